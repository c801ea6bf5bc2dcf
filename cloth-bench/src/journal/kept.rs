//! What a journal holds, read from its text.

use super::{Entry, FILE_NAME, RunHeader, SET_ASIDE, about, line};
use crate::error::BenchError;
use crate::files;
use std::collections::HashMap;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;

/// What a journal holds.
pub(super) struct Kept {
    pub(super) heading: RunHeader,
    pub(super) entries: HashMap<(String, String), Entry>,
    pub(super) damages: Vec<String>,
}

/// The lines of a journal's text that are as they were written, and those that are not.
#[derive(Default)]
pub(super) struct Sorted<'a> {
    sound: Vec<&'a [u8]>,
    damaged: Vec<&'a [u8]>,
}

impl Kept {
    /// What the text of the journal `path` says. What follows the last end of a line was being written when the run
    /// died.
    pub(super) fn read<'a>(path: &Path, text: &'a [u8]) -> Result<(Self, Sorted<'a>), BenchError> {
        let mut lines = text.split_inclusive(|&byte| byte == b'\n').enumerate();
        let whole = |line: &'a [u8]| line.strip_suffix(b"\n");
        let first = lines.next().map_or(&b""[..], |(_, line)| line);
        let heading = whole(first).ok_or_else(|| "it is cut off".to_owned());
        let heading = heading.and_then(line::read).map_err(|why| {
            BenchError::Failed(format!(
                "{}:1: the heading is damaged: {why}; start anew without --resume",
                path.display()
            ))
        })?;
        let mut kept = Self {
            heading,
            entries: HashMap::new(),
            damages: Vec::new(),
        };
        let mut sorted = Sorted::default();
        sorted.sound.push(first);
        for (number, line) in lines {
            let Some(content) = whole(line) else { break };
            match line::read::<Entry>(content) {
                Ok(entry) => {
                    sorted.sound.push(line);
                    let names = (entry.study.clone(), entry.case.clone());
                    kept.entries.insert(names, entry);
                }
                Err(why) => {
                    sorted.damaged.push(line);
                    kept.damages.push(format!(
                        "{}:{}: a damaged entry: {why}; its case counts as not run",
                        path.display(),
                        number + 1
                    ));
                }
            }
        }
        Ok((kept, sorted))
    }
}

impl Sorted<'_> {
    /// Leaves what is sound of `text` in the journal in `folder`, and puts what is damaged aside.
    pub(super) fn mend(&self, folder: &Path, text: &[u8]) -> Result<(), BenchError> {
        if !self.damaged.is_empty() {
            let aside = folder.join(SET_ASIDE);
            let file = OpenOptions::new().append(true).create(true).open(&aside);
            let put = file.and_then(|mut file| file.write_all(&self.damaged.concat()));
            put.map_err(|error| about(&aside, &error))?;
        }
        let sound = self.sound.concat();
        if sound == text {
            return Ok(());
        }
        let path = folder.join(FILE_NAME);
        files::write(&path, &[&sound]).map_err(|error| about(&path, &error))
    }
}
