//! A vertex tied to a point in space.

use crate::element::{Constraint, Element, Projective, Row, RowForm, VectorRow};
use crate::error::{OutOfRange, finite, number};
use crate::math::{Real, Vec3};

/// A spring of rest length zero between a vertex and a fixed point p: `E = ½ k ‖x − p‖²` (J).
///
/// It is the soft pin. A hard one is a prescribed vertex, see [`crate::particles::Particles`].
/// Its three rows are the coordinates of `x − p`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attachment {
    /// The vertex.
    pub vertex: u32,
    /// The point p (m).
    pub target: Vec3,
    /// Stiffness k (N/m).
    pub stiffness: Real,
}

impl Element<1> for Attachment {
    #[inline]
    fn vertices(&self) -> [u32; 1] {
        [self.vertex]
    }

    fn check(&self) -> Result<(), OutOfRange> {
        number("stiffness", self.stiffness)?;
        for &coordinate in &self.target {
            finite("coordinate of a target (m)", coordinate)?;
        }
        Ok(())
    }
}

impl Constraint<1> for Attachment {
    type Rows = [Row<1>; 3];

    const ROWS_ARE_LINEAR: bool = true;

    #[inline]
    fn rows(&self, x: &[Vec3; 1]) -> [Row<1>; 3] {
        self.as_vector_row().rows(x)
    }

    #[inline(always)]
    fn row_form(&self, _: &[Vec3; 1]) -> RowForm<1> {
        RowForm::Vector(self.as_vector_row())
    }
}

impl Attachment {
    #[inline(always)]
    fn as_vector_row(&self) -> VectorRow<1> {
        VectorRow {
            coefficients: [1.0],
            target: self.target,
            stiffness: self.stiffness,
        }
    }
}

impl Projective<1, 1> for Attachment {
    const PROJECTION_IS_CONSTANT: bool = true;

    #[inline]
    fn operator(&self) -> [[Real; 1]; 1] {
        [[1.0]]
    }

    #[inline]
    fn weight(&self) -> Real {
        self.stiffness
    }

    #[inline]
    fn project(&self, _: [Vec3; 1]) -> [Vec3; 1] {
        [self.target]
    }
}
