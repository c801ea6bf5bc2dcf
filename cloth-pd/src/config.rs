//! Settings.

use cloth_core::math::Real;
use cloth_core::step::BuildError;

/// Settings of [`PdSolver`](crate::PdSolver).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PdConfig {
    /// Local–global iterations in a step: exactly as many without a tolerance, at most as many with one; at least 1.
    /// Stiff cloth wants many more than the ten of the default, see the limits in the [crate documentation](crate).
    pub iterations: u32,
    /// With `Some(τ)` the iteration ends as soon as `‖∇G(x)‖ ≤ τ ‖∇G(x̃)‖` in the norm of M⁻¹ (τ dimensionless), and the
    /// report has that ratio as its residual. `None`: nothing is computed for it.
    pub tolerance: Option<Real>,
    /// Where the iteration starts.
    pub start: Start,
}

/// Where the iteration starts, S1 (34). A prescribed vertex is where it will be at the end of the step, in any case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Start {
    /// `x[0]`, the positions before the step.
    Previous,
    /// `x̃`, called `s` in S1 (33): where the vertices would go without elasticity.
    #[default]
    Predicted,
}

impl Default for PdConfig {
    fn default() -> Self {
        Self {
            iterations: 10,
            tolerance: None,
            start: Start::Predicted,
        }
    }
}

impl PdConfig {
    /// Whether every setting lies in its range.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        if self.iterations == 0 {
            return Err(BuildError::InvalidSetting {
                name: "iterations",
                value: 0.0,
                range: "at least 1",
            });
        }
        match self.tolerance {
            Some(tolerance) if !(tolerance >= 0.0 && tolerance.is_finite()) => {
                Err(BuildError::InvalidSetting {
                    name: "tolerance",
                    value: tolerance,
                    range: "zero or a positive finite number",
                })
            }
            _ => Ok(()),
        }
    }
}
