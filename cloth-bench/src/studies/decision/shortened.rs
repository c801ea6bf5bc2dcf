//! Steps in contact that end before they are converged: which of them is the better for its time?

use super::measure::Drape;
use crate::studies::pictures::vectors;
use crate::studies::prelude::*;
use std::cmp::Ordering;

/// Ends of a step of each method, those of a converged one first.
const ENDS: [(&str, &str); 8] = [
    ("implicit-euler", "tolerance=1e-3"),
    ("implicit-euler", "tolerance=1e-2"),
    ("implicit-euler", "tolerance=3e-2"),
    ("implicit-euler", "tolerance=1e-1"),
    ("implicit-euler", "tolerance=3e-1"),
    ("pd", "velocity_tolerance=3e-1"),
    ("pd", "velocity_tolerance=1e-1"),
    ("pd", "velocity_tolerance=3e-2"),
];

/// Scenes, with vertices along in a quick and in a full run.
const SCENES: [(&str, [u32; 2]); 3] = [
    ("drape-sphere", [9, 25]),
    ("drape-box", [9, 25]),
    ("fold", [9, 17]),
];

/// A fall that is off by less than this part of the converged one is right.
const RIGHT: Real = 0.02;

/// A step that ends early.
#[derive(Default, Serialize)]
struct End {
    scene: &'static str,
    method: &'static str,
    end: &'static str,
}

/// What it gives.
#[derive(Default, Serialize)]
struct Given {
    #[serde(rename = "ms a step")]
    ms: Option<Real>,
    #[serde(rename = "fall (m)")]
    fall: Option<Real>,
    #[serde(rename = "fall off by, relative")]
    off: Option<Real>,
    largest_stretch: Option<Real>,
    energy_above_what_was_given: Option<Real>,
}

pub(super) fn compare(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let columns = [
        "scene",
        "the fastest right to 2 %",
        "pd, default",
        "converged",
    ];
    let (mut rows, mut told, mut first) = (Vec::new(), Table::new(&columns), Vec::new());
    for (scene, sides) in SCENES {
        let begin = rows.len();
        compare_on(study, (scene, sides), &mut rows)?;
        let of_scene = &rows[begin..];
        told.line(scene, tell(of_scene));
        first.extend(first_method(of_scene).map(|method| format!("on {scene} {method}")));
    }
    let caption =
        "Steps in contact that end early, beside converged ones (the first of each scene)";
    study.table("decision-shortened", caption, Table::of(&rows));
    study.answer(
        "In contact, projective dynamics or the implicit step cut short?",
        format!(
            "The first to be right to {}: {}. Time of a step, and how far the fall is off that of converged steps:",
            percent(RIGHT),
            first.join(", ")
        ),
        Some(told),
        "table-decision-shortened",
    );
    Ok(())
}

/// The ends on one scene.
fn compare_on(
    study: &mut StudyRun<'_>,
    (name, sides): (&'static str, [u32; 2]),
    rows: &mut Vec<(End, Given)>,
) -> Result<(), BenchError> {
    let scope = study.scope;
    let n = scope.pick(sides[0], sides[1]);
    let scene = scene::build(name, None, &Settings::default().with("n", n))?;
    let start = mean_height(&scene.start.positions);
    let ends = ENDS.map(|(method, end)| End {
        scene: name,
        method,
        end,
    });
    let case = |end: &End| format!("{} on {}, {}", end.method, end.scene, end.end);
    let found = study.grid(ends, case, |end| {
        let (method, settings) = (Method::find(end.method)?, Settings::of(end.end));
        Drape::measure(&scene, scope, method, &settings)
    });
    let mut converged = None;
    for (end, drape) in found {
        let positions = vectors(&drape.positions);
        let fall = (!positions.is_empty()).then(|| start - mean_height(&positions));
        converged = converged.or(fall);
        let off = fall.zip(converged).map(|(fall, right)| fall / right - 1.0);
        let given = Given {
            ms: drape.ms,
            fall,
            off,
            largest_stretch: drape.stretch,
            energy_above_what_was_given: drape.excess,
        };
        rows.push((end, given));
    }
    Ok(())
}

/// The end that `pd` has by default.
const PD_DEFAULT: &str = "velocity_tolerance=1e-1";

/// Those that are right on one scene.
fn right(rows: &[(End, Given)]) -> impl Iterator<Item = &(End, Given)> {
    let is_right = |given: &Given| given.off.is_some_and(|off| off.abs() < RIGHT);
    rows.iter().filter(move |(_, given)| is_right(given))
}

/// The method that is right first, unless another is too near to tell.
fn first_method(rows: &[(End, Given)]) -> Option<&str> {
    let (end, Given { ms: first, .. }) = fastest(rows)?;
    let is_near = |ms: Option<Real>| ms.zip(*first).is_some_and(|(ms, first)| ms < NOISE * first);
    let mut near = right(rows).filter(|(_, given)| is_near(given.ms));
    Some(match near.all(|(other, _)| other.method == end.method) {
        true => end.method,
        false => "neither (within the noise)",
    })
}

/// The fastest that is right on one scene.
fn fastest(rows: &[(End, Given)]) -> Option<&(End, Given)> {
    right(rows).min_by(|a, b| a.1.ms.partial_cmp(&b.1.ms).unwrap_or(Ordering::Equal))
}

/// The same in words, projective dynamics at its default, and the converged one.
fn tell(rows: &[(End, Given)]) -> [Cell; 3] {
    let say = |given: &Given| {
        let ms = given.ms.map_or_else(String::new, two);
        match given.off {
            None => "not run".into(),
            Some(0.0) => format!("{ms} ms"),
            Some(off) if off < 0.0 => format!("{ms} ms, −{}", percent(-off)),
            Some(off) => format!("{ms} ms, +{}", percent(off)),
        }
    };
    let first = fastest(rows)
        .map(|(end, given)| Cell::said(format!("{} with {}: {}", end.method, end.end, say(given))));
    let default = rows.iter().find(|(end, _)| end.end == PD_DEFAULT);
    let short =
        |row: Option<&(End, Given)>| row.map_or(Cell::Missing, |(_, given)| Cell::said(say(given)));
    [
        first.unwrap_or_default(),
        short(default),
        short(rows.first()),
    ]
}

/// m, over all vertices.
fn mean_height(positions: &[Vec3]) -> Real {
    positions.iter().map(|x| x.z).sum::<Real>() / positions.len() as Real
}
