//! What can go wrong in the program, and the exit code that says so.

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
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Failed(_) => 1,
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
            Self::Usage(message) | Self::Failed(message) => f.write_str(message),
        }
    }
}

impl std::error::Error for BenchError {}
