//! Thin and stiff cloth, where the quasi-Newton method has a long way to go.

use crate::DOWN;
use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::math::Real;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::State;
use cloth_core::step::{Outcome, StepInput, StepReport, Stepper};
use cloth_massspring::{ImplicitConfig, ImplicitEuler, StartGuess};

const SIDE: usize = 33;

/// Steps of a sheet that falls from the horizontal, held by two corners; k in N/m, D in N·m.
fn hang(stiffness: Real, rigidity: Real, dt: Real, steps: usize) -> Vec<StepReport> {
    hang_from(StartGuess::default(), stiffness, rigidity, dt, steps)
}

fn hang_from(
    start: StartGuess,
    stiffness: Real,
    rigidity: Real,
    dt: Real,
    steps: usize,
) -> Vec<StepReport> {
    let mesh = grid(SIDE, SIDE, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(stiffness),
        bending_rigidity: rigidity,
    };
    let mut model = cloth.on(&mesh).unwrap();
    for corner in [SIDE * (SIDE - 1), SIDE * SIDE - 1] {
        model.particles.prescribe(corner).unwrap();
    }
    let builder = ImplicitEuler::builder(&model.particles);
    let builder = builder.energy(model.springs).unwrap();
    let config = ImplicitConfig {
        start,
        ..ImplicitConfig::default()
    };
    let builder = builder.energy(model.hinges).unwrap().config(config);
    let mut solver = builder.build().unwrap();
    let mut state = State::at_rest(mesh.positions().to_vec());
    let step = |_| {
        let input = StepInput::new(dt).gravity(DOWN);
        solver.step(&mut state, input).unwrap()
    };
    (0..steps).map(step).collect()
}

#[test]
fn thin_cloth_buckles_without_newtons_method() {
    for rigidity in [1e-6, 1e-8] {
        let reports = hang(1e4, rigidity, 1.0 / 60.0, 12);
        let fallbacks: u32 = reports.iter().map(|r| r.newton_fallbacks).sum();
        let most = reports.iter().map(|r| r.iterations).max();
        println!("D {rigidity:e}: {fallbacks} fallbacks, {most:?} iterations at most");
        assert!(reports.iter().all(|r| r.outcome == Outcome::Converged));
        assert_eq!(fallbacks, 0, "D {rigidity:e}");
    }
}

#[test]
fn where_only_rounding_is_left_the_iteration_ends() {
    for stiffness in [1e4, 1e8] {
        let reports = hang(stiffness, 1e-8, 1e-3, 20);
        let most = reports.iter().map(|r| r.iterations).max();
        println!("k {stiffness:e}: {most:?} iterations at most");
        assert!(reports.iter().all(|r| r.outcome == Outcome::Converged));
        assert!(most < Some(50), "k {stiffness:e}: {most:?}");
    }
}

#[test]
fn a_start_that_turns_with_the_cloth_saves_iterations() {
    let work = |start| -> u32 {
        let reports = hang_from(start, 1e4, 1e-5, 1.0 / 60.0, 90);
        reports.iter().map(|r| r.iterations + r.backtracks).sum()
    };
    let [inertial, extrapolated] = [StartGuess::Inertial, StartGuess::Extrapolated].map(work);
    println!("evaluations: {inertial} from x + Δt v, {extrapolated} extrapolated");
    assert!(f64::from(extrapolated) < 0.97 * f64::from(inertial));
}
