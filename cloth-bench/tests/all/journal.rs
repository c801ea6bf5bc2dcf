//! The journal of a run, torn, damaged, locked, and put together from parts.

mod line;
mod number;
mod shard;

use cloth_bench::journal::{FILE_NAME, Journal, RunHeader};
use serde_json::json;
use std::path::{Path, PathBuf};

fn heading(commit: &str) -> RunHeader {
    let facts = [("date", "today"), ("commit", commit), ("threads", "2")];
    RunHeader {
        studies: vec!["one".into()],
        quick: true,
        facts: facts
            .map(|(name, value)| (name.into(), value.into()))
            .into(),
    }
}

/// A folder of its own for each test.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("cloth-journal-{name}-{}", std::process::id()));
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

/// Cut off at every single byte, the journal has every case whose line was whole, with the same bits, and takes
/// more.
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
    let full = RunHeader {
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

/// Still JSON or not: its line is named and set aside, its case is to be run again, and all others stay.
#[test]
fn a_damaged_entry_is_named_and_set_aside() {
    let place = folder("damaged");
    drop(filled(&place));
    let path = place.join(FILE_NAME);
    let text = std::fs::read_to_string(&path).unwrap();
    for (number, (sound, damaged)) in [
        ("case 1\"", "case 1"),
        ("case 1\"", "case 7\""),
        ("\"found\":{\"error\":0.1}", "\"found\":{\"error\":0.9}"),
        (
            "\"seconds\":0.25,\"found\":{\"error\":0.1}",
            "\"seconds\":0.25,\"fount\":{\"error\":0.1}",
        ),
    ]
    .into_iter()
    .enumerate()
    {
        assert!(text.contains(sound));
        std::fs::write(&path, text.replace(sound, damaged)).unwrap();
        let joined = place.join("joined");
        let merged = Journal::merge(&joined, std::slice::from_ref(&place)).unwrap();
        let resumed = Journal::resume(&place, heading("a")).unwrap();
        for journal in [&merged, &resumed] {
            let [damage] = journal.damages() else {
                panic!("{:?}", journal.damages());
            };
            assert!(
                damage.contains("journal.jsonl:3: a damaged entry"),
                "{damage}"
            );
            assert_eq!(journal.len(), 4);
            assert!(journal.recall("one", "case 1").is_none());
        }
        drop(resumed);
        let aside = std::fs::read_to_string(place.join("journal.damaged.jsonl")).unwrap();
        assert_eq!(aside.lines().count(), number + 1);
        assert!(aside.lines().last().unwrap().contains(damaged), "{aside}");
        // It is said once.
        assert!(
            Journal::resume(&place, heading("a"))
                .unwrap()
                .damages()
                .is_empty()
        );
    }
    std::fs::write(&path, text.replacen("\"quick\":true", "\"quick\":false", 1)).unwrap();
    let error = Journal::resume(&place, heading("a")).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("journal.jsonl:1: the heading is damaged"),
        "{error}"
    );
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn a_folder_belongs_to_one_at_a_time() {
    let place = folder("locked");
    let first = filled(&place);
    for second in [
        Journal::begin(&place, heading("a")),
        Journal::resume(&place, heading("a")),
        Journal::merge(&place, std::slice::from_ref(&place)),
    ] {
        let told = second.unwrap_err().to_string();
        let process = format!("(process {})", std::process::id());
        assert!(
            told.contains("another run works in this folder") && told.contains(&process),
            "{told}"
        );
    }
    drop(first);
    assert_eq!(Journal::resume(&place, heading("a")).unwrap().len(), 5);
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
