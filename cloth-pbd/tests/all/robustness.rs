//! PBD from starts that make no sense, at ratios that are too large.
//!
//! A cell is one kind of start at one size of step, stiffness and mass ratio, with one variant of the sweep over the
//! constraints; ten jittered runs each. A step passes if it ends in a finite state, or with an error and
//! the state as it was; the second is counted.

use cloth_core::energy::{AreaTriangle, CurvatureHinge, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{Strain, center_of_mass, kinetic_energy};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_core::topology::{EdgeTable, HingeTable};
use cloth_pbd::{Hierarchy, HierarchyConfig, PbdConfig, PbdSolver, StiffnessRule};
use rayon::prelude::*;

const RUNS: usize = 10;
const SIDE: usize = 6;
const DOWN: Vec3 = Vec3::new(0.0, 0.0, -9.81);

/// Deterministic numbers in (−1, 1).
fn noise(index: usize) -> Vec3 {
    Vec3::from_fn(|axis, _| {
        let t = (3 * index + axis) as Real * 0.754_877_666 + 0.17;
        2.0 * t.fract() - 1.0
    })
}

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

/// Free vertices moved to a bad place, with a jitter that depends on `run`.
fn start(kind: Start, sheet: &Sheet, run: usize) -> State {
    let mut positions = sheet.mesh.positions().to_vec();
    for (vertex, x) in positions.iter_mut().enumerate() {
        let jitter = noise(1000 * run + vertex);
        if !sheet.particles.is_prescribed(vertex) {
            *x = match kind {
                Start::Random => jitter,
                // Into the line through the held corners, almost: nothing could say in which direction to leave
                // a plane that it fills.
                Start::Flattened => Vec3::new(x.x, 0.0, 0.0) + jitter * 1e-3,
                // Onto one point, exactly; the point differs.
                Start::Collapsed => noise(run),
                // Turned inside out through the held corners, and almost flat.
                Start::Mirrored => Vec3::new(1.0 - x.x, -x.y, 1e-6 * jitter.z),
            };
        }
    }
    State::at_rest(positions)
}

/// A sheet of 1 m × 1 m with two corners held, springs of stiffness k on all edges, bending, area, and vertices
/// of 0.01 kg, every third of `mass` times that.
struct Sheet {
    mesh: TriMesh,
    particles: Particles,
    springs: Vec<Spring>,
    hinges: Vec<CurvatureHinge>,
    areas: Vec<AreaTriangle>,
}

impl Sheet {
    fn new(stiffness: Real, mass: Real) -> Self {
        let mesh = grid(SIDE, SIDE, 1.0, 1.0, Diagonals::Alternating).unwrap();
        let masses = (0..mesh.vertex_count()).map(|v| if v % 3 == 0 { 0.01 * mass } else { 0.01 });
        let mut particles = Particles::new(masses.collect()).unwrap();
        particles.prescribe(0).unwrap();
        particles.prescribe(SIDE - 1).unwrap();
        let edges = EdgeTable::build(&mesh).unwrap();
        let hinges = HingeTable::build(&mesh, &edges);
        Self {
            springs: Spring::along(mesh.positions(), edges.ends(), stiffness),
            hinges: CurvatureHinge::across(&mesh, &hinges, 1e-5 * stiffness.min(1e6)),
            areas: AreaTriangle::on(&mesh, stiffness),
            mesh,
            particles,
        }
    }

    fn solver(&self, variant: Variant, stiffness: StiffnessRule, iterations: u32) -> PbdSolver {
        let acceleration = Acceleration {
            chebyshev: variant
                .chebyshev
                .map(|radius| Chebyshev { radius, delay: 3 }),
            ..Acceleration::default()
        };
        let config = PbdConfig {
            iterations,
            sweep: variant.sweep,
            acceleration,
            stiffness,
            ..PbdConfig::default()
        };
        let builder = PbdSolver::builder(&self.particles).energy(self.springs.clone());
        let builder = builder
            .energy(self.hinges.clone())
            .energy(self.areas.clone());
        let solver = builder.config(config).build().unwrap();
        if !variant.hierarchy {
            return solver;
        }
        let config = HierarchyConfig {
            every: Some(7),
            ..HierarchyConfig::default()
        };
        let hierarchy = Hierarchy::build(&self.mesh, &self.particles, config).unwrap();
        assert!(hierarchy.level_count() > 0);
        solver.with_hierarchy(hierarchy).unwrap()
    }
}

/// How to go through the constraints.
#[derive(Clone, Copy, Debug)]
struct Variant {
    sweep: Sweep,
    chebyshev: Option<Radius>,
    hierarchy: bool,
}

fn variants() -> Vec<Variant> {
    let mut variants = Vec::new();
    for sweep in [Sweep::Sequential, Sweep::Colored, Sweep::Jacobi] {
        for chebyshev in [None, Some(Radius::Estimated), Some(Radius::Given(0.99))] {
            for hierarchy in [false, true] {
                variants.push(Variant {
                    sweep,
                    chebyshev,
                    hierarchy,
                });
            }
        }
    }
    variants
}

/// A fixed stiffness does not look at k; once is enough.
fn rules(stiffness: Real) -> Vec<StiffnessRule> {
    match stiffness == 0.0 {
        true => vec![StiffnessRule::Material, StiffnessRule::Fixed(0.7)],
        false => vec![StiffnessRule::Material],
    }
}

#[test]
fn every_step_ends_in_a_finite_state_or_leaves_it_as_it_was() {
    let (mut taken, mut refused) = (0, 0);
    for stiffness in [0.0, 1e-6, 1e2, 1e10, Real::INFINITY] {
        for mass in [1.0, 1e6] {
            let sheet = Sheet::new(stiffness, mass);
            for variant in variants() {
                for rule in rules(stiffness) {
                    let mut solver = sheet.solver(variant, rule, 10);
                    for dt in [1e-3, 1.0 / 60.0, 1.0] {
                        for (kind, run) in STARTS
                            .into_iter()
                            .flat_map(|s| (0..RUNS).map(move |r| (s, r)))
                        {
                            let before = start(kind, &sheet, run);
                            let mut state = before.clone();
                            match solver.step(&mut state, StepInput::new(dt).gravity(DOWN)) {
                                Ok(_) => {
                                    taken += 1;
                                    assert_eq!(
                                        state.first_non_finite(),
                                        None,
                                        "{variant:?} {kind:?}"
                                    );
                                }
                                Err(error) => {
                                    refused += 1;
                                    assert!(state == before, "{variant:?} {kind:?}: {error}");
                                }
                            }
                        }
                    }
                }
            }
        }
    }
    println!("{taken} steps taken, {refused} refused");
    assert_eq!(refused, 0);
}

/// Lets the sheet come to rest for up to `steps` steps of 1/60 s, or until `done`: root mean square strain of
/// the springs, height of the centre of mass (m), and the steps taken.
///
/// It comes to rest by kinetic damping: the velocities are taken away whenever the kinetic energy has passed a
/// maximum.
fn settle(
    sheet: &Sheet,
    solver: &mut PbdSolver,
    mut state: State,
    steps: u32,
    done: impl Fn(Real, Real) -> bool,
) -> (Real, Real, u32) {
    let mut before = 0.0;
    let mut now = (Real::NAN, Real::NAN, 0);
    for step in 1..=steps {
        let input = StepInput::new(1.0 / 60.0).gravity(DOWN);
        solver.step(&mut state, input).unwrap();
        let energy = kinetic_energy(&sheet.particles, &state.velocities);
        if energy < before {
            state.velocities.fill(Vec3::zeros());
            before = 0.0;
        } else {
            before = energy;
        }
        if step % 20 == 0 {
            let strain = Strain::of(&sheet.springs, &state.positions).rms;
            let height = center_of_mass(&sheet.particles, &state.positions).z;
            now = (strain, height, step);
            if done(strain, height) {
                break;
            }
        }
    }
    now
}

/// Hard springs, from anywhere, with gravity: within four seconds the sheet hangs with its edges as long as
/// those of one that was let go flat, and as low.
#[test]
fn the_sheet_recovers_from_any_start() {
    let sheet = Sheet::new(Real::INFINITY, 1.0);
    let cell = |variant: Variant| {
        // Averaged Jacobi sweeps move little each.
        let iterations = if variant.sweep == Sweep::Jacobi {
            100
        } else {
            30
        };
        let mut solver = sheet.solver(variant, StiffnessRule::Material, iterations);
        let flat = State::at_rest(sheet.mesh.positions().to_vec());
        let (rest_strain, rest_height, _) = settle(&sheet, &mut solver, flat, 100, |_, _| false);
        let recovered = |strain: Real, height: Real| {
            strain < rest_strain + 0.002 && (height - rest_height).abs() < 0.01
        };
        let mut bad = Vec::new();
        for kind in STARTS {
            let mut most = 0;
            for run in 0..RUNS {
                let start = start(kind, &sheet, run);
                let (strain, height, steps) = settle(&sheet, &mut solver, start, 240, recovered);
                most = most.max(steps);
                if !recovered(strain, height) {
                    bad.push(format!(
                        "{variant:?} {kind:?} {run}: strain {strain:.1e}, {height:.3} m instead of {rest_strain:.1e}, {rest_height:.3} m"
                    ));
                }
            }
            println!("{variant:?} {kind:?}: back after at most {most} steps");
        }
        bad
    };
    let bad: Vec<String> = variants().into_par_iter().flat_map(cell).collect();
    assert!(bad.is_empty(), "{} runs:\n{}", bad.len(), bad.join("\n"));
}

/// Far from the origin the positions have fewer digits, and that is all.
#[test]
fn coordinates_may_be_large() {
    let sheet = Sheet::new(1e4, 1.0);
    let shift = Vec3::repeat(1e4);
    for variant in variants() {
        let run = |shift: Vec3| {
            let mut state =
                State::at_rest(sheet.mesh.positions().iter().map(|x| x + shift).collect());
            let mut solver = sheet.solver(variant, StiffnessRule::Material, 15);
            for _ in 0..10 {
                solver
                    .step(&mut state, StepInput::new(0.01).gravity(DOWN))
                    .unwrap();
            }
            state
        };
        let (near, far) = (run(Vec3::zeros()), run(shift));
        for (a, b) in near.positions.iter().zip(&far.positions) {
            assert!((b - shift - a).norm() < 1e-6, "{variant:?}");
        }
    }
}
