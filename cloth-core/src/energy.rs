//! The elements, one file each, with their formulas, derivatives and papers.
//!
//! | element | vertices | [`Energy`](crate::element::Energy) | [`Constraint`](crate::element::Constraint) | [`Projective`](crate::element::Projective) | stiffness |
//! |---|---|---|---|---|---|
//! | [`Spring`] | 2 | yes | 1 row | K = 1 | N/m |
//! | [`CurvatureHinge`] | 4 | yes | 3 rows | K = 1 | N/m, from a rigidity in N·m |
//! | [`CurvedHinge`], curved at rest | 4 | yes | 1 row | K = 1 | N/m, from a rigidity in N·m |
//! | [`DihedralHinge`], rest angle | 4 | yes | 1 row | – | N·m, from a rigidity in N·m |
//! | [`CubicShell`], rest angle | 4 | yes | – | – | N·m, from a rigidity in N·m |
//! | [`Attachment`] | 1 | yes | 3 rows | K = 1 | N/m |

mod attachment;
mod cubic_shell;
mod curvature_hinge;
mod curved_hinge;
mod dihedral_hinge;
mod spring;

pub use attachment::Attachment;
pub use cubic_shell::CubicShell;
pub use curvature_hinge::CurvatureHinge;
pub use curved_hinge::CurvedHinge;
pub use dihedral_hinge::DihedralHinge;
pub use spring::Spring;
