//! `P A Pᵀ = L D Lᵀ` of a symmetric quasi-definite matrix: a saddle-point matrix whose second diagonal block is
//! negative definite.
//!
//! `[H Jᵀ; J −S]` with H and S positive definite has such a factorisation for every permutation P, with as many
//! positive pivots as H has rows and as many negative ones as S has (R. Vanderbei, "Symmetric quasidefinite matrices",
//! SIAM J. Optim. 5, 1995, <https://doi.org/10.1137/0805005>). So the ordering can be chosen for sparsity once, and no
//! pivoting is needed. Where S is small the factor loses digits; iterative refinement gives them back.

use super::cholesky::{CholeskyError, UpperPattern, symbolic};
use crate::math::Real;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::{LdltRef, SymbolicCholesky, SymmetricOrdering};
use faer::{Conj, MatMut, Par, Side};
use std::fmt;

/// A quasi-definite matrix and its factor.
pub struct QuasidefiniteLdlt {
    pattern: UpperPattern,
    symbolic: SymbolicCholesky<u32>,
    /// +1 or −1: the sign that each pivot has to have.
    signs: Vec<i8>,
    values: Vec<Real>,
    factor: Vec<Real>,
    memory: MemBuffer,
    factored: bool,
}

impl fmt::Debug for QuasidefiniteLdlt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("QuasidefiniteLdlt")
            .field("dimension", &self.pattern.dimension())
            .field("nonzeros", &self.values.len())
            .field("factor_nonzeros", &self.factor.len())
            .field("factored", &self.factored)
            .finish()
    }
}

/// A pivot nearer to zero than this, or of the wrong sign, is replaced by one of this size: the diagonal of the matrix
/// should be of the order of 1 where it is not small on purpose.
const SMALLEST_PIVOT: Real = 1e-14;

impl QuasidefiniteLdlt {
    /// Finds an ordering (approximate minimum degree) and the nonzeros of the factor. The first `positive` rows are
    /// those of H, the others those of S.
    ///
    /// # Errors
    /// [`CholeskyError::TooLarge`].
    ///
    /// # Panics
    /// If the pattern is not one of compressed columns.
    pub fn analyze(pattern: UpperPattern, positive: usize) -> Result<Self, CholeskyError> {
        let symbolic = symbolic(&pattern, SymmetricOrdering::Amd)?;
        let numeric = symbolic.factorize_numeric_ldlt_scratch::<Real>(Par::Seq, Default::default());
        let solve = symbolic.solve_in_place_scratch::<Real>(1, Par::Seq);
        let memory = MemBuffer::try_new(numeric.or(solve)).map_err(|_| CholeskyError::TooLarge)?;
        let sign = |row| if row < positive { 1 } else { -1 };
        Ok(Self {
            signs: (0..pattern.dimension()).map(sign).collect(),
            values: vec![0.0; pattern.rows.len()],
            factor: vec![0.0; symbolic.len_val()],
            symbolic,
            pattern,
            memory,
            factored: false,
        })
    }

    /// The numbers of the matrix, in the order of its pattern, to be filled before [`QuasidefiniteLdlt::factorize`].
    pub fn values_mut(&mut self) -> &mut [Real] {
        &mut self.values
    }

    /// Numbers stored in the factor, the explicit zeros of its dense blocks included.
    #[must_use]
    pub fn factor_len(&self) -> usize {
        self.factor.len()
    }

    /// Computes the factor of the present numbers.
    ///
    /// # Errors
    /// [`CholeskyError::NotPositiveDefinite`] if the factor is not finite; it is then of no use until a factorisation
    /// succeeds.
    pub fn factorize(&mut self) -> Result<(), CholeskyError> {
        self.factored = false;
        let regularization = LdltRegularization {
            dynamic_regularization_signs: Some(&self.signs),
            dynamic_regularization_delta: SMALLEST_PIVOT,
            dynamic_regularization_epsilon: SMALLEST_PIVOT,
        };
        self.symbolic
            .factorize_numeric_ldlt(
                &mut self.factor,
                SparseColMatRef::new(self.pattern.view(), &self.values[..]),
                Side::Upper,
                regularization,
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .map_err(|_| CholeskyError::NotPositiveDefinite)?;
        if !self.factor.iter().sum::<Real>().is_finite() {
            return Err(CholeskyError::NotPositiveDefinite);
        }
        self.factored = true;
        Ok(())
    }

    /// Replaces the right-hand side by the solution.
    ///
    /// # Panics
    /// If the length is not that of the matrix, or it has not been factorised.
    pub fn solve_in_place(&mut self, right_hand_side: &mut [Real]) {
        assert!(self.factored, "solve before a successful factorisation");
        let n = self.pattern.dimension();
        assert_eq!(right_hand_side.len(), n, "length of the right-hand side");
        if n == 0 {
            return;
        }
        LdltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(right_hand_side, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}
