//! Stiffness-proportional damping as part of the minimisation.
//!
//! With the velocity at the end of a stage written as `v = (x − x_b)/τ`, the force `−β K v` is the negative gradient of
//!
//! ```text
//! β/(2τ) (x − x_b)ᵀ K (x − x_b)
//! ```
//!
//! as long as `K` does not depend on `x`. So it is taken at one place on the way of uniform motion, from `x_b` to
//! `x_b + τ v_b`, the same during a stage. Which place?
//!
//! - **Half-way.** A spring that turns by θ in the stage, from `d_b` to `d` with the same length, has `d − d_b` at a
//!   right angle to the direction half-way: nothing is damped, as it should be. With the direction of the start
//!   `n·(d − d_b)/τ` takes the turn for a compression `ℓ θ²/2`, and the force lengthens the spring; with that of the
//!   end for a stretch, and the force shortens it. A spring that is shorter than at rest and turns gets energy out of
//!   implicit Euler: its force at the end, along `d`, gives less than the `½ k s²` that it loses. In cloth that
//!   crumples, at `Δt = β = 0.01 s`, K of the end made 37 J out of half a joule.
//! - **At the end**, for BDF2 and the midpoint rule, whose velocity is that of this point in time (and whose base is
//!   not where the cloth was): `x_b + τ v_b` is away from it by the square of the step, so an integrator of second
//!   order stays one. But only where motion is resolved does uniform motion say anything of the end. So this K is
//!   taken where its blocks differ from those half-way by [`RESOLVED`] at most, and the other one in all other steps.

use cloth_core::element::Convexity;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::family::{Assembly, Energies};
use std::sync::Arc;

/// The largest change of a diagonal block of K (relative to the block) in the second half of uniform motion, with which
/// the motion is resolved.
const RESOLVED: Real = 0.01;

#[derive(Debug)]
pub(super) struct Damper {
    /// β (s).
    coefficient: Real,
    /// K (N/m), the same during a stage.
    stiffness: BlockMatrix,
    /// The same at the end of uniform motion, if that is asked for.
    at_end: Option<BlockMatrix>,
    half_way: Vec<Vec3>,
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
            stiffness: zeros(&assembly),
            at_end: None,
            half_way: Vec::with_capacity(pattern.row_count()),
            assembly,
            scale: 0.0,
        }
    }

    /// Takes the memory for stages of second order, where the first step is none.
    pub(super) fn expect_second_order(&mut self) {
        self.at_end = Some(zeros(&self.assembly));
    }

    /// β/τ (dimensionless): what K is multiplied by in the Hessian.
    pub(super) fn scale(&self) -> Real {
        self.scale
    }

    /// Gets ready for a stage of `tau` (s), in which uniform motion leads from one place to another (m). Is it of
    /// second order?
    pub(super) fn set(
        &mut self,
        energies: &Energies,
        [from, to]: [&[Vec3]; 2],
        tau: Real,
        is_second_order: bool,
    ) {
        self.from.copy_from_slice(from);
        self.scale = self.coefficient / tau;
        self.half_way.clear();
        let both = from.iter().zip(to);
        self.half_way.extend(both.map(|(a, b)| (a + b) * 0.5));
        let assembly = &self.assembly;
        let fill = |x: &[Vec3], out: &mut BlockMatrix| {
            out.clear();
            energies.add_hessian(assembly, x, 1.0, Convexity::GaussNewton, out);
        };
        fill(&self.half_way, &mut self.stiffness);
        if is_second_order {
            let at_end = self.at_end.get_or_insert_with(|| zeros(assembly));
            fill(to, at_end);
            if is_near(&self.stiffness, at_end) {
                std::mem::swap(&mut self.stiffness, at_end);
            }
        }
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

    /// By how much (J) rounding may change the [`value`](Self::value) at `x`: in rigid motion large terms cancel.
    pub(super) fn rounding(&self, x: &[Vec3]) -> Real {
        let mut sum = 0.0;
        self.for_each_block(|row, column, block| {
            let [a, b] = [row, column].map(|v| x[v] - self.from[v]);
            sum += a.norm() * (block * b).norm();
        });
        Real::EPSILON * self.scale * sum
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

/// A matrix of the pattern, without anything in it.
fn zeros(assembly: &Assembly) -> BlockMatrix {
    BlockMatrix::zeros(Arc::clone(assembly.pattern()))
}

/// Whether the diagonal blocks of the second of two matrices differ from those of the first by no more than
/// [`RESOLVED`].
fn is_near(one: &BlockMatrix, other: &BlockMatrix) -> bool {
    let pattern = one.pattern();
    (0..pattern.row_count()).all(|row| {
        let slot = pattern.row(row).end - 1;
        let [a, b] = [one, other].map(|matrix| &matrix.blocks()[slot]);
        (b - a).norm_squared() <= RESOLVED * RESOLVED * a.norm_squared()
    })
}
