//! Solvers of the primal–dual system, positions and multipliers together. With `y = −Δλ̂` the matrix is
//! symmetric, `[I + K̂  Ĵᵀ; Ĵ  −α̂]`.

use super::kkt::{Kkt, KktVector};
use super::minres::{KrylovReport, Minres};
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::linear::{CholeskyError, QuasidefiniteLdlt, UpperPattern};

/// Number of the first of the three unknowns of each vertex; `PRESCRIBED` for those that have none.
#[derive(Clone, Debug)]
struct Numbering {
    first: Vec<u32>,
    free: usize,
}

const PRESCRIBED: u32 = u32::MAX;

impl Numbering {
    fn of(kkt: &Kkt) -> Self {
        let mut free = 0;
        let first = kkt.vertex_scale.iter().map(|&s| {
            if s == 0.0 {
                return PRESCRIBED;
            }
            free += 3;
            free - 3
        });
        Self {
            first: first.collect(),
            free: free as usize,
        }
    }

    /// A right-hand side: the equations of the positions first, then those of the rows.
    fn pack(&self, from: &KktVector, to: &mut [Real]) {
        for (&first, x) in self.first.iter().zip(&from.x) {
            if first != PRESCRIBED {
                to[first as usize..first as usize + 3].copy_from_slice(x.as_slice());
            }
        }
        to[self.free..].copy_from_slice(&from.l);
    }

    /// A solution: the sign of the multipliers is changed back.
    fn unpack(&self, from: &[Real], to: &mut KktVector) {
        for (&first, x) in self.first.iter().zip(&mut to.x) {
            *x = if first == PRESCRIBED {
                Vec3::zeros()
            } else {
                Vec3::from_column_slice(&from[first as usize..first as usize + 3])
            };
        }
        for (l, y) in to.l.iter_mut().zip(&from[self.free..]) {
            *l = -y;
        }
    }
}

/// The factorisation `L D Lᵀ`, analysed once.
#[derive(Debug)]
pub(super) struct SaddleFactor {
    numbering: Numbering,
    factor: QuasidefiniteLdlt,
    /// Entries of each row in the order of their vertices.
    sorted: Vec<u32>,
    vector: Vec<Real>,
}

impl SaddleFactor {
    pub(super) fn analyze(kkt: &Kkt) -> Result<Self, CholeskyError> {
        let numbering = Numbering::of(kkt);
        let mut sorted: Vec<u32> = (0..kkt.vertices.len() as u32).collect();
        for row in 0..kkt.row_count() {
            sorted[kkt.entries(row)].sort_by_key(|&e| kkt.vertices[e as usize]);
        }
        let mut rows = Vec::new();
        let mut column_offsets = vec![0];
        let pattern = kkt.hessian.pattern();
        let mut close = |rows: &Vec<u32>| {
            let end = u32::try_from(rows.len()).map_err(|_| CholeskyError::TooLarge);
            end.map(|end| column_offsets.push(end))
        };
        for v in 0..pattern.row_count() {
            if numbering.first[v] == PRESCRIBED {
                continue;
            }
            for axis in 0..3 {
                for &column in &pattern.columns()[pattern.row(v)] {
                    let first = numbering.first[column as usize];
                    if first != PRESCRIBED {
                        let height = if column as usize == v { axis + 1 } else { 3 };
                        rows.extend(first..first + height);
                    }
                }
                close(&rows)?;
            }
        }
        for row in 0..kkt.row_count() {
            for &e in &sorted[kkt.entries(row)] {
                let first = numbering.first[kkt.vertices[e as usize] as usize];
                if first != PRESCRIBED {
                    rows.extend(first..first + 3);
                }
            }
            rows.push((numbering.free + row) as u32);
            close(&rows)?;
        }
        let pattern = UpperPattern {
            column_offsets,
            rows,
        };
        Ok(Self {
            vector: vec![0.0; pattern.dimension()],
            factor: QuasidefiniteLdlt::analyze(pattern, numbering.free)?,
            sorted,
            numbering,
        })
    }

    pub(super) fn factor_len(&self) -> usize {
        self.factor.factor_len()
    }

    /// Factorises with `shift` added to every α̂.
    pub(super) fn factorize(&mut self, kkt: &Kkt, shift: Real) -> Result<(), CholeskyError> {
        let mut values = self.factor.values_mut().iter_mut();
        let mut push = |value: Real| {
            *values.next().expect("the pattern that was analysed") = value;
        };
        let pattern = kkt.hessian.pattern();
        for v in 0..pattern.row_count() {
            if self.numbering.first[v] == PRESCRIBED {
                continue;
            }
            for axis in 0..3 {
                for slot in pattern.row(v) {
                    let column = pattern.columns()[slot] as usize;
                    if self.numbering.first[column] != PRESCRIBED {
                        let height = if column == v { axis + 1 } else { 3 };
                        (0..height).for_each(|k| push(kkt.hessian.blocks()[slot][(axis, k)]));
                    }
                }
            }
        }
        for row in 0..kkt.row_count() {
            for &e in &self.sorted[kkt.entries(row)] {
                if self.numbering.first[kkt.vertices[e as usize] as usize] != PRESCRIBED {
                    kkt.jacobian[e as usize].iter().for_each(|&j| push(j));
                }
            }
            push(-(kkt.normalized_compliance[row] + shift));
        }
        self.factor.factorize()
    }

    pub(super) fn solve(&mut self, right: &KktVector, out: &mut KktVector) {
        self.numbering.pack(right, &mut self.vector);
        self.factor.solve_in_place(&mut self.vector);
        self.numbering.unpack(&self.vector, out);
    }
}

/// MINRES on the same matrix, with its block diagonal as preconditioner.
#[derive(Debug)]
pub(super) struct SaddleMinres {
    numbering: Numbering,
    minres: Minres,
    /// Inverse diagonal blocks of `I + K̂`, and the inverse diagonal of `Ĵ (I + K̂)⁻¹ Ĵᵀ + α̂` with those.
    blocks: Vec<Mat3>,
    diagonal: Vec<Real>,
    right: Vec<Real>,
    solution: Vec<Real>,
    work: [KktVector; 2],
}

impl SaddleMinres {
    pub(super) fn new(kkt: &Kkt) -> Self {
        let numbering = Numbering::of(kkt);
        let (vertices, rows) = (kkt.vertex_scale.len(), kkt.row_count());
        let n = numbering.free + rows;
        Self {
            minres: Minres::new(n),
            blocks: vec![Mat3::identity(); vertices],
            diagonal: vec![1.0; rows],
            right: vec![0.0; n],
            solution: vec![0.0; n],
            work: [
                KktVector::zeros(vertices, rows),
                KktVector::zeros(vertices, rows),
            ],
            numbering,
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
        inverse_blocks(kkt, &mut self.blocks);
        for row in 0..kkt.row_count() {
            self.diagonal[row] = 1.0 / dual_diagonal(kkt, &self.blocks, row);
        }
        self.numbering.pack(right, &mut self.right);
        let (numbering, blocks, diagonal) = (&self.numbering, &self.blocks, &self.diagonal);
        let [a, b] = &mut self.work;
        let end = self.minres.solve(
            |x, y| {
                numbering.unpack(x, a);
                // `unpack` gives l = −y, for which the first row is that of the matrix and the second is too.
                kkt.hessian.multiply(&a.x, &mut b.x);
                kkt.add_forces(&a.l, -1.0, &mut b.x);
                for row in 0..kkt.row_count() {
                    b.l[row] =
                        kkt.row_product(row, &a.x) + kkt.normalized_compliance[row] * a.l[row];
                }
                numbering.pack(b, y);
            },
            |r, z| {
                for (v, &first) in numbering.first.iter().enumerate() {
                    if first != PRESCRIBED {
                        let at = first as usize..first as usize + 3;
                        let solved = blocks[v] * Vec3::from_column_slice(&r[at.clone()]);
                        z[at].copy_from_slice(solved.as_slice());
                    }
                }
                for (row, inverse) in diagonal.iter().enumerate() {
                    z[numbering.free + row] = inverse * r[numbering.free + row];
                }
            },
            &self.right,
            &mut self.solution,
            tolerance,
            most,
        );
        self.numbering.unpack(&self.solution, out);
        end
    }
}

/// Inverses of the diagonal blocks of `I + K̂`.
pub(super) fn inverse_blocks(kkt: &Kkt, out: &mut [Mat3]) {
    let pattern = kkt.hessian.pattern();
    for (v, out) in out.iter_mut().enumerate() {
        let block = kkt.hessian.blocks()[pattern.row(v).end - 1];
        *out = block.try_inverse().unwrap_or_else(Mat3::zeros);
    }
}

/// Diagonal entry of `Ĵ B Ĵᵀ + α̂` for block-diagonal B.
pub(super) fn dual_diagonal(kkt: &Kkt, blocks: &[Mat3], row: usize) -> Real {
    let mut sum = kkt.normalized_compliance[row];
    for e in kkt.entries(row) {
        let j = kkt.jacobian[e];
        sum += j.dot(&(blocks[kkt.vertices[e] as usize] * j));
    }
    sum
}
