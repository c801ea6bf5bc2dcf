//! Which vertices go on to the next coarser level, and on whom the others depend.

use cloth_core::math::Real;
use cloth_core::topology::EdgeTable;

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
    pub(super) fn of_mesh(positions: &[cloth_core::math::Vec3], edges: &EdgeTable) -> Self {
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
/// there. `hold` says which have to be kept: those that are prescribed.
pub(super) fn coarsen(
    graph: &Graph,
    hold: impl Fn(u32) -> bool,
    parent_count: usize,
) -> Coarsening {
    let count = graph.len();
    let mut kept = vec![true; count];
    let needed = |v: usize| match graph.rim[v].is_empty() {
        true => parent_count,
        false => 2,
    };
    // The rim first: what it keeps decides what the inside can lean on.
    let rim = (0..count).filter(|&v| graph.rim[v].len() == 2);
    let inside = (0..count).filter(|&v| graph.rim[v].is_empty());
    for v in rim.chain(inside) {
        let parents_of = |u: usize| graph.candidates(u).filter(|&(p, _)| kept[p as usize]);
        let spared = |u: usize| {
            let without = parents_of(u).filter(|&(p, _)| p as usize != v).count();
            kept[u] || without >= needed(u)
        };
        let mut around = graph.neighbors[v].iter().map(|&(u, _)| u as usize);
        if !hold(v as u32) && parents_of(v).count() >= needed(v) && around.all(spared) {
            kept[v] = false;
        }
    }
    describe(graph, &kept)
}

fn describe(graph: &Graph, kept: &[bool]) -> Coarsening {
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
        let mut own: Vec<(u32, Real)> = of_kept
            .map(|(p, length)| (coarse[p as usize], 1.0 / length))
            .collect();
        let sum: Real = own.iter().map(|(_, weight)| weight).sum();
        own.iter_mut().for_each(|(_, weight)| *weight /= sum);
        let best = own.iter().fold((NONE, 0.0), |best, &(p, weight)| {
            if weight > best.1 { (p, weight) } else { best }
        });
        nearest[v] = best.0;
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
