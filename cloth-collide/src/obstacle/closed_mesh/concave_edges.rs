//! The distances of a body that is not convex, for energies that have to be continuously differentiable.
//!
//! Let d(P) be the distance from the part P of the surface, a triangle, an edge or a vertex. Each is convex, so d(P)
//! has a continuous gradient outside of it, and so has
//!
//! Σ over triangles ψ(d) − Σ over edges ψ(d) + Σ over vertices ψ(d)
//!
//! for every ψ that has one (M. Li, Z. Ferguson, T. Schneider, T. Langlois, D. Zorin, D. Panozzo, C. Jiang and D. M.
//! Kaufman, "Convergent incremental potential contact", 2023, <https://arxiv.org/abs/2307.15908>). Where the surface is
//! convex or flat as far as the range of ψ, this is ψ of the distance: triangles that are nearest at one of their edges
//! cancel against the edge, all but one, and around a vertex with n triangles n − n + 1 are left. At a concave edge
//! both sides count, and so do two sides of a gap.

use super::{ClosedMesh, feature};
use crate::bounds::Bounds;
use crate::closest::{nearest_on_segment, point_triangle};
use crate::convert::aabb;
use crate::incidence::ends;
use crate::obstacle::Distance;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use cloth_core::topology::{EdgeTable, joined};

/// A triangle this fraction of the size of a body above the plane of its neighbour makes the edge between them concave.
const ABOVE: Real = 1e-9;

/// Whether the surface, which is closed and does not pass through itself, is that of a convex body: one component, and
/// without a concave edge.
pub(super) fn is_convex(mesh: &TriMesh, table: &EdgeTable, faces: &[Vec3]) -> bool {
    let components = joined(mesh.vertex_count(), table.ends().iter().copied());
    if components
        .iter()
        .any(|&component| component != components[0])
    {
        return false;
    }
    let size = Bounds::of(mesh.positions()).size();
    let is_concave = |(&[a, b], &[end, _]): (&[u32; 2], &[u32; 2])| {
        let start = mesh.positions()[end as usize];
        let other = gather(mesh.positions(), mesh.triangles()[b as usize]);
        let heights = other.map(|x| faces[a as usize].dot(&(x - start)));
        heights.iter().any(|&height| height > ABOVE * size)
    };
    !table.sides().iter().zip(table.ends()).any(is_concave)
}

/// Of each vertex, 1 over the number of triangles around it.
pub(super) fn shares(mesh: &TriMesh) -> Vec<Real> {
    let mut counts = vec![0.0; mesh.vertex_count()];
    let corners = mesh.triangles().iter().flatten();
    corners.for_each(|&vertex| counts[vertex as usize] += 1.0);
    counts.into_iter().map(|count: Real| 1.0 / count).collect()
}

impl ClosedMesh {
    /// The sum above, triangle by triangle: each counts itself once, minus one half of each of its edges, and 1/n of
    /// each of its corners that has n triangles around it. Terms with the same nearest point are added up first, and
    /// those whose weights add up to 0 are not visited. The point (m) is outside.
    pub(super) fn each_part_outside(
        &self,
        point: Vec3,
        range: Real,
        visit: &mut dyn FnMut(Distance, Real),
    ) {
        let around = aabb(&Bounds::around([point]).inflated(range));
        for t in self.tree.intersect_aabb(&around) {
            let corners = self.triangles[t as usize];
            let x = gather(&self.positions, corners);
            let nearest = point_triangle(point, x);
            if nearest.distance() >= range {
                continue;
            }
            // Three corners, three edges from corner k to the next one, and the triangle.
            let mut weights = [0.0; 7];
            let mut separations = [nearest.separation; 7];
            weights[feature(&nearest)] += 1.0;
            for k in 0..3 {
                let [a, b] = ends(k);
                let (d, edge) = (point - x[a], x[b] - x[a]);
                let s = nearest_on_segment(d, edge);
                separations[3 + k] = d - edge * s;
                let part = match s {
                    0.0 => a,
                    1.0 => b,
                    _ => 3 + k,
                };
                weights[part] -= 0.5;
                separations[k] = d;
                weights[k] += self.shares[corners[k] as usize];
            }
            for (weight, separation) in weights.into_iter().zip(separations) {
                let distance = separation.norm();
                if weight != 0.0 && distance < range && distance > 0.0 {
                    visit(Distance::exact(distance, separation / distance), weight);
                }
            }
        }
    }
}
