//! What position-based methods have in common: everything around one line.
//!
//! Such a method lets every vertex fly freely, S1 (24), then moves the positions until the constraints agree, S1 (25),
//! and reads the velocities off the positions, S1 (26). The middle is a Gauss–Seidel sweep: row after row gets a
//! multiplier Δλ (kg m² per unit of C), and the vertices of the row move by `Δxᵢ = wᵢ ∂C/∂xᵢ Δλ`. How large Δλ is tells one method
//! from another, and it is all that a [`Rule`] says.
//!
//! | part | what |
//! |---|---|
//! | [`Motion`] | the flight and the velocities, S1 (24) and (26) |
//! | [`Families`] | the elements of each kind, and the sweep over them |
//! | [`Rule`] | Δλ of one row |
//! | [`Builder`], [`Settings`] | how a solver is put together |
//!
//! Because `Σᵢ ∂C/∂xᵢ = 0` for a constraint that a translation leaves alone, a correction does not change `Σ m x`,
//! whatever Δλ is; and because a rotation leaves it alone too, `Σ m x × Δx = 0` (S1 (23)).

mod builder;
mod families;
mod motion;

pub use builder::{Builder, Settings};
pub use families::{Families, RowAt, RowEquation, RowView, Rule};
pub use motion::Motion;

/// In which order a sweep visits the elements of a family.
///
/// Gauss–Seidel depends on the order: the two differ in every iterate, and agree where the sweeps converge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sweep {
    /// In the order given, on one thread.
    Sequential,
    /// Colour by colour (CORE-13), on rayon's threads where a colour is large enough and the feature `parallel` is on. The bits do not depend
    /// on the number of threads.
    #[default]
    Colored,
}
