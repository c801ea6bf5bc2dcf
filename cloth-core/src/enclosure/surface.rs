//! A closed surface and its volume, `V = Σ a·(b × c)/6` over its triangles.

use super::EnclosureError;
use crate::math::{Real, Vec3, gather};
use crate::mesh::TriMesh;
use crate::topology::EdgeTable;
use std::f64::consts::TAU;

/// The triangles of a closed piece, seen from outside counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ClosedSurface {
    triangles: Vec<[u32; 3]>,
}

impl ClosedSurface {
    /// That of the piece of a mesh which consists of these triangles.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub(super) fn of(
        mesh: &TriMesh,
        triangles: impl IntoIterator<Item = usize>,
    ) -> Result<Self, EnclosureError> {
        let triangles = triangles.into_iter().map(|t| mesh.triangles()[t]).collect();
        let piece = mesh.part(triangles);
        let edges = EdgeTable::build(&piece)?;
        let open = (0..edges.ends().len()).find(|&edge| edges.is_boundary(edge));
        if let Some(edge) = open {
            return Err(EnclosureError::Open(edges.ends()[edge]));
        }
        let triangles = piece.triangles().to_vec();
        let mut surface = Self { triangles };
        if let Some(ends) = surface.disagreement() {
            return Err(EnclosureError::InconsistentlyOriented(ends));
        }
        if surface.volume(mesh.positions()) < 0.0 {
            let triangles = surface.triangles.iter_mut();
            triangles.for_each(|corners| corners.reverse());
        }
        Ok(surface)
    }

    /// V (m³) with the vertices at `x` (m).
    pub(super) fn volume(&self, x: &[Vec3]) -> Real {
        // About a point of the surface: far from the origin the sum would cancel.
        let first = self.triangles.first();
        let middle = first.map_or(Vec3::zeros(), |corners| x[corners[0] as usize]);
        let of = |&corners: &[u32; 3]| {
            let [a, b, c] = gather(x, corners).map(|x| x - middle);
            a.dot(&b.cross(&c)) / 6.0
        };
        self.triangles.iter().map(of).sum()
    }

    /// The radius (m) of the sphere that has as large a surface, with the vertices at `x` (m).
    pub(super) fn radius(&self, x: &[Vec3]) -> Real {
        let twice = |&corners: &[u32; 3]| {
            let [a, b, c] = gather(x, corners);
            (b - a).cross(&(c - a)).norm()
        };
        let area: Real = 0.5 * self.triangles.iter().map(twice).sum::<Real>();
        (area / (2.0 * TAU)).sqrt()
    }

    /// Adds `scale ∂V/∂x` (m² times the unit of `scale`) with the vertices at `x` (m) to `out`: of each triangle around
    /// a vertex a third of its area, along its normal.
    pub(super) fn add_gradient(&self, x: &[Vec3], scale: Real, out: &mut [Vec3]) {
        self.scatter(x, scale, &self.triangles, out);
    }

    /// The same with the entries of triangle i at `places[i]` of `out`.
    pub(super) fn scatter(&self, x: &[Vec3], scale: Real, places: &[[u32; 3]], out: &mut [Vec3]) {
        let sixth = scale / 6.0;
        for (&corners, places) in self.triangles.iter().zip(places) {
            let [a, b, c] = gather(x, corners);
            let third = (b - a).cross(&(c - a)) * sixth;
            for &place in places {
                out[place as usize] += third;
            }
        }
    }

    /// Its vertices in ascending order, and of each triangle the places of its corners in that order.
    pub(super) fn vertices(&self) -> (Vec<u32>, Vec<[u32; 3]>) {
        let mut vertices: Vec<u32> = self.triangles.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let place = |vertex: u32| vertices.partition_point(|&own| own < vertex) as u32;
        let places = self.triangles.iter().map(|corners| corners.map(place));
        let places = places.collect();
        (vertices, places)
    }

    /// An edge along which both its triangles run the same way, if there is one.
    fn disagreement(&self) -> Option<[u32; 2]> {
        let along = self.triangles.iter();
        let mut along: Vec<[u32; 2]> = along
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .collect();
        along.sort_unstable();
        along
            .windows(2)
            .find(|pair| pair[0] == pair[1])
            .map(|pair| pair[0])
    }
}
