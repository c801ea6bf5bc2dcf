//! Where the methods stop working: maps of step size, stiffness, ratios and mesh quality.

use crate::report::table::Mark;
use crate::studies::prelude::*;
use cloth_core::measure::{gravitational_energy, kinetic_energy};
use cloth_core::random::SplitMix64;
use cloth_core::step::StepError;
use map::{MAPS, Map};

pub mod map;

pub(super) const STUDY: Study = Study {
    name: "stability",
    question: "At which steps, stiffnesses, ratios of mass and stiffness, and meshes does each method stop working?",
    about: "A sheet of 1 m × 1 m held at two corners falls from the horizontal, one setting per method: the published one, but explicit methods take the step in one part, so that their limit is seen. \
        Every cell is run ten times (three times with xpbd-direct, which is slow; once with --quick), each with other velocities of up to 1 cm/s at the start, and shows the worst of them. \
        ok: finite, and elastic, kinetic and gravitational energy never above that of the start by more than a hundredth of the weight times 1 m; strained: above it, with the step after which it was first so, but only by elastic energy, which a solver that is cut short leaves in stiff springs; \
        grew: the kinetic and gravitational energy alone are above it, so the sheet moves faster than it can; \
        diverged: no longer finite, or the method said so; refused: not built, or the matrix of the first step is of no use, with the reason in the notes. Maps: step (s) × stiffness (N/m); mass of a free corner over that of an inner vertex × stiffness of one half of the sheet over that of the other, Δt = 1/60 s; \
        height of one row of triangles over that of the others, zero included; step × stiffness once more with one iteration a step (one iteration of the only substep) of every method that iterates; \
        distance (m) of the sheet from the origin along each axis × stiffness, Δt = 1/60 s, with the sweeps of XPBD in single precision as well. Limit: the largest step at which symplectic Euler keeps a fixed-free chain of 20 masses from exploding, found by bisection, over the closed form h = 1/(√(k/m) sin((2n − 1)π/(4n + 2))). \
        What might surprise: one iteration of PD around its coarse grid gains energy of motion on soft sheets, and without that grid does not; a method can be unconditionally stable for a linear spring (implicit midpoint) and still gain energy on cloth, and PBD and XPBD, cut short by their published settings, hold more elastic energy than the fall has given although they stay finite.",
    run,
};

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let limit = limits(study);
    let rows = rows(scope);
    let fates = study.cases.side_by_side(&rows, Row::name, |row| {
        row.map.row(scope, row.down, &row.method)
    });
    let mut told = vec![limit];
    let mut every = rows.into_iter().zip(fates);
    for map in &MAPS {
        let (across, down) = map.values(scope);
        let of_map = every
            .by_ref()
            .take((map.methods)().len() * down.len())
            .collect();
        told.push(draw(map, &across, of_map, &mut study.findings));
    }
    study.findings.section.verdict = Some(told.join("\n"));
    Ok(())
}

/// What is one case: a method on one row of a map.
struct Row {
    map: &'static Map,
    /// The value of the second parameter.
    down: Real,
    method: Variant,
}

impl Row {
    fn name(&self) -> String {
        let Self { map, down, method } = self;
        let (name, of, down) = (map.name, map.down, short(*down));
        format!("{name}, {of} {down}, {}", method.label)
    }
}

/// All rows, map by map, of each method one after the other.
fn rows(scope: Scope) -> Vec<Row> {
    let mut rows = Vec::new();
    for map in &MAPS {
        let (_, down) = map.values(scope);
        for method in (map.methods)() {
            let method = || method.clone();
            rows.extend(down.iter().map(|&down| Row {
                map,
                down,
                method: method(),
            }));
        }
    }
    rows
}

/// What came of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Fate {
    /// Nothing of what follows.
    Ok,
    /// Elastic energy that a solver cut short leaves in the springs, after this step; the sheet does not move faster
    /// than it may.
    Strained(u32),
    /// After this step.
    Grew(u32),
    /// No longer finite, or the method said so, after this step.
    Diverged(u32),
    /// Not built, or the first step failed: the reason.
    Refused(String),
}

impl Fate {
    /// From passing to failing at once.
    #[must_use]
    pub fn severity(&self) -> u8 {
        match self {
            Self::Ok => 0,
            Self::Strained(_) => 1,
            Self::Grew(_) => 2,
            Self::Diverged(_) => 3,
            Self::Refused(_) => 4,
        }
    }

    fn word(&self) -> String {
        match self {
            Self::Ok => "ok".into(),
            Self::Strained(step) => format!("strained ({step})"),
            Self::Grew(step) => format!("grew ({step})"),
            Self::Diverged(step) => format!("diverged ({step})"),
            Self::Refused(_) => "refused".into(),
        }
    }
}

/// Follows a method for some steps.
///
/// # Errors
/// [`BenchError`] for a method that is not known.
pub fn follow(scene: &Scene, variant: &Variant, dt: Real, steps: u32) -> Result<Fate, BenchError> {
    let method = Method::find(variant.method())?;
    let once = Settings::of(if method.is_explicit() {
        "substeps=1"
    } else {
        ""
    });
    let settings = once.then(&variant.settings);
    let mut stepper = match method.build(scene, &settings, dt) {
        Ok(stepper) => stepper,
        Err(error) => return Ok(Fate::Refused(error.to_string())),
    };
    let energies = scene.model.energies()?;
    let particles = &scene.model.particles;
    let moving = |state: &State| {
        kinetic_energy(particles, &state.velocities)
            + gravitational_energy(particles, &state.positions, scene.gravity)
    };
    let free = (0..particles.len()).filter(|&v| !particles.is_prescribed(v));
    let mass: Real = free.map(|v| particles.mass()[v]).sum();
    let mut state = scene.start.clone();
    let mut fate = Fate::Ok;
    let most = moving(&state) + 0.01 * mass * scene.gravity.norm();
    for step in 1..=steps {
        let input = StepInput::new(dt).gravity(scene.gravity);
        let told = stepper.step(&mut state, input);
        if let Err(error @ StepError::NotPositiveDefinite { step: 1, .. }) = told {
            return Ok(Fate::Refused(error.to_string()));
        }
        if told.is_err() || state.first_non_finite().is_some() {
            return Ok(Fate::Diverged(step));
        }
        let (now, elastic) = (moving(&state), energies.value(&state.positions));
        if !(now + elastic).is_finite() {
            return Ok(Fate::Diverged(step));
        }
        if now > most {
            return Ok(Fate::Grew(step));
        }
        if now + elastic > most && fate == Fate::Ok {
            fate = Fate::Strained(step);
        }
    }
    Ok(fate)
}

/// The largest power of ten (N/m), up to a billion, to which the springs of the hanging sheet can be stiffened before the
/// method explodes or gains energy of motion in so many steps of 1/60 s; none where it does with the softest.
///
/// # Errors
/// [`BenchError::Failed`] for a scene that cannot be built.
pub fn stable_up_to(method: &str, steps: u32) -> Result<Option<Real>, BenchError> {
    let mut stable = None;
    for decade in 0..=9 {
        let stiffness = Real::powi(10.0, decade);
        if map::falls(stiffness, method, steps)?.severity() >= Fate::Grew(0).severity() {
            break;
        }
        stable = Some(stiffness);
    }
    Ok(stable)
}

/// One table for a map, with a row per method and value of the second parameter; what it says.
fn draw(
    map: &Map,
    across: &[Real],
    rows: Vec<(Row, Result<Vec<Fate>, BenchError>)>,
    findings: &mut Findings,
) -> String {
    let mut names = vec!["method".to_owned(), map.down.to_owned()];
    names.extend(
        across
            .iter()
            .map(|value| format!("{} {}", map.across, short(*value))),
    );
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut table = Table::new(&names);
    let mut reasons: Vec<String> = Vec::new();
    let sheets = rows.len() / (map.methods)().len() * across.len();
    let mut found: Vec<(String, Vec<Fate>)> = Vec::new();
    for (row, fates) in rows {
        let Some(mut fates) = findings
            .unless_failed(&row.name(), fates)
            .filter(|fates| fates.len() == across.len())
        else {
            continue;
        };
        let hopeless = Method::find(row.method.method()).is_ok_and(Method::is_never_stable);
        let label = row.method.label;
        let mut cells = vec![Cell::from(label.as_str()), Cell::from(row.down)];
        cells.extend(fates.iter().map(|fate| {
            let mark = match fate {
                Fate::Diverged(_) if hopeless => Mark::Expected,
                _ => Mark::Plain,
            };
            Cell::Marked(fate.word(), mark)
        }));
        table.rows.push(cells);
        for fate in &fates {
            if let Fate::Refused(reason) = fate {
                let note = format!("Refused: {label}: {reason}.");
                if !reasons.contains(&note) {
                    reasons.push(note);
                }
            }
        }
        match found.last_mut() {
            Some((method, all)) if *method == label => all.append(&mut fates),
            _ => found.push((label, fates)),
        }
    }
    let passed: Vec<String> = found
        .iter()
        .map(|(name, fates)| passed(name, fates))
        .collect();
    findings.section.notes.extend(reasons);
    findings.table(&format!("stability-{}", map.name), map.caption, table);
    format!(
        "{}, of {sheets} sheets ok: {}.",
        map.caption,
        passed.join(", ")
    )
}

/// How many sheets a method got through, in words.
fn passed(method: &str, fates: &[Fate]) -> String {
    let ok = fates.iter().filter(|fate| **fate == Fate::Ok).count();
    let strained = fates
        .iter()
        .filter(|fate| matches!(fate, Fate::Strained(_)))
        .count();
    match strained {
        0 if ok == 0 && Method::find(method).is_ok_and(Method::is_never_stable) => {
            format!("{method} none, as expected")
        }
        0 => format!("{method} {ok}"),
        strained => format!("{method} {ok} and strained in {strained}"),
    }
}

fn short(value: Real) -> String {
    if value == 0.0 || (1e-2..1e3).contains(&value) {
        format!("{}", (value * 1e4).round() / 1e4)
    } else {
        format!("{value:.0e}")
    }
}

/// The step at which symplectic Euler explodes on a chain of 20 masses.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Limit {
    #[serde(rename = "stiffness (N/m)")]
    stiffness: Number,
    /// As a run finds it (s).
    #[serde(rename = "largest step (s)")]
    pub found: Number,
    /// By the closed form (s).
    #[serde(rename = "closed form (s)")]
    pub expected: Number,
}

fn limits(study: &mut StudyRun<'_>) -> String {
    let stiffnesses: &[Real] = study.scope.pick(&[1e2, 1e6], &[1.0, 1e2, 1e4, 1e6, 1e8]);
    let measure = || {
        stiffnesses
            .iter()
            .map(|&k| limit(k))
            .collect::<Result<Vec<Limit>, _>>()
    };
    let Some(found) = study.case("limit of symplectic Euler", measure) else {
        return "The limit of symplectic Euler was not found.".into();
    };
    let curve = |of: fn(&Limit) -> Number| {
        found
            .iter()
            .map(move |limit| (limit.stiffness.0, of(limit).0))
    };
    let measured = Series::new("symplectic-euler", curve(|limit| limit.found).collect());
    let plot = Plot::new(
        "The largest step of symplectic Euler",
        Axis::log("stiffness (N/m)"),
        Axis::log("step (s)"),
    )
    .points([measured])
    .exact("2/ω of the stiffest mode", curve(|limit| limit.expected))
    .note("A chain of 20 masses of 0.01 kg, held at one end, shaken along itself.");
    study.findings.plot("stability-limit", &plot);
    let table = Table::of(&found);
    study
        .findings
        .table("stability-limit", "The limit of symplectic Euler", table);
    let errors = found
        .iter()
        .map(|limit| (limit.found.0 / limit.expected.0 - 1.0).abs());
    let worst = errors.fold(0.0, Real::max);
    format!("Symplectic Euler explodes where the closed form says, to {worst:.0e}.")
}

/// Longitudinal motion of a chain is linear, so the limit is that of its stiffest mode.
///
/// # Errors
/// [`BenchError::Failed`] for a scene that cannot be built.
pub fn limit(stiffness: Real) -> Result<Limit, BenchError> {
    const LINKS: u32 = 20;
    const MASS: Real = 0.01;
    const STEPS: u32 = 3000;
    let settings = Settings::of(&format!(
        "n={LINKS} mass={MASS} tip_mass={MASS} stiffness={stiffness} gravity=0"
    ));
    let mut scene = scene::build("chain", None, &settings)?;
    let mut random = SplitMix64::new(1);
    for x in scene.start.positions.iter_mut().skip(1) {
        x.x += 1e-9 * random.symmetric();
    }
    let once = Settings::default().with("substeps", 1);
    let explodes = |dt: Real| -> Result<bool, BenchError> {
        let mut stepper = Method::find("symplectic-euler")?.build(&scene, &once, dt)?;
        let mut state = scene.start.clone();
        for _ in 0..STEPS {
            if stepper.step(&mut state, StepInput::new(dt)).is_err() {
                return Ok(true);
            }
        }
        let moved = state.positions.iter().zip(&scene.start.positions);
        Ok(moved.map(|(a, b)| (a - b).norm()).fold(0.0, Real::max) > 1e-6)
    };
    let phase = std::f64::consts::PI * Real::from(2 * LINKS - 1) / Real::from(4 * LINKS + 2);
    let expected = (MASS / stiffness).sqrt() / phase.sin();
    let (mut low, mut high) = (0.5 * expected, 2.0 * expected);
    while high / low > 1.0001 {
        let middle = (low * high).sqrt();
        if explodes(middle)? {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok(Limit {
        stiffness: Number(stiffness),
        found: Number((low * high).sqrt()),
        expected: Number(expected),
    })
}
