//! Cloth as simple as can be: vertices in free flight, edges of constant length if wanted, and contact.

use cloth_collide::SeparationProbe;
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactError, ContactStep, Projection};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

/// Sweeps over the edges in a step.
const SWEEPS: usize = 20;
/// Sweeps over the contacts.
const CONTACT_SWEEPS: u32 = 10;

/// Vertices in free flight, with contact.
pub(crate) struct Flight {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) velocities: Vec<Vec3>,
    pub(crate) inverse_mass: Vec<Real>,
    pub(crate) gravity: Vec3,
    /// Edges that keep their length (m), a few sweeps a step.
    pub(crate) edges: Vec<([usize; 2], Real)>,
    pub(crate) contacts: PotentialContacts,
    projection: Projection,
    pub(crate) probe: SeparationProbe,
}

impl Flight {
    /// `mesh` at rest, 1 kg a vertex.
    pub(crate) fn new(mesh: &TriMesh, contacts: PotentialContacts) -> Self {
        Self {
            positions: mesh.positions().to_vec(),
            velocities: vec![Vec3::zeros(); mesh.vertex_count()],
            inverse_mass: vec![1.0; mesh.vertex_count()],
            gravity: Vec3::zeros(),
            edges: Vec::new(),
            contacts,
            projection: Projection::default(),
            probe: SeparationProbe::new(mesh),
        }
    }

    /// One step of symplectic Euler, and contact.
    pub(crate) fn step(&mut self, dt: Real) -> Result<(), ContactError> {
        let mut velocities = self.velocities.clone();
        for (v, &w) in velocities.iter_mut().zip(&self.inverse_mass) {
            if w != 0.0 {
                *v += self.gravity * dt;
            }
        }
        let ends = self.positions.iter().zip(&velocities);
        let mut positions: Vec<_> = ends.map(|(x, v)| x + v * dt).collect();
        if !self.edges.is_empty() {
            for _ in 0..SWEEPS {
                self.keep_lengths(&mut positions);
            }
            let displacements = positions.iter().zip(&self.positions);
            velocities = displacements.map(|(to, from)| (to - from) / dt).collect();
        }
        let step = ContactStep {
            from: &self.positions,
            inverse_mass: &self.inverse_mass,
            dt,
        };
        let (x, v) = (&mut positions, &mut velocities);
        self.projection
            .step(&mut self.contacts, &step, CONTACT_SWEEPS, x, v)?;
        (self.positions, self.velocities) = (positions, velocities);
        Ok(())
    }

    /// Makes all edges of the mesh keep their present length.
    pub(crate) fn with_edges(mut self, mesh: &TriMesh) -> Self {
        let sides = mesh
            .triangles()
            .iter()
            .flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
        let sorted = sides.map(|[a, b]| [a.min(b) as usize, a.max(b) as usize]);
        let edges: std::collections::BTreeSet<_> = sorted.collect();
        let length = |[a, b]: [usize; 2]| (self.positions[a] - self.positions[b]).norm();
        self.edges = edges.into_iter().map(|e| (e, length(e))).collect();
        self
    }

    fn keep_lengths(&self, x: &mut [Vec3]) {
        for &([a, b], length) in &self.edges {
            let (wa, wb) = (self.inverse_mass[a], self.inverse_mass[b]);
            let difference = x[b] - x[a];
            if wa + wb > 0.0 && difference.norm() > 0.0 {
                let correction = difference * ((1.0 - length / difference.norm()) / (wa + wb));
                x[a] += correction * wa;
                x[b] -= correction * wb;
            }
        }
    }

    /// Number of pairs of triangles that meet.
    pub(crate) fn crossings(&mut self) -> usize {
        let found = self.probe.measure(&self.positions).expect("finite");
        found.intersecting_pairs
    }

    pub(crate) fn momentum(&self) -> Vec3 {
        let both = self.velocities.iter().zip(&self.inverse_mass);
        both.map(|(v, w)| v / *w).sum()
    }
}

/// Several meshes as one.
pub(crate) fn together(meshes: &[TriMesh]) -> TriMesh {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for mesh in meshes {
        let first = positions.len() as u32;
        positions.extend_from_slice(mesh.positions());
        triangles.extend(mesh.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    TriMesh::new(positions, triangles).expect("a mesh")
}

/// The mesh with its vertices moved.
pub(crate) fn moved(mesh: &TriMesh, place: impl Fn(&Vec3) -> Vec3) -> TriMesh {
    let positions = mesh.positions().iter().map(place).collect();
    TriMesh::new(positions, mesh.triangles().to_vec()).expect("a mesh")
}
