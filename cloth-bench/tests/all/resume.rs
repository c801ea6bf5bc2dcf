//! A run of studies that is killed, taken up again, or shared among machines gives what an unbroken one gives. What
//! failed in it is said.

use cloth_bench::journal::{Journal, RunHeader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

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

/// Kills a run three times, each time when some more cases are finished. Returns the journal, or nothing where it ended
/// before a kill came.
fn killed_three_times(study: &str, out: &Path) -> Option<Vec<String>> {
    let mut kept: Vec<String> = Vec::new();
    for round in 1..=3 {
        let mut child = program(&["study", study, "--quick", "--resume"], out)
            .spawn()
            .unwrap();
        while journal(out).len() < kept.len() + 2 && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(2));
        }
        // Once as a scheduler does it, without a chance to react the other times.
        if round == 2 {
            let id = child.id().to_string();
            Command::new("kill").args(["-TERM", &id]).status().unwrap();
        } else {
            child.kill().unwrap();
        }
        if child.wait().unwrap().success() {
            return None;
        }
        let now = journal(out);
        assert!(now.len() > kept.len() && now.starts_with(&kept));
        assert!(!out.join("report.html").exists());
        kept = now;
    }
    Some(kept)
}

#[test]
fn a_killed_run_is_taken_up_where_it_was() {
    const STUDY: &str = "sag";
    let (whole, broken) = (folder("whole"), folder("broken"));
    run(&["study", STUDY, "--quick"], &whole);
    let kept = loop {
        if let Some(kept) = killed_three_times(STUDY, &broken) {
            break kept;
        }
        folder("broken");
    };
    run(&["study", STUDY, "--quick", "--resume"], &broken);
    assert!(
        journal(&broken).starts_with(&kept),
        "a finished case was run again"
    );
    assert_eq!(cases(&broken), cases(&whole));
    for table in std::fs::read_dir(whole.join("data")).unwrap() {
        let table = PathBuf::from("data").join(table.unwrap().file_name());
        let (broken, whole) = (broken.join(&table), whole.join(&table));
        assert_eq!(
            std::fs::read(broken).unwrap(),
            std::fs::read(whole).unwrap()
        );
    }
    // The report is made of the journal alone.
    let report = read(&broken, "report.html");
    run(&["study", STUDY, "--quick", "--resume"], &broken);
    assert_eq!(read(&broken, "report.html"), report);
}

/// No step is stable for explicit Euler: its three cases fail, which is a finding, but foretold, and no alarm.
#[test]
fn expected_failures_are_counted_and_listed_apart() {
    let out = folder("failed");
    let mut command = program(&["study", "energy", "--quick"], &out);
    let output = command.stdout(Stdio::piped()).output().unwrap();
    assert!(output.status.success());
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(
        told.contains("\n3 cases failed as expected: ") && !told.contains("cases failed: "),
        "{told}"
    );
    let manifest: serde_json::Value = serde_json::from_str(&read(&out, "manifest.json")).unwrap();
    for none in ["failed", "failed_cases"] {
        assert_eq!(manifest[none].as_array().unwrap().len(), 0);
    }
    let cases = manifest["expected_failures"].as_array().unwrap();
    assert_eq!(cases.len(), 3);
    for case in cases {
        assert_eq!(case["study"], "energy");
        assert!(case["case"].as_str().unwrap().ends_with("explicit-euler"));
        assert!(case["error"].as_str().unwrap().contains("is unstable"));
    }
}

/// What the program says on standard error, and its exit code.
fn refused(mut command: Command) -> (String, Option<i32>) {
    let output = command.stderr(Stdio::piped()).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    (told, output.status.code())
}

/// A file that must not grow any more stands for a disk that is full in the middle of the run, `/dev/full` for one that
/// is full at its end.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_and_what_is_finished_is_kept() {
    let study = ["study", STUDY, "--quick"];
    let resumed = ["study", STUDY, "--quick", "--resume"];
    let (whole, out) = (folder("with-room"), folder("full"));
    run(&study, &whole);
    // Room for 2 kB, which is less than the journal takes; the signal that comes with the error is not for programs
    // that handle it.
    let mut command = Command::new("sh");
    let limited = "trap '' XFSZ; ulimit -f 4; exec \"$@\"";
    command.args(["-c", limited, "sh", env!("CARGO_BIN_EXE_cloth-bench")]);
    command.args(study).arg("--out").arg(&out);
    let (told, code) = refused(command);
    assert_eq!(code, Some(1), "{told}");
    assert!(told.contains("journal.jsonl: File too large"), "{told}");
    let kept = journal(&out);
    assert!(kept.len() > 2 && kept.len() < journal(&whole).len());
    // Room again, but none for the report: every case is finished and stays so.
    let report = out.join("report.html");
    std::os::unix::fs::symlink("/dev/full", &report).unwrap();
    let (told, code) = refused(program(&resumed, &out));
    assert_eq!(code, Some(1), "{told}");
    assert!(told.contains("report.html: No space left"), "{told}");
    let all = journal(&out);
    assert!(all.starts_with(&kept) && cases(&out) == cases(&whole));
    std::fs::remove_file(&report).unwrap();
    run(&resumed, &out);
    assert_eq!(journal(&out), all, "a finished case was run again");
    let table = "data/xpbd-floor.csv";
    assert_eq!(read(&out, table), read(&whole, table));
}

/// An entry that is still JSON, but not what was written.
#[test]
fn a_damaged_entry_is_said_and_its_case_run_again() {
    let study = ["study", STUDY, "--quick"];
    let resumed = ["study", STUDY, "--quick", "--resume"];
    let (whole, out, joined) = (folder("sound"), folder("damaged"), folder("damaged-joined"));
    run(&study, &whole);
    let lines = journal(&whole);
    let table = "data/xpbd-floor.csv";
    for (number, sound, damaged) in [
        (2, "\"order\"", "\"ordep\""),
        (4, "k = 200 N/m", "k = 300 N/m"),
        (5, "\"found\"", "\"fount\""),
        (
            9,
            "sweeps: objective error\":",
            "sweeps: objective error\":1",
        ),
    ] {
        let mut changed = lines.clone();
        changed[number - 1] = changed[number - 1].replace(sound, damaged);
        assert_ne!(changed, lines);
        std::fs::create_dir_all(&out).unwrap();
        std::fs::write(out.join("journal.jsonl"), changed.join("\n") + "\n").unwrap();
        // Joined, its case is missing.
        let place = format!("journal.jsonl:{number}: a damaged entry");
        let merge = ["merge", out.to_str().unwrap()];
        let (told, code) = refused(program(&merge, &joined));
        assert_eq!(code, Some(1), "{told}");
        assert!(
            told.contains(&place) && told.contains("1 cases are in none"),
            "{told}"
        );
        let (told, code) = refused(program(&resumed, &out));
        assert_eq!(code, Some(0), "{told}");
        assert!(told.contains(&place), "{told}");
        assert_eq!(cases(&out), cases(&whole));
        assert_eq!(read(&out, table), read(&whole, table));
    }
}

#[test]
fn two_runs_do_not_share_a_folder() {
    let out = folder("shared");
    let heading = RunHeader {
        studies: vec![STUDY.into()],
        quick: true,
        facts: Vec::new(),
    };
    let held = Journal::begin(&out, heading).unwrap();
    for more in [&["--resume"][..], &[]] {
        let (told, code) = refused(program(
            &[&["study", STUDY, "--quick"], more].concat(),
            &out,
        ));
        assert_eq!(code, Some(1), "{told}");
        let process = format!(
            "another run works in this folder (process {})",
            std::process::id()
        );
        assert!(told.contains(&process) && told.contains("--out"), "{told}");
    }
    assert_eq!(journal(&out).len(), 1);
    drop(held);
    run(&["study", STUDY, "--quick"], &out);
}

/// The journal has room, the report has not: an earlier one stays as it was.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_no_part_of_a_report() {
    let study = ["study", STUDY, "--quick"];
    let out = folder("cut-off");
    let mut earlier = None;
    for _ in 0..2 {
        let mut command = Command::new("sh");
        let limited = "trap '' XFSZ; ulimit -f 40; exec \"$@\"";
        command.args(["-c", limited, "sh", env!("CARGO_BIN_EXE_cloth-bench")]);
        command.args(study).arg("--out").arg(&out);
        let (told, code) = refused(command);
        assert_eq!(code, Some(1), "{told}");
        assert!(told.contains("File too large"), "{told}");
        assert_eq!(
            std::fs::read_to_string(out.join("report.html")).ok(),
            earlier
        );
        let parts = std::fs::read_dir(&out)
            .unwrap()
            .map(|file| file.unwrap().path());
        assert!(
            parts
                .into_iter()
                .all(|path| path.extension().is_none_or(|e| e != "part"))
        );
        run(&study, &out);
        earlier = Some(read(&out, "report.html"));
    }
}

#[test]
fn studies_of_a_scene_of_ones_own() {
    let out = folder("own-scene");
    std::fs::create_dir_all(&out).unwrap();
    let path = out.join("hammock.toml");
    let text = "[[mesh]]\ngenerator = \"grid:7x9:alternating\"\n[cloth]\nstiffness = 3000\n[[pins]]\nselect = \"corners\"\n";
    std::fs::write(&path, text).unwrap();
    let scene = path.to_str().unwrap();
    let study = ["study", "convergence", "--quick", "--scene", scene];
    run(&study, &out);
    let table = read(&out, "data/convergence-defaults.csv");
    let sizes: Vec<&str> = table
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').next())
        .collect();
    assert!(
        sizes.len() > 5 && sizes.iter().all(|size| *size == "hammock"),
        "{table}"
    );
    let newton = table
        .lines()
        .find(|line| line.starts_with("hammock,implicit-euler,"))
        .unwrap();
    let error: f64 = newton.split(',').nth(4).unwrap().parse().unwrap();
    // The square of the default tolerance.
    assert!(error.abs() < 1e-6, "{newton}");
    assert!(read(&out, "report.html").contains("study convergence --quick --scene "));
    assert!(
        out.join("plots/convergence-objective-time-hammock.svg")
            .exists()
    );
    // Another text is another scene: its cases do not belong to this run.
    std::fs::write(&path, text.replace("3000", "4000")).unwrap();
    let resumed = [&study[..], &["--resume"]].concat();
    let (told, code) = refused(program(&resumed, &out));
    assert!(
        code == Some(1) && told.contains("contents of the scene"),
        "{code:?} {told}"
    );
    // What cannot be compared is refused before anything is run.
    std::fs::write(&path, format!("{text}[air]\n")).unwrap();
    let (told, code) = refused(program(&study, &out));
    assert!(
        code == Some(2) && told.contains("contact, air or moving pins"),
        "{code:?} {told}"
    );
    let (told, code) = refused(program(&["study", "sag", "--scene", scene], &out));
    assert!(
        code == Some(2) && told.contains("no meaning for study `sag`"),
        "{code:?} {told}"
    );
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
