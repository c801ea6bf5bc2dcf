//! The program: `cloth-bench study | run | locking | ccd | law | list`.

use clap::Parser;
use cloth_bench::commands::{self, Command};
use std::process::ExitCode;

/// Cloth simulation methods, side by side.
#[derive(Parser)]
#[command(version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    match commands::execute(&Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
