//! One description of a material, three views of it: the page that every method reads.
//!
//! An *element* is a small struct with the numbers of its vertices and its rest data: a spring (2 vertices), a
//! hinge (4). What a method can do with it is a trait:
//!
//! | view | what it says | who asks for it |
//! |---|---|---|
//! | [`Energy`] | `E(x)`, `∂E/∂x`, `∂²E/∂x²` | explicit and implicit integration |
//! | [`Constraint`] | rows `C(x)`, `∂C/∂x`, `k` with `E = ½ Σ k C²` | PBD, XPBD |
//! | [`Projective`] | `E = ½ w ‖S x − p‖²`, `p` the nearest point of a set | projective dynamics |
//!
//! A `Constraint` is an `Energy` without further code, by a blanket implementation.
//!
//! # A new element
//!
//! 1. Write a struct with the numbers of its vertices and its rest data, and implement [`Element`] for it.
//! 2. If its energy is `½ Σ k C²`, implement [`Constraint`]: the rows and, unless they are linear
//!    ([`Constraint::ROWS_ARE_LINEAR`]), their [curvature](Constraint::curvature). The default curvature is zero, and
//!    makes every Hessian that of Gauss–Newton. For any other energy implement [`Energy`].
//! 3. If its energy is a squared distance to a set, implement [`Projective`] too.
//! 4. Put it through every function of [`crate::check`], at random shapes, away from rest.
//! 5. Hand a `Vec` of it to [`Energies::with`](crate::method::family::Energies::with), or to `energy` of the builder of
//!    a solver.
//!
//! ```
//! use cloth_core::Vec3;
//! use cloth_core::check::{gradient_error, hessian_error};
//! use cloth_core::element::{Constraint, Element, Row};
//! use cloth_core::method::family::Energies;
//!
//! /// Pulls a vertex to a plane through the origin: `C = n·x` (m).
//! #[derive(Clone, Copy, Debug)]
//! struct NearPlane { vertex: u32, normal: Vec3, stiffness: f64 }    // k in N/m
//!
//! impl Element<1> for NearPlane {
//!     fn vertices(&self) -> [u32; 1] {
//!         [self.vertex]
//!     }
//! }
//!
//! impl Constraint<1> for NearPlane {
//!     type Rows = [Row<1>; 1];
//!     const ROWS_ARE_LINEAR: bool = true;
//!
//!     fn rows(&self, [x]: &[Vec3; 1]) -> [Row<1>; 1] {
//!         [Row { value: self.normal.dot(x), gradient: [self.normal], stiffness: self.stiffness }]
//!     }
//! }
//!
//! let plane = NearPlane { vertex: 0, normal: Vec3::y(), stiffness: 50.0 };
//! let x = [Vec3::new(0.3, -0.2, 1.0)];
//! assert!(gradient_error(&plane, &x, 1.0) < 1e-9 && hessian_error(&plane, &x, 1.0) < 1e-9);
//! let energies = Energies::new(1).with(vec![plane])?;
//! assert!((energies.value(&x) - 0.5 * 50.0 * 0.2 * 0.2).abs() < 1e-12);    // J
//! # Ok::<(), cloth_core::BuildError>(())
//! ```
//!
//! An element of three vertices that is no constraint is an example of `ImplicitBuilder::energy` in `cloth-massspring`.

mod differences;
mod sweep_forms;

pub use sweep_forms::{DeadZoneRow, RowForm, UnitRow, VectorRow};

use crate::cloth::Elements;
use crate::error::OutOfRange;
use crate::math::{Blocks, Mat3, Real, Vec3};
use std::fmt::Debug;

/// One stencil of `N` vertices with its rest data.
pub trait Element<const N: usize>: Copy + Debug + Send + Sync + 'static {
    /// Whether its rest data change with time, so that [`Element::set_time`] has to be called.
    const CHANGES_WITH_TIME: bool = false;

    /// The vertices it touches, in the order that its formulas use. None twice: a builder refuses that.
    fn vertices(&self) -> [u32; N];

    /// Takes on the rest data of a time (s), that of [`State::time`](crate::particles::State::time). A method calls it
    /// with the time at which it takes the forces: mostly the end of a step, or of each substep. Stiffnesses never
    /// change, nor do the vertices. Elements whose rest data are constant leave it out.
    fn set_time(&mut self, time: Real) {
        let _ = time;
    }

    /// Whether its numbers are in their range; every builder asks ([`check_vertices`]). Those of this crate refuse a
    /// stiffness that is not a number and rest data that are not finite. A negative stiffness is left to the methods,
    /// some of which can take it.
    ///
    /// # Errors
    /// The first that is not.
    ///
    /// [`check_vertices`]: crate::method::family::check_vertices
    fn check(&self) -> Result<(), OutOfRange> {
        Ok(())
    }

    /// Whether a preconditioner takes it by [`Convexity::GaussNewton`], whatever is asked for, since its eigenvalues
    /// are found numerically ([`lumped_assembly`](crate::method::family::Energies::lumped_assembly)). Set it only where
    /// that matrix is stiff in every direction in which the Hessian is: not in an [`crate::energy::AreaTriangle`],
    /// which resists motion out of its plane by its curvature alone.
    const HAS_NUMERICAL_EIGENVALUES: bool = false;

    /// Whether its second derivative jumps within reach, as where a dead zone ends: what iterations have learnt of it on
    /// one side is wrong on the other.
    const HAS_JUMPS: bool = false;

    /// Whether [`Elements`] has a case for them, which a builder takes then. Elements of your own leave it out.
    #[doc(hidden)]
    const IS_IN_ELEMENTS: bool = false;

    /// That case.
    #[doc(hidden)]
    #[must_use]
    fn into_elements(all: Vec<Self>) -> Elements {
        unreachable!("there is no case for {all:?}")
    }
}

/// One scalar constraint at one configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<const N: usize> {
    /// `C(x)`, zero at rest, in the unit that the element documents.
    pub value: Real,
    /// `∂C/∂xᵢ`, one per vertex of the element (unit of `C` per m).
    pub gradient: [Vec3; N],
    /// `k` with the energy `½ k C²` (J); the compliance is `α = 1/k`. It must not depend on `x`: forces and Hessians
    /// are computed as `k C ∂C` and `k ∂C ∂Cᵀ + k C ∂²C`, without a derivative of `k`.
    pub stiffness: Real,
}

/// `[Row<N>; M]`: the rows of one element, on the stack. Sealed.
pub trait RowArray<const N: usize>: sealed::Sealed + AsRef<[Row<N>]> + Copy {
    /// How many rows M.
    const LEN: usize;

    /// `[T; M]`: what a method stores for each row, a multiplier for instance.
    type PerRow<T: Copy + Debug + Send + Sync>: AsRef<[T]> + AsMut<[T]> + Copy + Debug + Send + Sync;

    /// The same value for every row.
    fn per_row<T: Copy + Debug + Send + Sync>(value: T) -> Self::PerRow<T>;
}
impl<const N: usize, const M: usize> RowArray<N> for [Row<N>; M] {
    const LEN: usize = M;

    type PerRow<T: Copy + Debug + Send + Sync> = [T; M];

    fn per_row<T: Copy + Debug + Send + Sync>(value: T) -> [T; M] {
        [value; M]
    }
}
mod sealed {
    pub trait Sealed {}
    impl<const N: usize, const M: usize> Sealed for [super::Row<N>; M] {}
}

/// What to do with the negative eigenvalues of an element's Hessian.
///
/// Newton's method needs a direction that goes down; a compressed spring has a Hessian that is indefinite across its
/// axis. A positive semi-definite matrix in its place (PSD projection), plus `M/Δt²`, gives such a direction.
///
/// Of a [`Constraint`] the choice concerns the curvature `Σ k C ∂²C` alone, whose eigenvalues are meant below; the rest
/// of its Hessian, `Σ k ∂C ∂Cᵀ`, is semi-definite by its form. Of any other [`Energy`] it concerns the whole Hessian.
///
/// It is made element by element: a sum of semi-definite matrices is semi-definite, and the eigenvalues of small
/// matrices are cheap. The price: an element is changed also where the sum of all was positive definite already. If one
/// is changed at the minimum, Newton's method converges to it linearly, not quadratically.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Convexity {
    /// Keep them: the true second derivative.
    Exact,
    /// Set them to zero (J. Teran, E. Sifakis, G. Irving, R. Fedkiw, "Robust quasistatic finite elements and flesh
    /// simulation", SCA 2005, <https://doi.org/10.1145/1073368.1073394>).
    #[default]
    Clamp,
    /// Take their absolute value: a matrix that resists leaving the point in every direction in which the energy is
    /// curved (H. Chen et al., "Stabler neo-Hookean simulation: absolute eigenvalue filtering for projected Newton",
    /// SIGGRAPH 2024, <https://arxiv.org/abs/2406.05928>).
    Abs,
    /// Drop the second derivative of the constraint: `Σ k ∂C ∂Cᵀ` alone.
    ///
    /// An energy that is no sum of squares leaves out what corresponds to it. Of
    /// [`CubicShell`](crate::energy::CubicShell) that is the cubic part, where the rest angle is at most 90°. Beyond
    /// that (cos θ₀ < 0) the quadratic part alone would be negative, and the Hessian is taken whole, without its
    /// negative eigenvalues.
    GaussNewton,
}

impl Convexity {
    /// What becomes of one eigenvalue of the curvature `Σ k C ∂²C`, in its unit.
    #[inline]
    #[must_use]
    pub fn applied_to(self, eigenvalue: Real) -> Real {
        match self {
            Self::Clamp => eigenvalue.max(0.0),
            Self::Abs => eigenvalue.abs(),
            Self::Exact => eigenvalue,
            Self::GaussNewton => 0.0,
        }
    }
}

/// Value, gradient and Hessian: all that an explicit or a Newton-type method asks for.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an energy of {N}-vertex elements",
    note = "implement `Constraint<{N}>` (its rows give the energy), or `Energy<{N}>` directly"
)]
pub trait Energy<const N: usize>: Element<N> {
    /// Whether [`Energy::hessian`] is the same at every `x` and for every [`Convexity`]. The Hessians of a family are
    /// then added up once, and never computed again.
    const HESSIAN_IS_CONSTANT: bool = false;

    /// `E(x)` (J).
    fn value(&self, x: &[Vec3; N]) -> Real;

    /// `∂E/∂xᵢ` (N), one per vertex; the force is its negative.
    fn gradient(&self, x: &[Vec3; N]) -> [Vec3; N];

    /// [`Energy::value`] and [`Energy::gradient`]: what the two share is done once.
    #[inline(always)]
    fn value_and_gradient(&self, x: &[Vec3; N]) -> (Real, [Vec3; N]) {
        (self.value(x), self.gradient(x))
    }

    /// `∂²E/∂xᵢ∂xⱼ` (N/m).
    fn hessian(&self, x: &[Vec3; N], convexity: Convexity) -> Blocks<N>;

    /// The Hessian (N/m) at `x` (m), by [`Convexity::Abs`], for *mixed* methods, which have forces as unknowns beside
    /// the positions. Only the quasi-Newton method of `cloth-massspring` uses it, to begin a step.
    ///
    /// In an iteration from `from` to `to` (m) the forces of a mixed method follow the linearised constraint: `k
    /// (C(from) + ∂C(from)·(to − from))`, not `k C(to)`. That is `k C` in the curvature `Σ k C ∂²C` here
    /// ([`Constraint::mixed_curvature`] has the reason), and all else is taken at `x`. An energy that predicts no force
    /// gives its Hessian at `x`.
    #[inline]
    fn mixed_hessian(&self, x: &[Vec3; N], from: &[Vec3; N], to: &[Vec3; N]) -> Blocks<N> {
        let _ = (from, to);
        self.hessian(x, Convexity::Abs)
    }

    /// `∂E/∂xᵢ` (N) and `∂²E/∂xᵢ²` (N/m) of the vertex at `corner` alone, for methods that move one vertex at a time.
    #[inline(always)]
    fn at_corner(&self, x: &[Vec3; N], corner: usize, convexity: Convexity) -> (Vec3, Mat3) {
        (
            self.gradient(x)[corner],
            self.hessian(x, convexity)[corner][corner],
        )
    }

    /// `Σⱼ ∂²E/∂xᵢ∂xⱼ pⱼ` (N), for displacements `p` (m). An element that can do it without the blocks is several times
    /// faster.
    #[inline]
    fn hessian_product(&self, x: &[Vec3; N], p: &[Vec3; N], convexity: Convexity) -> [Vec3; N] {
        multiply(&self.hessian(x, convexity), p)
    }
}

/// Blocks times vectors.
#[inline]
fn multiply<const N: usize>(blocks: &Blocks<N>, p: &[Vec3; N]) -> [Vec3; N] {
    std::array::from_fn(|i| {
        let mut sum = Vec3::zeros();
        for j in 0..N {
            sum += blocks[i][j] * p[j];
        }
        sum
    })
}

/// An energy `E = ½ Σᵣ kᵣ Cᵣ²`, given by its rows: what PBD and XPBD ask for.
///
/// No kᵣ may depend on the positions, or force and energy disagree; what varies with them belongs in Cᵣ.
///
/// Implement it for one `N` only, or the compiler cannot infer `N` where families are added.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no constraint rows for {N} vertices, so position-based methods cannot take it",
    note = "position-based methods need `E = ½ Σ k C²`; implement `Constraint<{N}>`"
)]
pub trait Constraint<const N: usize>: Element<N> {
    /// `[Row<N>; M]`.
    type Rows: RowArray<N>;

    /// Whether the gradients of the rows are the same at every `x`, so that the energy is quadratic;
    /// [`Constraint::curvature`] and [`Constraint::geometric_stiffness`] are then zero.
    const ROWS_ARE_LINEAR: bool = false;

    /// The rows at `x` (m).
    fn rows(&self, x: &[Vec3; N]) -> Self::Rows;

    /// `−Σᵣ λᵣ ∂²Cᵣ/∂x²` (unit of λ times unit of C per m²), made positive semi-definite as `convexity` says: what the
    /// force `Jᵀλ` changes by where the gradients turn, with λ one number per row. It is [`Constraint::curvature`] with
    /// −λ in place of k C, and defined for hard rows too. Zero for [`Convexity::GaussNewton`].
    ///
    /// Unless an element writes its own, it comes from differences of the gradients, to some ten digits.
    fn geometric_stiffness(
        &self,
        x: &[Vec3; N],
        multipliers: &[Real],
        convexity: Convexity,
    ) -> Blocks<N> {
        if Self::ROWS_ARE_LINEAR {
            return [[Mat3::zeros(); N]; N];
        }
        differences::geometric_stiffness(self, x, multipliers, convexity)
    }

    /// The rows at `x` (m) in a form that is faster to sweep, if they have one. It says the same as
    /// [`Constraint::rows`], and leaving it out changes no result beyond rounding.
    #[inline(always)]
    fn row_form(&self, x: &[Vec3; N]) -> RowForm<N> {
        let _ = x;
        RowForm::General
    }

    /// The rows at `x` (m) as they are without their dead zones, if they have such. A dead zone is a range of values in
    /// which a row is zero and nothing acts, such as the lengths that a slack spring leaves free: see [`DeadZoneRow`].
    /// [`Constraint::rows`] are then their [`DeadZoneRow::row`]. An element whose rows vanish beyond one side, a limit
    /// or a contact, has to say so here, or a sweep with multipliers cannot make it inactive again.
    #[inline(always)]
    fn dead_zone_rows(
        &self,
        x: &[Vec3; N],
    ) -> Option<<Self::Rows as RowArray<N>>::PerRow<DeadZoneRow<N>>> {
        let _ = x;
        None
    }

    /// `Σᵣ kᵣ Cᵣ ∂²Cᵣ/∂x²` (N/m), made positive semi-definite as `convexity` says. Never called for
    /// [`Convexity::GaussNewton`]. The default is zero, which is right for linear rows only.
    ///
    /// By [`Convexity::Exact`] it may be indefinite, and the Hessian with it: a compressed spring (C < 0) is so across
    /// its axis. By the others it is semi-definite alone, and so is its sum with `Σᵣ kᵣ ∂Cᵣ ∂Cᵣᵀ`.
    fn curvature(&self, x: &[Vec3; N], convexity: Convexity) -> Blocks<N> {
        let _ = (x, convexity);
        [[Mat3::zeros(); N]; N]
    }

    /// The diagonal block (N/m) of [`Constraint::curvature`] of the vertex at `corner`.
    #[inline(always)]
    fn curvature_at(&self, x: &[Vec3; N], corner: usize, convexity: Convexity) -> Mat3 {
        self.curvature(x, convexity)[corner][corner]
    }

    /// [`Constraint::curvature`] by [`Convexity::Abs`], with the values `C(from) + ∂C(from)·(to − from)` in the place
    /// of `C(x)`. A stiff spring that has turned in an iteration is stretched by far, and its force at `x` says nothing
    /// of the one it ends with; the linear prediction does. An element without a form of its own takes the force at
    /// `x`.
    #[inline]
    fn mixed_curvature(&self, x: &[Vec3; N], from: &[Vec3; N], to: &[Vec3; N]) -> Blocks<N> {
        let _ = (from, to);
        self.curvature(x, Convexity::Abs)
    }

    /// [`Constraint::curvature`] times displacements `p` (m), in N. Called as that is, and never where
    /// [`Constraint::ROWS_ARE_LINEAR`].
    #[inline]
    fn curvature_product(&self, x: &[Vec3; N], p: &[Vec3; N], convexity: Convexity) -> [Vec3; N] {
        multiply(&self.curvature(x, convexity), p)
    }
}

/// An energy `E = ½ w ‖S x − p‖²` with `p` the nearest point of a set: what projective dynamics
/// asks for.
///
/// The gradient is `w Sᵀ(S x − p)`, because the nearest point moves at right angles to the difference.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a squared distance to a set, so projective dynamics cannot take it",
    note = "projective dynamics needs `E = ½ w ‖Sx − p‖²` with a constant S; implement `Projective<{N}, {K}>`"
)]
pub trait Projective<const N: usize, const K: usize>: Element<N> {
    /// Whether [`Projective::project`] returns the same points for every `z`. The energy is then quadratic, and
    /// a solver may add its part once a step instead of once an iteration.
    const PROJECTION_IS_CONSTANT: bool = false;

    /// `S`: `K` rows of vertex coefficients, constant for the life of the element. Each row acts on x, y and z alike.
    fn operator(&self) -> [[Real; N]; K];

    /// `w`, in the unit that makes `½ w ‖S x‖²` a J.
    fn weight(&self) -> Real;

    /// The nearest point of the set to `z = S x`.
    fn project(&self, z: [Vec3; K]) -> [Vec3; K];

    /// The radius r (unit of `z`) if the set is the sphere `‖z‖ = r` and `K` is 1, so that `p = r z/‖z‖`: a solver may
    /// then project several elements at once. It may keep r, so give one only if it never changes.
    /// [`Projective::project`] says what happens at `z = 0`.
    #[inline(always)]
    fn sphere(&self) -> Option<Real> {
        None
    }

    /// How the distance resists a change of `z`: `I − ∂p/∂z` in 3 × 3 blocks (dimensionless), with the absolute values
    /// of its eigenvalues, and 1 where one is below −1 ([`absolute_up_to_one`](crate::math::absolute_up_to_one)). So
    /// `w Sᵀ (I − ∂p/∂z) S` is the Hessian under [`Convexity::Abs`], as long as nothing is shorter than half of its
    /// length at rest.
    ///
    /// The identity, which it is by default, bounds it from above: exact where the projection is constant, as stiff in
    /// all directions elsewhere.
    fn projected_hessian(&self, z: [Vec3; K]) -> [[Mat3; K]; K] {
        let _ = z;
        std::array::from_fn(|k| {
            std::array::from_fn(|l| {
                if k == l {
                    Mat3::identity()
                } else {
                    Mat3::zeros()
                }
            })
        })
    }
}

/// `sum + Σ k ∂C ∂Cᵀ`.
#[inline(always)]
fn add_gauss_newton<const N: usize>(mut sum: Blocks<N>, rows: &[Row<N>]) -> Blocks<N> {
    for row in rows {
        for i in 0..N {
            let scaled = row.gradient[i] * row.stiffness;
            for j in 0..N {
                sum[i][j] += scaled * row.gradient[j].transpose();
            }
        }
    }
    sum
}

/// The line where a constraint becomes an energy: `E = ½ Σ k C²`, `∂E = Σ k C ∂C`,
/// `∂²E = Σ k ∂C ∂Cᵀ + Σ k C ∂²C`.
impl<const N: usize, C: Constraint<N>> Energy<N> for C {
    const HESSIAN_IS_CONSTANT: bool = C::ROWS_ARE_LINEAR;

    #[inline]
    fn value(&self, x: &[Vec3; N]) -> Real {
        let rows = self.rows(x);
        let sum: Real = rows
            .as_ref()
            .iter()
            .map(|row| row.stiffness * row.value * row.value)
            .sum();
        0.5 * sum
    }

    #[inline]
    fn gradient(&self, x: &[Vec3; N]) -> [Vec3; N] {
        let mut sum = [Vec3::zeros(); N];
        for row in self.rows(x).as_ref() {
            for i in 0..N {
                sum[i] += row.gradient[i] * (row.stiffness * row.value);
            }
        }
        sum
    }

    #[inline(always)]
    fn value_and_gradient(&self, x: &[Vec3; N]) -> (Real, [Vec3; N]) {
        let form = self.row_form(x);
        if let RowForm::Unit(row) = form {
            let force = row.stiffness * row.value;
            let mut gradient = row.direction;
            gradient.iter_mut().for_each(|g| *g *= force / row.length);
            return (0.5 * force * row.value, gradient);
        }
        if let RowForm::Vector(row) = form {
            let value = row.value(x);
            let force = value * row.stiffness;
            let mut gradient = [force; N];
            for i in 0..N {
                gradient[i] *= row.coefficients[i];
            }
            return (0.5 * force.dot(&value), gradient);
        }
        let (mut twice, mut sum) = (0.0, [Vec3::zeros(); N]);
        for row in self.rows(x).as_ref() {
            let force = row.stiffness * row.value;
            twice += force * row.value;
            for i in 0..N {
                sum[i] += row.gradient[i] * force;
            }
        }
        (0.5 * twice, sum)
    }

    #[inline(always)]
    fn hessian(&self, x: &[Vec3; N], convexity: Convexity) -> Blocks<N> {
        let curvature = match convexity {
            Convexity::GaussNewton => [[Mat3::zeros(); N]; N],
            _ => self.curvature(x, convexity),
        };
        add_gauss_newton(curvature, self.rows(x).as_ref())
    }

    #[inline(always)]
    fn mixed_hessian(&self, x: &[Vec3; N], from: &[Vec3; N], to: &[Vec3; N]) -> Blocks<N> {
        add_gauss_newton(self.mixed_curvature(x, from, to), self.rows(x).as_ref())
    }

    #[inline(always)]
    fn at_corner(&self, x: &[Vec3; N], corner: usize, convexity: Convexity) -> (Vec3, Mat3) {
        if let RowForm::Vector(row) = self.row_form(x) {
            let scaled = row.stiffness * row.coefficients[corner];
            let hessian = Mat3::from_diagonal_element(scaled * row.coefficients[corner]);
            return (row.value(x) * scaled, hessian);
        }
        let curvature = match convexity {
            _ if C::ROWS_ARE_LINEAR => Mat3::zeros(),
            Convexity::GaussNewton => Mat3::zeros(),
            _ => self.curvature_at(x, corner, convexity),
        };
        let (mut gradient, mut hessian) = (Vec3::zeros(), curvature);
        for row in self.rows(x).as_ref() {
            let scaled = row.gradient[corner] * row.stiffness;
            gradient += scaled * row.value;
            hessian += scaled * row.gradient[corner].transpose();
        }
        (gradient, hessian)
    }

    /// `Σ k ∂C (∂C·p)`, and what the curvature adds: no blocks of 3 × 3 where the rows are linear.
    #[inline]
    fn hessian_product(&self, x: &[Vec3; N], p: &[Vec3; N], convexity: Convexity) -> [Vec3; N] {
        let mut sum = match convexity {
            _ if C::ROWS_ARE_LINEAR => [Vec3::zeros(); N],
            Convexity::GaussNewton => [Vec3::zeros(); N],
            _ => self.curvature_product(x, p, convexity),
        };
        for row in self.rows(x).as_ref() {
            let mut change = 0.0;
            for j in 0..N {
                change += row.gradient[j].dot(&p[j]);
            }
            for i in 0..N {
                sum[i] += row.gradient[i] * (row.stiffness * change);
            }
        }
        sum
    }
}
