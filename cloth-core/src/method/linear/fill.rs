//! In which order to eliminate, so that a factorisation has little to do: the better of two orders, by count.
//!
//! Minimum degree tends to win on small sheets and wherever bending couples second neighbours, nested dissection on
//! large sheets of springs. Nothing but the count tells, and counting costs far less than one factorisation.

use super::cholesky::{CholeskyError, UpperPattern};
use crate::math::Real;
use crate::method::ordering::graph::Graph;
use crate::method::ordering::nested_dissection;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::amd;

/// How the rows of a matrix are ordered before it is factorised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FillOrdering {
    /// Approximate minimum degree: P. R. Amestoy, T. A. Davis, I. S. Duff, SIAM J. Matrix Anal. Appl. 17, 1996,
    /// <https://doi.org/10.1137/S0895479894278952>.
    MinimumDegree,
    /// Nested dissection of the graph by steps from two far ends.
    NestedDissection,
}

/// An order of the rows, and what a factorisation costs in it.
#[derive(Clone, Debug)]
pub struct Elimination {
    /// How it was found.
    pub ordering: FillOrdering,
    /// The row at each place.
    pub sequence: Vec<u32>,
    /// Multiplications (dimensionless): the squares of the columns' nonzeros, added up.
    pub work: Real,
}

impl FillOrdering {
    /// The order of the rows of a matrix, and what a factorisation in it would cost; nothing is factorised.
    ///
    /// # Errors
    /// [`CholeskyError::TooLarge`] if there is no memory for it.
    ///
    /// # Panics
    /// If the pattern is not one of an upper half.
    pub fn elimination(self, pattern: &UpperPattern) -> Result<Elimination, CholeskyError> {
        let graph = Graph::new(pattern.dimension(), pattern.off_diagonal());
        let sequence = match self {
            Self::MinimumDegree => minimum_degree(pattern)?,
            Self::NestedDissection => nested_dissection::sequence(&graph),
        };
        Ok(Elimination {
            work: column_counts(&graph, &sequence).map(|c| c * c).sum(),
            ordering: self,
            sequence,
        })
    }
}

/// The order of less work.
pub(super) fn best(pattern: &UpperPattern) -> Result<Elimination, CholeskyError> {
    let one = FillOrdering::MinimumDegree.elimination(pattern)?;
    let other = FillOrdering::NestedDissection.elimination(pattern)?;
    Ok(if other.work < one.work { other } else { one })
}

fn minimum_degree(pattern: &UpperPattern) -> Result<Vec<u32>, CholeskyError> {
    let n = pattern.dimension();
    let (mut sequence, mut place) = (vec![0; n], vec![0; n]);
    let scratch = amd::order_scratch::<u32>(n, pattern.rows.len());
    let mut memory = MemBuffer::try_new(scratch).map_err(|_| CholeskyError::TooLarge)?;
    amd::order(
        &mut sequence,
        &mut place,
        pattern.view(),
        amd::Control::default(),
        MemStack::new(&mut memory),
    )
    .map_err(|_| CholeskyError::TooLarge)?;
    Ok(sequence)
}

/// Nonzeros of each column of the factor, diagonal included: row by row up the elimination tree, T. A. Davis, *Direct
/// Methods for Sparse Linear Systems*, 2006, section 4.1.
fn column_counts(graph: &Graph, sequence: &[u32]) -> impl Iterator<Item = Real> {
    const ROOT: u32 = u32::MAX;
    let mut place = vec![0; sequence.len()];
    (0u32..)
        .zip(sequence)
        .for_each(|(at, &row)| place[row as usize] = at);
    let mut parent = vec![ROOT; sequence.len()];
    let mut seen = vec![ROOT; sequence.len()];
    let mut counts = vec![1u32; sequence.len()];
    for (at, &row) in (0u32..).zip(sequence) {
        seen[at as usize] = at;
        for &neighbour in graph.of(row) {
            let mut node = place[neighbour as usize];
            while node < at && seen[node as usize] != at {
                seen[node as usize] = at;
                counts[node as usize] += 1;
                if parent[node as usize] == ROOT {
                    parent[node as usize] = at;
                }
                node = parent[node as usize];
            }
        }
    }
    counts.into_iter().map(Real::from)
}
