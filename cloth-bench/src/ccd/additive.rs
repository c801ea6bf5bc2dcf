//! Additive conservative advancement, as published: the method that the conservative test of `cloth-collide` is
//! compared with.

use cloth_collide::{Query, QueryKind};
use cloth_core::math::{Real, Vec3};

/// The distance may shrink to this fraction of what it was at first.
const SLACK: Real = 1e-3;

/// Then it gives up, and returns the time reached.
const MOST_STEPS: u32 = 10_000;

/// First contact (dimensionless, 0..=1) by the algorithm of M. Li, D. M. Kaufman and C. Jiang, Codimensional
/// incremental potential contact, *ACM Trans. Graph.* 40(4), 2021, DOI 10.1145/3450626.3459767, algorithm 1.
///
/// The distance cannot shrink faster than the two primitives move towards each other, at most with the sum of the
/// largest displacements of both after their common motion is taken off. So a time of distance / sum is safe, were the
/// distance exact.
pub(super) fn first_contact(query: &Query) -> Option<Real> {
    let motion: [Vec3; 4] = std::array::from_fn(|k| query.to[k] - query.from[k]);
    let mean = motion.iter().sum::<Vec3>() / 4.0;
    let largest = |part: &[Vec3]| part.iter().map(|d| (d - mean).norm()).fold(0.0, Real::max);
    let (first, second) = motion.split_at(match query.kind {
        QueryKind::VertexTriangle => 1,
        QueryKind::EdgeEdge => 2,
    });
    let fastest = largest(first) + largest(second);
    let start = query.distance(0.0);
    if start == 0.0 {
        return Some(0.0);
    }
    let (mut time, mut distance) = (0.0, start);
    for _ in 0..MOST_STEPS {
        let advance = (1.0 - SLACK) * distance / fastest;
        if time + advance >= 1.0 || fastest == 0.0 {
            return None;
        }
        let next = query.distance(time + advance);
        if next < SLACK * start {
            return Some(time);
        }
        time += advance;
        distance = next;
    }
    Some(time)
}
