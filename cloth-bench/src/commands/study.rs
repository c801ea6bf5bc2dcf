//! `cloth-bench study [NAME…]`

use super::{print, write_file};
use crate::error::BenchError;
use crate::report::facts;
use crate::report::html::Report;
use crate::studies::{Findings, STUDIES, Scope, Study};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::Instant;

/// Arguments of `study`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The studies (see list); all of them if none is named
    names: Vec<String>,
    /// Small sizes only
    #[arg(long)]
    quick: bool,
    /// Folder for report.html, data, plots and manifest.json
    #[arg(long, default_value = "cloth-report", value_name = "DIR")]
    out: PathBuf,
    /// The tables on standard output too, besides the verdicts
    #[arg(long, conflicts_with = "json")]
    tables: bool,
    /// One JSON object on standard output instead of text
    #[arg(long)]
    json: bool,
}

pub(super) fn execute(arguments: &Arguments) -> Result<(), BenchError> {
    let studies: Vec<&Study> = if arguments.names.is_empty() {
        STUDIES.to_vec()
    } else {
        arguments
            .names
            .iter()
            .map(|name| Study::find(name))
            .collect::<Result<_, _>>()?
    };
    let scope = if arguments.quick {
        Scope::Quick
    } else {
        Scope::Full
    };
    // A folder that cannot be written to is found out now and not at the end.
    write_file(&arguments.out.join("manifest.json"), b"{}")?;
    let started = Instant::now();
    let bar = progress_bar(studies.iter().map(|study| study.cases(scope)).sum());
    let mut done: Vec<(&Study, Findings)> = Vec::new();
    let mut failed: Vec<(&str, BenchError)> = Vec::new();
    for study in studies {
        let mut first = true;
        let mut progress = |case: &str| {
            if !std::mem::take(&mut first) {
                bar.inc(1);
            }
            bar.set_message(case.to_owned());
            if bar.is_hidden() {
                eprintln!("{case}");
            }
        };
        match study.run(scope, &mut progress) {
            Ok(findings) => done.push((study, findings)),
            Err(error) => failed.push((study.name, error)),
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    write_report(arguments, &done, &failed, started.elapsed().as_secs_f64())?;
    let names: Vec<&str> = done.iter().map(|(study, _)| study.name).collect();
    let failures: Vec<&str> = failed.iter().map(|(name, _)| *name).collect();
    if arguments.json {
        print(&json!({"studies": names, "failed": failures, "out": arguments.out}).to_string())?;
    } else {
        for (study, findings) in &done {
            if arguments.tables {
                for (caption, table) in &findings.section.tables {
                    print(&format!("{caption}\n{}", table.to_text()))?;
                }
            }
            print(&format!(
                "{}: {}",
                study.name,
                findings
                    .section
                    .verdict
                    .as_deref()
                    .unwrap_or("see the report")
            ))?;
        }
        print(&format!(
            "report: {}",
            arguments.out.join("report.html").display()
        ))?;
    }
    match failed.first() {
        None => Ok(()),
        Some((name, error)) => Err(BenchError::Failed(format!("study `{name}`: {error}"))),
    }
}

fn progress_bar(cases: u64) -> ProgressBar {
    let style =
        ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed}, {eta} left  {wide_msg}");
    ProgressBar::new(cases).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

fn write_report(
    arguments: &Arguments,
    done: &[(&Study, Findings)],
    failed: &[(&str, BenchError)],
    seconds: f64,
) -> Result<(), BenchError> {
    let mut facts = facts::collect();
    facts.push((
        "scope".into(),
        if arguments.quick { "quick" } else { "full" }.into(),
    ));
    facts.push(("time".into(), format!("{seconds:.0} s")));
    let mut files = Vec::new();
    let mut keep = |name: String, content: &[u8]| {
        write_file(&arguments.out.join(&name), content)?;
        files.push(name);
        Ok::<(), BenchError>(())
    };
    let mut report = Report {
        title: "Cloth: the methods, side by side".into(),
        facts,
        sections: Vec::new(),
    };
    for (_, findings) in done {
        for (name, table) in &findings.data {
            keep(format!("data/{name}.csv"), table.to_csv().as_bytes())?;
        }
        for (name, svg) in &findings.plots {
            keep(format!("plots/{name}.svg"), svg.as_bytes())?;
        }
        report.sections.push(findings.section.clone());
    }
    keep("report.html".into(), report.to_html().as_bytes())?;
    let facts: serde_json::Map<String, Value> = report
        .facts
        .iter()
        .map(|(name, value)| (name.clone(), json!(value)))
        .collect();
    let failures: Vec<Value> = failed
        .iter()
        .map(|(name, error)| json!({"study": name, "error": error.to_string()}))
        .collect();
    let names: Vec<&str> = done.iter().map(|(study, _)| study.name).collect();
    let manifest = json!({"studies": names, "failed": failures, "facts": facts, "files": files, "seconds": seconds});
    let text = serde_json::to_string_pretty(&manifest).map_err(BenchError::failed)?;
    write_file(&arguments.out.join("manifest.json"), text.as_bytes())
}
