//! All tests of this crate in one program, which links once; a file is a subject, and a filter picks it:
//! `cargo test --release -p cloth-pbd --test all chapter::`.

#[path = "../../../cloth-core/tests/support/chain.rs"]
mod chain;
mod chapter;
mod constraints;
#[path = "../../../cloth-core/tests/support/counting_allocator.rs"]
mod counting_allocator;
mod hierarchy;
mod input;
mod no_alloc;
mod pin_work;
mod robustness;
#[path = "../../../cloth-core/tests/support/sheet.rs"]
mod sheet;
mod stiffness;
mod strain_limit;
