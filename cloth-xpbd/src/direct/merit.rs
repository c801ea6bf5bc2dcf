//! The merit function of the line search.
//!
//! The step is the minimum of `½‖x − x̃‖²_M` plus the energies of the soft rows, subject to the hard ones. For
//! both kinds of row at once we take
//!
//! `φ(x) = ½‖x − x̃‖²_M + Σ ψ(C)`, `ψ(C) = ½ C²/α̃` where `|C| ≤ α̃ μ`, `μ |C| − ½ α̃ μ²` beyond,
//!
//! Huber's function: the elastic energy near its zero, a slope μ beyond. For a hard row it is the exact penalty
//! `μ |C|` (Nocedal & Wright, *Numerical Optimization*, 2006, section 15.4). Stiff rows far from rest do not
//! make a narrow valley of it, and nothing is divided by a compliance of zero. With every μ above the
//! multipliers of the linear system, its solution is a direction of descent: put the two equations of the
//! system into the directional derivative of φ, and it is at most `−Δxᵀ H Δx`.

use super::rows::Rows;
use cloth_core::math::{Real, Vec3};

/// μ is kept above this times the largest multiplier that the row was asked for.
const MARGIN: Real = 1.5;

/// φ of one step.
#[derive(Clone, Debug)]
pub(super) struct Merit {
    /// μ of each row (unit of λ), which only grows in the course of a step.
    slope: Vec<Real>,
}

/// The data of the step that the merit needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scene<'a> {
    /// Masses (kg), 0 for prescribed vertices, which do not count.
    pub(super) mass: &'a [Real],
    /// x̃ (m).
    pub(super) predicted: &'a [Vec3],
    /// α̃ of each row; infinite for rows that do not count.
    pub(super) scaled_compliance: &'a [Real],
}

impl Merit {
    pub(super) fn new(rows: usize) -> Self {
        Self {
            slope: vec![0.0; rows],
        }
    }

    /// Starts a new step: every μ is 0.
    pub(super) fn reset(&mut self) {
        self.slope.fill(0.0);
    }

    /// Raises every μ above the multipliers `l + change`.
    pub(super) fn raise(&mut self, l: &[Real], change: impl Iterator<Item = Real>) {
        for ((slope, l), change) in self.slope.iter_mut().zip(l).zip(change) {
            *slope = slope.max(MARGIN * (l + change).abs());
        }
    }

    /// φ (kg m²) at `x` (m), where the rows have been evaluated. All terms are positive.
    pub(super) fn value(&self, scene: Scene<'_>, x: &[Vec3], rows: &Rows) -> Real {
        let mut inertia = 0.0;
        for ((mass, x), goal) in scene.mass.iter().zip(x).zip(scene.predicted) {
            inertia += 0.5 * mass * (x - goal).norm_squared();
        }
        let mut elastic = 0.0;
        for ((value, a), slope) in rows
            .violation
            .iter()
            .zip(scene.scaled_compliance)
            .zip(&self.slope)
        {
            if *a == Real::INFINITY {
                continue;
            }
            let size = value.abs();
            elastic += if size < a * slope {
                0.5 * size * (size / a)
            } else {
                slope * (size - 0.5 * a * slope)
            };
        }
        inertia + elastic
    }

    /// Rounding error (kg m²) of a `value` of φ on a cloth of `size` (m): each row is known to some ε of the
    /// size of the cloth, and is multiplied by at most its μ.
    pub(super) fn rounding(&self, value: Real, size: Real) -> Real {
        let slopes: Real = self.slope.iter().sum();
        8.0 * Real::EPSILON * (value + size * slopes)
    }

    /// `∂φ/∂x · Δx` (kg m²).
    pub(super) fn slope(
        &self,
        scene: Scene<'_>,
        x: &[Vec3],
        rows: &Rows,
        direction: &[Vec3],
    ) -> Real {
        let mut sum = 0.0;
        for (v, mass) in scene.mass.iter().enumerate() {
            sum += mass * (x[v] - scene.predicted[v]).dot(&direction[v]);
        }
        for row in 0..rows.len() {
            let a = scene.scaled_compliance[row];
            if a == Real::INFINITY {
                continue;
            }
            let change: Real = rows
                .entries(row)
                .map(|e| rows.gradient[e].dot(&direction[rows.vertices[e] as usize]))
                .sum();
            let (value, slope) = (rows.violation[row], self.slope[row]);
            sum += if value == 0.0 {
                // Both sides of the kink of a hard row rise.
                if a == 0.0 { slope * change.abs() } else { 0.0 }
            } else if value.abs() < a * slope {
                value / a * change
            } else {
                slope * value.signum() * change
            };
        }
        sum
    }
}
