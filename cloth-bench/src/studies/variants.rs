//! Methods with settings of their own, as lines of text.

use crate::method::{self, Method};
use crate::settings::Settings;

/// A method with some of its settings, and what it is called.
#[derive(Clone, Debug)]
pub struct Variant {
    /// The name of the method, and what is special after a comma.
    pub label: String,
    /// Those that are not as published.
    pub settings: Settings,
}

impl Variant {
    /// A method at its published settings.
    #[must_use]
    pub fn default_of(method: &Method) -> Self {
        Self {
            label: method.name.to_owned(),
            settings: Settings::default(),
        }
    }

    /// One per line, `method, what is special: key=value key=value`.
    #[must_use]
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

    /// Methods of your own that have a parameter `iterations`, with so many.
    pub fn own_that_iterate(iterations: u32) -> impl Iterator<Item = Self> {
        let iterates = |own: &&Method| {
            let mut parameters = own.parameters().into_iter().flatten();
            parameters.any(|one| one.name == "iterations")
        };
        method::own().iter().filter(iterates).map(move |own| Self {
            settings: Settings::default().with("iterations", iterations),
            ..Self::default_of(own)
        })
    }

    /// The name of the method.
    #[must_use]
    pub fn method(&self) -> &str {
        self.label.split(',').next().unwrap_or_default()
    }

    /// What is special about it.
    pub(super) fn what(&self) -> &str {
        self.label.split_once(", ").map_or("", |(_, what)| what)
    }
}
