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
    scope.pick(&[17], &[33, 64])
}

/// A step from a state in which cloth lies on a body, with the minimiser of G, the contact potential and its lagged
/// friction included.
#[derive(Debug)]
pub(super) struct ContactProblem {
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
pub(super) struct Reached {
    /// ‖x − x*‖_M/‖x̃ − x*‖_M (dimensionless): 1 at the inertial prediction, which has gone into the sphere.
    pub(super) position: Number,
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
    pub(super) fn new(n: u32) -> Result<Self, BenchError> {
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
            let mut input = StepInput::new(scene.dt).gravity(scene.gravity);
            if let Some(contacts) = &mut contacts {
                input = input.contacts(contacts);
            }
            let started = Instant::now();
            let report = solver.step(&mut state, input)?;
            let seconds = started.elapsed().as_secs_f64();
            taken = (state.positions, report.iterations, seconds);
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
    pub(super) fn reached(
        &self,
        method: &Method,
        settings: &Settings,
    ) -> Result<Reached, BenchError> {
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

/// A method with a setting that is made finer and finer.
struct Refined {
    label: &'static str,
    method: &'static str,
    /// The setting, its values, and what is not its default beside it.
    key: &'static str,
    values: Vec<String>,
    others: Settings,
}

fn refined(scope: Scope) -> Vec<Refined> {
    let most: u32 = scope.pick(5, 8);
    let counts = || (0..most).map(|i| (5 << i).to_string()).collect::<Vec<_>>();
    let tolerances = ["1", "1e-1", "1e-2", "1e-3", "1e-4", "1e-6"];
    let one_iteration = Settings::default().with("iterations", 1);
    vec![
        Refined {
            label: "implicit-euler, by tolerance",
            method: "implicit-euler",
            key: "tolerance",
            values: tolerances.map(str::to_owned).to_vec(),
            others: Settings::default(),
        },
        Refined {
            label: "pd, by iterations",
            method: "pd",
            key: "contact_iterations",
            values: counts(),
            others: Settings::default().with("iterations", 5),
        },
        Refined {
            label: "xpbd, by iterations",
            method: "xpbd",
            key: "iterations",
            values: counts(),
            others: Settings::default().with("substeps", 1),
        },
        Refined {
            label: "xpbd, by substeps",
            method: "xpbd",
            key: "substeps",
            values: counts(),
            others: one_iteration.clone(),
        },
        Refined {
            label: "pbd, by substeps",
            method: "pbd",
            key: "substeps",
            values: counts(),
            others: one_iteration,
        },
    ]
}

pub(super) fn run(study: &mut StudyRun<'_>) {
    let scope = study.scope;
    let columns = [
        "n",
        "method",
        "setting",
        "iterations",
        "ms",
        "position error",
        "objective error",
    ];
    let (mut table, mut samples) = (Table::new(&columns), Table::new(&columns));
    let mut told = Vec::new();
    for &n in sides(scope) {
        let mut problem = LazyCell::new(|| ContactProblem::new(n));
        let mut found: Vec<(&str, Reached)> = Vec::new();
        for method in method::all().filter(|method| method.aims_at_implicit_euler()) {
            let case = format!("a step of {} in contact, {n} × {n}", method.name);
            let settings = method.by_default(Settings::default());
            let Some(reached) = study.case(&case, || problem.get()?.reached(method, &settings))
            else {
                continue;
            };
            table.push(row(n, method.name, "default", &reached));
            found.push((method.name, reached));
        }
        let (mut by_time, mut by_objective) = (Vec::new(), Vec::new());
        for refined in refined(scope) {
            let mut curve = Vec::new();
            for value in &refined.values {
                let setting = format!("{}={value}", refined.key);
                let case = format!("{} in contact, {setting}, {n} × {n}", refined.label);
                let settings = refined.others.clone().with(refined.key, value);
                let reached = study.cases.case(&case, || {
                    let method = Method::find(refined.method)?;
                    problem.get()?.reached(method, &settings)
                });
                let Some(reached) = study.findings.unless_failed(&case, reached) else {
                    continue;
                };
                samples.push(row(n, refined.label, &setting, &reached));
                found.push((refined.label, reached));
                curve.push(reached);
            }
            let ms = |r: &Reached| 1e3 * r.seconds.0;
            let position = curve.iter().map(|r| (ms(r), r.position.0));
            by_time.push(Series::new(refined.label, position.collect()));
            let objective = curve
                .iter()
                .filter_map(|r| Some((ms(r), r.objective?.0.max(Real::EPSILON))));
            by_objective.push(Series::new(refined.label, objective.collect()));
        }
        for (name, title, error, series) in [
            (
                "position",
                "Distance from the implicit Euler step in contact",
                "‖x − x*‖_M/‖x̃ − x*‖_M",
                by_time,
            ),
            (
                "objective",
                "Objective with contact and friction",
                "(G − G*)/(G(xₙ) − G*)",
                by_objective,
            ),
        ] {
            study.findings.plot(
                &format!("contact-step-{name}-{n}"),
                &Plot {
                    title: format!("{title}, {n} × {n} vertices"),
                    x: Axis::log("time of the step (ms)"),
                    y: Axis::log(&format!("{error} (dimensionless)")),
                    series,
                    note: String::new(),
                },
            );
        }
        told.push(format!("{n} × {n}: {}", fastest(&found)));
    }
    study.findings.table(
        "contact-step",
        "One step of a sheet that lies on a sphere with its middle, every method at its default",
        table,
    );
    study.findings.data("contact-step-samples", samples);
    study.findings.answer(
        "Which method at which error in contact?",
        format!(
            "For the implicit Euler step of a sheet on a sphere, by the distance from its end, as a part of that of the inertial prediction: {}.",
            told.join("; at ")
        ),
    );
}

fn row(n: u32, label: &str, setting: &str, reached: &Reached) -> [Cell; 7] {
    [
        Cell::from(n as usize),
        Cell::from(label),
        Cell::from(setting),
        Cell::from(reached.iterations as usize),
        Cell::from(1e3 * reached.seconds.0),
        Cell::from(reached.position.0),
        Cell::from(reached.objective.map(|error| error.0)),
    ]
}

/// Who is the first at each error, in words.
fn fastest(found: &[(&str, Reached)]) -> String {
    let parts = [0.3, 0.1, 1e-2, 1e-3].map(|wanted| {
        let there = found.iter().filter(|(_, r)| r.position.0 <= wanted);
        let first = there.min_by(|(_, a), (_, b)| a.seconds.0.total_cmp(&b.seconds.0));
        first.map_or(format!("nobody gets to {wanted}"), |(label, reached)| {
            let ms = significant(1e3 * reached.seconds.0, 3);
            format!("{label} to {wanted} ({ms} ms)")
        })
    });
    parts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Implicit Euler gets as near to the minimiser as its tolerance says, projective dynamics with enough iterations,
    /// and the sweeps of XPBD in one substep come nearer slowly.
    #[test]
    fn methods_approach_the_minimiser_with_contact() {
        let problem = ContactProblem::new(13).unwrap();
        let error = |name: &str, key: &str, values: [&str; 3]| {
            let method = Method::find(name).unwrap();
            let settings = Settings::default();
            let settings = match name {
                "xpbd" => settings.with("substeps", 1),
                _ => settings,
            };
            let reached = |value| problem.reached(method, &settings.clone().with(key, value));
            values.map(|value| reached(value).unwrap().position.0)
        };
        let implicit = error("implicit-euler", "tolerance", ["1e-2", "1e-4", "1e-6"]);
        assert!(implicit[0] < 0.1 && implicit[2] < 2e-5, "{implicit:?}");
        let pd = error("pd", "contact_iterations", ["10", "100", "1000"]);
        assert!(pd[0] > 1.0 && pd[2] < 1e-4, "{pd:?}");
        let xpbd = error("xpbd", "iterations", ["10", "100", "1000"]);
        assert!(xpbd.is_sorted_by(|a, b| a > b) && xpbd[2] > 0.1, "{xpbd:?}");
    }
}
