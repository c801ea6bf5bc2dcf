//! A run of studies that is killed, taken up again, or shared among machines gives what an unbroken one gives.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A study without times in its tables: two runs of it give the same bytes.
const STUDY: &str = "xpbd-floor";

fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    path
}

fn program(arguments: &[&str], out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cloth-bench"));
    command.args(arguments).arg("--out").arg(out);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

fn run(arguments: &[&str], out: &Path) {
    assert!(program(arguments, out).status().unwrap().success());
}

fn read(out: &Path, file: &str) -> String {
    std::fs::read_to_string(out.join(file)).unwrap()
}

/// The lines of the journal that are whole.
fn journal(out: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(out.join("journal.jsonl")).unwrap_or_default();
    let end = text.rfind('\n').map_or(0, |end| end + 1);
    text[..end].lines().map(str::to_owned).collect()
}

/// The names of the cases, sorted.
fn cases(out: &Path) -> Vec<String> {
    let lines = journal(out);
    let case = |line: &String| {
        let entry: serde_json::Value = serde_json::from_str(line).unwrap();
        entry["case"].as_str().unwrap().to_owned()
    };
    let mut names: Vec<String> = lines[1..].iter().map(case).collect();
    names.sort();
    names
}

#[test]
fn a_killed_run_is_taken_up_where_it_was() {
    let (whole, broken) = (folder("whole"), folder("broken"));
    run(&["study", STUDY, "--quick"], &whole);
    let mut kept: Vec<String> = Vec::new();
    // Killed three times, each time when some more cases are finished.
    for round in 1..=3 {
        let mut child = program(&["study", STUDY, "--quick", "--resume"], &broken)
            .spawn()
            .unwrap();
        let started = Instant::now();
        while journal(&broken).len() < 1 + 2 * round && started.elapsed() < Duration::from_secs(60)
        {
            std::thread::sleep(Duration::from_millis(2));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let now = journal(&broken);
        assert!(now.len() > kept.len() && now.starts_with(&kept));
        assert!(!broken.join("report.html").exists());
        kept = now;
    }
    run(&["study", STUDY, "--quick", "--resume"], &broken);
    assert!(
        journal(&broken).starts_with(&kept),
        "a finished case was run again"
    );
    assert_eq!(cases(&broken), cases(&whole));
    let table = "data/xpbd-floor.csv";
    assert_eq!(read(&broken, table), read(&whole, table));
    // The report is made of the journal alone.
    let report = read(&broken, "report.html");
    run(&["study", STUDY, "--quick", "--resume"], &broken);
    assert_eq!(read(&broken, "report.html"), report);
}

#[test]
fn shards_joined_give_what_one_run_gives() {
    let parts = [folder("shard-1"), folder("shard-2")];
    let (joined, whole) = (folder("joined"), folder("unshared"));
    run(&["study", STUDY, "--quick"], &whole);
    run(&["study", STUDY, "--quick", "--shard", "1/2"], &parts[0]);
    let [one, other] = parts.each_ref().map(|part| part.to_str().unwrap());
    // Half of it is no report.
    assert!(!parts[0].join("report.html").exists());
    assert!(
        !program(&["merge", one], &joined)
            .status()
            .unwrap()
            .success()
    );
    run(&["study", STUDY, "--quick", "--shard", "2/2"], &parts[1]);
    run(&["merge", one, other], &joined);
    assert_eq!(cases(&joined), cases(&whole));
    assert_eq!(
        cases(&parts[0]).len() + cases(&parts[1]).len(),
        cases(&whole).len()
    );
    let table = "data/xpbd-floor.csv";
    assert_eq!(read(&joined, table), read(&whole, table));
}
