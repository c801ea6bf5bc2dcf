//! Limits on elements of one kind, and the projection of one element.

use super::StretchRange;
use cloth_core::element::{Constraint, Element};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::coloring::Colored;
use std::fmt::Debug;

/// All limits on elements of one type; one virtual call a pass.
pub(super) trait AnyLimits: Debug + Send + Sync {
    /// One projection of each element. Gives the largest violation met (dimensionless).
    fn pass(&mut self, inverse_mass: &[Real], tolerance: Real, x: &mut [Vec3]) -> Real;
}

/// Elements with their violations in the last pass.
#[derive(Debug)]
pub(super) struct Limits<const N: usize, E> {
    limits: Colored<N, Limit<E>>,
    violations: Vec<Real>,
}

impl<const N: usize, E: Constraint<N>> Limits<N, E> {
    pub(super) fn new(limits: &[Limit<E>], vertex_count: usize) -> Self {
        Self {
            violations: vec![0.0; limits.len()],
            limits: Colored::new(limits, vertex_count),
        }
    }
}

impl<const N: usize, E: Constraint<N>> AnyLimits for Limits<N, E> {
    fn pass(&mut self, inverse_mass: &[Real], tolerance: Real, x: &mut [Vec3]) -> Real {
        self.limits
            .sweep(&mut self.violations, x, |limit, violation, x| {
                let w = limit.vertices().map(|v| inverse_mass[v as usize]);
                *violation = limit.project(&w, tolerance, x);
            });
        self.violations.iter().copied().fold(0.0, Real::max)
    }
}

/// An element with the values that its rows `C = size − rest size` may have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limit<E> {
    element: E,
    low: Real,
    high: Real,
    rest: Real,
}

impl<E> Limit<E> {
    /// `rest` in the unit of the rows.
    pub(super) fn new(element: E, rest: Real, range: StretchRange) -> Self {
        Self {
            element,
            low: (range.min - 1.0) * rest,
            high: (range.max - 1.0) * rest,
            rest,
        }
    }

    fn excess(&self, value: Real) -> Real {
        value - value.max(self.low).min(self.high)
    }

    /// Brings the rows that are beyond their interval by more than the tolerance to its end. Gives the largest
    /// violation (dimensionless).
    fn project<const N: usize>(&self, w: &[Real; N], tolerance: Real, x: &mut [Vec3; N]) -> Real
    where
        E: Constraint<N>,
    {
        let mut moved = [Vec3::zeros(); N];
        let mut violation: Real = 0.0;
        for row in self.element.rows(x).as_ref() {
            let beyond = self.excess(row.value).abs() / self.rest;
            violation = violation.max(beyond);
            let weight: Real = (0..N).map(|i| w[i] * row.gradient[i].norm_squared()).sum();
            if beyond > tolerance && weight > 0.0 {
                // The change by the rows before this one, to first order.
                let change: Real = (0..N).map(|i| row.gradient[i].dot(&moved[i])).sum();
                let multiplier = -self.excess(row.value + change) / weight;
                for i in 0..N {
                    moved[i] += row.gradient[i] * (w[i] * multiplier);
                }
            }
        }
        for i in 0..N {
            x[i] += moved[i];
        }
        violation
    }
}

impl<const N: usize, E: Constraint<N>> Element<N> for Limit<E> {
    fn vertices(&self) -> [u32; N] {
        self.element.vertices()
    }
}
