//! Closest points of two primitives of cloth: the two cases that decide the distance of two triangles,
//! vertex against triangle and edge against edge.

mod edge_edge;
mod point_triangle;

pub use edge_edge::{EdgeEdge, edge_edge};
pub use point_triangle::{PointTriangle, point_triangle};

use cloth_core::math::{Real, Vec3};

/// Where the point of the segment from the origin along `edge` (m) is that lies nearest to `d` (m):
/// a fraction of `edge` in 0..=1. An edge without length gives 0.
pub(crate) fn nearest_on_segment(d: Vec3, edge: Vec3) -> Real {
    let squared = edge.norm_squared();
    if squared > 0.0 {
        (d.dot(&edge) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    }
}
