//! The order in which people number files: `2.obj` before `10.obj`.

use std::path::Path;

/// A part of a name: numbers come before text, short ones before long ones.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    /// Number of digits without leading zeros, and the digits.
    Number(usize, String),
    Text(String),
}

/// What files are sorted by: their names without the extension, in which digits in a row count as one number, of any
/// length; then, where two are the same, their whole names.
pub(super) fn natural_key(file: &Path) -> impl Ord + use<> {
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
    (parts, file.to_owned())
}
