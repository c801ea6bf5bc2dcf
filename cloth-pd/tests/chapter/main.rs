//! The claims of the chapter.
//!
//! | claim | test | tolerance |
//! |---|---|---|
//! | one spring: implicit Euler in closed form | `minimum.rs` | 1e-15 m |
//! | end of a step: ∇G = 0, by a G of `cloth-core` | `minimum.rs` | 1.1e-11 |
//! | G falls in each of 60 iterations, by every acceleration | `minimum.rs` | 1e-12 of G |
//! | quadratic energies: one iteration | `minimum.rs` | 2e-15 |
//! | all accelerations end at one minimum | `acceleration.rs` | 1e-11 m |
//! | local steps against brute force | `local.rs` | see there |
//! | a sheet turned, or beside another, moves as alone | `pieces.rs` | 2e-3 m |
//! | a changed solver steps as a new one | `change.rs` | see there |
//! | energy that pins give, from their reactions | `pin_work.rs` | see there |
//! | same bits on any number of threads | `step.rs` | none |
//!
//! Newton's method beside it: `cloth-bench/tests/contract/same_minimum.rs`. Not tested here: times, tables of
//! iterations, and contact beyond a floor (the laws and scenes of `cloth-bench` have it).

mod acceleration;
mod change;
mod cloth;
mod edges;
mod local;
mod minimum;
mod motion;
mod pieces;
mod pin_work;
mod robust;
mod step;
