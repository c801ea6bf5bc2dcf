//! Why there is no solver.

use crate::error::OutOfRange;
use std::fmt;

/// Why a solver could not be built.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BuildError {
    /// An element names a vertex that the particles do not have.
    NoSuchVertex {
        /// What it is: the name of its type.
        kind: &'static str,
        /// Its family, counted from 0 in the order given, if that is known.
        family: Option<usize>,
        /// The element, counted from 0 in its family.
        element: usize,
        /// The vertex.
        vertex: u32,
        /// How many vertices there are.
        vertex_count: usize,
    },
    /// An element names a vertex twice.
    RepeatedVertex {
        /// What it is: the name of its type.
        kind: &'static str,
        /// Its family, counted from 0 in the order given, if that is known.
        family: Option<usize>,
        /// The element, counted from 0 in its family.
        element: usize,
        /// The vertex.
        vertex: u32,
    },
    /// A number of an element lies outside its range.
    InvalidElement {
        /// What it is: the name of its type.
        kind: &'static str,
        /// Its family, counted from 0 in the order given, if that is known.
        family: Option<usize>,
        /// The element, counted from 0 in its family.
        element: usize,
        /// Which number.
        reason: OutOfRange,
    },
    /// The energy of the elements does not have the form that the method needs.
    UnsupportedElements {
        /// What the elements are.
        elements: &'static str,
        /// What their energy would have to be.
        needs: &'static str,
    },
    /// A setting lies outside its range.
    OutOfRange(OutOfRange),
    /// Two settings exclude each other.
    SettingsConflict {
        /// The one, with its value.
        one: &'static str,
        /// What it asks of the others.
        needs: &'static str,
    },
    /// The factor of the matrix has more entries than can be counted or kept in memory.
    MatrixTooLarge,
}

impl BuildError {
    /// For builders: the same, where it is about an element, of the family of this number.
    #[must_use]
    pub fn in_family(mut self, number: usize) -> Self {
        if let Self::NoSuchVertex { family, .. }
        | Self::RepeatedVertex { family, .. }
        | Self::InvalidElement { family, .. } = &mut self
        {
            *family = Some(number);
        }
        self
    }
}

/// An element, as a message names it.
struct Named(&'static str, Option<usize>, usize);

impl fmt::Display for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(kind, family, element) = self;
        match family {
            Some(family) => write!(f, "element {element} of family {family} ({kind})"),
            None => write!(f, "element {element} ({kind})"),
        }
    }
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSuchVertex {
                kind,
                family,
                element,
                vertex,
                vertex_count,
            } => write!(
                f,
                "{} names vertex {vertex}, but there are only {vertex_count} vertices",
                Named(kind, *family, *element)
            ),
            Self::RepeatedVertex {
                kind,
                family,
                element,
                vertex,
            } => write!(
                f,
                "{} names vertex {vertex} twice",
                Named(kind, *family, *element)
            ),
            Self::InvalidElement {
                kind,
                family,
                element,
                reason,
            } => write!(f, "{}: the {reason}", Named(kind, *family, *element)),
            Self::UnsupportedElements { elements, needs } => {
                write!(f, "cannot take {elements}: it needs an energy that {needs}")
            }
            Self::OutOfRange(error) => error.fmt(f),
            Self::SettingsConflict { one, needs } => write!(f, "{one} needs {needs}"),
            Self::MatrixTooLarge => {
                write!(f, "the factor of the matrix is too large for the memory")
            }
        }
    }
}

impl std::error::Error for BuildError {}

impl From<OutOfRange> for BuildError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}
