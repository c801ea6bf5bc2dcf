//! Settings of the direct solver.

use cloth_core::math::Real;

/// How the linear system of an iteration is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum System {
    /// Primal–dual: positions and multipliers together, `[H Jᵀ; J −α̃]`, by a factorisation `L D Lᵀ`.
    #[default]
    SaddleLdlt,
    /// The same matrix by MINRES, preconditioned by its diagonal blocks.
    SaddleMinres,
    /// Dual: the multipliers alone, `J H⁻¹ Jᵀ + α̃`, by sparse Cholesky. H is made block-diagonal by an upper
    /// bound, which is exact without geometric stiffness and takes more iterations with it.
    SchurCholesky,
    /// The same matrix by conjugate gradients.
    SchurConjugateGradients,
}

impl System {
    /// Whether the positions are eliminated first.
    pub(super) fn is_dual(self) -> bool {
        matches!(self, Self::SchurCholesky | Self::SchurConjugateGradients)
    }
}

/// Where the iteration starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DirectStart {
    /// At the positions before the step.
    Previous,
    /// At the inertial prediction x̃, as XPBD does.
    #[default]
    Predicted,
}

/// Settings of [`DirectXpbd`](super::DirectXpbd).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectConfig {
    /// Substeps per step, at least 1; each is a step of its own, with contact at its end.
    pub substeps: u32,
    /// The linear system and its solver.
    pub system: System,
    /// Whether `−Σ λ ∂²C`, the change of the forces where the gradients turn, is added to the mass, its
    /// negative part dropped (Tournier et al. 2015).
    pub geometric_stiffness: bool,
    /// Where the iteration starts.
    pub start: DirectStart,
    /// Whether λ, and with it the first geometric stiffness, starts from the end of the last step. If not, λ
    /// starts at zero, and a step depends on the state alone.
    pub warm_start: bool,
    /// Most iterations per step, at least 1.
    pub max_iterations: u32,
    /// A step is done when an iteration, taken whole, moves no vertex by more than this part of the size of the
    /// cloth (dimensionless).
    pub tolerance: Real,
    /// Whether an iteration may be shortened. Without, every one is taken whole.
    pub line_search: bool,
    /// β (s), as in [`XpbdConfig`](crate::XpbdConfig).
    pub damping: Real,
    /// Relative residual at which MINRES and conjugate gradients stop.
    pub krylov_tolerance: Real,
    /// Most iterations of MINRES and conjugate gradients per linear solve, at least 1.
    pub max_krylov: u32,
}

impl Default for DirectConfig {
    /// To convergence, from x̃, on the primal–dual matrix.
    fn default() -> Self {
        Self {
            substeps: 1,
            system: System::default(),
            geometric_stiffness: true,
            start: DirectStart::default(),
            warm_start: false,
            max_iterations: 200,
            tolerance: 1e-10,
            line_search: true,
            damping: 0.0,
            krylov_tolerance: 1e-12,
            max_krylov: 2000,
        }
    }
}

impl DirectConfig {
    /// One linear solve a step, from the positions before it and the multipliers of the last step: stable
    /// constrained dynamics (Tournier et al. 2015). Without `geometric_stiffness` it is the plain linearised
    /// form, the compliant system of Servin et al. 2006.
    #[must_use]
    pub fn linearized() -> Self {
        Self {
            start: DirectStart::Previous,
            warm_start: true,
            max_iterations: 1,
            line_search: false,
            ..Self::default()
        }
    }
}
