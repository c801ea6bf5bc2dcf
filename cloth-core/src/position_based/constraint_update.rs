//! What tells one position-based method from another.

use crate::math::{Real, Vec3};
use std::fmt::Debug;

/// One row where a sweep meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowState {
    /// `C`, in the unit that the element documents.
    pub value: Real,
    /// `k` with the energy `½ k C²` (J).
    pub stiffness: Real,
    /// `w̃ = Σᵢ wᵢ ‖∂C/∂xᵢ‖²` (unit of C² per kg m²): how easily the row moves. Zero if all its vertices are prescribed, or its gradient vanishes.
    pub weight: Real,
}

/// What a method makes of a row: `(w̃ + scaled_compliance) Δλ = −residual`.
///
/// Δλ (kg m² per unit of C) is how far to go: the vertices of the row move by `wᵢ ∂C/∂xᵢ Δλ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowEquation {
    /// What Δλ is to bring to zero (unit of C).
    pub residual: Real,
    /// What stands beside w̃ (unit of C² per kg m²), not negative, finite.
    pub scaled_compliance: Real,
}

/// One row as it is read out: where it stands, whom it acts on.
#[derive(Clone, Copy, Debug)]
pub struct RowView<'a, M> {
    /// Number of the row in its family: element after element in the order in which they were given, row after row.
    pub index: usize,
    /// Its numbers.
    pub row: RowState,
    /// The vertices of its element.
    pub vertices: &'a [u32],
    /// `∂C/∂x` (unit of C per m), one per vertex of the element; of a row with a dead zone ∂φ/∂x, also where it is free.
    pub gradient: &'a [Vec3],
    /// What is remembered of it.
    pub memory: &'a M,
}

/// How far a method goes along the rows of an element.
pub trait ConstraintUpdate: Copy + Debug + Send + Sync + 'static {
    /// What is remembered of a row from one visit to the next. It starts as the default.
    type Memory: Copy + Debug + Default + Send + Sync + 'static;

    /// Whether the rows of one element are solved together, with the products of their gradients, or one after another.
    const ROWS_TOGETHER: bool = false;

    /// Whether what the rows do is remembered ([`ConstraintUpdate::accumulate`]), as a multiplier is that goes with the positions, and extrapolated with them
    /// ([`ConstraintUpdate::extrapolate`]). Asked once a sweep: one that is not is spared it in every row.
    #[inline]
    fn accumulates(&self) -> bool {
        true
    }

    /// The equation of a row. It stands in the innermost loop, and should be `#[inline(always)]`, like [`ConstraintUpdate::accumulate`]. A row that nothing could change, because `w̃ + scaled_compliance` is zero, stays as it is whatever its residual.
    fn equation(&self, row: RowState, memory: &mut Self::Memory) -> RowEquation;

    /// Learns what it can of a row before the sweeps of a step begin, and again whenever the rule is another one.
    #[inline]
    fn prepare(&self, row: RowState, memory: &mut Self::Memory) {
        let _ = (row, memory);
    }

    /// Makes the memory that of a row not visited yet, at the start of a substep.
    #[inline]
    fn reset(memory: &mut Self::Memory) {
        *memory = Self::Memory::default();
    }

    /// Remembers that a row went along by `change` (kg m² per unit of C): Δλ, or the part of it that a relaxed or an averaging sweep takes.
    #[inline(always)]
    fn accumulate(&self, change: Real, memory: &mut Self::Memory) {
        let _ = (change, memory);
    }

    /// λ (kg m² per unit of C), if the method has one: what a row with a dead zone has done so far ([`DeadZoneRow`](crate::element::DeadZoneRow)). Zero, unless the method says so.
    #[inline(always)]
    fn multiplier(memory: &Self::Memory) -> Real {
        let _ = memory;
        0.0
    }

    /// What [`Chebyshev`](super::Chebyshev) does to the memory: `now ← before + ω (now − before)`. Only called if it [`accumulates`](ConstraintUpdate::accumulates).
    fn extrapolate(now: &mut Self::Memory, before: &Self::Memory, omega: Real) {
        let _ = (now, before, omega);
    }
}

/// The same update, whose rows remember nothing of what they do.
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
