//! What can go wrong in the program, and the exit code that says so.

use std::borrow::Cow;
use std::fmt;

/// Why a command did not do its work.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BenchError {
    /// The command or its input makes no sense: exit code 2.
    Usage(String),
    /// The command was fine, but the run failed (diverged, a check failed, a file could not be written): exit code 1.
    Failed(String),
}

impl BenchError {
    /// Exit code of the program.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Failed(_) => 1,
        }
    }

    /// The same with the place in a file in front, as errors begin: `scene.toml: line 3: `; empty if there is none.
    pub(crate) fn at(self, place: &str) -> Self {
        match self {
            Self::Usage(message) => Self::Usage(format!("{place}{message}")),
            Self::Failed(message) => Self::Failed(format!("{place}{message}")),
        }
    }

    /// Bad usage or input, explained by another error.
    pub fn usage(error: impl fmt::Display) -> Self {
        Self::Usage(error.to_string())
    }

    /// A failed run, explained by another error.
    pub fn failed(error: impl fmt::Display) -> Self {
        Self::Failed(error.to_string())
    }
}

impl fmt::Display for BenchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(message) | Self::Failed(message) => f.write_str(&bounded(message)),
        }
    }
}

/// `?` makes the error of a library a failed run. Where the input is to blame, `map_err(BenchError::usage)` says so.
impl<E: std::error::Error> From<E> for BenchError {
    fn from(error: E) -> Self {
        Self::failed(error)
    }
}

/// Longest text between backticks, and longest word elsewhere, such as a path, that a message repeats (characters).
const LONGEST: [usize; 2] = [120, 240];

/// The message with what is longer cut: it comes from a file or a command line and may be of any length.
fn bounded(message: &str) -> String {
    let [quoted, word] = LONGEST;
    let pieces = message.split('`').enumerate().map(|(number, piece)| {
        if number % 2 == 1 {
            return cut(piece, quoted).into_owned();
        }
        let words = piece.split(' ').map(|piece| cut(piece, word));
        words.collect::<Vec<_>>().join(" ")
    });
    pieces.collect::<Vec<_>>().join("`")
}

/// The text, without its middle if it has more than `most` characters.
pub(crate) fn cut(text: &str, most: usize) -> Cow<'_, str> {
    let count = text.chars().count();
    if count <= most {
        return text.into();
    }
    let tail = most / 3;
    let head: String = text.chars().take(most - tail - 1).collect();
    let tail: String = text.chars().skip(count - tail).collect();
    format!("{head}…{tail}").into()
}
