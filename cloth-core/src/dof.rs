//! How many degrees of freedom the edges leave: counted, and measured.
//!
//! A mesh with rigid edges has `3V` coordinates and `E` conditions. The count `3V − E` ([`crate::topology::Topology`])
//! is what is left *if the conditions are independent*. Whether they are is a question for the Jacobian `J = ∂l/∂x` of
//! the edge lengths at a configuration:
//!
//! - its rank r says how many conditions are independent there,
//! - the nullity `3V − r` is the number of motions that change no length to first order, the 6 rigid ones among them,
//! - `E − r` is the number of self-stresses: tensions that balance at every vertex. A flat sheet has one for every
//!   inner vertex, because no edge resists a motion out of the plane there. A bend of the whole sheet in all directions
//!   ([`perturbed`]) removes them; a part that stays flat keeps its own.
//!
//! # What to use when
//!
//! Stiff edges lock a fold that finds no lines of edges to bend about. All figures are of
//! `cloth-bench study locking`, 16 cells a side: a fold under its own weight about a diagonal, when the modulus
//! Y goes from 10⁴ to 10⁶ N/m. They are its bending energy over that of an elastica: an inextensible sheet that bends
//! about this axis alone, with the rigidity of the hinges about it. Where nothing locks the sheet may curve across too,
//! which makes it softer: then it reaches more than 1.
//!
//! | sheet of springs | bending reached |
//! |---|---|
//! | one-way grid, fold along its diagonals | 1.23, then 1.23: stiff edges do not matter |
//! | crossed grid | 1.19, then 1.20 |
//! | alternating grid | 1.14, then 0.92 |
//! | equilateral | 0.99, then 0.67 |
//! | irregular | 1.03, then 0.53 |
//! | one-way grid, fold across its diagonals | 1.19, then 0.49 |
//!
//! Where folds may run in any direction, crossed and alternating grids lock least, as they have lines in four of them.
//! An irregular mesh has none, and is also the one that locks most on a cone (9.1 times the energy of an inextensible
//! sheet at 10⁸ N/m, crossed 0.94). With other membranes than springs the last row ends at 0.51 (StVK) and 0.33 (ARAP).
//! The remedies there, at 10⁶ N/m, and what they break at 2 % strain:
//!
//! | remedy | bending reached | what it breaks |
//! |---|---|---|
//! | coarse level 2 holds, k/100 on the edges, [`crate::cloth::CoarseMembrane`] | 1.22 | 0.01 of the energy when pushed, 0.57 when sheared, 0.02 when stretched in waves of four cells |
//! | k/100 under compression, [`crate::cloth::SpringLaw::Compression`] | 1.09 | pushed, the sheet is a hundred times softer; pulled, it is the same |
//! | soft springs, stiff beyond 1 %, `DeadZone` beside them | 1.19 | 0.18 of the energy when pulled |
//! | slack ±0.5 %, [`crate::cloth::SpringLaw::DeadZone`] | 1.40 | 0.46 of the energy when pulled, and nothing within the range |
//! | a fifth of the coordinates free, [`crate::cloth::SpringEdges::DofFraction`] | 0.74 | 0.58 of the energy when sheared |
//! | quads, [`crate::cloth::SpringEdges::Quads`] | 1.46 | 2e-4 of the energy when sheared |
//! | edge midpoints, [`crate::cloth::Cloth::on_midpoints`] | 1.11 | nothing of the membrane; three times as many coordinates, and gaps between triangles |
//!
//! So: on a grid take the crossed pattern first, which costs nothing but a vertex more in each cell. Where the mesh is
//! given, weaker springs under compression are the cheapest cure; folds shorten edges, and cloth hardly resists being
//! pushed in its plane anyway. A coarse level frees more: of the 3·17² = 867 coordinates rigid springs on all edges
//! leave 67 free, its links 775. No bend costs the links anything, but stretch over a few edges hardly meets them.
//! Midpoints are for those who need the membrane as it is.
//!
//! Finer meshes lock less: the last sheet reaches 0.93 with 32 cells a side where it reached 0.49 with 16. The method
//! does not matter as long as it solves the cloth it is given.
//!
//! At what size of edges does a mesh lock? A sheet that is bent to a cylinder of radius R, with all of its vertices on
//! that surface, stores in its springs as much as in its hinges at the edge length `l* = (702 D R²/Y)^¼`. The reason:
//! an edge at the angle φ to the curved direction of a cylinder is a chord, shorter than its arc by the strain `ε = l²
//! cos⁴ φ/(24 R²)`. Equilateral springs store `½ Y Σ ε²` per area, summed over the three directions of edges, and `Σ
//! cos⁸ φ` is 105/128 in the mean over all φ. Hinges store `½ D/R²`, so `702 ≈ 24²·128/105`.
//!
//! For equilateral triangles with all vertices on a cone that is right to 6 %, with 16 to 128 cells a side and Y from
//! 10³ to 10⁸ N/m. A sheet between clamps leaves the surface and gets rid of all but 2 % of the energy of its springs.
//! So l* is about where locking can begin, not where it has to: of 40 kinds of sheets that fold under their own weight
//! 8 lose half of their bending, at edge lengths between 0.9 and 2.8 l*.
//!
//! # How the rank is found
//!
//! The rank is the number of singular values of J above a threshold. `JᵀJ` is the Gauss–Newton Hessian of unit springs,
//! so it is assembled by the code that assembles all Hessians, and its eigenvalues are counted by [`Inertia`] down to
//! [`COUNTED_ABOVE`]. Of a smoothly bent sheet the smallest singular value decreases fast with the number of vertices
//! (a jittered sheet of 20 000 has one of 6e-7), so those below are computed one by one if they are few.

mod smallest;

use crate::element::Convexity;
use crate::energy::Spring;
use crate::math::{Real, Vec3};
use crate::method::block_matrix::BlockMatrix;
use crate::method::family::Energies;
use crate::method::linear::{CholeskyError, Inertia};
use crate::topology::EdgeTable;
use std::fmt;

/// Singular values of the edge-length Jacobian below this are zero (dimensionless, as its entries are).
pub const RANK_THRESHOLD: Real = 1e-9;

/// Singular values above this are counted, as eigenvalues of `JᵀJ` above its square 1e-12, which are found with a
/// rounding error of about 1e-15. What lies below is zero or is computed one by one: at most [`MOST_WEAK`] of them. If
/// there are more, as on a flat sheet, all are taken for zero.
pub const COUNTED_ABOVE: Real = 1e-6;

/// At most this many singular values below [`COUNTED_ABOVE`] are computed one by one.
pub const MOST_WEAK: usize = 64;

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
    pub smallest_nonzero_singular_value: Real,
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

    /// Measures the rank of the distances between `pairs` of vertices at `positions` (m): of springs on some edges
    /// only, for instance.
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
        let counted = above(COUNTED_ABOVE)?;
        let uncounted = pairs.len() - counted;
        let mut weak = if (1..=MOST_WEAK).contains(&uncounted) {
            smallest::singular_values(positions, pairs, uncounted)?
        } else {
            Vec::new()
        };
        weak.retain(|&singular_value| singular_value > RANK_THRESHOLD);
        let rank = counted + weak.len();
        Ok(Self {
            rank,
            nullity: 3 * positions.len() - rank,
            self_stresses: pairs.len() - rank,
            smallest_nonzero_singular_value: match weak.first() {
                Some(&smallest) => smallest,
                None if rank == 0 => 0.0,
                None => smallest_nonzero_singular_value(
                    rank,
                    largest_possible(pairs, positions.len()),
                    above,
                )?,
            },
        })
    }
}

/// `JᵀJ`: the Gauss–Newton Hessian of springs with k = 1.
fn normal_matrix(positions: &[Vec3], pairs: &[[u32; 2]]) -> BlockMatrix {
    let springs = Spring::along(positions, pairs, 1.0);
    Energies::new(positions.len())
        .with(springs)
        .expect("edges name vertices of their mesh")
        .hessian(positions, Convexity::GaussNewton)
}

/// A bound on the largest singular value: each edge adds `g gᵀ` with ‖g‖² = 2 to two vertices, so no eigenvalue of
/// `JᵀJ` exceeds twice the largest number of edges at a vertex (Gershgorin).
fn largest_possible(pairs: &[[u32; 2]], vertex_count: usize) -> Real {
    let mut degree = vec![0u32; vertex_count];
    for &vertex in pairs.iter().flatten() {
        degree[vertex as usize] += 1;
    }
    (2.0 * Real::from(degree.into_iter().max().unwrap_or(0))).sqrt()
}

/// Singular values of J above a number, by the eigenvalues of `JᵀJ` above its square. A number that happens to be an
/// eigenvalue of a leading block is moved by a part in a thousand.
fn count_above(inertia: &mut Inertia, singular_value: Real) -> Result<usize, RankError> {
    (0..8)
        .map(|attempt| singular_value * (1.0 + 1e-3 * Real::from(attempt)))
        .find_map(|s| inertia.count_above(s * s))
        .ok_or(RankError::Indefinite { singular_value })
}

/// Bisection, in the logarithm, for the number at which the count of larger singular values drops below the rank.
fn smallest_nonzero_singular_value(
    rank: usize,
    largest: Real,
    mut above: impl FnMut(Real) -> Result<usize, RankError>,
) -> Result<Real, RankError> {
    let (mut low, mut high) = (COUNTED_ABOVE, largest * 1.001);
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

/// The positions (m) after a smooth motion that bends any shape in all directions, for measuring the rank of a bent
/// sheet. Every position moves by at most a quarter of the size of the shape, along a wave that no symmetry of a mesh
/// shares. A shape without size stays as it is.
#[must_use]
pub fn perturbed(positions: &[Vec3]) -> Vec<Vec3> {
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
