//! The common part of position-based methods: inertial prediction, sweeps over constraint rows, velocities from
//! positions.
//!
//! Such a method predicts positions by inertia, `v ← v + h a`, `x ← x + h v`, then moves them until the
//! constraints agree, and takes the velocities from the positions, `v ← v + (x − x̃)/h` (Müller et al. 2007,
//! Algorithm 1). The middle is a sweep: every row gets a multiplier Δλ (kg m² per unit of C), and the vertices
//! of the row move by `Δxᵢ = wᵢ ∂C/∂xᵢ Δλ`. The formula for Δλ is what distinguishes the methods:
//! [`ConstraintUpdate`]. In which order the rows are visited, and whether a row sees what the one before it
//! moved, is the same choice for all methods: [`Sweep`]. So is the extrapolation of a sequence of sweeps:
//! [`Acceleration`].
//!
//! | part | what |
//! |---|---|
//! | [`Motion`] | the flight and the velocities |
//! | [`Families`] | the elements of each kind, and the sweep over them |
//! | [`ConstraintUpdate`] | Δλ of one row |
//! | [`Sweep`] | sequential or coloured Gauss–Seidel, or Jacobi |
//! | [`Acceleration`] | relaxation, and Chebyshev extrapolation of the sweeps |
//! | [`FamilyPlans`] | for the builder of such a solver: constraints before their order is known |
//!
//! Contact constraints ([`ContactConstraints`](crate::contact::ContactConstraints)) are a part of [`Motion`]:
//! they come last in each sweep, for every method alike.
//!
//! Because `Σᵢ ∂C/∂xᵢ = 0` for a constraint that is invariant under translation, a correction does not change
//! `Σ m x`, whatever Δλ is; and if it is invariant under rotation too, `Σ m x × Δx = 0` (Müller et al. 2007,
//! section 3.3). Both hold as long as no vertex of the row is prescribed: such a vertex takes no part in the
//! correction.
//!
//! M. Müller, B. Heidelberger, M. Hennix, J. Ratcliff, "Position based dynamics", J. Vis. Commun. Image
//! Represent. 18(2), 2007, <https://doi.org/10.1016/j.jvcir.2007.01.005>.

mod builder;
mod chebyshev;
mod constraint_update;
mod correction;
mod families;
mod jacobi;
mod motion;
mod sweep;

pub use builder::{FamilyPlans, check_counts};
pub use chebyshev::{Chebyshev, Radius};
pub use constraint_update::{ConstraintUpdate, RowEquation, RowState, RowView};
pub use families::Families;
pub use motion::Motion;
pub use sweep::{Acceleration, Sweep};
