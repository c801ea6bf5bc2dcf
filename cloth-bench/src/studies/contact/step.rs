//! One step of implicit Euler in contact as a problem with a known answer, and how far each method is from it.

use super::survival::scene_of;
use crate::studies::convergence::variants::{cut, iterated};
use crate::studies::prelude::*;
use crate::yardstick::Recorder;
use cloth_core::contact::{ContactSource, ContactStep};
use cloth_core::measure::{IncrementalPotential, predict};
use cloth_core::method::family::Energies;

/// Tolerance of the reference.
const EXACT: Real = 1e-10;
/// A reference has at most this gradient, relative to that at the start of the step.
const MOST_GRADIENT: Real = 1e-6;
/// Runs whose times have a median, and the time (s) after which there are no more of them.
const RUNS: usize = 3;
const LONG: Real = 1.0;
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

/// Where a step has come to.
#[derive(Clone, Debug)]
struct Place {
    iterations: u32,
    seconds: Real,
    positions: Vec<Vec3>,
}

/// How far from the minimiser a step is, or has ended, and what it took until then.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reached {
    /// ‖x − x*‖_M/‖x̃ − x*‖_M (dimensionless): 1 at the inertial prediction, which has gone into the sphere.
    #[serde(rename = "position error")]
    pub position: Number,
    /// (G − G*)/(G(xₙ) − G*) (dimensionless): 1 where the step starts; none if the straight path there is not free of
    /// crossings.
    #[serde(rename = "objective error")]
    objective: Option<Number>,
    /// Time until then.
    ms: Number,
    /// Iterations until then, over all substeps.
    pub iterations: u32,
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
        problem.minimiser = problem.end(implicit, &exact)?.positions;
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

    /// Where a method comes to, on the way if it is watched, and at the end. Times are medians.
    fn take(
        &self,
        method: &Method,
        settings: &Settings,
        is_watched: bool,
    ) -> Result<Vec<Place>, BenchError> {
        let mut solver = method.build(&self.scene, settings, self.scene.dt)?;
        // Once to warm up: memory, and what is factorised once. Every run has the same start.
        let mut places = self.once(&mut *solver, is_watched)?;
        let (mut runs, mut spent) = (Vec::new(), 0.0);
        while runs.len() < RUNS && spent < LONG {
            places = self.once(&mut *solver, is_watched)?;
            spent += places.last().map_or(LONG, |end| end.seconds);
            runs.push(places.iter().map(|place| place.seconds).collect_vec());
        }
        for (number, place) in places.iter_mut().enumerate() {
            let times = runs.iter().filter_map(|run| run.get(number).copied());
            place.seconds = median(&mut times.collect_vec());
        }
        Ok(places)
    }

    /// The step once: about twenty places per decade of iterations, those that first have the errors of [`WANTED`], and
    /// the end.
    fn once(&self, solver: &mut dyn Stepper, is_watched: bool) -> Result<Vec<Place>, BenchError> {
        let mut contacts = self.scene.contacts()?;
        let mut state = self.state.clone();
        let parts = solver.preferred_substeps();
        let (mut places, mut iterations) = (Vec::new(), 0);
        let (mut next, mut wanted) = (0.0, WANTED.into_iter().peekable());
        let mut recorder = Recorder::new(|iterations, seconds, x: &[Vec3]| {
            let mut keep = Real::from(iterations) >= next;
            let error = self.position_error(x);
            while wanted.next_if(|wanted| error <= *wanted).is_some() {
                keep = true;
            }
            if keep {
                next = 1.12 * Real::from(iterations);
                let positions = x.to_vec();
                places.push(Place {
                    iterations,
                    seconds,
                    positions,
                });
            }
        });
        for _ in 0..parts {
            let dt = self.scene.dt / Real::from(parts);
            let mut input = StepInput::new(dt).gravity(self.scene.gravity);
            if let Some(contacts) = &mut contacts {
                input = input.contacts(contacts);
            }
            if is_watched {
                input = input.observer(&mut recorder);
            }
            iterations += solver.step(&mut state, input)?.iterations;
        }
        let seconds = recorder.seconds();
        places.push(Place {
            iterations,
            seconds,
            positions: state.positions,
        });
        Ok(places)
    }

    /// Where a method ends the step.
    fn end(&self, method: &Method, settings: &Settings) -> Result<Place, BenchError> {
        let nowhere = || BenchError::Failed("the step has no end".into());
        self.take(method, settings, false)?
            .pop()
            .ok_or_else(nowhere)
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
        self.error(&self.end(method, settings)?)
    }

    /// What it makes of it iteration by iteration, and in the end.
    pub fn trace(&self, method: &Method, settings: &Settings) -> Result<Vec<Reached>, BenchError> {
        let places = self.take(method, settings, true)?;
        places.iter().map(|place| self.error(place)).collect()
    }

    fn error(&self, place: &Place) -> Result<Reached, BenchError> {
        let objective = self.objective(&place.positions)?;
        let away = |(value, _): (Real, Real)| Number((value - self.minimum) / self.start[0]);
        Ok(Reached {
            position: Number(self.position_error(&place.positions)),
            objective: objective.map(away),
            ms: Number(1e3 * place.seconds),
            iterations: place.iterations,
        })
    }

    /// ‖x − x*‖_M/‖x̃ − x*‖_M (dimensionless).
    fn position_error(&self, x: &[Vec3]) -> Real {
        self.distance(x) / self.distance(&self.predicted)
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

/// What iterates without contact, but is no other way with it, or leads elsewhere: Newton's matrix has no place for
/// contact, PD has neither Chebyshev nor a coarse grid, XPBD as one system takes it at the end of a substep, and rigid
/// projections do not look at k.
const NOT_IN_CONTACT: [&str; 8] = [
    "implicit-euler, Newton",
    "pd, Chebyshev",
    "pd, Chebyshev, ρ given",
    "pd, no coarse grid",
    "xpbd-direct",
    "pbd, rigid",
    "pbd, Chebyshev",
    "pbd, coarse levels",
];

/// What is measured after every iteration.
pub fn traced(scope: Scope) -> Vec<Variant> {
    let mut variants = iterated(scope);
    variants.retain(|variant| !NOT_IN_CONTACT.contains(&variant.label.as_str()));
    variants
}

/// What is measured, and what is set of it: by default, after every one of its iterations, or with substeps.
fn ways(scope: Scope) -> impl Iterator<Item = (Variant, String)> {
    // What grows until it is torn to pieces keeps the last resort of contact busy for minutes.
    let usable = |method: &&Method| method.aims_at_implicit_euler() && !method.is_never_stable();
    let by_default = method::all().filter(usable).map(Variant::default_of);
    let by_default = by_default.map(|variant| (variant, DEFAULT.to_owned()));
    let by_iterations = traced(scope).into_iter();
    let by_iterations = by_iterations.map(|variant| (variant, ITERATIONS.to_owned()));
    let by_substeps = cut(scope).into_iter().map(|(method, parts)| {
        let (label, setting) = (format!("{method}, substeps"), format!("substeps={parts}"));
        let settings = Settings::of(&format!("{setting} iterations=1"));
        (Variant { label, settings }, setting)
    });
    by_default.chain(by_iterations).chain(by_substeps)
}

const DEFAULT: &str = "default";
const ITERATIONS: &str = "iterations";

/// Scene, vertices a side, method, and what is set of it.
type At = (&'static str, u32, String, String);

pub(super) fn run(study: &mut StudyRun<'_>) {
    let (mut rows, mut counts): (Vec<(At, Reached)>, Vec<_>) = Default::default();
    let columns = WANTED.map(|wanted| format!("to {}", percent(wanted)));
    let mut told = Table::about("scene, vertices", columns.clone());
    let scope = study.scope;
    let sizes = |(scene, steps)| iproduct!([scene], sides(scope, scene), [steps]);
    for (scene, &n, steps_before) in MOMENTS.into_iter().flat_map(sizes) {
        let mut problem = LazyCell::new(|| ContactProblem::new(scene, n, steps_before));
        let found = study.grid(
            ways(scope),
            |(variant, setting)| {
                format!("a step of {scene}, {n} × {n}, {}, {setting}", variant.label)
            },
            |(variant, setting)| {
                let (problem, settings) = (problem.get()?, &variant.settings);
                let method = Method::find(variant.method())?;
                match &**setting {
                    ITERATIONS => problem.trace(method, settings),
                    _ => Ok(vec![problem.reached(method, settings)?]),
                }
            },
        );
        let mut ours = Vec::new();
        for ((Variant { label, .. }, setting), reached) in found {
            if setting == ITERATIONS {
                let first = |wanted| reached.iter().find(|at| at.position.0 <= wanted);
                let taken = WANTED.map(|wanted| Some(first(wanted)?.iterations));
                counts.push(((scene, n, label.clone()), taken));
            }
            let at = |reached| ((scene, n, label.clone(), setting.clone()), reached);
            ours.extend(reached.into_iter().map(at));
        }
        plot(study, (scene, n), &ours);
        let reached = ours
            .iter()
            .map(|((_, _, label, _), at)| (&**label, at.position.0, at.ms.0));
        let fastest = WANTED.map(|wanted| fastest_to(wanted, reached.clone()));
        told.line(Cell::said(format!("{scene}, {n} × {n}")), fastest);
        rows.extend(ours);
    }
    let named = ["scene", "n", "method"].map(str::to_owned);
    let columns = [&named[..], &columns.map(|to| format!("iterations {to}"))].concat();
    let (defaults, samples): (Vec<_>, Vec<_>) =
        rows.into_iter().partition(|(at, _)| at.3 == DEFAULT);
    let of_step = |rows: &[(At, Reached)]| Table::named(&["scene", "n", "method", "setting"], rows);
    study.table(
        "contact-step",
        "One step in contact, every method that aims at the implicit Euler step, at its default (so not bdf2 and implicit-midpoint; nor forward Euler, which is stable at none)",
        of_step(&defaults),
    );
    study.table(
        "contact-step-iterations",
        "How many iterations each way takes to a distance from the implicit Euler step, over that of the inertial prediction",
        Table::named(&columns, &counts),
    );
    study.data("contact-step-samples", of_step(&samples));
    let first = MOMENTS[0].0;
    let sides = sides(scope, first);
    study.answer(
        "Which method at which error in contact?",
        "The fastest to a step of implicit Euler; the error is the distance from its end, over that of the inertial prediction.".into(),
        Some(told),
        &format!("figure-contact-step-{first}-position-time-{}", sides[0]),
    );
}

/// How far methods are from the end of the step, and from its minimum, against iterations and time.
fn plot(study: &mut StudyRun<'_>, (scene, n): (&str, u32), rows: &[(At, Reached)]) {
    type Of<T> = fn(&Reached) -> T;
    let position: Of<Option<Real>> = |at| Some(at.position.0);
    let objective: Of<_> = |at| Some(at.objective?.0.max(Real::EPSILON));
    let (iterations, time): (Of<_>, Of<_>) = (|at| Real::from(at.iterations), |at| at.ms.0);
    let errors = [
        (
            "position",
            "Distance from the implicit Euler step",
            "‖x − x*‖_M/‖x̃ − x*‖_M",
            position,
        ),
        (
            "objective",
            "Objective with contact and friction",
            "(G − G*)/(G(xₙ) − G*)",
            objective,
        ),
    ];
    let efforts = [
        ("iterations", "iterations (dimensionless)", iterations),
        ("time", "time of the step (ms)", time),
    ];
    for ((name, title, y, error), (against, x, effort)) in iproduct!(errors, efforts) {
        let rows = rows.iter().filter(|(at, _)| at.3 != DEFAULT);
        let rows = rows.filter_map(|(at, reached)| Some((&at.2, effort(reached), error(reached)?)));
        let series = curves(rows, |(label, effort, error)| {
            (label.clone(), (effort, error))
        });
        let title = format!("{title} against {against}, {scene}, {n} × {n} vertices");
        let y = Axis::log(&format!("{y} (dimensionless)"));
        let plot = Plot::new(title, Axis::log(x), y).with(series);
        study.plot(&format!("contact-step-{scene}-{name}-{against}-{n}"), &plot);
    }
}

/// Position errors (dimensionless) that are asked for.
const WANTED: [Real; 4] = [0.3, 0.1, 1e-2, 1e-3];
