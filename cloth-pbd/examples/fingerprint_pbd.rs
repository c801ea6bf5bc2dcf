//! A number for every bit of a falling sheet after some steps, one for each kind of sweep. It is the same on any
//! number of threads, and without the feature `parallel`:
//!
//! `cargo run --release -p cloth-pbd --example fingerprint_pbd`
//! `cargo run --release -p cloth-pbd --example fingerprint_pbd --no-default-features`

use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::energy::ArapTriangle;
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_core::particles::State;
use cloth_core::step::StepInput;
use cloth_core::step::Stepper;
use cloth_pbd::{
    Hierarchy, HierarchyConfig, PbdConfig, PbdSolver, StrainLimiter, StretchRange, WithStrainLimit,
};
use std::error::Error;

/// Large enough for every parallel path.
const SIDE: usize = 150;
const STEPS: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let mut given = std::env::args().skip(1);
    let side = given.next().map_or(Ok(SIDE), |text| text.parse())?;
    let steps = given.next().map_or(Ok(STEPS), |text| text.parse())?;
    let mesh = grid(side, side, 1.0, 1.0, Diagonals::Alternating)?;
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e4),
        bending_rigidity: 1e-4,
    };
    let mut model = cloth.on(&mesh)?;
    model.particles.prescribe(0)?;
    model.particles.prescribe(side - 1)?;
    let chebyshev = Some(Chebyshev {
        radius: Radius::Estimated,
        delay: 3,
    });
    for (name, sweep, chebyshev, coarse) in [
        ("sequential", Sweep::Sequential, None, false),
        ("coloured", Sweep::Colored, None, false),
        ("coloured, Chebyshev", Sweep::Colored, chebyshev, false),
        ("coloured, hierarchy", Sweep::Colored, None, true),
        ("Jacobi", Sweep::Jacobi, None, false),
        ("Jacobi, Chebyshev", Sweep::Jacobi, chebyshev, false),
    ] {
        let config = PbdConfig {
            iterations: 12,
            sweep,
            acceleration: Acceleration {
                chebyshev,
                ..Acceleration::default()
            },
            ..PbdConfig::default()
        };
        let mut solver = PbdSolver::builder(&model.particles)
            .energy(model.springs.clone())
            .energy(model.hinges.clone())
            .config(config)
            .build()?;
        if coarse {
            let config = HierarchyConfig {
                every: Some(4),
                ..HierarchyConfig::default()
            };
            let hierarchy = Hierarchy::build(&mesh, &model.particles, config)?;
            solver = solver.with_hierarchy(hierarchy)?;
        }
        let limiter = StrainLimiter::builder(&model.particles)
            .stretches(&ArapTriangle::on(&mesh, 1.0), StretchRange::stretch(0.01))
            .max_passes(5)
            .build()?;
        let mut solver = WithStrainLimit::new(Box::new(solver), limiter);
        let mut state = State::at_rest(mesh.positions().to_vec());
        for _ in 0..steps {
            let input = StepInput::new(1.0 / 60.0).gravity(Vec3::z() * -9.81);
            solver.step(&mut state, input)?;
        }
        println!("{name:20} {:016x}", fingerprint(&state));
    }
    Ok(())
}

/// FNV-1a over the bits of all positions and velocities.
fn fingerprint(state: &State) -> u64 {
    let numbers = state.positions.iter().chain(&state.velocities);
    let bytes = numbers.flat_map(|v| v.iter().flat_map(|c| c.to_bits().to_le_bytes()));
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte: u8| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
