//! From impossible starts back to a sheet.

use super::{capitalised, failed, is_expected};
use crate::studies::prelude::*;

pub(super) const STUDY: Study = Study {
    name: "recovery",
    question: "Which methods bring a sheet back from a random, flattened, collapsed or mirrored start?",
    about: "A sheet of 1 m × 1 m, held along one edge under gravity, springs of 1e3 N/m and hinges of 1e-5 N·m, Δt = 1/60 s, published settings. random: every free vertex anywhere in a cube of 2 m; flattened: all in the line of their row, so no triangle has an area; \
        collapsed: all in one point; mirrored: on the other side of the held edge. Every run is jittered by 1e-4 m, ten times with other numbers; velocities are taken away whenever the kinetic energy has passed a maximum. \
        A run recovers if no step fails, all stays finite, and at the end the root mean square strain is at most 1e-2 above what the same method leaves in the sheet when it starts flat (strain at rest), or implicit Euler where the method fails even then; one run that does not fails the cell. worst strain is the largest over the runs. \
        Strain at rest tells how stiff that setting is, which is no matter of recovery. \
        Mirrored is no trouble for a sheet in space, which swings down from there: it is a check. A collapsed sheet has springs of no length, which have no direction: what a method does there is a choice, and the jitter is there because no rule can break that tie for all.",
    run,
};

const STARTS: [&str; 4] = ["random", "flattened", "collapsed", "mirrored"];
/// Runs of a cell.
pub const RUNS: u64 = 10;
const DT: Real = 1.0 / 60.0;
/// A run recovers if its strain is at most this above that at rest.
const EXCESS: Real = 1e-2;
const STILL: Real = 1e-3;

/// Vertices a side, and steps.
const SIZES: [(usize, u32); 2] = [(5, 100), (9, 300)];

/// What came of the runs of a cell.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Outcome {
    /// How many of the runs recovered.
    pub recovered: u64,
    /// Strain (root mean square) that a start from the flat sheet ends with.
    pub rest: Number,
    /// Largest root mean square strain at the end; of the runs that had one.
    worst: Option<Number>,
    /// Why the first run that failed did so.
    reason: Option<String>,
}

/// The sheet, held along x = 0.
fn sheet(n: usize) -> Result<Scene, BenchError> {
    let settings = Settings::of(&format!("n={n} stiffness=1e3 pins=none"));
    let mut scene = scene::build("hang", None, &settings)?;
    for (vertex, x) in scene.start.positions.iter().enumerate() {
        if x.x == 0.0 {
            let particles = &mut scene.model.particles;
            particles.prescribe(vertex)?;
        }
    }
    Ok(scene)
}

/// Where a vertex that lies at `x` (m) starts.
fn place(start: &str, x: &Vec3, random: &mut SplitMix64) -> Vec3 {
    let mut anywhere =
        |size: Real| Vec3::new(random.symmetric(), random.symmetric(), random.symmetric()) * size;
    let put = match start {
        "random" => anywhere(1.0),
        "flattened" => Vec3::new(x.x, 0.5, 0.0),
        "collapsed" => Vec3::new(0.5, 0.5, -0.2),
        _ => Vec3::new(-x.x, x.y, x.z),
    };
    put + anywhere(1e-4)
}

/// Strain (root mean square) at the end of a run.
fn recover(scene: &Scene, variant: &Variant, steps: u32) -> Result<Real, BenchError> {
    let mut stepper = Method::find(variant.method())?.build(scene, &variant.settings, DT)?;
    let mut state = scene.start.clone();
    run::to_rest(scene, stepper.as_mut(), &mut state, DT, steps, STILL)?;
    match state.first_non_finite() {
        Some(vertex) => Err(BenchError::Failed(format!("vertex {vertex} is not finite"))),
        None => Ok(Strain::of(&scene.gauges()?, &state.positions).rms),
    }
}

/// Ten jittered runs.
pub fn cell(n: usize, steps: u32, start: &str, variant: &Variant) -> Result<Outcome, BenchError> {
    let newton = Variant::published(Method::find("implicit-euler")?);
    let rest =
        recover(&sheet(n)?, variant, steps).or_else(|_| recover(&sheet(n)?, &newton, steps))?;
    let mut cell = Outcome {
        rest: Number(rest),
        ..Outcome::default()
    };
    for seed in 1..=RUNS {
        let mut scene = sheet(n)?;
        let mut random = SplitMix64::new(seed);
        for (vertex, x) in scene.start.positions.iter_mut().enumerate() {
            if !scene.model.particles.is_prescribed(vertex) {
                *x = place(start, x, &mut random);
            }
        }
        match recover(&scene, variant, steps) {
            Ok(strain) => {
                cell.recovered += u64::from(strain <= rest + EXCESS);
                let worst = cell.worst.map_or(0.0, |worst| worst.0);
                cell.worst = Some(Number(worst.max(strain)));
            }
            Err(error) => {
                cell.reason.get_or_insert_with(|| error.to_string());
            }
        }
    }
    Ok(cell)
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let (n, steps) = study.scope.of(SIZES);
    let found = study.grid_side_by_side(
        iproduct!(method::all().map(Variant::published), STARTS),
        |(method, start)| format!("{start}, {}", method.label),
        |(method, start)| cell(n, steps, start, method),
    );
    let reasons = found.iter().filter_map(|((method, start), outcome)| {
        let reason = outcome.reason.as_ref()?;
        let failed = capitalised(failed(reason));
        Some(format!("{failed}: {start}, {}: {reason}.", method.label))
    });
    study.section.notes.extend(reasons);
    let row = |((method, start), outcome): &((Variant, &'static str), Outcome)| {
        let recovered = format!("{} of {RUNS}", outcome.recovered);
        let cell = match &outcome.reason {
            _ if outcome.recovered == RUNS => "passes",
            Some(reason) if is_expected(reason) => "fails, as expected",
            _ => "FAILS",
        };
        let at = (method.label.clone(), *start);
        (at, recovered, outcome.rest, outcome.worst, cell)
    };
    let columns = [
        "method",
        "start",
        "recovered",
        "strain at rest",
        "worst strain",
        "cell",
    ];
    let table = Table::named(&columns, &found.iter().map(row).collect_vec());
    let caption = format!("{n} × {n} vertices, at most {steps} steps");
    study.table("recovery", &caption, table);
    let (mut always, mut lost_some) = (Vec::new(), Vec::new());
    for method in method::all() {
        if method.is_never_stable() {
            lost_some.push(format!("{} fails, as expected", method.name));
            continue;
        }
        let of_method = found
            .iter()
            .filter(|((of, _), _)| of.method() == method.name);
        let lost = of_method.filter(|(_, outcome)| outcome.recovered != RUNS);
        let mut lost = lost.map(|((_, start), outcome)| {
            let count = outcome.recovered;
            format!("{start} ({count} of {RUNS})")
        });
        match lost.join(", ") {
            none if none.is_empty() => always.push(method.published()),
            lost => lost_some.push(format!("{} fails from {lost}", method.published())),
        }
    }
    let told = match lost_some.is_empty() {
        true => "all do".to_owned(),
        false => lost_some.join("; "),
    };
    study.section.verdict = Some(format!(
        "In ten runs of ten from every start, {} recover; {told}.",
        always.join(", ")
    ));
    Ok(())
}
