//! Studies whose cases fail.

mod cases;
mod collision;
mod contact;
mod convergence;
mod decision;
mod energy;
mod independence;
mod interleaved;
mod locking;
mod meshes_and_steps;
mod newton;
mod projective;
mod recovery;
mod sheets;
mod skip;
mod stability;
mod stiffness;
mod work_precision;
mod xpbd_floor;

use cloth_bench::error::BenchError;
use cloth_bench::journal::line::write;
use cloth_bench::journal::{FILE_NAME, Journal, RunHeader};
use cloth_bench::studies::{STUDIES, Scope, Share, Study};
use serde_json::json;

/// A study for whose cases nothing is run: those in `failed` have failed, all others have default values. Gives the
/// findings and the names of the others.
fn ended(study: &Study, failed: &[String]) -> Result<(String, Vec<String>), BenchError> {
    let folder = format!("cloth-studies-{}-{}", study.name, std::process::id());
    let folder = std::env::temp_dir().join(folder);
    let heading = RunHeader {
        studies: vec![study.name.into()],
        quick: true,
        facts: Vec::new(),
    };
    // As if the cases had been recorded, but in one piece: nothing waits for the disk.
    std::fs::create_dir_all(&folder)?;
    let mut lines = write(&heading)?;
    for case in failed {
        let message = format!("{case} diverged");
        let entry = json!({"study": study.name, "case": case, "seconds": 0.0, "failed": message});
        lines += &write(&entry)?;
    }
    std::fs::write(folder.join(FILE_NAME), lines)?;
    let mut journal = Journal::resume(&folder, heading)?;
    assert_eq!(journal.failures().len(), failed.len());
    let found = study.run(Scope::Quick, &mut journal, Share::Nothing, &mut |_| {});
    drop(journal);
    std::fs::remove_dir_all(&folder)?;
    let (findings, others) = found?;
    let text = serde_json::to_string(&findings)?;
    Ok((text, others))
}

/// Whether every second case fails, or the others do, or all: the study has a section that says so.
#[test]
fn a_failed_case_is_a_finding_of_its_study() {
    let mut aborted = Vec::new();
    for study in STUDIES {
        let (_, cases) = ended(study, &[]).unwrap();
        let every_second = |from| cases.iter().skip(from).step_by(2).cloned().collect();
        for failed in [every_second(0), every_second(1), cases.clone()] {
            let is_said = |text: &str| {
                failed
                    .iter()
                    .any(|case| text.contains(&format!("{case} diverged")))
            };
            match ended(study, &failed) {
                Ok((text, _)) if is_said(&text) => {}
                Ok(_) => aborted.push(format!("{}: no failure is said", study.name)),
                Err(error) => aborted.push(format!("{}: {error}", study.name)),
            }
        }
    }
    assert!(aborted.is_empty(), "{}", aborted.join("\n"));
}
