//! Geometric stiffness (Tournier et al. 2015): one linear solve a step, with it and without.

use crate::chain::Chain;
use crate::direct::{GRAVITY, largest_distance, solver, with};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{gravitational_energy, kinetic_energy};
use cloth_core::particles::State;
use cloth_core::step::{Outcome, StepInput, Stepper};
use cloth_xpbd::direct::{DirectConfig, System};

/// A light chain of ten links of 0.1 m and 10 g with a heavy end, hanging, its vertices moved sideways by some
/// 0.1 mm.
fn hanging(tip: Real, stiffness: Real) -> (Chain, State) {
    let mut chain = Chain::of(10, 0.01, 0.1, stiffness);
    chain.particles.set_mass(10, tip).unwrap();
    let mut state = chain.at_rest();
    for (i, x) in state.positions.iter_mut().enumerate().skip(1) {
        x.x = 1e-4 * ((i * i) as Real).sin();
    }
    (chain, state)
}

/// Largest distance (m) from the vertical in two seconds of steps of 1/60 s, largest gain of energy (J) over
/// the start, and the positions at the end.
fn two_seconds(chain: &Chain, start: &State, config: DirectConfig) -> (Real, Real, Vec<Vec3>) {
    let energy = |state: &State| {
        kinetic_energy(&chain.particles, &state.velocities)
            + gravitational_energy(&chain.particles, &state.positions, GRAVITY)
    };
    let mut solver = solver(chain, config);
    let mut state = start.clone();
    let (mut sideways, mut gain): (Real, Real) = (0.0, 0.0);
    for _ in 0..120 {
        let input = StepInput::new(1.0 / 60.0).gravity(GRAVITY);
        solver.step(&mut state, input).unwrap();
        let away = state.positions.iter().map(|x| x.x.hypot(x.y));
        sideways = away.fold(sideways, Real::max);
        gain = gain.max(energy(&state) - energy(start));
    }
    (sideways, gain, state.positions)
}

/// The tension T makes the light vertices swing sideways with `ω² = 4T/(m l)` and less. In the plain form the
/// direction of the tension is that of the start of the step, as in an explicit method, and `hω > 2` is
/// unstable: here it is 3.3 for a tip of 1 kg, and 33 for 100 kg. No stiffness of the links changes that, nor
/// how exactly the system is solved.
#[test]
fn one_solve_a_step_is_stable_with_geometric_stiffness_and_not_without() {
    for tip in [1.0, 10.0, 100.0] {
        for stiffness in [1e7, Real::INFINITY] {
            let (chain, start) = hanging(tip, stiffness);
            let plain = DirectConfig {
                geometric_stiffness: false,
                ..DirectConfig::linearized()
            };
            let (sideways, gain, _) = two_seconds(&chain, &start, plain);
            assert!(sideways > 0.1, "{sideways} m");
            assert!(gain > 1.0, "{gain} J");
            let (_, _, converged) = two_seconds(&chain, &start, with(System::SaddleLdlt));
            for system in [System::SaddleLdlt, System::SchurCholesky] {
                let config = DirectConfig {
                    system,
                    ..DirectConfig::linearized()
                };
                let (sideways, gain, positions) = two_seconds(&chain, &start, config);
                assert!(sideways < 1.5e-4, "{system:?}: {sideways:e} m");
                let apart = largest_distance(&positions, &converged);
                assert!(apart < 6e-5, "{system:?}: {apart:e} m");
                if stiffness == Real::INFINITY {
                    // The start violates the links by some 1e-7 m; to put that right lifts the tip.
                    assert!(gain < 1e-6 * tip.max(10.0), "{system:?}: {gain:e} J");
                }
            }
            // With the exact matrix one solve is enough.
            let (_, _, once) = two_seconds(&chain, &start, DirectConfig::linearized());
            let apart = largest_distance(&once, &converged);
            assert!(apart < 1e-6, "{apart:e} m");
        }
    }
}

/// Where the iteration may go on, the line search keeps the plain form from going astray, and it crawls.
#[test]
fn geometric_stiffness_saves_iterations_where_the_links_turn() {
    let mut chain = Chain::of(10, 0.01, 0.1, Real::INFINITY);
    chain.particles.set_mass(10, 100.0).unwrap();
    let mut start = chain.at_rest();
    for x in &mut start.positions {
        *x = Vec3::new(-0.6 * x.z, 0.0, 0.8 * x.z);
    }
    let iterations = |geometric_stiffness| {
        let config = DirectConfig {
            geometric_stiffness,
            ..DirectConfig::default()
        };
        let mut solver = solver(&chain, config);
        let mut state = start.clone();
        let mut sum = 0;
        for _ in 0..10 {
            let input = StepInput::new(1.0 / 60.0).gravity(GRAVITY);
            match solver.step(&mut state, input) {
                Ok(report) if report.outcome == Outcome::Converged => sum += report.iterations,
                Ok(_) | Err(_) => return None,
            }
        }
        Some(sum)
    };
    let with = iterations(true).expect("converges in every step");
    assert!(with <= 150, "{with}");
    assert_eq!(iterations(false), None);
}
