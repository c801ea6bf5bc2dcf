//! The elements, one file each, with their formulas, derivatives and papers.
//!
//! | element | vertices | [`Energy`](crate::element::Energy) | [`Constraint`](crate::element::Constraint) | [`Projective`](crate::element::Projective) | stiffness |
//! |---|---|---|---|---|---|
//! | [`Spring`] | 2 | yes | 1 row | 1 vector | N/m |
//! | [`CurvatureHinge`] | 4 | yes | 3 rows | 1 vector | N/m, from a rigidity in N·m |
//! | [`CurvedHinge`], curved at rest | 4 | yes | 1 row | 1 vector | N/m, from a rigidity in N·m |
//! | [`DihedralHinge`], rest angle | 4 | yes | 1 row | – | N·m, from a rigidity in N·m |
//! | [`CubicShell`], rest angle | 4 | yes | – | – | N·m, from a rigidity in N·m |
//! | [`MidpointHinge`], on edge midpoints | 5 | yes | 3 rows | 1 vector | N/m, from a rigidity in N·m |
//! | [`StvkTriangle`], modulus Y and ν | 3 | yes | 3 rows | – | J, from a modulus in N/m |
//! | [`ArapTriangle`], modulus Y, ν = 0 | 3 | yes | 2 rows | 2 vectors | J, from a modulus in N/m |
//! | [`AreaTriangle`], area modulus | 3 | yes | 1 row | – | N/m³, from a modulus in N/m |
//! | [`ArapTetrahedron`], shear modulus μ, ν = 0 | 4 | yes | 3 rows | 3 vectors | J, from a modulus in Pa |
//! | [`VolumeTetrahedron`], bulk modulus | 4 | yes | 1 row | – | N/m⁵, from a modulus in Pa |
//! | [`StrainLimitSpring`], slack in a range | 2 | yes | 1 row | 1 vector | N/m |
//! | [`StrainLimitTriangle`], slack in a range | 3 | yes | 2 rows | 2 vectors | J, from a modulus in N/m |
//! | [`Attachment`] | 1 | yes | 3 rows | 1 vector | N/m |
//! | [`SoftPin`], its point moves in time | 1 | yes | 3 rows | 1 vector | N/m |
//! | [`Stitch`], drawn together in time | 2 or 3 | yes | 3 rows | 1 vector | N/m |
//!
//! A dash is a view that the energy does not have. The projective view needs a squared distance to a set under a
//! *constant* linear map, whose vectors the column counts: an angle is no linear function of positions, and the strains
//! of StVK are quadratic ones. (PD bends by the length of the curvature vector instead, [`CurvedHinge`], and stretches
//! by ARAP.) The constraint view needs a sum of squares, and the cubic shell is a polynomial of third degree, unbounded
//! from below.
//!
//! # What a bending rigidity means on a mesh
//!
//! Each bending model gets its own coefficient from one rigidity D, so that bending about the edges of
//! the mesh costs `½ D κ²` per area. What else the sheet does, the pattern of its triangles decides, and no coefficient
//! can change it; the models agree in it, as they agree in small folds:
//!
//! | pattern | bent to a cylinder, over D | bent to a sphere, over `½ D (2κ)²` | note |
//! |---|---|---|---|
//! | equilateral | 1 in every direction | 1/3 | Poisson's ratio −1/3: a strip free to curve across is softer, by 8/9 |
//! | alternating | 1 along the grid, 3/2 across it at 45° | 1/2 | as long as all vertices stand on the surface |
//! | alternating, in equilibrium | 5/6 and 4/3 | 1/3 | vertices with four and with eight neighbours settle at two heights; a strip free to curve across: 4/5 |
//! | one way | 3/4 to 3 | 1/2 | stiffest where the curvature runs along the diagonals, at 45° |
//!
//! The first line by hand. In a sheet of equilateral triangles with edges e the [`CurvatureHinge`] has
//! `q = (2, 2, −2, −2)/√3`, and to each edge belongs the area `a = (A₀ + A₁)/3 = e²/(2√3)`. Let all vertices stand on a
//! surface of normal curvature κ⊥ across the edge and κ∥ along it (1/m). From the tangent plane at the middle of the
//! edge, to leading order, its ends are `κ∥ (e/2)²/2` away and the tips `κ⊥ (√3 e/2)²/2`, so
//! `‖z‖ = |3κ⊥ − κ∥| e²/(2√3) = |3κ⊥ − κ∥| a`, and the hinge costs `½ k (3κ⊥ − κ∥)² a`.
//!
//! - On a cylinder of curvature κ, curved in a direction at the angle φ to that across the edge, `κ⊥ = κ cos² φ` and
//!   `κ∥ = κ sin² φ`, so `3κ⊥ − κ∥ = κ (1 + 2 cos 2φ)`. Its square, in the mean over the three directions of edges, 60°
//!   apart, is `3κ²` for every φ. So `½ D κ²` per area asks for `k = D/3`.
//! - On a sphere `κ⊥ = κ∥ = κ`, and `½ k (2κ)²` per area is a third of `½ D (2κ)²`.
//!
//! The alternating grid, of cells of the size a, has vertices with eight neighbours and between them such with four.
//! Let the latter be raised by η a² over the surface of curvatures `κ_x`, `κ_y` and twist `κ_xy`. Per cell there are
//! three hinges of equal weight, about an edge along x, one along y, and a diagonal, every other of which runs the
//! other way. Their `‖z‖/a²` are `|κ_y + 2η|`, `|κ_x + 2η|` and `|2κ_xy ± 4η|`, so in the mean a cell has, in units of
//! `½ D a²`,
//!
//! `(κ_x + 2η)² + (κ_y + 2η)² + 4κ_xy² + 16η² = κ_x² + κ_y² + 4κ_xy² + 4η (κ_x + κ_y) + 24η²`.
//!
//! - With all vertices on the surface η is 0. On a cylinder along the grid only `κ_x = κ` is left: 1. On one at 45° all
//!   three are κ/2: 3/2. On a sphere it is `2κ²`, half of `(2κ)²`.
//! - In equilibrium `η = −(κ_x + κ_y)/12`, which takes away `(κ_x + κ_y)²/6`: 5/6, 4/3, and 4/3 of 4.
//! - A strip free to curve across has the `κ_y` for which that is least, `κ_x/5`: 4/5.
//!
//! All lines were derived so, hinge by hinge, and measured in the bench (laws `bending-factor`, `elastica`,
//! `lateral-buckling`; study `bending`).

mod arap_tetrahedron;
mod arap_triangle;
mod area;
mod attachment;
mod cotangent;
mod cubic_shell;
mod curvature_hinge;
mod curved_hinge;
mod dihedral_hinge;
mod midpoint_hinge;
mod soft_pin;
mod spring;
mod stitch;
mod strain_limit_spring;
mod strain_limit_triangle;
mod stvk_triangle;
mod triangle_map;
mod volume;

pub use arap_tetrahedron::ArapTetrahedron;
pub use arap_triangle::ArapTriangle;
pub use area::AreaTriangle;
pub use attachment::Attachment;
pub use cubic_shell::CubicShell;
pub use curvature_hinge::CurvatureHinge;
pub use curved_hinge::CurvedHinge;
pub use dihedral_hinge::{DihedralHinge, HingeLaw};
pub use midpoint_hinge::MidpointHinge;
pub use soft_pin::SoftPin;
pub use spring::Spring;
pub use stitch::{Seam, Stitch};
pub use strain_limit_spring::StrainLimitSpring;
pub use strain_limit_triangle::StrainLimitTriangle;
pub use stvk_triangle::StvkTriangle;
pub use volume::VolumeTetrahedron;

use crate::math::Real;

/// Panics if limits `[σ_min, σ_max]` (dimensionless) are negative or out of order.
fn check_limits([least, most]: [Real; 2]) {
    assert!(
        0.0 <= least && least <= most,
        "strain limits {least} to {most}: the first must not be negative, nor above the second"
    );
}
