//! A vertex tied to a point in space (CORE-9, CORE-10).

use crate::element::{Constraint, Convexity, Element, Projective, Row};
use crate::math::{Blocks, Mat3, Real, Vec3};

/// A spring of rest length zero between a vertex and a fixed point p, S1 (29): `E = ½ k ‖x − p‖²` (J).
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
}

impl Constraint<1> for Attachment {
    type Rows = [Row<1>; 3];

    const ROWS_ARE_INDEPENDENT: bool = true;

    #[inline]
    fn rows(&self, x: &[Vec3; 1]) -> [Row<1>; 3] {
        let d = x[0] - self.target;
        std::array::from_fn(|axis| Row {
            value: d[axis],
            gradient: [Vec3::ith(axis, 1.0)],
            stiffness: self.stiffness,
        })
    }

    /// Zero: the rows are linear.
    #[inline]
    fn geometric_stiffness(&self, _: &[Vec3; 1], _: &[Real], _: Convexity) -> Blocks<1> {
        [[Mat3::zeros(); 1]; 1]
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
