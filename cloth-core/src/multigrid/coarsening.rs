//! Which vertices make the next coarser level, and how the others hang on them.
//!
//! The coarse vertices are a maximal independent set of the graph of strong couplings (J. W. Ruge, K. Stüben, "Algebraic
//! multigrid", in *Multigrid Methods*, SIAM 1987, <https://doi.org/10.1137/1.9781611971057.ch4>, section 4.6). The weights are not
//! taken from the matrix, which changes all the time: they are the smallest change of inverse distances that makes them exact
//! for linear functions of the rest positions, so that coarse levels represent translations, rotations of small angle and
//! constant strain.

use super::prolongation::Prolongation;
use crate::math::{Mat3, Real, Vec3};

/// Neighbours of each vertex and how strongly they are coupled to it (any unit), ascending.
pub(super) type Graph = Vec<Vec<(u32, Real)>>;

/// A coupling weaker than this part of a vertex's strongest is none.
const STRONG: Real = 0.25;
/// How far a vertex may lie from the weighted mean of its parents, relative to their mean distance, before more distant ones are
/// asked too.
const ASIDE: Real = 0.05;
/// Two coarse vertices with a common neighbour are at least this many mean edge lengths apart.
const CLOSE: Real = 1.45;
/// Most parents of a vertex.
const MOST_PARENTS: usize = 6;
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

/// Free vertices, in the order of their numbers, of which none is a strong neighbour of one before, or a neighbour of such
/// and nearly as close at rest: across the cell of a grid that has no diagonal, for instance.
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

/// Coarse vertices and weights of a fine vertex: those among its neighbours if it lies among them, else also those of the
/// neighbours.
fn parents(vertex: usize, strong: &Graph, coarse: &[u32], place: &[Vec3]) -> Vec<(u32, Real)> {
    let is_coarse = |v: &u32| coarse[*v as usize] != NONE;
    let mut around: Vec<u32> = strong[vertex]
        .iter()
        .map(|entry| entry.0)
        .filter(is_coarse)
        .collect();
    let (mut weights, aside) = linear_weights(vertex, &around, place);
    if aside > ASIDE {
        let second = strong[vertex]
            .iter()
            .flat_map(|entry| &strong[entry.0 as usize]);
        let mut wider = around.clone();
        wider.extend(second.map(|entry| entry.0).filter(is_coarse));
        wider.sort_unstable();
        wider.dedup();
        let distance = |v: &u32| (place[*v as usize] - place[vertex]).norm_squared();
        wider.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        wider.truncate(MOST_PARENTS);
        let (wider_weights, wider_aside) = linear_weights(vertex, &wider, place);
        if wider_aside < aside {
            (around, weights) = (wider, wider_weights);
        }
    }
    let mut row: Vec<(u32, Real)> = around
        .iter()
        .map(|&v| coarse[v as usize])
        .zip(weights)
        .collect();
    row.retain(|entry| entry.1.abs() >= SMALLEST_WEIGHT);
    let sum: Real = row.iter().map(|entry| entry.1).sum();
    row.iter_mut().for_each(|entry| entry.1 /= sum);
    row.sort_unstable_by_key(|entry| entry.0);
    row
}

/// Weights (dimensionless, sum 1) of `others` for the place of a vertex, and how far from it their weighted mean is, relative
/// to their mean distance: `w = b (1 + β·(r − m))` with b the normalised inverse squared distances, r the displacements to the
/// others, m their mean weighted by b, and `cov β = −m` as far as the others spread. No weight is below `−½ b`.
fn linear_weights(vertex: usize, others: &[u32], place: &[Vec3]) -> (Vec<Real>, Real) {
    let away: Vec<Vec3> = others
        .iter()
        .map(|&v| place[v as usize] - place[vertex])
        .collect();
    let nearest = away.iter().map(Vec3::norm).fold(Real::INFINITY, Real::min);
    if away.is_empty() || nearest == 0.0 || !nearest.is_finite() {
        // Nothing to measure by: the places coincide.
        let equal = 1.0 / others.len().max(1) as Real;
        return (
            vec![equal; others.len()],
            if away.is_empty() { Real::INFINITY } else { 0.0 },
        );
    }
    let distance = away.iter().map(Vec3::norm).sum::<Real>() / away.len() as Real;
    let inverse: Vec<Real> = away.iter().map(|r| r.norm_squared().recip()).collect();
    let total: Real = inverse.iter().sum();
    let mut weights: Vec<Real> = inverse.iter().map(|b| b / total).collect();
    let mean: Vec3 = away.iter().zip(&weights).map(|(r, b)| r * *b).sum();
    let mut covariance = Mat3::zeros();
    for (r, b) in away.iter().zip(&weights) {
        covariance += (r - mean) * (r - mean).transpose() * *b;
    }
    let eigen = covariance.symmetric_eigen();
    let mut beta = Vec3::zeros();
    for axis in 0..3 {
        if eigen.eigenvalues[axis] > 1e-3 * distance * distance {
            let n: Vec3 = eigen.eigenvectors.column(axis).into();
            beta -= n * (n.dot(&mean) / eigen.eigenvalues[axis]);
        }
    }
    let slopes: Vec<Real> = away.iter().map(|r| beta.dot(&(r - mean))).collect();
    let steepest = slopes.iter().copied().fold(0.0, Real::min);
    let part = if steepest < -1.5 {
        -1.5 / steepest
    } else {
        1.0
    };
    for (weight, slope) in weights.iter_mut().zip(&slopes) {
        *weight *= 1.0 + part * slope;
    }
    let aside: Vec3 = away.iter().zip(&weights).map(|(r, w)| r * *w).sum();
    (weights, aside.norm() / distance)
}
