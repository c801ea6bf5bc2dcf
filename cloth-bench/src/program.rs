//! The program as a function, so that it can be started with methods of your own.

use crate::commands::{self, Command};
use crate::error;
use crate::method::{self, Method};
use clap::Parser;
use clap::error::{ContextKind, ContextValue};
use std::process::ExitCode;

/// Cloth simulation methods, side by side.
#[derive(Parser)]
#[command(version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// The whole program, with methods of your own beside those of the workspace: what the command line asks for is done,
/// and the exit code says how it went.
///
/// ```no_run
/// use cloth_bench::method::{Method, OwnMethod};
///
/// const MINE: Method = Method::own(OwnMethod {
///     aims_at_implicit_euler: true,
///     ..OwnMethod::new("mine", "nothing moves", |_, _, _| {
///         Err(cloth_bench::error::BenchError::Usage("to be written".into()))
///     })
/// });
///
/// fn main() -> std::process::ExitCode {
///     cloth_bench::main_with(&[MINE])
/// }
/// ```
pub fn main_with(own: &'static [Method]) -> ExitCode {
    let arguments = Arguments::try_parse().unwrap_or_else(|error| shortened(error).exit());
    match method::register(own).and_then(|()| commands::execute(&arguments.command)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

/// The error with what it repeats of the command line cut to a bounded length.
fn shortened(mut error: clap::Error) -> clap::Error {
    let cut = |(kind, value): (ContextKind, &ContextValue)| match value {
        ContextValue::String(text) => Some((kind, error::cut(text, 120).into_owned())),
        _ => None,
    };
    let repeated: Vec<(ContextKind, String)> = error.context().filter_map(cut).collect();
    for (kind, text) in repeated {
        error.insert(kind, ContextValue::String(text));
    }
    // How to pass an unknown argument as a value repeats it too.
    let tips = error.get(ContextKind::Suggested);
    if tips.is_some_and(|tips| tips.to_string().chars().count() > 240) {
        error.remove(ContextKind::Suggested);
    }
    error
}
