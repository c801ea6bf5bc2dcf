//! Settings of the solver.

use cloth_core::math::Real;
use cloth_core::method::position_based::{Acceleration, Sweep};

/// Settings of [`XpbdSolver`](crate::XpbdSolver).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct XpbdConfig {
    /// Sweeps over all constraints per substep, at least 1.
    pub iterations: u32,
    /// Substeps per step, at least 1; each is a step of its own of size Δt/substeps, with multipliers that
    /// start at zero.
    pub substeps: u32,
    /// Order of the sweep.
    pub sweep: Sweep,
    /// Relaxation of the corrections and extrapolation of the sweeps, positions and multipliers together.
    pub acceleration: Acceleration,
    /// β (s): a force `−β k Ċ` along every row beside the elastic `−k C` (Rayleigh's form of XPBD's constraint
    /// damping). Zero, the default, costs nothing. A hard row cannot move and is not damped.
    pub damping: Real,
    /// With `Some(τ)` a step that would gain more than a fraction τ (dimensionless, above 0) of the largest energy so
    /// far is repeated with twice as many substeps, up to eight times as many; see
    /// [steps that gain energy](crate#steps-that-gain-energy).
    /// `None`: nothing is computed for it.
    pub energy_gain: Option<Real>,
}

impl Default for XpbdConfig {
    /// Twenty substeps of one coloured sweep, as published (Macklin et al. 2019): for the same number of
    /// sweeps, small steps are nearer to the solution than many iterations. No damping.
    ///
    /// Twenty is no answer for fine meshes: [`SubstepRule`](crate::SubstepRule) chooses the number for a wanted
    /// strain.
    fn default() -> Self {
        Self {
            iterations: 1,
            substeps: 20,
            sweep: Sweep::Colored,
            acceleration: Acceleration::default(),
            damping: 0.0,
            energy_gain: None,
        }
    }
}
