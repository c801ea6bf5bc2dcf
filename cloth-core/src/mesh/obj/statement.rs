//! Lines, words and numbers of an OBJ file.

use super::{MeshFileProblem, ObjProblem};
use crate::math::{Real, Vec3};
use std::borrow::Cow;

/// Statements with the line they begin in, counted from 1: comments cut off, continued lines
/// joined.
pub(super) fn statements(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // Old files of the Mac have CR alone; that of CR LF is a blank like others.
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let mut lines = (1..).zip(text.split(end));
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let (first, mut continued) = code_of(line);
        let mut statement = Cow::Borrowed(first);
        while continued {
            let Some((_, line)) = lines.next() else { break };
            let (more, again) = code_of(line);
            // A number is never cut in two by a line end.
            statement.to_mut().push(' ');
            statement.to_mut().push_str(more);
            continued = again;
        }
        Some((number, statement))
    })
}

/// What stands before a comment or a final backslash, and whether the next line continues it. A
/// backslash at the end of a comment continues nothing: it may well be a Windows path.
fn code_of(line: &str) -> (&str, bool) {
    if let Some((code, _)) = line.split_once('#') {
        return (code, false);
    }
    let line = line.trim_end();
    match line.strip_suffix('\\') {
        Some(code) => (code, true),
        None => (line, false),
    }
}

/// The three coordinates (m) of a vertex; a weight or a colour after them is left out.
pub(super) fn position<'a>(words: impl Iterator<Item = &'a str>) -> Result<Vec3, MeshFileProblem> {
    let mut position = Vec3::zeros();
    let mut found = 0;
    for word in words.take(3) {
        // "nan" and "inf" are numbers for Rust, and so is 1e999, which becomes infinite.
        let number: Real = word
            .parse()
            .map_err(|_| ObjProblem::NotANumber(word.to_owned()))?;
        if !number.is_finite() {
            return Err(MeshFileProblem::NotFinite);
        }
        position[found] = number;
        found += 1;
    }
    match found {
        3 => Ok(position),
        _ => Err(ObjProblem::TooFewCoordinates { found }.into()),
    }
}

/// Vertex number, from 0, of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, also with slashes that nothing follows, when
/// `vertex_count` vertices have been read; a positive one may lie beyond them.
pub(super) fn corner(word: &str, vertex_count: usize) -> Result<u32, ObjProblem> {
    let malformed = || ObjProblem::NotAnIndex(word.to_owned());
    let mut parts = word.split('/');
    let vertex = parts.next().unwrap_or_default();
    let index: i64 = vertex.parse().map_err(|_| malformed())?;
    let is_index = |part: &str| part.is_empty() || part.parse::<i64>().is_ok_and(|i| i != 0);
    if !(parts.by_ref().take(2).all(is_index) && parts.next().is_none()) {
        return Err(malformed());
    }
    let found = match index {
        0 => return Err(malformed()),
        1.. => u32::try_from(index - 1).ok(),
        _ => (vertex_count as u64)
            .checked_sub(index.unsigned_abs())
            .and_then(|vertex| u32::try_from(vertex).ok()),
    };
    found.ok_or(ObjProblem::NoSuchVertex {
        index,
        vertex_count,
    })
}
