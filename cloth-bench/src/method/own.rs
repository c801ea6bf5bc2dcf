//! Methods from outside the workspace.
//!
//! Implement [`Stepper`], describe it as an [`OwnMethod`], and give it to [`main_with`](crate::main_with): it is then
//! in `list`, `run` takes it by name, and the studies that compare methods compare it too.
//! `cloth-bench/examples/own-method` is a whole crate that does so.

use super::{Kind, METHODS, Method};
use crate::error::BenchError;
use crate::scene::Scene;
use crate::settings::{Parameter, Settings};
use cloth_core::math::Real;
use cloth_core::step::Stepper;
use std::sync::OnceLock;

/// Builds a solver for a scene and a step size (s).
pub type Build = fn(&Scene, &Settings, Real) -> Result<Box<dyn Stepper>, BenchError>;

/// What the comparison has to know of a method of your own.
#[derive(Clone, Copy, Debug)]
pub struct OwnMethod {
    /// Its name, which no other method has.
    pub name: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// What can be set of it: the tables of structs that [`settings!`](crate::settings!) declares.
    pub parameters: &'static [&'static [Parameter]],
    /// A solver for a scene and a step size (s). Errors are [`BenchError::Usage`] for a setting out of range or an
    /// element that the method cannot take.
    pub build: Build,
    /// Whether the method, solved exactly, takes the step of implicit Euler, so that its error can be measured against
    /// the minimiser.
    pub aims_at_implicit_euler: bool,
}

impl Method {
    /// A method of your own.
    #[must_use]
    pub const fn own(own: OwnMethod) -> Self {
        Self {
            name: own.name,
            about: own.about,
            parameters: own.parameters,
            kind: Kind::Own(own),
        }
    }
}

static OWN: OnceLock<&'static [Method]> = OnceLock::new();

/// Adds methods to those that can be named, once a program.
///
/// # Errors
/// [`BenchError::Usage`] if methods have been added before, or for a name that another method has.
pub fn register(own: &'static [Method]) -> Result<(), BenchError> {
    for (index, method) in own.iter().enumerate() {
        let mut others = METHODS.iter().chain(&own[..index]);
        if others.any(|other| other.name == method.name) {
            return Err(BenchError::Usage(format!(
                "there are two methods `{}`",
                method.name
            )));
        }
    }
    OWN.set(own)
        .map_err(|_| BenchError::Usage("methods have been added before".into()))
}

/// The methods that were added.
pub(crate) fn own() -> &'static [Method] {
    OWN.get().copied().unwrap_or_default()
}

/// Every method, those of your own last.
pub fn all() -> impl Iterator<Item = &'static Method> + Clone {
    METHODS.iter().chain(own())
}

/// These names, and those of the methods of your own.
#[must_use]
pub fn with_own(names: &[&'static str]) -> Vec<&'static str> {
    let own = own().iter().map(|method| method.name);
    names.iter().copied().chain(own).collect()
}
