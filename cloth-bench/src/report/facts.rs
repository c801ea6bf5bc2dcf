//! The circumstances of a result: which code, on which machine.

use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// Name and value of everything that should be known about a run: date, commit, package version,
/// build, compiler, processor, cores, threads, operating system.
///
/// Commit and compiler are asked from `git` and `rustc` when this is called. They are those of
/// the working copy that the program was built in, if it still exists, else `unknown`.
pub fn collect() -> Vec<(String, String)> {
    let unknown = || "unknown".to_owned();
    let profile = if cfg!(debug_assertions) {
        "debug"
    } else {
        "release"
    };
    let cores = std::thread::available_parallelism().map_or_else(|_| unknown(), |n| n.to_string());
    [
        ("date", date(seconds_now()) + " (UTC)"),
        ("commit", commit().unwrap_or_else(unknown)),
        (
            "version",
            format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION")),
        ),
        ("build", format!("{profile}, {}", instructions())),
        (
            "compiler",
            answer(Command::new("rustc").arg("--version")).unwrap_or_else(unknown),
        ),
        ("processor", processor().unwrap_or_else(unknown)),
        ("logical cores", cores),
        ("threads", rayon::current_num_threads().to_string()),
        (
            "system",
            format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        ),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// The short hash of the checked-out commit, with `+dirty` if tracked files differ from it.
pub fn commit() -> Option<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let git =
        |arguments: &[&str]| answer(Command::new("git").arg("-C").arg(folder).args(arguments));
    let hash = git(&["rev-parse", "--short", "HEAD"])?;
    let changes = git(&["status", "--porcelain", "--untracked-files=no"])?;
    Some(if changes.is_empty() {
        hash
    } else {
        hash + "+dirty"
    })
}

/// What a program printed, without blanks around it; `None` if it failed or does not exist.
fn answer(command: &mut Command) -> Option<String> {
    let output = command
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// The widest vector instructions that the compiler was allowed to use everywhere.
fn instructions() -> &'static str {
    if cfg!(target_feature = "avx512f") {
        "AVX-512 throughout"
    } else if cfg!(target_feature = "avx2") {
        "AVX2 throughout"
    } else {
        "baseline instructions"
    }
}

fn processor() -> Option<String> {
    model(&std::fs::read_to_string("/proc/cpuinfo").ok()?)
}

/// The model in the text of `/proc/cpuinfo`.
pub fn model(cpuinfo: &str) -> Option<String> {
    let names = ["model name", "Processor", "Model", "cpu model"];
    let value = |name| {
        let lines = cpuinfo.lines().filter_map(|line| line.split_once(':'));
        lines
            .into_iter()
            .find(|(key, _)| key.trim() == name)
            .map(|(_, value)| value.trim().to_owned())
    };
    names
        .into_iter()
        .find_map(value)
        .filter(|model| !model.is_empty())
}

fn seconds_now() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs())
}

/// `seconds` after the start of 1970 as `2026-02-28 13:05`.
pub fn date(seconds: u64) -> String {
    // Count years from 1 March 0000: the leap day is then the last day of the year, and eras of
    // 400 years all have 146 097 days (Hinnant, "chrono-compatible low-level date algorithms").
    let days = seconds / 86_400 + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (month, carry) = if month < 10 {
        (month + 3, 0)
    } else {
        (month - 9, 1)
    };
    let year = era * 400 + year + carry;
    let (hour, minute) = (seconds / 3_600 % 24, seconds / 60 % 60);
    format!("{year}-{month:02}-{day:02} {hour:02}:{minute:02}")
}
