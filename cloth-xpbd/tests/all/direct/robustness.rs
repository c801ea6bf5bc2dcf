//! Starts that make no sense, at ratios that are too large. A run passes if a step ends finite, or is refused
//! with the state untouched.

use crate::bad_starts::{STARTS, sheet};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::Strain;
use cloth_core::particles::State;
use cloth_core::step::{Outcome, StepInput, Stepper};
use cloth_xpbd::direct::{DirectConfig, DirectXpbd, System};

const RUNS: usize = 10;
const DOWN: Vec3 = Vec3::new(0.0, -9.81, 0.0);

#[derive(Debug, Default)]
struct Count {
    converged: usize,
    spent: usize,
    refused: usize,
}

fn count(config: DirectConfig, stiffness: (Real, Real), mass: Real, dt: Real) -> Count {
    let sheet = sheet(stiffness.0, stiffness.1, mass);
    let builder = DirectXpbd::builder(&sheet.particles).energy(sheet.springs.clone());
    let builder = builder.energy(sheet.hinges.clone()).config(config);
    let mut solver = builder.build().unwrap();
    let mut count = Count::default();
    for kind in STARTS {
        for run in 0..RUNS {
            let before = sheet.start(kind, run);
            let mut state = before.clone();
            match solver.step(&mut state, StepInput::new(dt).gravity(DOWN)) {
                Ok(report) => {
                    assert_eq!(state.first_non_finite(), None, "{kind:?} {run}");
                    assert!(report.residual.is_some_and(Real::is_finite));
                    match report.outcome {
                        Outcome::Converged => count.converged += 1,
                        Outcome::BudgetSpent => count.spent += 1,
                    }
                }
                Err(error) => {
                    assert!(state == before, "{kind:?}: {error} changed the state");
                    count.refused += 1;
                }
            }
        }
    }
    count
}

#[test]
fn a_step_is_finite_or_refused_from_any_start_at_any_ratio() {
    let mut sum = Count::default();
    for stiffness in [(0.0, 1.0), (1e2, 1.0), (1e2, 1e8), (Real::INFINITY, 1.0)] {
        for mass in [1.0, 1e6] {
            for dt in [1e-3, 1.0 / 60.0, 1.0] {
                for system in [System::SaddleLdlt, System::SchurCholesky] {
                    let config = DirectConfig {
                        system,
                        max_iterations: 15,
                        ..DirectConfig::default()
                    };
                    let cell = count(config, stiffness, mass, dt);
                    sum.converged += cell.converged;
                    sum.spent += cell.spent;
                    sum.refused += cell.refused;
                }
            }
        }
    }
    println!("{sum:?}");
    assert_eq!(
        sum.converged + sum.spent + sum.refused,
        4 * 2 * 3 * 2 * 4 * RUNS
    );
}

/// Steps cut short at fifteen iterations still take every start back within two seconds: for ten steps on end its
/// edges are as near to their lengths as those of a sheet that hangs at rest, though it may still swing.
#[test]
fn every_start_recovers_to_a_hanging_sheet() {
    let sheet = sheet(1e4, 1.0, 1.0);
    let config = DirectConfig {
        max_iterations: 15,
        tolerance: 1e-7,
        damping: 1e-3,
        ..DirectConfig::default()
    };
    let builder = DirectXpbd::builder(&sheet.particles).energy(sheet.springs.clone());
    let builder = builder.energy(sheet.hinges.clone()).config(config);
    let mut solver = builder.build().unwrap();
    let mut step = |state: &mut State| {
        let input = StepInput::new(1.0 / 60.0).gravity(DOWN);
        solver.step(state, input).unwrap();
        Strain::of(&sheet.springs, &state.positions).rms
    };
    let mut hanging = sheet.hanging();
    let rest = (0..120).map(|_| step(&mut hanging)).last().unwrap();
    for kind in STARTS {
        let mut latest = 0;
        for run in 0..RUNS {
            let mut state = sheet.start(kind, run);
            let mut calm = 0;
            let mut strain = 0.0;
            let back = (1..=120).find(|_| {
                strain = step(&mut state);
                calm = if strain < rest + 0.001 { calm + 1 } else { 0 };
                calm == 10
            });
            assert!(back.is_some(), "{kind:?} {run}: rms strain {strain}");
            latest = latest.max(back.unwrap());
        }
        println!("{kind:?}: back after at most {latest} steps, rms strain at rest {rest:e}");
    }
}
