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
//! | [`AreaTriangle`], area modulus K | 3 | yes | 1 row | – | N/m³, from a modulus in N/m |
//! | [`VolumeTetrahedron`], bulk modulus K | 4 | yes | 1 row | – | N/m⁵, from a modulus in Pa |
//! | [`StrainLimitSpring`], slack in a range | 2 | yes | 1 row | K = 1 | N/m |
//! | [`StrainLimitTriangle`], slack in a range | 3 | yes | 2 rows | K = 2 | J, from a modulus in N/m |
//! | [`Attachment`] | 1 | yes | 3 rows | K = 1 | N/m |
//!
//! A dash is a view that the energy does not have. The projective view needs a squared distance to a set under a *constant* linear map: an angle is no
//! linear function of positions, and the strains of StVK are quadratic ones. (PD bends by the length of the curvature vector instead, [`CurvedHinge`], and stretches by ARAP.) The
//! constraint view needs a sum of squares, and the cubic shell is a polynomial of third degree, unbounded from below.

mod arap_triangle;
mod area;
mod attachment;
mod cotangent;
mod cubic_shell;
mod curvature_hinge;
mod curved_hinge;
mod dihedral_hinge;
mod spring;
mod strain_limit_spring;
mod strain_limit_triangle;
mod stvk_triangle;
mod triangle_map;
mod volume;

pub use arap_triangle::ArapTriangle;
pub use area::AreaTriangle;
pub use attachment::Attachment;
pub use cubic_shell::CubicShell;
pub use curvature_hinge::CurvatureHinge;
pub use curved_hinge::CurvedHinge;
pub use dihedral_hinge::DihedralHinge;
pub use spring::Spring;
pub use strain_limit_spring::StrainLimitSpring;
pub use strain_limit_triangle::StrainLimitTriangle;
pub use stvk_triangle::StvkTriangle;
pub use volume::VolumeTetrahedron;

use crate::math::Real;

/// Refuses limits `[σ_min, σ_max]` (dimensionless) that leave no room.
fn check_limits([least, most]: [Real; 2]) {
    assert!(
        0.0 <= least && least <= most,
        "strain limits {least} to {most}: the first must not be negative, nor above the second"
    );
}
