//! How far along a step is it safe to go?

use crate::broad_phase::{ClothCandidates, Hierarchy};
use crate::ccd::ContinuousTest;
use crate::closest::{edge_edge, point_triangle};
use crate::error::CollideError;
use crate::obstacle::{Obstacle, VertexPath, first_contact};
use cloth_core::math::{Real, Vec3, gather};

/// What a step leaves of each distance, or of the range of the barrier where that is less: the next step starts from there. A Newton step is meant to keep
/// its distances; what brings it nearer than this are long tangential ways that bend, and these are better taken in pieces. With 0.1 instead
/// the searches of random motions took twice the steps, and many ended too near to see a way.
const SLACK: Real = 0.7;
/// The search for that moment may end when this part of what is above it is left.
const EARLY: Real = 0.1;
/// Distances below this part of the coordinates cannot be relied on: positions on the way are rounded.
const ROUNDING: Real = 64.0 * Real::EPSILON;

/// A linear motion of all vertices, from one list of positions (m) to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion<'a> {
    pub(super) from: &'a [Vec3],
    pub(super) to: &'a [Vec3],
    /// Range of the barrier (m): what is farther apart may come as near in one step.
    pub(super) range: Real,
}

impl Motion<'_> {
    /// The time (dimensionless, 0..=1) at which a pair's distance is down to the part [`SLACK`] of the `distance` (m) that it has at the start, as `test` finds it; nothing
    /// if that does not happen. The slack of [`ContinuousTest`] itself would only let it stop early; it does not keep it from going on to the contact.
    fn time(
        &self,
        vertices: [u32; 4],
        distance: Real,
        test: impl Fn(&ContinuousTest) -> Result<Option<Real>, CollideError>,
    ) -> Result<Option<Real>, CollideError> {
        let size = |list: &[Vec3]| vertices.map(|v| list[v as usize].amax());
        let sizes = [size(self.from), size(self.to)];
        let size = sizes.iter().flatten().fold(0.0, |a: Real, b| a.max(*b));
        let keep = SLACK * distance.min(self.range);
        if keep <= ROUNDING * size {
            return Ok(Some(0.0));
        }
        test(&ContinuousTest::new(keep, EARLY)?)
    }

    fn stays<const N: usize>(&self, vertices: [u32; N]) -> bool {
        gather(self.from, vertices) == gather(self.to, vertices)
    }
}

/// Hands `visit` the vertices of every candidate that comes too near on the way, with the time until which it does not (dimensionless, 0..=1).
pub(super) fn visit_cloth(
    motion: Motion<'_>,
    candidates: &ClothCandidates<Hierarchy>,
    mut visit: impl FnMut(&[u32], Real),
) -> Result<(), CollideError> {
    let Motion { from, to, .. } = motion;
    for &[vertex, triangle] in candidates.vertex_triangle() {
        let corners = candidates.triangles()[triangle as usize];
        let vertices = [vertex, corners[0], corners[1], corners[2]];
        if motion.stays(vertices) {
            continue;
        }
        let (start, end) = (gather(from, corners), gather(to, corners));
        let (p, q) = (from[vertex as usize], to[vertex as usize]);
        let distance = point_triangle(p, start).distance();
        let time = motion.time(vertices, distance, |test| {
            let impact = test.vertex_triangle([p, q], [start, end])?;
            Ok(impact.map(|impact| impact.time))
        })?;
        time.into_iter().for_each(|time| visit(&vertices, time));
    }
    for pair in candidates.edge_edge() {
        let [first, second] = pair.map(|e| candidates.edges()[e as usize]);
        let vertices = [first[0], first[1], second[0], second[1]];
        if motion.stays(vertices) {
            continue;
        }
        let at = |ends: [u32; 2]| [gather(from, ends), gather(to, ends)];
        let (one, other) = (at(first), at(second));
        let distance = edge_edge(one[0], other[0]).distance();
        let time = motion.time(vertices, distance, |test| {
            let impact = test.edge_edge(one, other)?;
            Ok(impact.map(|impact| impact.time))
        })?;
        time.into_iter().for_each(|time| visit(&vertices, time));
    }
    Ok(())
}

/// A motion of obstacles: from `start` (s) on their own clocks for `duration` (s).
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    pub(super) start: Real,
    pub(super) duration: Real,
}

/// The same for the vertices of positive `weight` against obstacles that move meanwhile, with φ − `thickness` (m) for the distance.
pub(super) fn visit_obstacles(
    motion: Motion<'_>,
    obstacles: &[Obstacle],
    when: Interval,
    thickness: Real,
    weight: &[Real],
    mut visit: impl FnMut(&[u32], Real),
) {
    for obstacle in obstacles {
        let ends = motion.from.iter().zip(motion.to);
        let free = (0u32..).zip(ends).zip(weight).filter(|(_, w)| **w > 0.0);
        for ((vertex, (&from, &to)), _) in free {
            let gap = obstacle.clearance(from, when.start).value - thickness;
            let path = VertexPath::straight(from, to, when.duration);
            let keep = SLACK * gap.min(motion.range);
            if keep <= ROUNDING * from.amax().max(to.amax()) {
                if from != to || !obstacle.motion().is_still() {
                    visit(&[vertex], 0.0);
                }
            } else if let Some(hit) =
                first_contact(obstacle, &path, when.start, when.duration, thickness + keep)
            {
                visit(&[vertex], hit.time / when.duration);
            }
        }
    }
}
