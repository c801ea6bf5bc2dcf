//! Why an obstacle, or a law of contact, was refused.

use cloth_core::error::OutOfRange;
use cloth_core::math::Real;
use cloth_core::mesh::MeshError;
use std::fmt;

/// Why an obstacle, its motion or its law of contact was refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ObstacleError {
    /// A number is out of its range.
    OutOfRange(OutOfRange),
    /// A coordinate is NaN or infinite.
    NonFinite {
        /// Of what.
        name: &'static str,
    },
    /// The mesh has an edge with three or more triangles, or too many triangles.
    NotASurface(MeshError),
    /// The mesh has a boundary, so there is no inside.
    NotClosed {
        /// How many edges have one triangle only.
        boundary_edge_count: usize,
        /// The two vertices of the first of them.
        first: [u32; 2],
    },
    /// Two neighbouring triangles have opposite windings, so inside and outside change places between them.
    MixedWinding {
        /// The two vertices of the first such edge.
        edge: [u32; 2],
    },
    /// Two pieces of the surface touch in one vertex, where the outward direction is not defined.
    PinchedVertex {
        /// The first such vertex.
        vertex: u32,
    },
    /// The surface goes through itself, so inside and outside are not defined.
    SelfIntersecting {
        /// How many pairs of triangles meet.
        pair_count: usize,
    },
    /// The triangles are clockwise seen from outside: the enclosed volume is not positive.
    InsideOut {
        /// The signed volume (m³).
        volume: Real,
    },
    /// The shapes of an animated surface have different numbers of vertices.
    ShapeSize {
        /// The first that has another number than shape 0, counted from 0.
        shape: usize,
        /// How many it has.
        found: usize,
        /// How many shape 0 has.
        expected: usize,
    },
    /// A shape without end cannot be sampled on a grid.
    Unbounded,
}

impl fmt::Display for ObstacleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange(error) => write!(f, "the {error}"),
            Self::NonFinite { name } => {
                write!(f, "the {name} has a coordinate that is not a finite number")
            }
            Self::NotASurface(error) => write!(f, "the mesh cannot bound an obstacle: {error}"),
            Self::NotClosed {
                boundary_edge_count,
                first: [a, b],
            } => write!(
                f,
                "the mesh is not closed: {boundary_edge_count} edges have one triangle only, the first from vertex {a} \
                 to vertex {b}"
            ),
            Self::MixedWinding { edge: [a, b] } => write!(
                f,
                "the triangles beside the edge from vertex {a} to vertex {b} have opposite windings"
            ),
            Self::PinchedVertex { vertex } => {
                write!(f, "two pieces of the surface touch in vertex {vertex} only")
            }
            Self::SelfIntersecting { pair_count } => write!(
                f,
                "the surface goes through itself: {pair_count} pairs of triangles meet"
            ),
            Self::InsideOut { volume } => write!(
                f,
                "the enclosed volume is {volume} m³: the triangles have to be counter-clockwise seen from outside"
            ),
            Self::ShapeSize {
                shape,
                found,
                expected,
            } => write!(
                f,
                "shape {shape} of an animated surface has {found} vertices, but the first has {expected}"
            ),
            Self::Unbounded => write!(f, "a shape without end cannot be sampled on a grid"),
        }
    }
}

impl std::error::Error for ObstacleError {}

impl From<OutOfRange> for ObstacleError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}
