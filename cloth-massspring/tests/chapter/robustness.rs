//! The default (L-BFGS, and Newton's method by Cholesky where that is stuck) from starts that make no sense, at ratios
//! that are too large.
//!
//! A cell is one kind of start at one size of step, stiffness ratio and mass ratio; ten jittered runs each. A run
//! passes if the step converges to a finite state, and by implicit Euler to one whose incremental potential is not
//! above that of its start. A step that spends its iterations or is refused fails; a refused one has to leave the state
//! untouched.

use crate::{DOWN, noise, solver};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{IncrementalPotential, predict};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Outcome, StepInput, Stepper};
use cloth_core::topology::EdgeTable;
use cloth_massspring::{Bdf2, ImplicitConfig, ImplicitEuler, ImplicitMidpoint};

const RUNS: usize = 10;
const SIDE: usize = 6;

#[derive(Clone, Copy, Debug)]
enum Start {
    Random,
    Flattened,
    Collapsed,
    Mirrored,
}

const STARTS: [Start; 4] = [
    Start::Random,
    Start::Flattened,
    Start::Collapsed,
    Start::Mirrored,
];

/// A sheet of 1 m × 1 m with two corners held, springs of 10² N/m and `stiffness` times that, vertices of 0.01 kg and
/// `mass` times that.
fn sheet(mesh: &TriMesh, stiffness: Real, mass: Real) -> (Particles, Vec<Spring>) {
    let masses = (0..mesh.vertex_count()).map(|v| if v % 3 == 0 { 0.01 * mass } else { 0.01 });
    let mut particles = Particles::new(masses.collect()).unwrap();
    particles.prescribe(0).unwrap();
    particles.prescribe(SIDE - 1).unwrap();
    let edges = EdgeTable::build(mesh).unwrap();
    let mut springs = Spring::along(mesh.positions(), edges.ends(), 1e2);
    for spring in springs.iter_mut().step_by(2) {
        spring.stiffness *= stiffness;
    }
    (particles, springs)
}

/// Free vertices moved to a bad place, with a jitter that depends on `run`.
fn start(kind: Start, mesh: &TriMesh, particles: &Particles, run: usize) -> State {
    let mut positions = mesh.positions().to_vec();
    for (vertex, x) in positions.iter_mut().enumerate() {
        let jitter = noise(1000 * run + vertex);
        if !particles.is_prescribed(vertex) {
            *x = match kind {
                Start::Random => jitter,
                // Into the line through the held corners.
                Start::Flattened => Vec3::new(x.x + 1e-3 * jitter.x, 0.0, 0.0),
                // Onto one point, exactly; the point differs.
                Start::Collapsed => noise(run),
                // Turned inside out through the held corners, and almost flat.
                Start::Mirrored => Vec3::new(1.0 - x.x, -x.y, 1e-6 * jitter.z),
            };
        }
    }
    State::at_rest(positions)
}

/// Runs that converged, spent their iterations, and were refused with the state untouched; and most iterations of one.
#[derive(Debug, Default)]
struct Cell {
    converged: usize,
    spent: usize,
    refused: Vec<String>,
    iterations: u32,
}

fn cell(
    make: impl Fn(&Particles, &[Spring]) -> Box<dyn Stepper>,
    euler: bool,
    kind: Start,
    dt: Real,
    stiffness: Real,
    mass: Real,
) -> Cell {
    let mesh = grid(SIDE, SIDE, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let (particles, springs) = sheet(&mesh, stiffness, mass);
    let energies = cloth_core::method::family::Energies::new(particles.len())
        .with(springs.clone())
        .unwrap();
    let mut solver = make(&particles, &springs);
    let mut cell = Cell::default();
    let mut predicted = vec![Vec3::zeros(); particles.len()];
    for run in 0..RUNS {
        let before = start(kind, &mesh, &particles, run);
        let mut state = before.clone();
        let input = || StepInput::new(dt).gravity(DOWN);
        predict(&particles, &state, &input(), &mut predicted);
        match solver.step(&mut state, input()) {
            Ok(report) => {
                match report.outcome {
                    Outcome::Converged => cell.converged += 1,
                    Outcome::BudgetSpent => cell.spent += 1,
                }
                cell.iterations = cell.iterations.max(report.iterations);
                assert_eq!(state.first_non_finite(), None, "{kind:?} {dt} {run}");
                if euler {
                    let potential = IncrementalPotential {
                        particles: &particles,
                        energies: &energies,
                        predicted: &predicted,
                        dt,
                    };
                    let [from, to] = [&before, &state].map(|s| potential.value(&s.positions));
                    assert!(
                        to <= from * (1.0 + 1e-9),
                        "{kind:?} {dt} {run}: {from} to {to} J"
                    );
                }
            }
            Err(error) => {
                assert!(state == before, "{kind:?}: {error} changed the state");
                cell.refused.push(error.to_string());
            }
        }
    }
    cell
}

#[test]
fn the_default_converges_from_anywhere_on_uniform_cloth() {
    converges_from_anywhere(1.0);
}

#[test]
fn the_default_converges_from_anywhere_where_one_half_is_stiffer() {
    converges_from_anywhere(1e4);
}

#[test]
fn the_default_converges_from_anywhere_where_one_half_is_rigid() {
    converges_from_anywhere(1e8);
}

fn converges_from_anywhere(stiffness: Real) {
    let config = ImplicitConfig {
        max_iterations: 4000,
        ..ImplicitConfig::default()
    };
    let mut bad = Vec::new();
    for mass in [1.0, 1e3, 1e6] {
        for dt in [1e-3, 1.0 / 60.0, 1.0] {
            for kind in STARTS {
                let make = |p: &Particles, s: &[Spring]| {
                    Box::new(solver!(ImplicitEuler, p, s.to_vec(), config)) as Box<dyn Stepper>
                };
                let cell = cell(make, true, kind, dt, stiffness, mass);
                println!(
                    "stiffness 1:{stiffness:e}, mass 1:{mass:e}, dt {dt:.4}, {kind:?}: {} of {RUNS}, {} iterations at most",
                    cell.converged, cell.iterations
                );
                if cell.converged < RUNS {
                    bad.push(format!("{stiffness:e} {mass:e} {dt} {kind:?}: {cell:?}"));
                }
            }
        }
    }
    assert!(bad.is_empty(), "{} cells:\n{}", bad.len(), bad.join("\n"));
}

#[test]
fn midpoint_and_bdf2_converge_from_anywhere_too() {
    let config = ImplicitConfig {
        max_iterations: 4000,
        ..ImplicitConfig::default()
    };
    for kind in STARTS {
        for dt in [1e-3, 1.0] {
            for stiffness in [1.0, 1e8] {
                let midpoint = |p: &Particles, s: &[Spring]| {
                    Box::new(solver!(ImplicitMidpoint, p, s.to_vec(), config)) as Box<dyn Stepper>
                };
                let bdf2 = |p: &Particles, s: &[Spring]| {
                    Box::new(solver!(Bdf2, p, s.to_vec(), config)) as Box<dyn Stepper>
                };
                for cell in [
                    cell(midpoint, false, kind, dt, stiffness, 1e6),
                    cell(bdf2, false, kind, dt, stiffness, 1e6),
                ] {
                    assert_eq!(
                        cell.converged, RUNS,
                        "{kind:?} {dt} {stiffness:e}: {cell:?}"
                    );
                }
            }
        }
    }
}
