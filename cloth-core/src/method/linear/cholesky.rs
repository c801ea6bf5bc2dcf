//! Sparse Cholesky factorisation `P A Pᵀ = L Lᵀ` over faer's low-level interface: analyse once, refactor whenever the
//! numbers change, solve in place.
//!
//! faer's convenient interface allocates in every call (tens of thousands of times for a cloth); the low-level one
//! never does. Its parallelism does not pay for matrices of this size, so it is not used.

use super::fill::{self, Elimination, FillOrdering};
use crate::math::Real;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltParams;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};
use std::fmt;

/// Where the nonzeros of the upper half of a symmetric matrix are: compressed columns, rows ascending, the diagonal
/// last in every column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UpperPattern {
    /// Start of each column in `rows`, and the end of the last: `n + 1` numbers.
    pub column_offsets: Vec<u32>,
    /// Row of each nonzero.
    pub rows: Vec<u32>,
}

impl UpperPattern {
    /// Dimension n of the matrix.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.column_offsets.len() - 1
    }

    /// The nonzeros beside the diagonal, as pairs of row and column.
    pub(super) fn off_diagonal(&self) -> impl Iterator<Item = [u32; 2]> + Clone {
        let columns = self.column_offsets.windows(2).zip(0u32..);
        columns.flat_map(|(range, column)| {
            let rows = &self.rows[range[0] as usize..range[1] as usize];
            let above = rows.iter().filter(move |&&row| row < column);
            above.map(move |&row| [row, column])
        })
    }

    pub(super) fn view(&self) -> SymbolicSparseColMatRef<'_, u32> {
        let n = self.dimension();
        SymbolicSparseColMatRef::new_checked(n, n, &self.column_offsets, None, &self.rows)
    }
}

/// A symmetric positive definite matrix and its factor.
pub struct Cholesky {
    pattern: UpperPattern,
    ordering: FillOrdering,
    symbolic: SymbolicCholesky<u32>,
    values: Vec<Real>,
    factor: Vec<Real>,
    memory: MemBuffer,
    factored: bool,
}

impl fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cholesky")
            .field("dimension", &self.pattern.dimension())
            .field("nonzeros", &self.values.len())
            .field("factor_nonzeros", &self.factor.len())
            .field("factored", &self.factored)
            .finish()
    }
}

impl Cholesky {
    /// Finds an ordering (the one of less work, [`FillOrdering`]) and the nonzeros of the factor, and sets aside the
    /// memory for factorising and for solving up to three right-hand sides.
    ///
    /// # Errors
    /// [`CholeskyError::TooLarge`].
    ///
    /// # Panics
    /// If the pattern is not one of compressed columns.
    pub fn analyze(pattern: UpperPattern) -> Result<Self, CholeskyError> {
        let elimination = fill::best(&pattern)?;
        Self::analyze_in_order(pattern, elimination)
    }

    /// The same for an order that is known.
    pub(super) fn analyze_in_order(
        pattern: UpperPattern,
        elimination: Elimination,
    ) -> Result<Self, CholeskyError> {
        let Elimination {
            ordering, sequence, ..
        } = elimination;
        let mut place = vec![0; sequence.len()];
        (0u32..)
            .zip(&sequence)
            .for_each(|(at, &row)| place[row as usize] = at);
        let permutation = PermRef::new_checked(&sequence, &place, sequence.len());
        let custom = SymmetricOrdering::Custom(permutation);
        let symbolic = symbolic(&pattern, custom)?;
        let numeric = symbolic.factorize_numeric_llt_scratch::<Real>(Par::Seq, llt_params());
        let solve = symbolic.solve_in_place_scratch::<Real>(RIGHT_HAND_SIDES, Par::Seq);
        let memory = MemBuffer::try_new(numeric.or(solve)).map_err(|_| CholeskyError::TooLarge)?;
        Ok(Self {
            values: vec![0.0; pattern.rows.len()],
            factor: vec![0.0; symbolic.len_val()],
            symbolic,
            pattern,
            ordering,
            memory,
            factored: false,
        })
    }

    /// The pattern of the matrix.
    #[must_use]
    pub fn pattern(&self) -> &UpperPattern {
        &self.pattern
    }

    /// The ordering taken.
    #[must_use]
    pub fn ordering(&self) -> FillOrdering {
        self.ordering
    }

    /// The numbers of the matrix, in the order of its pattern, to be filled before [`Cholesky::factorize`].
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
    /// [`CholeskyError::NotPositiveDefinite`]; the factor is then of no use until a factorisation succeeds.
    pub fn factorize(&mut self) -> Result<(), CholeskyError> {
        self.factored = false;
        let matrix = SparseColMatRef::new(self.pattern.view(), &self.values[..]);
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                matrix,
                Side::Upper,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                llt_params(),
            )
            .map_err(|_| CholeskyError::NotPositiveDefinite)?;
        self.factored = true;
        // A pivot that is NaN or infinite passes the test of its sign. What is not finite elsewhere spoils a later
        // pivot.
        self.factored = self.factor().pivots_are_finite();
        if self.factored {
            Ok(())
        } else {
            Err(CholeskyError::NotPositiveDefinite)
        }
    }

    /// Replaces each column of `right_hand_sides` (column after column, n numbers each, at most three columns) by the
    /// solution.
    ///
    /// # Panics
    /// If the length is not n, 2n or 3n, or the matrix has not been factorised.
    pub fn solve_in_place(&mut self, right_hand_sides: &mut [Real]) {
        assert!(self.factored, "solve before a successful factorisation");
        let n = self.pattern.dimension();
        if n == 0 {
            return;
        }
        let columns = right_hand_sides.len() / n;
        assert!(
            columns * n == right_hand_sides.len() && (1..=RIGHT_HAND_SIDES).contains(&columns),
            "one to {RIGHT_HAND_SIDES} right-hand sides of length {n}"
        );
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(right_hand_sides, n, columns),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }

    /// A view of the factor, for kernels that want it in another layout.
    ///
    /// # Panics
    /// If the matrix has not been factorised.
    #[must_use]
    pub fn factor(&self) -> FactorView<'_> {
        assert!(self.factored, "factor before a successful factorisation");
        FactorView { owner: self }
    }
}

/// Memory for solving is set aside for this many right-hand sides: x, y and z.
const RIGHT_HAND_SIDES: usize = 3;

/// faer takes supernodes if the operations per entry of the factor *exceed* this; its own `FORCE_SUPERNODAL` is 0,
/// which a diagonal matrix does not exceed.
const ALWAYS_SUPERNODAL: SupernodalThreshold = SupernodalThreshold(-1.0);

/// The nonzeros of the factor in an order, as supernodes.
pub(super) fn symbolic(
    pattern: &UpperPattern,
    ordering: SymmetricOrdering<'_, u32>,
) -> Result<SymbolicCholesky<u32>, CholeskyError> {
    let params = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: ALWAYS_SUPERNODAL,
        ..Default::default()
    };
    factorize_symbolic_cholesky(pattern.view(), Side::Upper, ordering, params)
        .map_err(|_| CholeskyError::TooLarge)
}

fn llt_params() -> Spec<LltParams, Real> {
    Default::default()
}

/// The factor `L` as supernodes: dense blocks of neighbouring columns with the same rows.
#[derive(Clone, Copy, Debug)]
pub struct FactorView<'a> {
    owner: &'a Cholesky,
}

impl<'a> FactorView<'a> {
    /// For each position in the factor's order, the row of the matrix that stands there.
    #[must_use]
    #[allow(clippy::missing_panics_doc)] // every factor is made with a permutation
    pub fn order(&self) -> &'a [u32] {
        let permutation = self.owner.symbolic.perm();
        permutation.expect("analysed with a permutation").arrays().0
    }

    /// Number of supernodes.
    #[must_use]
    pub fn supernode_count(&self) -> usize {
        match self.owner.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(supernodes) => supernodes.n_supernodes(),
            SymbolicCholeskyRaw::Simplicial(_) => 0, // only a matrix without rows is not analysed as supernodal
        }
    }

    fn pivots_are_finite(&self) -> bool {
        (0..self.supernode_count()).all(|index| {
            let (_, _, block) = self.supernode(index);
            (0..block.ncols()).all(|column| block[(column, column)].is_finite())
        })
    }

    /// Supernode `index`: its first column, the rows below its triangle, and its numbers as a dense column-major matrix
    /// of `width + rows.len()` rows and `width` columns, of which the part above the diagonal has no meaning.
    ///
    /// # Panics
    /// If there is no such supernode.
    #[must_use]
    pub fn supernode(&self, index: usize) -> (usize, &'a [u32], faer::MatRef<'a, Real>) {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.owner.symbolic.raw() else {
            unreachable!("analysed as supernodal")
        };
        let factor = faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef::new(
            symbolic,
            &self.owner.factor,
        );
        let node = factor.supernode(index);
        (node.start(), node.pattern(), node.val())
    }
}

/// Why a matrix could not be factorised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CholeskyError {
    /// A pivot was not positive.
    NotPositiveDefinite,
    /// The factor has more entries than can be counted or kept in memory.
    TooLarge,
}

impl fmt::Display for CholeskyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPositiveDefinite => write!(f, "the matrix is not positive definite"),
            Self::TooLarge => write!(f, "the factor of the matrix is too large for the memory"),
        }
    }
}

impl std::error::Error for CholeskyError {}
