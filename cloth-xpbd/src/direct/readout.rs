//! Residuals, multipliers and forces of the last step.

use super::solver::DirectXpbd;
use cloth_core::math::{Real, Vec3};

/// Residuals of the two equations after the last step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residuals {
    /// Largest `|C + α̃λ|` of a row (unit of C; m for springs and hinges).
    pub compliance: Real,
    /// `‖M (x − x̃)/h² − Jᵀλ/h²‖` in the norm of M⁻¹ (N/√kg).
    pub momentum: Real,
}

impl DirectXpbd {
    /// Numbers stored in the factor; 0 for a Krylov method.
    #[must_use]
    pub fn factor_len(&self) -> usize {
        self.solver.factor_len()
    }

    /// The shift (dimensionless: the diagonal is 1) added to the diagonal of every row in the factor of the
    /// last iteration, so that dependent hard rows do not make the matrix singular. It changes how fast a step
    /// converges, not its limit.
    #[must_use]
    pub fn regularization(&self) -> Real {
        self.solver.shift()
    }

    /// The residuals of the last step; zero before the first.
    #[must_use]
    pub fn residuals(&self) -> Residuals {
        self.residuals
    }

    /// Writes the multipliers λ (kg m² per unit of C; kg m for springs and hinges) of the last step to `out`:
    /// those of the family that was added as number `family` (from 0), element after element in the order
    /// given, row after row. Zero before the first step and after one that failed.
    ///
    /// # Panics
    /// If there is no such family.
    pub fn multipliers_into(&self, family: usize, out: &mut Vec<Real>) {
        let first: usize = self.families[..family].iter().map(|f| f.row_count()).sum();
        let count = self.families[family].row_count();
        out.clear();
        out.extend_from_slice(&self.multipliers[first..first + count]);
    }

    /// Writes `Σ Jᵀλ/h²` (N) over all constraints to `out`, one per vertex, as
    /// [`XpbdSolver::vertex_forces_into`](crate::XpbdSolver::vertex_forces_into) does.
    ///
    /// # Panics
    /// If `out` does not have one entry per vertex.
    pub fn vertex_forces_into(&self, out: &mut [Vec3]) {
        assert_eq!(out.len(), self.mass.len(), "one force per vertex");
        out.fill(Vec3::zeros());
        let Some(update) = self.last else {
            return;
        };
        for (row, &multiplier) in self.multipliers.iter().enumerate() {
            for e in self.rows.entries(row) {
                let force = self.rows.gradient[e] * update.force(multiplier);
                out[self.rows.vertices[e] as usize] += force;
            }
        }
    }
}
