//! The elements, one file each, with their formulas, derivatives and papers.
//!
//! | element | vertices | [`Energy`](crate::element::Energy) | [`Constraint`](crate::element::Constraint) | [`Projective`](crate::element::Projective) | stiffness |
//! |---|---|---|---|---|---|
//! | [`Spring`] | 2 | yes | 1 row | K = 1 | N/m |
//! | [`CurvatureHinge`] | 4 | yes | 3 rows | K = 1 | N/m, from a rigidity in N·m |
//! | [`CurvedHinge`], curved at rest | 4 | yes | 1 row | K = 1 | N/m, from a rigidity in N·m |
//! | [`DihedralHinge`], rest angle | 4 | yes | 1 row | – | N·m, from a rigidity in N·m |
//! | [`CubicShell`], rest angle | 4 | yes | – | – | N·m, from a rigidity in N·m |
//! | [`StvkTriangle`], modulus Y and ν | 3 | yes | 3 rows | – | J, from a modulus in N/m |
//! | [`ArapTriangle`], modulus Y, ν = 0 | 3 | yes | 2 rows | K = 2 | J, from a modulus in N/m |
//! | [`StrainLimitSpring`], slack in a range | 2 | yes | 1 row | K = 1 | N/m |
//! | [`StrainLimitTriangle`], slack in a range | 3 | yes | 2 rows | K = 2 | J, from a modulus in N/m |
//! | [`Attachment`] | 1 | yes | 3 rows | K = 1 | N/m |

mod arap_triangle;
mod attachment;
mod cubic_shell;
mod curvature_hinge;
mod curved_hinge;
mod dihedral_hinge;
mod spring;
mod strain_limit_spring;
mod strain_limit_triangle;
mod stvk_triangle;
mod triangle_map;

pub use arap_triangle::ArapTriangle;
pub use attachment::Attachment;
pub use cubic_shell::CubicShell;
pub use curvature_hinge::CurvatureHinge;
pub use curved_hinge::CurvedHinge;
pub use dihedral_hinge::DihedralHinge;
pub use spring::Spring;
pub use strain_limit_spring::StrainLimitSpring;
pub use strain_limit_triangle::StrainLimitTriangle;
pub use stvk_triangle::StvkTriangle;

use crate::math::Real;

/// Refuses limits `[σ_min, σ_max]` (dimensionless) that leave no room.
fn check_limits([least, most]: [Real; 2]) {
    assert!(
        0.0 <= least && least <= most,
        "strain limits {least} to {most}: the first must not be negative, nor above the second"
    );
}
