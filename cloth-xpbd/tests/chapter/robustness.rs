//! Starts that make no sense, at ratios that are too large (VALIDATION 8.5).
//!
//! A cell is one kind of start at one size of step, stiffness and mass ratio; ten jittered runs each. A run passes if every step ends finite or is refused with the state
//! untouched, and where it is asked to recover, if the edges come back to their lengths.

use crate::bad_starts::{STARTS, Sheet, sheet};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{gravitational_energy, kinetic_energy};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

const RUNS: usize = 10;
const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

fn solver(sheet: &Sheet, config: XpbdConfig) -> XpbdSolver {
    let builder = XpbdSolver::builder(&sheet.particles).energy(sheet.springs.clone());
    let builder = builder.energy(sheet.hinges.clone()).config(config);
    builder.build().unwrap()
}

/// Root mean square strain of the springs.
fn strain(sheet: &Sheet, state: &State) -> Real {
    cloth_core::measure::Strain::of(&sheet.springs, &state.positions).rms
}

#[test]
fn every_step_is_finite_from_any_start_at_any_ratio() {
    let mut cells = 0;
    for (stiffness, ratio) in [
        (0.0, 1.0),
        (1e2, 1e8),
        (1e2, Real::INFINITY),
        (Real::INFINITY, 1.0),
    ] {
        for mass in [1.0, 1e6] {
            let sheet = sheet(stiffness, ratio, mass);
            for dt in [1e-3, 1.0 / 60.0, 1.0] {
                for damping in [0.0, 0.1] {
                    for (iterations, substeps) in [(1, 1), (1, 8), (20, 1)] {
                        for kind in STARTS {
                            cells += 1;
                            let config = XpbdConfig {
                                iterations,
                                substeps,
                                damping,
                                ..XpbdConfig::default()
                            };
                            let mut solver = solver(&sheet, config);
                            for run in 0..RUNS {
                                let mut state = sheet.start(kind, run);
                                for _ in 0..3 {
                                    let input = StepInput::new(dt).gravity(GRAVITY);
                                    let step = solver.step(&mut state, input);
                                    let cell = (kind, stiffness, ratio, mass, dt, damping, run);
                                    assert!(step.is_ok(), "{cell:?}: {step:?}");
                                    assert_eq!(state.first_non_finite(), None, "{cell:?}");
                                    let residual = solver.compliance_residual(&state.positions);
                                    assert!(residual.is_finite(), "{cell:?}: {residual}");
                                }
                            }
                        }
                    }
                }
            }
        }
    }
    assert_eq!(cells, 4 * 2 * 3 * 2 * 3 * 4);
}

/// Gravity and damping take every start back to a sheet that hangs: its energy ends below that of its start, its edges near their lengths.
#[test]
fn every_start_recovers_to_a_hanging_sheet() {
    let sheet = sheet(1e4, 1.0, 1.0);
    let config = XpbdConfig {
        damping: 1e-3,
        ..XpbdConfig::default()
    };
    let mut solver = solver(&sheet, config);
    for kind in STARTS {
        for run in 0..RUNS {
            let mut state = sheet.start(kind, run);
            let energy = |state: &State| {
                kinetic_energy(&sheet.particles, &state.velocities)
                    + gravitational_energy(&sheet.particles, &state.positions, GRAVITY)
                    + sheet
                        .springs
                        .iter()
                        .map(|s| {
                            let x = s.vertices.map(|v| state.positions[v as usize]);
                            cloth_core::element::Energy::value(s, &x)
                        })
                        .sum::<Real>()
            };
            let before = energy(&state);
            for _ in 0..300 {
                let input = StepInput::new(1.0 / 60.0).gravity(GRAVITY);
                solver.step(&mut state, input).unwrap();
            }
            let (after, strain) = (energy(&state), strain(&sheet, &state));
            assert!(after < before, "{kind:?} {run}: {before} to {after} J");
            assert!(strain < 0.02, "{kind:?} {run}: rms strain {strain}");
        }
    }
}

#[test]
fn edges_of_no_length_and_coordinates_far_away_are_taken() {
    for rest_length in [0.0, 0.3] {
        for stiffness in [0.0, 10.0, 1e12, Real::MAX, Real::INFINITY] {
            for offset in [0.0, 1e4] {
                let mut particles = Particles::new(vec![1e-3, 1.0, 1e3]).unwrap();
                particles.prescribe(2).unwrap();
                let spring = |vertices| Spring {
                    vertices,
                    rest_length,
                    stiffness,
                };
                let builder = XpbdSolver::builder(&particles);
                let builder = builder.energy([[0, 1], [1, 2], [2, 0]].map(spring).to_vec());
                let mut solver = builder.build().unwrap();
                let mut state = State::at_rest(vec![Vec3::from_element(offset); 3]);
                for dt in [1e-3, 1.0] {
                    let input = StepInput::new(dt).gravity(GRAVITY);
                    solver.step(&mut state, input).unwrap();
                    assert_eq!(state.first_non_finite(), None);
                }
                if stiffness == Real::INFINITY && rest_length > 0.0 {
                    // One sweep a substep does not meet three rows at once, but nearly so at the end of a long fall's worth of substeps.
                    let length = (state.positions[1] - state.positions[2]).norm();
                    assert!((length - rest_length).abs() < 0.1, "{length}");
                }
            }
        }
    }
}
