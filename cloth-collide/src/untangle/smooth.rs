//! Neighbours: displacements take them along.

use crate::incidence::edge_numbers;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

/// Averages displacements over the edges of a mesh, so that a fold is moved as a whole and not torn out of its
/// surroundings vertex by vertex.
#[derive(Debug)]
pub(super) struct Smoother {
    pub(super) edges: Vec<[u32; 2]>,
    valence: Vec<Real>,
    sums: Vec<Vec3>,
    ring: Vec<u32>,
}

impl Smoother {
    /// Of a mesh with pairs of vertices that are sewn together.
    pub(super) fn new(mesh: &TriMesh, sewn: &[[u32; 2]]) -> Self {
        let (mut edges, _) = edge_numbers(mesh.triangles());
        edges.extend(sewn);
        let mut valence = vec![0.0; mesh.vertex_count()];
        for vertex in edges.iter().flatten() {
            valence[*vertex as usize] += 1.0;
        }
        Self {
            edges,
            valence,
            sums: vec![Vec3::zeros(); mesh.vertex_count()],
            ring: Vec::new(),
        }
    }

    /// Adds the neighbours of what is inside.
    pub(super) fn grow(&mut self, is_inside: &mut [bool]) {
        let added = |[a, b]: [u32; 2]| {
            let ends = [is_inside[a as usize], is_inside[b as usize]];
            (ends[0] != ends[1]).then_some(if ends[0] { b } else { a })
        };
        self.ring.clear();
        self.ring
            .extend(self.edges.iter().filter_map(|&edge| added(edge)));
        for vertex in &self.ring {
            is_inside[*vertex as usize] = true;
        }
    }

    /// Replaces, in each of `rounds` rounds, the displacement of every free vertex by the mean of it and of the mean of
    /// its neighbours' `displacements`.
    pub(super) fn smooth(
        &mut self,
        displacements: &mut [Vec3],
        inverse_mass: &[Real],
        rounds: u32,
    ) {
        for _ in 0..rounds {
            self.sums.fill(Vec3::zeros());
            for [a, b] in self.edges.iter().map(|e| e.map(|v| v as usize)) {
                self.sums[a] += displacements[b];
                self.sums[b] += displacements[a];
            }
            let means = self.sums.iter().zip(&self.valence).map(|(s, n)| s / *n);
            for ((d, mean), w) in displacements.iter_mut().zip(means).zip(inverse_mass) {
                if *w > 0.0 {
                    *d = (*d + mean) * 0.5;
                }
            }
        }
    }
}
