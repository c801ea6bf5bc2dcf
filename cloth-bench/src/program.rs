//! The program as a function, so that it can be started with methods of your own.

use crate::commands::{self, Command};
use crate::method::{self, Method};
use clap::Parser;
use std::process::ExitCode;

/// Cloth simulation methods, side by side.
#[derive(Parser)]
#[command(version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// The whole program, with methods of your own beside those of the workspace: what the command line asks for is done, and the exit code says how it went.
///
/// ```no_run
/// use cloth_bench::method::{Method, OwnMethod};
///
/// const MINE: Method = Method::own(OwnMethod {
///     name: "mine",
///     about: "nothing moves",
///     parameters: &[],
///     build: |_, _, _| Err(cloth_bench::error::BenchError::Usage("to be written".into())),
///     aims_at_implicit_euler: true,
/// });
///
/// fn main() -> std::process::ExitCode {
///     cloth_bench::main_with(&[MINE])
/// }
/// ```
#[must_use]
pub fn main_with(own: &'static [Method]) -> ExitCode {
    let arguments = Arguments::parse();
    match method::register(own).and_then(|()| commands::execute(&arguments.command)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
