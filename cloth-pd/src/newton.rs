//! Directions in contact: a truncated Newton method with the constant matrix as its preconditioner (Nocedal and Wright
//! 2006, section 7.1).
//!
//! Cloth that is pressed onto something moves out of its own plane, where the constant matrix is as stiff as along the
//! springs, thousands of times too stiff. What an iteration with that matrix leaves of such a motion looks small in the
//! metric of the matrix, and pairs of differences hardly correct it: every contact that comes or goes makes them wrong.
//! By L-BFGS a towel without friction stuck to its rail, and cloth at rest pressed with 15 % less than its weight.
//!
//! So with active contacts the direction d solves `(H + Σ k J Jᵀ) d = −∇G`, H the Hessian of inertia and elements at
//! the iterate, by conjugate gradients preconditioned with `A⁻¹`, until a fifth of the residual is left. H is never
//! assembled: `H d = (∇G(x + ε d) − ∇G(x))/ε`, one local step. Where d has no curvature, as in buckling, what has been
//! found until then is taken.
//!
//! *Tried.* With the coarse grid in the preconditioner a sheet on a ball or on the corner of a box takes 1.4 to 1.8
//! times as long, and folds less than that of implicit Euler. With a twentieth of the residual left a step takes twice
//! as long and fewer iterations, for the same motion. The decrement of one iteration does not say that a step is near:
//! conjugate gradients cut short take what is stiff and what is soft alternately.

use crate::contact::ContactSystem;
use crate::global::GlobalSystem;
use crate::objective::{Objective, Point};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::trust::longest;
use cloth_core::method::vectors::{add, dot};

/// Residual, in the norm of the preconditioner and relative to the first, at which conjugate gradients end.
const CG_TOLERANCE: Real = 0.2;
/// Most iterations of conjugate gradients.
const MAX_CG_ITERATIONS: u32 = 30;
/// Least curvature along a direction, over that which the preconditioner has.
const MIN_CURVATURE_RATIO: Real = 1e-6;
/// Longest displacement of a difference of gradients, over the spacing that vertices have in the box around the cloth:
/// between rounding, 1e-16 of coordinates, and what curves.
const DIFFERENCE_LENGTH: Real = 1e-6;

/// The working memory.
#[derive(Debug)]
pub(crate) struct TruncatedNewton {
    /// The other end of a difference, and the gradient (N) without contact at the iterate.
    probe: Point,
    gradient: Vec<Vec3>,
    residual: Vec<Vec3>,
    /// The preconditioned residual (m).
    solved: Vec<Vec3>,
    /// d of conjugate gradients (m), and its product with the Hessian (N).
    direction: Vec<Vec3>,
    product: Vec<Vec3>,
}

impl TruncatedNewton {
    pub(crate) fn new(vertex_count: usize) -> Self {
        let zeros = vec![Vec3::zeros(); vertex_count];
        Self {
            probe: Point::new(vertex_count),
            gradient: zeros.clone(),
            residual: zeros.clone(),
            solved: zeros.clone(),
            direction: zeros.clone(),
            product: zeros,
        }
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
        let (probe, q) = (&mut self.probe, &point.displacement);
        probe.displacement.copy_from_slice(q);
        objective.evaluate(probe, &None);
        self.gradient.copy_from_slice(&probe.gradient);
        let length = DIFFERENCE_LENGTH * spacing(&point.positions);
        out.fill(Vec3::zeros());
        for (residual, gradient) in self.residual.iter_mut().zip(&point.gradient) {
            *residual = -gradient;
        }
        let (mut first, mut size) = (0.0, 0.0);
        for solves in 1..=MAX_CG_ITERATIONS {
            global.solve(&self.residual, &mut self.solved);
            let next = dot(&self.residual, &self.solved);
            if solves == 1 {
                first = next;
                self.direction.copy_from_slice(&self.solved);
            } else if next <= CG_TOLERANCE * CG_TOLERANCE * first {
                return solves;
            } else {
                let ratio = next / size;
                for (d, z) in self.direction.iter_mut().zip(&self.solved) {
                    *d = z + *d * ratio;
                }
            }
            size = next;
            self.multiply(objective, contacts, q, length);
            let curvature = dot(&self.direction, &self.product);
            if curvature <= MIN_CURVATURE_RATIO * size || curvature.is_nan() {
                if solves == 1 {
                    out.copy_from_slice(&self.direction);
                }
                return solves;
            }
            let length = size / curvature;
            add(out, length, &self.direction);
            add(&mut self.residual, -length, &self.product);
        }
        MAX_CG_ITERATIONS
    }

    /// `product = (H + Σ k J Jᵀ) d` where the displacement of the cloth is `q` (m), by a difference of that length (m).
    fn multiply(
        &mut self,
        objective: &mut Objective,
        contacts: &ContactSystem,
        q: &[Vec3],
        length: Real,
    ) {
        let part = length / longest(&self.direction).max(Real::MIN_POSITIVE);
        let moved = q.iter().zip(&self.direction);
        for (to, (q, d)) in self.probe.displacement.iter_mut().zip(moved) {
            *to = q + d * part;
        }
        objective.evaluate(&mut self.probe, &None);
        let gradients = self.probe.gradient.iter().zip(&self.gradient);
        for (product, (there, here)) in self.product.iter_mut().zip(gradients) {
            *product = (there - here) / part;
        }
        contacts.add_product(&self.direction, &mut self.product);
    }
}

/// The diagonal of the box around the cloth at `x` (m), over the root of the number of vertices; 1 m if it is a point.
fn spacing(x: &[Vec3]) -> Real {
    let first = x.first().copied().unwrap_or_default();
    let ends = x
        .iter()
        .fold((first, first), |(low, high), x| (low.inf(x), high.sup(x)));
    let diagonal = (ends.1 - ends.0).norm();
    match diagonal > 0.0 {
        true => diagonal / (x.len() as Real).sqrt(),
        false => 1.0,
    }
}
