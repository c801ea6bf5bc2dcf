//! When a second thread helps.

use super::interleaved::interleaved;
use crate::studies::prelude::*;
use std::time::Instant;

pub(super) const STUDY: Study = Study {
    name: "threads",
    question: "From which size on does a second thread make a step shorter?",
    about: "A step of the hanging sheet at default settings, in a pool of one thread and in one of two: one of each in turn, many times. Gain is the time on one thread over that on two, the median over the turns. Results are the same to the last \
        bit. Expect no gain and no loss on small sheets, where loops stay on one thread, and less than 2 on large ones: sweeps and solves wait for memory, and the triangular solves of projective dynamics and of Newton's method are serial.",
    run,
};

fn methods() -> Vec<&'static str> {
    method::with_own(&["symplectic-euler", "pbd", "xpbd", "pd", "linear-implicit"])
}

fn sides(scope: Scope) -> &'static [u32] {
    scope.pick(&[16, 48], &[16, 32, 64, 128, 256])
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let mut table = Table::new(&[
        "method",
        "vertices a side",
        "one thread (ms)",
        "two threads (ms)",
        "gain",
    ]);
    let mut series = Vec::new();
    let mut parts = Vec::new();
    for name in methods() {
        let mut curve = Vec::new();
        for &n in sides(scope) {
            let case = format!("{name} at {n} × {n}");
            let Some([one, two, gain]) = study.case(&case, || times(name, n)) else {
                continue;
            };
            table.push([
                Cell::from(name),
                Cell::from(n as usize),
                Cell::from(1e3 * one),
                Cell::from(1e3 * two),
                Cell::from(gain),
            ]);
            curve.push((Real::from(n), gain));
        }
        let no_more = curve.iter().rposition(|(_, gain)| *gain <= 1.1);
        let pays = curve.get(no_more.map_or(0, |last| last + 1));
        let most = curve.iter().map(|(_, gain)| *gain).fold(0.0, Real::max);
        parts.push(match pays {
            Some((n, _)) => format!("{name} from {n} × {n} on, by up to {most:.2}"),
            None => format!("{name} at no size measured"),
        });
        series.push(Series::new(name, curve));
    }
    let even = sides(scope).iter().map(|&n| (Real::from(n), 1.0)).collect();
    series.push(Series::new("no gain", even).styled(Style::ExactCurve));
    study.findings.plot(
        "threads",
        &Plot {
            title: "What a second thread gains".into(),
            x: Axis::log("vertices a side"),
            y: Axis::linear("time on one thread over time on two (dimensionless)"),
            series,
            note: String::new(),
        },
    );
    study
        .findings
        .table("threads", "A step on one thread and on two", table);
    let verdict = format!(
        "A second thread shortens a step by more than a tenth: {}.",
        parts.join("; ")
    );
    study
        .findings
        .answer("When does a second thread help?", verdict.clone());
    study.findings.section.verdict = Some(verdict);
    Ok(())
}

/// Median times (s) of a step on one thread and on two, and what the second gains.
fn times(name: &str, n: u32) -> Result<[Real; 3], BenchError> {
    let scene = scene::build("hang", None, &Settings::default().with("n", n))?;
    let pools = [1, 2].map(|count| rayon::ThreadPoolBuilder::new().num_threads(count).build());
    let [one, two] = pools;
    let pools = [one?, two?];
    let method = Method::find(name)?;
    let mut solvers = [
        method.build(&scene, &Settings::default(), scene.dt)?,
        method.build(&scene, &Settings::default(), scene.dt)?,
    ];
    let mut states = [scene.start.clone(), scene.start.clone()];
    let times = interleaved(1.0, |variant| {
        let (solver, state) = (&mut solvers[variant], &mut states[variant]);
        pools[variant].install(|| {
            let input = StepInput::new(scene.dt).gravity(scene.gravity);
            let started = Instant::now();
            solver.step(state, input)?;
            Ok(started.elapsed().as_secs_f64())
        })
    })?;
    let [one, two] = times.seconds;
    Ok([one, two, 1.0 / times.ratios[1]])
}
