//! Bending by the angle between two triangles, with a rest angle.
//!
//! - E. Grinspun, A. Hirani, M. Desbrun, P. Schröder, "Discrete shells", SCA 2003,
//!   <https://doi.org/10.2312/SCA03/062-067>: the flexural energy `Σ (θₑ − θ̄ₑ)² ‖ē‖/h̄ₑ`, the bars meaning rest. h̄ₑ
//!   is a third of the mean height of the two triangles, so `‖ē‖/h̄ₑ = 3e²/(A₀ + A₁)`.
//! - R. Bridson, S. Marino, R. Fedkiw, "Simulation of clothing with folds and wrinkles", SCA 2003,
//!   <https://doi.org/10.2312/SCA03/028-036>: the force `Fᵢ = kₑ |E|²/(|N₁| + |N₂|) sin(θ/2) uᵢ`, where u₁…u₄ are
//!   `∂θ/∂x`, and the normals N are twice an area long.
//! - R. Tamstorf, E. Grinspun, "Discrete bending forces and their Jacobians", Graphical Models 75 (2013),
//!   <https://doi.org/10.1016/j.gmod.2013.07.001>: the Hessian of θ.

use super::cotangent::on_each_hinge;
use crate::cloth::Elements;
use crate::element::{Constraint, Convexity, Element, Row};
use crate::error::{OutOfRange, finite, number};
use crate::math::{Blocks, Mat3, Real, Vec3, make_semidefinite};
use crate::mesh::TriMesh;
use crate::topology::HingeTable;
use std::f64::consts::{PI, TAU};

/// How the moment of a hinge grows with its angle θ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HingeLaw {
    /// `K (θ − θ₀)`: the energy `½ K (θ − θ₀)²` of Grinspun et al. (2003).
    #[default]
    Angle,
    /// `2K (sin θ/2 − sin θ₀/2)`, the force of Bridson et al. (2003), with edge and areas at rest. To first order it is
    /// the same; a sharp fold resists less. Its energy is `2K (2 cos θ₀/2 − 2 cos θ/2 − (θ − θ₀) sin θ₀/2)`, and
    /// `8K sin² θ/4` of a hinge that is flat at rest.
    HalfSine,
}

/// The energy of a hinge by its angle, after Grinspun et al. (2003), `E = ½ K (θ − θ₀)²` (J), or Bridson et al. (2003);
/// see [`HingeLaw`].
///
/// Four vertices, the edge `x₀ x₁` and the wing tips `x₂` (left of the arrow `x₀ → x₁`) and `x₃`. θ is the signed
/// deviation from flat (rad), positive where the edge is a ridge seen from the front:
///
/// `θ = atan2((n₂ × n₃)·e/‖e‖, n₂·n₃)`, with `e = x₁ − x₀`, `n₂ = e × (x₂ − x₀)`, `n₃ = (x₃ − x₀) × e`.
///
/// One row. By the first law `C = θ − θ₀` (rad), wrapped into [−π, π], so that `E` stays continuous when a wing passes
/// from π to −π; by the second the root of `2E/K`, with the sign of `θ − θ₀`. A tip that moves in the plane of its wing
/// leaves θ as it is. One that moves by δ along the normal turns its wing, and lowers θ, by δ over its height above the
/// edge, which is `‖n₂‖/‖e‖` (twice the area over the base). So `∂θ/∂x₂ = −‖e‖ n₂/‖n₂‖²`, `∂θ/∂x₃ = −‖e‖ n₃/‖n₃‖²`.
/// Rigid motions leave θ as it is, so the ends of the edge have the opposite, by the lever rule: `∂θ/∂x₁ = −t₂ ∂θ/∂x₂ −
/// t₃ ∂θ/∂x₃` and `∂θ/∂x₀ = −(1 − t₂) ∂θ/∂x₂ − (1 − t₃) ∂θ/∂x₃`, with `tᵢ = (xᵢ − x₀)·e/‖e‖²`.
///
/// The Hessian, wing by wing. With `d = x₂ − x₀`, `n = e × d = n₂`, `n̂ = n/‖n‖`, `ê = e/‖e‖`, `t = d·e/‖e‖²` and
/// `g = ∂θ/∂x₂ = −‖e‖ n/‖n‖²`, the derivatives of g and of the part −t g that `x₁` gets are
///
/// ```text
/// ∂g/∂d = −(‖e‖/‖n‖²)(I − 2n̂n̂ᵀ)[e]×                    ∂(−t g)/∂d = −t ∂g/∂d − g eᵀ/‖e‖²
/// ∂g/∂e =  (‖e‖/‖n‖²)(I − 2n̂n̂ᵀ)[d]× − n̂êᵀ/‖n‖          ∂(−t g)/∂e = −t ∂g/∂e − g (d − 2t e)ᵀ/‖e‖²
/// ```
///
/// by `∂n = [e]× ∂d − [d]× ∂e`. Since `∂/∂x₂ = ∂/∂d`, `∂/∂x₁ = ∂/∂e` and `∂/∂x₀ = −∂/∂d − ∂/∂e`, these are two rows of
/// three blocks; the row of `x₀` makes the columns sum to zero. The other wing has the same with `d = x₃ − x₀`,
/// `n = −n₃` and the opposite sign. `∂²θ` is the sum of both.
///
/// Limits: by the first law E has a kink where the angle is opposite to the rest angle, `|θ − θ₀| = π`, and by the
/// second it jumps where a wing passes through the other, `|θ| = π`, unless the hinge is flat at rest. A hinge with a
/// wing of zero area (or an edge of zero length) has no angle; value, gradient and Hessian are then defined to be zero,
/// and the hinge does nothing until its wings have an area again. Near that the gradient grows as one over the height
/// of the wing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DihedralHinge {
    /// Edge `x₀ x₁`, then the wing tips `x₂`, `x₃`.
    pub vertices: [u32; 4],
    /// Rest angle θ₀ (rad).
    pub rest_angle: Real,
    /// K (J, that is N·m, per rad²).
    pub stiffness: Real,
    /// How its moment grows.
    pub law: HingeLaw,
}

impl DihedralHinge {
    /// The coefficient k (N·m) of Grinspun's `k (θ − θ₀)² 3e²/(A₀ + A₁)` that gives a sheet of equilateral triangles
    /// the cylindrical bending rigidity `rigidity` = D (N·m): `k = D/6`.
    #[must_use]
    pub fn grinspun_coefficient(rigidity: Real) -> Real {
        rigidity / 6.0
    }

    /// The same for the coefficient k (N·m) of Bridson's force: `k = 4D`.
    #[must_use]
    pub fn bridson_coefficient(rigidity: Real) -> Real {
        4.0 * rigidity
    }

    /// One element on every hinge of the mesh, for a bending rigidity D (N·m). The shape of the mesh is the rest shape.
    #[must_use]
    pub fn across(mesh: &TriMesh, hinges: &HingeTable, rigidity: Real) -> Vec<Self> {
        let k = Self::grinspun_coefficient(rigidity);
        on_each_hinge(mesh, hinges, |vertices, rest| {
            Self::grinspun(vertices, rest, k)
        })
    }

    /// Grinspun's element with coefficient `k` (N·m), `K = 6 k e²/(A₀ + A₁)`, at rest at `rest` (m). The two triangles
    /// must have an area.
    #[must_use]
    pub fn grinspun(vertices: [u32; 4], rest: &[Vec3; 4], k: Real) -> Self {
        Self {
            vertices,
            rest_angle: angle(rest).unwrap_or(0.0),
            stiffness: 6.0 * k * edge_squared_over_area(rest),
            law: HingeLaw::Angle,
        }
    }

    /// Bridson's element on every hinge of the mesh, for a bending rigidity D (N·m). The shape of the mesh is the rest
    /// shape.
    #[must_use]
    pub fn bridson_across(mesh: &TriMesh, hinges: &HingeTable, rigidity: Real) -> Vec<Self> {
        let k = Self::bridson_coefficient(rigidity);
        on_each_hinge(mesh, hinges, |vertices, rest| {
            Self::bridson(vertices, rest, k)
        })
    }

    /// Bridson's element with coefficient `k` (N·m), by [`HingeLaw::HalfSine`] with `K = k e²/(4(A₀ + A₁))`, at rest at
    /// `rest` (m).
    #[must_use]
    pub fn bridson(vertices: [u32; 4], rest: &[Vec3; 4], k: Real) -> Self {
        Self {
            vertices,
            rest_angle: angle(rest).unwrap_or(0.0),
            stiffness: 0.25 * k * edge_squared_over_area(rest),
            law: HingeLaw::HalfSine,
        }
    }

    /// C (rad) at the angle θ (rad), C′, and C C″.
    fn constraint(&self, angle: Real) -> [Real; 3] {
        match self.law {
            HingeLaw::Angle => [wrapped(angle - self.rest_angle), 1.0, 0.0],
            HingeLaw::HalfSine => half_sine(angle, self.rest_angle),
        }
    }
}

/// C, C′ and C C″ of `C² = 8 (cos a − cos b − (b − a) sin a)`, with a and b half of the rest angle and the angle:
/// `C = (θ − θ₀) √q`, with q as below free of cancellation, `C C′ = 2 (sin b − sin a)` and `C′² + C C″ = cos b`.
fn half_sine(angle: Real, rest_angle: Real) -> [Real; 3] {
    let (a, b) = (0.5 * rest_angle, 0.5 * angle);
    let d = b - a;
    // sin(d/2)/(d/2), and (d − sin d)/d².
    let (sinc, rest) = if d.abs() < 1e-2 {
        let d2 = d * d;
        let sinc = 1.0 - d2 / 24.0 * (1.0 - d2 / 80.0);
        (sinc, d / 6.0 * (1.0 - d2 / 20.0 * (1.0 - d2 / 42.0)))
    } else {
        ((0.5 * d).sin() / (0.5 * d), (d - d.sin()) / (d * d))
    };
    let q = a.cos() * sinc * sinc - 2.0 * a.sin() * rest;
    if q <= 0.0 {
        return [0.0; 3]; // folded up altogether at rest, and now
    }
    let root = q.sqrt();
    let slope = (a + 0.5 * d).cos() * sinc / root;
    [2.0 * d * root, slope, b.cos() - slope * slope]
}

/// `e²/(A₀ + A₁)` (dimensionless).
pub(super) fn edge_squared_over_area(x: &[Vec3; 4]) -> Real {
    let edge = x[1] - x[0];
    let twice = |tip: Vec3| edge.cross(&(tip - x[0])).norm();
    2.0 * edge.norm_squared() / (twice(x[2]) + twice(x[3]))
}

/// θ (rad) in [−π, π], or none where a wing has no area.
pub(super) fn angle(x: &[Vec3; 4]) -> Option<Real> {
    let edge = x[1] - x[0];
    let left = Wing::of(edge, x[2] - x[0])?;
    let right = Wing::of(edge, x[3] - x[0])?;
    Some(turn(&left, &right))
}

/// One triangle of the hinge. `∂θ` is the difference of two parts, each of one wing alone, and so is `∂²θ`.
struct Wing {
    /// e and its length (m).
    edge: Vec3,
    length: Real,
    /// From `x₀` to the tip (m).
    arm: Vec3,
    /// Unit normal `e × d/‖e × d‖`.
    normal: Vec3,
    /// `‖e × d‖` (m²), twice the area.
    twice_area: Real,
    /// Where the foot of the height divides the edge (dimensionless).
    foot: Real,
}

impl Wing {
    /// None where the triangle has no area: its sine at `x₀` is below 10⁻¹⁰, and the direction of its normal is
    /// rounding.
    fn of(edge: Vec3, arm: Vec3) -> Option<Self> {
        let normal = edge.cross(&arm);
        let (squared, e2) = (normal.norm_squared(), edge.norm_squared());
        let zero = 1e-20 * e2 * arm.norm_squared();
        (squared > zero.max(1e-200)).then(|| Self {
            edge,
            length: e2.sqrt(),
            arm,
            normal: normal / squared.sqrt(),
            twice_area: squared.sqrt(),
            foot: arm.dot(&edge) / e2,
        })
    }

    /// This wing's part of `∂θ` at `x₀`, `x₁` and the tip (1/m), for the wing on the left; the right one has the
    /// opposite sign.
    fn gradient(&self) -> [Vec3; 3] {
        let tip = self.normal * (-self.length / self.twice_area);
        [tip * (self.foot - 1.0), tip * -self.foot, tip]
    }

    /// The derivatives of [`Wing::gradient`] by `x₀`, `x₁` and the tip (1/m²): `[row][column]`.
    fn hessian(&self) -> [[Mat3; 3]; 3] {
        let n = self.normal;
        let unit = self.edge / self.length;
        // g = −‖e‖ n/‖n‖², with ∂n = [e]× ∂d − [d]× ∂e.
        let reflect = (Mat3::identity() - n * n.transpose() * 2.0)
            * (self.length / (self.twice_area * self.twice_area));
        let by_arm = -reflect * self.edge.cross_matrix();
        let by_edge = reflect * self.arm.cross_matrix() - n * unit.transpose() / self.twice_area;
        // The end x₁ gets −t g, with t = d·e/e².
        let tip = n * (-self.length / self.twice_area);
        let e2 = self.length * self.length;
        let foot_by_edge = (self.arm - self.edge * (2.0 * self.foot)) / e2;
        let end_by_arm = -by_arm * self.foot - tip * (self.edge / e2).transpose();
        let end_by_edge = -by_edge * self.foot - tip * foot_by_edge.transpose();
        let last = [-by_edge - by_arm, by_edge, by_arm];
        let middle = [-end_by_edge - end_by_arm, end_by_edge, end_by_arm];
        // The three parts of the gradient sum to zero.
        [
            std::array::from_fn(|column| -middle[column] - last[column]),
            middle,
            last,
        ]
    }
}

/// θ from the two wings. The right normal of the formula is `(x₃ − x₀) × e`, minus that of [`Wing`].
fn turn(left: &Wing, right: &Wing) -> Real {
    let sine = -left.normal.cross(&right.normal).dot(&left.edge) / left.length;
    sine.atan2(-left.normal.dot(&right.normal))
}

/// An angle (rad) wrapped into [−π, π].
fn wrapped(angle: Real) -> Real {
    if angle > PI {
        angle - TAU
    } else if angle < -PI {
        angle + TAU
    } else {
        angle
    }
}

impl Element<4> for DihedralHinge {
    const IS_IN_ELEMENTS: bool = true;
    const HAS_NUMERICAL_EIGENVALUES: bool = true;

    #[inline]
    fn vertices(&self) -> [u32; 4] {
        self.vertices
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::Dihedral(all)
    }

    fn check(&self) -> Result<(), OutOfRange> {
        finite("rest angle (rad)", self.rest_angle)?;
        number("stiffness", self.stiffness)?;
        Ok(())
    }
}

impl Constraint<4> for DihedralHinge {
    type Rows = [Row<4>; 1];

    #[inline]
    fn rows(&self, x: &[Vec3; 4]) -> [Row<4>; 1] {
        let mut row = Row {
            value: 0.0,
            gradient: [Vec3::zeros(); 4],
            stiffness: self.stiffness,
        };
        let edge = x[1] - x[0];
        if let (Some(left), Some(right)) =
            (Wing::of(edge, x[2] - x[0]), Wing::of(edge, x[3] - x[0]))
        {
            let [l, r] = [left.gradient(), right.gradient()];
            let [value, slope, _] = self.constraint(turn(&left, &right));
            row.value = value;
            row.gradient = [l[0] - r[0], l[1] - r[1], l[2], -r[2]].map(|g| g * slope);
        }
        [row]
    }

    /// `K C (C′ ∂²θ + C″ ∂θ ∂θᵀ)`, indefinite, with its eigenvalues taken as `convexity` says.
    fn curvature(&self, x: &[Vec3; 4], convexity: Convexity) -> Blocks<4> {
        let mut sum = [[Mat3::zeros(); 4]; 4];
        let edge = x[1] - x[0];
        let (Some(left), Some(right)) = (Wing::of(edge, x[2] - x[0]), Wing::of(edge, x[3] - x[0]))
        else {
            return sum;
        };
        let [value, slope, bend] = self.constraint(turn(&left, &right));
        let force = self.stiffness * value * slope;
        if self.law == HingeLaw::HalfSine {
            let [l, r] = [left.gradient(), right.gradient()];
            let gradient = [l[0] - r[0], l[1] - r[1], l[2], -r[2]];
            for (row, g) in sum.iter_mut().zip(&gradient) {
                for (block, h) in row.iter_mut().zip(&gradient) {
                    *block += g * h.transpose() * (self.stiffness * bend);
                }
            }
        }
        for (wing, places, factor) in [(left, [0, 1, 2], force), (right, [0, 1, 3], -force)] {
            let hessian = wing.hessian();
            for (i, &row) in places.iter().enumerate() {
                for (j, &column) in places.iter().enumerate() {
                    // One wing alone is not symmetric, both together are; halves of both orders make it so to the last
                    // bit.
                    let half = (hessian[i][j] + hessian[j][i].transpose()) * (0.5 * factor);
                    sum[row][column] += half;
                }
            }
        }
        make_semidefinite(&sum, convexity)
    }
}
