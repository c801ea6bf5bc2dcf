//! Which vertices of a mesh go on to the next coarser level: one after another is left out, as long as it lies among
//! its parents.

use crate::math::{Real, Vec3};
use crate::method::multigrid::prolongation::Prolongation;
use crate::method::multigrid::weights::linear_weights;
use crate::topology::EdgeTable;

/// Vertices of one level and what links them.
#[derive(Debug)]
pub(super) struct Graph {
    /// Neighbours of each vertex and their distances (m), in ascending order of their numbers.
    neighbors: Vec<Vec<(u32, Real)>>,
    /// Neighbours along the boundary.
    boundary: Vec<Vec<u32>>,
}

impl Graph {
    /// The vertices and edges of a mesh.
    pub(super) fn of_mesh(positions: &[Vec3], edges: &EdgeTable) -> Self {
        let length = |[a, b]: [u32; 2]| (positions[a as usize] - positions[b as usize]).norm();
        let links = edges.ends().iter().map(|&ends| (ends, length(ends)));
        let boundary = (0..edges.len()).filter(|&edge| edges.is_boundary(edge));
        Self::new(
            positions.len(),
            links,
            boundary.map(|edge| edges.ends()[edge]),
        )
    }

    pub(super) fn new(
        count: usize,
        links: impl Iterator<Item = ([u32; 2], Real)>,
        boundary_links: impl Iterator<Item = [u32; 2]>,
    ) -> Self {
        let mut neighbors = vec![Vec::new(); count];
        for ([a, b], length) in links {
            neighbors[a as usize].push((b, length));
            neighbors[b as usize].push((a, length));
        }
        let mut boundary = vec![Vec::new(); count];
        for [a, b] in boundary_links {
            boundary[a as usize].push(b);
            boundary[b as usize].push(a);
        }
        for list in &mut neighbors {
            list.sort_unstable_by_key(|&(v, _)| v);
        }
        Self {
            neighbors,
            boundary,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.neighbors.len()
    }

    /// On which `v` could depend: inside, its neighbours; on the boundary, its two neighbours there.
    fn candidates(&self, v: usize) -> impl Iterator<Item = (u32, Real)> {
        let on_boundary = !self.boundary[v].is_empty();
        let all = self.neighbors[v].iter().copied();
        all.filter(move |(u, _)| !on_boundary || self.boundary[v].contains(u))
    }
}

/// A level made of a finer one. "Fine" and "coarse" numbers are those within either level.
#[derive(Debug)]
pub(super) struct Coarsening {
    /// The fine number of each coarse vertex, ascending.
    pub(super) kept: Vec<u32>,
    pub(super) prolongation: Prolongation,
    /// Coarse vertices that a fine link joins, themselves or by vertices whose nearest parents they are; ascending, the
    /// lower number first.
    pub(super) links: Vec<[u32; 2]>,
    /// The same along the boundary.
    pub(super) boundary_links: Vec<[u32; 2]>,
}

/// Leaves out as many vertices as it can in one go, so that the parents that are kept carry each of them: there are at
/// least `parent_count`, on the boundary its two neighbours there, and it lies among them. `keep` says which have to be
/// kept: those that are prescribed. `place` (m) is where vertices are at rest.
pub(super) fn coarsen(
    graph: &Graph,
    keep: impl Fn(u32) -> bool,
    place: &[Vec3],
    parent_count: usize,
) -> Coarsening {
    let count = graph.len();
    let mut is_kept = vec![true; count];
    let is_carried = |v: usize, is_kept: &[bool]| {
        let on_boundary = !graph.boundary[v].is_empty();
        let needed = if on_boundary { 2 } else { parent_count };
        let mut parents = parents(graph, v, is_kept);
        parents.len() >= needed
            && (on_boundary || linear_weights(v, &mut parents, place, LEAST) < ASIDE)
    };
    // The boundary first: what it keeps decides what the inside can depend on.
    let boundary = (0..count).filter(|&v| graph.boundary[v].len() == 2);
    let inside = (0..count).filter(|&v| graph.boundary[v].is_empty());
    for v in boundary.chain(inside).filter(|&v| !keep(v as u32)) {
        is_kept[v] = false;
        let mut around = graph.neighbors[v].iter().map(|&(u, _)| u as usize);
        is_kept[v] =
            !(is_carried(v, &is_kept) && around.all(|u| is_kept[u] || is_carried(u, &is_kept)));
    }
    describe(graph, &is_kept, place)
}

/// No weight is negative: a vertex that moves against a parent is not smoothed afterwards.
const LEAST: Real = 0.0;
/// How far aside of its parents a vertex may lie: its distance from their weighted mean, relative to their mean
/// distance.
const ASIDE: Real = 0.3;

/// The vertices on which `v` depends when it is left out, and the inverse of the length of each link to them (1/m).
fn parents(graph: &Graph, v: usize, is_kept: &[bool]) -> Vec<(u32, Real)> {
    let all = graph.candidates(v);
    let kept = all.filter(|&(p, _)| is_kept[p as usize]);
    kept.map(|(p, length)| (p, 1.0 / length)).collect()
}

fn describe(graph: &Graph, is_kept: &[bool], place: &[Vec3]) -> Coarsening {
    let kept: Vec<u32> = (0u32..)
        .zip(is_kept)
        .filter_map(|(v, is_kept)| is_kept.then_some(v))
        .collect();
    let mut coarse = vec![0; graph.len()];
    for (number, &v) in (0u32..).zip(&kept) {
        coarse[v as usize] = number;
    }
    let mut rows = Vec::with_capacity(graph.len());
    let mut nearest = coarse.clone();
    for v in 0..graph.len() {
        if is_kept[v] {
            rows.push(vec![(coarse[v], 1.0)]);
            continue;
        }
        let mut own = parents(graph, v, is_kept);
        let closest = own
            .iter()
            .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
        nearest[v] = coarse[closest.expect("it has parents").0 as usize];
        linear_weights(v, &mut own, place, LEAST);
        own.iter_mut().for_each(|(p, _)| *p = coarse[*p as usize]);
        rows.push(own);
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
    let boundary = graph.boundary.iter().zip(0..);
    let boundary_links =
        through(&mut boundary.flat_map(|(list, v)| list.iter().map(move |&u| [u, v])));
    Coarsening {
        prolongation: Prolongation::new(rows.iter().map(Vec::as_slice), kept.len()),
        kept,
        links,
        boundary_links,
    }
}
