//! The commands, one file each. `--json` puts one JSON object on standard output and nothing else there; progress goes
//! to standard error.

/// Fields of a struct as name and value pairs.
macro_rules! fields {
    ($of:expr => $($name:ident),+ $(,)?) => {
        [$((stringify!($name), serde_json::json!($of.$name))),+]
    };
}

mod ccd;
mod law;
mod list;
mod locking;
mod merge;
mod run;
mod study;
mod untangle;

use crate::error::BenchError;
use crate::files;
use clap::Subcommand;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

/// What the program is asked to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Runs studies and writes report.html, data/*.csv, plots/*.svg and manifest.json
    Study(study::Arguments),
    /// Joins the parts of a run of studies that was shared among machines, and writes its report
    Merge(merge::Arguments),
    /// Runs one simulation
    Run(run::Arguments),
    /// Counts and measures the degrees of freedom that the edges of a mesh leave
    Locking(locking::Arguments),
    /// Pulls a mesh that passes through itself apart, and writes it
    Untangle(untangle::Arguments),
    /// Asks continuous collision queries of known answer, and counts errors and time
    Ccd(ccd::Arguments),
    /// Puts one closed form beside what the code does
    Law(law::Arguments),
    /// Shows scenes, methods, studies, laws and meshes with their parameters
    List(list::Arguments),
}

/// Does it.
pub fn execute(command: &Command) -> Result<(), BenchError> {
    match command {
        Command::Study(arguments) => study::execute(arguments),
        Command::Merge(arguments) => merge::execute(arguments),
        Command::Run(arguments) => run::execute(arguments),
        Command::Locking(arguments) => patiently(|| locking::execute(arguments)),
        Command::Untangle(arguments) => patiently(|| untangle::execute(arguments)),
        Command::Ccd(arguments) => patiently(|| ccd::execute(arguments)),
        Command::Law(arguments) => patiently(|| law::execute(arguments)),
        Command::List(arguments) => list::execute(arguments),
    }
}

/// What takes longer than this says so on standard error, again and again.
const PATIENCE: Duration = Duration::from_secs(10);

/// Does `work` that has no progress to show, and says how long it has been at it.
fn patiently<T>(work: impl FnOnce() -> T) -> T {
    let started = Instant::now();
    let say = || eprintln!("at work for {:.0} s", started.elapsed().as_secs_f64());
    while_saying(PATIENCE, say, work)
}

/// Does `work`, and lets another thread `say` something after every `interval` that it takes.
pub fn while_saying<T>(interval: Duration, say: impl Fn() + Send, work: impl FnOnce() -> T) -> T {
    let (done, is_done) = mpsc::channel::<()>();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            while is_done.recv_timeout(interval) == Err(RecvTimeoutError::Timeout) {
                say();
            }
        });
        // Dropped when the work has ended, in a panic too.
        let _done = done;
        work()
    })
}

/// Writes to standard output; a closed pipe is no error.
fn print(text: &str) -> Result<(), BenchError> {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(BenchError::Failed(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Creates the folders above `path` and writes the file, all of it or nothing.
fn write_file(path: &Path, content: &[u8]) -> Result<(), BenchError> {
    in_its_folder(path, |path| files::write(path, &[content]))
}

/// Refuses files that cannot be written, and two that are one, before a run that ends with them.
fn check_files<'a>(paths: impl Iterator<Item = &'a PathBuf>) -> Result<(), BenchError> {
    let mut known: Vec<&PathBuf> = Vec::new();
    for path in paths {
        if known.contains(&path) {
            return Err(BenchError::Usage(format!(
                "{} is asked for twice, and the later one would replace the other",
                path.display()
            )));
        }
        known.push(path);
        in_its_folder(path, files::probe)?;
    }
    Ok(())
}

/// Does something with a file whose folder is there, or made.
fn in_its_folder(
    path: &Path,
    work: impl FnOnce(&Path) -> std::io::Result<()>,
) -> Result<(), BenchError> {
    let folder = path.parent().map_or(Ok(()), std::fs::create_dir_all);
    let done = folder.and_then(|()| work(path));
    done.map_err(|error| BenchError::Failed(format!("{}: {error}", path.display())))
}

/// Prints name and value pairs, as a JSON object or as lines.
fn print_pairs(json: bool, pairs: &[(&str, Value)]) -> Result<(), BenchError> {
    if json {
        let pair = |(name, value): &(&str, Value)| ((*name).to_owned(), value.clone());
        let object: Map<String, Value> = pairs.iter().map(pair).collect();
        return print(&Value::Object(object).to_string());
    }
    // The program says it on the other stream.
    let pairs = pairs.iter().filter(|(name, _)| *name != "error");
    let width = pairs.clone().map(|(name, _)| name.len()).max().unwrap_or(0);
    let line = |(name, value): &(&str, Value)| match value {
        Value::String(text) => format!("{name:width$}  {text}"),
        Value::Null => format!("{name:width$}  -"),
        value => format!("{name:width$}  {value}"),
    };
    print(&pairs.map(line).collect::<Vec<_>>().join("\n"))
}
