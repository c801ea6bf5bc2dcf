//! Axis-aligned boxes: the cheap lower limit of a distance.

use cloth_core::math::{Real, Vec3};

/// The smallest axis-aligned box around some points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates (m).
    pub lower: Vec3,
    /// The corner with the largest coordinates (m).
    pub upper: Vec3,
}

impl Bounds {
    /// The box around `points` (m).
    pub(crate) fn around<const N: usize>(points: [Vec3; N]) -> Self {
        Self::of(&points)
    }

    /// The box around `points` (m), of which there is at least one.
    pub(crate) fn of(points: &[Vec3]) -> Self {
        let mut bounds = Self {
            lower: points[0],
            upper: points[0],
        };
        for point in &points[1..] {
            bounds.lower = bounds.lower.inf(point);
            bounds.upper = bounds.upper.sup(point);
        }
        bounds
    }

    /// The box around some of the vertices at `x` (m), of which there is at least one.
    pub(crate) fn of_vertices(vertices: &[u32], x: &[Vec3]) -> Self {
        let first = Self::around([x[vertices[0] as usize]]);
        vertices.iter().fold(first, |bounds, &v| Self {
            lower: bounds.lower.inf(&x[v as usize]),
            upper: bounds.upper.sup(&x[v as usize]),
        })
    }

    /// The largest coordinate of a corner, in size (m).
    pub(crate) fn size(&self) -> Real {
        self.lower.amax().max(self.upper.amax())
    }

    /// Squared distance (m²) of two boxes: no points in them are closer.
    pub(crate) fn squared_gap(&self, other: &Self) -> Real {
        (self.lower - other.upper)
            .sup(&(other.lower - self.upper))
            .sup(&Vec3::zeros())
            .norm_squared()
    }

    /// The gap (m) along the axis where it is widest; negative if the boxes overlap.
    #[inline]
    pub(crate) fn axis_gap(&self, other: &Self) -> Real {
        let gaps = [self.lower - other.upper, other.lower - self.upper];
        gaps[0].max().max(gaps[1].max())
    }

    /// The box moved outwards by `margin` (m) on each side, and by so much more that rounding takes nothing away.
    pub(crate) fn inflated(&self, margin: Real) -> Self {
        let margin = Vec3::repeat(margin);
        Self {
            lower: (self.lower - margin).map(Real::next_down),
            upper: (self.upper + margin).map(Real::next_up),
        }
    }

    /// The smallest box that contains both.
    pub(crate) fn joined(&self, other: &Self) -> Self {
        Self {
            lower: self.lower.inf(&other.lower),
            upper: self.upper.sup(&other.upper),
        }
    }

    /// Whether the two boxes have a point in common; touching counts.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        // Without an early exit: on candidates the outcome is hard to foresee.
        (0..3).fold(true, |all, k| {
            all & (self.lower[k] <= other.upper[k]) & (other.lower[k] <= self.upper[k])
        })
    }
}

/// How far (m) a vertex goes besides a common `shift` (m), at most.
pub(crate) fn farthest(from: &[Vec3], to: &[Vec3], shift: Vec3) -> Real {
    let squares = from.iter().zip(to);
    let squares = squares.map(|(a, b)| (b - a - shift).norm_squared());
    squares.fold(0.0, Real::max).sqrt()
}

/// How far (m) a point goes, at most, relative to the mean motion.
pub(crate) fn longest([from, to]: [&[Vec3]; 2]) -> Real {
    farthest(from, to, mean(to) - mean(from))
}

/// The mean of some positions (m).
pub(crate) fn mean(positions: &[Vec3]) -> Vec3 {
    positions.iter().sum::<Vec3>() / positions.len().max(1) as Real
}
