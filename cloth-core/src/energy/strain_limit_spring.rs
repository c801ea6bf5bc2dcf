//! A spring that is slack within a range: strain limiting along an edge.
//!
//! X. Provot, "Deformation constraints in a mass-spring model to describe rigid cloth behavior", Graphics Interface
//! 1995; as a projection, S. Bouaziz et al., "Projective dynamics", 2014, <https://doi.org/10.1145/2601097.2601116>,
//! section 5.1.

use super::Spring;
use crate::cloth::Elements;
use crate::element::{Constraint, Convexity, DeadZoneRow, Element, Projective, Row};
use crate::error::{OutOfRange, number};
use crate::math::{
    Blocks, Mat3, Real, Vec3, across_pair, across_pair_product, length_and_direction,
};

/// Costs nothing while its length l is between `σ_min L` and `σ_max L`: `C = l − clamp(l)` (m), `E = ½ k C²` (J).
///
/// With both limits 1 it is a [`Spring`](super::Spring). Set beside one that is soft, it gives cloth that yields first
/// and then holds.
///
/// Limits: a soft limit: a load f stretches it by f/k beyond σ_max. The stiffness jumps at the limits, where the one of
/// the inside is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainLimitSpring {
    /// The two ends.
    pub vertices: [u32; 2],
    /// Shortest free length `σ_min L` (m).
    pub shortest: Real,
    /// Longest free length `σ_max L` (m), at least the shortest.
    pub longest: Real,
    /// Stiffness k (N/m) outside.
    pub stiffness: Real,
}

impl StrainLimitSpring {
    /// One element along every pair of `ends`, with limits `[σ_min, σ_max]` (dimensionless) on its length relative to
    /// that at `rest_positions` (m) and stiffness `stiffness` (N/m).
    ///
    /// # Panics
    /// If an end is not smaller than the number of rest positions, or `0 ≤ σ_min ≤ σ_max` does not hold.
    #[must_use]
    pub fn along(
        rest_positions: &[Vec3],
        ends: &[[u32; 2]],
        limits: [Real; 2],
        stiffness: Real,
    ) -> Vec<Self> {
        super::check_limits(limits);
        ends.iter()
            .map(|&vertices| {
                let [a, b] = crate::math::gather(rest_positions, vertices);
                let [shortest, longest] = limits.map(|limit| limit * (a - b).norm());
                Self {
                    vertices,
                    shortest,
                    longest,
                    stiffness,
                }
            })
            .collect()
    }

    /// φ is the length l (m).
    #[inline]
    fn dead_zone_row(&self, x: &[Vec3; 2]) -> DeadZoneRow<2> {
        let (length, n) = length_and_direction(x[0] - x[1], self.vertices);
        DeadZoneRow {
            value: length,
            gradient: [n, -n],
            range: [self.shortest, self.longest],
            stiffness: self.stiffness,
        }
    }

    /// The allowed length (m) nearest to `length` (m).
    #[inline]
    fn nearest(&self, length: Real) -> Real {
        length.min(self.longest).max(self.shortest)
    }

    /// Its direction, and its stiffness (N/m) at right angles to that.
    #[inline]
    fn stiffness_across(&self, x: &[Vec3; 2], convexity: Convexity) -> (Vec3, Real) {
        let (length, n) = length_and_direction(x[0] - x[1], self.vertices);
        let strain = if length > 0.0 {
            1.0 - self.nearest(length) / length
        } else if self.longest == 0.0 {
            1.0 // E = ½ k l² is smooth here
        } else {
            0.0 // no second derivative exists; the rank-one part stands alone
        };
        (n, self.stiffness * convexity.applied_to(strain))
    }
}

impl Element<2> for StrainLimitSpring {
    const HAS_JUMPS: bool = true;
    const IS_IN_ELEMENTS: bool = true;

    #[inline]
    fn vertices(&self) -> [u32; 2] {
        self.vertices
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::Limited(all)
    }

    fn check(&self) -> Result<(), OutOfRange> {
        number("shortest length (m)", self.shortest)?;
        number("longest length (m)", self.longest)?;
        number("stiffness", self.stiffness)?;
        Ok(())
    }
}

impl Constraint<2> for StrainLimitSpring {
    type Rows = [Row<2>; 1];

    /// The gradient vanishes with C between the limits.
    #[inline]
    fn rows(&self, x: &[Vec3; 2]) -> [Row<2>; 1] {
        [self.dead_zone_row(x).row()]
    }

    #[inline]
    fn dead_zone_rows(&self, x: &[Vec3; 2]) -> Option<[DeadZoneRow<2>; 1]> {
        Some([self.dead_zone_row(x)])
    }

    /// That of a [`Spring`]: where the limit does not act its multiplier is zero.
    fn geometric_stiffness(
        &self,
        x: &[Vec3; 2],
        multipliers: &[Real],
        convexity: Convexity,
    ) -> Blocks<2> {
        let spring = Spring {
            vertices: self.vertices,
            rest_length: self.longest,
            stiffness: self.stiffness,
        };
        spring.geometric_stiffness(x, multipliers, convexity)
    }

    /// `k (C/l)(I − n nᵀ)`: negative below the shortest length.
    #[inline]
    fn curvature(&self, x: &[Vec3; 2], convexity: Convexity) -> Blocks<2> {
        let (n, across) = self.stiffness_across(x, convexity);
        across_pair(n, across)
    }

    #[inline]
    fn curvature_product(&self, x: &[Vec3; 2], p: &[Vec3; 2], convexity: Convexity) -> [Vec3; 2] {
        let (n, across) = self.stiffness_across(x, convexity);
        across_pair_product(n, across, p)
    }
}

/// The set is the shell between two spheres, so `p = clamp(l) z/l`.
impl Projective<2, 1> for StrainLimitSpring {
    #[inline]
    fn operator(&self) -> [[Real; 2]; 1] {
        [[1.0, -1.0]]
    }

    #[inline]
    fn weight(&self) -> Real {
        self.stiffness
    }

    #[inline]
    fn project(&self, [z]: [Vec3; 1]) -> [Vec3; 1] {
        let (length, n) = length_and_direction(z, self.vertices);
        let nearest = self.nearest(length);
        // Between the limits z itself, to the last bit.
        [if nearest == length { z } else { n * nearest }]
    }

    #[inline]
    fn projected_hessian(&self, [z]: [Vec3; 1]) -> [[Mat3; 1]; 1] {
        let (length, n) = length_and_direction(z, self.vertices);
        let nearest = self.nearest(length);
        [[if nearest == length && self.shortest < self.longest {
            Mat3::zeros()
        } else {
            crate::math::projected_radial_hessian(length, n, nearest)
        }]]
    }
}
