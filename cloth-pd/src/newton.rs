//! Directions in contact: a truncated Newton method with the constant matrix as its preconditioner (Nocedal and Wright
//! 2006, section 7.1).
//!
//! Cloth that is pressed onto something moves out of its own plane, where the constant matrix is as stiff as along the
//! springs, thousands of times too stiff. What an iteration with that matrix leaves of such a motion looks small in the
//! metric of the matrix, and pairs of differences hardly correct it: every contact that comes or goes makes them wrong.
//! By L-BFGS a towel without friction stuck to its rail, and cloth at rest pressed with 15 % less than its weight.
//!
//! So with active contacts the direction d solves `(H + Σ k J Jᵀ) d = −∇G`, H = M/Δt² + Σ w Sᵀ (I − ∂p/∂z) S the
//! projected Hessian at the iterate, by conjugate gradients. Their preconditioner is `A⁻¹ + B⁻¹`, B the 3 × 3 blocks on
//! the diagonal of `H + Σ k J Jᵀ` (block Jacobi): A is right for what stretches the cloth, B for what moves a vertex
//! out of it or presses it onto something, and where both are right the sum is twice too much at most.
//!
//! *How far.* Until a fifth of the residual is left; from the thirtieth direction of a step on less and less. A
//! residual is mostly what contacts push with, a thousand times the weight of a light cloth; solved to a fifth, such a
//! step goes to and fro between too many contacts and too few: a cloth of 0.02 kg/m² on a table kept its overhanging
//! edges curled in the air, and fell 0.039 m instead of 0.053.
//!
//! *Tried.* The exact Hessian, as a difference of gradients, in the place of the projected one: wherever springs are
//! pressed it may be indefinite, and conjugate gradients end where they find that. With A⁻¹ alone as the preconditioner
//! a sheet on a ball fell 7 % less so than by implicit Euler, and with both as they are here, 0.2 to 1.5 % less.
//! Without B the same step takes twice as long on the ball and three times as long where a towel lies on a rail, and
//! the light cloth above falls 0.038 m; with the coarse grid in the preconditioner too, cloth at rest takes ten times
//! as long. All directions solved to a fiftieth: 2.2 times as long on the ball, to a two-hundredth 3.5 times. The
//! decrement of one iteration does not say that a step is near: conjugate gradients cut short take what is stiff and
//! what is soft alternately.

use crate::contact::ContactSystem;
use crate::global::GlobalSystem;
use crate::objective::{Objective, Point};
use crate::quadratic::Padded;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::chunked::map_reduce;
use cloth_core::method::linear::TruncatedConjugateGradients;

/// Residual, in the norm of the preconditioner and relative to the first, at which conjugate gradients end: in so many
/// directions of a step; after these it is smaller by a factor from one direction to the next, down to the least.
const LOOSE_TOLERANCE: Real = 0.2;
const LOOSE_DIRECTIONS: i32 = 30;
const TIGHTENING: Real = 0.8;
const TIGHTEST_TOLERANCE: Real = 1e-3;
/// Most iterations of conjugate gradients.
const MAX_CG_ITERATIONS: u32 = 200;

/// The working memory.
#[derive(Debug)]
pub(crate) struct TruncatedNewton {
    /// Inverses of the blocks on the diagonal of `H + Σ k J Jᵀ` (m/N); 0 of prescribed vertices.
    inverses: Vec<Mat3>,
    gradients: TruncatedConjugateGradients,
    /// A direction with a fourth number (m).
    padded: Vec<Padded>,
    /// Directions found in this step.
    found: i32,
}

impl TruncatedNewton {
    pub(crate) fn new(vertex_count: usize) -> Self {
        Self {
            inverses: vec![Mat3::zeros(); vertex_count],
            gradients: TruncatedConjugateGradients::default(),
            padded: Vec::with_capacity(vertex_count),
            found: 0,
        }
    }

    /// A step begins.
    pub(crate) fn begin(&mut self) {
        self.found = 0;
    }

    /// Writes the direction (m) from `point` to `out`. Returns the number of global solves.
    pub(crate) fn find(
        &mut self,
        objective: &mut Objective,
        global: &mut GlobalSystem,
        contacts: &ContactSystem,
        point: &Point,
        out: &mut [Vec3],
    ) -> u32 {
        self.linearize(objective, contacts, &point.positions);
        self.found += 1;
        let tightened = (self.found - LOOSE_DIRECTIONS).max(0);
        let tolerance = (LOOSE_TOLERANCE * TIGHTENING.powi(tightened)).max(TIGHTEST_TOLERANCE);
        let (objective, padded, inverses) = (&*objective, &mut self.padded, &self.inverses[..]);
        let multiply = |d: &[Vec3], out: &mut [Vec3]| {
            objective.multiply(d, padded, out);
            contacts.add_product(d, out);
        };
        // A⁻¹ + B⁻¹, B the blocks on the diagonal.
        let inverse = |r: &[Vec3], z: &mut [Vec3]| {
            global.solve(r, z);
            map_reduce(
                z,
                #[inline(always)]
                |start, z: &mut [Vec3]| {
                    let terms = inverses[start..].iter().zip(&r[start..]);
                    for (z, (inverse, r)) in z.iter_mut().zip(terms) {
                        *z += inverse * r;
                    }
                    []
                },
            );
        };
        let end = (tolerance, MAX_CG_ITERATIONS);
        let solved = self
            .gradients
            .solve(end, multiply, inverse, &point.gradient, out);
        solved.1 + 1
    }

    /// Takes the Hessian at x (m), and inverts the blocks on its diagonal.
    fn linearize(&mut self, objective: &mut Objective, contacts: &ContactSystem, x: &[Vec3]) {
        let blocks = &mut self.inverses;
        objective.linearize(x, blocks);
        for row in &contacts.rows {
            let along = row.normal * row.normal.transpose() * row.stiffness;
            for (vertex, weight) in row.vertices.iter().zip(row.weights) {
                blocks[*vertex as usize] += along * (weight * weight);
            }
        }
        for (block, w) in blocks.iter_mut().zip(objective.particles.inverse_mass()) {
            let inverse = block.try_inverse().filter(|_| *w > 0.0);
            *block = inverse.unwrap_or_default();
        }
    }
}
