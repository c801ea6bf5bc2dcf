//! Whole steps to equal errors: the quasi-Newton method around multigrid, and Newton's method with every linear solver.

use super::System;
use crate::studies::prelude::*;
use crate::studies::sheets::{STIFFNESS, hanging, sixteenth_step, trace_warm};
use crate::yardstick::Sample;
use cloth_core::method::linear::{LinearMethod, Preconditioner, StoppingCriteria, spectrum};
use cloth_massspring::{ImplicitConfig, ImplicitEuler, Solve};

/// Errors (G − G*)/(G(x̃) − G*) that are waited for.
const GOALS: [Real; 2] = [1e-3, 1e-8];
/// Most iterations of Newton's method in a step.
const MOST: u32 = 60;
/// A step (s) that takes longer is the last of its solver on the way to larger and stiffer sheets.
const LONG: Real = 5.0;
/// Iterations in which condition numbers are found.
const LANCZOS: u32 = 2000;

/// A sheet whose sixteenth step is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Problem {
    #[serde(rename = "vertices a side")]
    side: u32,
    #[serde(rename = "stiffness (N/m)")]
    stiffness: Real,
}

impl Problem {
    fn of_side(side: u32) -> Self {
        Self {
            side,
            stiffness: STIFFNESS,
        }
    }

    fn name(&self) -> String {
        let Self { side, stiffness } = self;
        format!("{side} × {side}, {stiffness:e} N/m")
    }

    /// Whether it is at least as large and as stiff.
    fn is_beyond(&self, other: &Self) -> bool {
        self.side >= other.side && self.stiffness >= other.stiffness
    }
}

/// Side of the sheets whose stiffness is varied, and their stiffnesses (N/m).
const VARIED: [(u32, &[Real]); 2] = [(9, &[1e2, 1e6]), (64, &[1e2, 1e3, 1e5, 1e6])];

/// The sheets that are softer or stiffer.
fn of_other_stiffness(scope: Scope) -> impl Iterator<Item = Problem> {
    let (side, stiffnesses) = scope.of(VARIED);
    let problem = move |&stiffness| Problem { side, stiffness };
    stiffnesses.iter().map(problem)
}

fn problems(scope: Scope) -> Vec<Problem> {
    let sides = scope.of(super::SIDES).iter().copied();
    sides
        .map(Problem::of_side)
        .chain(of_other_stiffness(scope))
        .collect()
}

/// Label, how much is minimised by what, and the linear solver.
fn solvers() -> [(&'static str, Solve, LinearMethod); 7] {
    let budget = StoppingCriteria::default();
    use LinearMethod::{
        ChebyshevJacobi, Cholesky, ConjugateGradients, GaussSeidel, Jacobi, Multigrid,
    };
    let newton = |label, linear| (label, Solve::Newton, linear);
    let multigrid = LinearMethod::default();
    [
        ("quasi-Newton, multigrid", Solve::QuasiNewton, multigrid),
        newton("Newton, Cholesky", Cholesky),
        newton("Newton, multigrid gradients", Multigrid(budget)),
        newton("Newton, conjugate gradients", ConjugateGradients(budget)),
        newton("Newton, Chebyshev–Jacobi", ChebyshevJacobi(budget)),
        newton("Newton, Gauss–Seidel", GaussSeidel(budget)),
        newton("Newton, Jacobi", Jacobi(budget)),
    ]
}

/// How a solver got to the goals in one step, if it got there.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Taken {
    problem: Problem,
    solver: String,
    #[serde(rename = "iterations to 1e-3")]
    iterations: Option<u32>,
    #[serde(rename = "ms to 1e-3")]
    ms: Option<Real>,
    #[serde(rename = "iterations to 1e-8")]
    sharp_iterations: Option<u32>,
    #[serde(rename = "ms to 1e-8")]
    sharp_ms: Option<Real>,
}

/// All problems with one solver, but for those beyond one that it was lost in.
fn take(
    scope: Scope,
    (label, solve, linear): (&str, Solve, LinearMethod),
    progress: &mut dyn FnMut(&str),
) -> Result<Vec<Taken>, BenchError> {
    let mut all = Vec::new();
    let mut lost: Vec<Problem> = Vec::new();
    for problem in problems(scope) {
        if lost.iter().any(|other| problem.is_beyond(other)) {
            continue;
        }
        progress(&format!("newton: step by {label}, {}", problem.name()));
        let settings = hanging(problem.side, problem.stiffness);
        let scene = scene::build("hang", None, &settings)?;
        let step = sixteenth_step(&settings)?;
        let config = ImplicitConfig {
            solve,
            linear,
            max_iterations: match solve {
                Solve::Newton => MOST,
                _ => ImplicitConfig::default().max_iterations,
            },
            tolerance: 1e-6,
            ..Default::default()
        };
        let model = &scene.model;
        let mut solver = ImplicitEuler::builder(&model.particles)
            .elements(model.families())
            .config(config)
            .build()?;
        let trace = trace_warm(&scene, scene.gravity, &step, &mut solver)?;
        let [coarse, sharp] = GOALS.map(|goal| first_within(goal, &trace));
        let took = trace.last().map_or(0.0, |sample| sample.seconds);
        if sharp.is_none() || took > LONG {
            lost.push(problem);
        }
        all.push(Taken {
            problem,
            solver: label.to_owned(),
            iterations: coarse.map(|(count, _)| count),
            ms: coarse.map(|(_, seconds)| 1e3 * seconds),
            sharp_iterations: sharp.map(|(count, _)| count),
            sharp_ms: sharp.map(|(_, seconds)| 1e3 * seconds),
        });
    }
    Ok(all)
}

/// Iterations and seconds to an objective error of `goal`. A solver that ends in a lower minimum than the reference is
/// measured against that: it would pass the other on its way.
pub fn first_within(goal: Real, trace: &[Sample]) -> Option<(u32, Real)> {
    let end = trace.last()?.error.objective;
    let least = end.min(0.0);
    let there = |sample: &&Sample| sample.error.objective - least <= goal;
    let there = trace.iter().find(there)?;
    Some((there.iteration, there.seconds))
}

/// Condition numbers of the matrix of a Newton iteration without and with its diagonal blocks inverted.
pub(super) fn conditions(system: &System) -> Result<[Real; 2], BenchError> {
    let mut found = [0.0; 2];
    let kinds = [Preconditioner::Identity, Preconditioner::BlockJacobi];
    for (kind, found) in kinds.into_iter().zip(&mut found) {
        let spectrum = spectrum(&system.matrix, &system.is_free, kind, LANCZOS);
        *found = spectrum?.condition_number();
    }
    Ok(found)
}

/// Measures all, and says who is the fastest. `of_sides` are the sides whose conditions are known, with these.
pub(super) fn run(study: &mut StudyRun<'_>, of_sides: &[(u32, [Real; 2])]) -> String {
    let scope = study.scope;
    let of_sides = of_sides
        .iter()
        .map(|&(side, found)| (Problem::of_side(side), found));
    let mut rows = of_sides.collect_vec();
    rows.extend(study.grid(
        of_other_stiffness(scope),
        |problem| format!("condition, {}", problem.name()),
        |problem| conditions(&System::falling(problem.side, problem.stiffness)?),
    ));
    let names = ["condition number of A", "condition number of D⁻¹A"];
    study.table(
        "newton-conditions",
        "Condition numbers",
        Table::named(&names, &rows),
    );
    let mut all: Vec<Taken> = Vec::new();
    for solver in solvers() {
        let case = format!("steps, {}", solver.0);
        let taken = study
            .cases
            .parts(&case, |progress| take(scope, solver, progress));
        all.extend(study.unless_failed(&case, taken).unwrap_or_default());
    }
    report(scope, &all, &mut study.findings);
    verdict(scope, &all)
}

fn report(scope: Scope, all: &[Taken], findings: &mut Findings) {
    let of_problem = |problem| all.iter().filter(move |one| one.problem == problem);
    let rows = problems(scope)
        .into_iter()
        .flat_map(of_problem)
        .cloned()
        .collect_vec();
    findings.table(
        "newton-steps",
        "Whole steps to equal errors; empty where a solver did not get there, and without a line beyond",
        &rows,
    );
    let (side, _) = scope.of(VARIED);
    for (goal, error) in GOALS.into_iter().enumerate() {
        let ms = |one: &Taken| if goal == 0 { one.ms } else { one.sharp_ms };
        let curves_over = |x: fn(&Problem) -> Real, is_on: &dyn Fn(&Problem) -> bool| {
            let there = all.iter().filter(|one| is_on(&one.problem));
            let mut points: Vec<(&str, (Real, Real))> = there
                .filter_map(|one| Some((one.solver.as_str(), (x(&one.problem), ms(one)?))))
                .collect();
            points.sort_by(|a, b| a.1.0.total_cmp(&b.1.0));
            curves(points, |point| point)
        };
        let (sides, times) = (Axis::log("vertices a side"), Axis::log("time (ms)"));
        let title = format!("A whole step to an error of {error:e}, {STIFFNESS:e} N/m");
        let series = curves_over(|p| Real::from(p.side), &|p| p.stiffness == STIFFNESS);
        let plot = Plot::new(title, sides, times.clone()).with(series);
        findings.plot(&format!("newton-steps-{error:e}"), &plot);
        let title = format!("A whole step to an error of {error:e}, {side} × {side} vertices");
        let series = curves_over(|p| p.stiffness, &|p| p.side == side);
        let plot = Plot::new(title, Axis::log("spring stiffness k (N/m)"), times).with(series);
        findings.plot(&format!("newton-steps-stiffness-{error:e}"), &plot);
    }
}

/// The times of those who reach the sharper goal on the largest sheet.
fn verdict(scope: Scope, all: &[Taken]) -> String {
    let Some(&side) = scope.of(super::SIDES).last() else {
        return String::new();
    };
    let largest = all
        .iter()
        .filter(|one| one.problem == Problem::of_side(side));
    let times = largest.filter_map(|one| Some((&one.solver, one.sharp_iterations?, one.sharp_ms?)));
    let times = times.sorted_by(|a, b| a.2.total_cmp(&b.2));
    let mut each =
        times.map(|(label, count, ms)| format!("{label} {ms:.0} ms in {count} iterations"));
    let (goal, each) = (GOALS[1], each.join(", "));
    format!("A whole step of {side} × {side} vertices to an error of {goal:e}: {each}.")
}
