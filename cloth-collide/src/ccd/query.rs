//! A query as a value: for files of queries, for generated ones, and for methods to be compared.

use super::{ContinuousTest, CoplanarityTest, Impact};
use crate::closest::{edge_edge, point_triangle};
use crate::error::CollideError;
use cloth_core::math::{Real, Vec3};

/// Which two primitives move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QueryKind {
    /// A vertex and the three corners of a triangle.
    VertexTriangle,
    /// The two ends of an edge and the two of another.
    EdgeEdge,
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
    /// The vertex and the triangle (m), each at both times, if that is what it is about; otherwise the result has no
    /// meaning.
    #[must_use]
    pub fn vertex_and_triangle(&self) -> ([Vec3; 2], [[Vec3; 3]; 2]) {
        let ([p, a, b, c], [p1, a1, b1, c1]) = (self.from, self.to);
        ([p, p1], [[a, b, c], [a1, b1, c1]])
    }

    /// The two edges (m), each at both times, if that is what it is about; otherwise the result has no meaning.
    #[must_use]
    pub fn edges(&self) -> ([[Vec3; 2]; 2], [[Vec3; 2]; 2]) {
        let ([a, b, c, d], [a1, b1, c1, d1]) = (self.from, self.to);
        ([[a, b], [a1, b1]], [[c, d], [c1, d1]])
    }

    /// What the conservative `test` says.
    ///
    /// # Errors
    /// Those of [`ContinuousTest::vertex_triangle`].
    pub fn first_contact(&self, test: &ContinuousTest) -> Result<Option<Impact>, CollideError> {
        match self.kind {
            QueryKind::VertexTriangle => {
                let (vertex, triangle) = self.vertex_and_triangle();
                test.vertex_triangle(vertex, triangle)
            }
            QueryKind::EdgeEdge => {
                let (first, second) = self.edges();
                test.edge_edge(first, second)
            }
        }
    }

    /// What the `test` of the textbooks says (dimensionless, 0..=1).
    ///
    /// # Errors
    /// Those of [`ContinuousTest::vertex_triangle`].
    pub fn first_coplanar_contact(
        &self,
        test: &CoplanarityTest,
    ) -> Result<Option<Real>, CollideError> {
        match self.kind {
            QueryKind::VertexTriangle => {
                let (vertex, triangle) = self.vertex_and_triangle();
                test.vertex_triangle(vertex, triangle)
            }
            QueryKind::EdgeEdge => {
                let (first, second) = self.edges();
                test.edge_edge(first, second)
            }
        }
    }

    /// Distance (m) of the two primitives at `time` (dimensionless, 0..=1), in `f64`.
    #[must_use]
    pub fn distance(&self, time: Real) -> Real {
        let [a, b, c, d] = std::array::from_fn(|k| self.from[k] * (1.0 - time) + self.to[k] * time);
        match self.kind {
            QueryKind::VertexTriangle => point_triangle(a, [b, c, d]).distance(),
            QueryKind::EdgeEdge => edge_edge([a, b], [c, d]).distance(),
        }
    }
}
