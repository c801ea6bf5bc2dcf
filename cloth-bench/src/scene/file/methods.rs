//! `[method.pd]` and the like: settings of methods, those that `--set` takes too.

use super::document::{Document, Section};
use super::keys::{METHOD, SectionInfo};
use crate::error::BenchError;
use crate::method;
use crate::names;
use crate::settings::Settings;
use toml::Spanned;
use toml::de::DeValue;

/// What a file says of methods, all of it checked.
pub(super) fn settings<'a>(
    document: Document<'a>,
    given: Option<&'a Spanned<DeValue<'a>>>,
) -> Result<Vec<(&'static str, Settings)>, BenchError> {
    let table = |value: &'a Spanned<DeValue<'a>>| match value.get_ref() {
        DeValue::Table(entries) => Ok(entries),
        _ => {
            let message = format!(
                "this has to be a table: write {} above its keys",
                METHOD.head
            );
            Err(document.refuse(value.span(), message))
        }
    };
    let mut all = Vec::new();
    for (name, value) in given.map(table).transpose()?.into_iter().flatten() {
        let Some(method) = method::all().find(|method| method.name == name.get_ref().as_ref())
        else {
            let known: Vec<&str> = method::all().map(|method| method.name).collect();
            let message = names::unknown("method", name.get_ref(), &known);
            return Err(document.refuse(name.span(), message));
        };
        // A program reads one or a few files.
        let info: &'static SectionInfo = Box::leak(Box::new(SectionInfo {
            head: Box::leak(format!("[method.{}]", method.name).into_boxed_str()),
            about: METHOD.about,
            keys: Vec::leak(method.parameters()),
        }));
        let section = Section::new(document, info, Some(value), Some(table(value)?), &[])?;
        let settings = section.settings(Settings::default());
        settings.check_values(info.keys)?;
        all.push((method.name, settings));
    }
    Ok(all)
}
