//! How far along a step is it safe to go?

use crate::broad_phase::{ClothCandidates, Hierarchy};
use crate::ccd::{ContinuousTest, Impact};
use crate::closest::{edge_edge, point_triangle};
use crate::error::CollideError;
use crate::obstacle::{Obstacle, VertexPath, first_contact};
use cloth_core::math::{Real, Vec3, gather};

/// A part of a step that is free of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Safe {
    /// How much of it (dimensionless, 0..=1).
    pub(super) part: Real,
    /// A vertex of what comes next, if something does.
    pub(super) vertex: Option<u32>,
}

impl Safe {
    pub(super) fn all() -> Self {
        Self {
            part: 1.0,
            vertex: None,
        }
    }

    fn lower_to(&mut self, part: Real, vertex: u32) {
        if part < self.part {
            *self = Self {
                part,
                vertex: Some(vertex),
            };
        }
    }
}

/// What a step leaves of each distance, at least: the next step starts from there.
pub(super) const SLACK: Real = 0.1;
/// The search for that moment may end when this part of what is above it is left.
const EARLY: Real = 0.1;

/// A candidate's test: for the time at which its distance (m) is down to the part [`SLACK`] of what it is at the start. The slack of [`ContinuousTest`]
/// itself would only let it stop early; it does not keep it from going on to the contact.
fn keeping(distance: Real) -> Result<ContinuousTest, CollideError> {
    ContinuousTest::new(SLACK * distance, EARLY)
}

/// Lowers `safe` to the part of the motion from `from` to `to` (m) in which every candidate keeps the part [`SLACK`] of its distance.
pub(super) fn cap_by_cloth(
    safe: &mut Safe,
    candidates: &ClothCandidates<Hierarchy>,
    from: &[Vec3],
    to: &[Vec3],
) -> Result<(), CollideError> {
    let mut lower = |vertex: u32, impact: Option<Impact>| {
        if let Some(impact) = impact {
            safe.lower_to(impact.time, vertex);
        }
    };
    for &[vertex, triangle] in candidates.vertex_triangle() {
        let corners = candidates.triangles()[triangle as usize];
        let v = vertex as usize;
        let (start, end) = (gather(from, corners), gather(to, corners));
        if from[v] == to[v] && start == end {
            continue;
        }
        let test = keeping(point_triangle(from[v], start).distance())?;
        lower(
            vertex,
            test.vertex_triangle([from[v], to[v]], [start, end])?,
        );
    }
    for pair in candidates.edge_edge() {
        let [first, second] = pair.map(|e| candidates.edges()[e as usize]);
        let at = |ends: [u32; 2]| [gather(from, ends), gather(to, ends)];
        let (one, other) = (at(first), at(second));
        if one[0] == one[1] && other[0] == other[1] {
            continue;
        }
        let test = keeping(edge_edge(one[0], other[0]).distance())?;
        lower(first[0], test.edge_edge(one, other)?);
    }
    Ok(())
}

/// A motion of obstacles: from `start` (s) on their own clocks for `duration` (s).
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    pub(super) start: Real,
    pub(super) duration: Real,
}

/// The same for the vertices against obstacles that move meanwhile, each vertex keeping its part of φ − `thickness` (m).
pub(super) fn cap_by_obstacles(
    safe: &mut Safe,
    obstacles: &[Obstacle],
    when: Interval,
    thickness: Real,
    from: &[Vec3],
    to: &[Vec3],
) {
    for obstacle in obstacles {
        for (vertex, (&from, &to)) in (0u32..).zip(from.iter().zip(to)) {
            let gap = obstacle.clearance(from, when.start).value - thickness;
            let keep = thickness + SLACK * gap;
            let path = VertexPath::straight(from, to, when.duration);
            let hit = first_contact(obstacle, &path, when.start, when.duration, keep);
            if let Some(hit) = hit {
                safe.lower_to(hit.time / when.duration, vertex);
            }
        }
    }
}
