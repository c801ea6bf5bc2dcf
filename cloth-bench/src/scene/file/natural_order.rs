//! The order in which people number files: `2.obj` before `10.obj`.

use std::path::{Path, PathBuf};

/// A part of a name: numbers come before text, short ones before long ones.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    /// Number of digits without leading zeros, and the digits.
    Number(usize, String),
    Text(String),
}

/// Sorts the files of an animation by their names without the extension, in which digits in a row count as one number,
/// of any length. Says which files have no place in that order: one without a number beside others with numbers, and
/// two whose names differ in the zeros before a number or in the extension alone.
pub(super) fn sort(files: &mut [PathBuf]) -> Result<(), String> {
    let shown = |file: &Path| {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        format!("`{name}`")
    };
    files.sort();
    files.sort_by_cached_key(|file| natural_key(file));
    let has_number = |file: &&PathBuf| {
        let parts = natural_key(file);
        parts.iter().any(|part| matches!(part, Part::Number(..)))
    };
    let (numbered, others): (Vec<_>, Vec<_>) = files.iter().partition(has_number);
    if let (Some(number), Some(other)) = (numbered.first(), others.first()) {
        return Err(format!(
            "{} has no number in its name, as {} has: which shape is it? Move it elsewhere or number it",
            shown(other),
            shown(number)
        ));
    }
    let is_same = |pair: &&[PathBuf]| natural_key(&pair[0]) == natural_key(&pair[1]);
    match files.windows(2).find(is_same) {
        Some(pair) => Err(format!(
            "{} and {} have the same name but for zeros before a number or the extension: which shape comes first?",
            shown(&pair[0]),
            shown(&pair[1])
        )),
        None => Ok(()),
    }
}

/// What files are sorted by.
fn natural_key(file: &Path) -> Vec<Part> {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let digits = |c: char| c.is_ascii_digit();
    let mut parts = Vec::new();
    let mut rest = &stem[..];
    while let Some(first) = rest.chars().next() {
        let is_number = digits(first);
        let end = rest.find(|c| digits(c) != is_number);
        let (part, after) = rest.split_at(end.unwrap_or(rest.len()));
        parts.push(match is_number {
            true => {
                let number = part.trim_start_matches('0');
                Part::Number(number.len(), number.to_owned())
            }
            false => Part::Text(part.to_owned()),
        });
        rest = after;
    }
    parts
}
