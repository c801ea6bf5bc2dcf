//! A cloth whose degrees of freedom are the middles of the edges.

use super::discretization::MembraneElements;
use super::{Cloth, ClothError, ClothModel, Elements};
use crate::energy::{ArapTriangle, MidpointHinge, Spring, StvkTriangle};
use crate::error::not_negative;
use crate::math::gather;
use crate::mesh::TriMesh;
use crate::particles::Particles;
use crate::topology::{EdgeTable, Midpoints};

/// A cloth discretized on the edge midpoints of a mesh, ready for any solver that takes its elements: particle e is the
/// middle of edge e.
///
/// Masses are those of the mesh's triangles, a third of each at each of its midpoints. For vertices at `x`, the
/// membrane costs at `midpoints.between(x)` what the same membrane costs at `x` on vertices, springs and triangles
/// alike; only there is more freedom here.
#[derive(Clone, Debug, PartialEq)]
pub struct MidpointCloth {
    /// From vertices to midpoints and back.
    pub midpoints: Midpoints,
    /// Masses and elements; hold a midpoint by prescribing its particle.
    pub model: ClothModel,
}

impl Cloth {
    /// The same cloth on edge midpoints: springs, StVK or ARAP on the triangles, and [`MidpointHinge`] for bending.
    ///
    /// Rotations about the middle of an edge are free, so a corner held by one midpoint is a ball joint; hold two or
    /// more to clamp.
    ///
    /// # Errors
    /// [`ClothError`] if a number is out of range or an edge of the mesh is not manifold.
    pub fn on_midpoints(
        &self,
        membrane: MembraneElements,
        mesh: &TriMesh,
    ) -> Result<MidpointCloth, ClothError> {
        self.membrane.check()?;
        not_negative("bending rigidity (N·m)", self.bending_rigidity)?;
        let edges = EdgeTable::build(mesh)?;
        let midpoints = Midpoints::of(mesh, &edges)?;
        let small = midpoints.mesh();
        // The small triangles have a quarter of the area, so they get four times the density and the modulus.
        let particles = Particles::from_areal_density(small, 4.0 * self.areal_density)?;
        let modulus = 4.0 * self.membrane.modulus(mesh, &edges);
        let mut springs = Vec::new();
        let mut others = Vec::new();
        match membrane {
            MembraneElements::Springs => springs = self.midpoint_springs(mesh, &edges, small),
            MembraneElements::Stvk { poisson_ratio } => {
                if !(-1.0 < poisson_ratio && poisson_ratio < 1.0) {
                    return Err(ClothError::PoissonRatio(poisson_ratio));
                }
                others.push(Elements::Stvk(StvkTriangle::on(
                    small,
                    modulus,
                    poisson_ratio,
                )));
            }
            MembraneElements::Arap => others.push(Elements::Arap(ArapTriangle::on(small, modulus))),
        }
        if self.bending_rigidity > 0.0 {
            let hinges = (0..edges.len()).filter_map(|edge| {
                let (points, corners) = midpoints.hinge(edge, &edges)?;
                let rest = gather(mesh.positions(), corners);
                Some(MidpointHinge::new(points, &rest, self.bending_rigidity))
            });
            others.push(Elements::Midpoint(hinges.collect()));
        }
        Ok(MidpointCloth {
            model: ClothModel {
                particles,
                springs,
                hinges: Vec::new(),
                others,
            },
            midpoints,
        })
    }

    /// Springs along the sides of the small triangles. A side is half as long as the edge beside it and changes by half
    /// as much, so it is four times as stiff; two triangles share the stiffness of an inner edge.
    fn midpoint_springs(&self, mesh: &TriMesh, edges: &EdgeTable, small: &TriMesh) -> Vec<Spring> {
        let of_edges = self.membrane.springs(mesh, edges);
        let mut springs = Vec::with_capacity(3 * small.triangle_count());
        for &middles in small.triangles() {
            for k in 0..3 {
                // The side from midpoint k to midpoint k + 1 cuts off corner k + 1 and runs along the third edge.
                let edge = middles[(k + 2) % 3] as usize;
                let triangles = if edges.is_boundary(edge) { 1.0 } else { 2.0 };
                let ends = [middles[k], middles[(k + 1) % 3]];
                let stiffness = 4.0 * of_edges[edge].stiffness / triangles;
                springs.extend(Spring::along(small.positions(), &[ends], stiffness));
            }
        }
        springs
    }
}
