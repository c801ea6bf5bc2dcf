//! Coarse levels, and multigrid on them: a V-cycle as a preconditioner for the matrices of implicit steps.
//!
//! Relaxation (Gauss–Seidel) takes away errors that are as rough as the mesh, and hardly touches smooth ones; on a mesh
//! with a quarter of the vertices what was smooth is rough again. So each level is smoothed, its residual restricted to
//! the next, the correction found there interpolated back and smoothed once more. On the coarsest level, a few dozen
//! vertices, the system is solved. The work is that of a few sweeps over the finest level, whatever its size.
//!
//! | equation | says | where |
//! |---|---|---|
//! | `x_fine = P x_coarse` | prolongation; restriction is `Pᵀ` | [`Prolongation`] |
//! | `A_coarse = Pᵀ A P` | the coarse operator (Galerkin) | `galerkin` |
//! | `x ← (D′ + L)⁻¹ r`, `x ← x + (D′ + Lᵀ)⁻¹(r − A x)` | smoothing before and after; L within chunks of rows, `D′ = D` if there is one | `level` |
//! | `A x = r` | the coarsest level | `coarsest` |
//! | `w = b (1 + β·(r − m))` | weights of P, exact for linear functions | `weights` |
//! | lengths of geodesics over the cloth | links of the coarse vertices of a mesh | [`coarse_levels`] |
//!
//! Why `Pᵀ A P`: to solve `A x = b` with a symmetric positive definite A is to minimise `½ xᵀA x − bᵀx`. The correction
//! of the form `P y` that makes this least at `x + P y` solves `Pᵀ A P y = Pᵀ(b − A x)`. So the coarse operator and the
//! restriction follow from P; the best such correction never raises what is minimised; and the coarse level needs no
//! mesh and no elements.
//!
//! Position-based dynamics has no matrix. Its levels are those of the mesh at rest ([`coarse_levels`]), interpolated by
//! the same weights, with links over the cloth in place of the coarse operator. Links are projected and nothing is
//! smoothed after them, so they ask more of a level: half of the vertices instead of a quarter, each among its parents,
//! and no negative weight.
//!
//! The cycle is a symmetric positive definite operator, so conjugate gradients and quasi-Newton methods can build on
//! it. It is computed in single precision: it only has to be near the inverse, what is iterated around it is not.
//!
//! # Why the number of vertices does not matter
//!
//! Take two levels, the error e, its energy `‖e‖²_A = eᵀA e`, the diagonal blocks D of A, and `M = D + L` (where a
//! level is one chunk; `level` has the others). Two facts bound what a correction and the sweep after it leave (after
//! Ruge and Stüben, cited in `coarsening`):
//!
//! 1. *Smoothing.* A sweep of Gauss–Seidel makes `e − M⁻¹A e` of e. Since `M + Mᵀ = A + D`, that takes `‖M⁻¹A e‖²_D`
//!    from the energy, which is at least `σ ‖A e‖²` in the norm of D⁻¹, with `σ = 1/‖D^−½ M D^−½‖²`. The block (i, j)
//!    of `D^−½ A D^−½` has a norm of at most 1, as A is positive definite, and a row of M has no more of them than a
//!    vertex has neighbours, and itself. So `σ ≥ 1/(n + 1)²` with n the most neighbours of a vertex, on a mesh of any
//!    size. A sweep takes much where the residual A e is large beside the error: from rough errors.
//! 2. *Approximation.* Some coarse y has `‖e − P y‖²_D ≤ τ ‖e‖²_A`: an error of little energy changes little from a
//!    vertex to its parents, and is interpolated well. τ depends on how far away these are, in edges, and not on how
//!    many vertices there are.
//!
//! The best correction leaves an e with `eᵀA P y = 0` for all y. So `‖e‖²_A = eᵀA (e − P y)`. That is at most the norm
//! of A e by D⁻¹ times the norm of e − P y by D, which by 2 is at most `√τ ‖e‖_A` for the right y. So `‖A e‖²` by D⁻¹
//! is at least `‖e‖²_A/τ`: the residual is large, and by 1 the sweep leaves no more than `1 − σ/τ` of the energy, on a
//! mesh of any size.
//!
//! A cycle over more levels solves the coarse equation by a cycle and not exactly. For a rate of that the approximation
//! has to be better than 2; it is not proved here. The test `the_number_of_iterations_hardly_grows_with_the_mesh` has
//! conjugate gradients around the cycle: at most 80 iterations to 10⁻⁸ on all of its sheets, and from 17 × 17 to 129 ×
//! 129 vertices at most twice as many.
//!
//! # References
//!
//! - A. Brandt, "Multi-level adaptive solutions to boundary-value problems", Math. Comp. 31, 1977,
//!   <https://doi.org/10.1090/S0025-5718-1977-0431719-X>.
//! - W. L. Briggs, V. E. Henson, S. F. McCormick, *A Multigrid Tutorial*, 2nd ed., SIAM 2000,
//!   <https://doi.org/10.1137/1.9780898719505>.
//! - M. Müller, "Hierarchical position based dynamics", VRIPHYS 2008,
//!   <https://doi.org/10.2312/PE/vriphys/vriphys08/001-010>.
//! - R. Tamstorf, T. Jones, S. F. McCormick, "Smoothed aggregation multigrid for cloth simulation", ACM TOG 34(6),
//!   2015,
//!   <https://doi.org/10.1145/2816795.2818081>.

mod blocks;
mod coarsening;
mod coarsest;
mod galerkin;
mod level;
mod mesh_levels;
mod prolongation;
mod rank_one;
mod weights;

pub use mesh_levels::{CoarseLevel, Geodesics, coarse_levels};
pub use prolongation::Prolongation;

use crate::contact::ContactRow;
use crate::math::{Mat3, Real, Vec3};
use crate::method::block_matrix::{BlockMatrix, BlockPattern};
use crate::method::chunked::map_reduce;
use blocks::Block;
use coarsening::{Coarsening, Graph, coarsen};
use coarsest::Coarsest;
use galerkin::{Galerkin, coarse_strengths};
use level::Level;
use std::sync::Arc;

/// A level with no more vertices than this is solved directly.
const COARSEST: usize = 48;
/// A level that keeps more than this fraction of the vertices of the one before is not made.
const WORTHWHILE: Real = 0.8;

/// The levels for matrices of one pattern, and the numbers of the last one.
#[derive(Debug)]
pub struct Multigrid {
    levels: Vec<Level>,
    /// From level k + 1 to level k.
    transfers: Vec<(Prolongation, Galerkin)>,
    coarsest: Option<Coarsest>,
}

impl Multigrid {
    /// Levels for matrices on the pattern of `matrix`, whose blocks (N/m) say how strongly vertices are coupled.
    /// `is_free[v]` says whether vertex `v` moves, `rest` (m) where it is at rest.
    ///
    /// # Panics
    /// If `is_free` or `rest` does not have one entry per row of the matrix.
    #[must_use]
    pub fn new(matrix: &BlockMatrix, is_free: &[bool], rest: &[Vec3]) -> Self {
        let pattern = matrix.shared_pattern();
        assert_eq!(is_free.len(), pattern.row_count(), "one flag per row");
        assert_eq!(rest.len(), pattern.row_count(), "one rest position per row");
        let finest = Level::new(Arc::clone(pattern), is_free.to_vec());
        let mut this = Self {
            levels: vec![finest],
            transfers: Vec::new(),
            coarsest: None,
        };
        this.coarsen(strengths(matrix), rest.to_vec());
        this
    }

    /// Adds a level below the last; gives the couplings of its vertices from those of the finer ones.
    fn add(&mut self, prolongation: Prolongation, strengths: &[Real]) -> Vec<Real> {
        let finer = self.levels[self.levels.len() - 1].pattern();
        let (pattern, galerkin) = Galerkin::new(finer, &prolongation);
        let strengths = coarse_strengths(finer, strengths, &prolongation, &pattern);
        let free = vec![true; prolongation.coarse_count()];
        self.levels.push(Level::new(pattern, free));
        self.transfers.push((prolongation, galerkin));
        strengths
    }

    /// Adds levels until one is small enough, or one more would gain nothing.
    fn coarsen(&mut self, mut strengths: Vec<Real>, mut place: Vec<Vec3>) {
        loop {
            let last = &self.levels[self.levels.len() - 1];
            let free_count = last.is_free().iter().filter(|free| **free).count();
            if free_count <= COARSEST {
                break;
            }
            let graph = graph(last.pattern(), &strengths);
            let Coarsening { prolongation, kept } = coarsen(&graph, last.is_free(), &place);
            if kept.len() as Real > WORTHWHILE * free_count as Real {
                break;
            }
            place = kept.iter().map(|&vertex| place[vertex as usize]).collect();
            strengths = self.add(prolongation, &strengths);
        }
        let last = &self.levels[self.levels.len() - 1];
        let is_small = last.len() <= COARSEST;
        self.coarsest = is_small.then(|| Coarsest::new(last.len()));
    }

    /// Vertices of each level, from fine to coarse.
    pub fn sizes(&self) -> impl Iterator<Item = usize> {
        self.levels.iter().map(Level::len)
    }

    /// Updates the levels for the numbers of a matrix (N/m) on the pattern. Returns false where the coarsest level is
    /// not positive definite. That need not be the matrix: the levels are computed in single precision, whose rounding
    /// can do it to a definite one that is stiff beside its masses. The coarsest level is then solved with its diagonal
    /// larger by a part of itself, the first of 10⁻⁶, 10⁻⁵ and 10⁻⁴ that makes it definite, and gives no correction if
    /// none does.
    ///
    /// # Panics
    /// If the matrix has another number of blocks.
    pub fn refresh(&mut self, matrix: &BlockMatrix) -> bool {
        self.refresh_with(matrix, &[])
    }

    /// The same with additions of rank one, which need not be on the pattern.
    ///
    /// # Panics
    /// If the matrix has another number of blocks, or a vertex does not exist.
    pub fn refresh_with(&mut self, matrix: &BlockMatrix, added: &[ContactRow]) -> bool {
        let finest = &mut self.levels[0];
        assert_eq!(
            matrix.blocks().len(),
            finest.blocks.len(),
            "matrix on another pattern"
        );
        map_reduce(
            (&mut finest.blocks[..], matrix.blocks()),
            #[inline(always)]
            |_, (own, blocks): (&mut [Block], &[Mat3])| {
                for (own, block) in own.iter_mut().zip(blocks) {
                    *own = Block::from(block);
                }
                []
            },
        );
        for (number, (_, galerkin)) in self.transfers.iter().enumerate() {
            let (fine, coarse) = self.levels.split_at_mut(number + 1);
            galerkin.apply(&fine[number].blocks, &mut coarse[0].blocks);
        }
        let finest = &mut self.levels[0];
        let mut own = std::mem::take(&mut finest.rank_one);
        own.set(added, finest.is_free());
        finest.rank_one = own;
        for (number, (prolongation, _)) in self.transfers.iter().enumerate() {
            let (fine, coarse) = self.levels.split_at_mut(number + 1);
            let coarse = &mut coarse[0].rank_one;
            coarse.restrict(&fine[number].rank_one, prolongation);
        }
        self.levels.iter_mut().for_each(Level::prepare);
        if let (Some(coarsest), Some(level)) = (&mut self.coarsest, self.levels.last()) {
            return coarsest.factorize(level);
        }
        true
    }

    /// Whether the coarsest level gives a correction: it is solved by its factor, perhaps with a larger diagonal, or by
    /// a sweep.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        self.coarsest.as_ref().is_none_or(Coarsest::has_factor)
    }

    /// One V-cycle from zero: `z` (m) is near `A⁻¹ r` for a right-hand side `r` (N), and zero where nothing moves.
    ///
    /// # Panics
    /// If `r` or `z` does not have one entry per row.
    pub fn apply(&mut self, r: &[Vec3], z: &mut [Vec3]) {
        assert_eq!(r.len(), self.levels[0].len(), "length of r");
        assert_eq!(z.len(), self.levels[0].len(), "length of z");
        self.levels[0].take(r);
        self.cycle(0);
        self.levels[0].give(z);
    }

    fn cycle(&mut self, number: usize) {
        let Some((prolongation, _)) = self.transfers.get(number) else {
            return self.solve_coarsest();
        };
        let (fine, coarse) = self.levels.split_at_mut(number + 1);
        fine[number].smooth_forward();
        fine[number].restrict(prolongation, &mut coarse[0].right_hand_side);
        self.cycle(number + 1);
        let (prolongation, _) = &self.transfers[number];
        let (fine, coarse) = self.levels.split_at_mut(number + 1);
        fine[number].correct(prolongation, &coarse[0].solution);
        fine[number].smooth_backward();
    }

    /// The last level: by its factor, or by a symmetric sweep where it is not small.
    fn solve_coarsest(&mut self) {
        let Some(level) = self.levels.last_mut() else {
            return;
        };
        match &mut self.coarsest {
            Some(coarsest) => coarsest.solve(level),
            None => {
                level.smooth_forward();
                level.smooth_backward();
            }
        }
    }
}

/// How strongly each block couples its vertices (N/m).
fn strengths(matrix: &BlockMatrix) -> Vec<Real> {
    matrix.blocks().iter().map(Mat3::norm).collect()
}

/// Both halves of a pattern as lists of neighbours.
fn graph(pattern: &BlockPattern, strengths: &[Real]) -> Graph {
    let mut graph = vec![Vec::new(); pattern.row_count()];
    for row in 0..pattern.row_count() {
        for slot in pattern.row(row) {
            let column = pattern.columns()[slot] as usize;
            if column != row {
                graph[row].push((column as u32, strengths[slot]));
                graph[column].push((row as u32, strengths[slot]));
            }
        }
    }
    graph
        .iter_mut()
        .for_each(|list| list.sort_unstable_by_key(|entry| entry.0));
    graph
}
