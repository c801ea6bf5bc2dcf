//! The two points at which two edges come nearest to each other.

use super::nearest_on_segment;
use cloth_core::math::{Real, Vec3};

/// Where two edges come nearest to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeEdge {
    /// How far along the first and along the second edge the two points are, as a fraction of the edge
    /// (dimensionless, 0..=1). The barycentric weights of an edge are 1 − t and t.
    pub along: [Real; 2],
    /// The vector (m) from the point of the second edge to that of the first. Its length is the
    /// distance.
    pub separation: Vec3,
}

impl EdgeEdge {
    /// Distance (m) of the two edges.
    #[must_use]
    pub fn distance(&self) -> Real {
        self.separation.norm()
    }
}

/// Nearest points of the edge `first` and the edge `second` (two positions each, m).
///
/// With u and v the two edge vectors, d the vector from the start of `second` to that of `first` and n = u × v, the
/// two infinite lines are nearest at
///
/// s = n · (v × d) / n²,  t = v · (d + s u) / v².
///
/// For the shortest connection is at right angles to both, d + s u − t v = z n. The cross product of v with it is
/// v × d − s n = z v × n, whose dot product with n is 0; and the dot product of v with it is v · (d + s u) − t v² = 0.
///
/// If both lie in 0..=1 that is the answer. Otherwise an end of one of the edges takes part, and
/// the best of the four pairs (end, other edge) is it. This is the region walk of Ericson (2005), section
/// 5.1.9, with changes for nearly parallel edges, which are common in cloth. Ericson's determinant
/// |u|²|v|² − (u · v)² is made of rounding once the angle θ is below 1e-8; n² keeps its digits down to
/// θ = 1e-16. Even so s has an error of 1e-16/θ. It does no harm if t is the foot of just this point, as above, since
/// along nearly parallel edges the distance changes by θ times the displacement; a t computed like s would add its own
/// error to the distance.
///
/// The distance is accurate to a few roundings of the size of the configuration (the longest of the
/// edges and of the vectors between them), at every angle. The two points are less certain, as they have to be:
/// parallel edges that face each other are nearest along a stretch, a point of which is returned, and it jumps when the
/// angle changes sign. An edge without length is a point.
///
/// ```
/// use cloth_collide::edge_edge;
/// use cloth_core::math::Vec3;
///
/// let first = [Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0)];
/// let second = [Vec3::new(0.0, -1.0, 3.0), Vec3::new(0.0, 3.0, 3.0)];
/// let nearest = edge_edge(first, second);
/// assert_eq!(nearest.along, [0.5, 0.25]);
/// assert_eq!(nearest.distance(), 3.0);
/// ```
#[must_use]
pub fn edge_edge(first: [Vec3; 2], second: [Vec3; 2]) -> EdgeEdge {
    let (u, v) = (first[1] - first[0], second[1] - second[0]);
    let d = first[0] - second[0];
    let n = u.cross(&v);
    let n_squared = n.norm_squared();
    // Subnormal numbers would leave s too few digits.
    if n_squared >= Real::MIN_POSITIVE {
        let s = n.dot(&v.cross(&d)) / n_squared;
        let at_s = d + u * s;
        let t = v.dot(&at_s) / v.norm_squared();
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            return EdgeEdge {
                along: [s, t],
                separation: at_s - v * t,
            };
        }
    }
    nearest_with_an_end(first, second)
}

/// The nearest pair of points (of the two edges, in m) among those of which one is an end.
fn nearest_with_an_end(first: [Vec3; 2], second: [Vec3; 2]) -> EdgeEdge {
    let (u, v) = (first[1] - first[0], second[1] - second[0]);
    let first_end = |end: usize| {
        let d = first[end] - second[0];
        let t = nearest_on_segment(d, v);
        EdgeEdge {
            along: [end as Real, t],
            separation: d - v * t,
        }
    };
    let second_end = |end: usize| {
        let d = second[end] - first[0];
        let s = nearest_on_segment(d, u);
        EdgeEdge {
            along: [s, end as Real],
            separation: u * s - d,
        }
    };
    let mut nearest = first_end(0);
    for next in [first_end(1), second_end(0), second_end(1)] {
        if next.separation.norm_squared() < nearest.separation.norm_squared() {
            nearest = next;
        }
    }
    nearest
}
