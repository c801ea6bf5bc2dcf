//! Both kinds of query are one: when does the origin meet a moving polygon?

use super::number::{Number, Triple, exact_sum, power_for};
use crate::closest::{edge_edge, point_triangle};
use crate::error::CollideError;
use cloth_core::math::{Real, Vec3, is_finite};

/// The differences "corner of the one minus corner of the other" of two primitives, at the start and at the end of
/// the motion.
///
/// A vertex and a triangle have K = 3 of them, two edges have K = 4: the corners of a triangle and of a parallelogram.
/// Two points, one of each primitive, differ by a point of this polygon, so the distance of the two primitives is the
/// distance of the polygon from the origin. All corners move linearly, hence so do their differences.
///
/// The lengths here are in a unit of their own, a power of two metres, in which the largest coordinate is of order one.
/// So nothing overflows or underflows later on, and the change of unit does not round. A difference of two coordinates
/// is rounded relative to itself, however far away from the origin of space both are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Difference<const K: usize> {
    /// At the start.
    pub(super) from: Corners<K>,
    /// At the end.
    pub(super) to: Corners<K>,
    /// Largest absolute coordinate of all (own unit).
    pub(super) size: Real,
    /// Metres to own unit (1/m), a power of two.
    pub(super) scale: Real,
}

/// K differences (own unit), rounded, and the two points (m) that each one is made of, to get at what was rounded away.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corners<const K: usize> {
    pub(super) rounded: [Vec3; K],
    pairs: [[Vec3; 2]; K],
}

impl<const K: usize> Corners<K> {
    /// From pairs of points (m) to be subtracted, not scaled yet.
    fn new(pairs: [[Vec3; 2]; K]) -> Self {
        Self {
            rounded: pairs.map(|[a, b]| a - b),
            pairs,
        }
    }

    fn scaled(mut self, scale: Real) -> Self {
        for x in &mut self.rounded {
            *x *= scale;
        }
        self
    }

    fn number<S: Number>(&self, k: usize, scale: Real) -> Triple<S> {
        let [a, b] = &self.pairs[k];
        [0, 1, 2].map(|i| S::new(self.rounded[k][i], exact_sum(a[i], -b[i]).1 * scale))
    }
}

impl<const K: usize> Difference<K> {
    fn new(from: Corners<K>, to: Corners<K>) -> Result<Self, CollideError> {
        let all = from.rounded.iter().chain(&to.rounded);
        let largest = all.map(Vec3::amax).fold(0.0, Real::max);
        if largest > LARGEST {
            return Err(CollideError::TooFarApart);
        }
        let scale = power_for(largest);
        Ok(Self {
            from: from.scaled(scale),
            to: to.scaled(scale),
            size: largest * scale,
            scale,
        })
    }

    /// The differences (own unit) at `time` in 0..=1. Each coordinate is off by at most 4 roundings of `size`: one
    /// was made by subtracting, one in 1 − t, one in each product and one in the sum.
    pub(super) fn at<S: Number>(&self, time: S) -> [Triple<S>; K] {
        let rest = S::new(1.0, 0.0) - time;
        std::array::from_fn(|k| {
            let (from, to) = (
                self.from.number::<S>(k, self.scale),
                self.to.number::<S>(k, self.scale),
            );
            [0, 1, 2].map(|i| from[i] * rest + to[i] * time)
        })
    }
}

impl Difference<3> {
    /// Of a vertex and a triangle (m).
    pub(super) fn vertex_triangle(
        point: [Vec3; 2],
        triangle: [[Vec3; 3]; 2],
    ) -> Result<Self, CollideError> {
        let [a0, b0, c0] = triangle[0];
        let [a1, b1, c1] = triangle[1];
        refuse_non_finite([point, [a0, a1], [b0, b1], [c0, c1]])?;
        let minus = |at: usize| Corners::new(triangle[at].map(|corner| [point[at], corner]));
        Self::new(minus(0), minus(1))
    }
}

impl Difference<4> {
    /// Of two edges (m).
    pub(super) fn edge_edge(
        first: [[Vec3; 2]; 2],
        second: [[Vec3; 2]; 2],
    ) -> Result<Self, CollideError> {
        let vertex = |edge: &[[Vec3; 2]; 2], end: usize| [edge[0][end], edge[1][end]];
        refuse_non_finite([
            vertex(&first, 0),
            vertex(&first, 1),
            vertex(&second, 0),
            vertex(&second, 1),
        ])?;
        let minus = |at: usize| {
            let ([a, b], [c, d]) = (first[at], second[at]);
            Corners::new([[a, c], [b, c], [a, d], [b, d]])
        };
        Self::new(minus(0), minus(1))
    }
}

/// Differences (m) up to this can be scaled and squared.
const LARGEST: Real = 1e300;

/// `vertices` are positions (m) at the start and at the end.
fn refuse_non_finite(vertices: [[Vec3; 2]; 4]) -> Result<(), CollideError> {
    let wrong = |ends: &[Vec3; 2]| !ends.iter().all(is_finite);
    match vertices.iter().position(wrong) {
        Some(vertex) => Err(CollideError::NonFinitePosition { vertex }),
        None => Ok(()),
    }
}

/// The part of a polygon on which its point nearest to the origin lies. Numbers are those of corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Feature {
    Face,
    Edge(usize, usize),
    Corner(usize),
}

/// Polygons that know their point nearest to the origin.
pub(super) trait NearestFeature {
    /// All their parts, those with the most points first.
    const FEATURES: &'static [Feature];
    /// Where it is.
    fn nearest_feature(&self) -> Feature;
    /// How far inside the face it is: its smallest weight (dimensionless), 0 on the boundary.
    fn depth_inside(&self) -> Real;
}

/// Weights of the point of the triangle `x` that is nearest to the origin.
fn triangle_weights(x: &[Vec3; 3]) -> [Real; 3] {
    point_triangle(Vec3::zeros(), x.map(|x| -x)).weights
}

/// Fractions of the two edges at which the parallelogram `x` is nearest to the origin. As seen from the start of the
/// second edge.
fn fractions([x0, x1, x2, _]: &[Vec3; 4]) -> [Real; 2] {
    edge_edge([*x0, *x1], [Vec3::zeros(), x0 - x2]).along
}

impl NearestFeature for [Vec3; 3] {
    const FEATURES: &'static [Feature] = &[
        Feature::Face,
        Feature::Edge(0, 1),
        Feature::Edge(1, 2),
        Feature::Edge(0, 2),
        Feature::Corner(0),
        Feature::Corner(1),
        Feature::Corner(2),
    ];

    fn nearest_feature(&self) -> Feature {
        let [wa, wb, wc] = triangle_weights(self);
        match (wa == 0.0, wb == 0.0, wc == 0.0) {
            (true, true, _) => Feature::Corner(2),
            (true, _, true) => Feature::Corner(1),
            (_, true, true) => Feature::Corner(0),
            (true, _, _) => Feature::Edge(1, 2),
            (_, true, _) => Feature::Edge(0, 2),
            (_, _, true) => Feature::Edge(0, 1),
            _ => Feature::Face,
        }
    }

    fn depth_inside(&self) -> Real {
        triangle_weights(self).into_iter().fold(1.0, Real::min)
    }
}

impl NearestFeature for [Vec3; 4] {
    const FEATURES: &'static [Feature] = &[
        Feature::Face,
        Feature::Edge(0, 1),
        Feature::Edge(2, 3),
        Feature::Edge(0, 2),
        Feature::Edge(1, 3),
        Feature::Corner(0),
        Feature::Corner(1),
        Feature::Corner(2),
        Feature::Corner(3),
    ];

    fn nearest_feature(&self) -> Feature {
        let [s, t] = fractions(self);
        let end = |along: Real| match along {
            0.0 => Some(0),
            1.0 => Some(1),
            _ => None,
        };
        match (end(s), end(t)) {
            (None, None) => Feature::Face,
            (Some(i), None) => Feature::Edge(i, i + 2),
            (None, Some(j)) => Feature::Edge(2 * j, 2 * j + 1),
            (Some(i), Some(j)) => Feature::Corner(i + 2 * j),
        }
    }

    fn depth_inside(&self) -> Real {
        let [s, t] = fractions(self);
        s.min(1.0 - s).min(t).min(1.0 - t)
    }
}
