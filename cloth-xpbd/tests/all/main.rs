//! All tests of this crate in one program, which links once; a file is a subject, and a filter picks it:
//! `cargo test --release -p cloth-xpbd --test all chapter::`.

#[path = "../support/bad_starts.rs"]
mod bad_starts;
#[path = "../../../cloth-core/tests/support/chain.rs"]
mod chain;
mod chapter;
mod constraints;
#[path = "../../../cloth-core/tests/support/counting_allocator.rs"]
mod counting_allocator;
#[cfg(feature = "direct")]
mod direct;
#[cfg(feature = "direct")]
mod minres;
mod no_alloc;
#[cfg(all(feature = "direct", feature = "single"))]
mod pin_work;
mod refinement;
#[path = "../../../cloth-core/tests/support/sheet.rs"]
mod sheet;
#[cfg(feature = "single")]
mod single;
mod substeps;
mod sweeps;
