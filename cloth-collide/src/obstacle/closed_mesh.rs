//! The inside of a closed mesh.

mod concave_edges;

use super::{Distance, ObstacleError, SignedDistance};
use crate::bounds::Bounds;
use crate::closest::PointTriangle;
use crate::convert::{nearest_triangle, tree_over};
use crate::separation::SeparationProbe;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use cloth_core::topology::{
    EdgeTable, bow_tie_vertices, inconsistently_oriented_edges, triangle_edges,
};
use parry3d_f64::partitioning::Bvh;
use std::fmt;

/// A body bounded by triangles. φ is the distance from the nearest triangle, found in a tree of boxes; it is negative
/// where the vector from the nearest point of the surface goes against the outward direction there.
///
/// On an edge or at a vertex the normal of one triangle would sometimes tell the wrong side. The *angle-weighted* sum
/// of the normals around a vertex, and the sum of both normals at an edge, never do (Bærentzen and Aanæs 2005). With
/// that, the sign is right wherever the distance is more than rounding.
///
/// Above a concave edge, whose sides meet at less than 180° outside, two triangles are nearest and the gradient of φ
/// jumps. What minimises an energy of φ comes to rest in just these places, and would go from side to side without end;
/// so such energies take [`SignedDistance::each_part`].
///
/// The mesh is checked once: closed, two triangles at each edge, consistent winding, outward normals, not through
/// itself.
pub struct ClosedMesh {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    tree: Bvh,
    /// Outward unit normal of each triangle.
    faces: Vec<Vec3>,
    /// Outward direction at the edge from corner k to the next one, of each triangle; not of unit length.
    edges: Vec<[Vec3; 3]>,
    /// Outward direction at each vertex; not of unit length.
    vertices: Vec<Vec3>,
    /// Of each vertex, 1 over the number of triangles around it; none if the body is convex.
    shares: Vec<Real>,
    bounds: Bounds,
}

impl ClosedMesh {
    /// The body that `mesh` bounds, its triangles counter-clockwise seen from outside.
    ///
    /// # Errors
    /// [`ObstacleError::NotASurface`], [`ObstacleError::NotClosed`], [`ObstacleError::MixedWinding`],
    /// [`ObstacleError::PinchedVertex`], [`ObstacleError::InsideOut`], [`ObstacleError::SelfIntersecting`].
    pub fn new(mesh: &TriMesh) -> Result<Self, ObstacleError> {
        let table = EdgeTable::build(mesh).map_err(ObstacleError::NotASurface)?;
        check(mesh, &table)?;
        let positions = mesh.positions().to_vec();
        let triangles = mesh.triangles().to_vec();
        let corners = || triangles.iter().map(|&t| gather(&positions, t));
        let faces: Vec<Vec3> = corners().map(unit_normal).collect();
        let edges = triangle_edges(mesh, &table)
            .into_iter()
            .map(|three| {
                three.map(|edge| {
                    let [a, b] = table.sides()[edge as usize];
                    faces[a as usize] + faces[b as usize]
                })
            })
            .collect();
        let mut vertices = vec![Vec3::zeros(); positions.len()];
        for ((triangle, x), face) in triangles.iter().zip(corners()).zip(&faces) {
            for k in 0..3 {
                let (u, w) = (x[(k + 1) % 3] - x[k], x[(k + 2) % 3] - x[k]);
                vertices[triangle[k] as usize] += face * u.cross(&w).norm().atan2(u.dot(&w));
            }
        }
        let shares = match concave_edges::is_convex(mesh, &table, &faces) {
            true => Vec::new(),
            false => concave_edges::shares(mesh),
        };
        Ok(Self {
            shares,
            tree: tree_over(corners()),
            bounds: Bounds::of(&positions),
            positions,
            triangles,
            faces,
            edges,
            vertices,
        })
    }

    /// The outward direction where `nearest` lies on triangle `t`: not of unit length.
    fn outward(&self, t: usize, nearest: &PointTriangle) -> Vec3 {
        match feature(nearest) {
            corner @ 0..3 => self.vertices[self.triangles[t][corner] as usize],
            edge @ 3..6 => self.edges[t][edge - 3],
            _ => self.faces[t],
        }
    }
}

impl SignedDistance for ClosedMesh {
    fn signed_distance(&self, point: Vec3) -> Distance {
        let corners = |t: usize| gather(&self.positions, self.triangles[t]);
        let found = nearest_triangle(&self.tree, point, Real::MAX, corners);
        let Some((t, nearest)) = found else {
            // So far away that the square of the distance is not a number any more.
            return Distance::exact(Real::MAX, Vec3::z());
        };
        let distance = nearest.distance();
        let outward = self.outward(t, &nearest);
        let side = 1f64.copysign(nearest.separation.dot(&outward));
        let size = self.bounds.size() + distance;
        // Beside a face its normal is exact. Elsewhere the vector from the nearest point is, unless it is so short that
        // rounding turns it.
        let normal = if nearest.weights.iter().all(|&w| w > 0.0) {
            self.faces[t]
        } else if distance > 1e-9 * size {
            nearest.separation * (side / distance)
        } else {
            outward.normalize()
        };
        Distance::exact(side * distance, normal)
    }

    fn each_part(&self, point: Vec3, range: Real, visit: &mut dyn FnMut(Distance, Real)) {
        let nearest = self.signed_distance(point);
        if self.shares.is_empty() || nearest.value <= 0.0 || nearest.value >= range {
            visit(nearest, 1.0);
        } else {
            self.each_part_outside(point, range, visit);
        }
    }

    fn bounds(&self) -> Option<Bounds> {
        Some(self.bounds)
    }
}

impl fmt::Debug for ClosedMesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The tree alone would be thousands of lines.
        f.debug_struct("ClosedMesh")
            .field("triangle_count", &self.triangles.len())
            .finish_non_exhaustive()
    }
}

/// Where on its triangle the nearest point is: at a corner (0 to 2), on an edge (3 to 5), from corner k to the next
/// one, or inside (6).
fn feature(nearest: &PointTriangle) -> usize {
    match nearest.weights.map(|weight| weight > 0.0) {
        [true, false, false] => 0,
        [false, true, false] => 1,
        [false, false, true] => 2,
        [true, true, false] => 3,
        [false, true, true] => 4,
        [true, false, true] => 5,
        _ => 6,
    }
}

fn unit_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a)).normalize()
}

/// Whether the mesh has an inside.
fn check(mesh: &TriMesh, table: &EdgeTable) -> Result<(), ObstacleError> {
    if let Some(edge) = (0..table.len()).find(|&edge| table.is_boundary(edge)) {
        return Err(ObstacleError::NotClosed {
            boundary_edge_count: table.boundary_edge_count(),
            first: table.ends()[edge],
        });
    }
    if let Some(&edge) = inconsistently_oriented_edges(mesh, table).first() {
        let edge = table.ends()[edge as usize];
        return Err(ObstacleError::MixedWinding { edge });
    }
    if let Some(&vertex) = bow_tie_vertices(mesh, table).first() {
        return Err(ObstacleError::PinchedVertex { vertex });
    }
    // Volumes of tetrahedra to a point nearby: to the origin they would cancel far away from it.
    let apex = mesh.positions()[0];
    let volume: Real = mesh
        .triangles()
        .iter()
        .map(|&t| gather(mesh.positions(), t).map(|x| x - apex))
        .map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0)
        .sum();
    if volume <= 0.0 {
        return Err(ObstacleError::InsideOut { volume });
    }
    let measured = SeparationProbe::new(mesh).measure(mesh.positions());
    match measured.map(|found| found.intersecting_pairs) {
        Ok(0) => Ok(()),
        Ok(pair_count) => Err(ObstacleError::SelfIntersecting { pair_count }),
        Err(_) => Err(ObstacleError::NonFinite { name: "mesh" }),
    }
}
