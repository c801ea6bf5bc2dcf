//! Settings of the solver.

use crate::stiffness::StiffnessRule;
use cloth_core::method::position_based::{Acceleration, Sweep};

/// Settings of [`PbdSolver`](crate::PbdSolver).
///
/// # How fast sweeps converge
/// The rates of chains of equal masses are [in the chapter](crate#order-of-the-constraints-colours-and-threads). Three
/// more, for linear rows, one an element:
///
/// *Which relaxation is stable in a Gauss–Seidel sweep?* Let `e = x − x*`, where `x*` meets all rows, so that
/// `C = Σ ∂C/∂xᵢ·eᵢ`. A visit that makes ωs times the correction takes `ωs wᵢ ∂C/∂xᵢ C/w̃` from eᵢ, and
/// `‖e‖²_M = Σ mᵢ ‖eᵢ‖²` becomes `‖e‖²_M − ωs (2 − ωs) C²/w̃`. For 0 < ωs < 2 it falls with each visit of a row that is
/// violated, in any order, however many rows share a vertex; so every ω < 2 is stable, whatever s. How fast it falls
/// depends on ω: the best one of a chain is in the chapter.
///
/// *Which relaxation is stable in a Jacobi sweep?* With fractions sⱼ it takes an error e to `e − ω Σ sⱼ Pⱼ e`, ω the
/// relaxation and Pⱼ the projector, orthogonal in the metric of M, onto what row j moves. Since
/// `Σ sⱼ ‖Pⱼ e‖²_M ≤ Σᵢ mᵢ ‖eᵢ‖² Σ sⱼ`, the last sum over the elements at vertex i, the eigenvalues of Σ sⱼ Pⱼ lie
/// between 0 and the largest such sum. Averaged it is at most 1, and every ω < 2 is stable; in full it is
/// at most the number d of elements at one vertex, and ω < 2/d is stable.
///
/// *A heavy end.* A chain of N rigid links of masses m, held at one end, has a mass M ≫ N m at the other. With J =
/// ∂C/∂x the sweeps solve `A λ = b`, A = J W Jᵀ, W the inverse masses, D the diagonal of A. Jacobi's factor μ of an
/// error y has `A y = (1 − μ) D y`, and the slowest y is nearly the same λ in all links, y = (1, …, 1). Such forces
/// cancel at every vertex but the heavy one, so `yᵀA y = 1/M`; D is 1/m, then 2/m for N − 2 links, then 1/m + 1/M, so
/// `yᵀD y ≈ 2 (N − 1)/m`. Their quotient is `1 − μ ≈ m/(2 (N − 1) M)`, and Gauss–Seidel, as for every tridiagonal
/// matrix, leaves `μ² ≈ 1 − m/((N − 1) M)` of the error.
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
