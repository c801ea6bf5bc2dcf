//! `cloth-bench study [NAME…]`

use super::{print, write_file};
use crate::error::BenchError;
use crate::hash::fnv1a;
use crate::journal::{self, Journal, RunHeader, Shard};
use crate::report::html::Report;
use crate::report::png::Rasterizer;
use crate::report::table::Table;
use crate::report::{arrow, facts};
use crate::studies::{Findings, Progress, STUDIES, Scope, Share, Study, is_expected};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use itertools::Itertools;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Arguments of `study`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The studies (see list); all of them if none is named
    names: Vec<String>,
    /// A scene file of your own in the place of the hanging sheet: for `convergence` and `work-precision`
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Small sizes only
    #[arg(long)]
    quick: bool,
    /// Goes on where a run with the same output folder was cut off; finished cases are not run again
    #[arg(long)]
    resume: bool,
    /// Runs the I-th of N parts of the cases, without a report; `merge` joins the parts
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    #[command(flatten)]
    output: Output,
}

/// Where the report goes, and what is printed.
#[derive(Debug, Args)]
pub(super) struct Output {
    /// Folder for report.html, data, plots, manifest.json and the journal of finished cases
    #[arg(long, default_value = "cloth-report", value_name = "DIR")]
    pub(super) out: PathBuf,
    /// The plots also as PNG; needs the feature plots-as-png
    #[arg(long)]
    png: bool,
    /// The tables on standard output too, besides the verdicts
    #[arg(long, conflicts_with = "json")]
    tables: bool,
    /// One JSON object on standard output instead of text
    #[arg(long)]
    json: bool,
}

impl Output {
    /// Refuses what cannot be written, before anything is run.
    ///
    /// # Errors
    /// [`BenchError::Usage`] for plots as PNG without the feature, or without a font.
    pub(super) fn check(&self) -> Result<(), BenchError> {
        self.png.then(Rasterizer::new).transpose().map(|_| ())
    }
}

pub(super) fn execute(arguments: &Arguments) -> Result<(), BenchError> {
    let studies: Vec<&Study> = if arguments.names.is_empty() {
        STUDIES.to_vec()
    } else {
        // In the order of the report, and each once.
        let asked = arguments.names.iter().map(|name| Study::find(name));
        let asked: Vec<&Study> = asked.collect::<Result<_, _>>()?;
        let is_asked = |study: &&Study| asked.iter().any(|other| other.name == study.name);
        STUDIES.iter().copied().filter(is_asked).collect()
    };
    let mut facts = facts::collect();
    if let Some(shard) = arguments.shard {
        facts.push(("shard".into(), shard.to_string()));
    }
    if let Some(path) = &arguments.scene {
        facts.extend(own_scene(path, &studies)?);
    }
    arguments.output.check()?;
    let heading = RunHeader {
        studies: studies.iter().map(|study| study.name.to_owned()).collect(),
        quick: arguments.quick,
        facts,
    };
    let out = &arguments.output.out;
    let journal = if arguments.resume {
        Journal::resume(out, heading)?
    } else {
        Journal::begin(out, heading)?
    };
    let share = arguments.shard.map_or(Share::All, Share::One);
    conclude(&arguments.output, &studies, journal, share)
}

/// The facts of a run on a scene file: its path, and what tells whether it is still the same when the run is taken up
/// again.
fn own_scene(path: &Path, studies: &[&Study]) -> Result<[(String, String); 2], BenchError> {
    if let Some(other) = studies.iter().find(|study| !study.takes_a_scene()) {
        let known = STUDIES.iter().filter(|s| s.takes_a_scene());
        return Err(BenchError::Usage(format!(
            "--scene has no meaning for study `{}`; name studies that take one: {}",
            other.name,
            known.map(|s| s.name).join(", ")
        )));
    }
    crate::studies::check_scene(path)?;
    let text = std::fs::read(path)
        .map_err(|error| BenchError::Usage(format!("{}: {error}", path.display())))?;
    let contents = ("contents of the scene", format!("{:016x}", fnv1a(text)));
    let facts = [(journal::SCENE, path.display().to_string()), contents];
    Ok(facts.map(|(name, value)| (name.to_owned(), value)))
}

/// Runs what is not in the journal and falls to this run; writes the report, if this run is all of it.
pub(super) fn conclude(
    output: &Output,
    studies: &[&Study],
    mut journal: Journal,
    share: Share,
) -> Result<(), BenchError> {
    for damage in journal.damages() {
        eprintln!("warning: {damage}");
    }
    let scope = [Scope::Full, Scope::Quick][usize::from(journal.heading().quick)];
    let own = journal.heading().scene().map(Path::new);
    let bar = progress_bar(studies.iter().map(|study| study.cases(scope, own)).sum());
    let mut first = true;
    let mut progress = |now: Progress<'_>| {
        let (Progress::Case(case) | Progress::Part(case)) = now;
        if matches!(now, Progress::Case(_)) && !std::mem::take(&mut first) {
            bar.inc(1);
        }
        bar.set_message(case.to_owned());
        if bar.is_hidden() {
            eprintln!("{case}");
        }
    };
    let mut done: Vec<(&Study, Findings)> = Vec::new();
    let mut failed: Vec<(&str, BenchError)> = Vec::new();
    let mut missing: Vec<String> = Vec::new();
    for study in studies {
        match study.run(scope, &mut journal, share, &mut progress) {
            Ok((findings, left_out)) => {
                let named = |case: &String| format!("{}: {case}", study.name);
                missing.extend(left_out.iter().map(named));
                done.push((study, findings));
            }
            // Nothing more can be kept; what has been is safe.
            Err(error) if journal.broken().is_some() => return Err(error),
            Err(error) => failed.push((study.name, error)),
        }
    }
    bar.finish_and_clear();
    match share {
        Share::One(shard) => {
            finish_shard(output, &journal, shard, missing.len())?;
            return failed.first().map_or(Ok(()), failure);
        }
        Share::Nothing if !missing.is_empty() => {
            return Err(BenchError::Failed(format!(
                "{} cases are in none of the folders: {}",
                missing.len(),
                missing.join("; ")
            )));
        }
        _ => {}
    }
    write_report(output, &journal, &done, &failed)?;
    let names = done.iter().map(|(study, _)| study.name).collect_vec();
    let failures = failed.iter().map(|(name, _)| *name).collect_vec();
    if output.json {
        print(&json!({"studies": names, "failed": failures, "out": output.out}).to_string())?;
    } else {
        let failures = journal.failures();
        let expected = failures
            .iter()
            .filter(|[.., error]| is_expected(error))
            .count();
        print_verdicts(output, &done, expected, failures.len() - expected)?;
    }
    failed.first().map_or(Ok(()), failure)
}

fn failure((name, error): &(&str, BenchError)) -> Result<(), BenchError> {
    Err(BenchError::Failed(format!("study `{name}`: {error}")))
}

fn finish_shard(
    output: &Output,
    journal: &Journal,
    shard: Shard,
    others: usize,
) -> Result<(), BenchError> {
    if output.json {
        let studies = &journal.heading().studies;
        let none: [&str; 0] = [];
        return print(
            &json!({
                "studies": studies, "failed": none, "out": output.out,
                "shard": shard.to_string(), "cases": journal.len(), "cases_of_others": others,
            })
            .to_string(),
        );
    }
    print(&format!(
        "shard {shard}: {} cases finished, {others} left to the others; `merge` joins {} with theirs",
        journal.len(),
        output.out.display()
    ))
}

fn print_verdicts(
    output: &Output,
    done: &[(&Study, Findings)],
    expected: usize,
    failures: usize,
) -> Result<(), BenchError> {
    for told in done.iter().flat_map(|(_, findings)| &findings.answers) {
        let table = told.table.as_ref().map_or(String::new(), Table::to_text);
        let lines = std::iter::once(told.answer.as_str()).chain(table.lines());
        let lines: String = lines.map(|line| format!("\n  {line}")).collect();
        print(&format!("{}{lines}", told.question))?;
    }
    for (study, Findings { section, .. }) in done {
        if output.tables {
            for (_, caption, table) in &section.tables {
                print(&format!("{caption}\n{}", table.to_text()))?;
            }
        }
        let verdict = section.verdict.as_deref().unwrap_or("see the report");
        print(&format!("{}: {verdict}", study.name))?;
    }
    if expected > 0 {
        print(&format!(
            "{expected} cases failed as expected: no step is stable for their method"
        ))?;
    }
    if failures > 0 {
        print(&format!(
            "{failures} cases failed: manifest.json lists them, the remarks of their studies say why"
        ))?;
    }
    let report = output.out.join("report.html");
    print(&format!("report: {}", report.display()))
}

fn progress_bar(cases: usize) -> ProgressBar {
    let style =
        ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed}, {eta} left  {wide_msg}");
    ProgressBar::new(cases as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// Everything in it comes from the journal.
fn write_report(
    output: &Output,
    journal: &Journal,
    done: &[(&Study, Findings)],
    failed: &[(&str, BenchError)],
) -> Result<(), BenchError> {
    let out = &output.out;
    let rasterizer = output.png.then(Rasterizer::new).transpose()?;
    let seconds = journal.seconds();
    let mut facts = journal.heading().facts.clone();
    let scope = ["full", "quick"][usize::from(journal.heading().quick)];
    facts.push(("scope".into(), scope.into()));
    facts.push(("time of all cases".into(), format!("{seconds:.0} s")));
    let mut files = Vec::new();
    let mut keep = |name: String, content: &[u8]| {
        write_file(&out.join(&name), content)?;
        files.push(name);
        Ok::<(), BenchError>(())
    };
    let mut report = Report {
        title: "Cloth: the methods, side by side".into(),
        facts,
        answers: Vec::new(),
        sections: Vec::new(),
    };
    for (_, findings) in done {
        // Where every case has failed there is none; the remarks of the study say why.
        for (name, table) in findings.data.iter().filter(|(_, t)| !t.rows.is_empty()) {
            keep(format!("data/{name}.csv"), table.to_csv().as_bytes())?;
        }
        for (name, svg) in &findings.section.plots {
            keep(format!("plots/{name}.svg"), svg.as_bytes())?;
            if let Some(rasterizer) = &rasterizer {
                keep(format!("plots/{name}.png"), &rasterizer.png(svg)?)?;
            }
        }
        report.answers.extend(findings.answers.iter().cloned());
        report.sections.push(findings.section.clone());
    }
    let tables = done.iter().flat_map(|(study, findings)| {
        let tables = findings.data.iter();
        tables.map(|(name, table)| (study.name, name.as_str(), table))
    });
    keep("data/all.arrow".into(), &arrow::file(tables)?)?;
    keep("report.html".into(), report.to_html().as_bytes())?;
    let fact = |(name, value): &(String, String)| (name.clone(), json!(value));
    let facts: serde_json::Map<String, Value> = report.facts.iter().map(fact).collect();
    let failure =
        |(name, error): &(&str, BenchError)| json!({"study": name, "error": error.to_string()});
    let failures = failed.iter().map(failure).collect_vec();
    let names = done.iter().map(|(study, _)| study.name).collect_vec();
    let all = journal.failures();
    let failures_of = |wanted: bool| {
        let of_kind = all
            .iter()
            .filter(|[.., error]| is_expected(error) == wanted);
        let case = |[study, case, error]: &[&str; 3]| json!({"study": study, "case": case, "error": error});
        of_kind.map(case).collect_vec()
    };
    let manifest = json!({
        "studies": names, "failed": failures, "failed_cases": failures_of(false), "expected_failures": failures_of(true),
        "facts": facts, "files": files, "seconds": seconds,
    });
    let text = serde_json::to_string_pretty(&manifest)?;
    write_file(&out.join("manifest.json"), text.as_bytes())
}
