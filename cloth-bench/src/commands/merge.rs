//! `cloth-bench merge DIR…`

use super::study::{self, Output};
use crate::error::BenchError;
use crate::journal::Journal;
use crate::studies::{Share, Study};
use clap::Args;
use std::path::PathBuf;

/// Arguments of `merge`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The folders that the shards were written to
    #[arg(required = true, value_name = "DIR")]
    parts: Vec<PathBuf>,
    #[command(flatten)]
    output: Output,
}

pub(super) fn execute(arguments: &Arguments) -> Result<(), BenchError> {
    arguments.output.check()?;
    let journal = Journal::merge(&arguments.output.out, &arguments.parts)?;
    let names = journal.heading().studies.clone();
    let studies = names.iter().map(|name| Study::find(name));
    let studies = studies.collect::<Result<Vec<_>, _>>()?;
    study::conclude(&arguments.output, &studies, journal, Share::Nothing)
}
