//! The linear system (KKT matrix) of one iteration, scaled so that its diagonal is of the order of 1.
//!
//! With `Δx̂ = √m Δx`, `Δλ̂ = √D Δλ` and `D = w̃ + α̃` of each row, and the geometric stiffness `K = −Σ λ ∂²C` made
//! positive semi-definite, it reads
//!
//! ```text
//! (I + K̂) Δx̂ − Ĵᵀ Δλ̂ = −(√m (x − x̃) − Ĵᵀ λ̂)     Ĵ = D^(−½) J M^(−½),  K̂ = M^(−½) K M^(−½),
//!      Ĵ  Δx̂ + α̂ Δλ̂  = −D^(−½) (C + α̃ λ)          α̂ = α̃/D
//! ```
//!
//! α̂ is 0 for a hard row and tends to 1 for a soft one, whatever the units, the masses and the step. Prescribed
//! vertices and rows that no multiplier could change have zeros in Ĵ. The only division by a stiffness is that in
//! `α̃ = 1/(k h²)`, for k neither 0 nor ∞; nothing divides by a compliance.

use super::rows::{RowFamily, Rows};
use crate::update::XpbdUpdate;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::block_matrix::BlockMatrix;

/// A vector of the KKT system: unknowns or right-hand side, one block for positions and one for multipliers.
#[derive(Clone, Debug)]
pub(super) struct KktVector {
    /// One per vertex, zero at prescribed ones.
    pub(super) x: Vec<Vec3>,
    /// One per row.
    pub(super) l: Vec<Real>,
}

impl KktVector {
    pub(super) fn zeros(vertices: usize, rows: usize) -> Self {
        Self {
            x: vec![Vec3::zeros(); vertices],
            l: vec![0.0; rows],
        }
    }

    pub(super) fn norm(&self) -> Real {
        let x: Real = self.x.iter().map(Vec3::norm_squared).sum();
        let l: Real = self.l.iter().map(|l| l * l).sum();
        (x + l).sqrt()
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (x, other) in self.x.iter_mut().zip(&other.x) {
            *x += other;
        }
        for (l, other) in self.l.iter_mut().zip(&other.l) {
            *l += other;
        }
    }
}

/// The scaled system.
#[derive(Debug)]
pub(super) struct Kkt {
    /// Start of the entries of each row in `vertices` and `jacobian`; the end of the last.
    pub(super) offsets: Vec<u32>,
    /// Vertex of each entry.
    pub(super) vertices: Vec<u32>,
    /// Ĵ.
    pub(super) jacobian: Vec<Vec3>,
    /// α̂ of each row.
    pub(super) normalized_compliance: Vec<Real>,
    /// `I + K̂`.
    pub(super) hessian: BlockMatrix,
    /// `D^(−½)` of each row; 0 for a row that no multiplier could change.
    pub(super) row_scale: Vec<Real>,
    /// `√w` (kg^−½) of each vertex.
    pub(super) vertex_scale: Vec<Real>,
}

impl Kkt {
    pub(super) fn new(rows: &Rows, inverse_mass: &[Real], hessian: BlockMatrix) -> Self {
        Self {
            offsets: rows.offsets.clone(),
            vertices: rows.vertices.clone(),
            jacobian: vec![Vec3::zeros(); rows.vertices.len()],
            normalized_compliance: vec![1.0; rows.len()],
            row_scale: vec![0.0; rows.len()],
            hessian,
            vertex_scale: inverse_mass.iter().map(|w| w.sqrt()).collect(),
        }
    }

    /// Number of rows.
    pub(super) fn row_count(&self) -> usize {
        self.normalized_compliance.len()
    }

    /// Entries of a row.
    #[inline]
    pub(super) fn entries(&self, row: usize) -> std::ops::Range<usize> {
        self.offsets[row] as usize..self.offsets[row + 1] as usize
    }

    /// Fills Ĵ, α̂ and the scales from the rows as they are.
    pub(super) fn set_rows(&mut self, rows: &Rows, update: XpbdUpdate) {
        for r in 0..rows.len() {
            let entries = rows.entries(r);
            let mut weight = 0.0;
            for e in entries.clone() {
                let s = self.vertex_scale[self.vertices[e] as usize];
                weight += (s * rows.gradient[e]).norm_squared();
            }
            let scaled_compliance = rows.scaled_compliance(r, update);
            let diagonal = weight + scaled_compliance;
            let (scale, normalized) = if weight > 0.0 && diagonal < Real::INFINITY {
                (1.0 / diagonal.sqrt(), scaled_compliance / diagonal)
            } else {
                (0.0, 1.0)
            };
            self.row_scale[r] = scale;
            self.normalized_compliance[r] = normalized;
            for e in entries {
                let s = self.vertex_scale[self.vertices[e] as usize];
                self.jacobian[e] = rows.gradient[e] * (s * scale);
            }
        }
    }

    /// Fills `I + K̂` from λ (not scaled), or I without families.
    pub(super) fn set_hessian(
        &mut self,
        families: &[Box<dyn RowFamily>],
        x: &[Vec3],
        multipliers: &[Real],
        diagonal_only: bool,
    ) {
        self.hessian.clear();
        self.hessian.add_diagonal(std::iter::repeat(1.0));
        let mut first = 0;
        for family in families {
            let own = &multipliers[first..first + family.row_count()];
            first += own.len();
            let scale = &self.vertex_scale;
            family.add_stiffness(x, own, scale, diagonal_only, &mut self.hessian);
        }
    }

    /// `Ĵ x`.
    #[inline]
    pub(super) fn row_product(&self, row: usize, x: &[Vec3]) -> Real {
        let entries = self.entries(row);
        entries
            .map(|e| self.jacobian[e].dot(&x[self.vertices[e] as usize]))
            .sum()
    }

    /// Adds `factor Ĵᵀ l` to `x`.
    pub(super) fn add_forces(&self, l: &[Real], factor: Real, x: &mut [Vec3]) {
        for (row, l) in l.iter().enumerate() {
            for e in self.entries(row) {
                x[self.vertices[e] as usize] += self.jacobian[e] * (factor * l);
            }
        }
    }

    /// `out = right − A z`.
    pub(super) fn residual(&self, right: &KktVector, z: &KktVector, out: &mut KktVector) {
        self.hessian.multiply(&z.x, &mut out.x);
        self.add_forces(&z.l, -1.0, &mut out.x);
        for (v, (out, right)) in out.x.iter_mut().zip(&right.x).enumerate() {
            *out = if self.vertex_scale[v] == 0.0 {
                Vec3::zeros()
            } else {
                right - *out
            };
        }
        for row in 0..self.row_count() {
            let product = self.row_product(row, &z.x) + self.normalized_compliance[row] * z.l[row];
            out.l[row] = right.l[row] - product;
        }
    }
}
