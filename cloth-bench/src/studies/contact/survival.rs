//! What comes through contact, with steps of every size and from starts that pass through themselves.

use crate::run::{Plan, SeparationWatch, Solver};
use crate::studies::prelude::*;
use crate::studies::stability::map::runs;
use crate::studies::{capitalised, collision, scale};
use std::path::Path;

const QUARTER: Real = std::f64::consts::FRAC_PI_2;
/// Time of a run (s).
const SECONDS: Real = 0.5;
/// Part of the energy that was given which a cloth may hold beyond it.
const MOST_EXCESS: Real = 0.01;
/// A run ends where it holds so many times as much.
const TOO_MUCH: Real = 10.0;
/// Velocities (m/s) that every vertex starts with, other ones in every run, are below this in each direction.
const JITTER: Real = 1e-2;

/// Scenes of contact: a drape, a fold, a stack, a garment.
const SCENES: [&str; 4] = ["drape-sphere", "fold", "stack", "garment"];
/// Those of them that can begin tangled.
const TANGLED: [&str; 3] = ["fold", "stack", "garment"];

/// A ribbon whose upper half comes down through the lower one.
fn pleat(x: Vec3) -> Vec3 {
    match x.z > 0.5 {
        true => Vec3::new(x.x, 0.2 * (x.z - 0.75), 1.0 - x.z),
        false => x,
    }
}

/// Every second sheet is tilted about its middle, through the one below.
fn through(x: Vec3) -> Vec3 {
    let is_second = x.z > 2e-3;
    Vec3::new(
        x.x,
        x.y,
        x.z + if is_second { 0.2 * x.x } else { 0.0 } + 0.1,
    )
}

/// Vertices a side, sizes of steps (s), and stiffnesses (N/m) of the map.
fn size(scope: Scope) -> (u32, &'static [Real], &'static [Real]) {
    const STEPS: [Real; 4] = [1.0 / 240.0, 1.0 / 60.0, 1.0 / 30.0, 1.0 / 15.0];
    scope.pick(
        (5, &STEPS[1..3], &[1e2, 1e6]),
        (17, &STEPS, &[1.0, 1e2, 1e4, 1e6, 1e8]),
    )
}

/// Vertices a side of the map.
const OF_MAP: [u32; 2] = [5, 9];

/// A scene of contact by its name, with so many vertices a side and with settings of its start.
pub fn scene_of(name: &str, n: u32, starts: &str) -> Result<Scene, BenchError> {
    let settings = Settings::of(starts);
    match name {
        "garment" => collision::garment(&format!("tube:{}x{n}", n / 2 * 2)),
        "sleeve" => sleeve(n, &settings),
        "stack" => scene::build(name, None, &settings.with("n", n).with("sheets", 2)),
        _ => scene::build(name, None, &settings.with("n", n)),
    }
}

/// A tube that hangs around a capsule which is narrower, and which lies inside the polygon that the tube is at rest.
fn sleeve(n: u32, settings: &Settings) -> Result<Scene, BenchError> {
    let around = n / 2 * 2;
    let top = 0.25 * (2.0 * QUARTER / Real::from(around)).cos();
    let text = format!(
        "[[mesh]]\ngenerator = \"tube:{around}x{n}\"\nrotate = [{QUARTER}, 0, 0]\n\
        [[obstacle]]\nshape = \"capsule\"\nradius = 0.05\nlength = 1.2\nrotate = [{QUARTER}, 0, 0]\n\
        position = [0, 0, {}]\n[contact]\nself = true\n",
        top - 0.052
    );
    scene::file::build_text(Path::new("sleeve.toml"), &text, settings)
}

/// The same with a start that passes through itself. The garment has got a lining, which comes out on one side.
fn tangled(name: &str, n: u32) -> Result<Scene, BenchError> {
    let (place, lift): (fn(Vec3) -> Vec3, _) = match name {
        "fold" => (pleat, 0.0),
        "stack" => (through, 0.1),
        _ => return lined(n),
    };
    let mut scene = scene_of(name, n, "untangle=yes")?;
    let heights = scene.start.positions.iter().map(|x| x.z);
    let lowest = Vec3::z() * heights.fold(Real::MAX, Real::min);
    for x in &mut scene.start.positions {
        *x = place(*x - lowest) + lowest + Vec3::z() * lift;
    }
    Ok(scene)
}

fn lined(n: u32) -> Result<Scene, BenchError> {
    let around = n / 2 * 2;
    let text = format!(
        "[[mesh]]\ngenerator = \"tube:{around}x{n}\"\ntranslate = [0, 0, 0.2]\n\
        [[mesh]]\ngenerator = \"tube:{around}x{n}\"\nscale = [0.9, 0.9, 0.95]\ntranslate = [0.05, 0.02, 0.22]\n\
        [[obstacle]]\nshape = \"plane\"\n[contact]\nself = true\nuntangle = true\n"
    );
    scene::file::build_text(Path::new("lined.toml"), &text, &Settings::default())
}

/// Everything that is not unstable by its own nature; without the direct solver, which is slow, in the quick scope.
fn methods(scope: Scope) -> impl Iterator<Item = &'static str> + Clone {
    let slow = scope.pick("xpbd-direct", "");
    method::all()
        .filter(move |method| !method.is_never_stable() && method.name != slow)
        .map(|method| method.name)
}

/// What came of the worst run of a cell, from passing to failing.
#[derive(Clone, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
pub enum Fate {
    /// Nothing of what follows.
    #[default]
    Ok,
    /// The cloth holds more energy than it was given, first after this step, but does not move with it: elastic energy
    /// that a solver cut short leaves.
    Strained(u32),
    /// It moves with more energy than it was given.
    Grew(u32),
    /// Triangles cross, or vertices are inside a body, after so many steps.
    Crossed(u32),
    /// The run ended with an error.
    Ended(String),
}

impl Fate {
    fn word(&self) -> String {
        match self {
            Self::Ok => "ok".into(),
            Self::Strained(step) => format!("strained ({step})"),
            Self::Grew(step) => format!("grew ({step})"),
            Self::Crossed(steps) => format!("crossed ({steps})"),
            Self::Ended(_) => "ended".into(),
        }
    }
}

fn jitter(state: &mut State, seed: u64) {
    let mut random = SplitMix64::new(seed);
    for v in &mut state.velocities {
        *v = Vec3::from_fn(|_, _| JITTER * random.symmetric());
    }
}

/// A run of a method, and what the cloth held of what it was given (dimensionless) after every step.
pub fn follow(
    scene: &Scene,
    name: &str,
    dt: Real,
    seed: u64,
) -> Result<(Fate, Vec<Number>), BenchError> {
    let method = Method::find(name)?;
    let settings = method.by_default(Settings::default());
    let mut state = scene.start.clone();
    jitter(&mut state, seed);
    let mut watch = SeparationWatch::new(scene)?;
    let steps = (SECONDS / dt).round() as u32;
    let mut solver = Solver::new(method, &settings, scene, dt)?;
    let plan = Plan::new(dt, steps);
    let (mut energies, mut is_lost): (Vec<[Real; 2]>, bool) = Default::default();
    let ran = run::run_changing(scene, &mut solver, &mut state, plan, |moment| {
        energies.push([moment.held, moment.given]);
        is_lost = moment.held > TOO_MUCH * moment.given;
        match is_lost {
            true => Err(BenchError::Failed(String::new())),
            false => watch.look(moment.scene, moment.state),
        }
    });
    let most = energies
        .iter()
        .map(|[_, given]| *given)
        .fold(0.0, Real::max);
    let first = energies
        .iter()
        .zip(1..)
        .find(|([held, given], _)| held - given > MOST_EXCESS * most);
    let mut fate = first.map_or(Fate::Ok, |(_, step)| Fate::Strained(step));
    let seen = watch.seen();
    let inside = seen.min_clearance.is_some_and(|clearance| clearance < 0.0);
    match ran {
        Ok((summary, _)) => {
            if let Some(gain) = summary.energy_gain {
                fate = Fate::Grew(gain.step);
            }
        }
        Err(_) if is_lost => fate = Fate::Grew(energies.len() as u32),
        Err(error) => fate = Fate::Ended(error.to_string()),
    }
    if seen.crossed_steps > 0 || seen.most_obstacle_intersections > 0 || inside {
        fate = Fate::Crossed(seen.crossed_steps.max(1));
    }
    let share = |[held, given]: [Real; 2]| Number(held / given);
    Ok((fate, energies.into_iter().map(share).collect()))
}

/// A scene with springs of so many N/m, or with its own, by a method: the worst of all runs with every step.
type Case = (&'static str, Option<Real>, &'static str);

fn fates(study: &mut StudyRun<'_>, n: u32, cases: Vec<Case>) -> Vec<(Case, Fates)> {
    let scope = study.scope;
    let steps = size(scope).1;
    study.grid_side_by_side(
        cases,
        |(scene, stiffness, method)| match stiffness {
            Some(stiffness) => {
                format!("{scene} of {stiffness} N/m by {method}, steps of every size")
            }
            None => format!("{scene} by {method}, steps of every size"),
        },
        |&(scene, stiffness, method)| {
            let stiffness = stiffness.map(|stiffness| format!("stiffness={stiffness}"));
            let scene = scene_of(scene, n, &stiffness.unwrap_or_default())?;
            let of_step = |&dt: &Real| {
                let mut worst = follow(&scene, method, dt, 1)?;
                for seed in 2..=runs(scope, method) {
                    let (fate, _) = follow(&scene, method, dt, seed)?;
                    if fate > worst.0 {
                        worst.0 = fate;
                    }
                }
                Ok::<_, BenchError>(worst)
            };
            steps.iter().map(of_step).try_collect::<_, Vec<_>, _>()
        },
    )
}

/// The table of all scenes, methods and steps, and the energy over time.
pub(super) fn run(study: &mut StudyRun<'_>) {
    let (n, steps, stiffnesses) = size(study.scope);
    let cases = iproduct!(SCENES, [None], methods(study.scope)).collect();
    let found = fates(study, n, cases);
    let columns = steps.iter().map(|dt| format!("Δt 1/{:.0} s", 1.0 / dt));
    let columns = ["method".into()].into_iter().chain(columns).collect_vec();
    let mut table = Table::about("scene", columns.clone());
    for ((scene, _, method), fates) in &found {
        let words = fates.iter().map(|(fate, _)| fate.word().into());
        table.line(*scene, [Cell::from(*method)].into_iter().chain(words));
        for ((fate, _), dt) in fates.iter().zip(steps) {
            if let Fate::Ended(reason) = fate {
                study.note(format!("{scene} by {method}, Δt = {dt:.1e} s: {reason}."));
            }
        }
    }
    let caption = format!(
        "Contact with steps of every size, {n} vertices a side, {SECONDS} s, the worst of {} runs",
        runs(study.scope, "")
    );
    study.table("contact-steps", &caption, table);
    let of_map = study.scope.of(OF_MAP);
    let stiff = stiffnesses.iter().map(|&stiffness| Some(stiffness));
    let cases = iproduct!([SCENES[0]], stiff, methods(study.scope)).collect();
    let mut map = Table::about("stiffness (N/m)", columns);
    let mut through = Vec::new();
    for ((_, stiffness, method), fates) in fates(study, of_map, cases) {
        let words = fates.iter().map(|(fate, _)| fate.word().into());
        map.line(
            stiffness.unwrap_or_default(),
            [Cell::from(method)].into_iter().chain(words),
        );
        through.push((
            method,
            fates.iter().filter(|(fate, _)| *fate == Fate::Ok).count(),
        ));
    }
    let caption = format!(
        "Step size and stiffness in contact: {}, {of_map} vertices a side",
        SCENES[0]
    );
    study.table("contact-stiffness", &caption, map);
    let through = through.into_iter().into_grouping_map().sum();
    let sheets = steps.len() * stiffnesses.len();
    let told = methods(study.scope)
        .filter_map(|method| Some(format!("{method} {}", through.get(method)?)));
    let told = format!(
        "{caption}, of {sheets} sheets ok: {}.",
        told.collect_vec().join(", ")
    );
    study.note(told);
    for scene in SCENES {
        // Steps of 1/60 s.
        let place = steps.iter().position(|dt| *dt == 1.0 / 60.0);
        let place = place.unwrap_or_default();
        let of_scene = found.iter().filter(|((of, ..), _)| *of == scene);
        let curves = of_scene.map(|((.., method), fates)| {
            let shares = fates.get(place).map_or(&[][..], |(_, shares)| shares);
            let points = (1..).zip(shares);
            let points = points.map(|(step, share)| (Real::from(step) * steps[place], share.0));
            Series::new(method, points.collect())
        });
        let held = Axis::linear("energy held over given (dimensionless)").within(0.0, 1.1);
        let title = format!("Energy of {scene}, steps of 1/60 s");
        let plot = Plot::new(title, Axis::linear("time (s)"), held)
        .with(curves)
        .exact("all that was given", [(0.0, 1.0), (SECONDS, 1.0)])
        .note("Kinetic and elastic energy and that of contact, over what the cloth held at the start, gravity has released and bodies have done.");
        study.plot(&format!("contact-energy-{scene}"), &plot);
    }
    answer(steps, &found, study);
    recovery(study);
}

/// Fates of every step, with the energy over time.
type Fates = Vec<(Fate, Vec<Number>)>;

/// Which method comes through all scenes with which step.
fn answer(steps: &[Real], found: &[(Case, Fates)], study: &mut StudyRun<'_>) {
    let names = steps.iter().map(|dt| format!("1/{:.0} s", 1.0 / dt));
    let mut table = Table::about("method", names);
    let thirtieth = steps.iter().position(|dt| *dt == 1.0 / 30.0);
    let thirtieth = thirtieth.unwrap_or_default();
    let (mut survives, mut others) = (Vec::new(), Vec::new());
    for method in methods(study.scope) {
        let ok = |step: usize| {
            let of_method = found.iter().filter(|((.., by), _)| *by == method);
            let fates = of_method.filter_map(|(_, fates)| Some(&fates.get(step)?.0));
            fates.filter(|fate| **fate == Fate::Ok).count()
        };
        let cells =
            (0..steps.len()).map(|step| Cell::said(format!("{} of {}", ok(step), SCENES.len())));
        table.line(method, cells);
        match ok(thirtieth) == SCENES.len() {
            true => survives.push(method),
            false => others.push(method),
        }
    }
    let others = match others.is_empty() {
        true => String::new(),
        false => format!("; not with {}", others.join(", ")),
    };
    let told = format!(
        "A drape, a fold, a stack and a garment, each for {SECONDS} s, go without a crossing and without energy from nowhere by steps of 1/30 s with {}{others}. {} at no step, as expected.",
        survives.join(", "),
        capitalised(scale::WITHOUT)
    );
    let question = "What survives a step of 1/30 s in contact?";
    study.section.rests_on = "table-contact-steps".into();
    study.section.verdict = Some(told.clone());
    study.answer(question, told, Some(table), "table-contact-steps");
}

/// Gains energy from every jerk, and tears the cloth to pieces that keep the last resort of contact busy for minutes.
const LEFT_OUT: &str = "implicit-midpoint";

/// How a start that passes through itself went.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Recovered {
    /// Pairs of triangles that cross at the start.
    pub pairs_at_start: usize,
    /// Steps until no pair crosses; none if some still do.
    pub steps_until_free: Option<usize>,
    /// Those that still do at the end.
    pub pairs_at_end: usize,
    /// After the step from which on nothing crosses.
    pub crossings_afterwards: u32,
    largest_stretch: Number,
}

impl Recovered {
    fn is_free(&self) -> bool {
        self.steps_until_free.is_some() && self.crossings_afterwards == 0
    }
}

/// A run from a start that passes through itself.
pub fn recover(
    scene: &str,
    method: &str,
    (n, steps): (u32, u32),
    seed: u64,
) -> Result<Recovered, BenchError> {
    let mut scene = tangled(scene, n)?;
    jitter(&mut scene.start, seed);
    let method = Method::find(method)?;
    let settings = method.by_default(Settings::default());
    let mut probe = scene.separation_probe();
    let mut counts = Vec::new();
    let (summary, _) =
        run::from_start(&scene, method, &settings, scene.dt, steps, |_, state, _| {
            if let Some(probe) = &mut probe {
                counts.push(probe.measure(&state.positions)?.intersecting_pairs);
            }
            Ok(())
        })?;
    let at_start = summary.tangled_pairs.first().copied().unwrap_or(0);
    let free = counts.iter().position(|pairs| *pairs == 0);
    let later = free.map_or(0, |free| counts[free..].iter().filter(|n| **n > 0).count());
    Ok(Recovered {
        pairs_at_start: at_start,
        steps_until_free: free.map(|free| free + 1),
        pairs_at_end: counts.last().copied().unwrap_or(at_start),
        crossings_afterwards: later as u32,
        largest_stretch: Number(summary.max_stretch),
    })
}

/// Cloth that passes through itself at the start.
fn recovery(study: &mut StudyRun<'_>) {
    let scope = study.scope;
    let size = scope.pick((9, 40), (17, 100));
    let methods = || methods(scope).filter(|method| *method != LEFT_OUT);
    let (tried, of_methods) = (methods().collect_vec(), methods().collect_vec());
    let rows = study.grid_side_by_side(
        iproduct!(TANGLED, tried),
        |(scene, method)| format!("{scene} by {method}, from a start that passes through itself"),
        |(scene, method)| {
            let seeds = 1..=runs(scope, method);
            let runs = seeds.map(|seed| recover(scene, method, size, seed));
            let runs: Vec<Recovered> = runs.try_collect()?;
            let free = runs.iter().filter(|run| run.is_free()).count();
            let told = format!("{free} of {}", runs.len());
            let is_slow = |run: &Recovered| (!run.is_free(), run.steps_until_free);
            let slowest = runs.into_iter().max_by_key(is_slow);
            Ok((told, slowest.unwrap_or_default()))
        },
    );
    let caption = format!(
        "Starts that pass through themselves, {} vertices a side, {} steps of 1/60 s: how many runs are pulled apart for good, and the slowest",
        size.0, size.1
    );
    let table = Table::named(&["scene", "method", "recovered"], &rows);
    study.table("contact-recovery", &caption, table);
    let mut told = of_methods.into_iter().map(|method| {
        let of_method = || rows.iter().filter(|((_, by), _)| *by == method);
        let free = of_method().filter(|(_, (_, slowest))| slowest.is_free());
        format!("{method} {} of {}", free.count(), of_method().count())
    });
    let told = told.join(", ");
    study.note(format!(
        "Pulled apart in every run, and nothing crosses afterwards: {told}."
    ));
}
