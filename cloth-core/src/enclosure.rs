//! Gas and other fillings inside a closed surface of cloth, with its volume V.
//!
//! - [`Pressure`]: a gas that a pump keeps at one pressure. It is a load from outside.
//! - [`ClosedVolume`]: a filling that resists a change of V, an energy ½ k (V − V*)². It couples all vertices of the
//!   piece, so it is no element, and a load would be unstable. [`Enclosed`] brings it into the solve of every method,
//!   by the hook that contact has ([`contact`](crate::contact)).
//!
//! M. Müller, B. Heidelberger, M. Hennix, J. Ratcliff, "Position based dynamics", 2007,
//! <https://doi.org/10.1016/j.jvcir.2007.01.005>, section 4.4: cloth balloons, the volume as one constraint.

mod pressure;
mod source;
mod surface;
mod volume;

pub use pressure::Pressure;
pub use source::{Enclosed, NoContact};
pub use volume::ClosedVolume;

use crate::error::OutOfRange;
use crate::mesh::MeshError;
use std::fmt;

/// Why nothing can be inside.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EnclosureError {
    /// A number is out of its range.
    OutOfRange(OutOfRange),
    /// The surface has a boundary, along this edge.
    Open([u32; 2]),
    /// The triangles at this edge face different ways.
    InconsistentlyOriented([u32; 2]),
    /// The surface encloses nothing.
    Empty,
    /// The mesh does not serve.
    Mesh(MeshError),
}

impl fmt::Display for EnclosureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange(error) => write!(f, "the {error}"),
            Self::Open([a, b]) => write!(
                f,
                "what is inside would escape: the surface has a boundary between vertices {a} and {b} (sewing does not \
                 close it, one mesh without a border does)"
            ),
            Self::InconsistentlyOriented([a, b]) => write!(
                f,
                "there is no inside: the triangles between vertices {a} and {b} face different ways"
            ),
            Self::Empty => f.write_str("the surface encloses no volume"),
            Self::Mesh(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for EnclosureError {}

impl From<OutOfRange> for EnclosureError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl From<MeshError> for EnclosureError {
    fn from(error: MeshError) -> Self {
        Self::Mesh(error)
    }
}
