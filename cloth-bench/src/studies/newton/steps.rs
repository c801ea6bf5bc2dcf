//! Whole steps to equal errors: the quasi-Newton method around multigrid, and Newton's method with every linear solver.

use super::System;
use crate::studies::prelude::*;
use crate::studies::sheets::{STIFFNESS, hanging, sixteenth_step, trace_warm};
use crate::yardstick::Sample;
use cloth_core::method::linear::{LinearMethod, Preconditioner, StoppingCriteria, spectrum};
use cloth_massspring::{ImplicitConfig, Solve};

/// Errors (G − G*)/(G(x̃) − G*) that are waited for.
const GOALS: [Real; 2] = [1e-3, 1e-8];
/// Most iterations of Newton's method in a step.
const MOST: u32 = 60;
/// A step (s) that takes longer is the last of its solver on the way to larger and stiffer sheets.
const LONG: Real = 5.0;
/// Iterations in which condition numbers are found.
const LANCZOS: u32 = 2000;

/// A sheet whose sixteenth step is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Problem {
    side: u32,
    /// N/m.
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
fn varied(scope: Scope) -> (u32, &'static [Real]) {
    scope.pick((16, &[1e2, 1e6]), (64, &[1e2, 1e3, 1e5, 1e6]))
}

/// The sheets that are softer or stiffer.
fn of_other_stiffness(scope: Scope) -> impl Iterator<Item = Problem> {
    let (side, stiffnesses) = varied(scope);
    stiffnesses
        .iter()
        .map(move |&stiffness| Problem { side, stiffness })
}

fn problems(scope: Scope) -> Vec<Problem> {
    let sides = super::sides(scope).iter().copied().map(Problem::of_side);
    sides.chain(of_other_stiffness(scope)).collect()
}

/// Label, how much is minimised by what, and the linear solver.
fn solvers() -> [(&'static str, Solve, LinearMethod); 7] {
    let budget = StoppingCriteria::default();
    let newton = |label, linear| (label, Solve::Newton, linear);
    [
        (
            "quasi-Newton, multigrid",
            Solve::QuasiNewton,
            LinearMethod::default(),
        ),
        newton("Newton, Cholesky", LinearMethod::Cholesky),
        newton(
            "Newton, multigrid gradients",
            LinearMethod::Multigrid(budget),
        ),
        newton(
            "Newton, conjugate gradients",
            LinearMethod::ConjugateGradients(budget),
        ),
        newton(
            "Newton, Chebyshev–Jacobi",
            LinearMethod::ChebyshevJacobi(budget),
        ),
        newton("Newton, Gauss–Seidel", LinearMethod::GaussSeidel(budget)),
        newton("Newton, Jacobi", LinearMethod::Jacobi(budget)),
    ]
}

/// How a solver got to the goals in one step: iterations and seconds to each, if it got there.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Taken {
    side: u32,
    stiffness: Real,
    reached: [Option<(u32, Real)>; 2],
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
        let mut solver = method::implicit_euler(&model.particles, model.families(), config)?;
        let trace = trace_warm(&scene, scene.gravity, &step, &mut solver)?;
        let reached = GOALS.map(|goal| first_within(goal, &trace));
        let took = trace.last().map_or(0.0, |sample| sample.seconds);
        if reached[1].is_none() || took > LONG {
            lost.push(problem);
        }
        all.push(Taken {
            side: problem.side,
            stiffness: problem.stiffness,
            reached,
        });
    }
    Ok(all)
}

/// Iterations and seconds to an objective error of `goal`. A solver that ends in a lower minimum than the reference is
/// measured against that: it would pass the other on its way.
fn first_within(goal: Real, trace: &[Sample]) -> Option<(u32, Real)> {
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
    let mut table = Table::new(&[
        "vertices a side",
        "stiffness (N/m)",
        "condition number of A",
        "condition number of D⁻¹A",
    ]);
    let mut push = |problem: Problem, [plain, preconditioned]: [Real; 2]| {
        table.push([
            Cell::from(problem.side as usize),
            Cell::from(problem.stiffness),
            Cell::from(plain),
            Cell::from(preconditioned),
        ]);
    };
    for &(side, found) in of_sides {
        push(Problem::of_side(side), found);
    }
    for problem in of_other_stiffness(scope) {
        let case = format!("condition, {}", problem.name());
        let found = study.cases.case(&case, || {
            conditions(&System::falling(problem.side, problem.stiffness)?)
        });
        if let Some(found) = study.findings.unless_failed(&case, found) {
            push(problem, found);
        }
    }
    study
        .findings
        .table("newton-conditions", "Condition numbers", table);
    let mut all: Vec<(&str, Vec<Taken>)> = Vec::new();
    for solver in solvers() {
        let case = format!("steps, {}", solver.0);
        let taken = study
            .cases
            .parts(&case, |progress| take(scope, solver, progress));
        if let Some(taken) = study.findings.unless_failed(&case, taken) {
            all.push((solver.0, taken));
        }
    }
    report(scope, &all, &mut study.findings);
    verdict(scope, &all)
}

fn report(scope: Scope, all: &[(&str, Vec<Taken>)], findings: &mut Findings) {
    let mut table = Table::new(&[
        "vertices a side",
        "stiffness (N/m)",
        "solver",
        "iterations to 1e-3",
        "ms to 1e-3",
        "iterations to 1e-8",
        "ms to 1e-8",
    ]);
    for problem in problems(scope) {
        for (label, taken) in all {
            let of = |one: &&Taken| of_problem(one, &problem);
            let Some(one) = taken.iter().find(of) else {
                continue;
            };
            let mut row = vec![
                Cell::from(one.side as usize),
                Cell::from(one.stiffness),
                Cell::from(*label),
            ];
            for reached in one.reached {
                row.push(Cell::from(reached.map(|(count, _)| count as usize)));
                row.push(Cell::from(reached.map(|(_, seconds)| 1e3 * seconds)));
            }
            table.rows.push(row);
        }
    }
    findings.table(
        "newton-steps",
        "Whole steps to equal errors; empty where a solver did not get there, and without a line beyond",
        table,
    );
    let (side, _) = varied(scope);
    for (goal, error) in GOALS.into_iter().enumerate() {
        let curves = |x: fn(&Taken) -> Real, is_on: &dyn Fn(&Taken) -> bool| {
            let curve = |taken: &[Taken]| -> Vec<(Real, Real)> {
                let there = taken.iter().filter(|one| is_on(one));
                let points = there.filter_map(|one| Some((x(one), 1e3 * one.reached[goal]?.1)));
                let mut points: Vec<_> = points.collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                points
            };
            let series = all.iter();
            series
                .map(|(label, taken)| Series::new(label, curve(taken)))
                .collect()
        };
        findings.plot(
            &format!("newton-steps-{error:e}"),
            &Plot {
                title: format!("A whole step to an error of {error:e}, {STIFFNESS:e} N/m"),
                x: Axis::log("vertices a side"),
                y: Axis::log("time (ms)"),
                series: curves(|one| Real::from(one.side), &|one| {
                    one.stiffness == STIFFNESS
                }),
                note: String::new(),
            },
        );
        findings.plot(
            &format!("newton-steps-stiffness-{error:e}"),
            &Plot {
                title: format!("A whole step to an error of {error:e}, {side} × {side} vertices"),
                x: Axis::log("spring stiffness k (N/m)"),
                y: Axis::log("time (ms)"),
                series: curves(|one| one.stiffness, &|one| one.side == side),
                note: String::new(),
            },
        );
    }
}

fn of_problem(one: &Taken, problem: &Problem) -> bool {
    one.side == problem.side && one.stiffness == problem.stiffness
}

/// The times of those who reach the sharper goal on the largest sheet.
fn verdict(scope: Scope, all: &[(&str, Vec<Taken>)]) -> String {
    let Some(&side) = super::sides(scope).last() else {
        return String::new();
    };
    let largest = Problem::of_side(side);
    let mut times: Vec<(&str, u32, Real)> = Vec::new();
    for (label, taken) in all {
        let there = taken.iter().find(|one| of_problem(one, &largest));
        if let Some((count, seconds)) = there.and_then(|one| one.reached[1]) {
            times.push((label, count, seconds));
        }
    }
    times.sort_by(|a, b| a.2.total_cmp(&b.2));
    let each = times.iter().map(|(label, count, seconds)| {
        format!("{label} {:.0} ms in {count} iterations", 1e3 * seconds)
    });
    format!(
        "A whole step of {side} × {side} vertices to an error of {:e}: {}.",
        GOALS[1],
        each.collect::<Vec<_>>().join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::yardstick::StepError;

    #[test]
    fn a_lower_minimum_is_not_reached_where_it_passes_the_other() {
        let sample = |(iteration, objective): (u32, Real)| Sample {
            iteration,
            seconds: Real::from(iteration),
            error: StepError {
                objective,
                gradient: 0.0,
            },
        };
        let trace = |values: [Real; 4]| (1..).zip(values).map(sample).collect::<Vec<_>>();
        let same = trace([1e-2, 1e-5, 1e-9, 1e-13]);
        assert_eq!(first_within(1e-8, &same), Some((3, 3.0)));
        let lower = trace([1e-2, -1e-5, -2e-5, -2e-5 - 1e-12]);
        assert_eq!(first_within(1e-8, &lower), Some((3, 3.0)));
        let higher = trace([1e-2, 1e-3, 1e-4, 1e-5]);
        assert_eq!(first_within(1e-8, &higher), None);
        assert_eq!(first_within(1e-3, &[]), None);
    }
}
