//! All tests of this crate in one program, which links once; a file is a subject, and a filter picks it:
//! `cargo test --release -p cloth-core --test all bending::`.

use cloth_core::math; // files of the library that are included ask for `crate::math`

mod air;
mod area_volume;
mod bending;
mod cloth;
#[cfg(feature = "cholesky")]
mod coarse_membrane;
mod coloring;
mod contact_hessian;
mod contact_steps;
#[path = "../support/counting_allocator.rs"]
mod counting_allocator;
mod directions;
mod discretization;
#[cfg(feature = "cholesky")]
mod dof;
#[path = "../support/element_checks.rs"]
mod element_checks;
mod elements;
#[cfg(feature = "cholesky")]
mod elimination;
mod enclosure;
mod geodesics;
mod geometric_stiffness;
mod hessian_product;
mod incidence;
mod limited_memory;
mod line_search;
#[cfg(feature = "cholesky")]
mod linear;
mod linear_solvers;
#[cfg(feature = "cholesky")]
mod locking_remedies;
mod membrane;
mod mesh;
mod multigrid;
mod obj;
mod ordering;
mod pieces;
mod ply;
mod position_based;
mod projection;
mod prolongation;
mod random;
#[cfg(feature = "cholesky")]
mod saddle;
mod semidefinite;
mod solid;
mod stencils;
mod stitch;
mod sweep_forms;
mod sweeps;
mod topology;
mod truncated_gradients;
mod truncation;
mod trust;
mod weights;
