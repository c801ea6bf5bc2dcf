//! Methods from outside the workspace.
//!
//! Implement [`Stepper`], describe it as an [`OwnMethod`], and give it to [`main_with`](crate::main_with): it is then
//! in `list`, `run` takes it by name, and the studies that compare methods compare it too.
//! `cloth-bench/examples/own-method` is a whole crate that does so.

use super::{Kind, METHODS, Method};
use crate::error::BenchError;
use crate::report::palette::{Marker, Rgb};
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
    /// Colour and marker in every plot. [`palette::gap`](crate::report::palette::gap) tells colours apart.
    pub look: (Rgb, Marker),
    /// Settings of a run that is not a comparison, as `key=value` pairs, where they are not the defaults.
    pub by_default: &'static str,
    /// What the studies of convergence and acceleration compare beside its default, if it has a setting `iterations`:
    /// one a line, as [`Variant::list`](crate::studies::variants::Variant::list) reads them.
    pub variants: &'static str,
    /// What no measurement says: whether parameters are physical; whether vertices are held and let go without a new
    /// solver; what runs in parallel; what is factorised; patents.
    pub qualities: [&'static str; 5],
}

impl OwnMethod {
    /// A method of this name that is what `about` says, without settings. What else is known of it is changed by
    /// `..`, as in the example of [`main_with`](crate::main_with).
    pub const fn new(name: &'static str, about: &'static str, build: Build) -> Self {
        Self {
            name,
            about,
            parameters: &[],
            build,
            aims_at_implicit_euler: false,
            look: ([0xe0, 0x22, 0x5a], Marker::Star),
            by_default: "",
            variants: "",
            qualities: ["not said"; 5],
        }
    }
}

impl Method {
    /// A method of your own.
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
pub fn with_own(names: &[&'static str]) -> Vec<&'static str> {
    let own = own().iter().map(|method| method.name);
    names.iter().copied().chain(own).collect()
}
