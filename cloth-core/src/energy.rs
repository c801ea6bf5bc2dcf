//! The elements, one file each, with their formulas, derivatives and papers.
//!
//! | element | vertices | [`Energy`](crate::element::Energy) | [`Constraint`](crate::element::Constraint) | [`Projective`](crate::element::Projective) | stiffness |
//! |---|---|---|---|---|---|
//! | [`Spring`] | 2 | yes | 1 row | K = 1 | N/m |
//! | [`CurvatureHinge`] | 4 | yes | 3 rows | K = 1 | N/m, from a rigidity in N·m |
//! | [`Attachment`] | 1 | yes | 3 rows | K = 1 | N/m |

mod attachment;
mod curvature_hinge;
mod spring;

pub use attachment::Attachment;
pub use curvature_hinge::CurvatureHinge;
pub use spring::Spring;
