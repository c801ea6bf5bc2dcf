//! Which vertices make the next coarser level, and how the others are interpolated from them.
//!
//! The coarse vertices are chosen so that no two of them are strongly coupled, nor are both strongly coupled to a third
//! vertex while they lie almost as near to each other as neighbours do (J. W. Ruge, K. Stüben, "Algebraic multigrid",
//! in *Multigrid Methods*, SIAM 1987, <https://doi.org/10.1137/1.9781611971057.ch4>, section 4.6). The weights are not
//! taken from the matrix, which changes all the time, but from the rest positions.
//!
//! # The numbers
//!
//! Iterations of conjugate gradients around the cycle to 10⁻⁸, for the matrices of `tests/all/multigrid.rs` on sheets
//! of 65 × 65 vertices (alternating, irregular, one-way grid), with one of the constants changed and the others as they
//! are, which takes 59, 79 and 54:
//!
//! | constant | why so | what others take |
//! |---|---|---|
//! | [`STRONG`] | that of Ruge and Stüben: a weak coupling says little of where errors are smooth | 0.1 and 0.5 within one; 0, all couplings, 60, 85, 63 |
//! | [`ASIDE`] | outside of its parents a vertex is extrapolated | none wider: 59, 86, 55; 0 to 0.2 the same |
//! | [`CLOSE`] | just above √2: of a square cell without a diagonal only one of the two opposite corners is taken | 1.2, with half of the vertices on the first coarse level instead of a quarter: 51, 79, 54; 1.7: 58, 85, 54; 2: 66, 82, 60 |
//! | [`MOST_PARENTS`] | each parent fills the coarse matrix, and three near ones are enough where they lie around | 3: 59, 81, 54; 4: 59, 84, 54; 8 and 12 the same |
//! | [`LEAST`] | a large negative weight moves a vertex against its parents; the coarse vertices of these sheets lie around too well for that | 0 to −3 the same |
//! | [`SMALLEST_WEIGHT`] | fills the coarse matrix and does little | 0 the same; 0.1: 59, 84, 54 |
//!
//! So `CLOSE` takes a sixth more iterations on the alternating grid, and half of the rows of the first coarse level.
//! The others are far from where they matter.

use super::prolongation::Prolongation;
use super::weights::linear_weights;
use crate::math::{Real, Vec3};

/// Neighbours of each vertex and how strongly they are coupled to it (any unit), ascending.
pub(super) type Graph = Vec<Vec<(u32, Real)>>;

/// A coupling weaker than this fraction of a vertex's strongest does not count.
const STRONG: Real = 0.25;
/// How far aside of its parents a vertex may lie: its distance from their weighted mean, relative to their mean
/// distance. Beyond it more distant ones are taken too.
const ASIDE: Real = 0.05;
/// Two coarse vertices with a common neighbour are at least this many mean edge lengths apart.
const CLOSE: Real = 1.45;
/// Most parents of a vertex.
const MOST_PARENTS: usize = 6;
/// Least weight, relative to what it would be by distance alone.
const LEAST: Real = -0.5;
/// A smaller weight is left out.
const SMALLEST_WEIGHT: Real = 0.04;

/// The next coarser level.
#[derive(Debug)]
pub(super) struct Coarsening {
    pub(super) prolongation: Prolongation,
    /// Fine number of each coarse vertex, ascending.
    pub(super) kept: Vec<u32>,
}

/// Coarsens the graph of the free vertices; the others have no parents.
pub(super) fn coarsen(graph: &Graph, is_free: &[bool], place: &[Vec3]) -> Coarsening {
    let strong: Graph = graph.iter().map(|list| strong_part(list)).collect();
    let kept = independent_set(&strong, is_free, place);
    let mut coarse = vec![NONE; graph.len()];
    for (number, &vertex) in (0u32..).zip(&kept) {
        coarse[vertex as usize] = number;
    }
    let mut rows: Vec<Vec<(u32, Real)>> = Vec::with_capacity(graph.len());
    for vertex in 0..graph.len() {
        rows.push(if !is_free[vertex] {
            Vec::new()
        } else if coarse[vertex] != NONE {
            vec![(coarse[vertex], 1.0)]
        } else {
            parents(vertex, &strong, &coarse, place)
        });
    }
    let rows = rows.iter().map(Vec::as_slice);
    Coarsening {
        prolongation: Prolongation::new(rows, kept.len()),
        kept,
    }
}

/// Stands for a vertex that is on the fine level only.
const NONE: u32 = u32::MAX;

fn strong_part(list: &[(u32, Real)]) -> Vec<(u32, Real)> {
    let strongest = list.iter().map(|entry| entry.1).fold(0.0, Real::max);
    let is_strong = |entry: &&(u32, Real)| entry.1 >= STRONG * strongest && entry.1 > 0.0;
    list.iter().filter(is_strong).copied().collect()
}

/// Free vertices, in the order of their numbers, of which none is a strong neighbour of one before, or a neighbour of
/// such and nearly as close at rest: across the cell of a grid that has no diagonal, for instance.
fn independent_set(strong: &Graph, is_free: &[bool], place: &[Vec3]) -> Vec<u32> {
    let mut is_open = is_free.to_vec();
    let mut kept = Vec::new();
    for vertex in 0..strong.len() {
        if !is_open[vertex] {
            continue;
        }
        kept.push(vertex as u32);
        let distance = |v: u32| (place[v as usize] - place[vertex]).norm();
        let around = &strong[vertex];
        let mean =
            around.iter().map(|entry| distance(entry.0)).sum::<Real>() / around.len() as Real;
        for &(neighbor, _) in around {
            is_open[neighbor as usize] = false;
            for &(second, _) in &strong[neighbor as usize] {
                if distance(second) < CLOSE * mean {
                    is_open[second as usize] = false;
                }
            }
        }
    }
    kept
}

/// Coarse vertices and weights of a fine vertex: those among its neighbours if it lies among them, else also those of
/// the neighbours.
fn parents(vertex: usize, strong: &Graph, coarse: &[u32], place: &[Vec3]) -> Vec<(u32, Real)> {
    let is_coarse = |v: &u32| coarse[*v as usize] != NONE;
    let squared = |v: u32| (place[v as usize] - place[vertex]).norm_squared();
    let weigh = |around: Vec<u32>| {
        let near = around.into_iter().map(|v| (v, squared(v).recip()));
        let mut row: Vec<(u32, Real)> = near.collect();
        let aside = linear_weights(vertex, &mut row, place, LEAST);
        (row, aside)
    };
    let around = strong[vertex].iter().map(|entry| entry.0);
    let around: Vec<u32> = around.filter(is_coarse).collect();
    let (mut row, aside) = weigh(around.clone());
    if aside > ASIDE {
        let second = strong[vertex]
            .iter()
            .flat_map(|entry| &strong[entry.0 as usize]);
        let mut wider = around;
        wider.extend(second.map(|entry| entry.0).filter(is_coarse));
        wider.sort_unstable();
        wider.dedup();
        wider.sort_by(|&a, &b| squared(a).total_cmp(&squared(b)));
        wider.truncate(MOST_PARENTS);
        let (wider, wider_aside) = weigh(wider);
        if wider_aside < aside {
            row = wider;
        }
    }
    row.iter_mut()
        .for_each(|entry| entry.0 = coarse[entry.0 as usize]);
    row.retain(|entry| entry.1.abs() >= SMALLEST_WEIGHT);
    let sum: Real = row.iter().map(|entry| entry.1).sum();
    row.iter_mut().for_each(|entry| entry.1 /= sum);
    row.sort_unstable_by_key(|entry| entry.0);
    row
}
