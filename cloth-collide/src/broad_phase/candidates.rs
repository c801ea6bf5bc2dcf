//! Vertex–triangle and edge–edge pairs that can touch.

use super::BroadPhase;
use super::order::PairSorter;
use super::triangle_pairs::TrianglePairs;
use crate::bounds::Bounds;
use crate::ccd::{Query, QueryKind};
use crate::error::{CollideError, NonFinite};
use crate::incidence::Incidence;
use crate::pair::{Gap, Pair};
use cloth_core::error::not_negative;
use cloth_core::math::{Real, Vec3, is_finite};
use cloth_core::mesh::TriMesh;

/// The pairs (vertex, triangle) and (edge, edge) of a cloth that can come within a margin of each other while it moves;
/// of several cloths, if they are one mesh.
///
/// A pair is a candidate if the boxes of its two parts overlap, each box around all positions of its vertices before
/// and after the motion, moved outwards by half of the margin and by one rounding, and if they are not farther apart
/// than the margin, at both ends of the motion, along the line between their nearest points halfway. Boxes alone would
/// be far too many: those of a tilted layer overlap with the layers above and below wherever it is, and those of
/// neighbours in a flat sheet overlap all the time.
///
/// So no pair is lost that comes as near as the margin while its vertices move on straight paths. Left out are
/// pairs with a common vertex.
///
/// The candidates are the same for every [`BroadPhase`], in rising order, and depend on nothing but the mesh, the
/// motion and the margin.
///
/// ```
/// use cloth_collide::{ClothCandidates, Hierarchy};
/// use cloth_core::math::Vec3;
/// use cloth_core::mesh::TriMesh;
///
/// // Two triangles (m), the upper one falls through the lower.
/// let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
/// let at = |z: f64| corners.map(|(x, y)| Vec3::new(x, y, z));
/// let from = [at(0.0), at(1.0)].concat();
/// let to = [at(0.0), at(-1.0)].concat();
/// let mesh = TriMesh::new(from.clone(), vec![[0, 1, 2], [3, 4, 5]])?;
///
/// let mut candidates = ClothCandidates::new(&mesh, Hierarchy::default());
/// candidates.update(&from, &to, 0.01)?;
/// assert_eq!(candidates.vertex_triangle().len(), 6);
/// assert_eq!(candidates.edge_edge().len(), 9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ClothCandidates<B> {
    incidence: Incidence,
    vertex_boxes: Vec<Bounds>,
    triangle_pairs: TrianglePairs<B>,
    /// Of each kind, in the order of [`QueryKind`].
    found: [Vec<[u32; 2]>; 2],
    sorter: PairSorter,
}

impl<B: BroadPhase> ClothCandidates<B> {
    /// Prepares for the cloth `mesh`. There are no candidates before the first
    /// [`ClothCandidates::update`].
    #[must_use]
    pub fn new(mesh: &TriMesh, broad_phase: B) -> Self {
        let incidence = Incidence::new(mesh);
        let nothing = Bounds::around([Vec3::zeros()]);
        Self {
            incidence,
            vertex_boxes: vec![nothing; mesh.vertex_count()],
            triangle_pairs: TrianglePairs::with(mesh, broad_phase),
            found: [Vec::new(), Vec::new()],
            sorter: PairSorter::default(),
        }
    }

    /// Finds the candidates of the motion from positions `from` to positions `to` (m), one per vertex, for a margin of
    /// `margin` (m).
    ///
    /// # Errors
    /// [`CollideError::NonFinitePosition`], [`CollideError::OutOfRange`] if the margin is negative or not finite.
    /// The candidates then stay as they were.
    ///
    /// # Panics
    /// If there are not as many positions as the mesh has vertices.
    pub fn update(&mut self, from: &[Vec3], to: &[Vec3], margin: Real) -> Result<(), CollideError> {
        not_negative("margin (m)", margin)?;
        Ok(self.search(from, to, margin)?)
    }

    /// The same with a margin (m) that is not negative.
    pub(crate) fn search(
        &mut self,
        from: &[Vec3],
        to: &[Vec3],
        margin: Real,
    ) -> Result<(), NonFinite> {
        let count = self.vertex_boxes.len();
        assert!(
            from.len() == count && to.len() == count,
            "the number of positions is not the number of vertices"
        );
        let ends = || from.iter().zip(to);
        if let Some(vertex) = ends().position(|(a, b)| !is_finite(a) || !is_finite(b)) {
            return Err(NonFinite { vertex });
        }
        for (bounds, (&from, &to)) in self.vertex_boxes.iter_mut().zip(ends()) {
            *bounds = Bounds::around([from, to]).inflated(0.5 * margin);
        }
        let boxes = self.triangle_pairs.bounds.iter_mut();
        for (bounds, triangle) in boxes.zip(&self.incidence.triangles) {
            *bounds = around(&triangle.map(|v| &self.vertex_boxes[v as usize]));
        }
        self.triangle_pairs.search();
        self.collect([from, to], margin);
        Ok(())
    }

    fn collect(&mut self, path: [&[Vec3]; 2], margin: Real) {
        let mut found = std::mem::take(&mut self.found);
        found.iter_mut().for_each(Vec::clear);
        for &pair in &self.triangle_pairs.pairs {
            let reaches = |ends: [u32; 2], t: u32| {
                around(&ends.map(|v| &self.vertex_boxes[v as usize]))
                    .overlaps(&self.triangle_pairs.bounds[t as usize])
            };
            self.incidence.visit(pair, reaches, |pair, [a, b]| {
                if self.can_touch(pair, path, margin) {
                    found[pair.kind as usize].push(match pair.kind {
                        QueryKind::VertexTriangle => [a, b],
                        QueryKind::EdgeEdge => [a.min(b), a.max(b)],
                    });
                }
            });
        }
        self.found = found;
        let counts = [self.vertex_boxes.len(), self.incidence.edges.len()];
        for (found, count) in self.found.iter_mut().zip(counts) {
            self.sorter.sort_pairs(found, count);
        }
    }

    /// Whether two primitives have overlapping boxes, and are not separated by the plane across the line between their
    /// nearest points halfway.
    #[inline]
    fn can_touch(&self, pair: Pair, [from, to]: [&[Vec3]; 2], margin: Real) -> bool {
        let boxes = pair.vertices.map(|v| &self.vertex_boxes[v as usize]);
        let (first, second) = boxes.split_at(pair.kind.split());
        if !around(first).overlaps(&around(second)) {
            return false;
        }
        let path = Query::of(pair, from, to);
        let halfway = Gap::new(pair.kind, &path.at(0.5));
        !path.is_apart_along(&halfway.normal, margin)
    }

    /// Pairs `[vertex, triangle]` in rising order.
    #[must_use]
    pub fn vertex_triangle(&self) -> &[[u32; 2]] {
        &self.found[0]
    }

    /// Pairs `[e, f]` of numbers of edges, e < f, in rising order.
    #[must_use]
    pub fn edge_edge(&self) -> &[[u32; 2]] {
        &self.found[1]
    }

    /// The two vertices of each edge, the lower number first; in rising order, as in
    /// [`cloth_core::topology::EdgeTable`], but here an edge may have any number of triangles.
    #[must_use]
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.incidence.edges
    }

    /// All of them, those of a vertex and a triangle first.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = Pair> + '_ {
        let [vertex_triangle, edge_edge] = self.found.each_ref().map(|found| found.iter());
        let vertex_triangle = vertex_triangle.map(|&[v, t]| self.incidence.vertex_triangle(v, t));
        vertex_triangle.chain(edge_edge.map(|&[e, f]| self.incidence.edge_edge(e, f)))
    }
}

fn around(boxes: &[&Bounds]) -> Bounds {
    boxes[1..]
        .iter()
        .fold(*boxes[0], |all, one| all.joined(one))
}
