//! How many degrees of freedom the edges leave: counted, and measured (CORE-11).
//!
//! A mesh with rigid edges has `3V` coordinates and `E` conditions. The count `3V − E` (S1 (19), (20); [`crate::topology::Topology`]) is what is left *if
//! the conditions are independent*. Whether they are is a question for the Jacobian `J = ∂l/∂x` of the edge lengths at a configuration:
//!
//! - its rank r says how many conditions are independent there,
//! - the nullity `3V − r` is the number of motions that change no length to first order, the 6 rigid ones among them,
//! - `E − r` is the number of self-stresses: tensions that balance at every vertex. A flat sheet has one for every inner vertex, because no edge
//!   resists a motion out of the plane there; any finite bend removes them.
//!
//! The rank is the number of singular values of J above a threshold. `JᵀJ` is the Gauss–Newton Hessian of unit springs, so
//! it is assembled by the code that assembles all Hessians, and its eigenvalues are counted by [`Inertia`].

use crate::block_matrix::BlockMatrix;
use crate::element::Convexity;
use crate::energy::Spring;
use crate::family::Energies;
use crate::linear::{CholeskyError, Inertia};
use crate::math::{Real, Vec3};
use crate::topology::EdgeTable;
use std::fmt;

/// Singular values of the edge-length Jacobian below this are zero (dimensionless, as its entries are).
///
/// The eigenvalues of `JᵀJ` are its squares, 1e-12, and are found with a rounding error of about 1e-15.
pub const RANK_THRESHOLD: Real = 1e-6;

/// Rank of the edge-length Jacobian at one configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeRank {
    /// Rank r: independent edge lengths.
    pub rank: usize,
    /// `3V − r`: independent motions that keep every length to first order.
    pub nullity: usize,
    /// `E − r`: independent self-stresses.
    pub self_stresses: usize,
    /// The smallest singular value above [`RANK_THRESHOLD`] (dimensionless), to three digits. The farther it is
    /// from the threshold, the surer the rank. 0 if the rank is 0.
    pub smallest_kept: Real,
}

impl EdgeRank {
    /// Measures the rank of the lengths of all `edges` at `positions` (m).
    ///
    /// # Errors
    /// [`RankError`].
    ///
    /// # Panics
    /// If an edge names a vertex that has no position.
    pub fn measure(positions: &[Vec3], edges: &EdgeTable) -> Result<Self, RankError> {
        Self::of_pairs(positions, edges.ends())
    }

    /// Measures the rank of the distances between `pairs` of vertices at `positions` (m): of springs on some edges only, for instance.
    ///
    /// # Errors
    /// [`RankError`].
    ///
    /// # Panics
    /// If a pair names a vertex that has no position.
    pub fn of_pairs(positions: &[Vec3], pairs: &[[u32; 2]]) -> Result<Self, RankError> {
        if let Some(vertex) = positions.iter().position(|p| !crate::math::is_finite(p)) {
            return Err(RankError::NonFinite { vertex });
        }
        let normal = normal_matrix(positions, pairs);
        let mut inertia = Inertia::of(&normal).map_err(RankError::Factorization)?;
        let mut above = |singular_value: Real| count_above(&mut inertia, singular_value);
        let rank = above(RANK_THRESHOLD)?;
        Ok(Self {
            rank,
            nullity: 3 * positions.len() - rank,
            self_stresses: pairs.len() - rank,
            smallest_kept: if rank == 0 {
                0.0
            } else {
                smallest_kept(rank, largest_possible(pairs, positions.len()), above)?
            },
        })
    }
}

/// `JᵀJ`: the Gauss–Newton Hessian of springs with k = 1.
fn normal_matrix(positions: &[Vec3], pairs: &[[u32; 2]]) -> BlockMatrix {
    let springs = Spring::along(positions, pairs, 1.0);
    let mut energies = Energies::new(positions.len())
        .with(springs)
        .expect("edges name vertices of their mesh");
    let mut matrix = BlockMatrix::zeros(energies.bind_pattern());
    energies.add_hessian(positions, 1.0, Convexity::GaussNewton, &mut matrix);
    matrix
}

/// A bound on the largest singular value: each edge adds `g gᵀ` with ‖g‖² = 2 to two vertices, so no eigenvalue of `JᵀJ` exceeds twice the
/// largest number of edges at a vertex (Gershgorin).
fn largest_possible(pairs: &[[u32; 2]], vertex_count: usize) -> Real {
    let mut degree = vec![0u32; vertex_count];
    for &vertex in pairs.iter().flatten() {
        degree[vertex as usize] += 1;
    }
    (2.0 * Real::from(degree.into_iter().max().unwrap_or(0))).sqrt()
}

/// Singular values of J above a number, by the eigenvalues of `JᵀJ` above its square. A number that happens to be an eigenvalue of a leading
/// block is moved by a part in a thousand.
fn count_above(inertia: &mut Inertia, singular_value: Real) -> Result<usize, RankError> {
    (0..8)
        .map(|attempt| singular_value * (1.0 + 1e-3 * Real::from(attempt)))
        .find_map(|s| inertia.count_above(s * s))
        .ok_or(RankError::Indefinite { singular_value })
}

/// Bisection, in the logarithm, for the number at which the count of larger singular values drops below the rank.
fn smallest_kept(
    rank: usize,
    largest: Real,
    mut above: impl FnMut(Real) -> Result<usize, RankError>,
) -> Result<Real, RankError> {
    let (mut low, mut high) = (RANK_THRESHOLD, largest * 1.001);
    while high / low > 1.001 {
        let middle = (low * high).sqrt();
        if above(middle)? == rank {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok((low * high).sqrt())
}

/// The positions (m) after a smooth motion that bends any shape in all directions, for measuring the rank of a bent sheet. Every position moves
/// by at most a quarter of the size of the shape, along a wave that no symmetry of a mesh shares. A shape without size stays as it is.
#[must_use]
pub fn bent(positions: &[Vec3]) -> Vec<Vec3> {
    let low = positions
        .iter()
        .copied()
        .reduce(|a, b| a.inf(&b))
        .unwrap_or_default();
    let high = positions
        .iter()
        .copied()
        .reduce(|a, b| a.sup(&b))
        .unwrap_or_default();
    let size = (high - low).amax();
    if size == 0.0 {
        return positions.to_vec();
    }
    positions
        .iter()
        .map(|p| {
            let q = (p - low) * (4.0 / size);
            let wave = Vec3::new(
                (0.9 * q.y + 0.4 * q.z + 0.3).sin() * 0.3,
                (0.8 * q.z + 0.5 * q.x + 1.1).sin() * 0.3,
                (0.7 * q.x + 1.2).sin() + (0.9 * q.y + 0.3 * q.x + 0.5).cos(),
            );
            p + wave * (0.1 * size)
        })
        .collect()
}

/// Why a rank could not be measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum RankError {
    /// A position is not finite.
    NonFinite {
        /// The vertex.
        vertex: usize,
    },
    /// The matrix is too large.
    Factorization(CholeskyError),
    /// Pivots vanished at every number tried near this one.
    Indefinite {
        /// The singular value asked for.
        singular_value: Real,
    },
}

impl fmt::Display for RankError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinite { vertex } => {
                write!(f, "the position of vertex {vertex} is not finite")
            }
            Self::Factorization(error) => error.fmt(f),
            Self::Indefinite { singular_value } => {
                write!(
                    f,
                    "singular values above {singular_value:e} could not be counted: pivots vanished"
                )
            }
        }
    }
}

impl std::error::Error for RankError {}
