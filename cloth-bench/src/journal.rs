//! The journal of a run of studies: one line per finished case, written when it finishes.
//!
//! A study is cut into cases that know nothing of each other ([`Cases`](crate::studies::Cases)). What a case found is
//! appended to `journal.jsonl` and handed to the disk when it finishes, so a run that is killed, or whose disk is full,
//! loses the cases that it was working on (one, or where no times are measured one per core) and no other. The report
//! is made from the journal alone: taken up again, or put together from several machines, the same journal gives the
//! same report.
//!
//! The first line is a [`RunHeader`]; every further one a case: its study and name, the seconds that it took, and what
//! it found or why it failed. Every line ends with a checksum. A line that is not as it was written is said with its
//! number ([`Journal::damages`]), and its case is not finished: `--resume` sets the line aside and runs the case again.
//! A last line without an end was being written when the run died, and is dropped.
//!
//! A journal is open in one process at a time: its folder is locked until it is dropped.

mod kept;
pub mod line;
mod lock;
mod number;
mod shard;

pub use number::Number;
pub use shard::Shard;

use crate::error::BenchError;
use kept::Kept;
use lock::Lock;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Name of the file in the folder of a report.
pub const FILE_NAME: &str = "journal.jsonl";

/// Name of the file for lines that are not as they were written.
const SET_ASIDE: &str = "journal.damaged.jsonl";

/// The fact that names the scene file.
pub const SCENE: &str = "scene";

/// Facts that may differ between the parts of a journal: they say which machine, not which code.
const OF_THE_MACHINE: [&str; 5] = ["processor", "logical cores", "threads", "system", "shard"];

/// What a journal is about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunHeader {
    /// Names of the studies.
    pub studies: Vec<String>,
    /// Whether they are run on small sizes only.
    pub quick: bool,
    /// Commit, version, machine and whatever else the results depend on: names and values.
    pub facts: Vec<(String, String)>,
}

impl RunHeader {
    /// The scene file that the studies are asked of, if it is one of the user's own.
    pub fn scene(&self) -> Option<&str> {
        let fact = self.facts.iter().find(|(name, _)| name == SCENE);
        fact.map(|(_, path)| path.as_str())
    }

    /// The first fact in which results of the other would not belong here, but for the date and those called `besides`.
    fn differs(&self, other: &Self, besides: &[&str]) -> Option<String> {
        if self.quick != other.quick {
            return Some("other sizes (--quick or not)".into());
        }
        let value = |of: &Self, name: &str| {
            let fact = of.facts.iter().find(|(known, _)| known == name);
            fact.map(|(_, value)| value.clone())
        };
        let names = self.facts.iter().chain(&other.facts).map(|(name, _)| name);
        names
            .filter(|name| *name != "date" && !besides.contains(&name.as_str()))
            .find(|name| value(self, name) != value(other, name))
            .map(|name| {
                let show = |of| value(of, name).unwrap_or_else(|| "nothing".into());
                format!("another {name} (`{}`, not `{}`)", show(self), show(other))
            })
    }
}

/// One finished case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Entry {
    study: String,
    case: String,
    /// How long it took (s).
    seconds: f64,
    #[serde(flatten)]
    outcome: Recorded,
}

/// What came of it. That a method fails is a result like any other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Recorded {
    Found(Value),
    Failed(String),
}

/// The cases that are finished, and the file where more are kept.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    heading: RunHeader,
    entries: HashMap<(String, String), Entry>,
    /// Lines that were not as they had been written: which, and why.
    damages: Vec<String>,
    /// Why nothing can be written any more.
    broken: Option<BenchError>,
    _lock: Lock,
}

impl Journal {
    /// A new journal in `folder`. One that is there already gets the name `journal.old.jsonl`.
    pub fn begin(folder: &Path, heading: RunHeader) -> Result<Self, BenchError> {
        std::fs::create_dir_all(folder).map_err(|error| about(folder, &error))?;
        Self::begin_locked(folder, heading, Lock::take(folder)?)
    }

    fn begin_locked(folder: &Path, heading: RunHeader, lock: Lock) -> Result<Self, BenchError> {
        let path = folder.join(FILE_NAME);
        if path.exists() {
            let moved = std::fs::rename(&path, folder.join("journal.old.jsonl"));
            moved.map_err(|error| about(&path, &error))?;
        }
        let line = line::write(&heading)?;
        let kept = Kept {
            heading,
            entries: HashMap::new(),
            damages: Vec::new(),
        };
        let mut journal = Self::over(path, kept, lock)?;
        journal.append(&line)?;
        Ok(journal)
    }

    /// The journal that is in `folder`, to go on with; a new one if there is none. Damaged lines are set aside in
    /// `journal.damaged.jsonl`.
    ///
    /// # Errors
    /// [`BenchError::Failed`] if its results do not belong to `heading`: another commit, other sizes, another machine;
    /// if its heading cannot be read; or if another process works in the folder.
    pub fn resume(folder: &Path, heading: RunHeader) -> Result<Self, BenchError> {
        std::fs::create_dir_all(folder).map_err(|error| about(folder, &error))?;
        let lock = Lock::take(folder)?;
        let path = folder.join(FILE_NAME);
        if !path.exists() {
            return Self::begin_locked(folder, heading, lock);
        }
        let text = std::fs::read(&path).map_err(|error| about(&path, &error))?;
        let (mut kept, sorted) = Kept::read(&path, &text)?;
        if let Some(difference) = kept.heading.differs(&heading, &["shard"]) {
            return Err(BenchError::Failed(format!(
                "{}: made with {difference}; start anew without --resume",
                path.display()
            )));
        }
        kept.heading.studies = heading.studies;
        sorted.mend(folder, &text)?;
        Self::over(path, kept, lock)
    }

    /// With a file that takes more lines, made if there is none.
    fn over(path: PathBuf, kept: Kept, lock: Lock) -> Result<Self, BenchError> {
        let file = OpenOptions::new().append(true).create(true).open(&path);
        let file = file.map_err(|error| about(&path, &error))?;
        Ok(Self {
            path,
            file,
            heading: kept.heading,
            entries: kept.entries,
            damages: kept.damages,
            broken: None,
            _lock: lock,
        })
    }

    /// One journal in `folder` from those in other folders: the shards of one run.
    ///
    /// # Errors
    /// [`BenchError::Failed`] if one of them cannot be read, or if they are not parts of the same run; otherwise as
    /// [`Journal::begin`].
    pub fn merge(folder: &Path, parts: &[PathBuf]) -> Result<Self, BenchError> {
        let read = |part: &PathBuf| {
            let path = part.join(FILE_NAME);
            let text = std::fs::read(&path).map_err(|error| about(&path, &error))?;
            let (kept, _) = Kept::read(&path, &text)?;
            Ok::<_, BenchError>((path, kept))
        };
        let parts: Vec<(PathBuf, Kept)> = parts.iter().map(read).collect::<Result<_, _>>()?;
        let Some((first_path, first)) = parts.first() else {
            return Err(BenchError::Usage("no folder to merge".into()));
        };
        let mut heading = first.heading.clone();
        for (path, part) in &parts {
            if let Some(difference) = first.heading.differs(&part.heading, &OF_THE_MACHINE) {
                return Err(BenchError::Failed(format!(
                    "{}: made with {difference} than {}",
                    path.display(),
                    first_path.display()
                )));
            }
            for (name, value) in &part.heading.facts {
                let is_new = |known: &str| !known.split(" and ").any(|known| known == value);
                let fact = heading.facts.iter_mut().find(|(known, _)| known == name);
                if let Some((_, known)) = fact
                    && OF_THE_MACHINE.contains(&name.as_str())
                    && is_new(known)
                {
                    *known += " and ";
                    *known += value;
                }
            }
            for study in &part.heading.studies {
                if !heading.studies.contains(study) {
                    heading.studies.push(study.clone());
                }
            }
        }
        heading.facts.retain(|(name, _)| name != "shard");
        let mut journal = Self::begin(folder, heading)?;
        for (_, part) in parts {
            journal.damages.extend(part.damages);
            let mut entries: Vec<Entry> = part.entries.into_values().collect();
            entries.sort_by(|a, b| (&a.study, &a.case).cmp(&(&b.study, &b.case)));
            for entry in entries {
                journal.keep(entry)?;
            }
        }
        Ok(journal)
    }

    /// What it is about.
    pub fn heading(&self) -> &RunHeader {
        &self.heading
    }

    /// Lines that were not as they had been written: file, number and why.
    pub fn damages(&self) -> &[String] {
        &self.damages
    }

    /// Number of finished cases.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether no case is finished.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Time (s) that the finished cases have taken.
    pub fn seconds(&self) -> f64 {
        // In an order of its own, so that the sum is the same whatever was finished first.
        let mut seconds: Vec<f64> = self.entries.values().map(|entry| entry.seconds).collect();
        seconds.sort_by(f64::total_cmp);
        seconds.iter().sum()
    }

    /// Finished cases that failed: study, case and why, in the order of their names.
    pub fn failures(&self) -> Vec<[&str; 3]> {
        let mut failures = Vec::new();
        for entry in self.entries.values() {
            if let Recorded::Failed(message) = &entry.outcome {
                failures.push([&*entry.study, &*entry.case, &**message]);
            }
        }
        failures.sort_unstable();
        failures
    }

    /// Why no more can be written, if that is so.
    pub fn broken(&self) -> Option<&BenchError> {
        self.broken.as_ref()
    }

    /// What a finished case found, or why it failed.
    pub fn recall(&self, study: &str, case: &str) -> Option<Result<Value, BenchError>> {
        let entry = self.entries.get(&(study.to_owned(), case.to_owned()))?;
        Some(match &entry.outcome {
            Recorded::Found(value) => Ok(value.clone()),
            Recorded::Failed(message) => Err(BenchError::Failed(message.clone())),
        })
    }

    /// Keeps what a case found in `seconds`, or why it failed.
    pub fn record(
        &mut self,
        study: &str,
        case: &str,
        seconds: f64,
        outcome: Result<Value, String>,
    ) -> Result<(), BenchError> {
        self.keep(Entry {
            study: study.to_owned(),
            case: case.to_owned(),
            seconds,
            outcome: match outcome {
                Ok(value) => Recorded::Found(value),
                Err(message) => Recorded::Failed(message),
            },
        })
    }

    fn keep(&mut self, entry: Entry) -> Result<(), BenchError> {
        let line = line::write(&entry)?;
        self.append(&line)?;
        self.entries
            .insert((entry.study.clone(), entry.case.clone()), entry);
        Ok(())
    }

    /// Hands a line to the disk, in one piece.
    fn append(&mut self, line: &str) -> Result<(), BenchError> {
        if let Some(error) = &self.broken {
            return Err(error.clone());
        }
        let written = self.file.write_all(line.as_bytes());
        written
            .and_then(|()| self.file.sync_data())
            .map_err(|error| {
                let error = about(&self.path, &error);
                self.broken = Some(error.clone());
                error
            })
    }
}

fn about(path: &Path, error: &std::io::Error) -> BenchError {
    BenchError::Failed(format!("{}: {error}", path.display()))
}
