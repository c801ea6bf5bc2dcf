//! The spring: two vertices that want to be a rest length apart.

use crate::cloth::Elements;
use crate::element::{Constraint, Convexity, Element, Projective, Row, RowForm, UnitRow};
use crate::error::{OutOfRange, finite, number};
use crate::math::{
    Blocks, Mat3, Real, Vec3, across_pair, across_pair_product, length_and_direction,
};

/// A linear spring: `C = ‖x₀ − x₁‖ − L` (m), `E = ½ k C²` (J).
///
/// With l = ‖x₀ − x₁‖ and the unit vector n from x₁ to x₀, its gradient is `k (l − L) n` at x₀ and the negative of that
/// at x₁; its Hessian has the block `B = k n nᵀ + k (1 − L/l) (I − n nᵀ)` at both ends and −B between them. Across n,
/// B is tension over length: negative under compression.
///
/// Where its two ends coincide the direction of its force is not defined; see
/// [`length_and_direction`] for the one it gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// The two ends.
    pub vertices: [u32; 2],
    /// Rest length L (m).
    pub rest_length: Real,
    /// Stiffness k (N/m).
    pub stiffness: Real,
}

impl Spring {
    /// One spring of stiffness `stiffness` (N/m) along every pair of `ends`, at rest at `rest_positions` (m). With the
    /// ends of [`crate::topology::EdgeTable`] these are the structural springs.
    ///
    /// # Panics
    /// If an end is not smaller than the number of rest positions.
    #[must_use]
    pub fn along(rest_positions: &[Vec3], ends: &[[u32; 2]], stiffness: Real) -> Vec<Self> {
        ends.iter()
            .map(|&vertices| {
                let [a, b] = crate::math::gather(rest_positions, vertices);
                Self {
                    vertices,
                    rest_length: (a - b).norm(),
                    stiffness,
                }
            })
            .collect()
    }

    /// One spring of stiffness `stiffness` (N/m) between the two vertices opposite the edge of every hinge: bending
    /// springs.
    ///
    /// Limits: they do not resist a small fold. Folded by θ without stretching, a hinge whose wings are mirror images,
    /// ℓ₀ apart, costs `½ k ℓ₀² (1 − cos(θ/2))² ≈ k ℓ₀² θ⁴/128`, so no rigidity D corresponds to k; and stretching the
    /// cloth stretches them too.
    ///
    /// # Panics
    /// If a vertex of a hinge is not smaller than the number of rest positions.
    #[must_use]
    pub fn across(
        rest_positions: &[Vec3],
        hinges: &crate::topology::HingeTable,
        stiffness: Real,
    ) -> Vec<Self> {
        let tips: Vec<_> = hinges.hinges().iter().map(|h| [h[2], h[3]]).collect();
        Self::along(rest_positions, &tips, stiffness)
    }

    /// Its direction, and its stiffness (N/m) at right angles to that.
    #[inline(always)]
    fn stiffness_across(&self, x: &[Vec3; 2], convexity: Convexity) -> (Vec3, Real) {
        let (length, n) = length_and_direction(x[0] - x[1], self.vertices);
        let strain = if length > 0.0 {
            1.0 - self.rest_length / length
        } else if self.rest_length == 0.0 {
            1.0 // E = ½ k l² is smooth here
        } else {
            0.0 // no second derivative exists; the rank-one part k n nᵀ stands alone
        };
        (n, self.stiffness * convexity.applied_to(strain))
    }

    /// Its length (m) at `to` as linearised at `from`; negative where its ends pass each other.
    #[inline(always)]
    pub(super) fn predicted_length(&self, from: &[Vec3; 2], to: &[Vec3; 2]) -> Real {
        let (length, along) = length_and_direction(from[0] - from[1], self.vertices);
        length + along.dot(&(to[0] - to[1] - from[0] + from[1]))
    }
}

/// Below this (m²) the square of a length has lost digits. [`length_and_direction`] takes lengths below 10⁻¹⁴⁰ m for
/// zero; the faster form keeps the direction of those down to 10⁻¹⁴⁵ m.
const SHORTEST_SQUARED: Real = 1e-290;

/// Length and direction where the square of the length underflows: seldom needed, so it is kept out of line.
#[cold]
#[inline(never)]
fn lost(d: Vec3, vertices: [u32; 2]) -> (Real, Vec3) {
    length_and_direction(d, vertices)
}

impl Element<2> for Spring {
    const IS_IN_ELEMENTS: bool = true;

    #[inline(always)]
    fn vertices(&self) -> [u32; 2] {
        self.vertices
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::Springs(all)
    }

    fn check(&self) -> Result<(), OutOfRange> {
        finite("rest length (m)", self.rest_length)?;
        number("stiffness", self.stiffness)?;
        Ok(())
    }
}

impl Constraint<2> for Spring {
    type Rows = [Row<2>; 1];

    #[inline(always)]
    fn rows(&self, x: &[Vec3; 2]) -> [Row<2>; 1] {
        let (length, n) = length_and_direction(x[0] - x[1], self.vertices);
        [Row {
            value: length - self.rest_length,
            gradient: [n, -n],
            stiffness: self.stiffness,
        }]
    }

    /// `−λ/l (I − n nᵀ)`: positive where the spring pulls, λ < 0.
    #[inline]
    fn geometric_stiffness(
        &self,
        x: &[Vec3; 2],
        multipliers: &[Real],
        convexity: Convexity,
    ) -> Blocks<2> {
        let (length, n) = length_and_direction(x[0] - x[1], self.vertices);
        let tension = if length > 0.0 {
            -multipliers[0] / length
        } else {
            0.0 // no second derivative exists
        };
        let block = (Mat3::identity() - n * n.transpose()) * convexity.applied_to(tension);
        [[block, -block], [-block, block]]
    }

    #[inline(always)]
    fn row_form(&self, x: &[Vec3; 2]) -> RowForm<2> {
        let mut d = x[0] - x[1];
        let squared = d.norm_squared();
        let mut length = squared.sqrt();
        let mut value = length - self.rest_length;
        // One comparison with a normal number: one with 0, subnormal numbers or NaN becomes a slow test of bits.
        if squared < SHORTEST_SQUARED {
            let shortest;
            (shortest, d) = lost(d, self.vertices);
            (value, length) = (shortest - self.rest_length, 1.0);
        }
        RowForm::Unit(UnitRow {
            value,
            direction: [d, -d],
            length,
            stiffness: self.stiffness,
        })
    }

    /// `k (1 − L/l)(I − n nᵀ)`: positive across a stretched spring, negative across a compressed one, so `Clamp` drops
    /// it under compression.
    #[inline(always)]
    fn curvature(&self, x: &[Vec3; 2], convexity: Convexity) -> Blocks<2> {
        let (n, across) = self.stiffness_across(x, convexity);
        across_pair(n, across)
    }

    /// The same at both ends.
    #[inline(always)]
    fn curvature_at(&self, x: &[Vec3; 2], _: usize, convexity: Convexity) -> Mat3 {
        let (n, across) = self.stiffness_across(x, convexity);
        (Mat3::identity() - n * n.transpose()) * across
    }

    /// `k |C|/L (I − n nᵀ)` with the predicted C, where [`Constraint::curvature`] divides by the length l at x. A stiff
    /// spring that has turned in an iteration is too long at x; where the prediction holds it is about L long.
    #[inline(always)]
    fn mixed_curvature(&self, x: &[Vec3; 2], from: &[Vec3; 2], to: &[Vec3; 2]) -> Blocks<2> {
        if self.rest_length == 0.0 {
            return self.curvature(x, Convexity::Abs);
        }
        let (_, n) = length_and_direction(x[0] - x[1], self.vertices);
        let value = self.predicted_length(from, to) - self.rest_length;
        across_pair(n, self.stiffness * (value / self.rest_length).abs())
    }

    #[inline]
    fn curvature_product(&self, x: &[Vec3; 2], p: &[Vec3; 2], convexity: Convexity) -> [Vec3; 2] {
        let (n, across) = self.stiffness_across(x, convexity);
        across_pair_product(n, across, p)
    }
}

/// The set is the sphere of radius L, so `p = L (x₀ − x₁)/‖x₀ − x₁‖`.
impl Projective<2, 1> for Spring {
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
        [length_and_direction(z, self.vertices).1 * self.rest_length]
    }

    #[inline(always)]
    fn sphere(&self) -> Option<Real> {
        Some(self.rest_length)
    }

    /// `n nᵀ + (1 − L/l)(I − n nᵀ)`, the second part only under tension.
    #[inline]
    fn projected_hessian(&self, [z]: [Vec3; 1]) -> [[Mat3; 1]; 1] {
        let (length, n) = length_and_direction(z, self.vertices);
        [[crate::math::projected_radial_hessian(
            length,
            n,
            self.rest_length,
        )]]
    }
}
