//! Vertex–triangle and edge–edge pairs that can touch.

use super::BroadPhase;
use super::order::PairSorter;
use super::separating_plane::SeparatingPlane;
use super::triangle_pairs::TrianglePairs;
use crate::bounds::Bounds;
use crate::ccd::QueryKind;
use crate::error::CollideError;
use crate::incidence::Incidence;
use crate::pair::{Pair, nearest};
use cloth_core::error::not_negative;
use cloth_core::math::{Real, Vec3, gather, is_finite};
use cloth_core::mesh::TriMesh;

/// The pairs (vertex, triangle) and (edge, edge) of a cloth that can come within a margin of each other while it moves;
/// of several cloths, if they are one mesh.
///
/// A pair is a candidate if the boxes of its two parts overlap, each box around all positions of its vertices before
/// and after the motion, moved outwards by half of the margin and by one rounding, and if no plane is found between the
/// boxes of the vertices of one part and those of the other. Three planes are tried: along each of the two triangles
/// that the parts belong to, and across the line between their nearest points halfway. Boxes alone would be far too
/// many: those of a tilted layer overlap with the layers above and below wherever it is, and those of neighbours in a
/// flat sheet overlap all the time.
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
#[derive(Debug)]
pub struct ClothCandidates<B> {
    incidence: Incidence,
    vertex_boxes: Vec<Bounds>,
    triangle_pairs: TrianglePairs<B>,
    /// The middle (m) of each vertex's box.
    middles: Vec<Vec3>,
    /// Across each triangle, halfway (m²).
    normals: Vec<Vec3>,
    separating_plane: SeparatingPlane,
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
            middles: vec![Vec3::zeros(); mesh.vertex_count()],
            normals: vec![Vec3::zeros(); mesh.triangle_count()],
            separating_plane: SeparatingPlane::default(),
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
        let count = self.vertex_boxes.len();
        assert!(
            from.len() == count && to.len() == count,
            "the number of positions is not the number of vertices"
        );
        not_negative("margin (m)", margin)?;
        let ends = || from.iter().zip(to);
        if let Some(vertex) = ends().position(|(a, b)| !is_finite(a) || !is_finite(b)) {
            return Err(CollideError::NonFinitePosition { vertex });
        }
        for (bounds, (&from, &to)) in self.vertex_boxes.iter_mut().zip(ends()) {
            *bounds = Bounds::around([from, to]).inflated(0.5 * margin);
        }
        let boxes = self.triangle_pairs.bounds.iter_mut();
        for (bounds, triangle) in boxes.zip(&self.incidence.triangles) {
            *bounds = around(&triangle.map(|v| &self.vertex_boxes[v as usize]));
        }
        self.separating_plane = SeparatingPlane::among(&self.vertex_boxes);
        for (middle, bounds) in self.middles.iter_mut().zip(&self.vertex_boxes) {
            *middle = (bounds.lower + bounds.upper) * 0.5;
        }
        for (normal, &triangle) in self.normals.iter_mut().zip(&self.incidence.triangles) {
            let [a, b, c] = gather(&self.middles, triangle);
            *normal = (b - a).cross(&(c - a));
        }
        self.triangle_pairs.search();
        self.collect();
        Ok(())
    }

    fn collect(&mut self) {
        let mut pairs = std::mem::take(&mut self.triangle_pairs.pairs);
        pairs.retain(|pair| !self.are_parted(pair.map(|t| t as usize)));
        let mut found = std::mem::take(&mut self.found);
        found.iter_mut().for_each(Vec::clear);
        for &pair in &pairs {
            let reaches = |ends: [u32; 2], t: u32| {
                around(&ends.map(|v| &self.vertex_boxes[v as usize]))
                    .overlaps(&self.triangle_pairs.bounds[t as usize])
            };
            self.incidence.visit(pair, reaches, |pair, [a, b]| {
                if self.can_touch(pair) {
                    found[pair.kind as usize].push(match pair.kind {
                        QueryKind::VertexTriangle => [a, b],
                        QueryKind::EdgeEdge => [a.min(b), a.max(b)],
                    });
                }
            });
        }
        self.triangle_pairs.pairs = pairs;
        self.found = found;
        let counts = [self.vertex_boxes.len(), self.incidence.edges.len()];
        for (found, count) in self.found.iter_mut().zip(counts) {
            self.sorter.sort_pairs(found, count);
        }
    }

    /// Whether a plane along one of two triangles has them apart, and so all of their parts.
    fn are_parted(&self, [a, b]: [usize; 2]) -> bool {
        let corners =
            [a, b].map(|t| self.incidence.triangles[t].map(|v| &self.vertex_boxes[v as usize]));
        let along = |t: usize| {
            self.separating_plane
                .is_plane(&self.normals[t], &corners[0], &corners[1])
        };
        along(a) || along(b)
    }

    /// Whether two primitives have overlapping boxes, and are not parted by the plane across the line between their
    /// nearest points halfway.
    #[inline]
    fn can_touch(&self, Pair { kind, vertices }: Pair) -> bool {
        let boxes = vertices.map(|v| &self.vertex_boxes[v as usize]);
        let (first, second) = boxes.split_at(kind.split());
        if !around(first).overlaps(&around(second)) {
            return false;
        }
        let (_, line) = nearest(kind, &gather(&self.middles, vertices));
        !self.separating_plane.is_plane(&line, first, second)
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
