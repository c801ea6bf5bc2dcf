//! Damaged journals: what is read from one is what was written, or is said to be damaged.

use crate::{folder, fuzz};
use cloth_bench::journal::{FILE_NAME, Journal, RunHeader};
use std::process::{Command, Stdio};

#[test]
fn a_damaged_journal_loses_lines_and_never_changes_one() {
    let (whole, damaged) = (folder("journal"), folder("journal-damaged"));
    let mut study = Command::new(env!("CARGO_BIN_EXE_cloth-bench"));
    study
        .args(["study", "xpbd-floor", "--quick", "--out"])
        .arg(&whole);
    study.stdout(Stdio::null()).stderr(Stdio::null());
    assert!(study.status().unwrap().success());
    let text = std::fs::read(whole.join(FILE_NAME)).unwrap();
    let lines: Vec<&[u8]> = text.split_inclusive(|&byte| byte == b'\n').collect();
    let heading: RunHeader = serde_json::from_slice(lines[0]).unwrap();
    fuzz(500, |random| {
        let mut changed = text.clone();
        random.mutate(&mut changed);
        std::fs::write(damaged.join(FILE_NAME), &changed).unwrap();
        match Journal::resume(&damaged, heading.clone()) {
            Ok(journal) => {
                assert!(journal.len() < lines.len());
                drop(journal);
                let mended = std::fs::read(damaged.join(FILE_NAME)).unwrap();
                let kept = mended.split_inclusive(|&byte| byte == b'\n');
                for line in kept {
                    assert!(lines.contains(&line), "{}", String::from_utf8_lossy(line));
                }
            }
            // The heading is what tells whether the rest belongs here.
            Err(error) => assert!(!changed.starts_with(lines[0]), "{error}"),
        }
    });
}
