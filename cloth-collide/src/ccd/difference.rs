//! Both kinds of query as one: the origin before a moving polygon.

use super::Query;
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
    pub(super) from: Corners<K>,
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
    /// Of a query: `pairs` of its vertices to be subtracted.
    pub(super) fn new(query: &Query, pairs: [[usize; 2]; K]) -> Result<Self, CollideError> {
        let is_bad = |&k: &usize| !is_finite(&query.from[k]) || !is_finite(&query.to[k]);
        if let Some(vertex) = (0..4).find(is_bad) {
            return Err(CollideError::NonFinitePosition { vertex });
        }
        let [from, to] =
            [&query.from, &query.to].map(|x| Corners::new(pairs.map(|pair| pair.map(|k| x[k]))));
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

/// Differences (m) up to this can be scaled and squared.
const LARGEST: Real = 1e300;

/// The part of a polygon on which its point nearest to the origin lies. Numbers are those of corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Feature {
    Face,
    Edge(usize, usize),
    Corner(usize),
}

/// Polygons that know their point nearest to the origin.
pub(super) trait NearestFeature {
    /// The corners at the ends of their edges.
    const EDGES: &'static [[usize; 2]];
    const CORNERS: usize;
    /// All their parts, those with the most points first.
    fn features() -> impl Iterator<Item = Feature> {
        let edges = Self::EDGES.iter().map(|&[k, l]| Feature::Edge(k, l));
        let corners = (0..Self::CORNERS).map(Feature::Corner);
        std::iter::once(Feature::Face).chain(edges).chain(corners)
    }
    /// Where it is.
    fn nearest_feature(&self) -> Feature;
    /// `nearest` and those of more points that it belongs to. At a small distance it takes less than rounding to
    /// mistake a point of an edge for its end, but the directions to the two are not the same; and the normal of the
    /// face often serves for longer.
    fn containing(nearest: Feature) -> impl Iterator<Item = Feature> {
        let contains = move |larger: &Feature| match (*larger, nearest) {
            (Feature::Face, nearest) => nearest != Feature::Face,
            (Feature::Edge(k, l), Feature::Corner(corner)) => corner == k || corner == l,
            _ => false,
        };
        std::iter::once(nearest).chain(Self::features().filter(contains))
    }
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
    const EDGES: &'static [[usize; 2]] = &[[0, 1], [1, 2], [0, 2]];
    const CORNERS: usize = 3;

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
    const EDGES: &'static [[usize; 2]] = &[[0, 1], [2, 3], [0, 2], [1, 3]];
    const CORNERS: usize = 4;

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
