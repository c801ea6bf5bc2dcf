//! The resistance of the air as part of the minimisation. (The drag α of [`Damping`](crate::Damping) is none of it.)
//!
//! The air pulls at a vertex with `F − D (v − v₀)` ([`cloth_core::air`]): F is its force at the velocity v₀ of the
//! vertex before the step, and D (3 × 3, kg/s) the positive semi-definite part of how that changes with the velocity,
//! summed over the triangles of the vertex. F is constant in the step, and is in `x̂`. With the velocity at the end of
//! a stage written as `v = (x − x_b)/τ`, the force −D (v − v₀) is the negative gradient of `(x − a)ᵀ D (x − a)/(2τ)`,
//! with `a = x_b + τ v₀`.

use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::block_matrix::BlockMatrix;

/// D of each vertex (kg/s), a (m) and τ (s).
#[derive(Clone, Copy, Debug)]
pub(super) struct AirDrag<'a> {
    pub(super) drag: &'a [Mat3],
    pub(super) constant_velocity_positions: &'a [Vec3],
    pub(super) tau: Real,
}

impl AirDrag<'_> {
    /// `D/τ` of a vertex (N/m).
    pub(super) fn stiffness(&self, vertex: usize) -> Mat3 {
        self.drag[vertex] / self.tau
    }

    /// `D (x − a)/τ` of a vertex at `x` (N).
    pub(super) fn gradient(&self, vertex: usize, x: Vec3) -> Vec3 {
        self.drag[vertex] * (x - self.constant_velocity_positions[vertex]) / self.tau
    }

    /// Adds the gradient (N) to `out`, and returns the value (J).
    pub(super) fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        let mut twice = 0.0;
        for (vertex, (x, out)) in x.iter().zip(out).enumerate() {
            let gradient = self.gradient(vertex, *x);
            twice += gradient.dot(&(x - self.constant_velocity_positions[vertex]));
            *out += gradient;
        }
        0.5 * twice
    }

    pub(super) fn add_product(&self, p: &[Vec3], out: &mut [Vec3]) {
        for ((p, out), drag) in p.iter().zip(out).zip(self.drag) {
            *out += drag * p / self.tau;
        }
    }

    /// Adds the blocks to the diagonal of `out` (N/m).
    pub(super) fn add_hessian(&self, out: &mut BlockMatrix) {
        for vertex in 0..self.drag.len() {
            let slot = out.pattern().row(vertex).end - 1;
            out.blocks_mut()[slot] += self.stiffness(vertex);
        }
    }
}
