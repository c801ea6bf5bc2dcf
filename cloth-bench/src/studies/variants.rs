//! Methods with settings of their own, as lines of text.

use crate::method::{self, Method};
use crate::settings::Settings;
use itertools::Itertools;
use serde::{Serialize, Serializer};

/// The methods of your own that can be told how often to iterate towards the step of implicit Euler.
pub(super) fn iterating_own() -> impl Iterator<Item = &'static Method> {
    method::own().iter().filter(|own| {
        let mut all = own.parameters().into_iter().flatten();
        own.aims_at_implicit_euler() && all.any(|one| one.name == "iterations")
    })
}

/// A method with some of its settings, and what it is called.
#[derive(Clone, Debug, Default)]
pub struct Variant {
    /// The name of the method, and what is special after a comma.
    pub label: String,
    /// Those that are not as published.
    pub settings: Settings,
}

/// Of a variant, tables have the label.
impl Serialize for Variant {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.label.serialize(serializer)
    }
}

impl Variant {
    /// A method as `run` takes it.
    pub fn default_of(method: &Method) -> Self {
        Self {
            label: method.name.to_owned(),
            settings: method.by_default(Settings::default()),
        }
    }

    /// A method at its published setting, one for all scenes, which is named where `run` takes another one.
    pub fn published(method: &Method) -> Self {
        Self {
            label: method.published(),
            settings: Settings::default(),
        }
    }

    /// Every method at its default, and those with another published setting at that too.
    pub fn defaults() -> Vec<Self> {
        let both = |method| [Self::default_of(method), Self::published(method)];
        let all = method::all().flat_map(both);
        all.unique_by(|variant| variant.label.clone()).collect()
    }

    /// A method of your own that takes a step in one solve.
    pub fn uncut(own: &Method) -> Self {
        Self {
            label: own.name.to_owned(),
            settings: Settings::default(),
        }
    }

    /// One per line, `method, what is special: key=value key=value`.
    pub fn list(lines: &str) -> Vec<Self> {
        let variant = |line: &str| {
            let (label, settings) = line.split_once(':').unwrap_or((line, ""));
            Self {
                label: label.trim().to_owned(),
                settings: Settings::of(settings),
            }
        };
        let lines = lines.lines().filter(|line| !line.trim().is_empty());
        lines.map(variant).collect()
    }

    /// Methods of your own that iterate, and what they name beside it.
    pub fn of_own() -> Vec<Self> {
        let variants = |own: &Method| [vec![Self::uncut(own)], own.variants()].concat();
        iterating_own().flat_map(variants).collect()
    }

    /// The name of the method.
    pub fn method(&self) -> &str {
        self.label.split(',').next().unwrap_or_default()
    }

    /// What is special about it.
    pub(super) fn what(&self) -> &str {
        self.label.split_once(", ").map_or("", |(_, what)| what)
    }
}
