//! Normals of the vertices of a surface, for pictures and exports.

use crate::math::{Vec3, gather};

/// Unit normals (dimensionless), one per vertex, of triangles at `positions` (m): out of the side from which their
/// corners run counter-clockwise. Zero where those of the triangles cancel, and at a vertex without a triangle.
///
/// The corner between the edges a and b weighs in with `a × b/(‖a‖² ‖b‖²)`, which is exact wherever a vertex and its
/// neighbours lie on a sphere, in whatever places (N. Max, "Weights for computing vertex normals from facet normals",
/// Journal of Graphics Tools 4(2), 1999, <https://doi.org/10.1080/10867651.1999.10487501>, equation 2).
///
/// # Panics
/// If a triangle names a vertex without a position.
#[must_use]
pub fn vertex_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::zeros(); positions.len()];
    for &triangle in triangles {
        let x = gather(positions, triangle);
        for corner in 0..3 {
            let a = x[(corner + 1) % 3] - x[corner];
            let b = x[(corner + 2) % 3] - x[corner];
            let weighted = a.cross(&b) / (a.norm_squared() * b.norm_squared());
            // An edge without length has no direction.
            if crate::math::is_finite(&weighted) {
                normals[triangle[corner] as usize] += weighted;
            }
        }
    }
    for normal in &mut normals {
        let length = normal.norm();
        *normal = if length > 0.0 {
            *normal / length
        } else {
            Vec3::zeros()
        };
    }
    normals
}
