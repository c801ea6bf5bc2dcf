//! Stiffness-proportional damping as part of the minimisation.
//!
//! With the velocity at the end of a stage written as `v = (x − x_b)/τ`, the force `−β K v` is the negative gradient of
//!
//! ```text
//! β/(2τ) (x − x_b)ᵀ K (x − x_b)
//! ```
//!
//! as long as `K` does not depend on `x`. It is therefore taken where uniform motion would end, at `x_b + τ v_b`,
//! which is away from the solution by the square of the step: an integrator of second order stays one.

use cloth_core::element::Convexity;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::family::{Assembly, Energies};
use std::sync::Arc;

#[derive(Debug)]
pub(super) struct Damper {
    /// β (s).
    coefficient: Real,
    /// K (N/m), the same during a stage.
    stiffness: BlockMatrix,
    assembly: Assembly,
    /// x_b (m): from where the velocity is measured.
    from: Vec<Vec3>,
    /// β/τ (dimensionless).
    scale: Real,
}

impl Damper {
    /// A damper for a coefficient β (s) above zero.
    pub(super) fn new(coefficient: Real, assembly: Assembly) -> Self {
        let pattern = assembly.pattern();
        Self {
            coefficient,
            from: vec![Vec3::zeros(); pattern.row_count()],
            stiffness: BlockMatrix::zeros(Arc::clone(pattern)),
            assembly,
            scale: 0.0,
        }
    }

    /// β/τ (dimensionless): what K is multiplied by in the Hessian.
    pub(super) fn scale(&self) -> Real {
        self.scale
    }

    /// Gets ready for a stage of `tau` (s) that starts at `from` (m), with the stiffness at `x` (m).
    pub(super) fn set(&mut self, energies: &Energies, x: &[Vec3], from: &[Vec3], tau: Real) {
        self.from.copy_from_slice(from);
        self.scale = self.coefficient / tau;
        self.stiffness.clear();
        let by = Convexity::GaussNewton;
        energies.add_hessian(&self.assembly, x, 1.0, by, &mut self.stiffness);
    }

    pub(super) fn value(&self, x: &[Vec3]) -> Real {
        let mut twice = 0.0;
        self.for_each_block(|row, column, block| {
            let [a, b] = [row, column].map(|v| x[v] - self.from[v]);
            let part = a.dot(&(block * b));
            twice += if row == column { part } else { 2.0 * part };
        });
        0.5 * self.scale * twice
    }

    pub(super) fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        self.multiply(|v| x[v] - self.from[v], out);
    }

    pub(super) fn add_product(&self, p: &[Vec3], out: &mut [Vec3]) {
        self.multiply(|v| p[v], out);
    }

    pub(super) fn add_hessian(&self, out: &mut BlockMatrix) {
        for (out, block) in out.blocks_mut().iter_mut().zip(self.stiffness.blocks()) {
            *out += block * self.scale;
        }
    }

    /// Adds `(β/τ) K p`.
    fn multiply(&self, p: impl Fn(usize) -> Vec3, out: &mut [Vec3]) {
        self.for_each_block(|row, column, block| {
            out[row] += block * p(column) * self.scale;
            if row != column {
                out[column] += block.tr_mul(&p(row)) * self.scale;
            }
        });
    }

    /// Visits the blocks of the lower half with their row and column.
    fn for_each_block(&self, mut visit: impl FnMut(usize, usize, &Mat3)) {
        let pattern = self.stiffness.pattern();
        for row in 0..pattern.row_count() {
            for slot in pattern.row(row) {
                let column = pattern.columns()[slot] as usize;
                visit(row, column, &self.stiffness.blocks()[slot]);
            }
        }
    }
}
