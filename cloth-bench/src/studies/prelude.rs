//! What studies use.

pub(super) use super::cases::LazyCell;
pub(super) use super::study_run::StudyRun;
pub(super) use super::variants::{Variant, iterating_own};
pub(super) use super::{Cases, Findings, NOISE, Scope, Study, fastest_to};
pub(super) use crate::bounds::bounds;
pub(super) use crate::error::BenchError;
pub(super) use crate::journal::Number;
pub(super) use crate::method::{self, Method};
pub(super) use crate::report::plot::{Axis, Plot, Series, Style, curves};
pub(super) use crate::report::table::{Cell, Mark, Table, percent, significant, two};
pub(super) use crate::run::{self, largest, median};
pub(super) use crate::scene::{self, Scene};
pub(super) use crate::settings::Settings;
pub(super) use cloth_core::math::{Real, Vec3};
pub(super) use cloth_core::measure::Strain;
pub(super) use cloth_core::particles::State;
pub(super) use cloth_core::random::SplitMix64;
pub(super) use cloth_core::step::{StepInput, Stepper};
pub(super) use itertools::{Itertools, iproduct};
pub(super) use serde::{Deserialize, Serialize};
