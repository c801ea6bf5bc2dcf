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

#[derive(Clone, Serialize, Deserialize)]
struct Solve {
    side: u32,
    name: String,
    tolerance: Real,
    /// Preparing and solving (s).
    time: Real,
    iterations: u32,
    /// Relative residual at the end.
    residual: Real,
    converged: bool,
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
                let built = method.build(
                    system.matrix.pattern(),
                    &system.is_free,
                    system.scene.model.particles.rest_positions(),
                );
                let mut solver = built?;
                let is_lost = |one: &&Solve| one.name == solver.name() && !one.converged;
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
        let mut table = Table::new(&[
            "vertices a side",
            "solver",
            "relative residual asked for",
            "prepare and solve (ms)",
            "iterations",
            "relative residual",
            "done",
        ]);
        for solve in &self.solves {
            table.push([
                Cell::from(solve.side as usize),
                Cell::from(solve.name.as_str()),
                Cell::from(solve.tolerance),
                Cell::from(1e3 * solve.time),
                Cell::from(solve.iterations as usize),
                Cell::from(solve.residual),
                Cell::from(if solve.converged {
                    "yes"
                } else {
                    "budget spent"
                }),
            ]);
        }
        for tolerance in TOLERANCES {
            findings.plot(
                &format!("newton-solvers-{tolerance:e}"),
                &self.plot(tolerance),
            );
        }
        findings.table("newton-solvers", "Linear solvers", table);
        self.verdict()
    }

    fn plot(&self, tolerance: Real) -> Plot {
        let mut names: Vec<&str> = Vec::new();
        for solve in &self.solves {
            if !names.contains(&solve.name.as_str()) {
                names.push(&solve.name);
            }
        }
        let series = names.into_iter().map(|name| {
            let solves = self
                .solves
                .iter()
                .filter(|s| s.name == name && s.tolerance == tolerance && s.converged);
            let points = solves.map(|s| (Real::from(s.side), 1e3 * s.time)).collect();
            Series::new(name, points)
        });
        Plot {
            title: format!("Preparing and solving to a residual of {tolerance:e}"),
            x: Axis::log("vertices a side"),
            y: Axis::log("time (ms)"),
            series: series.collect(),
            note: "Solvers that spent their iterations are left out.".into(),
        }
    }

    /// Who wins, size by size.
    fn verdict(&self) -> String {
        let mut sides: Vec<u32> = self.solves.iter().map(|solve| solve.side).collect();
        sides.dedup();
        let sentences = TOLERANCES.map(|tolerance| {
            let winners: Vec<(u32, &str)> = sides
                .iter()
                .filter_map(|&side| Some((side, self.fastest(side, tolerance)?)))
                .collect();
            let who = match winners.first() {
                Some((_, name)) if winners.iter().all(|(_, other)| other == name) => {
                    format!("{name} at every size")
                }
                _ => {
                    let each = winners
                        .iter()
                        .map(|(side, name)| format!("{name} at {side}"));
                    each.collect::<Vec<_>>().join(", ")
                }
            };
            format!("To a residual of {tolerance:e} the fastest is {who}.")
        });
        sentences.join(" ")
    }

    fn fastest(&self, side: u32, tolerance: Real) -> Option<&str> {
        let done = self
            .solves
            .iter()
            .filter(|s| s.side == side && s.tolerance == tolerance && s.converged);
        done.min_by(|a, b| a.time.total_cmp(&b.time))
            .map(|s| s.name.as_str())
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
        side,
        name: solver.name().to_owned(),
        tolerance,
        time,
        iterations: report.iterations,
        residual: report.residual,
        converged: report.outcome == Outcome::Converged,
    })
}
