//! Where the methods stop working: maps of step size, stiffness, ratios and mesh quality.

use crate::studies::prelude::*;
use cloth_core::measure::{gravitational_energy, kinetic_energy};
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
    // All rows of all maps are cases side by side: a map, a method, and the value of the second parameter.
    let of_map = |map: &'static Map| iproduct!([map], (map.methods)(), map.values(scope)[1]);
    let found = study.grid_side_by_side(
        MAPS.iter().flat_map(of_map),
        |(map, method, down)| {
            let (name, of, down) = (map.name, map.down, short(**down));
            format!("{name}, {of} {down}, {}", method.label)
        },
        |(map, method, down)| map.row(scope, **down, method),
    );
    let mut told = vec![limit];
    for map in &MAPS {
        let of_map = found.iter().filter(|((of, ..), _)| of.name == map.name);
        let rows = of_map.map(|((_, method, down), fates)| (method, **down, &fates[..]));
        told.push(draw(map, scope, rows, study));
    }
    study.section.verdict = Some(told.join("\n"));
    Ok(())
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
    /// Whether the sheet does not move as it may.
    pub fn is_lost(&self) -> bool {
        !matches!(self, Self::Ok | Self::Strained(_))
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

/// How stiff the springs of the hanging sheet can be, as powers of ten (N/m).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StableUpTo {
    /// The largest, up to a billion, before the method explodes or gains energy of motion; none where it does with the
    /// softest.
    pub stable: Option<Real>,
    /// The smallest of those with which it holds more elastic energy than the sheet was given, if there is one.
    pub strained: Option<Real>,
}

/// The same of a method at its default in so many steps of 1/60 s.
pub fn stable_up_to(method: &str, steps: u32) -> Result<StableUpTo, BenchError> {
    let mut found = StableUpTo::default();
    for decade in 0..=9 {
        let stiffness = Real::powi(10.0, decade);
        let fate = map::falls(stiffness, method, steps)?;
        if fate.is_lost() {
            break;
        }
        found.stable = Some(stiffness);
        if fate != Fate::Ok {
            found.strained.get_or_insert(stiffness);
        }
    }
    Ok(found)
}

/// One table for a map, with a row per method and value of the second parameter; what it says.
fn draw<'a>(
    map: &Map,
    scope: Scope,
    rows: impl Iterator<Item = (&'a Variant, Real, &'a [Fate])>,
    study: &mut StudyRun<'_>,
) -> String {
    let [across, down] = map.values(scope);
    let columns = across
        .iter()
        .map(|value| format!("{} {}", map.across, short(*value)));
    let mut table = Table::about("method", [map.down.to_owned()].into_iter().chain(columns));
    let mut reasons: Vec<String> = Vec::new();
    let mut found: Vec<(&str, Vec<&Fate>)> = Vec::new();
    for (method, down, fates) in rows.filter(|(.., fates)| fates.len() == across.len()) {
        let hopeless = Method::find(method.method()).is_ok_and(Method::is_never_stable);
        let label = method.label.as_str();
        let cells = fates.iter().map(|fate| {
            let mark = match fate {
                Fate::Diverged(_) if hopeless => Mark::Expected,
                _ => Mark::Plain,
            };
            Cell::Marked(fate.word(), mark)
        });
        table.line(label, [Cell::from(down)].into_iter().chain(cells));
        reasons.extend(fates.iter().filter_map(|fate| match fate {
            Fate::Refused(reason) => Some(format!("Refused: {label}: {reason}.")),
            _ => None,
        }));
        match found.last_mut() {
            Some((method, all)) if *method == label => all.extend(fates),
            _ => found.push((label, fates.iter().collect())),
        }
    }
    let passed = found
        .iter()
        .map(|(name, fates)| passed(name, fates))
        .join(", ");
    study.section.notes.extend(reasons.into_iter().unique());
    study.table(&format!("stability-{}", map.name), map.caption, table);
    let sheets = across.len() * down.len();
    format!("{}, of {sheets} sheets ok: {passed}.", map.caption)
}

/// How many sheets a method got through, in words.
fn passed(method: &str, fates: &[&Fate]) -> String {
    let ok = fates.iter().filter(|fate| ***fate == Fate::Ok).count();
    let strained = fates
        .iter()
        .filter(|fate| matches!(fate, Fate::Strained(_)));
    match strained.count() {
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
            .try_collect::<_, Vec<_>, _>()
    };
    let Some(found) = study.case("limit of symplectic Euler", measure) else {
        return "The limit of symplectic Euler was not found.".into();
    };
    let curve = |of: fn(&Limit) -> Number| {
        let point = move |limit: &Limit| (limit.stiffness.0, of(limit).0);
        found.iter().map(point)
    };
    let measured = Series::new("symplectic-euler", curve(|limit| limit.found).collect());
    let (stiffness, step) = (Axis::log("stiffness (N/m)"), Axis::log("step (s)"));
    let plot = Plot::new("The largest step of symplectic Euler", stiffness, step)
        .points([measured])
        .exact("2/ω of the stiffest mode", curve(|limit| limit.expected))
        .note("A chain of 20 masses of 0.01 kg, held at one end, shaken along itself.");
    study.plot("stability-limit", &plot);
    study.table("stability-limit", "The limit of symplectic Euler", &found);
    let error = |limit: &Limit| (limit.found.0 / limit.expected.0 - 1.0).abs();
    let worst = found.iter().map(error).fold(0.0, Real::max);
    format!("Symplectic Euler explodes where the closed form says, to {worst:.0e}.")
}

/// Longitudinal motion of a chain is linear, so the limit is that of its stiffest mode.
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
