//! Crossings that a run has made, in a sentence each.

use super::{SeparationWatch, Summary, Watched};
use crate::error::BenchError;
use crate::scene::Scene;

/// Pairs of triangles that pass through each other, and what is said of them.
struct Crossings<'a> {
    /// What the cloth has passed through.
    through: &'a str,
    /// At the start and at the end.
    start: usize,
    end: usize,
    /// The most after any step, and the steps after which there were some, of a run that was watched.
    seen: Option<(usize, u32)>,
    /// Why that may be, as the end of the sentence.
    why: Option<String>,
}

/// A sentence about the cloth in itself, and one about it in bodies, where a run of `steps` steps that began with the
/// scene `start` has made crossings that were not there at its start: at its end, or after any step where it was
/// watched and nothing crossed at the start.
pub fn crossing_warnings(
    start: &Scene,
    summary: &Summary,
    seen: Option<&Watched>,
) -> Result<Vec<String>, BenchError> {
    let ends = [summary.intersections, summary.obstacle_intersections];
    let ends = ends.map(Option::unwrap_or_default);
    let watched = [
        seen.map(|seen| (seen.most_intersections, seen.crossed_steps)),
        seen.map(|seen| {
            (
                seen.most_obstacle_intersections,
                seen.obstacle_crossed_steps,
            )
        }),
    ];
    let any = watched.iter().flatten().any(|(most, _)| *most > 0);
    if ends == [0, 0] && !any {
        return Ok(Vec::new());
    }
    let mut watch = SeparationWatch::new(start)?;
    watch.look(start, &start.start)?;
    let before = watch.seen();
    let touch = start.touch.as_ref().filter(|touch| !touch.is_idle());
    let nothing = || "nothing is touched in this scene".to_owned();
    let own = match touch {
        Some(touch) if touch.self_collision => None,
        Some(_) => Some("the cloth does not touch itself in this scene".to_owned()),
        None => Some(nothing()),
    };
    let bodies = touch.is_none().then(nothing);
    let all = [
        Crossings {
            through: "itself",
            start: before.most_intersections,
            end: ends[0],
            seen: watched[0],
            why: own,
        },
        Crossings {
            through: "a body",
            start: before.most_obstacle_intersections,
            end: ends[1],
            seen: watched[1],
            why: bodies,
        },
    ];
    let warnings = all.iter().filter_map(|all| all.warning(summary.steps));
    Ok(warnings.collect())
}

impl Summary {
    /// A sentence about cloth that bodies have pinched, if they have.
    pub fn pinch_warning(&self) -> Option<String> {
        let (pinched, steps, most) = (self.pinched_steps, self.steps, self.most_pinched);
        (pinched > 0).then(|| {
            format!(
                "bodies have pinched the cloth: in {pinched} of {steps} steps up to {most} of its vertices passed through one of them, since they had no feasible path (pinched=refuse ends the run instead)"
            )
        })
    }
}

impl Crossings<'_> {
    fn warning(&self, steps: u32) -> Option<String> {
        let (start, end) = (self.start, self.end);
        let came_and_went = start == 0 && self.seen.is_some_and(|(most, _)| most > 0);
        if end <= start && !came_and_went {
            return None;
        }
        let of_all = self
            .seen
            .map(|(most, crossed)| format!(", and {most} at most, in {crossed} of {steps} steps"));
        let why = self.why.as_ref().map(|why| format!("; {why}"));
        let through = self.through;
        Some(format!(
            "the cloth has passed through {through}: crossing pairs of triangles were {start} at the start, {end} at the end{}{}",
            of_all.unwrap_or_default(),
            why.unwrap_or_default()
        ))
    }
}
