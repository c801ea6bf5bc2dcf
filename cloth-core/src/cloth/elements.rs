//! Families of the energies of this crate, to be kept in one list whatever their kind.

use crate::energy::{
    ArapTriangle, CubicShell, CurvatureHinge, CurvedHinge, DihedralHinge, MidpointHinge, Spring,
    Stitch, StrainLimitSpring, StvkTriangle,
};
use crate::method::family::Energies;
use crate::step::BuildError;

/// All elements of one kind, with the kind as a case: what a description of a cloth hands to the builder of a solver.
///
/// A builder takes the cases that have the view its method asks for, and the compiler sees to it that it takes no
/// other.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Elements {
    /// Springs: structural, shear or bending.
    Springs(Vec<Spring>),
    /// Springs that are slack in a range.
    Limited(Vec<StrainLimitSpring>),
    /// Triangles of a linear-elastic sheet.
    Stvk(Vec<StvkTriangle>),
    /// As-rigid-as-possible triangles.
    Arap(Vec<ArapTriangle>),
    /// Quadratic hinges, flat at rest.
    Quadratic(Vec<CurvatureHinge>),
    /// Hinges in the cotangent form, curved at rest.
    Curved(Vec<CurvedHinge>),
    /// Hinges by angle.
    Dihedral(Vec<DihedralHinge>),
    /// Hinges of the cubic shell.
    Cubic(Vec<CubicShell>),
    /// Quadratic hinges between triangles that share the middle of an edge.
    Midpoint(Vec<MidpointHinge>),
    /// Stitches of seams.
    Stitches(Vec<Stitch>),
}

impl Elements {
    /// What the elements are, as a word in a sentence.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Springs(_) => "springs",
            Self::Limited(_) => "springs with slack",
            Self::Stvk(_) => "StVK triangles",
            Self::Arap(_) => "ARAP triangles",
            Self::Quadratic(_) => "quadratic hinges",
            Self::Curved(_) => "curved cotangent hinges",
            Self::Dihedral(_) => "dihedral hinges",
            Self::Cubic(_) => "cubic-shell hinges",
            Self::Midpoint(_) => "hinges of edge midpoints",
            Self::Stitches(_) => "stitches",
        }
    }

    /// Number of elements.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Springs(elements) => elements.len(),
            Self::Limited(elements) => elements.len(),
            Self::Stvk(elements) => elements.len(),
            Self::Arap(elements) => elements.len(),
            Self::Quadratic(elements) => elements.len(),
            Self::Curved(elements) => elements.len(),
            Self::Dihedral(elements) => elements.len(),
            Self::Cubic(elements) => elements.len(),
            Self::Midpoint(elements) => elements.len(),
            Self::Stitches(elements) => elements.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds a family to a list, to the one of its kind if there is one.
    pub(super) fn merge(families: &mut Vec<Self>, mut family: Self) {
        for own in families.iter_mut() {
            match (own, &mut family) {
                (Self::Springs(own), Self::Springs(more)) => return own.append(more),
                (Self::Limited(own), Self::Limited(more)) => return own.append(more),
                (Self::Stvk(own), Self::Stvk(more)) => return own.append(more),
                (Self::Arap(own), Self::Arap(more)) => return own.append(more),
                (Self::Quadratic(own), Self::Quadratic(more)) => return own.append(more),
                (Self::Curved(own), Self::Curved(more)) => return own.append(more),
                (Self::Dihedral(own), Self::Dihedral(more)) => return own.append(more),
                (Self::Cubic(own), Self::Cubic(more)) => return own.append(more),
                (Self::Midpoint(own), Self::Midpoint(more)) => return own.append(more),
                (Self::Stitches(own), Self::Stitches(more)) => return own.append(more),
                _ => {}
            }
        }
        families.push(family);
    }

    /// Adds them to a sum of energies: every kind has that view.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`].
    pub fn add_to(self, energies: Energies) -> Result<Energies, BuildError> {
        match self {
            Self::Springs(elements) => energies.with(elements),
            Self::Limited(elements) => energies.with(elements),
            Self::Stvk(elements) => energies.with(elements),
            Self::Arap(elements) => energies.with(elements),
            Self::Quadratic(elements) => energies.with(elements),
            Self::Curved(elements) => energies.with(elements),
            Self::Dihedral(elements) => energies.with(elements),
            Self::Cubic(elements) => energies.with(elements),
            Self::Midpoint(elements) => energies.with(elements),
            Self::Stitches(elements) => energies.with(elements),
        }
    }
}
