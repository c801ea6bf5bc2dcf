//! Settings of the solver.

use crate::stiffness::StiffnessRule;
use cloth_core::method::position_based::{Acceleration, Sweep};

/// Settings of [`PbdSolver`](crate::PbdSolver).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PbdConfig {
    /// Sweeps over all constraints per substep, at least 1.
    pub iterations: u32,
    /// Substeps per step, at least 1; each is a step of its own of size Δt/substeps.
    pub substeps: u32,
    /// Order of the sweep.
    pub sweep: Sweep,
    /// Relaxation of the corrections and extrapolation of the sweeps. A constraint alone has its stiffness only
    /// without both.
    pub acceleration: Acceleration,
    /// How the stiffness of a projection follows from that of the material.
    pub stiffness: StiffnessRule,
}

impl Default for PbdConfig {
    /// One substep of 20 coloured sweeps, neither relaxed nor extrapolated, stiffness from the material. On fine and
    /// stiff cloth that is far too little: see [when not to use PBD](crate#when-not-to-use-this-method).
    fn default() -> Self {
        Self {
            iterations: 20,
            substeps: 1,
            sweep: Sweep::Colored,
            acceleration: Acceleration::default(),
            stiffness: StiffnessRule::Material,
        }
    }
}
