//! What a user should know of a mesh: border vertices that lie on each other without being one, as in a file in which
//! faces do not share their corners; fans that touch in one vertex; sides that change places; slivers; and seams that
//! stay open.

use super::contact::mean_edge;
use super::{ChangeKind, Scene};
use cloth_core::element::Element;
use cloth_core::energy::Stitch;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::State;
use cloth_core::topology::{
    DisjointSets, EdgeTable, bow_tie_vertices, components, inconsistently_oriented_edges,
};

/// Length of an edge (in mean edges) below which it is seldom meant.
const SLIVER: Real = 1e-3;

/// Sets of the points that are no farther from each other than `distance` (m), or are joined by others between them;
/// the root of a set is its lowest number.
pub(super) fn coincident(x: &[Vec3], distance: Real) -> DisjointSets {
    // Points of a grid come one after the other along a direction that is none of its own.
    let skew = Vec3::new(0.83, 0.51, 0.23).normalize();
    let mut order: Vec<(Real, u32)> = (0..).zip(x).map(|(v, x)| (x.dot(&skew), v)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sets = DisjointSets::new(x.len());
    for (place, &(along, v)) in order.iter().enumerate() {
        for &(other, u) in &order[place + 1..] {
            if other - along > distance {
                break;
            }
            if (x[v as usize] - x[u as usize]).norm() <= distance {
                sets.join(v, u);
            }
        }
    }
    sets
}

impl Scene {
    /// Sentences about bow-tie vertices, edges between triangles that are wound against each other, and slivers, if there
    /// are any: all are allowed, and seldom meant.
    pub fn mesh_notes(&self) -> Vec<String> {
        let Some(mesh) = &self.mesh else {
            return Vec::new();
        };
        let Ok(edges) = EdgeTable::build(mesh) else {
            return Vec::new();
        };
        let touching = bow_tie_vertices(mesh, &edges);
        let turned = inconsistently_oriented_edges(mesh, &edges);
        let touching_at = touching.first().map(|&vertex| {
            format!(
                "fans of triangles touch without a common edge at {} of the vertices, such as {}: nothing resists bending \
                 between them",
                touching.len(),
                self.named(vertex)
            )
        });
        let named = |ends: [u32; 2]| {
            let mut ends = ends.map(|v| self.named(v));
            ends.sort_unstable();
            ends
        };
        let turned_at = turned.first().map(|&edge| {
            let [a, b] = named(edges.ends()[edge as usize]);
            format!(
                "triangles are wound against each other at {} of the edges, such as that from {a} to {b}: there the \
                 sides of the cloth change places",
                turned.len()
            )
        });
        let x = mesh.positions();
        let length = |[a, b]: [u32; 2]| (x[a as usize] - x[b as usize]).norm();
        let lengths = edges.ends().iter().map(|&ends| (ends, length(ends)));
        let shortest = lengths.min_by(|a, b| a.1.total_cmp(&b.1));
        let mean = mean_edge(mesh);
        let sliver = shortest.filter(|(_, length)| *length < SLIVER * mean);
        let sliver_at = sliver.map(|(ends, length)| {
            let [a, b] = named(ends);
            format!(
                "the edge between vertices {a} and {b} is {length:.1e} m long, where edges have {mean:.1e} m on average: \
                 what is stiff there takes small steps, and what is told of its stretch means little; make its ends one"
            )
        });
        let all = [touching_at, turned_at, sliver_at];
        all.into_iter().flatten().collect()
    }

    /// A sentence about a seam that is open by more than an edge where it has closed, if there is one.
    pub(crate) fn seam_warning(&self, state: &State, time: Real) -> Option<String> {
        fn opening<const N: usize>(stitch: &Stitch<N>, x: &[Vec3]) -> ([u32; 2], Real, Real) {
            let ends = [stitch.vertices()[0], stitch.vertices()[1]];
            (ends, stitch.gap(x).norm(), stitch.until())
        }
        let (seam, x) = (self.model.seam(), &state.positions);
        let pairs = seam.pairs.iter().map(|stitch| opening(stitch, x));
        let onto_edges = seam.onto_edges.iter().map(|stitch| opening(stitch, x));
        let closed = pairs.chain(onto_edges).filter(|(.., until)| *until <= time);
        let (ends, gap, _) = closed.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let [a, b] = ends.map(|v| self.named(v));
        (gap > mean_edge(self.mesh.as_ref()?)).then(|| {
            format!(
                "a seam is still open by {gap:.4} m between vertices {a} and {b}, where it should have closed: something is \
                 in between or holds them, or what it joins is too small"
            )
        })
    }

    /// A sentence about border vertices in the same place that nothing joins, if there are any: the cloth falls apart
    /// there.
    pub fn border_warning(&self) -> Option<String> {
        let mesh = self.mesh.as_ref()?;
        let edges = EdgeTable::build(mesh).ok()?;
        let border = (0..edges.len()).filter(|&edge| edges.is_boundary(edge));
        let mut border: Vec<u32> = border.flat_map(|edge| edges.ends()[edge]).collect();
        border.sort_unstable();
        border.dedup();
        let later = self.changes.iter().filter_map(|change| match &change.kind {
            ChangeKind::Sew { seam, .. } => Some(seam.clone()),
            _ => None,
        });
        let seams: Vec<_> = std::iter::once(self.model.seam()).chain(later).collect();
        let mut sewn: Vec<u32> = Vec::new();
        for seam in &seams {
            sewn.extend(seam.sewn_pairs().as_flattened());
            sewn.extend(seam.sewn_onto_edges().as_flattened());
        }
        border.retain(|v| !sewn.contains(v));
        let x: Vec<Vec3> = border
            .iter()
            .map(|&v| mesh.positions()[v as usize])
            .collect();
        let mut sets = coincident(&x, 0.0);
        let doubles: Vec<[u32; 2]> = (0..x.len() as u32)
            .map(|v| [sets.root(v), v])
            .filter(|[root, v]| root != v)
            .map(|pair| pair.map(|v| border[v as usize]))
            .collect();
        let [a, b] = doubles.first()?.map(|v| self.named(v));
        let pieces = components(mesh.vertex_count(), &edges);
        let pieces = pieces.iter().max().map_or(0, |last| last + 1);
        Some(format!(
            "{} border vertices lie on others without being one with them, such as {} on {}: there the cloth, of \
             {pieces} pieces, falls apart; weld = 0 makes those of one [[mesh]] one, and two [[mesh]] need a [[seam]], or a \
             distance from each other",
            doubles.len(),
            a.max(b),
            a.min(b)
        ))
    }
}
