//! What to say when a name is not known.
//!
//! Scenes, methods, studies and laws are all chosen by name on the command line. A name that does
//! not exist is answered with the nearest one that does, by Damerau–Levenshtein distance, so a
//! transposed pair of letters counts as one mistake.

use crate::error::BenchError;

/// The nearest of `known` to `given`, if one is near enough to be what was meant.
///
/// Near means at most one mistake in three letters (and always at least one allowed), or that the
/// given name is the beginning of a known one. Case does not count. Of equally near names the
/// first in `known` is returned.
pub fn nearest<'a>(given: &str, known: &[&'a str]) -> Option<&'a str> {
    let given = given.trim().to_lowercase();
    let allowed = (given.chars().count() / 3).max(1);
    let by_distance = known
        .iter()
        .map(|&name| {
            (
                strsim::damerau_levenshtein(&given, &name.to_lowercase()),
                name,
            )
        })
        .min_by_key(|&(distance, _)| distance)
        .filter(|&(distance, _)| distance <= allowed);
    by_distance.map(|(_, name)| name).or_else(|| {
        let begins = |name: &&&str| given.len() > 1 && name.to_lowercase().starts_with(&given);
        known.iter().find(begins).copied()
    })
}

/// One sentence that refuses the number of a `kind` of thing (`"mesh"`), of which there are `count`, from 0 on.
pub(crate) fn beyond(kind: &str, number: u32, count: usize) -> String {
    match count {
        0 => format!("there is no {kind} {number}, and no other one"),
        1 => format!("there is no {kind} {number}, only 0"),
        _ => format!("there is no {kind} {number}, only 0 to {}", count - 1),
    }
}

/// The one of `all` that is called `given`, or an error that lists what they are called.
pub(crate) fn find<T>(
    kind: &str,
    given: &str,
    all: impl Iterator<Item = T> + Clone,
    name: impl Fn(&T) -> &'static str,
) -> Result<T, BenchError> {
    let found = all.clone().find(|one| name(one) == given);
    found.ok_or_else(|| {
        let known: Vec<&str> = all.map(|one| name(&one)).collect();
        BenchError::Usage(unknown(kind, given, &known))
    })
}

/// One sentence that refuses the name `given` of a `kind` of thing (`"method"`, `"scene"`),
/// suggests the nearest known name if there is one, and lists the known ones.
///
/// ```
/// # use cloth_bench::names::unknown;
/// assert_eq!(
///     unknown("method", "xpdb", &["pbd", "xpbd"]),
///     "unknown method `xpdb`: did you mean `xpbd`? (known: pbd, xpbd)"
/// );
/// ```
pub fn unknown(kind: &str, given: &str, known: &[&str]) -> String {
    let known_names = if known.is_empty() {
        "none".to_owned()
    } else {
        known.join(", ")
    };
    match nearest(given, known) {
        Some(name) => {
            format!("unknown {kind} `{given}`: did you mean `{name}`? (known: {known_names})")
        }
        None => format!("unknown {kind} `{given}` (known: {known_names})"),
    }
}
