//! A sheet held at two corners: how far an iteration budget gets in one step, against the minimum of `G`, by the plain
//! iteration and by the default with a coarse grid of 12 cells.
//!
//! ```sh
//! cargo run --release -p cloth-pd --example hanging
//! ```

use cloth_core::cloth::{Cloth, ClothModel, Membrane};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{IncrementalPotential, Strain, predict};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::State;
use cloth_core::step::{BuildError, Observer, StepInput, Stepper};
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

    // A quarter of a second into the fall, one step, watched.
    let mut falling = start.clone();
    let mut solver = build(&model, &start, PdConfig::default())?;
    for _ in 0..15 {
        solver.step(&mut falling, input())?;
    }
    let energies = model.energies()?;
    let mut predicted = start.positions.clone();
    predict(&model.particles, &falling, &input(), &mut predicted);
    let potential = IncrementalPotential {
        particles: &model.particles,
        energies: &energies,
        predicted: &predicted,
        dt: input().dt,
    };
    let watch = |config: PdConfig| -> Result<Vec<Real>, Box<dyn Error>> {
        let mut history = History {
            potential,
            values: vec![potential.value(&predicted)],
        };
        let mut state = falling.clone();
        let config = PdConfig {
            iterations: Some(3000),
            ..config
        };
        let input = input().observer(&mut history);
        build(&model, &start, config)?.step(&mut state, input)?;
        Ok(history.values)
    };
    let runs = [watch(PdConfig::plain())?, watch(PdConfig::default())?];
    let minimum = runs[1][runs[1].len() - 1];
    println!("(G - G*)/(G(x~) - G*)\niterations  plain      default");
    for count in [1, 2, 5, 10, 20, 50, 100, 200, 500] {
        let left = |values: &[Real]| (values[count] - minimum) / (values[0] - minimum);
        println!("{count:10}  {:.3e}  {:.3e}", left(&runs[0]), left(&runs[1]));
    }

    // Many steps of the default, each of ten to 300 iterations.
    let mut state = start.clone();
    let mut solver = build(&model, &start, PdConfig::default())?;
    let (mut factorizations, mut iterations) = (0, 0);
    for _ in 0..300 {
        let report = solver.step(&mut state, input())?;
        factorizations += report.factorizations;
        iterations += report.iterations;
    }
    let strain = Strain::of(&model.springs, &state.positions);
    let lowest = state.positions.iter().map(|x| x.z).fold(0.0, Real::min);
    println!("\nafter 5 s with {} iterations a step:", iterations / 300);
    println!("factorisations {factorizations}");
    println!("lowest point   {lowest:.3} m");
    println!("largest strain {:.2} %", 100.0 * strain.max);

    let falls = runs.iter().all(|values| {
        let mut pairs = values.windows(2);
        pairs.all(|pair| pair[1] <= pair[0] + 1e-12 * values[0])
    });
    if !falls || factorizations != 1 || state.first_non_finite().is_some() || lowest > -0.5 {
        return Err("G rose, or the sheet did not hang".into());
    }
    println!("check: G fell in each iteration, and the sheet hangs");
    Ok(())
}

fn input<'a>() -> StepInput<'a> {
    StepInput::new(1.0 / 60.0).gravity(Vec3::new(0.0, 0.0, -9.81))
}

fn build(model: &ClothModel, rest: &State, config: PdConfig) -> Result<PdSolver, BuildError> {
    PdSolver::builder(&model.particles)
        .energy(model.springs.clone())
        .energy(model.hinges.clone())
        .coarse_grid(&rest.positions, 12)
        .config(config)
        .build()
}
