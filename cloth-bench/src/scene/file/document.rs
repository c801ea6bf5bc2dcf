//! A TOML document whose values know their lines.

use super::keys::{SECTIONS, SectionInfo};
use crate::error::BenchError;
use crate::names;
use crate::settings::{Settings, Table};
use cloth_core::math::Real;
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
    /// File and line of the bytes of `span`, as errors begin.
    fn place(&self, span: Range<usize>) -> String {
        let before = self.text.as_bytes().get(..span.start).unwrap_or_default();
        let line = 1 + before.iter().filter(|&&b| b == b'\n').count();
        format!("{}: line {line}: ", self.path.display())
    }

    /// What is wrong with the bytes of `span`.
    pub(super) fn refuse(&self, span: Range<usize>, message: impl Display) -> BenchError {
        BenchError::Usage(format!("{}{message}", self.place(span)))
    }

    /// What a reader of TOML says of the byte `at`, with the line that it is about.
    pub(super) fn of_syntax(&self, message: &str, at: usize) -> String {
        let before = self.text.get(..at).unwrap_or(self.text);
        let start = before.rfind('\n').map_or(0, |end| end + 1);
        let line = self.text[start..].lines().next().unwrap_or_default().trim();
        let code = line.split('#').next().unwrap_or_default();
        let value = code.split_once('=').map_or("", |(_, value)| value);
        let parts = value.split('/').map(|part| part.trim().parse());
        let numbers: Vec<Real> = parts.collect::<Result<_, _>>().unwrap_or_default();
        match numbers[..] {
            [over, under] => format!(
                "`{line}`: a number is no fraction in TOML, but {}",
                over / under
            ),
            _ if line.is_empty() => message.to_owned(),
            _ => format!("{message}: `{line}`"),
        }
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
        let mut known: Vec<&str> = info
            .keys
            .iter()
            .copied()
            .flatten()
            .map(|key| key.name)
            .collect();
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
                Err(document.refuse(key.span(), message + &elsewhere(key.get_ref())))
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

    pub(super) fn is_given(&self) -> bool {
        self.entries.is_some()
    }

    /// Its place, as errors begin.
    pub(super) fn place(&self) -> String {
        match self.table {
            Some(table) => self.document.place(table.span()) + self.info.head + ": ",
            None => format!("{}: ", self.document.path.display()),
        }
    }

    /// What is wrong with the table.
    pub(super) fn refuse_table(&self, message: impl Display) -> BenchError {
        BenchError::Usage(format!("{}{message}", self.place()))
    }

    /// The settings that stand in it.
    pub(super) fn read<T: Table>(&self) -> Result<T, BenchError> {
        T::read(&self.settings(Settings::default()))
    }

    /// These settings, and those that stand in it, which hold where both are given.
    pub(super) fn settings(&self, settings: Settings) -> Settings {
        let settings = settings.of_table(self.place().into());
        let keys = self.info.keys.iter().copied().flatten();
        keys.fold(settings, |settings, key| {
            match self.entries.and_then(|entries| entries.get(key.name)) {
                Some(value) => {
                    let (span, place) = (value.span(), self.document.place(value.span()));
                    settings.entry(key.name, &self.document.text[span], Some(place.into()))
                }
                None => settings,
            }
        })
    }
}

/// Where a key can stand that is not known where it does, to be said behind that.
fn elsewhere(key: &str) -> String {
    let has_it = |section: &&SectionInfo| {
        let mut keys = section.keys.iter().copied().flatten();
        keys.any(|parameter| parameter.name == key)
    };
    let heads = SECTIONS.iter().filter(has_it).map(|section| section.head);
    let places: Vec<String> = heads
        .map(|head| match head {
            "" => "before all tables".into(),
            head => format!("in {head}"),
        })
        .collect();
    match places.is_empty() {
        true => String::new(),
        false => format!("; it can stand {}", places.join(", ")),
    }
}
