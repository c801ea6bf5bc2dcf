//! Where an edge passes through a triangle, and how that point moves with the vertices.

use crate::closest::point_triangle;
use crate::intersect::segment_meets_triangle;
use cloth_core::math::{Real, Vec3, gather};

/// One end of the segment in which two triangles meet.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    /// A vertex that both have.
    Vertex { vertex: u32, point: Vec3 },
    /// An edge of one through the other.
    Crossing(Crossing),
}

/// The point of an edge that lies in a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) edge: [u32; 2],
    pub(super) triangle: [u32; 3],
    point: Vec3,
    /// Weights of the ends, and of the corners.
    along: [Real; 2],
    pub(super) weights: [Real; 3],
    /// E, from one end to the other (m), and N, a normal of the triangle (m²).
    displacement: Vec3,
    pub(super) normal: Vec3,
}

impl Crossing {
    /// If there is one. Whether is decided exactly, where is not. Nothing also for an edge in the plane of the
    /// triangle.
    pub(super) fn find(edge: [u32; 2], triangle: [u32; 3], positions: &[Vec3]) -> Option<Self> {
        let (ends, corners) = (gather(positions, edge), gather(positions, triangle));
        if !segment_meets_triangle(ends, corners) {
            return None;
        }
        let displacement = ends[1] - ends[0];
        let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        let t = normal.dot(&(corners[0] - ends[0])) / normal.dot(&displacement);
        if !t.is_finite() {
            return None;
        }
        let t = t.clamp(0.0, 1.0);
        let point = ends[0] + displacement * t;
        Some(Self {
            edge,
            triangle,
            point,
            along: [1.0 - t, t],
            weights: point_triangle(point, corners).weights,
            displacement,
            normal,
        })
    }

    /// The ends of the edge, the smaller number first.
    pub(super) fn sorted_edge(&self) -> [u32; 2] {
        let [a, b] = self.edge;
        [a.min(b), a.max(b)]
    }
}

impl End {
    pub(super) fn point(&self) -> Vec3 {
        match self {
            Self::Vertex { point, .. } => *point,
            Self::Crossing(crossing) => crossing.point,
        }
    }

    /// Adds to `gradient` what a gradient `f` by this point is by the vertices: with the displacements u of the edge
    /// and w of the triangle at the point, it moves by u + E (N·(w − u))/(N·E).
    pub(super) fn pull_back(&self, f: Vec3, gradient: &mut [Vec3]) {
        match self {
            Self::Vertex { vertex, .. } => gradient[*vertex as usize] += f,
            Self::Crossing(c) => {
                let by_triangle =
                    c.normal * (f.dot(&c.displacement) / c.normal.dot(&c.displacement));
                let by_edge = f - by_triangle;
                if !cloth_core::math::is_finite(&by_triangle) {
                    return;
                }
                for (vertex, weight) in c.edge.iter().zip(c.along) {
                    gradient[*vertex as usize] += by_edge * weight;
                }
                for (vertex, weight) in c.triangle.iter().zip(c.weights) {
                    gradient[*vertex as usize] += by_triangle * weight;
                }
            }
        }
    }
}
