//! Closed forms beside what the code does.

/// Declares a law with the settings that are its own, as [`settings!`](crate::settings!) does, and if need be those of
/// a bending model: name and tolerance, what it says, and the function that evaluates it.
macro_rules! law {
    ($law:ident = $name:literal within $tolerance:literal, $about:literal;
     $evaluate:ident($table:ident { $($settings:tt)* } $(and $other:ident)?)) => {
        crate::settings! { struct $table { $($settings)* } }

        pub(super) const $law: Law = Law {
            name: $name,
            about: $about,
            parameters: &[$table::PARAMETERS $(, $other::PARAMETERS)?],
            tolerance: $tolerance,
            evaluate: |settings| $evaluate(&$table::read(settings)? $(, &$other::read(settings)?)?),
        };
    };
}

mod bending_spring;
pub mod buckling;
mod catenary;
mod chain_rate;
mod chains;
mod constraints;
mod contact;
pub mod elastica;
pub(crate) mod elements;
pub(crate) mod factors;
pub(crate) mod models;
mod motion;
mod patch;
mod prelude;
mod space;
pub(crate) mod strip;
mod swings;
mod xpbd;

pub(crate) use constraints::{Stretched, fixed_projection};

use crate::error::BenchError;
use crate::names;
use crate::settings::{Parameter, Settings};
use cloth_core::math::Real;

/// What a law says and what the code does.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// The closed form.
    pub expected: Real,
    /// What the code gives.
    pub measured: Real,
    /// Relative error (absolute if the expected number is 0) that rounding alone can explain, where that is more than
    /// the law's tolerance; else 0.
    pub rounding: Real,
    /// What else there is to know, name and value.
    pub details: Vec<(&'static str, Real)>,
}

impl Evaluation {
    /// An expected and a measured number.
    pub fn new(expected: Real, measured: Real) -> Self {
        Self {
            expected,
            measured,
            rounding: 0.0,
            details: Vec::new(),
        }
    }

    /// States what rounding alone can explain.
    pub fn rounding(mut self, rounding: Real) -> Self {
        self.rounding = rounding;
        self
    }

    /// Adds a named number.
    pub fn detail(mut self, name: &'static str, value: Real) -> Self {
        self.details.push((name, value));
        self
    }

    /// `|measured − expected|`, relative to the expected number unless that is zero.
    pub fn error(&self) -> Real {
        let difference = (self.measured - self.expected).abs();
        if self.expected == 0.0 {
            difference
        } else {
            difference / self.expected.abs()
        }
    }
}

/// Refuses values with which a check would take minutes. `operations` are about those on numbers, by a formula of the
/// law.
fn within_reach(operations: Real) -> Result<(), BenchError> {
    /// Some ten seconds of one core.
    const MOST: Real = 2e10;
    if operations <= MOST {
        return Ok(());
    }
    Err(BenchError::Usage(format!(
        "these values take some {operations:.0e} operations, but a law is checked with at most {MOST:.0e}: give smaller counts"
    )))
}

/// Where rounding can do more than this (relative), a comparison says nothing.
const MOST_ROUNDING: Real = 1e-3;

/// A closed form that can be asked for by name.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    /// Its name.
    pub name: &'static str,
    /// What it says, and the unit of its number.
    pub about: &'static str,
    /// What can be set, in groups.
    pub parameters: &'static [&'static [Parameter]],
    /// How far the code may be from it (relative) before the law counts as broken.
    pub tolerance: Real,
    evaluate: fn(&Settings) -> Result<Evaluation, BenchError>,
}

/// Every law.
pub const LAWS: [&Law; 30] = [
    &motion::OSCILLATOR,
    &motion::FREE_FALL,
    &constraints::XPBD_CONSTRAINT,
    &constraints::PBD_CONSTRAINT,
    &chain_rate::CHAIN_RATE,
    &xpbd::XPBD_DAMPING,
    &xpbd::SUPPORT_FORCE,
    &xpbd::XPBD_COMPLIANCE,
    &xpbd::DIRECT_STEP,
    &chains::SAG,
    &chains::HANGING_CHAIN,
    &catenary::CATENARY,
    &swings::PENDULUM,
    &swings::CHAIN_SWING,
    &elements::LATTICE_MODULUS,
    &factors::BENDING_FACTOR,
    &patch::PATCH,
    &elements::FLAT_BENDING,
    &bending_spring::BENDING_SPRING,
    &elastica::ELASTICA,
    &buckling::LATERAL_BUCKLING,
    &space::NULL_SPACE,
    &space::COUNT,
    &space::SAME_MINIMUM,
    &contact::INCLINE,
    &contact::BOUNCE,
    &contact::BARRIER_GAP,
    &contact::STACK,
    &contact::CAPSTAN,
    &contact::PRESSURE,
];

impl Law {
    /// Whether the code is as near to the closed form as it has to be.
    pub fn holds(&self, evaluation: &Evaluation) -> bool {
        evaluation.error() <= self.tolerance.max(evaluation.rounding)
    }

    /// The law of that name.
    pub fn find(name: &str) -> Result<&'static Self, BenchError> {
        names::find("law", name, LAWS.iter().copied(), |law| law.name)
    }

    /// Puts the closed form beside what the code does.
    ///
    /// # Errors
    /// [`BenchError::Usage`] for a parameter that is unknown or out of range, [`BenchError::Failed`] if the code gives
    /// no number.
    pub fn evaluate(&self, settings: &Settings) -> Result<Evaluation, BenchError> {
        settings.check(&format!("law `{}`", self.name), self.parameters)?;
        let evaluation = (self.evaluate)(settings)?;
        // Written so that a bound that is not a number is refused too.
        if evaluation.rounding < MOST_ROUNDING {
            return Ok(evaluation);
        }
        Err(BenchError::Usage(format!(
            "law `{}` cannot be checked with these values: rounding alone may change the result by {:.1e}",
            self.name, evaluation.rounding
        )))
    }
}
