//! Contact in the iteration: what it adds to the Hessian, and to the constant matrix.
//!
//! The order of a step, C the contact potential:
//! ```text
//! begin: λ and planes of friction from x[0];  truncate the path from x[0] to the start     begin, limit_each
//! so many times, at the iterate x:
//!     k, J of the active contacts                                                          linearize
//!     L-BFGS around a multigrid cycle for H + Σ k J Jᵀ: a direction d                      hessian.rs
//!     scale d to the trust radius
//!     detect on the path from x to x + d, find how much of it is free                      limit
//!     line search on G + C along that                                                      backtrack
//!     where that fails: the same with d truncated vertex by vertex                         limit_each
//!     where that fails: the same with A in the place of H                                  below, limit
//! ```
//! So candidates are detected in every iteration, for the path that is about to be taken, and `C`, `∇C` and the contact
//! constraints of the next iteration are evaluated over them. An accepted path has no intersection, so nothing passes
//! through in between (no tunnelling). A contact constraint has up to four vertices with weights: a vertex and a
//! triangle, or two edges.
//!
//! *The bound of a vertex* is continuous collision detection (in `cloth-collide`): of the distance that a vertex and a
//! triangle, or two edges, have at the start of a path, or of h where that is less, a fifth has to be left. `limit`
//! cuts all paths to the shortest fraction that is safe, `limit_each` only those of the vertices of such a pair, and
//! looks again until no pair comes too near. Wu et al. (2020) and Chen et al. (2025) need no time of impact: if a
//! vertex moves by less than half of its distance to all that it may meet, nothing meets (triangle inequality). That
//! stops motion along a surface, and away from it, as well.
//!
//! *Thickness* belongs to the potential (`cloth-collide`): it acts where two surfaces are nearer than that, so cloth at
//! rest on something keeps a gap a little smaller, and no gap becomes zero.
//!
//! *Non-penetration* is a condition on positions: the barrier in C and the truncated paths, not a velocity and not a
//! force that is added to the right-hand side of the constant matrix. Forces are −∇C at the iterate, so they change in
//! every iteration with x.
//!
//! *The Hessian.* Of ψ(d(x)) it is `ψ″ J Jᵀ + ψ′ ∇²d`, J = ∇d. The first term has k = ψ″ ≥ 0 (κ_c, or ¼ κ_c h²/d²
//! within the barrier, times the area). The second is left out: ψ′ ≤ 0, so where the distance curves, as around a
//! corner, it has negative eigenvalues. Without it the direction is only an approximation of Newton's, but positive
//! definite, so it leads down, and the gradient, which decides where the iteration ends, is whole. Friction is μ λ
//! f(‖u‖) with u linear in x; its second derivatives are μ λ f″ along u and μ λ f′/‖u‖ across it in the plane, both ≥
//! 0: μ λ/ε below ε, and 0 and μ λ/‖u‖ beyond it.
//!
//! *Friction.* λ and the plane are set in `begin` and kept, so `G + C` is one function in all iterations of a step, and
//! each accepted iterate is lower, but for rounding: lagging takes nothing from the convergence within a step. λ is not
//! iterated. So ‖f‖ ≤ μ λ holds exactly, converged or not, for the λ of the start; for that of the end it is wrong by μ
//! times its change over the step. Sticking is a stiff spring: under a tangential force f a vertex gives way by u = ε
//! f/(μ λ), at most ε.
//!
//! *Another way.* Ly et al. (2020) leave the global matrix as it is, split it into its diagonal and the rest, and find
//! the force on each vertex by Coulomb's law in the local step. Their contacts are at vertices, and their forces are
//! those of no potential. Here a contact may be between a vertex and a triangle or two edges, and a line search sees
//! it; the price is conjugate gradients for every direction.

use crate::global::GlobalSystem;
use cloth_core::contact::{ContactPotential, ContactRow, GlobalRows};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::vectors::{add, dot};
use cloth_core::particles::Particles;

/// The contact potential of the step, if there is contact and the method takes it into account.
pub(crate) type Contact<'a> = Option<&'a mut dyn ContactPotential>;

/// Residual, in the norm of A⁻¹ and relative to the first, at which conjugate gradients end: a search direction needs
/// no more.
const CG_TOLERANCE: Real = 0.1;
/// Most iterations of conjugate gradients.
const MAX_CG_ITERATIONS: u32 = 10;

/// `A + Σ k J Jᵀ` with the contacts linearised at one iterate, for which no matrix is factorised: conjugate gradients
/// preconditioned with the factor of A. As the contacts are few, or soft beside the cloth, three to six are enough. For
/// methods without pairs, and where a direction of Newton's method leads nowhere.
#[derive(Debug)]
pub(crate) struct ContactSystem {
    pub(crate) rows: Vec<ContactRow>,
    /// What couples many vertices.
    global: GlobalRows,
    residual: Vec<Vec3>,
    /// A⁻¹ r (m).
    solved: Vec<Vec3>,
    /// d (m), A d and (A + Σ k J Jᵀ) d (N).
    direction: Vec<Vec3>,
    times_matrix: Vec<Vec3>,
    product: Vec<Vec3>,
}

impl ContactSystem {
    pub(crate) fn new(vertex_count: usize) -> Self {
        let zeros = vec![Vec3::zeros(); vertex_count];
        Self {
            rows: Vec::new(),
            global: GlobalRows::default(),
            residual: zeros.clone(),
            solved: zeros.clone(),
            direction: zeros.clone(),
            times_matrix: zeros.clone(),
            product: zeros,
        }
    }

    /// Linearises the contacts at `x` (m), which has to lie on the path of the last detection.
    pub(crate) fn find(&mut self, contact: &Contact<'_>, x: &[Vec3], particles: &Particles) {
        self.rows.clear();
        self.global.clear();
        let Some(contact) = contact else {
            return;
        };
        contact.linearize(x, &mut self.rows);
        // Nothing moves a prescribed vertex.
        for row in &mut self.rows {
            for (weight, vertex) in row.weights.iter_mut().zip(row.vertices) {
                if particles.is_prescribed(vertex as usize) {
                    *weight = 0.0;
                }
            }
        }
        contact.linearize_globally(x, &mut self.global);
        self.global
            .remove_fixed(|vertex| particles.is_prescribed(vertex));
    }

    /// Whether nothing but the constant matrix is left.
    fn is_empty(&self) -> bool {
        self.rows.is_empty() && self.global.rows().is_empty()
    }

    /// Solves with `A + Σ k J Jᵀ`, nearly, for `out` (m), of `g` (N). Returns the number of global solves.
    pub(crate) fn solve(&mut self, global: &mut GlobalSystem, g: &[Vec3], out: &mut [Vec3]) -> u32 {
        if self.is_empty() {
            global.solve(g, out);
            return 1;
        }
        self.residual.copy_from_slice(g);
        global.solve(&self.residual, &mut self.solved);
        self.direction.copy_from_slice(&self.solved);
        self.times_matrix.copy_from_slice(&self.residual);
        out.fill(Vec3::zeros());
        let mut size = dot(&self.residual, &self.solved);
        let enough = CG_TOLERANCE * CG_TOLERANCE * size;
        for solves in 1..=MAX_CG_ITERATIONS {
            self.multiply();
            let length = size / dot(&self.direction, &self.product);
            // A gradient of zero.
            if !length.is_finite() {
                return solves;
            }
            add(out, length, &self.direction);
            add(&mut self.residual, -length, &self.product);
            if solves == MAX_CG_ITERATIONS {
                break;
            }
            global.solve(&self.residual, &mut self.solved);
            let next = dot(&self.residual, &self.solved);
            if next <= enough {
                return solves + 1;
            }
            let ratio = next / size;
            size = next;
            // A d follows from A A⁻¹ r = r: no product with A is needed.
            for (kept, new) in [
                (&mut self.direction, &self.solved),
                (&mut self.times_matrix, &self.residual),
            ] {
                for (kept, new) in kept.iter_mut().zip(new) {
                    *kept = new + *kept * ratio;
                }
            }
        }
        MAX_CG_ITERATIONS
    }

    /// `product = (A + Σ k J Jᵀ) d`.
    fn multiply(&mut self) {
        let mut product = std::mem::take(&mut self.product);
        product.copy_from_slice(&self.times_matrix);
        self.add_product(&self.direction, &mut product);
        self.product = product;
    }

    /// Adds `Σ k J Jᵀ d` (N) to `out`, of d (m).
    pub(crate) fn add_product(&self, d: &[Vec3], out: &mut [Vec3]) {
        for row in &self.rows {
            row.add_product(d, out);
        }
        for row in self.global.rows() {
            row.add_product(d, out);
        }
    }
}
