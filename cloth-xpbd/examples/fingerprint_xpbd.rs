//! A number for every bit of a falling sheet after some steps, one for each kind of sweep. It is the same on any
//! number of threads, and without the feature `parallel`:
//!
//! `cargo run --release -p cloth-xpbd --example fingerprint_xpbd`
//! `cargo run --release -p cloth-xpbd --example fingerprint_xpbd --no-default-features`

use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::energy::StvkTriangle;
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_core::particles::State;
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::{XpbdConfig, XpbdSolver};
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
    for (name, sweep, chebyshev, damping) in [
        ("sequential", Sweep::Sequential, None, 0.0),
        ("coloured", Sweep::Colored, None, 0.0),
        ("coloured, damped", Sweep::Colored, None, 1e-3),
        ("coloured, Chebyshev", Sweep::Colored, chebyshev, 0.0),
        ("Jacobi", Sweep::Jacobi, None, 0.0),
        ("Jacobi, Chebyshev", Sweep::Jacobi, chebyshev, 0.0),
    ] {
        let config = XpbdConfig {
            iterations: 8,
            substeps: 2,
            sweep,
            acceleration: Acceleration {
                chebyshev,
                ..Acceleration::default()
            },
            damping,
            energy_gain: None,
        };
        let triangles = StvkTriangle::on(&mesh, 100.0, 0.3);
        let mut solver = XpbdSolver::builder(&model.particles)
            .energy(model.springs.clone())
            .energy(triangles)
            .energy(model.hinges.clone())
            .config(config)
            .build()?;
        let mut state = State::at_rest(mesh.positions().to_vec());
        for _ in 0..steps {
            let input = StepInput::new(1.0 / 60.0).gravity(Vec3::z() * -9.81);
            solver.step(&mut state, input)?;
        }
        let mut forces = vec![Vec3::zeros(); mesh.vertex_count()];
        solver.vertex_forces_into(&mut forces);
        println!("{name:20} {:016x}", fingerprint(&state, &forces));
    }
    Ok(())
}

/// FNV-1a over the bits of all positions, velocities and forces.
fn fingerprint(state: &State, forces: &[Vec3]) -> u64 {
    let numbers = state
        .positions
        .iter()
        .chain(&state.velocities)
        .chain(forces);
    let bytes = numbers.flat_map(|v| v.iter().flat_map(|c| c.to_bits().to_le_bytes()));
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte: u8| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
