//! Does the cloth touch itself?
mod bounds;
mod broad_phase;
mod closest;
mod convert;
mod error;
mod intersect;
mod separation;
pub use broad_phase::TrianglePairs;
pub use closest::{EdgeEdge, PointTriangle, edge_edge, point_triangle};
pub use error::CollideError;
pub use intersect::{segment_meets_triangle, triangles_meet};
pub use separation::{Separation, SeparationProbe};
