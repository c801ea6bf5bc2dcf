//! The journal of a run of studies: one line per finished case, written when it finishes.
//!
//! A study is cut into cases that know nothing of each other ([`Cases`](crate::studies::Cases)). What a case found is appended to
//! `journal.jsonl` and handed to the disk when it finishes, so a run that is killed, or whose disk is full, loses the cases that it was
//! working on (one, or where no times are measured one per core) and no other. The report is made from the journal alone: taken up again, or put together from several machines, the same journal gives
//! the same report.
//!
//! The first line is a [`Heading`]; every further one a case: its study and name, the seconds that it took, and what it found or why it failed. A last line without an end was being written when the run died, and is dropped.

use crate::error::BenchError;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Name of the file in the folder of a report.
pub const FILE_NAME: &str = "journal.jsonl";

/// The fact that names the scene file.
pub const SCENE: &str = "scene";

/// Facts that may differ between the parts of a journal: they say which machine, not which code.
const OF_THE_MACHINE: [&str; 5] = ["processor", "logical cores", "threads", "system", "shard"];

/// What a journal is about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Heading {
    /// Names of the studies.
    pub studies: Vec<String>,
    /// Whether they are run on small sizes only.
    pub quick: bool,
    /// Commit, version, machine and whatever else the results depend on: names and values.
    pub facts: Vec<(String, String)>,
}

impl Heading {
    /// The scene file that the studies are asked of, if it is one of the user's own.
    #[must_use]
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
    heading: Heading,
    entries: HashMap<(String, String), Entry>,
    /// Why nothing can be written any more.
    broken: Option<BenchError>,
}

impl Journal {
    /// A new journal in `folder`. One that is there already gets the name `journal.old.jsonl`.
    ///
    /// # Errors
    /// [`BenchError::Failed`] that names the file that cannot be written.
    pub fn begin(folder: &Path, heading: Heading) -> Result<Self, BenchError> {
        let path = folder.join(FILE_NAME);
        let failed = |error: std::io::Error| about(&path, &error);
        std::fs::create_dir_all(folder).map_err(failed)?;
        if path.exists() {
            std::fs::rename(&path, folder.join("journal.old.jsonl")).map_err(failed)?;
        }
        let file = File::create_new(&path).map_err(failed)?;
        let mut journal = Self {
            path,
            file,
            heading,
            entries: HashMap::new(),
            broken: None,
        };
        let line = serde_json::to_string(&journal.heading).map_err(BenchError::failed)?;
        journal.append(line)?;
        Ok(journal)
    }

    /// The journal that is in `folder`, to go on with; a new one if there is none.
    ///
    /// # Errors
    /// [`BenchError::Failed`] if its results do not belong to `heading`: another commit, other sizes, another machine; or if it cannot be read, with the line.
    pub fn resume(folder: &Path, heading: Heading) -> Result<Self, BenchError> {
        if !folder.join(FILE_NAME).exists() {
            return Self::begin(folder, heading);
        }
        let mut journal = Self::open(folder)?;
        if let Some(difference) = journal.heading.differs(&heading, &["shard"]) {
            return Err(BenchError::Failed(format!(
                "{}: made with {difference}; start anew without --resume",
                journal.path.display()
            )));
        }
        journal.heading.studies = heading.studies;
        Ok(journal)
    }

    /// One journal in `folder` from those in other folders: the shards of one run.
    ///
    /// # Errors
    /// [`BenchError::Failed`] if one of them cannot be read, or if they are not parts of the same run.
    pub fn merge(folder: &Path, parts: &[PathBuf]) -> Result<Self, BenchError> {
        let parts: Vec<Self> = parts
            .iter()
            .map(|part| Self::open(part))
            .collect::<Result<_, _>>()?;
        let Some(first) = parts.first() else {
            return Err(BenchError::Usage("no folder to merge".into()));
        };
        let mut heading = first.heading.clone();
        for part in &parts {
            if let Some(difference) = first.heading.differs(&part.heading, &OF_THE_MACHINE) {
                return Err(BenchError::Failed(format!(
                    "{}: made with {difference} than {}",
                    part.path.display(),
                    first.path.display()
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
        for part in parts {
            let mut entries: Vec<Entry> = part.entries.into_values().collect();
            entries.sort_by(|a, b| (&a.study, &a.case).cmp(&(&b.study, &b.case)));
            for entry in entries {
                journal.keep(entry)?;
            }
        }
        Ok(journal)
    }

    fn open(folder: &Path) -> Result<Self, BenchError> {
        let path = folder.join(FILE_NAME);
        let text = std::fs::read(&path).map_err(|error| about(&path, &error))?;
        // What follows the last end of a line was being written when the run died.
        let whole = text
            .iter()
            .rposition(|&byte| byte == b'\n')
            .map_or(0, |end| end + 1);
        let unreadable = |line: usize, error: &dyn std::fmt::Display| {
            BenchError::Failed(format!("{}:{line}: {error}", path.display()))
        };
        let mut lines = text[..whole].split(|&byte| byte == b'\n').enumerate();
        let (_, first) = lines.next().unwrap_or_default();
        let heading = serde_json::from_slice(first).map_err(|error| unreadable(1, &error))?;
        let mut entries = HashMap::new();
        for (number, line) in lines.filter(|(_, line)| !line.is_empty()) {
            let entry: Entry =
                serde_json::from_slice(line).map_err(|error| unreadable(number + 1, &error))?;
            entries.insert((entry.study.clone(), entry.case.clone()), entry);
        }
        let failed = |error: std::io::Error| about(&path, &error);
        let mut file = OpenOptions::new().write(true).open(&path).map_err(failed)?;
        file.set_len(whole as u64).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        Ok(Self {
            path,
            file,
            heading,
            entries,
            broken: None,
        })
    }

    /// What it is about.
    #[must_use]
    pub fn heading(&self) -> &Heading {
        &self.heading
    }

    /// Number of finished cases.
    #[must_use]
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether no case is finished.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Time (s) that the finished cases have taken.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        // In an order of its own, so that the sum is the same whatever was finished first.
        let mut seconds: Vec<f64> = self.entries.values().map(|entry| entry.seconds).collect();
        seconds.sort_by(f64::total_cmp);
        seconds.iter().sum()
    }

    /// Finished cases that failed: study, case and why, in the order of their names.
    #[must_use]
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
    #[must_use]
    pub fn broken(&self) -> Option<&BenchError> {
        self.broken.as_ref()
    }

    /// What a finished case found, or why it failed.
    pub(crate) fn recall(&self, study: &str, case: &str) -> Option<Result<Value, BenchError>> {
        let entry = self.entries.get(&(study.to_owned(), case.to_owned()))?;
        Some(match &entry.outcome {
            Recorded::Found(value) => Ok(value.clone()),
            Recorded::Failed(message) => Err(BenchError::Failed(message.clone())),
        })
    }

    /// Keeps what a case found in `seconds`, or why it failed.
    ///
    /// # Errors
    /// [`BenchError::Failed`] if the file cannot be written. Then nothing is written any more.
    pub(crate) fn record(
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
        let line = serde_json::to_string(&entry).map_err(BenchError::failed)?;
        self.append(line)?;
        self.entries
            .insert((entry.study.clone(), entry.case.clone()), entry);
        Ok(())
    }

    fn append(&mut self, mut line: String) -> Result<(), BenchError> {
        if let Some(error) = &self.broken {
            return Err(error.clone());
        }
        line.push('\n');
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

/// A number of a result that may be infinite or none, which JSON does not know: those are kept as text.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Number(pub f64);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0.is_finite() {
            self.0.serialize(serializer)
        } else {
            self.0.to_string().serialize(serializer)
        }
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Either {
            Number(f64),
            Text(String),
        }
        match Either::deserialize(deserializer)? {
            Either::Number(number) => Ok(Self(number)),
            Either::Text(text) => text.parse().map(Self).map_err(serde::de::Error::custom),
        }
    }
}

/// One of several runs that share the cases of the studies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which one, from 1.
    number: u64,
    /// Of how many.
    count: u64,
}

impl Shard {
    /// Whether a case falls to this one: by a hash of its names, the same on every machine and in every version.
    #[must_use]
    pub fn includes(&self, study: &str, case: &str) -> bool {
        // FNV-1a, with a byte between the names that neither has.
        let bytes = study.bytes().chain([0]).chain(case.bytes());
        let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        // The low bits of a product know little of its high ones.
        (hash ^ hash >> 32) % self.count == self.number - 1
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(number, count)| {
            Some((number.parse::<u64>().ok()?, count.parse::<u64>().ok()?))
        });
        match numbers {
            Some((number, count)) if 1 <= number && number <= count => Ok(Self { number, count }),
            _ => Err(format!(
                "`{text}` is not I/N with whole numbers 1 ≤ I ≤ N, such as 2/4"
            )),
        }
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn heading(commit: &str) -> Heading {
        let facts = [("date", "today"), ("commit", commit), ("threads", "2")];
        Heading {
            studies: vec!["one".into()],
            quick: true,
            facts: facts
                .map(|(name, value)| (name.into(), value.into()))
                .into(),
        }
    }

    /// A folder of its own for each test.
    fn folder(name: &str) -> PathBuf {
        let folder =
            std::env::temp_dir().join(format!("cloth-journal-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        folder
    }

    fn filled(folder: &Path) -> Journal {
        let mut journal = Journal::begin(folder, heading("a")).unwrap();
        for case in 0..5 {
            let outcome = if case == 3 {
                Err("diverged".to_owned())
            } else {
                Ok(json!({"error": 0.1 * f64::from(case)}))
            };
            let name = format!("case {case}");
            journal.record("one", &name, 0.25, outcome).unwrap();
        }
        journal
    }

    /// Cut off at every single byte, the journal has every case whose line was whole, with the same bits, and takes more.
    #[test]
    fn a_torn_journal_keeps_all_that_was_whole() {
        let place = folder("torn");
        drop(filled(&place));
        let path = place.join(FILE_NAME);
        let text = std::fs::read(&path).unwrap();
        let lines = |text: &[u8]| text.iter().filter(|&&byte| byte == b'\n').count();
        for end in 0..=text.len() {
            std::fs::write(&path, &text[..end]).unwrap();
            let whole = lines(&text[..end]);
            let resumed = Journal::resume(&place, heading("a"));
            if whole == 0 {
                // Not even the heading.
                assert!(resumed.is_err());
                continue;
            }
            let mut journal = resumed.unwrap();
            assert_eq!(journal.len(), whole - 1);
            for case in 0..whole - 1 {
                let found = journal.recall("one", &format!("case {case}")).unwrap();
                match (case, found) {
                    (3, Err(error)) => assert_eq!(error.to_string(), "diverged"),
                    (_, Ok(value)) => assert_eq!(value, json!({"error": 0.1 * case as f64})),
                    (_, Err(error)) => panic!("{error}"),
                }
            }
            journal.record("one", "more", 1.0, Ok(json!(1))).unwrap();
            drop(journal);
            let journal = Journal::resume(&place, heading("a")).unwrap();
            assert_eq!(journal.len(), whole);
        }
        std::fs::remove_dir_all(&place).unwrap();
    }

    #[test]
    fn results_of_other_code_or_sizes_are_not_taken_up() {
        let place = folder("other");
        drop(filled(&place));
        let refused = |heading| Journal::resume(&place, heading).unwrap_err().to_string();
        assert!(refused(heading("b")).contains("another commit (`a`, not `b`)"));
        let full = Heading {
            quick: false,
            ..heading("a")
        };
        assert!(refused(full).contains("other sizes"));
        // A date is no difference; and a new run keeps the old journal.
        let mut later = heading("a");
        later.facts[0].1 = "tomorrow".into();
        assert_eq!(Journal::resume(&place, later).unwrap().len(), 5);
        drop(Journal::begin(&place, heading("b")).unwrap());
        assert!(place.join("journal.old.jsonl").exists());
        std::fs::remove_dir_all(&place).unwrap();
    }

    #[test]
    fn a_line_that_is_none_is_named() {
        let place = folder("bad");
        drop(filled(&place));
        let path = place.join(FILE_NAME);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replace("case 1\"", "case 1")).unwrap();
        let error = Journal::resume(&place, heading("a")).unwrap_err();
        assert!(error.to_string().contains("journal.jsonl:3:"), "{error}");
        std::fs::remove_dir_all(&place).unwrap();
    }

    #[test]
    fn shards_are_joined_whatever_their_order() {
        let places = ["s1", "s2", "joined"].map(folder);
        for (place, threads) in places.iter().zip(["2", "4"]) {
            let mut heading = heading("a");
            heading.facts[2].1 = threads.into();
            let mut journal = Journal::begin(place, heading).unwrap();
            journal
                .record("one", threads, 0.5, Ok(json!(threads)))
                .unwrap();
        }
        let [one, other, joined] = &places;
        let texts = [[one, other], [other, one]].map(|parts| {
            let parts = parts.map(Clone::clone);
            let journal = Journal::merge(joined, &parts).unwrap();
            assert_eq!((journal.len(), journal.seconds()), (2, 1.0));
            journal.heading().facts[2].1.clone()
        });
        assert_eq!(texts, ["2 and 4", "4 and 2"]);
        let other_code = Journal::begin(other, heading("b")).unwrap();
        drop(other_code);
        let error = Journal::merge(joined, &[one.clone(), other.clone()]).unwrap_err();
        assert!(error.to_string().contains("another commit"), "{error}");
        for place in &places {
            std::fs::remove_dir_all(place).unwrap();
        }
    }

    /// Every case falls to exactly one shard, and the shards are about as large.
    #[test]
    fn shards_cut_the_cases_evenly() {
        let names: Vec<String> = (0..1000).map(|i| format!("case {i}")).collect();
        for count in [1_u64, 2, 3, 8] {
            let shards: Vec<Shard> = (1..=count).map(|number| Shard { number, count }).collect();
            let sizes = shards.iter().map(|shard| {
                names
                    .iter()
                    .filter(|name| shard.includes("study", name))
                    .count()
            });
            let sizes: Vec<usize> = sizes.collect();
            assert_eq!(sizes.iter().sum::<usize>(), 1000);
            let mean = 1000 / count as usize;
            assert!(sizes.iter().all(|&n| n.abs_diff(mean) < 70), "{sizes:?}");
        }
        assert_eq!(
            "2/4".parse(),
            Ok(Shard {
                number: 2,
                count: 4
            })
        );
        for text in ["0/2", "3/2", "1", "a/b", "1/0", ""] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_come_back_with_all_bits() {
        for number in [
            0.1,
            -0.0,
            5e-324,
            f64::MAX,
            1.0 / 3.0,
            f64::INFINITY,
            -f64::INFINITY,
        ] {
            let text = serde_json::to_string(&Number(number)).unwrap();
            let back: Number = serde_json::from_str(&text).unwrap();
            assert_eq!(back.0.to_bits(), number.to_bits());
        }
        let none: Number = serde_json::from_str("\"NaN\"").unwrap();
        assert!(none.0.is_nan());
    }
}
