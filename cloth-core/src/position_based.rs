//! What position-based methods have in common: everything around one line.
//!
//! Such a method lets every vertex fly freely, S1 (24), then moves the positions until the constraints agree, S1 (25),
//! and reads the velocities off the positions, S1 (26). The middle is a sweep: every row gets a
//! multiplier Δλ (kg m² per unit of C), and the vertices of the row move by `Δxᵢ = wᵢ ∂C/∂xᵢ Δλ`. How large Δλ is tells one method
//! from another, and it is all that a [`ConstraintUpdate`] says. In which order the rows are visited, and whether a row sees what the one before it
//! did, is the same choice for all methods: [`Sweep`]. So is what is made of a sequence of sweeps: [`Acceleration`].
//!
//! | part | what |
//! |---|---|
//! | [`Motion`] | the flight and the velocities, S1 (24) and (26) |
//! | [`Families`] | the elements of each kind, and the sweep over them |
//! | [`ConstraintUpdate`] | Δλ of one row |
//! | [`Sweep`] | one after another, colour by colour, or all at once |
//! | [`Acceleration`] | relaxation, and Chebyshev extrapolation of the sweeps |
//! | [`Builder`], [`Settings`] | how a solver is put together |
//!
//! Contact that comes as constraints ([`ContactConstraints`](crate::contact::ContactConstraints)) is a part of [`Motion`]: it comes last in each sweep, for every method alike.
//!
//! Because `Σᵢ ∂C/∂xᵢ = 0` for a constraint that a translation leaves alone, a correction does not change `Σ m x`,
//! whatever Δλ is; and because a rotation leaves it alone too, `Σ m x × Δx = 0` (S1 (23)).

mod builder;
mod chebyshev;
mod constraint_update;
mod correction;
mod families;
mod jacobi;
mod motion;
mod sweep;

pub use builder::{Builder, Settings};
pub use chebyshev::{Chebyshev, Radius};
pub use constraint_update::{ConstraintUpdate, RowEquation, RowState, RowView};
pub use families::Families;
pub use motion::Motion;
pub use sweep::{Acceleration, Sweep};
