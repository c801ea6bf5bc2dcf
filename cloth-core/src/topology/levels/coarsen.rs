//! Which vertices go on to the next coarser level, and on whom the others depend.

use crate::math::{Mat3, Real, Vec3};
use crate::topology::EdgeTable;

/// Vertices of one level and what links them.
#[derive(Debug)]
pub(super) struct Graph {
    /// Neighbours of each vertex and their distances (m), in ascending order of their numbers.
    neighbors: Vec<Vec<(u32, Real)>>,
    /// Neighbours along the boundary.
    rim: Vec<Vec<u32>>,
}

impl Graph {
    /// The vertices and edges of a mesh.
    pub(super) fn of_mesh(positions: &[Vec3], edges: &EdgeTable) -> Self {
        let length = |[a, b]: [u32; 2]| (positions[a as usize] - positions[b as usize]).norm();
        let links = edges.ends().iter().map(|&ends| (ends, length(ends)));
        let rim = (0..edges.len()).filter(|&edge| edges.is_boundary(edge));
        Self::new(positions.len(), links, rim.map(|edge| edges.ends()[edge]))
    }

    pub(super) fn new(
        count: usize,
        links: impl Iterator<Item = ([u32; 2], Real)>,
        rim_links: impl Iterator<Item = [u32; 2]>,
    ) -> Self {
        let mut neighbors = vec![Vec::new(); count];
        for ([a, b], length) in links {
            neighbors[a as usize].push((b, length));
            neighbors[b as usize].push((a, length));
        }
        let mut rim = vec![Vec::new(); count];
        for [a, b] in rim_links {
            rim[a as usize].push(b);
            rim[b as usize].push(a);
        }
        for list in &mut neighbors {
            list.sort_unstable_by_key(|&(v, _)| v);
        }
        Self { neighbors, rim }
    }

    pub(super) fn len(&self) -> usize {
        self.neighbors.len()
    }

    /// On whom `v` could depend: inside, its neighbours; on the rim, its two neighbours there.
    fn candidates(&self, v: usize) -> impl Iterator<Item = (u32, Real)> {
        let on_rim = !self.rim[v].is_empty();
        let all = self.neighbors[v].iter().copied();
        all.filter(move |(u, _)| !on_rim || self.rim[v].contains(u))
    }
}

/// A level made of a finer one. "Fine" and "coarse" numbers are those within either level.
#[derive(Debug)]
pub(super) struct Coarsening {
    /// The fine number of each coarse vertex, ascending.
    pub(super) kept: Vec<u32>,
    /// Each fine vertex that was left out, ascending, with its parents' coarse numbers and their weights (dimensionless, sum 1).
    pub(super) parents: Vec<(u32, Vec<(u32, Real)>)>,
    /// Coarse vertices that a fine link joins, themselves or by vertices whose nearest parents they are; ascending, the lower number first.
    pub(super) links: Vec<[u32; 2]>,
    /// The same along the boundary.
    pub(super) rim_links: Vec<[u32; 2]>,
}

/// Stands for a vertex that was left out.
const NONE: u32 = u32::MAX;

/// Leaves out as many vertices as it can in one go, so that each of them has at least `parent_count` parents among those kept, on the rim its two neighbours
/// there, and lies among them: see [`weights`]. `hold` says which have to be kept: those that are prescribed. `place` gives the position at rest (m).
pub(super) fn coarsen(
    graph: &Graph,
    hold: impl Fn(u32) -> bool,
    place: impl Fn(u32) -> Vec3,
    parent_count: usize,
) -> Coarsening {
    let count = graph.len();
    let mut kept = vec![true; count];
    let mut parents = Vec::new();
    let is_carried = |v: usize, kept: &[bool], parents: &mut Vec<(u32, Real)>| {
        let on_rim = !graph.rim[v].is_empty();
        let needed = if on_rim { 2 } else { parent_count };
        parents.clear();
        parents.extend(graph.candidates(v).filter(|&(p, _)| kept[p as usize]));
        parents.len() >= needed && (on_rim || weights(place(v as u32), parents, &place) < ASIDE)
    };
    // The rim first: what it keeps decides what the inside can lean on.
    let rim = (0..count).filter(|&v| graph.rim[v].len() == 2);
    let inside = (0..count).filter(|&v| graph.rim[v].is_empty());
    for v in rim.chain(inside).filter(|&v| !hold(v as u32)) {
        kept[v] = false;
        let mut around = graph.neighbors[v].iter().map(|&(u, _)| u as usize);
        kept[v] = !(is_carried(v, &kept, &mut parents)
            && around.all(|u| kept[u] || is_carried(u, &kept, &mut parents)));
    }
    describe(graph, &kept, place)
}

/// How far a vertex may lie from the weighted mean of its parents, relative to their mean distance.
const ASIDE: Real = 0.3;

/// Turns the distances (m) in `parents` into weights (dimensionless, sum 1, none negative), and gives how far from the place the weighted mean of the parents is, relative
/// to their mean distance.
///
/// Inverse distances are changed by as little as it takes to have the weighted mean in place, `w = b (1 + β·(r − m))` with r the ways to the parents,
/// m their weighted mean and `cov β = −m`; as far as no weight becomes negative. Where it is in place, linear fields are handed down exactly.
fn weights(place: Vec3, parents: &mut [(u32, Real)], of: impl Fn(u32) -> Vec3) -> Real {
    let count = parents.len() as Real;
    let distance = parents.iter().map(|(_, d)| d).sum::<Real>() / count;
    let inverse: Real = parents.iter().map(|(_, d)| 1.0 / d).sum();
    parents
        .iter_mut()
        .for_each(|(_, d)| *d = 1.0 / (*d * inverse));
    let way = |p: u32| of(p) - place;
    let mean: Vec3 = parents.iter().map(|&(p, b)| way(p) * b).sum();
    let mut covariance = Mat3::zeros();
    for &(p, b) in parents.iter() {
        let r = way(p) - mean;
        covariance += r * r.transpose() * b;
    }
    let eigen = covariance.symmetric_eigen();
    let mut beta = Vec3::zeros();
    for k in 0..3 {
        if eigen.eigenvalues[k] > 1e-6 * distance * distance {
            let axis: Vec3 = eigen.eigenvectors.column(k).into();
            beta -= axis * (axis.dot(&mean) / eigen.eigenvalues[k]);
        }
    }
    let slopes = parents.iter().map(|&(p, _)| beta.dot(&(way(p) - mean)));
    let part = slopes.fold(
        1.0,
        |part: Real, s| if s < -1.0 { part.min(-1.0 / s) } else { part },
    );
    for (p, b) in parents.iter_mut() {
        *b *= (1.0 + part * beta.dot(&(way(*p) - mean))).max(0.0);
    }
    let aside: Vec3 = parents.iter().map(|&(p, w)| way(p) * w).sum();
    aside.norm() / distance
}

fn describe(graph: &Graph, kept: &[bool], place: impl Fn(u32) -> Vec3) -> Coarsening {
    let mut coarse = vec![NONE; graph.len()];
    let mut survivors = Vec::new();
    for v in (0..graph.len()).filter(|&v| kept[v]) {
        coarse[v] = survivors.len() as u32;
        survivors.push(v as u32);
    }
    let mut parents = Vec::new();
    let mut nearest = coarse.clone();
    for v in (0..graph.len()).filter(|&v| !kept[v]) {
        let of_kept = graph.candidates(v).filter(|&(p, _)| kept[p as usize]);
        let mut own: Vec<(u32, Real)> = of_kept.collect();
        let closest = own
            .iter()
            .fold((NONE, Real::INFINITY), |best, &(p, length)| {
                if length < best.1 { (p, length) } else { best }
            });
        nearest[v] = coarse[closest.0 as usize];
        weights(place(v as u32), &mut own, &place);
        own.iter_mut().for_each(|(p, _)| *p = coarse[*p as usize]);
        parents.push((v as u32, own));
    }
    let through = |pairs: &mut dyn Iterator<Item = [u32; 2]>| {
        let mut links: Vec<[u32; 2]> = pairs
            .map(|pair| pair.map(|v| nearest[v as usize]))
            .filter(|[a, b]| a != b)
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        links.sort_unstable();
        links.dedup();
        links
    };
    let all = graph.neighbors.iter().zip(0..);
    let links = through(&mut all.flat_map(|(list, v)| list.iter().map(move |&(u, _)| [u, v])));
    let rim = graph.rim.iter().zip(0..);
    let rim_links = through(&mut rim.flat_map(|(list, v)| list.iter().map(move |&u| [u, v])));
    Coarsening {
        kept: survivors,
        parents,
        links,
        rim_links,
    }
}
