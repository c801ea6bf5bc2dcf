//! Families of the energies that a cloth is made of, to be kept in one list whatever their kind.
//!
//! [`AreaTriangle`](crate::energy::AreaTriangle) and [`Attachment`](crate::energy::Attachment) are not among them. They
//! go to a builder by its `energy`, as elements of your own do.

use crate::element::{Constraint, Energy, Projective};
use crate::energy::{
    ArapTetrahedron, ArapTriangle, CubicShell, CurvatureHinge, CurvedHinge, DihedralHinge,
    MidpointHinge, SoftPin, Spring, Stitch, StrainLimitSpring, StrainLimitTriangle, StvkTriangle,
    VolumeTetrahedron,
};
use crate::method::family::Energies;
use crate::step::BuildError;

/// All elements of one kind, with the kind as a case: what a description of a cloth hands to the builder of a solver.
///
/// A builder takes the kinds that have the view its method asks for, and refuses the others by name. Methods of your
/// own do so with a visitor: [`Elements::as_energies`], [`Elements::as_constraints`], [`Elements::as_projections`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Elements {
    /// Springs: structural, shear or bending.
    Springs(Vec<Spring>),
    /// Springs that are slack in a range.
    Limited(Vec<StrainLimitSpring>),
    /// Triangles that are slack while their principal stretches are in a range.
    LimitedTriangles(Vec<StrainLimitTriangle>),
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
    /// As-rigid-as-possible tetrahedra.
    ArapTetrahedra(Vec<ArapTetrahedron>),
    /// Tetrahedra that keep their volume.
    Volumes(Vec<VolumeTetrahedron>),
    /// Ties to points that move.
    SoftPins(Vec<SoftPin>),
    /// Links: springs that are no part of the cloth, rigid ones with an infinite stiffness.
    Links(Vec<Spring>),
    /// Links that pull and do not push: ropes.
    SlackLinks(Vec<StrainLimitSpring>),
    /// Stitches of seams from vertex to vertex.
    Stitches(Vec<Stitch>),
    /// Stitches of seams from a vertex to a point of an edge.
    EdgeStitches(Vec<Stitch<3>>),
}

/// Does the same with the elements of every kind.
macro_rules! each {
    ($of:expr, $elements:ident => $what:expr) => {
        match $of {
            Elements::Springs($elements) => $what,
            Elements::Limited($elements) => $what,
            Elements::LimitedTriangles($elements) => $what,
            Elements::Stvk($elements) => $what,
            Elements::Arap($elements) => $what,
            Elements::Quadratic($elements) => $what,
            Elements::Curved($elements) => $what,
            Elements::Dihedral($elements) => $what,
            Elements::Cubic($elements) => $what,
            Elements::Midpoint($elements) => $what,
            Elements::ArapTetrahedra($elements) => $what,
            Elements::Volumes($elements) => $what,
            Elements::SoftPins($elements) => $what,
            Elements::Links($elements) => $what,
            Elements::SlackLinks($elements) => $what,
            Elements::Stitches($elements) => $what,
            Elements::EdgeStitches($elements) => $what,
        }
    };
}

/// Does the same with two lists of the same kind, if they are.
macro_rules! both {
    ($of:expr, $own:ident, $other:ident => $what:expr) => {
        match $of {
            (Elements::Springs($own), Elements::Springs($other)) => Some($what),
            (Elements::Limited($own), Elements::Limited($other)) => Some($what),
            (Elements::LimitedTriangles($own), Elements::LimitedTriangles($other)) => Some($what),
            (Elements::Stvk($own), Elements::Stvk($other)) => Some($what),
            (Elements::Arap($own), Elements::Arap($other)) => Some($what),
            (Elements::Quadratic($own), Elements::Quadratic($other)) => Some($what),
            (Elements::Curved($own), Elements::Curved($other)) => Some($what),
            (Elements::Dihedral($own), Elements::Dihedral($other)) => Some($what),
            (Elements::Cubic($own), Elements::Cubic($other)) => Some($what),
            (Elements::Midpoint($own), Elements::Midpoint($other)) => Some($what),
            (Elements::ArapTetrahedra($own), Elements::ArapTetrahedra($other)) => Some($what),
            (Elements::Volumes($own), Elements::Volumes($other)) => Some($what),
            (Elements::SoftPins($own), Elements::SoftPins($other)) => Some($what),
            (Elements::Links($own), Elements::Links($other)) => Some($what),
            (Elements::SlackLinks($own), Elements::SlackLinks($other)) => Some($what),
            (Elements::Stitches($own), Elements::Stitches($other)) => Some($what),
            (Elements::EdgeStitches($own), Elements::EdgeStitches($other)) => Some($what),
            _ => None,
        }
    };
}

impl Elements {
    /// What the elements are, as a word in a sentence.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Springs(_) => "springs",
            Self::Limited(_) => "springs with slack",
            Self::LimitedTriangles(_) => "triangles with slack",
            Self::Stvk(_) => "StVK triangles",
            Self::Arap(_) => "ARAP triangles",
            Self::Quadratic(_) => "quadratic hinges",
            Self::Curved(_) => "curved cotangent hinges",
            Self::Dihedral(_) => "dihedral hinges",
            Self::Cubic(_) => "cubic-shell hinges",
            Self::Midpoint(_) => "hinges of edge midpoints",
            Self::ArapTetrahedra(_) => "ARAP tetrahedra",
            Self::Volumes(_) => "tetrahedra with a volume",
            Self::SoftPins(_) => "soft pins",
            Self::Links(_) => "links",
            Self::SlackLinks(_) => "links with slack",
            Self::Stitches(_) => "stitches",
            Self::EdgeStitches(_) => "stitches onto edges",
        }
    }

    /// Number of elements.
    #[must_use]
    pub fn len(&self) -> usize {
        each!(self, elements => elements.len())
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds a family to a list, to the one of its kind if there is one.
    pub(super) fn merge(families: &mut Vec<Self>, mut family: Self) {
        for own in families.iter_mut() {
            if both!((own, &mut family), own, more => own.append(more)).is_some() {
                return;
            }
        }
        families.push(family);
    }

    /// Places of the elements that `left` does not have, if that is these without them, in the same order.
    fn without(&self, left: &Self) -> Option<Vec<usize>> {
        both!((self, left), all, left => {
            let mut left = left.iter().peekable();
            let numbered = all.iter().enumerate();
            let gone = numbered.filter(|(_, one)| left.next_if(|next| next == one).is_none());
            let gone = gone.map(|(place, _)| place).collect();
            left.next().is_none().then_some(gone)
        })?
    }

    /// What `left` lacks of `families`, a family and a place in it each, if it has nothing else, and all in the same
    /// order: what a [`Stepper`](crate::step::Stepper) with these families has to
    /// [lose](crate::step::Stepper::remove_elements) to have the others.
    #[must_use]
    pub fn lost(families: &[Self], left: &[Self]) -> Option<Vec<[usize; 2]>> {
        let mut left = left.iter().peekable();
        let mut lost = Vec::new();
        for (number, family) in families.iter().enumerate() {
            let part = left.peek().and_then(|left| family.without(left));
            let gone = match part {
                Some(gone) => {
                    left.next();
                    gone
                }
                None => (0..family.len()).collect(),
            };
            lost.extend(gone.into_iter().map(|place| [number, place]));
        }
        left.next().is_none().then_some(lost)
    }

    /// Shows the elements as energies: every kind has that view.
    pub fn as_energies<V: EnergyVisitor>(self, visitor: V) -> V::Output {
        each!(self, elements => visitor.visit(elements))
    }

    /// Shows the elements as constraints.
    ///
    /// # Errors
    /// [`BuildError::UnsupportedElements`] for a kind that is no sum of squares `½ k C²`: the cubic shell.
    pub fn as_constraints<V: ConstraintVisitor>(self, visitor: V) -> Result<V::Output, BuildError> {
        Ok(match self {
            Self::Springs(elements) => visitor.visit(elements),
            Self::Limited(elements) => visitor.visit(elements),
            Self::LimitedTriangles(elements) => visitor.visit(elements),
            Self::Stvk(elements) => visitor.visit(elements),
            Self::Arap(elements) => visitor.visit(elements),
            Self::Quadratic(elements) => visitor.visit(elements),
            Self::Curved(elements) => visitor.visit(elements),
            Self::Dihedral(elements) => visitor.visit(elements),
            Self::Midpoint(elements) => visitor.visit(elements),
            Self::ArapTetrahedra(elements) => visitor.visit(elements),
            Self::Volumes(elements) => visitor.visit(elements),
            Self::SoftPins(elements) => visitor.visit(elements),
            Self::Links(elements) => visitor.visit(elements),
            Self::SlackLinks(elements) => visitor.visit(elements),
            Self::Stitches(elements) => visitor.visit(elements),
            Self::EdgeStitches(elements) => visitor.visit(elements),
            Self::Cubic(_) => return Err(self.unsupported("is a sum of squares ½ k C²")),
        })
    }

    /// Shows the elements as squared distances to sets.
    ///
    /// # Errors
    /// [`BuildError::UnsupportedElements`] for a kind that is none: StVK triangles, dihedral hinges, the cubic shell,
    /// tetrahedra with a volume.
    pub fn as_projections<V: ProjectiveVisitor>(self, visitor: V) -> Result<V::Output, BuildError> {
        Ok(match self {
            Self::Springs(elements) => visitor.visit(elements),
            Self::Limited(elements) => visitor.visit(elements),
            Self::LimitedTriangles(elements) => visitor.visit(elements),
            Self::Arap(elements) => visitor.visit(elements),
            Self::Quadratic(elements) => visitor.visit(elements),
            Self::Curved(elements) => visitor.visit(elements),
            Self::Midpoint(elements) => visitor.visit(elements),
            Self::ArapTetrahedra(elements) => visitor.visit(elements),
            Self::SoftPins(elements) => visitor.visit(elements),
            Self::Links(elements) => visitor.visit(elements),
            Self::SlackLinks(elements) => visitor.visit(elements),
            Self::Stitches(elements) => visitor.visit(elements),
            Self::EdgeStitches(elements) => visitor.visit(elements),
            Self::Stvk(_) | Self::Dihedral(_) | Self::Cubic(_) | Self::Volumes(_) => {
                return Err(self.unsupported("is a squared distance ½ w ‖Sx − p‖² to a set"));
            }
        })
    }

    /// The error of a method that cannot take these elements; `needs` says what their energy would have to be.
    #[must_use]
    pub fn unsupported(&self, needs: &'static str) -> BuildError {
        BuildError::UnsupportedElements {
            elements: self.name(),
            needs,
        }
    }
}

impl Energies {
    /// Adds all elements of a cloth, as [`ClothModel::families`](super::ClothModel::families) has them.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`] or [`BuildError::RepeatedVertex`] if an element names a vertex that does not exist,
    /// or one twice; [`BuildError::InvalidElement`] for a number of one.
    pub fn with_elements(self, families: Vec<Elements>) -> Result<Self, BuildError> {
        let mut families = families.into_iter();
        families.try_fold(self, |sum, family| family.as_energies(Summand(sum)))
    }
}

/// Receives one family of elements, whichever its kind is, for a method that asks for energies.
pub trait EnergyVisitor {
    /// Result type.
    type Output;

    /// Receives one family.
    fn visit<const N: usize, E: Energy<N>>(self, elements: Vec<E>) -> Self::Output;
}

/// The same for a method that asks for constraints.
pub trait ConstraintVisitor {
    /// Result type.
    type Output;

    /// Receives one family.
    fn visit<const N: usize, E: Constraint<N>>(self, elements: Vec<E>) -> Self::Output;
}

/// The same for a method that asks for squared distances to sets.
pub trait ProjectiveVisitor {
    /// Result type.
    type Output;

    /// Receives one family.
    fn visit<const N: usize, const K: usize, E: Projective<N, K>>(
        self,
        elements: Vec<E>,
    ) -> Self::Output;
}

/// A sum of energies that elements are to be added to.
struct Summand(Energies);

impl EnergyVisitor for Summand {
    type Output = Result<Energies, BuildError>;

    fn visit<const N: usize, E: Energy<N>>(self, elements: Vec<E>) -> Self::Output {
        self.0.with_family(elements)
    }
}
