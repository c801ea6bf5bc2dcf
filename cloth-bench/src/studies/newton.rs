//! Where the time of a Newton iteration goes, which ordering and linear solver win at which size, and what a whole step
//! costs with each.

pub mod convexity;
pub mod overshoot;
mod parts;
mod solvers;
pub mod steps;

use super::sheets::{STIFFNESS, hanging};
use crate::studies::prelude::*;
use cloth_core::element::Convexity;
use cloth_core::measure::{IncrementalPotential, predict};
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::family::{Assembly, Energies};
use std::time::Instant;

pub(super) const STUDY: Study = Study {
    name: "newton",
    question: "Where does the time of a Newton iteration go, which ordering and which linear solver win at which size, and does a quasi-Newton method around multigrid beat them all?",
    about: "The matrix M/Δt² + H of the hanging sheet after a quarter of a second, Δt = 1/60 s, indefinite parts dropped. Times are medians in one process on one thread. \
        `library` is the sparse Cholesky library alone, numbers in place: refactor and solve. The limit of a product is the bytes it has to read and write over what a triad moves \
        per second in as much memory. Iterative solvers start at zero; one that spends its 2000 iterations is marked, and condition numbers are lower bounds found in as many. Expect assembly to be a small part, \
        and the stationary iterations never to be worth it. One might expect conjugate gradients to overtake the factorisation on large sheets and at loose tolerances; whether they do, the table of linear solvers tells, and how their iterations grow with the side: this cloth is stiff against its mass. \
        `multigrid` among the linear solvers is conjugate gradients around a multigrid cycle, whose iterations hardly grow. \
        Whole steps: the sixteenth of the hanging sheet, from its start guess, with solvers that have taken a step before; the error is (G − G*)/(G(x̃) − G*) against Newton's method to rounding. Newton's method solves its systems to a residual of 1e-3, in at most 1000 linear iterations, \
        and takes at most 60 iterations; a solver that does not reach 1e-8 within them, or takes more than 5 s, is not asked for a sheet that is larger or stiffer. The quasi-Newton method is what implicit steps take by default. \
        Negative eigenvalues: one vertex between two compressed springs, k = 1e3 N/m, Δt = 1/60 s, whose step has two minima and a saddle point between them; then the sixteenth step of the hanging sheet, and the first of a sheet pressed together by a tenth, each vertex off the plane by up to 0.1 mm. \
        Each by Newton's method with the exact Hessian of every spring, with its negative eigenvalues at zero (clamp), with their absolute values, with the second derivative of the length left out (Gauss–Newton), and with as much of the exact one as is positive definite, which is what the solver takes by default. \
        Overshoot: one step of a mass on a spring, stretched by a tenth or turning at its rest length.",
    run,
};

/// Vertices a side.
const SIDES: [&[u32]; 2] = [&[9, 13], &[32, 64, 128, 256]];

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let mut parts = parts::Parts::default();
    let mut solvers = solvers::Solvers::default();
    let mut conditions = Vec::new();
    for &side in study.scope.of(SIDES) {
        let name = format!("{side} × {side}");
        let found = study.cases.parts(&name, |progress| {
            progress(&format!("newton: {side} × {side}, parts of an iteration"));
            let mut system = System::falling(side, STIFFNESS)?;
            let of_parts = parts::Parts::of(side, &mut system)?;
            progress(&format!("newton: {side} × {side}, linear solvers"));
            let of_solvers = solvers::Solvers::of(side, &system)?;
            Ok((of_parts, of_solvers, steps::conditions(&system)?))
        });
        if let Some((of_parts, of_solvers, condition)) = study.unless_failed(&name, found) {
            parts.append(of_parts);
            solvers.append(of_solvers);
            conditions.push((side, condition));
        }
    }
    let first = parts.report(&mut study.findings);
    let second = solvers.report(&mut study.findings);
    let third = steps::run(study, &conditions);
    let fourth = convexity::run(study);
    let fifth = study.chapter("overshoot", |findings, _| overshoot::draw(findings));
    let fifth = fifth.unwrap_or_default();
    study.section.rests_on = "figure-newton-steps-1e-8".into();
    study.section.verdict = Some(format!("{third}\n{first} {second} {fourth} {fifth}"));
    Ok(())
}

/// The linear system of the first Newton iteration of a step, and what it is made of.
struct System {
    scene: Scene,
    energies: Energies,
    assembly: Assembly,
    state: State,
    predicted: Vec<Vec3>,
    matrix: BlockMatrix,
    gradient: Vec<Vec3>,
    is_free: Vec<bool>,
}

impl System {
    /// A quarter of a second into the fall, taken with linearised steps.
    fn falling(side: u32, stiffness: Real) -> Result<Self, BenchError> {
        let scene = scene::build("hang", None, &hanging(side, stiffness))?;
        let mut state = scene.start.clone();
        let mut solver =
            Method::find("linear-implicit")?.build(&scene, &Settings::default(), scene.dt)?;
        let input = || StepInput::new(scene.dt).gravity(scene.gravity);
        for _ in 0..15 {
            solver.step(&mut state, input())?;
        }
        let energies = scene.model.energies()?;
        let assembly = energies.assembly();
        let count = state.positions.len();
        let mut predicted = vec![Vec3::zeros(); count];
        predict(&scene.model.particles, &state, &input(), &mut predicted);
        let particles = &scene.model.particles;
        let mut system = Self {
            matrix: BlockMatrix::zeros(assembly.pattern().clone()),
            assembly,
            is_free: (0..count).map(|v| !particles.is_prescribed(v)).collect(),
            gradient: Vec::new(),
            scene,
            energies,
            state,
            predicted,
        };
        system.assemble();
        let mut gradient = vec![Vec3::zeros(); count];
        let x = &system.state.positions;
        system.potential().gradient_into(x, &mut gradient);
        system.gradient = gradient;
        Ok(system)
    }

    fn potential(&self) -> IncrementalPotential<'_> {
        IncrementalPotential {
            particles: &self.scene.model.particles,
            energies: &self.energies,
            predicted: &self.predicted,
            dt: self.scene.dt,
        }
    }

    fn assemble(&mut self) {
        let inertia = 1.0 / (self.scene.dt * self.scene.dt);
        let masses = self.scene.model.particles.mass().iter();
        self.matrix.clear();
        self.matrix.add_diagonal(masses.map(|m| m * inertia));
        let x = &self.state.positions;
        self.energies
            .add_hessian(&self.assembly, x, 1.0, Convexity::Clamp, &mut self.matrix);
    }
}

/// The time of [`seconds`] of work that can fail.
fn tried<T, E: Into<BenchError>>(
    mut work: impl FnMut() -> Result<T, E>,
) -> Result<Real, BenchError> {
    let mut outcome = Ok(());
    let time = seconds(|| outcome = work().map(drop));
    outcome.map(|()| time).map_err(Into::into)
}

/// Median time (s) of some runs, the first not counted: half a second's worth, but three to fifty, or one of something
/// slow.
fn seconds(mut work: impl FnMut()) -> Real {
    let started = Instant::now();
    work();
    let first = started.elapsed().as_secs_f64();
    let least = if first < 1.5 { 3.0 } else { 1.0 };
    let runs = (0.5 / first).clamp(least, 50.0) as usize;
    let timed = |_| {
        let started = Instant::now();
        work();
        started.elapsed().as_secs_f64()
    };
    median(&mut (0..runs).map(timed).collect_vec())
}
