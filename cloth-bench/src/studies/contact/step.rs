//! One step of implicit Euler in contact as a problem with a known answer, and how far each method is from it.

use super::survival::scene_of;
use crate::studies::cases::LazyCell;
use crate::studies::prelude::*;
use cloth_core::contact::{ContactSource, ContactStep};
use cloth_core::measure::{IncrementalPotential, predict};
use cloth_core::method::family::Energies;
use std::time::Instant;

/// Tolerance of the reference.
const EXACT: Real = 1e-10;
/// A reference has at most this gradient, relative to that at the start of the step.
const MOST_GRADIENT: Real = 1e-6;
/// Scenes, and the steps of each before the one that is looked at: a sheet lies on a sphere with its middle, and its
/// sides still fall; a strip folds onto itself; sheets land on each other; a tube buckles on a floor.
pub const MOMENTS: [(&str, u32); 4] = [
    ("drape-sphere", 17),
    ("fold", 25),
    ("stack", 3),
    ("garment", 20),
];

/// Vertices a side.
fn sides(scope: Scope, scene: &str) -> &'static [u32] {
    match scene {
        "drape-sphere" => scope.pick(&[13], &[33, 64]),
        _ => scope.pick(&[9], &[33]),
    }
}

/// A step from a state in which cloth lies on a body, with the minimiser of G, the contact potential and its lagged
/// friction included.
#[derive(Debug)]
pub struct ContactProblem {
    scene: Scene,
    energies: Energies,
    state: State,
    predicted: Vec<Vec3>,
    minimiser: Vec<Vec3>,
    minimum: Real,
    /// G − G* and ‖∇G‖ at the start of the step.
    start: [Real; 2],
}

/// How far from the minimiser a step has ended, and what it took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reached {
    /// ‖x − x*‖_M/‖x̃ − x*‖_M (dimensionless): 1 at the inertial prediction, which has gone into the sphere.
    pub position: Number,
    /// (G − G*)/(G(xₙ) − G*) (dimensionless): 1 where the step starts; none if the straight path there is not free of
    /// crossings.
    pub(super) objective: Option<Number>,
    /// Seconds of the step.
    pub(super) seconds: Number,
    /// Its iterations, over all substeps.
    pub(super) iterations: u32,
}

impl ContactProblem {
    /// The step after so many of implicit Euler, of one of the scenes that [`scene_of`] knows.
    pub fn new(scene: &str, n: u32, steps_before: u32) -> Result<Self, BenchError> {
        let scene = scene_of(scene, n, "")?;
        let implicit = Method::find("implicit-euler")?;
        let (_, state) = run::simulate(
            &scene,
            implicit,
            &Settings::default(),
            scene.dt,
            steps_before,
        )?;
        let mut predicted = state.positions.clone();
        let input = StepInput::new(scene.dt).gravity(scene.gravity);
        predict(&scene.model.particles, &state, &input, &mut predicted);
        let energies = scene.model.energies()?;
        let mut problem = Self {
            scene,
            energies,
            state,
            predicted,
            minimiser: Vec::new(),
            minimum: 0.0,
            start: [1.0; 2],
        };
        let exact = Settings::of(&format!("tolerance={EXACT} iterations=200000"));
        problem.minimiser = problem.take(implicit, &exact)?.0;
        let not_free = || BenchError::Failed("the reference goes through something".into());
        let (minimum, gradient) = problem
            .objective(&problem.minimiser)?
            .ok_or_else(not_free)?;
        let (value, at_start) = problem
            .objective(&problem.state.positions)?
            .ok_or_else(not_free)?;
        problem.minimum = minimum;
        problem.start = [value - minimum, at_start];
        if !(value > minimum && gradient < MOST_GRADIENT * at_start) {
            return Err(BenchError::Failed(format!(
                "the reference did not converge: ‖∇G‖ = {:e} of that at the start of the step",
                gradient / at_start
            )));
        }
        Ok(problem)
    }

    /// Where a method takes the step from the state, its report's iterations, and seconds.
    fn take(
        &self,
        method: &Method,
        settings: &Settings,
    ) -> Result<(Vec<Vec3>, u32, Real), BenchError> {
        let scene = &self.scene;
        let mut solver = method.build(scene, settings, scene.dt)?;
        // Once to warm up: memory, and what is factorised once. The second step has the same start.
        let mut taken = (Vec::new(), 0, Real::INFINITY);
        for _ in 0..2 {
            let mut contacts = scene.contacts()?;
            let mut state = self.state.clone();
            let parts = solver.preferred_substeps();
            let mut iterations = 0;
            let started = Instant::now();
            for _ in 0..parts {
                let dt = scene.dt / Real::from(parts);
                let mut input = StepInput::new(dt).gravity(scene.gravity);
                if let Some(contacts) = &mut contacts {
                    input = input.contacts(contacts);
                }
                iterations += solver.step(&mut state, input)?.iterations;
            }
            let seconds = started.elapsed().as_secs_f64();
            taken = (state.positions, iterations, seconds);
        }
        Ok(taken)
    }

    /// G (J) and ‖∇G‖ (N/√kg) at a place that the step may end at, contact included; none if the straight path there
    /// from the start of the step is not free of crossings.
    fn objective(&self, x: &[Vec3]) -> Result<Option<(Real, Real)>, BenchError> {
        let particles = &self.scene.model.particles;
        let without = IncrementalPotential {
            particles,
            energies: &self.energies,
            predicted: &self.predicted,
            dt: self.scene.dt,
        };
        let mut gradient = vec![Vec3::zeros(); x.len()];
        let mut value = without.gradient_into(x, &mut gradient);
        if let Some(mut contacts) = self.scene.contacts()? {
            let potential = contacts.potential();
            let step = ContactStep {
                from: &self.state.positions,
                inverse_mass: particles.inverse_mass(),
                dt: self.scene.dt,
            };
            let mut end = x.to_vec();
            potential.begin(&step, &mut end)?;
            if end != x {
                return Ok(None);
            }
            value += potential.add_gradient(x, &mut gradient);
        }
        Ok(Some((value, without.gradient_norm(&gradient))))
    }

    /// What a method makes of the step.
    pub fn reached(&self, method: &Method, settings: &Settings) -> Result<Reached, BenchError> {
        let (x, iterations, seconds) = self.take(method, settings)?;
        let objective = self.objective(&x)?;
        let away = |(value, _): (Real, Real)| Number((value - self.minimum) / self.start[0]);
        Ok(Reached {
            position: Number(self.distance(&x) / self.distance(&self.predicted)),
            objective: objective.map(away),
            seconds: Number(seconds),
            iterations,
        })
    }

    /// ‖x − x*‖_M (√kg m).
    fn distance(&self, x: &[Vec3]) -> Real {
        let mass = self.scene.model.particles.mass();
        let pairs = x.iter().zip(&self.minimiser).zip(mass);
        pairs
            .map(|((a, b), m)| m * (a - b).norm_squared())
            .sum::<Real>()
            .sqrt()
    }
}

/// Methods with a setting that is made finer and finer: what is not its default beside it, its key, and its values.
pub fn refined(scope: Scope) -> Vec<(Variant, &'static str, Vec<String>)> {
    let counts = (0..scope.pick(5, 8)).map(|i| (5 << i).to_string());
    let counts: Vec<String> = counts.collect();
    let tolerances = ["1", "1e-1", "1e-2", "1e-3", "1e-4", "1e-6"].map(str::to_owned);
    let variants = Variant::list(
        "implicit-euler, by tolerance
        pd, by iterations: iterations=5
        xpbd, by iterations: substeps=1
        xpbd, by substeps: iterations=1
        pbd, by substeps: iterations=1",
    );
    let keys = [
        "tolerance",
        "iterations",
        "iterations",
        "substeps",
        "substeps",
    ];
    let values = |key| match key {
        "tolerance" => tolerances.to_vec(),
        _ => counts.clone(),
    };
    let own = iterating_own().map(|own| {
        let mut variant = Variant::uncut(own);
        variant.label.push_str(", by iterations");
        (variant, "iterations")
    });
    let all = variants.into_iter().zip(keys).chain(own);
    all.map(|(variant, key)| (variant, key, values(key)))
        .collect()
}

/// A step by a method.
#[derive(Clone, Default, Serialize)]
struct Row {
    scene: &'static str,
    n: u32,
    method: String,
    setting: String,
    iterations: u32,
    ms: Real,
    position_error: Real,
    objective_error: Option<Real>,
}

/// A method, what is set of it, and the setting in words.
type Way = (Variant, String);

/// Every method at its default. What grows until it is torn to pieces keeps the last resort of contact busy for
/// minutes.
fn by_default() -> Vec<Way> {
    method::all()
        .filter(|method| method.aims_at_implicit_euler() && !method.is_never_stable())
        .map(|method| (Variant::default_of(method), "default".to_owned()))
        .collect()
}

/// Those of [`refined`], value by value.
fn finer(scope: Scope) -> Vec<Way> {
    let of_value = |(variant, key, values): (Variant, &'static str, Vec<String>)| {
        values.into_iter().map(move |value| {
            let mut variant = variant.clone();
            variant.settings = variant.settings.with(key, &value);
            (variant, format!("{key}={value}"))
        })
    };
    refined(scope).into_iter().flat_map(of_value).collect()
}

/// Steps of a scene with `n` vertices a side.
fn steps(
    study: &mut StudyRun<'_>,
    (scene, n): (&'static str, u32),
    problem: &mut LazyCell<ContactProblem, impl FnMut() -> Result<ContactProblem, BenchError>>,
    ways: Vec<Way>,
) -> Vec<Row> {
    let found = study.grid(
        ways,
        |(variant, setting)| {
            format!(
                "a step of {scene} by {}, {setting}, {n} × {n}",
                variant.label
            )
        },
        |(variant, _)| {
            let method = Method::find(variant.method())?;
            problem.get()?.reached(method, &variant.settings)
        },
    );
    let row = |((variant, setting), reached): (Way, Reached)| Row {
        scene,
        n,
        method: variant.label,
        setting,
        iterations: reached.iterations,
        ms: 1e3 * reached.seconds.0,
        position_error: reached.position.0,
        objective_error: reached.objective.map(|error| error.0),
    };
    found.into_iter().map(row).collect()
}

pub(super) fn run(study: &mut StudyRun<'_>) {
    let (mut defaults, mut samples) = (Vec::new(), Vec::new());
    let columns = WANTED.map(|wanted| format!("to {}", percent(wanted)));
    let mut told = Table::about("scene, vertices", columns);
    for (scene, steps_before) in MOMENTS {
        for &n in sides(study.scope, scene) {
            let mut problem = LazyCell::new(|| ContactProblem::new(scene, n, steps_before));
            let at = (scene, n);
            let by_default = steps(study, at, &mut problem, by_default());
            let finer = steps(study, at, &mut problem, finer(study.scope));
            plot(study, at, &finer);
            let all = || by_default.iter().chain(&finer);
            let reached = || all().map(|row| (&*row.method, row.position_error, row.ms));
            let fastest = WANTED.map(|wanted| fastest_to(wanted, reached()));
            told.line(Cell::said(format!("{scene}, {n} × {n}")), fastest);
            defaults.extend(by_default);
            samples.extend(finer);
        }
    }
    study.table(
        "contact-step",
        "One step in contact, every method at its default (but forward Euler, which is not stable at any)",
        &defaults,
    );
    study.data("contact-step-samples", &samples);
    let first = MOMENTS[0].0;
    let sides = sides(study.scope, first);
    study.answer(
        "Which method at which error in contact?",
        "The fastest to a step of implicit Euler; the error is the distance from its end, over that of the inertial prediction.".into(),
        Some(told),
        &format!("figure-contact-step-{first}-position-{}", sides[0]),
    );
}

/// How far methods are from the end of the step, and from its minimum, against time.
fn plot(study: &mut StudyRun<'_>, (scene, n): (&str, u32), rows: &[Row]) {
    let position = rows.iter().map(|row| (row, row.position_error));
    let objective = rows
        .iter()
        .filter_map(|row| Some((row, row.objective_error?.max(Real::EPSILON))));
    let of = |(row, error): (&Row, Real)| (row.method.clone(), (row.ms, error));
    for (name, title, error, series) in [
        (
            "position",
            "Distance from the implicit Euler step",
            "‖x − x*‖_M/‖x̃ − x*‖_M",
            curves(position, of),
        ),
        (
            "objective",
            "Objective with contact and friction",
            "(G − G*)/(G(xₙ) − G*)",
            curves(objective, of),
        ),
    ] {
        let title = format!("{title}, {scene}, {n} × {n} vertices");
        let error = Axis::log(&format!("{error} (dimensionless)"));
        let plot = Plot::new(title, Axis::log("time of the step (ms)"), error).with(series);
        let name = format!("contact-step-{scene}-{name}-{n}");
        study.plot(&name, &plot);
    }
}

/// Position errors (dimensionless) that are asked for.
const WANTED: [Real; 4] = [0.3, 0.1, 1e-2, 1e-3];
