//! Starts and materials that no one would choose, with every acceleration.

use crate::cloth::{
    GRAVITY, accelerated, coarse_solver, falling, hanging, iterations, noise, potential, sheet,
    solver,
};
use cloth_core::cloth::ClothModel;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::kinetic_energy;
use cloth_core::particles::State;
use cloth_core::step::{StepError, StepInput, Stepper};
use cloth_pd::{Acceleration, PdConfig, StartGuess};

type Deform = fn(&Vec3) -> Vec3;

/// Starts at rest far from any rest shape: all in a point, on a line, in a plane that halves it, mirrored, and blown up
/// a hundredfold.
const STARTS: [(&str, Deform); 5] = [
    ("collapsed to a point", |_| Vec3::zeros()),
    ("on a line", |x| Vec3::new(x.x, 0.0, 0.0)),
    ("flattened", |x| Vec3::new(0.5 * x.x, x.y, 0.0)),
    ("mirrored", |x| Vec3::new(-x.x, x.y, -x.z)),
    ("blown up", |x| x * 100.0),
];

/// Energy (J) of springs and of gravity.
fn potential_energy(model: &ClothModel, x: &[Vec3]) -> Real {
    let gravity = cloth_core::measure::gravitational_energy(&model.particles, x, GRAVITY);
    model.energies().unwrap().value(x) + gravity
}

/// With two iterations a step. `G(x[1]) ≤ G(x[0])`, which every start at x[0] gives and the quasi-Newton method sees to
/// after others, says in terms of energies: the potential energy after the step and the kinetic energy of the change of
/// velocity are together at most the whole energy before it.
fn recovers(what: &str, model: &ClothModel, rest: &[Vec3], start: &State, config: PdConfig) {
    let moving = |v: &[Vec3]| kinetic_energy(&model.particles, v);
    for mut solver in [solver(model, config), coarse_solver(model, rest, config)] {
        let mut state = start.clone();
        let first = potential_energy(model, &state.positions);
        for step in 1..=60 {
            let before = state.clone();
            let energy = potential_energy(model, &state.positions) + moving(&state.velocities);
            solver.step(&mut state, falling()).unwrap();
            let changes = state.velocities.iter().zip(&before.velocities);
            let changes: Vec<Vec3> = changes.map(|(after, before)| after - before).collect();
            let after = potential_energy(model, &state.positions) + moving(&changes);
            let most = energy + 1e-9 * energy.abs().max(1.0);
            assert!(
                after <= most,
                "{what}, {config:?}, step {step}: {energy} to {after} J"
            );
        }
        let last = potential_energy(model, &state.positions) + moving(&state.velocities);
        assert!(
            last < first.max(0.01),
            "{what}, {config:?}: {first} to {last} J"
        );
    }
}

#[test]
fn energy_does_not_appear_from_any_start() {
    let (model, flat) = hanging(9, 1e4);
    let rest = &flat.positions;
    let held = |start: &mut Vec<Vec3>| {
        for vertex in [72, 80] {
            start[vertex] = rest[vertex];
        }
    };
    let watched =
        |config: &PdConfig| matches!(config.acceleration, Acceleration::QuasiNewton { .. });
    let previous = accelerated(iterations(2)).map(|config| PdConfig {
        start: StartGuess::Previous,
        ..config
    });
    let inertial = previous.into_iter().filter(watched).map(|config| PdConfig {
        start: StartGuess::Inertial,
        ..config
    });
    for config in previous.into_iter().chain(inertial) {
        for (what, deform) in STARTS {
            let mut start: Vec<Vec3> = rest.iter().map(deform).collect();
            held(&mut start);
            recovers(what, &model, rest, &State::at_rest(start), config);
        }
        let mut start = noise(81);
        held(&mut start);
        recovers("random", &model, rest, &State::at_rest(start), config);
    }
}

/// Steps, with damping, until the cloth hangs and its forces, as a part of the weight, balance. Where it is without a
/// fold it is stretched by 0.42 %; a fold that has come to rest, of a cloth that may pass through itself, doubles a
/// part of it.
fn hangs_in_the_end(config: PdConfig, steps: u32, largest_force: Real) {
    let (model, flat) = hanging(9, 1e3);
    let rest = &flat.positions;
    let mut shapes: Vec<(&str, Vec<Vec3>)> = STARTS
        .iter()
        .map(|(what, deform)| (*what, rest.iter().map(deform).collect()))
        .collect();
    shapes.push(("random", noise(81)));
    for (what, mut start) in shapes {
        for vertex in [72, 80] {
            start[vertex] = rest[vertex];
        }
        let mut solver = coarse_solver(&model, rest, config);
        let mut state = State::at_rest(start);
        for _ in 0..steps {
            solver.step(&mut state, falling()).unwrap();
            state.velocities.iter_mut().for_each(|v| *v *= 0.97);
        }
        let strain = cloth_core::measure::Strain::of(&model.springs, &state.positions);
        let lowest = state.positions.iter().map(|x| x.z).fold(0.0, Real::min);
        let moving = kinetic_energy(&model.particles, &state.velocities);
        state.velocities.fill(Vec3::zeros());
        let (_, force) = potential(&model, &state, &falling(), &state.positions);
        assert!(
            strain.max < 0.0055 && lowest < -0.99 && force < largest_force,
            "{what}: {strain:?}, {lowest} m, {moving:e} J, {force:e} of the weight"
        );
    }
}

#[test]
fn the_default_hangs_in_the_end_from_any_start() {
    hangs_in_the_end(PdConfig::default(), 1200, 1e-7);
}

#[test]
fn thirty_plain_iterations_hang_in_the_end_from_any_start() {
    hangs_in_the_end(iterations(30), 600, 0.02);
}

#[test]
fn springs_may_differ_in_stiffness_by_eight_powers_of_ten() {
    let (mut model, mut state) = hanging(9, 1.0);
    for spring in model.springs.iter_mut().step_by(2) {
        spring.stiffness = 1e8;
    }
    let rest = state.positions.clone();
    for config in accelerated(PdConfig {
        start: StartGuess::Previous,
        ..iterations(10)
    }) {
        let before = state.clone();
        for mut solver in [solver(&model, config), coarse_solver(&model, &rest, config)] {
            let mut after = before.clone();
            solver.step(&mut after, falling()).unwrap();
            let (start, _) = potential(&model, &before, &falling(), &before.positions);
            let (end, _) = potential(&model, &before, &falling(), &after.positions);
            assert!(end <= start, "{config:?}: {start} to {end} J");
        }
    }
    let mut solver = coarse_solver(&model, &rest, PdConfig::default());
    for _ in 0..60 {
        solver.step(&mut state, falling()).unwrap();
    }
    assert_eq!(state.first_non_finite(), None);
}

#[test]
fn a_free_cloth_whose_mass_is_rounded_away_is_refused() {
    let error = StepError::NotPositiveDefinite {
        iteration: 1,
        step: 1,
    };
    for config in accelerated(iterations(10)) {
        for dt in [1e8, 1e9, 1e12] {
            let input = || StepInput::new(dt).gravity(GRAVITY);
            let (free, mut state) = sheet(9, 1e4);
            assert_eq!(
                solver(&free, config).step(&mut state, input()),
                Err(error.clone())
            );
            let (held, mut state) = hanging(9, 1e4);
            let config = PdConfig {
                start: StartGuess::Inertial,
                ..config
            };
            solver(&held, config).step(&mut state, input()).unwrap();
            let farthest = state
                .positions
                .iter()
                .map(|x| x.norm())
                .fold(0.0, Real::max);
            assert!(farthest < 2.0, "{config:?}, {dt:e} s: {farthest:e} m");
        }
    }
}

/// Stretched by a twentieth, without gravity: what is at rest ends each step, though there is nothing else to compare
/// rounding with.
#[test]
fn a_taut_sheet_at_rest_without_gravity_takes_few_iterations() {
    for k in [1e2, 1e4, 1e6] {
        let (mut model, mut state) = sheet(11, k);
        for vertex in 0..121 {
            let column = vertex % 11;
            if column == 0 || column == 10 {
                model.particles.prescribe(vertex).unwrap();
            }
            if column == 10 {
                state.positions[vertex].x += 0.05;
            }
        }
        let mut solver = solver(&model, PdConfig::default());
        for step in 0..300 {
            let report = solver.step(&mut state, StepInput::new(1.0 / 60.0)).unwrap();
            assert_eq!(report.unfinished, 0, "k {k}, step {step}");
            if step >= 200 {
                assert!(
                    report.iterations <= 20,
                    "k {k}, step {step}: {}",
                    report.iterations
                );
            }
        }
    }
}
