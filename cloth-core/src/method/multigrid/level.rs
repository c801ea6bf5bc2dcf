//! One level: its matrix, and symmetric Gauss–Seidel over it with the residual taken on the way.
//!
//! The rows are divided into chunks. Within a chunk the sweep is Gauss–Seidel, between chunks Jacobi: chunks do not
//! wait for each other, and the result does not depend on how many threads share them (hybrid smoothers: A. H. Baker,
//! R. D. Falgout, T. V. Kolev, U. M. Yang, "Multigrid smoothers for ultraparallel computing", SIAM J. Sci. Comput.
//! 33(5), 2011, <https://doi.org/10.1137/100798806>). A forward sweep before the coarse correction and a backward one
//! after it make the cycle symmetric.
//!
//! It is positive definite if `M + Mᵀ − A` is, where M is the block lower triangle that a forward sweep inverts. Let D
//! be the diagonal blocks of A, L the blocks below it within a chunk, and C all blocks between chunks, so that `A = D +
//! L + Lᵀ + C`. With `M = D + L` that would be `D − C`. This is indefinite where bending couples the four vertices of a
//! hinge in two chunks. So `M = D′ + L` with a larger diagonal D′ (the ℓ₁ smoother of the same paper, section 6):
//!
//! 1. A block `B = U Σ Vᵀ` of C has the absolute value `|B| = U Σ Uᵀ` in its row and `V Σ Vᵀ` in its column. `2 xᵀB y ≤
//!    xᵀU Σ Uᵀx + yᵀV Σ Vᵀy` for all x and y.
//! 2. Let S be the sum of these over the blocks of C, in the diagonal block of each row. So `S − C` is positive
//!    semidefinite.
//! 3. `D′ = D + (S − 0.9 D)₊`, with the part above zero: D wherever that will do, as mostly with springs. It is at
//!    least D, and at least `S + 0.1 D`.
//! 4. The sum of the two is `2D′ ≥ D + S + 0.1 D`. So `M + Mᵀ − A = 2D′ − D − C ≥ 2D′ − D − S ≥ 0.1 D`.
//!
//! With contacts between vertices all chunks are swept one after another on one thread, since these may couple any two.

use super::blocks::{Block, Inverse, Lanes, lanes, plus, vector};
use super::prolongation::Prolongation;
use super::rank_one::RankOne;
use crate::math::{Mat3, Vec3};
use crate::method::block_matrix::BlockPattern;
use crate::method::chunked::map_reduce;
use crate::method::parallel::{join, wide};
use std::sync::Arc;

/// Rows of a chunk of the smoother.
const ROWS: usize = 8_192;
/// Fraction of D that blocks between chunks may take: what is left of it is what makes the cycle positive definite.
const TAKEN: f64 = 0.9;

#[derive(Debug)]
pub(super) struct Level {
    pattern: Arc<BlockPattern>,
    /// The lower half of the matrix (N/m), in the order of the pattern.
    pub(super) blocks: Vec<Block>,
    /// Inverses of the diagonal blocks (m/N); zero where nothing moves.
    inverse: Vec<Inverse>,
    is_free: Vec<bool>,
    /// Places of blocks whose column is in a chunk before, with their row.
    between: Vec<(u32, u32)>,
    /// `D′ − D` (N/m); nothing if there is one chunk.
    beyond: Vec<Block>,
    /// Whether all blocks are symmetric, as those of springs are.
    is_symmetric: bool,
    /// What is added to the matrix beside its blocks.
    pub(super) rank_one: RankOne,
    /// Right-hand side (N), solution (m) and residual (N).
    pub(super) right_hand_side: Vec<Lanes>,
    pub(super) solution: Vec<Lanes>,
    residual: Vec<Lanes>,
}

impl Level {
    pub(super) fn new(pattern: Arc<BlockPattern>, is_free: Vec<bool>) -> Self {
        let count = is_free.len();
        let mut between = Vec::new();
        for row in 0..count {
            let start = row - row % ROWS;
            let slots = pattern.row(row);
            let before = slots.filter(|&slot| (pattern.columns()[slot] as usize) < start);
            between.extend(before.map(|slot| (row as u32, slot as u32)));
        }
        let split = if count > ROWS { count } else { 0 };
        Self {
            blocks: vec![Block::ZERO; pattern.block_count()],
            inverse: vec![Inverse::ZERO; count],
            right_hand_side: vec![Lanes::ZERO; count],
            solution: vec![Lanes::ZERO; count],
            residual: vec![Lanes::ZERO; count],
            between,
            beyond: vec![Block::ZERO; split],
            is_free,
            is_symmetric: false,
            rank_one: RankOne::default(),
            pattern,
        }
    }

    pub(super) fn pattern(&self) -> &Arc<BlockPattern> {
        &self.pattern
    }

    pub(super) fn is_free(&self) -> &[bool] {
        &self.is_free
    }

    pub(super) fn len(&self) -> usize {
        self.is_free.len()
    }

    /// Updates the level for new blocks: inverts D′.
    pub(super) fn prepare(&mut self) {
        self.find_beyond();
        let [asymmetric] = map_reduce(
            &self.blocks[..],
            #[inline(always)]
            |_, blocks: &[Block]| {
                let mut count = 0.0;
                for block in blocks {
                    count += f64::from(u8::from(!block.is_symmetric()));
                }
                [count]
            },
        );
        self.is_symmetric = asymmetric == 0.0;
        let (pattern, blocks, is_free) = (&self.pattern, &self.blocks, &self.is_free);
        let added = (!self.rank_one.is_empty()).then_some(&self.rank_one);
        let beyond = &self.beyond;
        map_reduce(
            &mut self.inverse[..],
            #[inline(always)]
            |start, inverse: &mut [Inverse]| {
                for (row, inverse) in (start..).zip(inverse) {
                    *inverse = Inverse::ZERO;
                    if is_free[row] {
                        let mut block = blocks[pattern.row(row).end - 1].to_double();
                        if let Some(added) = added {
                            block += added.diagonal(row);
                        }
                        if let Some(beyond) = beyond.get(row) {
                            block += beyond.to_double();
                        }
                        *inverse = Inverse::of(&block);
                    }
                }
                []
            },
        );
    }

    /// Updates `D′ − D`, the part above zero of `Σ|B| − 0.9 D`.
    fn find_beyond(&mut self) {
        self.beyond.fill(Block::ZERO);
        for &(row, slot) in &self.between {
            let column = self.pattern.columns()[slot as usize];
            let [of_row, of_column] = absolute(&self.blocks[slot as usize]);
            self.beyond[row as usize].add(&Block::from(&of_row), 1.0);
            self.beyond[column as usize].add(&Block::from(&of_column), 1.0);
        }
        for (row, beyond) in self.beyond.iter_mut().enumerate() {
            if *beyond != Block::ZERO {
                let own = self.blocks[self.pattern.row(row).end - 1].to_double();
                let missing = beyond.to_double() - own * TAKEN;
                if (-missing).cholesky().is_some() {
                    *beyond = Block::ZERO;
                    continue;
                }
                let mut eigen = missing.symmetric_eigen();
                eigen.eigenvalues.apply(|value| *value = value.max(0.0));
                *beyond = Block::from(&eigen.recompose());
            }
        }
    }

    /// Takes a right-hand side (N).
    pub(super) fn take(&mut self, r: &[Vec3]) {
        map_reduce(
            (&mut self.right_hand_side[..], r),
            #[inline(always)]
            |_, (own, r): (&mut [Lanes], &[Vec3])| {
                for (own, r) in own.iter_mut().zip(r) {
                    *own = lanes(r);
                }
                []
            },
        );
    }

    /// Gives the solution (m).
    pub(super) fn give(&self, z: &mut [Vec3]) {
        map_reduce(
            (z, &self.solution[..]),
            #[inline(always)]
            |_, (z, own): (&mut [Vec3], &[Lanes])| {
                for (z, own) in z.iter_mut().zip(own) {
                    *z = vector(own);
                }
                []
            },
        );
    }

    /// A forward sweep from zero, and its residual.
    pub(super) fn smooth_forward(&mut self) {
        let mut solution = std::mem::take(&mut self.solution);
        let mut residual = std::mem::take(&mut self.residual);
        let (x, t) = (&mut solution[..], &mut residual[..]);
        if !self.rank_one.is_empty() {
            match self.is_symmetric {
                true => self.sweep_with_rank_one::<false, true>(x, t),
                false => self.sweep_with_rank_one::<false, false>(x, t),
            }
            self.couple(&solution, &mut residual);
            (self.solution, self.residual) = (solution, residual);
            return;
        }
        match self.is_symmetric {
            true => self.sweep::<false, true>(0, x, t),
            false => self.sweep::<false, false>(0, x, t),
        }
        // What the chunks did not know of each other.
        self.couple(&solution, &mut residual);
        (self.solution, self.residual) = (solution, residual);
    }

    /// A backward sweep from the solution so far.
    pub(super) fn smooth_backward(&mut self) {
        let mut solution = std::mem::take(&mut self.solution);
        let mut residual = std::mem::take(&mut self.residual);
        residual.copy_from_slice(&self.right_hand_side);
        self.couple(&solution, &mut residual);
        let (x, t) = (&mut solution[..], &mut residual[..]);
        if !self.rank_one.is_empty() {
            match self.is_symmetric {
                true => self.sweep_with_rank_one::<true, true>(x, t),
                false => self.sweep_with_rank_one::<true, false>(x, t),
            }
            (self.solution, self.residual) = (solution, residual);
            return;
        }
        match self.is_symmetric {
            true => self.sweep::<true, true>(0, x, t),
            false => self.sweep::<true, false>(0, x, t),
        }
        (self.solution, self.residual) = (solution, residual);
    }

    /// Subtracts the products of the blocks between chunks from the residual.
    fn couple(&self, solution: &[Lanes], residual: &mut [Lanes]) {
        for &(row, slot) in &self.between {
            let (row, column) = (row as usize, self.pattern.columns()[slot as usize] as usize);
            let block = &self.blocks[slot as usize];
            residual[row] -= block.times(&solution[column]);
            residual[column] -= block.transposed_times::<false>(&solution[row]);
        }
    }

    /// Sweeps over the rows from `start` on, forward or `BACK`, on several threads where that pays.
    fn sweep<const BACK: bool, const SYMMETRIC: bool>(
        &self,
        start: usize,
        x: &mut [Lanes],
        t: &mut [Lanes],
    ) {
        let count = x.len();
        if count <= ROWS {
            return wide(
                #[inline(always)]
                || {
                    for step in 0..count {
                        let row = if BACK { count - 1 - step } else { step };
                        self.relax::<BACK, SYMMETRIC>(start, row, x, t, None);
                    }
                },
            );
        }
        let half = (count / 2).next_multiple_of(ROWS);
        let (x, t) = (x.split_at_mut(half), t.split_at_mut(half));
        join(
            self.len(),
            || self.sweep::<BACK, SYMMETRIC>(start, x.0, t.0),
            || self.sweep::<BACK, SYMMETRIC>(start + half, x.1, t.1),
        );
    }

    /// The same with what is added to the matrix, one chunk after another.
    fn sweep_with_rank_one<const BACK: bool, const SYMMETRIC: bool>(
        &mut self,
        x: &mut [Lanes],
        t: &mut [Lanes],
    ) {
        let mut added = std::mem::take(&mut self.rank_one);
        added.start(BACK.then_some(&*x));
        let chunks = x.len().div_ceil(ROWS);
        wide(
            #[inline(always)]
            || {
                for step in 0..chunks {
                    let start = ROWS * if BACK { chunks - 1 - step } else { step };
                    let end = x.len().min(start + ROWS);
                    let (x, t) = (&mut x[start..end], &mut t[start..end]);
                    let count = end - start;
                    for step in 0..count {
                        let row = if BACK { count - 1 - step } else { step };
                        self.relax::<BACK, SYMMETRIC>(start, row, x, t, Some(&mut added));
                    }
                }
            },
        );
        if !BACK {
            // Each row has added what was known when it was its turn.
            added.subtract(t);
        }
        self.rank_one = added;
    }

    /// One row of a chunk that begins at row `start`. Forward, from zero: `x = D′⁻¹(r − L x)`, `t = (D′ − D) x − Lᵀx`,
    /// the residual. Backward, with the residual of what is known in `t`: `x ← D′⁻¹(t − L x + (D′ − D) x)`,
    /// `t ← t − Lᵀx`.
    #[inline(always)]
    fn relax<const BACK: bool, const SYMMETRIC: bool>(
        &self,
        start: usize,
        row: usize,
        x: &mut [Lanes],
        t: &mut [Lanes],
        mut added: Option<&mut RankOne>,
    ) {
        let mut rest = t[row];
        if !BACK {
            rest = self.right_hand_side[start + row];
            t[row] = Lanes::ZERO;
        }
        if !self.is_free[start + row] {
            if !BACK {
                x[row] = Lanes::ZERO;
            }
            return;
        }
        let slots = self.pattern.row(start + row);
        let slots = slots.start..slots.end - 1;
        let (columns, blocks) = (&self.pattern.columns()[slots.clone()], &self.blocks[slots]);
        for (&column, block) in columns.iter().zip(blocks) {
            if let Some(other) = x.get((column as usize).wrapping_sub(start)) {
                rest -= block.times(other);
            }
        }
        let beyond = self.beyond.get(start + row);
        if let (true, Some(beyond)) = (BACK, beyond) {
            rest += beyond.times(&x[row]);
        }
        if let Some(added) = &mut added {
            if BACK {
                added.moved(start + row, &x[row], -1.0);
            }
            rest = added.without(start + row, rest);
        }
        let own = self.inverse[start + row].times(&rest);
        x[row] = own;
        if let (false, Some(beyond)) = (BACK, beyond) {
            t[row] += beyond.times(&own);
        }
        if let Some(added) = added {
            added.moved(start + row, &own, 1.0);
            if !BACK {
                let known = added.without(start + row, Lanes::ZERO);
                t[row] -= known;
            }
        }
        for (&column, block) in columns.iter().zip(blocks) {
            if let Some(t) = t.get_mut((column as usize).wrapping_sub(start)) {
                *t -= block.transposed_times::<SYMMETRIC>(&own);
            }
        }
    }

    /// Restricts the residual: `coarse = Pᵀ t`.
    pub(super) fn restrict(&self, prolongation: &Prolongation, coarse: &mut [Lanes]) {
        let fine = &self.residual;
        map_reduce(
            coarse,
            #[inline(always)]
            |start, coarse: &mut [Lanes]| {
                for (vertex, out) in (start..).zip(coarse) {
                    let mut sum = Lanes::ZERO;
                    for &(from, weight) in prolongation.of_coarse(vertex) {
                        sum = plus(sum, weight as f32, &fine[from as usize]);
                    }
                    *out = sum;
                }
                []
            },
        );
    }

    /// Adds the coarse correction: `x += P coarse`.
    pub(super) fn correct(&mut self, prolongation: &Prolongation, coarse: &[Lanes]) {
        map_reduce(
            &mut self.solution[..],
            #[inline(always)]
            |start, solution: &mut [Lanes]| {
                for (vertex, out) in (start..).zip(solution) {
                    for &(parent, weight) in prolongation.of_fine(vertex) {
                        *out = plus(*out, weight as f32, &coarse[parent as usize]);
                    }
                }
                []
            },
        );
    }
}

/// |B| (N/m) in its row and in its column.
fn absolute(block: &Block) -> [Mat3; 2] {
    let b = block.to_double();
    // That of a spring is −B, and singular to rounding.
    let rounding = Mat3::from_diagonal_element(f64::from(f32::EPSILON) * b.norm());
    if block.is_symmetric() && (rounding * 10.0 - b).cholesky().is_some() {
        return [-b; 2];
    }
    let svd = b.svd(true, true);
    let sigma = Mat3::from_diagonal(&svd.singular_values);
    let of = |q: Option<Mat3>| q.map_or(Mat3::zeros(), |q| q * sigma * q.transpose());
    [of(svd.u), of(svd.v_t.map(|v_t| v_t.transpose()))]
}
