//! The smallest distance of a cloth from itself, and the pairs of its triangles that meet.

mod bodies;
mod surface;

pub use bodies::BodyProbe;
pub use surface::distance_from_surface;

use crate::bounds::Bounds;
use crate::broad_phase::TrianglePairs;
use crate::error::CollideError;
use crate::incidence::Incidence;
use crate::intersect::{segment_meets_triangle, triangles_meet};
use crate::pair::{Pair, nearest as nearest_points};
use crate::potential::excluded::Excluded;
use crate::potential::sewn::Sewn;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use std::cell::Cell;

/// What [`SeparationProbe::measure`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Separation {
    /// How many pairs of triangles meet where they should not: pairs without a common vertex that
    /// have a point in common, and pairs with one common vertex that have a second point in common. Touching
    /// counts, as in [`triangles_meet`].
    pub intersecting_pairs: usize,
    /// The smallest distance (m) between a vertex and a triangle, or between two edges, that have no vertex in
    /// common; 0 if any triangles intersect; absent if there are none.
    pub min_distance: Option<Real>,
}

/// Measures how close a cloth comes to itself, again and again while it moves.
///
/// **What is measured.** `min_distance` takes all pairs (vertex, triangle) and (edge, edge) *that share no
/// vertex*, the same pairs between which a contact model with a thickness keeps its distance. It is zero
/// exactly if some piece of the cloth meets another one, up to rounding.
///
/// **What it does not say.** Neighbours in the mesh are such pairs too: two triangles with a common edge have two
/// corners that face each other across it. So `min_distance` is never more than the smallest height of a triangle onto
/// an edge that it shares: for an unstretched square grid of cell size h with diagonals, h/√2 (the corner across the
/// diagonal), even when it lies flat and alone. Only a value below that of the rest shape means something: that contact
/// is near, that a fold is sharp, or that a triangle is pressed flat in its own plane. No rule that leaves out more
/// neighbours is free of this, and each loses the sharp folds, so none is applied.
///
/// Two triangles with a common *edge* never count as intersecting: they meet elsewhere only if they lie exactly
/// flat on each other, and then `min_distance` is zero, or nearly so for rounding.
///
/// **How.** Pairs of triangles with overlapping boxes go through the exact test of [`triangles_meet`]. If none
/// meets, the distances of the pairs just tested, neighbours among them, give an upper limit. The tree of boxes is then
/// walked in search of anything nearer than the limit, which falls with every find. So that no pair of primitives is
/// computed twice, each vertex and each edge belongs to one of its triangles (Curtis, Tamstorf and Manocha 2008), and a
/// pair of triangles computes what both own.
///
/// ```
/// use cloth_collide::SeparationProbe;
/// use cloth_core::math::Vec3;
/// use cloth_core::mesh::TriMesh;
///
/// // Two unit squares (m), 10 cm apart.
/// let square = |z| [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z));
/// let positions = [square(0.0), square(0.1)].concat();
/// let triangles = vec![[0, 1, 2], [1, 3, 2], [4, 5, 6], [5, 7, 6]];
/// let mesh = TriMesh::new(positions.clone(), triangles)?;
///
/// let mut probe = SeparationProbe::new(&mesh);
/// assert_eq!(probe.measure(&positions)?.min_distance, Some(0.1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SeparationProbe {
    pairs: TrianglePairs,
    incidence: Incidence,
    excluded: Excluded,
    sewn: Sewn,
    vertex_count: usize,
}

impl SeparationProbe {
    /// Prepares for the cloth `mesh`: builds the tree, and looks up who owns what.
    #[must_use]
    pub fn new(mesh: &TriMesh) -> Self {
        Self {
            pairs: TrianglePairs::new(mesh),
            incidence: Incidence::new(mesh),
            excluded: Excluded::default(),
            sewn: Sewn::default(),
            vertex_count: mesh.vertex_count(),
        }
    }

    /// Without pairs of regions that may pass through each other, as
    /// [`PotentialBuilder::exclude`](crate::potential::PotentialBuilder::exclude) has them: `region` has a number for
    /// each vertex. A vertex beyond its end is in no region.
    #[must_use]
    pub fn exclude(mut self, region: Vec<u32>, pairs: Vec<[u32; 2]>) -> Self {
        self.excluded = Excluded::new(region, pairs);
        self
    }

    /// Without pairs of triangles that meet at a seam, as
    /// [`PotentialBuilder::sew`](crate::potential::PotentialBuilder::sew) has the vertices. What names a vertex
    /// beyond those of the mesh is left out.
    #[must_use]
    pub fn sew(mut self, pairs: &[[u32; 2]], onto_edges: &[[u32; 3]]) -> Self {
        self.sewn = Sewn::new(pairs, onto_edges, self.vertex_count);
        self
    }

    fn counts(&self, corners: [[u32; 3]; 2]) -> bool {
        let all = corners.as_flattened();
        !self.excluded.has(all) && !self.sewn.join(all)
    }

    /// Measures the cloth at `positions` (m), one per vertex. The result depends on mesh and positions only.
    ///
    /// # Errors
    /// [`CollideError::NonFinitePosition`] if a coordinate is NaN or infinite.
    ///
    /// # Panics
    /// If there are not as many positions as the mesh has vertices.
    pub fn measure(&mut self, positions: &[Vec3]) -> Result<Separation, CollideError> {
        self.pairs.find(positions)?;
        let intersecting_pairs = self.count_intersecting(positions);
        let min_distance = if intersecting_pairs > 0 {
            Some(0.0)
        } else {
            self.min_distance(positions)
        };
        Ok(Separation {
            intersecting_pairs,
            min_distance,
        })
    }

    fn count_intersecting(&self, positions: &[Vec3]) -> usize {
        let counted = self.pairs.corners().filter(|pair| self.counts(*pair));
        counted.filter(|pair| meet_unduly(*pair, positions)).count()
    }

    /// The smallest distance (m), given that the pairs of overlapping boxes have just been listed.
    fn min_distance(&self, positions: &[Vec3]) -> Option<Real> {
        let nearest = Cell::new(Real::INFINITY);
        for &pair in &self.pairs.pairs {
            self.lower_to_pair(pair, positions, &nearest);
        }
        self.pairs.broad_phase.visit_near(&nearest, |a, b| {
            let boxes = [a, b].map(|t| &self.pairs.bounds[t as usize]);
            // Overlapping boxes were in the list.
            if boxes[0].squared_gap(boxes[1]) > 0.0 {
                self.lower_to_pair([a, b], positions, &nearest);
            }
        });
        Some(nearest.get().sqrt()).filter(|distance| distance.is_finite())
    }

    /// Lowers the squared distance `nearest` (m²) to that of the primitives that two triangles represent.
    fn lower_to_pair(&self, pair: [u32; 2], positions: &[Vec3], nearest: &Cell<Real>) {
        let bounds = |t: u32| &self.pairs.bounds[t as usize];
        let corners = |t: u32| self.pairs.triangles[t as usize];
        let is_far = |a: &Bounds, b: &Bounds| a.squared_gap(b) >= nearest.get();
        if is_far(bounds(pair[0]), bounds(pair[1])) || !self.counts(pair.map(corners)) {
            return;
        }
        let reaches = |ends, t| !is_far(&Bounds::around(gather(positions, ends)), bounds(t));
        self.incidence
            .visit(pair, reaches, |Pair { kind, vertices }, _| {
                let x = gather(positions, vertices);
                let (one, other) = x.split_at(kind.split());
                if !is_far(&Bounds::of(one), &Bounds::of(other)) {
                    let found = nearest_points(kind, &x).1.norm_squared();
                    nearest.set(nearest.get().min(found));
                }
            });
    }
}

/// Whether two triangles have a point in common that is not due to a common vertex or edge.
pub(crate) fn meet_unduly(pair: [[u32; 3]; 2], positions: &[Vec3]) -> bool {
    let x = pair.map(|t| gather(positions, t));
    let shared = |one: usize| pair[one].map(|vertex| pair[1 - one].contains(&vertex));
    match shared(0).iter().filter(|&&s| s).count() {
        0 => triangles_meet(x[0], x[1]),
        // Two triangles that share a corner are both convex: if they share another point, they share the
        // segment to it and beyond, until one of them ends, and that is on the edge across from the corner.
        1 => (0..2).any(|one| {
            let across = match shared(one) {
                [true, _, _] => [1, 2],
                [_, true, _] => [2, 0],
                _ => [0, 1],
            };
            segment_meets_triangle(across.map(|k| x[one][k]), x[1 - one])
        }),
        _ => false,
    }
}
