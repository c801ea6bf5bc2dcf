//! `--set key=value`: named parameters of scenes, methods and laws, checked against what each of them knows.

use crate::error::BenchError;
use crate::names;
use cloth_core::math::Real;

/// A parameter that a scene, a method or a law takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its key.
    pub name: &'static str,
    /// Its value if it is not set, as one would write it.
    pub default: &'static str,
    /// What it is, with its unit.
    pub about: &'static str,
}

/// Shorthand for a table of parameters.
#[must_use]
pub const fn parameter(
    name: &'static str,
    default: &'static str,
    about: &'static str,
) -> Parameter {
    Parameter {
        name,
        default,
        about,
    }
}

/// The values set on the command line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    given: Vec<(String, String)>,
}

impl Settings {
    /// Reads `key=value` pairs.
    ///
    /// # Errors
    /// [`BenchError::Usage`] for a pair without `=` or without a key, or for a key that is there twice.
    pub fn parse<S: AsRef<str>>(pairs: &[S]) -> Result<Self, BenchError> {
        let mut settings = Self::default();
        for pair in pairs {
            let pair = pair.as_ref();
            let split = pair.split_once('=').map(|(key, value)| (key.trim(), value));
            let Some((key, value)) = split.filter(|(key, _)| !key.is_empty()) else {
                return Err(BenchError::Usage(format!(
                    "`--set {pair}` is not of the form key=value"
                )));
            };
            if let Some(first) = settings.get(key) {
                return Err(BenchError::Usage(format!(
                    "`{key}` is set twice, to `{first}` and to `{}`: give one of them",
                    value.trim()
                )));
            }
            settings = settings.with(key, value.trim());
        }
        Ok(settings)
    }

    /// Settings of the program's own, as one writes them, with blanks between: `n=20 stiffness=1e4`.
    ///
    /// # Panics
    /// If one of them is not of the form `key=value`.
    #[must_use]
    pub fn of(text: &str) -> Self {
        let pairs: Vec<&str> = text.split_whitespace().collect();
        Self::parse(&pairs).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The same settings and one more, which holds if there is one of its key already.
    #[must_use]
    #[allow(clippy::needless_pass_by_value)] // callers hand in literals; a reference before each would only be noise
    pub fn with(mut self, key: &str, value: impl std::fmt::Display) -> Self {
        self.given.push((key.to_owned(), format!("{value}")));
        self
    }

    /// These settings and `later` ones, which hold where both are given.
    #[must_use]
    pub fn then(mut self, later: &Self) -> Self {
        self.given.extend_from_slice(&later.given);
        self
    }

    /// Refuses keys that none of the tables knows. `what` names what takes them.
    ///
    /// # Errors
    /// [`BenchError::Usage`] that names the key and the nearest known one.
    pub fn check(&self, what: &str, tables: &[&[Parameter]]) -> Result<(), BenchError> {
        let known: Vec<&str> = tables
            .iter()
            .flat_map(|t| t.iter())
            .map(|p| p.name)
            .collect();
        match self
            .given
            .iter()
            .find(|(key, _)| !known.contains(&key.as_str()))
        {
            Some((key, _)) => Err(BenchError::Usage(names::unknown(
                &format!("parameter of {what}"),
                key,
                &known,
            ))),
            None => Ok(()),
        }
    }

    /// Refuses a parameter that was given, because it does nothing without `what`.
    ///
    /// # Errors
    /// [`BenchError::Usage`] that names both.
    pub fn refuse_without(&self, parameter: &Parameter, what: &str) -> Result<(), BenchError> {
        if self.get(parameter.name).is_none() {
            return Ok(());
        }
        Err(BenchError::Usage(format!(
            "{} has no meaning without {what}",
            parameter.name
        )))
    }

    /// Those of the settings whose keys the tables know.
    #[must_use]
    pub fn among(&self, tables: &[&[Parameter]]) -> Self {
        let is_known = |key: &str| tables.iter().flat_map(|t| t.iter()).any(|p| p.name == key);
        let given = self.given.iter().filter(|(key, _)| is_known(key));
        Self {
            given: given.cloned().collect(),
        }
    }

    /// What was given for a key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&str> {
        self.given
            .iter()
            .rev()
            .find(|(k, _)| k == key)
            .map(|(_, v)| v.as_str())
    }

    /// The value of a parameter as text, its default if it was not set.
    #[must_use]
    pub fn text<'a>(&'a self, parameter: &Parameter) -> &'a str {
        self.get(parameter.name).unwrap_or(parameter.default)
    }

    /// The value as a finite number.
    ///
    /// # Errors
    /// [`BenchError::Usage`] if it is none.
    pub fn number(&self, parameter: &Parameter) -> Result<Real, BenchError> {
        let text = self.text(parameter);
        text.parse::<Real>()
            .ok()
            .filter(|v| v.is_finite())
            .ok_or_else(|| {
                BenchError::Usage(format!(
                    "{} is `{text}`, but it has to be a finite number",
                    parameter.name
                ))
            })
    }

    /// The value as a number above zero.
    ///
    /// # Errors
    /// [`BenchError::Usage`] if it is none.
    pub fn positive(&self, parameter: &Parameter) -> Result<Real, BenchError> {
        let value = self.number(parameter)?;
        if value > 0.0 {
            Ok(value)
        } else {
            Err(BenchError::Usage(format!(
                "{} is {value}, but it has to be above zero",
                parameter.name
            )))
        }
    }

    /// The value as a whole number of at least `least`.
    ///
    /// # Errors
    /// [`BenchError::Usage`] if it is none.
    pub fn count(&self, parameter: &Parameter, least: u32) -> Result<u32, BenchError> {
        let text = self.text(parameter);
        text.parse::<u32>()
            .ok()
            .filter(|&n| n >= least)
            .ok_or_else(|| {
                BenchError::Usage(format!(
                    "{} is `{text}`, but it has to be a whole number, at least {least}",
                    parameter.name
                ))
            })
    }

    /// The value as one of a few names.
    ///
    /// # Errors
    /// [`BenchError::Usage`] that names the nearest known one.
    pub fn choice<T: Copy>(
        &self,
        parameter: &Parameter,
        choices: &[(&'static str, T)],
    ) -> Result<T, BenchError> {
        let text = self.text(parameter);
        choices
            .iter()
            .find(|(name, _)| *name == text)
            .map(|&(_, value)| value)
            .ok_or_else(|| {
                let known: Vec<&str> = choices.iter().map(|&(name, _)| name).collect();
                BenchError::Usage(names::unknown(parameter.name, text, &known))
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: [Parameter; 2] = [
        parameter("stiffness", "1e4", "N/m"),
        parameter("iterations", "10", "a count"),
    ];

    #[test]
    fn the_last_value_of_a_key_holds_and_defaults_fill_in() {
        let set = Settings::parse(&["stiffness = 5"]).unwrap();
        let set = set.with("stiffness", 7);
        assert_eq!(set.number(&TABLE[0]).unwrap(), 7.0);
        assert_eq!(set.count(&TABLE[1], 1).unwrap(), 10);
    }

    #[test]
    fn an_unknown_key_is_answered_with_the_nearest_known_one() {
        let set = Settings::parse(&["stifness=5"]).unwrap();
        let message = set
            .check("scene `hang`", &[&TABLE])
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("`stifness`") && message.contains("`stiffness`"),
            "{message}"
        );
    }

    #[test]
    fn what_the_tables_do_not_know_stays_behind() {
        let set = Settings::parse(&["stiffness=5", "other=1"]).unwrap();
        assert_eq!(
            set.among(&[&TABLE]),
            Settings::parse(&["stiffness=5"]).unwrap()
        );
    }

    #[test]
    fn values_out_of_range_are_refused_by_name() {
        for (pair, parameter) in [
            ("stiffness=nan", 0),
            ("stiffness=-1", 0),
            ("stiffness=x", 0),
        ] {
            let error = Settings::parse(&[pair])
                .unwrap()
                .positive(&TABLE[parameter])
                .unwrap_err();
            assert!(error.to_string().starts_with("stiffness is"), "{error}");
        }
        assert!(
            Settings::parse(&["iterations=0"])
                .unwrap()
                .count(&TABLE[1], 1)
                .is_err()
        );
        assert!(Settings::parse(&["iterations"]).is_err());
        assert!(Settings::parse(&["=3"]).is_err());
        assert!(Settings::parse(&["iterations=1", " iterations = 1"]).is_err());
    }
}
