//! Backtracking line search with a second-order correction.

use super::merit::Scene;
use super::solver::DirectXpbd;
use cloth_core::math::{Real, Vec3};
use cloth_core::step::StepReport;

/// Armijo's constant: the fraction of the predicted decrease that has to be reached.
const ARMIJO: Real = 1e-4;
/// Step lengths tried before giving up, each half of the one before.
const MAX_TRIALS: u32 = 40;

impl DirectXpbd {
    /// Takes the first of Δ, Δ with a second-order correction, Δ/2, Δ/4, … that makes the merit fall enough;
    /// `None` if none does.
    pub(super) fn line_search(&mut self, size: Real, report: &mut StepReport) -> Option<()> {
        let changes = self.change.l.iter().zip(&self.kkt.row_scale);
        self.merit
            .raise(&self.multipliers, changes.map(|(l, scale)| l * scale));
        let scene = Scene {
            mass: &self.mass,
            predicted: &self.predicted,
            scaled_compliance: &self.scaled_compliance,
        };
        let start = self.merit.value(scene, &self.positions, &self.rows);
        let slope = self
            .merit
            .slope(scene, &self.positions, &self.rows, &self.direction);
        let rounding = self.merit.rounding(start, size);
        let bound = |length: Real| start + ARMIJO * length * slope.min(0.0) + rounding;
        let mut length = 1.0;
        for _ in 0..MAX_TRIALS {
            self.try_length(length);
            if self.trial_merit() <= bound(length) {
                self.accept();
                return Some(());
            }
            if length == 1.0 {
                self.second_order_correction();
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
            scaled_compliance: &self.scaled_compliance,
        };
        self.merit.value(scene, &self.trial, &self.rows)
    }

    /// Makes `x + t Δx`, `λ + t Δλ` the trial point, and evaluates the rows there.
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

    /// Corrects the trial point for the curvature of the rows, by one more solve with the rows evaluated there
    /// (Nocedal & Wright 2006, section 15.6). Without it a hard row that turns keeps full steps from being
    /// accepted: the Maratos effect.
    fn second_order_correction(&mut self) {
        self.right.x.fill(Vec3::zeros());
        for row in 0..self.rows.len() {
            let scale = self.kkt.row_scale[row];
            self.right.l[row] = if scale > 0.0 {
                let compliant = self.scaled_compliance[row] * self.trial_multipliers[row];
                -scale * (self.rows.value[row] + compliant)
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
