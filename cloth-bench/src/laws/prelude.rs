//! What nearly every law uses.

pub(super) use super::{Evaluation, Law, within_reach};
pub(super) use crate::error::BenchError;
pub(super) use crate::settings::{Range::*, Settings, Table};
pub(super) use cloth_core::cloth::Elements;
pub(super) use cloth_core::energy::Spring;
pub(super) use cloth_core::math::{Real, Vec3};
pub(super) use cloth_core::particles::{Particles, State};
pub(super) use cloth_core::step::{StepInput, Stepper};
