//! A sheet hangs at rest, by its upper edge or by its two upper corners. In one step gravity takes every vertex down by g h², and the sweeps have to
//! bring it back: how many sweeps, and how much time, until a hundredth of that is left, plainly and with each acceleration.
//!
//! `cargo run --release -p cloth-pbd --example accelerations [vertices a side, 16] [edge or corners, both]`

use cloth_core::energy::Spring;
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::{Particles, State};
use cloth_core::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_core::step::{Observer, StepInput, Stepper};
use cloth_core::topology::EdgeTable;
use cloth_pbd::{Hierarchy, HierarchyConfig, PbdConfig, PbdSolver, StiffnessRule};
use std::error::Error;
use std::time::Instant;

const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);
const STEP: f64 = 1.0 / 60.0;
const MOST_SWEEPS: u32 = 300_000;

/// The first sweep after which the root mean square of the distances to the places at rest was small.
struct Errors<'a> {
    rest: &'a [Vec3],
    wanted: f64,
    reached: Option<u32>,
}

impl Observer for Errors<'_> {
    fn iteration(&mut self, sweep: u32, x: &[Vec3]) {
        if self.reached.is_none() {
            let square = |(x, rest): (&Vec3, &Vec3)| (x - rest).norm_squared();
            let sum: f64 = x.iter().zip(self.rest).map(square).sum();
            if (sum / x.len() as f64).sqrt() <= self.wanted {
                self.reached = Some(sweep);
            }
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let side = match std::env::args().nth(1) {
        Some(side) => side.parse()?,
        None => 16,
    };
    let only = std::env::args().nth(2);
    for held in ["edge", "corners"] {
        if only.as_ref().is_none_or(|only| only == held) {
            compare(side, held)?;
        }
    }
    Ok(())
}

fn compare(side: usize, held: &str) -> Result<(), Box<dyn Error>> {
    let mesh = grid(side, side, 1.0, 1.0, Diagonals::Alternating)?;
    let mut particles = Particles::from_areal_density(&mesh, 0.2)?;
    let top = mesh
        .positions()
        .iter()
        .map(|x| x.y)
        .fold(f64::MIN, f64::max);
    for (v, x) in mesh.positions().iter().enumerate() {
        if x.y == top && (held == "edge" || x.x == 0.0 || x.x == 1.0) {
            particles.prescribe(v)?;
        }
    }
    let none = None;
    let chebyshev = |radius| Some(Chebyshev { radius, delay: 4 });
    let once = Some(HierarchyConfig::default());
    let often = |every| {
        Some(HierarchyConfig {
            every: Some(every),
            ..HierarchyConfig::default()
        })
    };
    let auto = chebyshev(Radius::Estimated);
    let given = chebyshev(Radius::Given(1.0 - 2.5 / (side * side) as f64));
    let methods = [
        ("coloured", Sweep::Colored, none, None),
        ("coloured, Chebyshev given", Sweep::Colored, given, None),
        ("coloured, Chebyshev auto", Sweep::Colored, auto, None),
        (
            "in the order given, Chebyshev auto",
            Sweep::Sequential,
            auto,
            None,
        ),
        ("coloured, hierarchy once", Sweep::Colored, none, once),
        (
            "coloured, hierarchy every 10",
            Sweep::Colored,
            none,
            often(10),
        ),
        ("hierarchy once, Chebyshev auto", Sweep::Colored, auto, once),
        (
            "hierarchy every 40, Chebyshev auto",
            Sweep::Colored,
            auto,
            often(40),
        ),
        ("Jacobi, Chebyshev auto", Sweep::Jacobi, auto, None),
    ];
    println!("{side} × {side} vertices, held by its {held}: sweeps and time to 1 % of g h²");
    let mut first = None;
    for (name, sweep, chebyshev, hierarchy) in methods {
        let acceleration = Acceleration {
            chebyshev,
            ..Acceleration::default()
        };
        let config = PbdConfig {
            sweep,
            acceleration,
            stiffness: StiffnessRule::Fixed(1.0),
            ..PbdConfig::default()
        };
        let Some(needed) = measure(&mesh, &particles, config, hierarchy)? else {
            println!("{name:36} not in {MOST_SWEEPS} sweeps");
            continue;
        };
        let plain = *first.get_or_insert(needed);
        println!(
            "{name:36} {:6} sweeps {:9.1} ms   {:7.1} times fewer, {:7.1} times faster",
            needed.sweeps,
            1e3 * needed.seconds,
            f64::from(plain.sweeps) / f64::from(needed.sweeps),
            plain.seconds / needed.seconds,
        );
    }
    Ok(())
}

/// Sweeps until the error is small, and the time (s) of a step of so many.
#[derive(Clone, Copy)]
struct Needed {
    sweeps: u32,
    seconds: f64,
}

/// `None` if too many sweeps are needed.
fn measure(
    mesh: &TriMesh,
    particles: &Particles,
    config: PbdConfig,
    hierarchy: Option<HierarchyConfig>,
) -> Result<Option<Needed>, Box<dyn Error>> {
    let edges = EdgeTable::build(mesh)?;
    let springs = Spring::along(mesh.positions(), edges.ends(), 1.0);
    let make = |iterations| -> Result<PbdSolver, Box<dyn Error>> {
        let config = PbdConfig {
            iterations,
            ..config
        };
        let builder = PbdSolver::builder(particles).energy(springs.clone());
        let solver = builder.config(config).build()?;
        Ok(match hierarchy {
            Some(config) => solver.with_hierarchy(Hierarchy::build(mesh, particles, config)?)?,
            None => solver,
        })
    };
    let start = State::at_rest(mesh.positions().to_vec());
    let mut sweeps = 1000;
    while sweeps <= MOST_SWEEPS {
        let mut errors = Errors {
            rest: mesh.positions(),
            wanted: 0.01 * GRAVITY.norm() * STEP * STEP,
            reached: None,
        };
        let input = StepInput::new(STEP).gravity(GRAVITY);
        make(sweeps)?.step(&mut start.clone(), input.observer(&mut errors))?;
        if let Some(sweeps) = errors.reached {
            let mut solver = make(sweeps)?;
            // The second step is the warm one; the best of five.
            let mut seconds = f64::INFINITY;
            for _ in 0..6 {
                let mut state = start.clone();
                let started = Instant::now();
                solver.step(&mut state, StepInput::new(STEP).gravity(GRAVITY))?;
                seconds = seconds.min(started.elapsed().as_secs_f64());
            }
            return Ok(Some(Needed { sweeps, seconds }));
        }
        sweeps *= 4;
    }
    Ok(None)
}
