//! The linear system `(M/s² + H) Δx = −∇G`, kept positive definite; s is the time of the stage, Δt in implicit Euler
//! without drag. (Stiffness damping and the resistance of the air add their own terms.)
//!
//! Where springs are compressed the exact `H` can make the matrix indefinite, and a Newton step may lead uphill. The
//! usual cure, dropping the indefinite part of every element ([`Convexity::Clamp`]), always works and is always
//! paid for: convergence becomes linear, and near a saddle point (a compressed sheet that has not buckled yet) Newton's
//! method converges *to the saddle*. We therefore drop no more than necessary: the matrix is
//!
//! ```text
//! M/s² + b H_exact + (1 − b) H_clamped,    0 ≤ b ≤ 1
//! ```
//!
//! with the blend `b` as near to 1 as positive definiteness allows. A Cholesky factorisation detects an indefinite
//! matrix always (a pivot is not positive), conjugate gradients if they meet a direction of negative curvature. Near a
//! minimum `b = 1` and convergence is quadratic. Near a saddle the blended matrix is almost singular along the way
//! down, so the step along it is long, and the saddle is left within a few iterations.
//!
//! **Why no trust region.** Its step, the minimum of `∇G·p + ½ pᵀA p` over `‖p‖_M ≤ r`, solves `(A + λM) p = −∇G` with
//! a λ ≥ 0 that makes `A + λM` positive semi-definite, and 0 unless `‖p‖_M = r` (Nocedal and Wright, *Numerical
//! Optimization*, 2006, theorem 4.1, in the norm of M). With `A = M/s² + H` this is the matrix of a shorter time,
//! `1/s² + λ` for `1/s²`. So a few compressed springs would hold back the whole cloth, falling and turning too, whereas
//! the blend changes their own blocks only. The price in factorisations is the same: one for each λ, as for each b. In
//! contact the displacement is bounded, without a change of its direction
//! ([`TrustRadius`](cloth_core::method::trust::TrustRadius)).
//!
//! **Buckling and the step.** Flat cloth under the pressure N (N/m) with the deflection w moves by
//! `ρ ∂²w/∂t² = −N ∂²w/∂X² − D ∂⁴w/∂X⁴`: a wave of number ξ grows like `e^(σt)`, `ρσ² = Nξ² − Dξ⁴`. So it grows where
//! `N > Dξ²` (Euler's load, `π²D/ℓ²` for a strip hinged at both ends of its length ℓ), fastest at `ξ² = N/(2D)`, with
//! `σ² = N²/(4ρD)`. Implicit Euler beside the flat state, with `S = Δt σ`, has `(1 − S²) w[1] = 2w[0] − w[−1]`, hence
//! the factors `1/(1 − S)` and `1/(1 + S)` a step:
//! - `S < 1`: the flat state is a minimum of G along the wave, which grows faster than the truth, `1/(1 − S) > e^S`.
//! - `S > 1`: it is a saddle point. The solution of ∇G = 0 that lies beside the saddle grows with changing sign while
//!   `S < 2`, and dies out beyond: a long step that ends there does not buckle. Descent leaves the saddle unless the
//!   deflection is so small that the tolerance takes it; [`Accept::Minimum`](crate::Accept::Minimum) looks for a way
//!   down.

use super::drift::Unconstrained;
use super::line_search::Point;
use super::stage::Stage;
use crate::config::{HessianPolicy, ImplicitConfig};
use crate::stability::{dot, noise};
use cloth_core::element::Convexity;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::family::{Assembly, Energies};
use cloth_core::method::linear::{LinearError, LinearReport, LinearSolver};
use cloth_core::step::BuildError;
use std::sync::Arc;

/// Iterations without another attempt at `b = 1` after one has failed: a failed attempt costs as much as a good one.
const RETRY_INTERVAL: u32 = 5;
/// Difference between the blend that worked and the one that failed at which the search between them ends.
const BLEND_RESOLUTION: Real = 0.03;
/// Factor on `b` after an attempt with what worked last has failed.
const BLEND_REDUCTION: Real = 0.5;
/// Blends below this are rounded down to 0.
const SMALLEST_BLEND: Real = 0.025;
/// Inverse iterations for a direction of negative curvature.
const INVERSE_ITERATIONS: u32 = 8;

/// The matrix, its solver, and how much of the exact Hessian it could take last time.
#[derive(Debug)]
pub(super) struct NewtonSystem {
    assembly: Assembly,
    matrix: BlockMatrix,
    solver: Box<dyn LinearSolver>,
    unconstrained: Unconstrained,
    policy: HessianPolicy,
    /// What worked last.
    blend: Real,
    /// What failed last.
    ceiling: Real,
    /// Iterations until `b = 1` is tried again.
    wait: u32,
    /// Whether the last factor was that of the exact Hessian.
    exact: bool,
}

impl NewtonSystem {
    /// For an energy, and the linear solver of the settings.
    ///
    /// # Errors
    /// What the linear solver refuses.
    pub(super) fn build(
        energies: &Energies,
        is_free: &[bool],
        rest: Option<&[Vec3]>,
        config: &ImplicitConfig,
    ) -> Result<Self, BuildError> {
        let assembly = energies.assembly();
        Ok(Self {
            matrix: BlockMatrix::zeros(Arc::clone(assembly.pattern())),
            solver: config.linear.build(assembly.pattern(), is_free, rest)?,
            policy: config.hessian,
            unconstrained: Unconstrained::of_energies(energies, assembly.pattern(), is_free),
            assembly,
            blend: 1.0,
            ceiling: 1.0,
            wait: 0,
            exact: false,
        })
    }

    /// Forgets what was learnt in another step.
    pub(super) fn reset(&mut self) {
        (self.blend, self.ceiling, self.wait, self.exact) = (1.0, 1.0, 0, false);
    }

    /// Whether the last factorisation proved that the exact Hessian of `G` is positive definite.
    pub(super) fn is_exact(&self) -> bool {
        self.exact
    }

    /// The matrix (N/m) that was assembled last.
    pub(super) fn matrix(&self) -> &BlockMatrix {
        &self.matrix
    }

    /// Assembles the matrix to be tried first at `x` (m).
    pub(super) fn assemble(&mut self, g: &Stage<'_>, x: &[Vec3]) {
        match self.policy {
            HessianPolicy::Always(convexity) => self.fill(g, x, &[(1.0, convexity)]),
            HessianPolicy::ExactFirst => self.fill_blend(g, x, self.first_blend()),
        }
    }

    /// Factorises it, or as much of it as is positive definite. Returns the number of attempts.
    pub(super) fn factorize(
        &mut self,
        g: &Stage<'_>,
        x: &[Vec3],
    ) -> Result<u32, NotPositiveDefinite> {
        match self.policy {
            HessianPolicy::Always(convexity) => {
                self.exact = convexity == Convexity::Exact && self.solver.proves_definiteness();
                let prepared = self.solver.prepare(&self.matrix);
                prepared.map(|()| 1).map_err(|_| NotPositiveDefinite)
            }
            HessianPolicy::ExactFirst => self.factorise_with_reduction(g, x, self.first_blend()),
        }
    }

    /// Drops more of the indefinite part after [`NewtonSystem::solve`] has failed. Returns the number of attempts.
    pub(super) fn reduce_blend(
        &mut self,
        g: &Stage<'_>,
        x: &[Vec3],
    ) -> Result<u32, NotPositiveDefinite> {
        if self.policy != HessianPolicy::ExactFirst || self.blend == 0.0 {
            return Err(NotPositiveDefinite);
        }
        let blend = self.next_blend(self.blend);
        self.fill_blend(g, x, blend);
        self.factorise_with_reduction(g, x, blend)
    }

    /// Lowers the blend from that of the matrix as it is to the first that the solver takes.
    fn factorise_with_reduction(
        &mut self,
        g: &Stage<'_>,
        x: &[Vec3],
        mut blend: Real,
    ) -> Result<u32, NotPositiveDefinite> {
        for attempt in 1.. {
            if self.solver.prepare(&self.matrix).is_ok() {
                let whole = blend == 1.0;
                self.exact = whole && self.solver.proves_definiteness();
                self.wait = if whole {
                    0
                } else {
                    self.wait.saturating_sub(1)
                };
                self.blend = blend;
                return Ok(attempt);
            }
            if blend == 0.0 {
                return Err(NotPositiveDefinite);
            }
            blend = self.next_blend(blend);
            self.fill_blend(g, x, blend);
        }
        unreachable!("the blend falls to 0")
    }

    /// The exact Hessian now and then; otherwise half-way between what worked last and what failed last.
    fn first_blend(&self) -> Real {
        if self.wait == 0 {
            1.0
        } else if self.ceiling - self.blend > BLEND_RESOLUTION {
            0.5 * (self.blend + self.ceiling)
        } else {
            self.blend
        }
    }

    /// What to try after `failed`.
    fn next_blend(&mut self, failed: Real) -> Real {
        self.ceiling = failed;
        if failed == 1.0 {
            self.wait = RETRY_INTERVAL;
        }
        if failed > self.blend {
            return self.blend;
        }
        self.blend = if failed * BLEND_REDUCTION < SMALLEST_BLEND {
            0.0
        } else {
            failed * BLEND_REDUCTION
        };
        self.blend
    }

    /// Drops the whole indefinite part in the next iteration. Returns whether that changes anything.
    pub(super) fn clamp_fully(&mut self) -> bool {
        let changes = self.policy == HessianPolicy::ExactFirst && self.first_blend() > 0.0;
        (self.blend, self.ceiling, self.wait) = (0.0, 0.0, RETRY_INTERVAL);
        changes
    }

    fn fill_blend(&mut self, g: &Stage<'_>, x: &[Vec3], blend: Real) {
        match blend {
            1.0 => self.fill(g, x, &[(1.0, Convexity::Exact)]),
            0.0 => self.fill(g, x, &[(1.0, Convexity::Clamp)]),
            b => self.fill(g, x, &[(b, Convexity::Exact), (1.0 - b, Convexity::Clamp)]),
        }
    }

    fn fill(&mut self, g: &Stage<'_>, x: &[Vec3], parts: &[(Real, Convexity)]) {
        g.hessian_into(&self.assembly, x, parts, &mut self.matrix);
    }

    /// `out = −(matrix)⁻¹ gradient`.
    ///
    /// # Errors
    /// Where an iterative solver finds out on the way that the matrix is not positive definite.
    pub(super) fn solve(
        &mut self,
        gradient: &[Vec3],
        out: &mut [Vec3],
    ) -> Result<LinearReport, LinearError> {
        let report = self.solver.solve(&self.matrix, gradient, out)?;
        out.iter_mut().for_each(|p| *p = -*p);
        Ok(report)
    }

    /// Puts the momentum of unconstrained components right at a point with its gradient.
    pub(super) fn restore_momentum(&self, g: &Stage<'_>, point: &mut Point) {
        self.unconstrained.restore_momentum(g, point);
    }

    /// Tries the exact Hessian at `x`.
    pub(super) fn factorize_exact(&mut self, g: &Stage<'_>, x: &[Vec3]) -> bool {
        self.fill(g, x, &[(1.0, Convexity::Exact)]);
        self.exact = self.solver.prepare(&self.matrix).is_ok();
        self.exact
    }

    /// Writes a direction of negative curvature of `G` to `out` and returns that curvature (N/m, per squared length of
    /// `out`), or `None` if it finds none. Call it after [`NewtonSystem::factorize`] at the same `x`: inverse iteration
    /// with that factor tends to what it is most nearly singular for.
    pub(super) fn negative_curvature(
        &mut self,
        g: &Stage<'_>,
        x: &[Vec3],
        out: &mut [Vec3],
        product: &mut [Vec3],
    ) -> Option<Real> {
        for (vertex, p) in product.iter_mut().enumerate() {
            *p = noise(vertex);
        }
        for _ in 0..INVERSE_ITERATIONS {
            self.solver.solve(&self.matrix, product, out).ok()?;
            let length = dot(out, out).sqrt();
            out.iter_mut().for_each(|p| *p /= length);
            g.hessian_product_into(x, out, product);
            let curvature = dot(out, product);
            if curvature < 0.0 {
                return Some(curvature);
            }
            product.copy_from_slice(out);
        }
        None
    }
}

/// The matrix is indefinite even without the indefinite parts of its elements, or the policy forbids to drop them.
#[derive(Clone, Copy, Debug)]
pub(super) struct NotPositiveDefinite;
