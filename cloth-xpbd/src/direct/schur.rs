//! Solvers of the dual system, the Schur complement in the multipliers: `S Δλ̂ = r_λ − Ĵ B r_x`,
//! `S = Ĵ B Ĵᵀ + α̂`, `Δx̂ = B (r_x + Ĵᵀ Δλ̂)`, where B is the inverse of a block-diagonal `I + K̂`.

use super::kkt::{Kkt, KktVector};
use super::minres::KrylovReport;
use super::saddle::{dual_diagonal, inverse_blocks};
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::linear::{Cholesky, CholeskyError, UpperPattern};

/// Reduction to the dual system and back, for both of its solvers.
#[derive(Debug)]
struct Dual {
    /// B.
    blocks: Vec<Mat3>,
    /// Scratch, one per vertex.
    forces: Vec<Vec3>,
}

impl Dual {
    fn new(kkt: &Kkt) -> Self {
        Self {
            blocks: vec![Mat3::identity(); kkt.vertex_scale.len()],
            forces: vec![Vec3::zeros(); kkt.vertex_scale.len()],
        }
    }

    /// `r_λ − Ĵ B r_x`.
    fn reduce(&mut self, kkt: &Kkt, right: &KktVector, out: &mut [Real]) {
        for (force, (block, x)) in self.forces.iter_mut().zip(self.blocks.iter().zip(&right.x)) {
            *force = block * x;
        }
        for (row, out) in out.iter_mut().enumerate() {
            *out = right.l[row] - kkt.row_product(row, &self.forces);
        }
    }

    /// `Δx̂ = B (r_x + Ĵᵀ Δλ̂)` from `out.l`.
    fn expand(&self, kkt: &Kkt, right: &KktVector, out: &mut KktVector) {
        out.x.copy_from_slice(&right.x);
        kkt.add_forces(&out.l, 1.0, &mut out.x);
        for (v, x) in out.x.iter_mut().enumerate() {
            *x = if kkt.vertex_scale[v] == 0.0 {
                Vec3::zeros()
            } else {
                self.blocks[v] * *x
            };
        }
    }

    /// `y = S l`.
    fn apply(&mut self, kkt: &Kkt, l: &[Real], y: &mut [Real]) {
        self.forces.fill(Vec3::zeros());
        kkt.add_forces(l, 1.0, &mut self.forces);
        for (force, block) in self.forces.iter_mut().zip(&self.blocks) {
            *force = block * *force;
        }
        for (row, y) in y.iter_mut().enumerate() {
            *y = kkt.row_product(row, &self.forces) + kkt.normalized_compliance[row] * l[row];
        }
    }
}

/// S by sparse Cholesky. Two rows have an entry where they share a vertex that can move.
#[derive(Debug)]
pub(super) struct SchurFactor {
    dual: Dual,
    cholesky: Cholesky,
    /// Entries at each vertex that can move, rows ascending: `at[start[v]..start[v + 1]]`.
    start: Vec<u32>,
    at: Vec<u32>,
    /// Row of each entry.
    row_of: Vec<u32>,
    /// Scratch: one column of S.
    column: Vec<Real>,
}

impl SchurFactor {
    pub(super) fn analyze(kkt: &Kkt) -> Result<Self, CholeskyError> {
        let (vertices, rows) = (kkt.vertex_scale.len(), kkt.row_count());
        let mut row_of = vec![0; kkt.vertices.len()];
        let mut start = vec![0_u32; vertices + 1];
        for row in 0..rows {
            for e in kkt.entries(row) {
                row_of[e] = row as u32;
                start[kkt.vertices[e] as usize + 1] += 1;
            }
        }
        for v in 0..vertices {
            start[v + 1] += start[v];
        }
        let mut next = start.clone();
        let mut at = vec![0; kkt.vertices.len()];
        for (e, &v) in kkt.vertices.iter().enumerate() {
            at[next[v as usize] as usize] = e as u32;
            next[v as usize] += 1;
        }
        let mut pattern = UpperPattern {
            column_offsets: vec![0],
            rows: Vec::new(),
        };
        let mut last_seen = vec![u32::MAX; rows];
        for row in 0..rows {
            let begin = pattern.rows.len();
            pattern.rows.push(row as u32);
            last_seen[row] = row as u32;
            for e in kkt.entries(row) {
                let v = kkt.vertices[e] as usize;
                if kkt.vertex_scale[v] == 0.0 {
                    continue;
                }
                for &other in &at[start[v] as usize..start[v + 1] as usize] {
                    let other = row_of[other as usize];
                    if other < row as u32 && last_seen[other as usize] != row as u32 {
                        last_seen[other as usize] = row as u32;
                        pattern.rows.push(other);
                    }
                }
            }
            pattern.rows[begin..].sort_unstable();
            let end = u32::try_from(pattern.rows.len()).map_err(|_| CholeskyError::TooLarge)?;
            pattern.column_offsets.push(end);
        }
        Ok(Self {
            dual: Dual::new(kkt),
            cholesky: Cholesky::analyze(pattern)?,
            start,
            at,
            row_of,
            column: vec![0.0; rows],
        })
    }

    pub(super) fn factor_len(&self) -> usize {
        self.cholesky.factor_len()
    }

    /// Factorises with `shift` added to every α̂.
    pub(super) fn factorize(&mut self, kkt: &Kkt, shift: Real) -> Result<(), CholeskyError> {
        inverse_blocks(kkt, &mut self.dual.blocks);
        let mut filled = 0;
        for row in 0..kkt.row_count() {
            for e in kkt.entries(row) {
                let v = kkt.vertices[e] as usize;
                if kkt.vertex_scale[v] == 0.0 {
                    continue;
                }
                let moved = self.dual.blocks[v] * kkt.jacobian[e];
                for &other in &self.at[self.start[v] as usize..self.start[v + 1] as usize] {
                    let other_row = self.row_of[other as usize] as usize;
                    if other_row > row {
                        break;
                    }
                    self.column[other_row] += kkt.jacobian[other as usize].dot(&moved);
                }
            }
            self.column[row] += kkt.normalized_compliance[row] + shift;
            let pattern = self.cholesky.pattern();
            let range =
                pattern.column_offsets[row] as usize..pattern.column_offsets[row + 1] as usize;
            for slot in range {
                let r = self.cholesky.pattern().rows[slot] as usize;
                self.cholesky.values_mut()[filled] = self.column[r];
                self.column[r] = 0.0;
                filled += 1;
            }
        }
        self.cholesky.factorize()
    }

    pub(super) fn solve(&mut self, kkt: &Kkt, right: &KktVector, out: &mut KktVector) {
        self.dual.reduce(kkt, right, &mut out.l);
        if !out.l.is_empty() {
            self.cholesky.solve_in_place(&mut out.l);
        }
        self.dual.expand(kkt, right, out);
    }
}

/// S by conjugate gradients, preconditioned by its diagonal.
#[derive(Debug)]
pub(super) struct SchurCg {
    dual: Dual,
    right: Vec<Real>,
    direction: Vec<Real>,
    product: Vec<Real>,
    /// Inverse diagonal of S.
    diagonal: Vec<Real>,
}

impl SchurCg {
    pub(super) fn new(kkt: &Kkt) -> Self {
        let zeros = || vec![0.0; kkt.row_count()];
        Self {
            dual: Dual::new(kkt),
            right: zeros(),
            direction: zeros(),
            product: zeros(),
            diagonal: zeros(),
        }
    }

    pub(super) fn solve(
        &mut self,
        kkt: &Kkt,
        right: &KktVector,
        out: &mut KktVector,
        tolerance: Real,
        most: u32,
    ) -> KrylovReport {
        inverse_blocks(kkt, &mut self.dual.blocks);
        for row in 0..kkt.row_count() {
            self.diagonal[row] = 1.0 / dual_diagonal(kkt, &self.dual.blocks, row);
        }
        self.dual.reduce(kkt, right, &mut self.right);
        out.l.fill(0.0);
        // In the norm of the preconditioner, with the residual in `right`.
        let norm =
            |r: &[Real], d: &[Real]| -> Real { r.iter().zip(d).map(|(r, d)| r * d * r).sum() };
        self.direction.fill(0.0);
        let start = norm(&self.right, &self.diagonal);
        let (mut now, mut before) = (start, Real::INFINITY);
        let mut iterations = 0;
        while now > tolerance * tolerance * start && iterations < most {
            let keep = now / before;
            for row in 0..self.right.len() {
                self.direction[row] =
                    self.diagonal[row] * self.right[row] + keep * self.direction[row];
            }
            self.dual.apply(kkt, &self.direction, &mut self.product);
            let pairs = self.direction.iter().zip(&self.product);
            let curvature: Real = pairs.map(|(d, p)| d * p).sum();
            if curvature <= 0.0 || curvature.is_nan() {
                break; // singular: what is left of the right-hand side is out of reach
            }
            let length = now / curvature;
            for row in 0..self.right.len() {
                out.l[row] += length * self.direction[row];
                self.right[row] -= length * self.product[row];
            }
            before = now;
            now = norm(&self.right, &self.diagonal);
            iterations += 1;
        }
        self.dual.expand(kkt, right, out);
        KrylovReport {
            iterations,
            residual: if start > 0.0 {
                (now / start).sqrt()
            } else {
                0.0
            },
        }
    }
}
