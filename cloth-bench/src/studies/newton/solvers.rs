//! Every linear solver on the same system.

use super::{System, seconds};
use crate::studies::prelude::*;
use cloth_core::method::linear::{LinearMethod, LinearSolver, StoppingCriteria};
use cloth_core::step::Outcome;

/// Relative residuals asked for.
const TOLERANCES: [Real; 2] = [1e-3, 1e-8];
/// More iterations than this are not worth waiting for.
const MOST: u32 = 2000;

#[derive(Default, Serialize, Deserialize)]
pub(super) struct Solvers {
    solves: Vec<Solve>,
}

#[derive(Clone, Default, Serialize, Deserialize)]
struct Solve {
    vertices_a_side: u32,
    solver: String,
    #[serde(rename = "relative residual asked for")]
    tolerance: Real,
    #[serde(rename = "prepare and solve (ms)")]
    time: Real,
    iterations: u32,
    relative_residual: Real,
    done: Done,
}

#[derive(Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
enum Done {
    #[default]
    #[serde(rename = "yes")]
    Converged,
    #[serde(rename = "budget spent")]
    Spent,
}

impl Solvers {
    /// Those of one size.
    pub(super) fn of(side: u32, system: &System) -> Result<Self, BenchError> {
        let mut solves: Vec<Solve> = Vec::new();
        for tolerance in TOLERANCES {
            let budget = StoppingCriteria {
                tolerance,
                max_iterations: MOST,
            };
            for method in [
                LinearMethod::Cholesky,
                LinearMethod::Multigrid(budget),
                LinearMethod::ConjugateGradients(budget),
                LinearMethod::ChebyshevJacobi(budget),
                LinearMethod::GaussSeidel(budget),
                LinearMethod::Jacobi(budget),
            ] {
                let mut solver = method.build(
                    system.matrix.pattern(),
                    &system.is_free,
                    system.scene.model.particles.rest_positions(),
                )?;
                let is_lost = |one: &&Solve| one.solver == solver.name() && one.done == Done::Spent;
                solves.push(match solves.iter().find(is_lost) {
                    // It would spend them again.
                    Some(lost) => Solve {
                        tolerance,
                        ..lost.clone()
                    },
                    None => solve(side, tolerance, &mut *solver, system)?,
                });
            }
        }
        Ok(Self { solves })
    }

    /// Adds those of another size.
    pub(super) fn append(&mut self, other: Self) {
        self.solves.extend(other.solves);
    }

    pub(super) fn report(&self, findings: &mut Findings) -> String {
        for tolerance in TOLERANCES {
            let name = format!("newton-solvers-{tolerance:e}");
            findings.plot(&name, &self.plot(tolerance));
        }
        findings.table("newton-solvers", "Linear solvers", &self.solves);
        self.verdict()
    }

    /// Those that came to an end.
    fn done(&self, tolerance: Real) -> impl Iterator<Item = &Solve> {
        let is_done = move |s: &&Solve| s.tolerance == tolerance && s.done == Done::Converged;
        self.solves.iter().filter(is_done)
    }

    fn plot(&self, tolerance: Real) -> Plot {
        let series = curves(self.done(tolerance), |s| {
            (s.solver.as_str(), (Real::from(s.vertices_a_side), s.time))
        });
        let title = format!("Preparing and solving to a residual of {tolerance:e}");
        let (sides, times) = (Axis::log("vertices a side"), Axis::log("time (ms)"));
        let plot = Plot::new(title, sides, times).with(series);
        plot.note("Solvers that spent their iterations are left out.")
    }

    /// Who wins, size by size.
    fn verdict(&self) -> String {
        let sides = self
            .solves
            .iter()
            .map(|solve| solve.vertices_a_side)
            .dedup();
        let sentences = TOLERANCES.map(|tolerance| {
            let winner = |side| Some((side, self.fastest(side, tolerance)?));
            let winners = sides.clone().filter_map(winner).collect_vec();
            let who = match winners.first() {
                Some((_, name)) if winners.iter().map(|(_, name)| name).all_equal() => {
                    format!("{name} at every size")
                }
                _ => winners
                    .iter()
                    .map(|(side, name)| format!("{name} at {side}"))
                    .join(", "),
            };
            format!(
                "To a residual of {tolerance:e} the fastest is {who} (several where times differ by less than a factor of {NOISE})."
            )
        });
        sentences.join(" ")
    }

    /// The fastest, or all that are too near to it to tell which is.
    fn fastest(&self, side: u32, tolerance: Real) -> Option<String> {
        let done = self.done(tolerance).filter(|s| s.vertices_a_side == side);
        let done = done.collect_vec();
        let least = done.iter().map(|s| s.time).min_by(|a, b| a.total_cmp(b))?;
        let near = done.iter().filter(|s| s.time < NOISE * least);
        Some(near.map(|s| s.solver.as_str()).join(" or "))
    }
}

fn solve(
    side: u32,
    tolerance: Real,
    solver: &mut dyn LinearSolver,
    system: &System,
) -> Result<Solve, BenchError> {
    let mut x = vec![Vec3::zeros(); system.is_free.len()];
    let mut outcome = None;
    let time = seconds(|| {
        let prepared = solver.prepare(&system.matrix);
        outcome =
            Some(prepared.and_then(|()| solver.solve(&system.matrix, &system.gradient, &mut x)));
    });
    let report = outcome.expect("it ran")?;
    Ok(Solve {
        vertices_a_side: side,
        solver: solver.name().to_owned(),
        tolerance,
        time: 1e3 * time,
        iterations: report.iterations,
        relative_residual: report.residual,
        done: match report.outcome {
            Outcome::Converged => Done::Converged,
            _ => Done::Spent,
        },
    })
}
