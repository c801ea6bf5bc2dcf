//! A dense Cholesky factorisation `A = L Lᵀ` of some hundred rows, three of them at a time.
//!
//! Golub and Van Loan, *Matrix Computations*, 4th edition, section 4.2.5, row by row: each number of `L` is one of `A`
//! less the dot product of two rows of `L`, both read in the order in which they lie in memory.

use crate::math::{Mat3, Real};
use crate::method::parallel::wide;
use wide::f64x4;

/// Numbers that are multiplied at once.
type Lanes = [Real; 4];

/// A symmetric positive definite matrix of 3 × 3 blocks, and then its factor in the same memory.
#[derive(Debug)]
pub(super) struct Dense {
    /// Of a row, in lanes.
    width: usize,
    /// What is below the diagonal, row after row, and zeros; on the diagonal the matrix, and zeros in the factor.
    rows: Vec<Lanes>,
    /// The inverse of each number on the diagonal of the factor.
    inverse: Vec<Real>,
    /// The right-hand side, then `L⁻¹` times it, then the solution; zeros behind it.
    vector: Vec<Lanes>,
}

impl Dense {
    /// Zero, of so many blocks a row.
    pub(super) fn new(block_count: usize) -> Self {
        let width = (3 * block_count).div_ceil(4);
        Self {
            width,
            rows: vec![[0.0; 4]; 3 * block_count * width],
            inverse: vec![0.0; 3 * block_count],
            vector: vec![[0.0; 4]; width],
        }
    }

    pub(super) fn clear(&mut self) {
        self.rows.as_flattened_mut().fill(0.0);
    }

    /// Adds a block, of which only what is not above the diagonal counts.
    pub(super) fn add(&mut self, row: usize, column: usize, block: &Mat3) {
        let rows = self.rows.as_flattened_mut();
        for (i, j) in (0..9).map(|entry| (entry % 3, entry / 3)) {
            let (row, column) = (3 * row + i, 3 * column + j);
            if column <= row {
                rows[4 * self.width * row + column] += block[(i, j)];
            }
        }
    }

    /// Makes the diagonal larger by a part of itself.
    pub(super) fn shift(&mut self, part: Real) {
        let step = 4 * self.width + 1;
        for number in self.rows.as_flattened_mut().iter_mut().step_by(step) {
            *number *= 1.0 + part;
        }
    }

    /// Writes the factor over the matrix. Returns whether the matrix is positive definite; otherwise there is neither.
    pub(super) fn factorize(&mut self) -> bool {
        wide(
            #[inline(always)]
            || {
                for block in 0..self.inverse.len() / 3 {
                    if !self.factorize_rows(block) {
                        return false;
                    }
                }
                true
            },
        )
    }

    /// The three rows of a block, after those above.
    #[inline(always)]
    fn factorize_rows(&mut self, block: usize) -> bool {
        let (width, first) = (self.width, 3 * block);
        let (above, rows) = self.rows.split_at_mut(first * width);
        let (top, rows) = rows.split_at_mut(width);
        let (middle, rows) = rows.split_at_mut(width);
        let mut rows = [top, middle, &mut rows[..width]];
        for (column, other) in above.chunks_exact(width).enumerate() {
            let products = dot_each([&*rows[0], &*rows[1], &*rows[2]], other, column);
            for (row, product) in rows.iter_mut().zip(products) {
                let number = &mut row.as_flattened_mut()[column];
                *number = (*number - product) * self.inverse[column];
            }
        }
        for last in 0..3 {
            let (done, rest) = rows.split_at_mut(last);
            let row = &mut *rest[0];
            for (column, other) in (first..).zip(done) {
                let [product] = dot_each([row], other, column);
                let number = &mut row.as_flattened_mut()[column];
                *number = (*number - product) * self.inverse[column];
            }
            let diagonal = std::mem::take(&mut row.as_flattened_mut()[first + last]);
            let [product] = dot_each([row], row, first + last);
            let square = diagonal - product;
            if !(square > 0.0 && square.is_finite()) {
                return false;
            }
            self.inverse[first + last] = 1.0 / square.sqrt();
        }
        true
    }

    /// Right-hand side, then solution, of [`Dense::solve`].
    pub(super) fn vector(&mut self) -> &mut [Real] {
        &mut self.vector.as_flattened_mut()[..self.inverse.len()]
    }

    /// Solves with the factor.
    pub(super) fn solve(&mut self) {
        wide(
            #[inline(always)]
            || {
                self.solve_lower();
                self.solve_upper();
            },
        );
    }

    #[inline(always)]
    fn solve_lower(&mut self) {
        let rows = self.rows.chunks_exact(self.width);
        for (number, (row, inverse)) in rows.zip(&self.inverse).enumerate() {
            let [product] = dot_each([row], &self.vector, number);
            let number = &mut self.vector.as_flattened_mut()[number];
            *number = (*number - product) * inverse;
        }
    }

    #[inline(always)]
    fn solve_upper(&mut self) {
        let rows = self.rows.chunks_exact(self.width);
        for (number, (row, inverse)) in rows.zip(&self.inverse).enumerate().rev() {
            let solution = &mut self.vector.as_flattened_mut()[number];
            *solution *= inverse;
            let solution = *solution;
            let used = number.div_ceil(4);
            let by = f64x4::splat(solution);
            for (sum, &row) in self.vector[..used].iter_mut().zip(&row[..used]) {
                *sum = (f64x4::new(*sum) - f64x4::new(row) * by).to_array();
            }
        }
    }
}

/// Dot products of rows with another one, of which the first `count` numbers count and those up to the next full lanes
/// are zero in one of both.
#[inline(always)]
fn dot_each<const N: usize>(rows: [&[Lanes]; N], other: &[Lanes], count: usize) -> [Real; N] {
    let used = count.div_ceil(4);
    let rows = rows.map(|row| &row[..used]);
    let mut sums = [f64x4::ZERO; N];
    for (number, &other) in other[..used].iter().enumerate() {
        let other = f64x4::new(other);
        for (sum, row) in sums.iter_mut().zip(&rows) {
            *sum += f64x4::new(row[number]) * other;
        }
    }
    sums.map(|sum| {
        let [a, b, c, d] = sum.to_array();
        (a + b) + (c + d)
    })
}
