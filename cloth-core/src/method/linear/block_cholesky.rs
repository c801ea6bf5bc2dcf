//! Cholesky factorisation of a [`BlockMatrix`], without the rows and columns of prescribed vertices.

use super::cholesky::{Cholesky, CholeskyError, UpperPattern};
use super::fill::{self, Elimination, FillOrdering};
use super::solver::{LinearError, LinearReport, LinearSolver, dot};
use crate::math::{Real, Vec3};
use crate::method::block_matrix::{BlockMatrix, BlockPattern};
use crate::step::Outcome;

/// Factor of the part of a block matrix that belongs to free vertices.
#[derive(Debug)]
pub struct BlockCholesky {
    cholesky: Cholesky,
    /// Number of each free vertex among the free ones; `PRESCRIBED` for the others.
    free_index: Vec<u32>,
    right_hand_side: Vec<Real>,
    /// `b − A x` of a solve through [`LinearSolver`].
    residual: Vec<Vec3>,
}

const PRESCRIBED: u32 = u32::MAX;

impl BlockCholesky {
    /// Analyses the pattern, in the better of the two orders; `is_free[v]` says whether vertex `v` takes part.
    ///
    /// # Errors
    /// [`CholeskyError::TooLarge`].
    ///
    /// # Panics
    /// If `is_free` does not have one entry per row of the pattern.
    pub fn analyze(pattern: &BlockPattern, is_free: &[bool]) -> Result<Self, CholeskyError> {
        Self::analyze_by(pattern, is_free, fill::best)
    }

    /// The same in a given order, for comparisons.
    ///
    /// # Errors
    /// [`CholeskyError::TooLarge`].
    ///
    /// # Panics
    /// If `is_free` does not have one entry per row of the pattern.
    pub fn analyze_with(
        pattern: &BlockPattern,
        is_free: &[bool],
        ordering: FillOrdering,
    ) -> Result<Self, CholeskyError> {
        Self::analyze_by(pattern, is_free, |graph| ordering.elimination(graph))
    }

    fn analyze_by(
        pattern: &BlockPattern,
        is_free: &[bool],
        order: impl FnOnce(&UpperPattern) -> Result<Elimination, CholeskyError>,
    ) -> Result<Self, CholeskyError> {
        assert_eq!(is_free.len(), pattern.row_count(), "one flag per row");
        let free_index = numbered(is_free);
        let free_count = is_free.iter().filter(|free| **free).count();
        Ok(Self {
            cholesky: Cholesky::analyze_in_order(
                upper_pattern(pattern, &free_index)?,
                for_coordinates(order(&vertex_pattern(pattern, &free_index))?),
            )?,
            right_hand_side: vec![0.0; 3 * free_count],
            residual: vec![Vec3::zeros(); free_index.len()],
            free_index,
        })
    }

    /// Numbers stored in the factor.
    #[must_use]
    pub fn factor_len(&self) -> usize {
        self.cholesky.factor_len()
    }

    /// The ordering of the vertices taken.
    #[must_use]
    pub fn ordering(&self) -> FillOrdering {
        self.cholesky.ordering()
    }

    /// Factorises the numbers of `matrix`, which has the pattern that was analysed.
    ///
    /// # Errors
    /// [`CholeskyError::NotPositiveDefinite`].
    ///
    /// # Panics
    /// If `matrix` does not have the pattern that was analysed.
    pub fn factorize(&mut self, matrix: &BlockMatrix) -> Result<(), CholeskyError> {
        let mut values = self.cholesky.values_mut().iter_mut();
        for_each_value(matrix, &self.free_index, |value| {
            *values.next().expect("the pattern that was analysed") = value;
        });
        self.cholesky.factorize()
    }

    /// Solves `A x = b` over the free vertices; `x` is set to zero at the others.
    ///
    /// # Panics
    /// If `b` or `x` does not have one entry per row, or no factorisation has succeeded.
    pub fn solve(&mut self, b: &[Vec3], x: &mut [Vec3]) {
        assert_eq!(b.len(), self.free_index.len(), "length of b");
        assert_eq!(x.len(), self.free_index.len(), "length of x");
        for (&index, b) in self.free_index.iter().zip(b) {
            if index != PRESCRIBED {
                let at = 3 * index as usize;
                self.right_hand_side[at..at + 3].copy_from_slice(b.as_slice());
            }
        }
        self.cholesky.solve_in_place(&mut self.right_hand_side);
        for (&index, x) in self.free_index.iter().zip(x) {
            *x = if index == PRESCRIBED {
                Vec3::zeros()
            } else {
                let at = 3 * index as usize;
                Vec3::from_column_slice(&self.right_hand_side[at..at + 3])
            };
        }
    }
}

impl LinearSolver for BlockCholesky {
    fn name(&self) -> &'static str {
        "cholesky"
    }

    fn prepare(&mut self, matrix: &BlockMatrix) -> Result<(), LinearError> {
        self.factorize(matrix)
            .map_err(|_| LinearError::NotPositiveDefinite)
    }

    fn solve(
        &mut self,
        matrix: &BlockMatrix,
        b: &[Vec3],
        x: &mut [Vec3],
    ) -> Result<LinearReport, LinearError> {
        BlockCholesky::solve(self, b, x);
        matrix.multiply(x, &mut self.residual);
        let mut b_squared = 0.0;
        for ((r, b), &index) in self.residual.iter_mut().zip(b).zip(&self.free_index) {
            let free = index != PRESCRIBED;
            *r = if free { b - *r } else { Vec3::zeros() };
            b_squared += if free { b.norm_squared() } else { 0.0 };
        }
        let residual = (dot(&self.residual, &self.residual) / b_squared).sqrt();
        if b_squared > 0.0 && !residual.is_finite() {
            return Err(LinearError::Diverged { iterations: 1 });
        }
        Ok(LinearReport {
            outcome: Outcome::Converged,
            iterations: 1,
            residual: if b_squared > 0.0 { residual } else { 0.0 },
        })
    }

    fn proves_definiteness(&self) -> bool {
        true
    }
}

/// Number of each free vertex among the free ones.
fn numbered(is_free: &[bool]) -> Vec<u32> {
    let mut free_count = 0;
    let number = |free: &bool| {
        if !free {
            return PRESCRIBED;
        }
        free_count += 1;
        free_count - 1
    };
    is_free.iter().map(number).collect()
}

/// The free part of a block matrix as a scalar matrix: its upper half, and the numbers in the order of that pattern.
///
/// # Errors
/// [`CholeskyError::TooLarge`].
///
/// # Panics
/// If `is_free` does not have one entry per row of the pattern.
pub fn upper_half(
    matrix: &BlockMatrix,
    is_free: &[bool],
) -> Result<(UpperPattern, Vec<Real>), CholeskyError> {
    assert_eq!(
        is_free.len(),
        matrix.pattern().row_count(),
        "one flag per row"
    );
    let free_index = numbered(is_free);
    let pattern = upper_pattern(matrix.pattern(), &free_index)?;
    let mut values = Vec::with_capacity(pattern.rows.len());
    for_each_value(matrix, &free_index, |value| values.push(value));
    Ok((pattern, values))
}

/// An order of the vertices as one of their coordinates. (Ordering vertices is a ninth of the work of ordering
/// coordinates.)
fn for_coordinates(mut elimination: Elimination) -> Elimination {
    let coordinates = |v: &u32| [3 * v, 3 * v + 1, 3 * v + 2];
    elimination.sequence = elimination.sequence.iter().flat_map(coordinates).collect();
    elimination
}

/// The free part of a block pattern with one row and column for each vertex.
fn vertex_pattern(pattern: &BlockPattern, free_index: &[u32]) -> UpperPattern {
    let mut column_offsets = vec![0];
    let mut rows = Vec::new();
    for row in (0..pattern.row_count()).filter(|&row| free_index[row] != PRESCRIBED) {
        let columns = pattern.columns()[pattern.row(row)].iter();
        let free = columns.map(|&column| free_index[column as usize]);
        rows.extend(free.filter(|&index| index != PRESCRIBED));
        column_offsets.push(rows.len() as u32);
    }
    UpperPattern {
        column_offsets,
        rows,
    }
}

/// The scalar upper half of the free part of a block pattern. Row i of the lower half, read across, is column i of
/// the upper half, read down.
fn upper_pattern(
    pattern: &BlockPattern,
    free_index: &[u32],
) -> Result<UpperPattern, CholeskyError> {
    let mut column_offsets = vec![0u32];
    let mut rows = Vec::new();
    for row in (0..pattern.row_count()).filter(|&row| free_index[row] != PRESCRIBED) {
        for axis in 0..3 {
            for &column in &pattern.columns()[pattern.row(row)] {
                let index = free_index[column as usize];
                if index != PRESCRIBED {
                    let height = if column as usize == row { axis + 1 } else { 3 };
                    rows.extend((0..height).map(|k| 3 * index + k));
                }
            }
            let end = u32::try_from(rows.len()).map_err(|_| CholeskyError::TooLarge)?;
            column_offsets.push(end);
        }
    }
    Ok(UpperPattern {
        column_offsets,
        rows,
    })
}

/// The numbers of a block matrix in the order of [`upper_pattern`].
fn for_each_value(matrix: &BlockMatrix, free_index: &[u32], mut visit: impl FnMut(Real)) {
    let pattern = matrix.pattern();
    for row in (0..pattern.row_count()).filter(|&row| free_index[row] != PRESCRIBED) {
        for axis in 0..3 {
            for slot in pattern.row(row) {
                let column = pattern.columns()[slot] as usize;
                if free_index[column] != PRESCRIBED {
                    let height = if column == row { axis + 1 } else { 3 };
                    (0..height).for_each(|k| visit(matrix.blocks()[slot][(axis, k)]));
                }
            }
        }
    }
}
