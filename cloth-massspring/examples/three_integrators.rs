//! One sheet, three integrators: where the energy goes.
//!
//! A sheet of 1 m × 1 m hangs from two corners and swings down for half a second. What it loses in height appears as
//! motion and stretch, or it is lost by the method. Forward Euler ends when it has gained too much.
//!
//! `cargo run --release -p cloth-massspring --example three_integrators`

use cloth_core::cloth::{Cloth, ClothModel, Membrane};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{gravitational_energy, kinetic_energy};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::method::family::Energies;
use cloth_core::particles::State;
use cloth_core::step::{StepError, StepInput, Stepper};
use cloth_massspring::{ExplicitEuler, ImplicitEuler, SymplecticEuler, stable_time_step};
use std::error::Error;

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);
const DURATION: Real = 0.5;
const SIDE: usize = 16;

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = grid(SIDE, SIDE, 1.0, 1.0, Diagonals::Alternating)?;
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e4),
        bending_rigidity: 1e-5,
    };
    let mut model = cloth.on(&mesh)?;
    model.particles.prescribe(SIDE * SIDE - SIDE)?;
    model.particles.prescribe(SIDE * SIDE - 1)?;
    let energies = model.energies()?;
    let rest = mesh.positions();
    let stable = stable_time_step(&energies, &model.particles, rest).expect("springs are stiff");
    println!(
        "{} vertices, largest stable step {:.3} ms",
        model.particles.len(),
        stable * 1e3
    );
    println!(
        "method            step/ms   time/s  kinetic/J  elastic/J  gravitational/J      sum/J"
    );

    let springs = || model.springs.clone();
    let (explicit, symplectic, implicit) = (
        ExplicitEuler::builder(&model.particles).energy(springs()),
        SymplecticEuler::builder(&model.particles).energy(springs()),
        ImplicitEuler::builder(&model.particles).energy(springs()),
    );
    let hinges = || model.hinges.clone();
    let swing = Swing {
        model: &model,
        energies: &energies,
        rest,
    };
    let forward = swing.run(&mut explicit.energy(hinges()).build()?, 0.1 * stable);
    let kept = swing.run(&mut symplectic.energy(hinges()).build()?, 0.9 * stable);
    let lost = swing.run(&mut implicit.energy(hinges()).build()?, 1.0 / 60.0);

    // Nothing acts from outside, so the sum stays 0 in a solution that is exact in time. The fall turns over about 1 J.
    assert!(matches!(forward.end, Some(StepError::Unstable { .. })));
    assert!(
        kept.end.is_none() && kept.sum.abs() < 0.01,
        "symplectic Euler keeps the energy"
    );
    assert!(
        lost.end.is_none() && lost.sum < -0.05,
        "implicit Euler loses some"
    );
    println!(
        "as expected: symplectic Euler keeps the energy, implicit Euler loses some, forward Euler blows up"
    );
    Ok(())
}

struct Swing<'a> {
    model: &'a ClothModel,
    energies: &'a Energies,
    rest: &'a [Vec3],
}

struct Fate {
    /// Kinetic, elastic and gravitational energy (J) together, 0 at the start.
    sum: Real,
    end: Option<StepError>,
}

impl Swing<'_> {
    /// Swings for half a second, or until the method gives up, and prints a line.
    fn run(&self, solver: &mut dyn Stepper, dt: Real) -> Fate {
        let mut state = State::at_rest(self.rest.to_vec());
        let mut end = None;
        while state.time < DURATION && end.is_none() {
            end = solver
                .step(&mut state, StepInput::new(dt).gravity(GRAVITY))
                .err();
        }
        let kinetic = kinetic_energy(&self.model.particles, &state.velocities);
        let elastic = self.energies.value(&state.positions);
        let height = |x: &[Vec3]| gravitational_energy(&self.model.particles, x, GRAVITY);
        let fall = height(&state.positions) - height(self.rest);
        let sum = kinetic + elastic + fall;
        println!(
            "{:<16} {:8.4} {:8.4} {kinetic:10.5} {elastic:10.5} {fall:16.5} {sum:10.5}",
            solver.name(),
            dt * 1e3,
            state.time,
        );
        if let Some(error) = &end {
            println!("    {error}");
        }
        Fate { sum, end }
    }
}
