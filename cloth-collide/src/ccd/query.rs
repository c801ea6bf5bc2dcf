//! What the continuous test is asked: two primitives whose vertices move linearly.

use super::advance::Walk;
use super::difference::Difference;
use super::{ContinuousTest, Impact};
use crate::error::CollideError;
use crate::pair::Gap;
use cloth_core::math::{Real, Vec3};

/// Which two primitives move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum QueryKind {
    /// A vertex and the three corners of a triangle.
    VertexTriangle,
    /// The two ends of an edge and the two of another.
    EdgeEdge,
}

impl QueryKind {
    /// How many of the four vertices belong to the first primitive.
    pub(crate) fn split(self) -> usize {
        match self {
            Self::VertexTriangle => 1,
            Self::EdgeEdge => 2,
        }
    }
}

/// Four vertices that move linearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    /// What they are, in this order.
    pub kind: QueryKind,
    /// Positions (m) at time 0.
    pub from: [Vec3; 4],
    /// Positions (m) at time 1.
    pub to: [Vec3; 4],
}

impl Query {
    /// Of a `vertex` and a `triangle`, positions (m) at both times.
    #[must_use]
    pub fn vertex_triangle(vertex: [Vec3; 2], triangle: [[Vec3; 3]; 2]) -> Self {
        let at = |k: usize| [vertex[k], triangle[k][0], triangle[k][1], triangle[k][2]];
        Self {
            kind: QueryKind::VertexTriangle,
            from: at(0),
            to: at(1),
        }
    }

    /// Of two edges, the two positions (m) of each at both times.
    #[must_use]
    pub fn edge_edge(first: [[Vec3; 2]; 2], second: [[Vec3; 2]; 2]) -> Self {
        let at = |k: usize| [first[k][0], first[k][1], second[k][0], second[k][1]];
        Self {
            kind: QueryKind::EdgeEdge,
            from: at(0),
            to: at(1),
        }
    }

    /// The first contact, as the conservative `test` has it.
    ///
    /// ```
    /// use cloth_collide::{ContinuousTest, Query};
    /// use cloth_core::math::Vec3;
    ///
    /// let floor = [Vec3::zeros(), Vec3::x(), Vec3::y()];
    /// let falling = [Vec3::new(0.25, 0.25, 0.5), Vec3::new(0.25, 0.25, -1.5)];
    /// let query = Query::vertex_triangle(falling, [floor; 2]);
    /// let impact = query.first_contact(&ContinuousTest::default())?.unwrap();
    /// assert!(impact.time <= 0.25 && impact.time > 0.25 - 1e-14);
    ///
    /// let beside = Query::vertex_triangle(falling.map(|x| x + Vec3::x()), [floor; 2]);
    /// assert_eq!(beside.first_contact(&ContinuousTest::default())?, None);
    /// # Ok::<(), cloth_collide::CollideError>(())
    /// ```
    ///
    /// # Errors
    /// [`CollideError::NonFinitePosition`] with the number of the vertex, 0 to 3, and [`CollideError::TooFarApart`].
    pub fn first_contact(&self, test: &ContinuousTest) -> Result<Option<Impact>, CollideError> {
        let (separation, slack) = (test.separation, test.slack);
        Ok(match self.kind {
            QueryKind::VertexTriangle => {
                let polygon = Difference::new(self, [[0, 1], [0, 2], [0, 3]])?;
                Walk::end(polygon, separation, slack)
            }
            QueryKind::EdgeEdge => {
                let polygon = Difference::new(self, [[0, 2], [1, 2], [0, 3], [1, 3]])?;
                Walk::end(polygon, separation, slack)
            }
        })
    }

    /// Distance (m) of the two primitives at `time` (dimensionless, 0..=1), in `f64`.
    #[must_use]
    pub fn distance(&self, time: Real) -> Real {
        let x = std::array::from_fn(|k| self.from[k] * (1.0 - time) + self.to[k] * time);
        Gap::new(self.kind, &x).distance
    }
}
