//! A sheet held at two corners: how far an iteration budget gets in the first step, against the minimum of `G`.

use cloth_core::cloth::{Cloth, ClothModel, Membrane};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{IncrementalPotential, Strain, predict};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::State;
use cloth_core::step::{Observer, StepInput, Stepper};
use cloth_pd::{PdConfig, PdSolver};
use std::error::Error;

const SIDE: usize = 16;

/// `G` (J) after every iteration.
struct History<'a> {
    potential: IncrementalPotential<'a>,
    values: Vec<Real>,
}

impl Observer for History<'_> {
    fn iteration(&mut self, _: u32, positions: &[Vec3]) {
        self.values.push(self.potential.value(positions));
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = grid(SIDE, SIDE, 1.0, 1.0, Diagonals::Alternating)?;
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e4),
        bending_rigidity: 1e-5,
    };
    let mut model = cloth.on(&mesh)?;
    model.particles.prescribe(SIDE * (SIDE - 1))?;
    model.particles.prescribe(SIDE * SIDE - 1)?;
    let start = State::at_rest(mesh.positions().to_vec());

    // One step, watched.
    let energies = model.energies()?;
    let mut predicted = start.positions.clone();
    predict(&model.particles, &start, &input(), &mut predicted);
    let potential = IncrementalPotential {
        particles: &model.particles,
        energies: &energies,
        predicted: &predicted,
        dt: input().dt,
    };
    let mut history = History {
        potential,
        values: vec![potential.value(&predicted)],
    };
    let mut state = start.clone();
    solver(&model, 5000)?.step(&mut state, input().observer(&mut history))?;
    let values = &history.values;
    let minimum = values[values.len() - 1];
    println!("iterations  (G - G*)/(G(x~) - G*)");
    for count in [1, 2, 5, 10, 20, 50, 100, 200, 500] {
        let left = (values[count] - minimum) / (values[0] - minimum);
        println!("{count:10}  {left:.3e}");
    }

    // Many steps with a few iterations each.
    let mut state = start;
    let mut solver = solver(&model, 10)?;
    let mut factorizations = 0;
    for _ in 0..300 {
        factorizations += solver.step(&mut state, input())?.factorizations;
    }
    let strain = Strain::of(&model.springs, &state.positions);
    let lowest = state.positions.iter().map(|x| x.z).fold(0.0, Real::min);
    println!("\nafter 5 s with 10 iterations a step:");
    println!("factorisations {factorizations}");
    println!("lowest point   {lowest:.3} m");
    println!("largest strain {:.2} %", 100.0 * strain.max);

    let falls = values
        .windows(2)
        .all(|pair| pair[1] <= pair[0] * (1.0 + 1e-12));
    if !falls || factorizations != 1 || state.first_non_finite().is_some() || lowest > -0.5 {
        return Err("G rose, or the sheet did not hang".into());
    }
    println!(
        "check: G fell in each of {} iterations, and the sheet hangs",
        values.len() - 1
    );
    Ok(())
}

fn input<'a>() -> StepInput<'a> {
    StepInput::new(1.0 / 60.0).gravity(Vec3::new(0.0, 0.0, -9.81))
}

fn solver(model: &ClothModel, iterations: u32) -> Result<PdSolver, cloth_core::step::BuildError> {
    PdSolver::builder(&model.particles)
        .energy(model.springs.clone())
        .energy(model.hinges.clone())
        .config(PdConfig {
            iterations,
            ..PdConfig::default()
        })
        .build()
}
