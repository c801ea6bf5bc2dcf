//! How far to go along the direction of an iteration.

use super::merit::Scene;
use super::solver::DirectXpbd;
use cloth_core::math::{Real, Vec3};
use cloth_core::step::StepReport;

/// Part of the promised decrease that has to be kept (Armijo's constant).
const SUFFICIENT: Real = 1e-4;
/// Step lengths tried before giving up, each half of the one before.
const MOST_TRIALS: u32 = 40;

impl DirectXpbd {
    /// Takes the first of Δ, Δ with a second-order correction, Δ/2, Δ/4, … that makes the merit fall enough; `None` if none does.
    pub(super) fn search(&mut self, size: Real, report: &mut StepReport) -> Option<()> {
        let changes = self.change.l.iter().zip(&self.kkt.row_scale);
        self.merit
            .raise(&self.multipliers, changes.map(|(l, scale)| l * scale));
        let scene = Scene {
            mass: &self.mass,
            predicted: &self.predicted,
            softness: &self.softness,
        };
        let start = self.merit.value(scene, &self.positions, &self.rows);
        let slope = self
            .merit
            .slope(scene, &self.positions, &self.rows, &self.direction);
        let rounding = self.merit.rounding(start, size);
        let bound = |length: Real| start + SUFFICIENT * length * slope.min(0.0) + rounding;
        let mut length = 1.0;
        for _ in 0..MOST_TRIALS {
            self.try_length(length);
            if self.trial_merit() <= bound(length) {
                self.accept();
                return Some(());
            }
            if length == 1.0 {
                self.correct();
                if self.trial_merit() <= bound(1.0) {
                    self.accept();
                    return Some(());
                }
            }
            report.backtracks += 1;
            length *= 0.5;
        }
        None
    }

    fn trial_merit(&self) -> Real {
        let scene = Scene {
            mass: &self.mass,
            predicted: &self.predicted,
            softness: &self.softness,
        };
        self.merit.value(scene, &self.trial, &self.rows)
    }

    /// Puts `x + t Δx`, `λ + t Δλ` in the place to try, and evaluates the rows there.
    pub(super) fn try_length(&mut self, t: Real) {
        let moved = self.positions.iter().zip(&self.direction);
        for (trial, (x, d)) in self.trial.iter_mut().zip(moved) {
            *trial = x + d * t;
        }
        for row in 0..self.rows.len() {
            let change = self.kkt.row_scale[row] * self.change.l[row];
            self.trial_multipliers[row] = self.multipliers[row] + t * change;
        }
        self.evaluate_trial();
    }

    /// Adds to the place to try what the matrix says of the curvature of the rows that it did not see: without it a hard row that turns keeps whole
    /// steps from being accepted.
    fn correct(&mut self) {
        self.right.x.fill(Vec3::zeros());
        for row in 0..self.rows.len() {
            let scale = self.kkt.row_scale[row];
            self.right.l[row] = if scale > 0.0 {
                let softness = self.softness[row] * self.trial_multipliers[row];
                -scale * (self.rows.value[row] + softness)
            } else {
                0.0
            };
        }
        self.solver
            .solve(&self.kkt, &self.right, &mut self.correction);
        for (v, trial) in self.trial.iter_mut().enumerate() {
            *trial += self.correction.x[v] * self.kkt.vertex_scale[v];
        }
        for row in 0..self.rows.len() {
            self.trial_multipliers[row] += self.kkt.row_scale[row] * self.correction.l[row];
        }
        self.evaluate_trial();
    }

    pub(super) fn accept(&mut self) {
        std::mem::swap(&mut self.positions, &mut self.trial);
        std::mem::swap(&mut self.multipliers, &mut self.trial_multipliers);
    }
}
