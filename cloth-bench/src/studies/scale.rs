//! How large a cloth each method can simulate on this machine, and what a step of it costs.

use crate::memory;
use crate::studies::prelude::*;
use serde_json::Value;
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

pub(super) const STUDY: Study = Study {
    name: "scale",
    question: "How large a cloth does each method simulate on this machine, and what does a step of it cost in time and memory?",
    about: "The hanging sheet at default settings, larger and larger, three steps from rest and the count of crossings at their end, each size in a process of its own: so the memory is that of this cloth alone, and one that is too large takes nothing else along. A method goes on to the next size until a run takes longer than its \
        budget of time, or would if it took as long a vertex as the last, or until four times the memory of the last size would not leave a fifth of what the machine has free. Time of a step is the median of the three, setup is everything before the first step that belongs to the method; memory is the peak of \
        the process, program and mesh included. The line through the plot is a time proportional to the vertices. Expect sweeps and projections to follow it; factorisations grow faster in time and memory, and explicit steps grow with the power 1.5 because \
        a finer sheet needs shorter ones. How good these steps are is another question: see `convergence` and `independence`.",
    run,
};

/// Vertices a side.
const SIDES: [&[u32]; 2] = [&[12, 24], &[64, 128, 256, 512, 1000]];
/// Time that one size may take.
const BUDGET: [Duration; 2] = [Duration::from_secs(10), Duration::from_secs(60)];

const STEPS: u32 = 3;
/// What ends a method that gets through every size.
const ALL: &str = "the largest asked for";
/// No step of forward Euler is stable.
pub(super) const WITHOUT: &str = "explicit-euler";

fn methods() -> impl Iterator<Item = &'static Method> {
    method::all().filter(|method| method.name != WITHOUT)
}

/// One size that a method got through.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Size {
    side: u32,
    pub(super) ms_per_step: Real,
    setup_ms: Real,
    /// Bytes; not every system tells.
    pub(super) memory: Option<u64>,
}

/// How far a method came, and why not further.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Reach {
    sizes: Vec<Size>,
    end: String,
}

/// A size that a method got through.
#[derive(Default, Serialize)]
struct Row {
    method: &'static str,
    vertices_a_side: u32,
    vertices: usize,
    ms_per_step: Real,
    #[serde(rename = "µs per vertex and step")]
    per_vertex: Real,
    #[serde(rename = "setup (ms)")]
    setup: Real,
    #[serde(rename = "memory (MB)")]
    memory: Option<Real>,
    #[serde(rename = "memory per vertex (kB)")]
    memory_per_vertex: Option<Real>,
    /// Of the largest size.
    what_ended_it: String,
}

fn rows(method: &'static str, reach: &Reach) -> Vec<Row> {
    let row = |(number, size): (usize, &Size)| {
        let vertices = Real::from(size.side).powi(2);
        let is_last = number + 1 == reach.sizes.len();
        let bytes = size.memory.map(|bytes| bytes as Real);
        Row {
            method,
            vertices_a_side: size.side,
            vertices: vertices as usize,
            ms_per_step: size.ms_per_step,
            per_vertex: 1e3 * size.ms_per_step / vertices,
            setup: size.setup_ms,
            memory: bytes.map(|bytes| bytes / 1e6),
            memory_per_vertex: bytes.map(|bytes| bytes / 1e3 / vertices),
            what_ended_it: match is_last {
                true => reach.end.clone(),
                false => String::new(),
            },
        }
    };
    reach.sizes.iter().enumerate().map(row).collect()
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let mut table = Vec::new();
    let mut largest = Table::new(&["method", "largest", "ms a step", "memory"]);
    for method in methods() {
        let name = method.name;
        let reach = study
            .cases
            .parts(name, |progress| reach(scope, name, progress));
        let Some(reach) = study.unless_failed(name, reach) else {
            continue;
        };
        let rows = rows(name, &reach);
        let cells = match rows.last() {
            Some(row) => [
                Cell::said(format!("{0} × {0}", row.vertices_a_side)),
                Cell::said(two(row.ms_per_step)),
                row.memory
                    .map_or(Cell::Missing, |mb| Cell::said(format!("{} MB", two(mb)))),
            ],
            None => [Cell::said("none"), Cell::Missing, Cell::Missing],
        };
        largest.line(name, cells);
        table.extend(rows);
    }
    let series = curves(&table, |row| {
        (row.method, (row.vertices as Real, row.ms_per_step))
    });
    let (size, time) = (Axis::log("vertices"), Axis::log("time of a step (ms)"));
    let title = "Time of a step against the size of the cloth";
    let mut plot = Plot::new(title, size, time).with(series);
    let vertices = || table.iter().map(|row| row.vertices as Real);
    if let Some(most) = vertices().reduce(Real::max) {
        let each = table
            .iter()
            .zip(vertices())
            .map(|(row, vertices)| row.ms_per_step / vertices);
        let least = each.fold(Real::INFINITY, Real::min);
        let first = Real::from(scope.of(SIDES)[0]).powi(2);
        plot = plot.exact(
            "∝ vertices",
            [first, most].map(|count| (count, least * count)),
        );
    }
    study.plot("scale", &plot);
    study.table("scale", "The hanging sheet, larger and larger", &table);
    let sizes = scope
        .of(SIDES)
        .iter()
        .map(|n| format!("{n} × {n}"))
        .join(", ");
    let all_there = table.iter().filter(|row| row.what_ended_it == ALL);
    let all_there = match all_there.count() {
        0 => "",
        _ => {
            " (the last of these is the largest that this form of the study tries, no limit of a method)"
        }
    };
    let told = format!(
        "Here the largest of {sizes} vertices{all_there} that each method gets through within {} s, three steps and all before them:",
        scope.of(BUDGET).as_secs(),
    );
    study.answer("How large a cloth?", told, Some(largest), "figure-scale");
    let most = table.iter().map(|row| row.vertices_a_side).max();
    let there = table.iter().filter(|row| Some(row.vertices_a_side) == most);
    let there = there.map(|row| row.method).join(", ");
    let is_last = most == scope.of(SIDES).iter().copied().max();
    study.section.verdict = most.map(|side| match is_last {
        true => format!(
            "The largest sheet that was tried, {side} × {side} vertices, is within the reach of {there}."
        ),
        false => format!(
            "The largest sheet that any method gets through has {side} × {side} vertices: {there}."
        ),
    });
    Ok(())
}

fn reach(scope: Scope, method: &str, progress: &mut dyn FnMut(&str)) -> Result<Reach, BenchError> {
    let mut reach = Reach::default();
    let mut last: Option<(u32, Duration)> = None;
    for &side in scope.of(SIDES) {
        if let Some(needed) = too_much(reach.sizes.last()) {
            reach.end = format!("{side} × {side} would need about {needed:.1} GB");
            return Ok(reach);
        }
        // A larger cloth takes at least as long a vertex, but for what other programs do to the machine.
        let expected = last.map(|(smaller, took)| {
            let ratio = Real::from(side) / Real::from(smaller);
            took.as_secs_f64() * ratio * ratio
        });
        if let Some(seconds) = expected.filter(|&seconds| seconds > scope.of(BUDGET).as_secs_f64())
        {
            reach.end = format!("{side} × {side} would take {seconds:.0} s at this time a vertex");
            return Ok(reach);
        }
        progress(&format!("scale: {method} at {side} × {side}"));
        let started = Instant::now();
        match alone(method, side, STEPS, "", scope.of(BUDGET))? {
            Ok(size) => {
                reach.sizes.push(size);
                last = Some((side, started.elapsed()));
            }
            Err(reason) => {
                reach.end = format!("{side} × {side}: {reason}");
                return Ok(reach);
            }
        }
    }
    reach.end = ALL.into();
    Ok(reach)
}

/// Memory (GB) of a cloth four times as large as the last, if it would leave less than a fifth of what is free.
fn too_much(last: Option<&Size>) -> Option<Real> {
    let needed = 4.0 * last?.memory? as Real;
    let free = memory::available()? as Real;
    (needed > 0.8 * free).then_some(needed / 1e9)
}

/// A run of so many steps of the hanging sheet in a process of its own, with `settings` (`key=value key=value`), or why
/// there is none.
pub(super) fn alone(
    method: &str,
    side: u32,
    steps: u32,
    settings: &str,
    budget: Duration,
) -> Result<Result<Size, String>, BenchError> {
    let program = std::env::current_exe()?;
    let (side_text, steps) = (side.to_string(), steps.to_string());
    // So short a step is too short to tear anything, and takes as much memory as any.
    let dt: &[&str] = if method == WITHOUT {
        &["--dt", "1e-6"]
    } else {
        &[]
    };
    let child = Command::new(program)
        .args(["run", "hang", "--method", method, "--n", &side_text])
        .args(["--steps", &steps, "--json"])
        .args(dt)
        .args(settings.split_whitespace().flat_map(|set| ["--set", set]))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()?;
    Ok(finished(child, budget)?.and_then(|told| {
        let told: Value = serde_json::from_str(&told).map_err(|error| error.to_string())?;
        if let Some(error) = told["error"].as_str() {
            return Err(error.to_owned());
        }
        let number = |key: &str| told[key].as_f64().ok_or(format!("no {key}"));
        Ok(Size {
            side,
            ms_per_step: number("ms_per_step_median")?,
            setup_ms: number("setup_ms")?,
            memory: told["peak_memory"].as_u64(),
        })
    }))
}

/// What a process prints, or why it did not come to an end.
fn finished(mut child: Child, budget: Duration) -> Result<Result<String, String>, BenchError> {
    let started = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            let mut told = String::new();
            if let Some(mut out) = child.stdout.take() {
                out.read_to_string(&mut told)?;
            }
            let has_ended = status.code().is_some();
            return Ok(if has_ended && !told.is_empty() {
                Ok(told)
            } else {
                Err(format!("ended with {status}"))
            });
        }
        if started.elapsed() > budget {
            // It may have ended just now, which is as good.
            let _ = child.kill();
            let _ = child.wait();
            return Ok(Err(format!("longer than {} s", budget.as_secs())));
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}
