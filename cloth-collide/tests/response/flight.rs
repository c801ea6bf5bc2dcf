//! Cloth without stiffness: every vertex flies freely, and only contact holds it.

use cloth_collide::{ClothContacts, SeparationProbe};
use cloth_core::contact::{ContactError, ContactSource, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

/// Vertices in free flight, with contact.
pub(crate) struct Flight {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) velocities: Vec<Vec3>,
    pub(crate) inverse_mass: Vec<Real>,
    pub(crate) gravity: Vec3,
    pub(crate) contacts: ClothContacts,
    pub(crate) probe: SeparationProbe,
}

impl Flight {
    /// `mesh` at rest, 1 kg a vertex.
    pub(crate) fn new(mesh: &TriMesh, contacts: ClothContacts) -> Self {
        Self {
            positions: mesh.positions().to_vec(),
            velocities: vec![Vec3::zeros(); mesh.vertex_count()],
            inverse_mass: vec![1.0; mesh.vertex_count()],
            gravity: Vec3::zeros(),
            contacts,
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
        let step = ContactStep {
            from: &self.positions,
            inverse_mass: &self.inverse_mass,
            dt,
        };
        self.contacts
            .resolve(&step, &mut positions, &mut velocities)?;
        (self.positions, self.velocities) = (positions, velocities);
        Ok(())
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
