//! What the stretch of cloth is measured by.

use super::{ContactSetup, Scene};
use crate::error::BenchError;
use cloth_core::cloth::Elements;
use cloth_core::element::{Element, Energy};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::topology::{EdgeTable, components};

/// Strain at which the stiffness of a triangle is measured.
const SMALL: Real = 1e-6;

impl Scene {
    /// Springs to measure stretch by: those of the model, and in pieces whose membrane is of another kind one on every
    /// edge, as stiff as the springs of a sheet of that modulus. Solids count only where there is no cloth.
    pub fn gauges(&self) -> Result<Vec<Spring>, BenchError> {
        let mut gauges = self.model.springs.clone();
        let Some(mesh) = &self.mesh else {
            return Ok(gauges);
        };
        let edges = EdgeTable::build(mesh)?;
        let piece = components(mesh.vertex_count(), &edges);
        let count = piece.iter().max().map_or(0, |last| last + 1) as usize;
        let of = |vertex: u32| piece[vertex as usize] as usize;
        let mut is_solid = vec![false; count];
        for family in &self.model.others {
            if let Elements::ArapTetrahedra(elements) = family {
                elements
                    .iter()
                    .for_each(|e| is_solid[of(e.vertices[0])] = true);
            }
        }
        let is_all_solid = !is_solid.contains(&false);
        let mut is_left = vec![true; count];
        gauges
            .iter()
            .for_each(|spring| is_left[of(spring.vertices[0])] = false);
        for (is_left, is_solid) in is_left.iter_mut().zip(is_solid) {
            *is_left &= is_all_solid || !is_solid;
        }
        if is_left.contains(&true) {
            let stiffness = stiffness_of_edges(&self.model.others, mesh.positions(), &edges);
            let all = Spring::along(mesh.positions(), edges.ends(), 0.0);
            let left = all.into_iter().zip(stiffness);
            let left = left.filter(|(spring, _)| is_left[of(spring.vertices[0])]);
            gauges.extend(left.map(|(spring, stiffness)| Spring {
                stiffness,
                ..spring
            }));
        }
        Ok(gauges)
    }

    /// The same, and springs of no length that only say which pieces can carry each other: where they are linked or
    /// sewn together, or can touch.
    pub(crate) fn joined_gauges(&self) -> Result<Vec<Spring>, BenchError> {
        let mut joined = self.gauges()?;
        let joint = |vertices: [u32; 2]| Spring {
            vertices,
            rest_length: 0.0,
            stiffness: 0.0,
        };
        for family in &self.model.others {
            match family {
                Elements::Links(all) => joined.extend(all.iter().map(|e| joint(e.vertices))),
                Elements::SlackLinks(all) => joined.extend(all.iter().map(|e| joint(e.vertices))),
                _ => {}
            }
        }
        joined.extend(self.sewn().into_iter().map(joint));
        for stitch in self.model.edge_stitches() {
            let [vertex, a, _] = stitch.vertices();
            joined.push(joint([vertex, a]));
        }
        let touch = self.touch.as_ref();
        if touch.is_some_and(ContactSetup::touches_itself) {
            let last = self.model.particles.len() as u32;
            joined.extend((1..last).map(|vertex| joint([vertex - 1, vertex])));
        }
        Ok(joined)
    }
}

/// Of each edge, the stiffness (N/m) by which springs store what its triangles do at a small and even strain s: of a
/// triangle with the edges L that is `2 E/(s² Σ L²)` for each of them.
fn stiffness_of_edges(families: &[Elements], x: &[Vec3], edges: &EdgeTable) -> Vec<Real> {
    let mut stiffness = vec![0.0; edges.len()];
    let mut add = |[a, b]: [u32; 2], own: Real| {
        if let Some(edge) = edges.find(a, b) {
            stiffness[edge] += own;
        }
    };
    let mut spread = |vertices: [u32; 3], element: &dyn Fn(&[Vec3; 3]) -> Real| {
        let at = gather(x, vertices);
        let stored = element(&at.map(|x| x * (1.0 + SMALL)));
        let squares: Real = (0..3)
            .map(|i| (at[i] - at[(i + 1) % 3]).norm_squared())
            .sum();
        let own = 2.0 * stored / (SMALL * SMALL * squares);
        (0..3).for_each(|i| add([vertices[i], vertices[(i + 1) % 3]], own));
    };
    for family in families {
        match family {
            Elements::Stvk(all) => all.iter().for_each(|e| spread(e.vertices, &|x| e.value(x))),
            Elements::Arap(all) => all.iter().for_each(|e| spread(e.vertices, &|x| e.value(x))),
            _ => {}
        }
    }
    for family in families {
        if let Elements::Limited(all) = family {
            all.iter().for_each(|e| add(e.vertices, e.stiffness));
        }
    }
    stiffness
}
