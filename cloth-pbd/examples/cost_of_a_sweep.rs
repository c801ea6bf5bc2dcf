//! What one element costs in one sweep, for each kind of element and both rules, on one thread.
//!
//! `cargo run --release -p cloth-pbd --example cost_of_a_sweep`

use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::element::{Constraint, Element};
use cloth_core::energy::{AreaTriangle, CurvatureHinge, DihedralHinge, HingeLaw};
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_pbd::{PbdConfig, PbdSolver, StiffnessRule};
use std::error::Error;
use std::time::Instant;

type Failure = Box<dyn Error + Send + Sync>;

/// Vertices a side, sweeps in a step, and steps of which the fastest counts.
const SIDE: usize = 128;
const SWEEPS: u32 = 20;
const REPETITIONS: u32 = 10;

fn main() -> Result<(), Failure> {
    let mesh = grid(SIDE, SIDE, 1.0, 1.0, Diagonals::Alternating)?;
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e4),
        bending_rigidity: 1e-4,
    };
    let mut model = cloth.on(&mesh)?;
    model.particles.prescribe(0)?;
    model.particles.prescribe(SIDE - 1)?;
    let by_angle = |hinge: &CurvatureHinge| DihedralHinge {
        vertices: hinge.vertices(),
        rest_angle: 0.0,
        stiffness: 1e-4,
        law: HingeLaw::Angle,
    };
    let angles: Vec<DihedralHinge> = model.hinges.iter().map(by_angle).collect();
    let areas = AreaTriangle::on(&mesh, 1e4);
    let (particles, x) = (&model.particles, mesh.positions());
    println!("element            elements   ns an element and sweep: material   fixed");
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()?
        .install(|| {
            print("spring", &model.springs, particles, x)?;
            print("isometric bending", &model.hinges, particles, x)?;
            print("bending by angle", &angles, particles, x)?;
            print("area", &areas, particles, x)
        })
}

fn print<const N: usize, E: Constraint<N>>(
    name: &str,
    elements: &[E],
    particles: &Particles,
    positions: &[Vec3],
) -> Result<(), Failure> {
    let cost = |rule| cost(elements, particles, positions, rule);
    let (material, fixed) = (
        cost(StiffnessRule::Material)?,
        cost(StiffnessRule::Fixed(0.5))?,
    );
    let count = elements.len();
    println!("{name:18} {count:8} {material:36.1} {fixed:7.1}");
    Ok(())
}

/// Time (ns) of one element in one sweep: the fastest of some steps, over their sweeps and elements.
fn cost<const N: usize, E: Constraint<N>>(
    elements: &[E],
    particles: &Particles,
    positions: &[Vec3],
    stiffness: StiffnessRule,
) -> Result<f64, Failure> {
    let config = PbdConfig {
        iterations: SWEEPS,
        stiffness,
        ..PbdConfig::default()
    };
    let mut solver = PbdSolver::builder(particles)
        .energy(elements.to_vec())
        .config(config)
        .build()?;
    let mut state = State::at_rest(positions.to_vec());
    let mut fastest = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let input = StepInput::new(1.0 / 60.0).gravity(Vec3::z() * -9.81);
        let start = Instant::now();
        solver.step(&mut state, input)?;
        fastest = fastest.min(start.elapsed().as_secs_f64());
    }
    Ok(1e9 * fastest / (f64::from(SWEEPS) * elements.len() as f64))
}
