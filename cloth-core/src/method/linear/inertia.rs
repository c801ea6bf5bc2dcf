//! How many eigenvalues of a symmetric matrix lie above a number, without computing any: Sylvester's law of inertia.
//!
//! `A − s I = L D Lᵀ` has as many positive entries in D as A has eigenvalues above s. One factorisation
//! answers the question for one s.

use super::block_cholesky::upper_half;
use super::cholesky::{CholeskyError, UpperPattern, symbolic};
use crate::math::Real;
use crate::method::block_matrix::BlockMatrix;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering};
use faer::{Par, Side};
use std::fmt;

/// Counts eigenvalues of one sparse symmetric matrix.
pub struct Inertia {
    pattern: UpperPattern,
    values: Vec<Real>,
    shifted: Vec<Real>,
    symbolic: SymbolicCholesky<u32>,
    factor: Vec<Real>,
    memory: MemBuffer,
}

impl fmt::Debug for Inertia {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Inertia")
            .field("dimension", &self.pattern.dimension())
            .field("factor_nonzeros", &self.factor.len())
            .finish()
    }
}

impl Inertia {
    /// Takes a whole block matrix.
    ///
    /// # Errors
    /// [`CholeskyError::TooLarge`].
    pub fn of(matrix: &BlockMatrix) -> Result<Self, CholeskyError> {
        let (pattern, values) = upper_half(matrix, &vec![true; matrix.pattern().row_count()])?;
        Self::new(pattern, values)
    }

    /// Takes the upper half of the matrix, the numbers in the order of the pattern.
    ///
    /// # Errors
    /// [`CholeskyError::TooLarge`].
    ///
    /// # Panics
    /// If there is not one number per nonzero of the pattern.
    pub fn new(pattern: UpperPattern, values: Vec<Real>) -> Result<Self, CholeskyError> {
        assert_eq!(values.len(), pattern.rows.len(), "one number per nonzero");
        let symbolic = symbolic(&pattern, SymmetricOrdering::Amd)?;
        let scratch = symbolic.factorize_numeric_ldlt_scratch::<Real>(Par::Seq, Default::default());
        Ok(Self {
            shifted: values.clone(),
            values,
            factor: vec![0.0; symbolic.len_val()],
            memory: MemBuffer::try_new(scratch).map_err(|_| CholeskyError::TooLarge)?,
            symbolic,
            pattern,
        })
    }

    /// Number of eigenvalues above `shift`. `None` if a pivot vanished to rounding: `shift` is an eigenvalue of a
    /// leading block; any other shift nearby will do.
    pub fn count_above(&mut self, shift: Real) -> Option<usize> {
        self.shifted.copy_from_slice(&self.values);
        for &end in &self.pattern.column_offsets[1..] {
            self.shifted[end as usize - 1] -= shift; // the diagonal is the last of its column
        }
        self.symbolic
            .factorize_numeric_ldlt(
                &mut self.factor,
                SparseColMatRef::new(self.pattern.view(), &self.shifted[..]),
                Side::Upper,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .ok()?;
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("analysed as supernodal")
        };
        let factor = SupernodalLdltRef::new(symbolic, &self.factor);
        let mut positive = 0;
        for index in 0..symbolic.n_supernodes() {
            let block = factor.supernode(index).val();
            for column in 0..block.ncols() {
                let pivot = block[(column, column)];
                if !pivot.is_finite() || pivot == 0.0 {
                    return None;
                }
                positive += usize::from(pivot > 0.0);
            }
        }
        Some(positive)
    }
}
