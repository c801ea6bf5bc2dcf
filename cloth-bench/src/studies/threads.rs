//! When a second thread helps.

use super::interleaved::{interleaved, timed};
use crate::studies::prelude::*;

pub(super) const STUDY: Study = Study {
    name: "threads",
    question: "From which size on does a second thread make a step shorter?",
    about: "A step of the hanging sheet at default settings, in a pool of one thread and in one of two: one of each in turn, many times. Gain is the time on one thread over that on two, the median over the turns. Results are the same to the last \
        bit. Expect no gain and no loss on small sheets, where loops stay on one thread, and less than 2 on large ones: sweeps and solves wait for memory, and of the triangular solves of projective dynamics only those of independent subtrees of its factor run beside each other. Whether a gain counts is decided by the lower quartile of the turns.",
    run,
};

fn methods() -> Vec<&'static str> {
    method::with_own(&["symplectic-euler", "pbd", "xpbd", "pd", "linear-implicit"])
}

const SIDES: [&[u32]; 2] = [&[16, 32], &[16, 32, 64, 128, 256]];

/// Times of a step, and what the second thread gains.
#[derive(Default, Serialize, Deserialize)]
struct Times {
    #[serde(rename = "one thread (ms)")]
    one: Real,
    #[serde(rename = "two threads (ms)")]
    two: Real,
    gain: Real,
    #[serde(rename = "gain, lower quartile")]
    least: Real,
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let sides = scope.of(SIDES);
    let rows = study.grid(
        iproduct!(methods(), sides.iter().copied()),
        |(method, n)| format!("{method} at {n} × {n}"),
        |&(method, n)| times(scope, method, n),
    );
    let gains = curves(&rows, |&((method, n), ref times)| {
        (method, (Real::from(n), times.gain))
    });
    let mut helps = Table::new(&["method", "from", "by up to"]);
    let mut never = Vec::new();
    for name in methods() {
        let own = rows.iter().filter(|((method, _), _)| *method == name);
        let own = own.collect_vec();
        let no_more = own.iter().rposition(|(_, times)| times.least <= 1.1);
        let most = own.iter().map(|(_, times)| times.gain).fold(0.0, Real::max);
        match own.get(no_more.map_or(0, |last| last + 1)) {
            Some(((_, n), _)) => {
                let cells = [format!("{n} × {n}"), format!("× {}", two(most))];
                helps.line(name, cells.map(Cell::said));
            }
            None => never.push(name),
        }
    }
    let gain = Axis::linear("time on one thread over time on two (dimensionless)");
    let sizes = Axis::log("vertices a side");
    let plot = Plot::new("What a second thread gains", sizes, gain)
        .with(gains)
        .exact("no gain", sides.iter().map(|&n| (Real::from(n), 1.0)));
    study.plot("threads", &plot);
    let table = Table::named(&["method", "vertices a side"], &rows);
    study.table("threads", "A step on one thread and on two", table);
    let helps = (!helps.rows.is_empty()).then_some(helps);
    let told = match (&helps, &never[..]) {
        (None, _) => {
            "It shortens no method's step by more than a tenth at any size measured.".into()
        }
        (_, []) => "It shortens a step by more than a tenth with every method measured:".into(),
        (_, never) => format!(
            "It shortens a step by more than a tenth as the table says, and at no size measured with {}:",
            never.join(", ")
        ),
    };
    let told_here = told
        .trim_end_matches([':', '.'])
        .replacen("It", "A second thread", 1);
    study.section.verdict = Some(format!("{told_here}."));
    let question = "When does a second thread help?";
    study.answer(question, told, helps, "figure-threads");
    Ok(())
}

/// Median times of a step on one thread and on two, and what the second gains.
fn times(scope: Scope, name: &str, n: u32) -> Result<Times, BenchError> {
    let scene = scene::build("hang", None, &Settings::default().with("n", n))?;
    let pool = |count| rayon::ThreadPoolBuilder::new().num_threads(count).build();
    let pools = [pool(1)?, pool(2)?];
    let method = Method::find(name)?;
    let settings = method.by_default(Settings::default());
    let build = || method.build(&scene, &settings, scene.dt);
    let mut solvers = [build()?, build()?];
    let mut states = [scene.start.clone(), scene.start.clone()];
    let times = interleaved(scope.pick(0.3, 1.0), |variant| {
        let (solver, state) = (&mut solvers[variant], &mut states[variant]);
        pools[variant].install(|| {
            let input = StepInput::new(scene.dt).gravity(scene.gravity);
            Ok(timed(|| solver.step(state, input))?)
        })
    })?;
    let [one, two] = times.seconds.map(|seconds| 1e3 * seconds);
    Ok(Times {
        one,
        two,
        gain: 1.0 / times.ratios[1],
        least: 1.0 / times.upper[1],
    })
}
