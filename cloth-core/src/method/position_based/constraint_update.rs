//! The update of one constraint row: the formula for Δλ that distinguishes position-based methods.

use crate::math::{Real, Vec3};
use std::fmt::Debug;

/// The state of one row at the visit of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowState {
    /// `C`, in the unit that the element documents.
    pub value: Real,
    /// `k` with the energy `½ k C²` (J).
    pub stiffness: Real,
    /// `w̃ = Σᵢ wᵢ ‖∂C/∂xᵢ‖²` (unit of C² per kg m²): the generalised inverse mass. Zero if
    /// all its vertices are prescribed, or its gradient vanishes.
    pub weight: Real,
}

/// The linear equation of a row: `(w̃ + scaled_compliance) Δλ = −residual`.
///
/// Δλ (kg m² per unit of C) is the change of the multiplier: the vertices of the row move by `wᵢ ∂C/∂xᵢ Δλ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowEquation {
    /// The residual (unit of C) that Δλ is to bring to zero.
    pub residual: Real,
    /// α̃, added to w̃ (unit of C² per kg m²): not negative, finite; 0 for a hard row. The three rows of a
    /// [`VectorRow`](crate::element::VectorRow), which have one stiffness, have the α̃ of the first.
    pub scaled_compliance: Real,
}

/// One row for read-out: its state, vertices and gradient.
#[derive(Clone, Copy, Debug)]
pub struct RowView<'a, M> {
    /// Number of the row in its family: element after element in the order in which they were given, row after row.
    pub index: usize,
    /// Its state.
    pub row: RowState,
    /// The vertices of its element.
    pub vertices: &'a [u32],
    /// `∂C/∂x` (unit of C per m), one per vertex of the element; of a row with a dead zone ∂φ/∂x, also where it
    /// is inactive.
    pub gradient: &'a [Vec3],
    /// Whether it has a dead zone.
    pub is_limit: bool,
    /// Its memory.
    pub memory: &'a M,
}

/// The formula of a method for Δλ of a row, and the numbers that it keeps of each row.
pub trait ConstraintUpdate: Copy + Debug + Send + Sync + 'static {
    /// The numbers kept of a row from one visit to the next, a multiplier for instance. They start as the default.
    type Memory: Copy + Debug + Default + Send + Sync + 'static;

    /// Whether the rows of one element are solved together, with the products of their gradients, or one after
    /// another.
    const ROWS_TOGETHER: bool = false;

    /// Whether Δλ is accumulated ([`ConstraintUpdate::accumulate`]), and extrapolated with the positions
    /// ([`ConstraintUpdate::extrapolate`]). Asked once a sweep.
    #[inline]
    fn accumulates(&self) -> bool {
        true
    }

    /// The equation of a row. It is called in the innermost loop, and should be `#[inline(always)]`, like
    /// [`ConstraintUpdate::accumulate`]. A row with `w̃ + scaled_compliance` of zero stays as it is, whatever
    /// its residual.
    fn equation(&self, row: RowState, memory: &mut Self::Memory) -> RowEquation;

    /// Sets the memory of a row before the sweeps of a step, and whenever the update has changed.
    #[inline]
    fn prepare(&self, row: RowState, memory: &mut Self::Memory) {
        let _ = (row, memory);
    }

    /// The same of a row with a dead zone ([`DeadZoneRow`](crate::element::DeadZoneRow)).
    #[inline]
    fn prepare_limit(&self, row: RowState, memory: &mut Self::Memory) {
        self.prepare(row, memory);
    }

    /// Resets the memory, at the start of a substep.
    #[inline]
    fn reset(memory: &mut Self::Memory) {
        *memory = Self::Memory::default();
    }

    /// Adds `change` (kg m² per unit of C) to λ: Δλ, or its fraction in a relaxed or averaging sweep.
    #[inline(always)]
    fn accumulate(&self, change: Real, memory: &mut Self::Memory) {
        let _ = (change, memory);
    }

    /// λ (kg m² per unit of C), if the method has one; a row with a dead zone needs it
    /// ([`DeadZoneRow`](crate::element::DeadZoneRow)). Zero, unless the method says so.
    #[inline(always)]
    fn multiplier(memory: &Self::Memory) -> Real {
        let _ = memory;
        0.0
    }

    /// What [`Chebyshev`](super::Chebyshev) does to the memory: `now ← before + ω (now − before)`. Only called
    /// if it [`accumulates`](ConstraintUpdate::accumulates).
    fn extrapolate(now: &mut Self::Memory, before: &Self::Memory, omega: Real) {
        let _ = (now, before, omega);
    }
}

/// The same update without accumulation.
#[derive(Clone, Copy, Debug)]
pub(super) struct WithoutAccumulation<U>(pub(super) U);

impl<U: ConstraintUpdate> ConstraintUpdate for WithoutAccumulation<U> {
    type Memory = U::Memory;

    const ROWS_TOGETHER: bool = U::ROWS_TOGETHER;

    #[inline(always)]
    fn equation(&self, row: RowState, memory: &mut U::Memory) -> RowEquation {
        self.0.equation(row, memory)
    }

    #[inline(always)]
    fn multiplier(memory: &U::Memory) -> Real {
        U::multiplier(memory)
    }
}
