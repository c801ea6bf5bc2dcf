//! A TOML document whose values know their lines.

use super::keys::SectionInfo;
use crate::error::BenchError;
use crate::names;
use crate::scene::STIFFNESS;
use crate::settings::{Parameter, Settings};
use cloth_core::math::{Real, Vec3};
use std::fmt::Display;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The file that errors name.
#[derive(Clone, Copy)]
pub(super) struct Document<'a> {
    pub(super) path: &'a Path,
    pub(super) text: &'a str,
}

impl Document<'_> {
    /// What is wrong with the bytes of `span`.
    pub(super) fn refuse(&self, span: Range<usize>, message: impl Display) -> BenchError {
        let before = self.text.as_bytes().get(..span.start).unwrap_or_default();
        let line = 1 + before.iter().filter(|&&b| b == b'\n').count();
        BenchError::Usage(format!("{}: line {line}: {message}", self.path.display()))
    }

    /// What is wrong with the file as a whole.
    pub(super) fn refuse_whole(&self, message: impl Display) -> BenchError {
        BenchError::Usage(format!("{}: {message}", self.path.display()))
    }
}

/// A table of the file; one that is not there has only defaults.
#[derive(Clone, Copy)]
pub(super) struct Section<'a> {
    document: Document<'a>,
    info: &'static SectionInfo,
    table: Option<&'a Spanned<DeValue<'a>>>,
    entries: Option<&'a DeTable<'a>>,
}

type Value<'a> = &'a Spanned<DeValue<'a>>;

/// What a value is, for errors.
fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

fn real(value: &DeValue<'_>) -> Option<Real> {
    let number: Real = match value {
        DeValue::Float(float) => float.as_str().parse().ok()?,
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok()? as Real
        }
        _ => return None,
    };
    number.is_finite().then_some(number)
}

fn whole(value: &DeValue<'_>) -> Option<u64> {
    match value {
        DeValue::Integer(integer) => u64::from_str_radix(integer.as_str(), integer.radix()).ok(),
        _ => None,
    }
}

fn vector(value: &DeValue<'_>) -> Option<Vec3> {
    let DeValue::Array(array) = value else {
        return None;
    };
    let numbers: Option<Vec<Real>> = array.iter().map(|v| real(v.get_ref())).collect();
    match numbers?[..] {
        [x, y, z] => Some(Vec3::new(x, y, z)),
        _ => None,
    }
}

impl<'a> Section<'a> {
    /// Checks that all keys are known.
    pub(super) fn new(
        document: Document<'a>,
        info: &'static SectionInfo,
        table: Option<Value<'a>>,
        entries: Option<&'a DeTable<'a>>,
        others: &[&str],
    ) -> Result<Self, BenchError> {
        let section = Self {
            document,
            info,
            table,
            entries,
        };
        let mut known: Vec<&str> = info.keys.iter().map(|key| key.name).collect();
        known.extend(others);
        let unknown = entries
            .into_iter()
            .flat_map(DeTable::iter)
            .map(|(key, _)| key);
        let unknown = unknown.filter(|key| !known.contains(&key.get_ref().as_ref()));
        match unknown.min_by_key(|key| key.span().start) {
            None => Ok(section),
            Some(key) => {
                let kind = match info.head {
                    "" => "key".to_owned(),
                    head => format!("key of {head}"),
                };
                let message = names::unknown(&kind, key.get_ref(), &known);
                Err(document.refuse(key.span(), message))
            }
        }
    }

    /// A table below this one, such as the `[mesh.cloth]` of a `[[mesh]]`.
    pub(super) fn below(
        &self,
        name: &str,
        info: &'static SectionInfo,
    ) -> Result<Option<Self>, BenchError> {
        let Some(value) = self.entries.and_then(|entries| entries.get(name)) else {
            return Ok(None);
        };
        let DeValue::Table(entries) = value.get_ref() else {
            let message = format!("this has to be a table: write {} above its keys", info.head);
            return Err(self.document.refuse(value.span(), message));
        };
        Self::new(self.document, info, Some(value), Some(entries), &[]).map(Some)
    }

    /// The value of a key.
    pub(super) fn value(&self, key: &Parameter) -> Option<Value<'a>> {
        self.entries?.get(key.name)
    }

    pub(super) fn is_given(&self) -> bool {
        self.entries.is_some()
    }

    /// What is wrong with the value of a key, or with the table if it is not given.
    pub(super) fn refuse(&self, key: &Parameter, message: impl Display) -> BenchError {
        match self.value(key) {
            Some(value) => self.document.refuse(value.span(), message),
            None => self.refuse_table(message),
        }
    }

    /// What is wrong with the table.
    pub(super) fn refuse_table(&self, message: impl Display) -> BenchError {
        match self.table {
            Some(table) => {
                let head = self.info.head;
                self.document
                    .refuse(table.span(), format!("{head}: {message}"))
            }
            None => self.document.refuse_whole(message),
        }
    }

    fn read<T>(
        &self,
        key: &Parameter,
        expected: &str,
        read: impl Fn(&'a DeValue<'a>) -> Option<T>,
    ) -> Result<Option<T>, BenchError> {
        let Some(value) = self.value(key) else {
            return Ok(None);
        };
        read(value.get_ref()).map(Some).ok_or_else(|| {
            let shown = &self.document.text[value.span()];
            let message = format!(
                "{} is `{}`, {}, but it has to be {expected}",
                key.name,
                shown.lines().next().unwrap_or_default(),
                kind(value.get_ref())
            );
            self.document.refuse(value.span(), message)
        })
    }

    pub(super) fn number(&self, key: &Parameter) -> Result<Option<Real>, BenchError> {
        self.read(key, "a finite number", real)
    }

    pub(super) fn positive(&self, key: &Parameter) -> Result<Option<Real>, BenchError> {
        let above = |value: &DeValue<'_>| real(value).filter(|&number| number > 0.0);
        self.read(key, "a finite number above 0", above)
    }

    /// A stiffness, which may be infinite.
    pub(super) fn stiffness(&self, key: &Parameter) -> Result<Option<Real>, BenchError> {
        let above = |value: &DeValue<'_>| match value {
            DeValue::Float(float) if float.as_str().trim_start_matches('+') == "inf" => {
                Some(Real::INFINITY)
            }
            _ => real(value).filter(|&number| number > 0.0),
        };
        self.read(key, "a number above 0, or inf", above)
    }

    pub(super) fn not_negative(&self, key: &Parameter) -> Result<Option<Real>, BenchError> {
        let above = |value: &DeValue<'_>| real(value).filter(|&number| number >= 0.0);
        self.read(key, "a finite number of at least 0", above)
    }

    pub(super) fn count(&self, key: &Parameter) -> Result<Option<u32>, BenchError> {
        let count = |value: &DeValue<'_>| whole(value).and_then(|n| u32::try_from(n).ok());
        self.read(key, "a whole number", count)
    }

    pub(super) fn counts(&self, key: &Parameter) -> Result<Option<Vec<u64>>, BenchError> {
        let all = |value: &DeValue<'_>| match value {
            DeValue::Array(array) => array.iter().map(|v| whole(v.get_ref())).collect(),
            _ => None,
        };
        self.read(key, "a list of whole numbers such as [0, 32]", all)
    }

    pub(super) fn text(&self, key: &Parameter) -> Result<Option<&'a str>, BenchError> {
        let text = |value: &'a DeValue<'a>| match value {
            DeValue::String(text) => Some(text.as_ref()),
            _ => None,
        };
        self.read(key, "a text in quotes", text)
    }

    pub(super) fn vector(&self, key: &Parameter) -> Result<Option<Vec3>, BenchError> {
        self.read(key, "three finite numbers such as [0, 0, 1]", vector)
    }

    /// A vector that may be written as one number.
    pub(super) fn factors(&self, key: &Parameter) -> Result<Option<Vec3>, BenchError> {
        let factors = |value: &DeValue<'_>| {
            let same = real(value).map(|number| Vec3::new(number, number, number));
            same.or_else(|| vector(value)).filter(|v| v.min() > 0.0)
        };
        self.read(key, "a finite number above 0, or three", factors)
    }

    pub(super) fn corners(&self, key: &Parameter) -> Result<Option<[Vec3; 2]>, BenchError> {
        let corners = |value: &DeValue<'_>| match value {
            DeValue::Array(array) => {
                let both: Option<Vec<Vec3>> = array.iter().map(|v| vector(v.get_ref())).collect();
                both?.try_into().ok()
            }
            _ => None,
        };
        self.read(key, "two points such as [[0, 0, 0], [1, 1, 1]]", corners)
    }

    /// Its keys as settings, as one would write them after `--set`.
    pub(super) fn settings(&self, mut settings: Settings) -> Result<Settings, BenchError> {
        for key in self.info.keys {
            // The only one that may be infinite.
            let is_stiffness = key.name == STIFFNESS.name;
            let written = |value: &DeValue<'_>| match value {
                DeValue::String(text) => Some(text.to_string()),
                DeValue::Boolean(yes) => Some(if *yes { "yes" } else { "no" }.to_owned()),
                DeValue::Array(array) => {
                    let numbers = array.iter().map(|v| real(v.get_ref()));
                    let all: Option<Vec<String>> =
                        numbers.map(|n| Some(format!("{:?}", n?))).collect();
                    Some(all?.join(","))
                }
                DeValue::Integer(_) => whole(value)
                    .map(|n| n.to_string())
                    .or_else(|| Some(format!("{:?}", real(value)?))),
                DeValue::Float(float) if is_stiffness && float.as_str().ends_with("inf") => {
                    Some(float.as_str().trim_start_matches('+').to_owned())
                }
                DeValue::Float(_) => real(value).map(|number| format!("{number:?}")),
                _ => None,
            };
            let expected = "a finite number, a text in quotes, true or false, or a list of numbers";
            if let Some(text) = self.read(key, expected, written)? {
                settings = settings.with(key.name, text);
            }
        }
        Ok(settings)
    }

    /// The first key in a message that stands in this table.
    fn named_in(&self, message: &str) -> Option<&'static Parameter> {
        let mut words = message.split(|c: char| !(c.is_alphanumeric() || c == '_'));
        words.find_map(|word| {
            let mut keys = self.info.keys.iter();
            keys.find(|key| key.name == word && self.value(key).is_some())
        })
    }

    /// Whether an error names a key that stands in this table.
    pub(super) fn is_named_in(&self, error: &BenchError) -> bool {
        matches!(error, BenchError::Usage(message) if self.named_in(message).is_some())
    }

    /// Says in which line the value stands that an error names, if it stands in this table and nothing else has
    /// `overruled` it.
    pub(super) fn blame(&self, error: BenchError, overruled: &Settings) -> BenchError {
        let BenchError::Usage(message) = error else {
            return error;
        };
        match self.named_in(&message) {
            Some(key) if overruled.get(key.name).is_some() => BenchError::Usage(message),
            Some(key) => self.refuse(key, message),
            None => self.refuse_table(message),
        }
    }
}
