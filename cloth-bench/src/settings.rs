//! Settings of scenes, methods and laws: each declared once, as a field of a struct, with its default, unit and range.
//!
//! `--set key=value`, the tables of a scene file and `list` are readings of that struct:
//!
//! ```
//! use cloth_bench::settings::{Range::*, Settings, Table};
//! cloth_bench::settings! {
//!     /// Of a ball that falls.
//!     struct Ball {
//!         height: f64 = 1 "m" in Above(0.0), "how far it falls";
//!         bounces: u32 = 3 in AtLeast(1.0), "number of bounces";
//!     }
//! }
//! let ball = Ball::read(&Settings::parse(&["height=2.5"])?)?;
//! assert_eq!((*ball.height, *ball.bounces), (2.5, 3));
//! assert_eq!(Ball::PARAMETERS[0].explained(), "(m, above 0) how far it falls");
//! let error = Ball::read(&Settings::parse(&["bounces=0"])?).unwrap_err();
//! assert_eq!(error.to_string(), "bounces is `0`, but it has to be a whole number of at least 1");
//! # Ok::<(), cloth_bench::error::BenchError>(())
//! ```

mod value;

pub use value::{Auto, Choice, Factors, Infinite, Or, Range, Value};

use crate::error::BenchError;
use crate::names;
use std::borrow::Cow;
use std::fmt::Display;
use std::ops::Deref;
use std::sync::Arc;
use toml::de::{DeTable, DeValue};

/// What there is to know of a setting.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its key.
    pub name: &'static str,
    /// Its value if it is not given, as one would write it.
    pub default: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Its unit; empty if it has none.
    pub unit: &'static str,
    /// Which numbers it takes.
    pub range: Range,
    /// Whether its value can be read.
    pub check: fn(&Settings, &Self) -> Result<(), BenchError>,
}

impl Parameter {
    /// What it is, with unit and range.
    pub fn explained(&self) -> String {
        let limits = [self.unit, &self.range.to_string()];
        let limits: Vec<&str> = limits.into_iter().filter(|text| !text.is_empty()).collect();
        match limits.is_empty() {
            true => self.about.to_owned(),
            false => format!("({}) {}", limits.join(", "), self.about),
        }
    }
}

/// A struct of settings, as [`settings!`](crate::settings!) declares it.
pub trait Table: Sized {
    /// Every setting, in the order of the fields.
    const PARAMETERS: &'static [Parameter];

    /// The struct as it is set.
    fn read(settings: &Settings) -> Result<Self, BenchError>;
}

/// Declares structs of settings. A field is `name: Type = default "unit" in range, "what it is";`; unit and range may
/// be left out. A key that cannot be the name of a field stands behind it: `collides as "self": bool = "no", "…";`. The
/// [module](mod@crate::settings) has an example.
#[macro_export]
macro_rules! settings {
    ($($(#[$attribute:meta])* $visible:vis struct $table:ident { $(
        $field:ident $(as $key:literal)?: $type:ty = $default:literal $($unit:literal)? $(in $range:expr)?,
        $about:literal;
    )+ })+) => { $(
        $(#[$attribute])*
        #[derive(Clone, Debug)]
        $visible struct $table {
            $(#[doc = $about] $visible $field: $crate::settings::Setting<$type>),+
        }
        impl $crate::settings::Table for $table {
            const PARAMETERS: &'static [$crate::settings::Parameter] = &[$($crate::settings::Parameter {
                name: [$($key,)? stringify!($field)][0],
                default: concat!($default),
                about: $about,
                unit: concat!($($unit)?),
                range: [$($range,)? $crate::settings::Range::Any][0],
                check: |settings, parameter| settings.value::<$type>(parameter).map(drop),
            }),+];

            fn read(settings: &$crate::settings::Settings) -> Result<Self, $crate::error::BenchError> {
                let mut parameters = Self::PARAMETERS.iter();
                Ok(Self { $($field: settings.next(&mut parameters)?),+ })
            }
        }
    )+ };
}

/// The value of a setting, which knows its key and where it comes from.
#[derive(Clone, Debug)]
pub struct Setting<T> {
    value: T,
    name: &'static str,
    place: Option<Arc<str>>,
    is_given: bool,
}

impl<T> Deref for Setting<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> Setting<T> {
    /// Whether it was given, by the user or by the program.
    pub fn is_given(&self) -> bool {
        self.is_given
    }

    /// The same without the value, for lists of settings of several types.
    pub fn bare(&self) -> Setting<()> {
        Setting {
            value: (),
            name: self.name,
            place: self.place.clone(),
            is_given: self.is_given,
        }
    }

    /// Its key.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Its place in a file, as errors begin; empty if it is from elsewhere.
    pub(crate) fn place(&self) -> &str {
        self.place.as_deref().unwrap_or_default()
    }

    /// What is wrong with it, with file and line if it is from a file.
    pub fn refuse(&self, message: impl Display) -> BenchError {
        placed(self.place.as_deref(), message)
    }

    /// Refuses it if it was given, because it does nothing without `what`.
    pub fn refuse_without(&self, what: &str) -> Result<(), BenchError> {
        self.refuse_given(format_args!("without {what}"))
    }

    /// Refuses it if it was given, because it does nothing `there`.
    pub fn refuse_given(&self, there: impl Display) -> Result<(), BenchError> {
        match self.is_given {
            true => Err(self.refuse(format!("{} has no meaning {there}", self.name))),
            false => Ok(()),
        }
    }
}

fn placed(place: Option<&str>, message: impl Display) -> BenchError {
    BenchError::Usage(format!("{}{message}", place.unwrap_or_default()))
}

/// What is given for a key.
#[derive(Clone, Debug, PartialEq)]
struct Entry {
    key: String,
    /// As it is written.
    text: String,
    /// File and line, if it is from a file.
    place: Option<Arc<str>>,
    /// Whether it only takes the place of the default.
    is_default: bool,
}

/// Values by their keys, from the command line, from a file or from the program; the last one of a key holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    given: Vec<Entry>,
    /// The table of a file that they are from.
    table: Option<Arc<str>>,
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
    pub fn of(text: &str) -> Self {
        let pairs: Vec<&str> = text.split_whitespace().collect();
        Self::parse(&pairs).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The same settings and one more, which holds if there is one of its key already.
    #[allow(clippy::needless_pass_by_value)] // callers hand in literals; a reference before each would only be noise
    pub fn with(self, key: &str, value: impl Display) -> Self {
        self.entry(key, value, None)
    }

    /// The same settings and one from the `place` in a file, if it is from one.
    pub(crate) fn entry(mut self, key: &str, text: impl Display, place: Option<Arc<str>>) -> Self {
        self.given.push(Entry {
            key: key.to_owned(),
            text: text.to_string(),
            place,
            is_default: false,
        });
        self
    }

    /// The same settings, from a table of a file: what is wrong with a value that is not there is said of the table.
    pub(crate) fn of_table(mut self, place: Arc<str>) -> Self {
        self.table = Some(place);
        self
    }

    /// The same settings without those of some keys.
    pub(crate) fn without(mut self, keys: &[&str]) -> Self {
        self.given.retain(|entry| !keys.contains(&&*entry.key));
        self
    }

    /// These settings and `later` ones, which hold where both are given.
    pub fn then(mut self, later: &Self) -> Self {
        self.given.extend_from_slice(&later.given);
        self
    }

    /// These settings, and where they give nothing, other `defaults` than usual.
    pub fn with_defaults(&self, defaults: &str) -> Cow<'_, Self> {
        if defaults.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut all = Self::of(defaults);
        all.given
            .iter_mut()
            .for_each(|entry| entry.is_default = true);
        all.table.clone_from(&self.table);
        Cow::Owned(all.then(self))
    }

    /// Refuses keys that none of the tables knows. `what` names what takes them.
    pub fn check(&self, what: &str, tables: &[&[Parameter]]) -> Result<(), BenchError> {
        let known: Vec<&str> = tables
            .iter()
            .flat_map(|t| t.iter())
            .map(|p| p.name)
            .collect();
        let mut given = self.given.iter().map(|entry| entry.key.as_str());
        match given.find(|key| !known.contains(key)) {
            Some(key) => Err(BenchError::Usage(names::unknown(
                &format!("parameter of {what}"),
                key,
                &known,
            ))),
            None => Ok(()),
        }
    }

    /// Refuses values of these tables that cannot be read or are out of range.
    ///
    /// # Errors
    /// [`BenchError::Usage`] with the key, and with file and line if it is from a file.
    pub fn check_values(&self, tables: &[&[Parameter]]) -> Result<(), BenchError> {
        let mut all = tables.iter().copied().flatten();
        all.try_for_each(|parameter| (parameter.check)(self, parameter))
    }

    /// Those of the settings whose keys the tables know.
    pub fn among(&self, tables: &[&[Parameter]]) -> Self {
        let is_known = |key: &str| tables.iter().flat_map(|t| t.iter()).any(|p| p.name == key);
        let mut own = self.clone();
        own.given.retain(|entry| is_known(&entry.key));
        own
    }

    /// What was given for a key, as it is written.
    pub fn get(&self, key: &str) -> Option<&str> {
        let last = self.last(key).filter(|entry| !entry.is_default);
        last.map(|entry| entry.text.as_str())
    }

    fn last(&self, key: &str) -> Option<&Entry> {
        self.given.iter().rev().find(|entry| entry.key == key)
    }

    /// The value of the next of some parameters; [`settings!`](crate::settings!) reads the fields of a table by it.
    ///
    /// # Panics
    /// If there is none left, and as [`Settings::value`].
    pub fn next<T: Value>(
        &self,
        parameters: &mut std::slice::Iter<'static, Parameter>,
    ) -> Result<Setting<T>, BenchError> {
        self.value(parameters.next().expect("as many parameters as fields"))
    }

    /// The value of a parameter.
    ///
    /// # Panics
    /// For a default that cannot be read.
    pub fn value<T: Value>(&self, parameter: &Parameter) -> Result<Setting<T>, BenchError> {
        let (value, place, is_given) = match self.last(parameter.name) {
            Some(entry) => (entry.read(parameter)?, &entry.place, !entry.is_default),
            None => {
                let value = T::by_default(parameter.default);
                let value = value.unwrap_or_else(|| panic!("{parameter:?} has a wrong default"));
                (value, &self.table, false)
            }
        };
        Ok(Setting {
            value,
            name: parameter.name,
            place: place.clone(),
            is_given,
        })
    }

    /// The first of their keys that a message names.
    fn named_in(&self, message: &str) -> Option<&Entry> {
        let mut words = message.split(|c: char| !(c.is_alphanumeric() || c == '_'));
        words.find_map(|word| self.last(word))
    }

    /// Says in which file and line the value stands that an error of a library names, or else where the table does.
    /// Values of `own` tables come first.
    pub(crate) fn blame<'a>(
        &'a self,
        own: impl IntoIterator<Item = &'a Self>,
        error: impl Display,
    ) -> BenchError {
        let message = error.to_string();
        let mut all = own.into_iter().chain([self]);
        match all.find_map(|settings| settings.named_in(&message)) {
            Some(entry) => placed(entry.place.as_deref(), message),
            None => placed(self.table.as_deref(), message),
        }
    }
}

impl Entry {
    fn read<T: Value>(&self, parameter: &Parameter) -> Result<T, BenchError> {
        let value = match &self.place {
            // The head of a table is no value.
            Some(_) => DeValue::parse(&self.text).map_or_else(
                |_| DeValue::Table(DeTable::new()),
                |value| value.into_inner(),
            ),
            None => DeValue::String(self.text.as_str().into()),
        };
        let read = T::read(&value).filter(|read| read.is_within(parameter.range));
        read.ok_or_else(|| {
            let text = value.as_str().unwrap_or(&self.text);
            let mut words = T::names();
            // Of other defaults, such as `needed`, it is not what one would write.
            if T::CAN_BE_NONE && parameter.default == "none" {
                words.push("none");
            }
            let expected = match (T::KIND, words) {
                ("", known) => {
                    let message = names::unknown(parameter.name, text, &known);
                    return placed(self.place.as_deref(), message);
                }
                (kind, words) => {
                    let (kind, of) = match parameter.range {
                        Range::Any => (T::OF_ANY_SIZE, ""),
                        Range::AtLeast(_) => (kind, " of "),
                        _ => (kind, " "),
                    };
                    let words = words.iter().map(|word| format!(", or {word}"));
                    let words: String = words.collect();
                    format!("{kind}{of}{}{words}", parameter.range)
                }
            };
            let shown = self.text.lines().next().unwrap_or_default();
            let kind = self.place.as_ref().map_or("", |_| kind(&value));
            let name = parameter.name;
            let message = format!("{name} is `{shown}`{kind}, but it has to be {expected}");
            placed(self.place.as_deref(), message)
        })
    }
}

/// What a value is, for errors.
fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => ", a text",
        DeValue::Integer(_) | DeValue::Float(_) => ", a number",
        DeValue::Boolean(_) => ", true or false",
        DeValue::Datetime(_) => ", a date",
        DeValue::Array(_) => ", a list",
        DeValue::Table(_) => ", a table",
    }
}
