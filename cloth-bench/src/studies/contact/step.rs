//! One step of implicit Euler in contact as a problem with a known answer, and how far each method is from it.

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
/// Steps before the one that is looked at: the sheet lies on the sphere with its middle, and its sides still fall.
const STEPS_BEFORE: u32 = 17;

/// Vertices a side.
fn sides(scope: Scope) -> &'static [u32] {
    scope.pick(&[13], &[33, 64])
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
    /// The step after so many of implicit Euler of the scene `drape-sphere`.
    ///
    /// # Errors
    /// [`BenchError::Failed`] if the reference does not converge.
    pub fn new(n: u32) -> Result<Self, BenchError> {
        let scene = scene::build("drape-sphere", None, &Settings::default().with("n", n))?;
        let implicit = Method::find("implicit-euler")?;
        let (_, state) = run::from_start(
            &scene,
            implicit,
            &Settings::default(),
            scene.dt,
            STEPS_BEFORE,
            |_, _, _| Ok(()),
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
            let parts = solver.parts();
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
    ///
    /// # Errors
    /// [`BenchError::Failed`] with the method's own error.
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
#[must_use]
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
        let mut variant = Variant::default_of(own);
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
    n: u32,
    method: String,
    setting: String,
    iterations: u32,
    ms: Real,
    position_error: Real,
    objective_error: Option<Real>,
}

/// Steps by one or several methods on a sheet of `n` vertices a side: method, what is set of it, and the name of the
/// case.
fn steps(
    study: &mut StudyRun<'_>,
    n: u32,
    problem: &mut LazyCell<ContactProblem, impl FnMut() -> Result<ContactProblem, BenchError>>,
    all: Vec<(Variant, String, String)>,
) -> Vec<Row> {
    let found = study.grid(
        all,
        |(.., case)| case.clone(),
        |(variant, ..)| {
            let method = Method::find(variant.method())?;
            problem.get()?.reached(method, &variant.settings)
        },
    );
    let row = |((variant, setting, _), reached): ((Variant, _, _), Reached)| Row {
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
    let (mut defaults, mut samples, mut told) = (Vec::new(), Vec::new(), Vec::new());
    for &n in sides(study.scope) {
        let mut problem = LazyCell::new(|| ContactProblem::new(n));
        // What grows until it is torn to pieces keeps the last resort of contact busy for minutes.
        let compared = method::all()
            .filter(|method| method.aims_at_implicit_euler() && !method.is_never_stable());
        let by_default = |method: &Method| {
            let case = format!("a step of {} in contact, {n} × {n}", method.name);
            let mut variant = Variant::default_of(method);
            variant.settings = method.by_default(variant.settings);
            (variant, "default".to_owned(), case)
        };
        let by_default: Vec<_> = compared.map(by_default).collect();
        let by_default = steps(study, n, &mut problem, by_default);
        let mut finer = Vec::new();
        for (variant, key, values) in refined(study.scope) {
            finer.extend(values.into_iter().map(|value| {
                let setting = format!("{key}={value}");
                let case = format!("{} in contact, {setting}, {n} × {n}", variant.label);
                let mut variant = variant.clone();
                variant.settings = variant.settings.with(key, value);
                (variant, setting, case)
            }));
        }
        let finer = steps(study, n, &mut problem, finer);
        let position = finer.iter().map(|row| (row, row.position_error));
        let objective = finer
            .iter()
            .filter_map(|row| Some((row, row.objective_error?.max(Real::EPSILON))));
        let of = |(row, error): (&Row, Real)| (row.method.clone(), (row.ms, error));
        for (name, title, error, series) in [
            (
                "position",
                "Distance from the implicit Euler step in contact",
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
            let title = format!("{title}, {n} × {n} vertices");
            let error = Axis::log(&format!("{error} (dimensionless)"));
            let plot = Plot::new(title, Axis::log("time of the step (ms)"), error).with(series);
            study
                .findings
                .plot(&format!("contact-step-{name}-{n}"), &plot);
        }
        let every: Vec<&Row> = by_default.iter().chain(&finer).collect();
        told.push(format!("{n} × {n}: {}", fastest(&every)));
        defaults.extend(by_default);
        samples.extend(finer);
    }
    study.findings.table(
        "contact-step",
        "One step of a sheet that lies on a sphere with its middle, every method at its default (but forward Euler, which is not stable at any)",
        Table::of(&defaults),
    );
    study
        .findings
        .data("contact-step-samples", Table::of(&samples));
    study.findings.answer(
        "Which method at which error in contact?",
        format!(
            "For the implicit Euler step of a sheet on a sphere, by the distance from its end, as a part of that of the inertial prediction: {}.",
            told.join("; at ")
        ),
    );
}

/// Who is the first at each error, in words.
fn fastest(found: &[&Row]) -> String {
    let parts = [0.3, 0.1, 1e-2, 1e-3].map(|wanted| {
        let there = found.iter().filter(|row| row.position_error <= wanted);
        let first = there.min_by(|a, b| a.ms.total_cmp(&b.ms));
        first.map_or(format!("nobody gets to {wanted}"), |row| {
            format!("{} to {wanted} ({} ms)", row.method, significant(row.ms, 3))
        })
    });
    parts.join(", ")
}
