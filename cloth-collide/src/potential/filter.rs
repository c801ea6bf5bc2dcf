//! How far a way is safe.

use super::gap::Gap;
use super::near_pairs::NearPairs;
use crate::ccd::{ContinuousTest, Impact};
use crate::error::CollideError;
use crate::obstacle::{Obstacle, VertexPath, first_contact};
use cloth_core::math::{Real, Vec3, gather};

/// What a way leaves of each distance, or of the thickness where that is less.
const SLACK: Real = 0.2;
/// The continuous test may end when this part of what is above that is left.
const EARLY: Real = 0.1;
/// Distances below this part of the coordinates cannot be relied on: positions on the way are rounded.
const ROUNDING: Real = 64.0 * Real::EPSILON;

impl NearPairs {
    /// The part of a way (m) on which every near pair keeps [`SLACK`] of its distance.
    pub(super) fn safe_part(
        &self,
        thickness: Real,
        from: &[Vec3],
        to: &[Vec3],
        obstacles: &[Obstacle],
    ) -> Result<Real, CollideError> {
        let mut cap: Real = 1.0;
        for pair in &self.vertex_triangle {
            let (a, b) = (gather(from, pair.vertices), gather(to, pair.vertices));
            let distance = Gap::vertex_triangle(&a).distance;
            let test = |test: &ContinuousTest| {
                let corners = [[a[1], a[2], a[3]], [b[1], b[2], b[3]]];
                test.vertex_triangle([a[0], b[0]], corners)
            };
            let way = approach(&a, &b, 1);
            cap = cap.min(time(distance, pair.law.range(), way, &a, &b, test)?);
        }
        for pair in &self.edge_edge {
            let (a, b) = (gather(from, pair.vertices), gather(to, pair.vertices));
            let distance = Gap::edge_edge(&a).distance;
            let test = |test: &ContinuousTest| {
                let first = [[a[0], a[1]], [b[0], b[1]]];
                test.edge_edge(first, [[a[2], a[3]], [b[2], b[3]]])
            };
            let way = approach(&a, &b, 2);
            cap = cap.min(time(distance, pair.law.range(), way, &a, &b, test)?);
        }
        for &[vertex, number] in &self.vertex_obstacle {
            let (a, b) = (from[vertex as usize], to[vertex as usize]);
            let obstacle = &obstacles[number as usize];
            let gap = obstacle.clearance(a, 0.0).value;
            let keep = SLACK * gap.min(thickness);
            if keep <= ROUNDING * a.amax().max(b.amax()) {
                cap = if a == b { cap } else { 0.0 };
            } else if (b - a).norm() * obstacle.shape().lipschitz() >= gap - keep {
                let path = VertexPath::straight(a, b, 1.0);
                let hit = first_contact(obstacle, &path, 0.0, 1.0, keep);
                cap = cap.min(hit.map_or(1.0, |hit| hit.time));
            }
        }
        Ok(cap)
    }
}

/// The most by which two pieces of four vertices, the first of which has `split`, can have come nearer (m) between two moments.
fn approach(a: &[Vec3; 4], b: &[Vec3; 4], split: usize) -> Real {
    let ways: [Vec3; 4] = std::array::from_fn(|k| b[k] - a[k]);
    let mean = ways.iter().sum::<Vec3>() * 0.25;
    let sizes = ways.map(|way| (way - mean).norm());
    let most = |sizes: &[Real]| sizes.iter().fold(0.0, |a: Real, b| a.max(*b));
    most(&sizes[..split]) + most(&sizes[split..])
}

/// The time (dimensionless, 0..=1) at which a pair's distance is down to [`SLACK`] of the `distance` (m) that it has at the start, or of
/// the thickness; 1 if that does not happen. `way` bounds how far the pieces approach each other.
fn time(
    distance: Real,
    thickness: Real,
    way: Real,
    a: &[Vec3; 4],
    b: &[Vec3; 4],
    test: impl Fn(&ContinuousTest) -> Result<Option<Impact>, CollideError>,
) -> Result<Real, CollideError> {
    let keep = SLACK * distance.min(thickness);
    if way < distance - keep {
        return Ok(1.0);
    }
    let size = a.iter().chain(b).map(Vec3::amax).fold(0.0, Real::max);
    if keep <= ROUNDING * size {
        return Ok(0.0);
    }
    let hit = test(&ContinuousTest::new(keep, EARLY)?)?;
    Ok(hit.map_or(1.0, |hit| hit.time))
}
