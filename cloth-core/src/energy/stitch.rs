//! The stitch: two vertices that are drawn together, and then held together.

use super::Spring;
use crate::cloth::Elements;
use crate::element::{Constraint, Convexity, Element, Projective, Row, RowForm, VectorRow};
use crate::math::{Blocks, Mat3, Real, Vec3};

/// A spring between two vertices whose rest length L falls to zero: `E = ½ k (‖x₀ − x₁‖ − L(t))²` (J).
///
/// ```text
/// L(t) = L₀                                   until `from`
/// L(t) = L₀ (until − t)/(until − from)        between
/// L(t) = 0                                    after it: E = ½ k ‖x₀ − x₁‖²
/// ```
///
/// The force acts along the line between the two vertices and is opposite at its ends, at every L: a stitch changes
/// neither momentum nor angular momentum. Once it is closed the energy is quadratic, with a gradient and a Hessian
/// (`± k I`) where the vertices coincide too, and its rows are the three coordinates of `x₀ − x₁`. While it closes it
/// has one row, that of a [`Spring`] of length L, and two that are zero everywhere.
///
/// The matrix of projective dynamics has k in it and not L, so it stays as it is while the stitch closes. Methods tell
/// the time by [`Element::set_time`].
///
/// Limits: the stiffness is finite, so that a force F leaves the vertices F/k apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stitch {
    vertices: [u32; 2],
    stiffness: Real,
    start_length: Real,
    from: Real,
    until: Real,
    /// L (m) at the time that was set last.
    rest_length: Real,
}

impl Stitch {
    /// A stitch of `stiffness` k (N/m) that is closed from the start on.
    #[must_use]
    pub fn closed(vertices: [u32; 2], stiffness: Real) -> Self {
        Self::closing(vertices, stiffness, 0.0, [0.0; 2])
    }

    /// A stitch of `stiffness` k (N/m) whose rest length falls from `start_length` L₀ (m) to zero between two times
    /// (s); at once if they are the same. It begins with L₀.
    #[must_use]
    pub fn closing(
        vertices: [u32; 2],
        stiffness: Real,
        start_length: Real,
        [from, until]: [Real; 2],
    ) -> Self {
        Self {
            vertices,
            stiffness,
            start_length,
            from,
            until,
            rest_length: start_length,
        }
    }

    /// Rest length L (m) at a time (s).
    #[must_use]
    pub fn rest_length_at(&self, time: Real) -> Real {
        if time >= self.until {
            0.0
        } else if time <= self.from {
            self.start_length
        } else {
            self.start_length * ((self.until - time) / (self.until - self.from))
        }
    }

    /// When it is closed (s).
    #[must_use]
    pub fn until(&self) -> Real {
        self.until
    }

    /// Stiffness k (N/m).
    #[must_use]
    pub fn stiffness(&self) -> Real {
        self.stiffness
    }

    /// What it is while it closes.
    #[inline(always)]
    fn spring(&self) -> Spring {
        Spring {
            vertices: self.vertices,
            rest_length: self.rest_length,
            stiffness: self.stiffness,
        }
    }

    #[inline(always)]
    fn is_closed(&self) -> bool {
        self.rest_length == 0.0
    }

    #[inline(always)]
    fn as_vector_row(&self) -> VectorRow<2> {
        VectorRow {
            coefficients: [1.0, -1.0],
            target: Vec3::zeros(),
            stiffness: self.stiffness,
        }
    }
}

impl Element<2> for Stitch {
    const IS_IN_ELEMENTS: bool = true;

    const CHANGES_WITH_TIME: bool = true;

    #[inline(always)]
    fn vertices(&self) -> [u32; 2] {
        self.vertices
    }

    fn set_time(&mut self, time: Real) {
        self.rest_length = self.rest_length_at(time);
    }

    fn into_elements(all: Vec<Self>) -> Elements {
        Elements::Stitches(all)
    }
}

impl Constraint<2> for Stitch {
    type Rows = [Row<2>; 3];

    #[inline]
    fn rows(&self, x: &[Vec3; 2]) -> [Row<2>; 3] {
        if self.is_closed() {
            return self.as_vector_row().rows(x);
        }
        let [row] = self.spring().rows(x);
        let none = Row {
            value: 0.0,
            gradient: [Vec3::zeros(); 2],
            stiffness: self.stiffness,
        };
        [row, none, none]
    }

    #[inline]
    fn geometric_stiffness(
        &self,
        x: &[Vec3; 2],
        multipliers: &[Real],
        convexity: Convexity,
    ) -> Blocks<2> {
        if self.is_closed() {
            return [[Mat3::zeros(); 2]; 2];
        }
        self.spring().geometric_stiffness(x, multipliers, convexity)
    }

    #[inline(always)]
    fn row_form(&self, x: &[Vec3; 2]) -> RowForm<2> {
        if self.is_closed() {
            return RowForm::Vector(self.as_vector_row());
        }
        self.spring().row_form(x)
    }

    #[inline]
    fn curvature(&self, x: &[Vec3; 2], convexity: Convexity) -> Blocks<2> {
        if self.is_closed() {
            return [[Mat3::zeros(); 2]; 2];
        }
        self.spring().curvature(x, convexity)
    }

    #[inline]
    fn mixed_curvature(&self, x: &[Vec3; 2], from: &[Vec3; 2], to: &[Vec3; 2]) -> Blocks<2> {
        if self.is_closed() {
            return [[Mat3::zeros(); 2]; 2];
        }
        self.spring().mixed_curvature(x, from, to)
    }
}

/// The set is the sphere of radius L, in the end its centre. It is not announced as a sphere: a solver may keep the
/// radius of one for good.
impl Projective<2, 1> for Stitch {
    #[inline]
    fn operator(&self) -> [[Real; 2]; 1] {
        [[1.0, -1.0]]
    }

    #[inline]
    fn weight(&self) -> Real {
        self.stiffness
    }

    #[inline]
    fn project(&self, z: [Vec3; 1]) -> [Vec3; 1] {
        self.spring().project(z)
    }

    #[inline]
    fn projected_hessian(&self, z: [Vec3; 1]) -> [[Mat3; 1]; 1] {
        self.spring().projected_hessian(z)
    }
}
