//! All tests of this crate in one program, which links once; a file is a subject, and a filter picks it:
//! `cargo test --release -p cloth-core --test all bending::`.

mod air;
mod area_volume;
mod bending;
mod carriers;
mod cloth;
#[path = "../support/counting_allocator.rs"]
mod counting_allocator;
#[cfg(feature = "cholesky")]
mod detail;
#[cfg(feature = "cholesky")]
mod dof;
#[path = "../support/element_checks.rs"]
mod element_checks;
mod elements;
mod enclosure;
mod geometric_stiffness;
mod hessian_product;
#[cfg(feature = "cholesky")]
mod linear;
mod linear_solvers;
mod membrane;
mod mesh;
mod multigrid;
mod obj;
mod ordering;
mod pieces;
mod ply;
mod position_based;
mod projection;
#[cfg(feature = "cholesky")]
mod relief;
#[cfg(feature = "cholesky")]
mod saddle;
mod stitch;
mod sweep_forms;
mod sweeps;
mod topology;
