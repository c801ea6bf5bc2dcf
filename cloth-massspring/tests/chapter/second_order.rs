//! Implicit midpoint and BDF2: closed forms, energy, and when BDF2 starts again.

use crate::{DOWN, chain, hang, largest_difference, oscillator, sharp, solver};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{gravitational_energy, kinetic_energy};
use cloth_core::method::family::Energies;
use cloth_core::particles::{Particles, State};
use cloth_core::pin::Pins;
use cloth_core::step::{StepInput, Stepper};
use cloth_massspring::{Bdf2, ImplicitConfig, ImplicitEuler, ImplicitMidpoint};

const OMEGA: Real = 7.0;

/// Position and velocity/ω.
fn phase(state: &State) -> [Real; 2] {
    [state.positions[0].x, state.velocities[0].x / OMEGA]
}

fn start() -> State {
    let mut state = State::at_rest(vec![Vec3::new(0.3, 0.0, 0.0)]);
    state.velocities[0].x = 1.1;
    state
}

#[test]
fn midpoint_keeps_energy_and_turns_by_twice_the_arc_tangent() {
    for z in [0.01, 0.3, 1.0, 30.0] {
        let (particles, springs) = oscillator(OMEGA);
        let mut solver = solver!(ImplicitMidpoint, &particles, springs, sharp());
        let mut state = start();
        let first = phase(&state);
        for _ in 0..1000 {
            let [x0, v0] = phase(&state);
            solver.step(&mut state, StepInput::new(z / OMEGA)).unwrap();
            let [x1, v1] = phase(&state);
            let angle = (x1 * v0 - x0 * v1).atan2(x0 * x1 + v0 * v1);
            let expected = 2.0 * (z / 2.0).atan();
            assert!((angle - expected).abs() < 1e-12, "z {z}: {angle}");
        }
        let [x, v] = phase(&state);
        let drift = x.hypot(v) / first[0].hypot(first[1]) - 1.0;
        assert!(drift.abs() < 1e-12, "z {z}: {drift:e} in 1000 steps");
    }
}

#[test]
fn bdf2_follows_its_recurrence() {
    // (3 + 2iz) u[1] = 4 u[0] − u[−1] for u = x + i v/ω, after one step of implicit Euler, (1 + iz) u[1] = u[0].
    for z in [0.01, 0.3, 1.0, 30.0] {
        let (particles, springs) = oscillator(OMEGA);
        let mut solver = solver!(Bdf2, &particles, springs, sharp());
        let mut state = start();
        let over = |[x, v]: [Real; 2], re: Real, im: Real| {
            let square = re * re + im * im;
            [(x * re + v * im) / square, (v * re - x * im) / square]
        };
        let mut before = phase(&state);
        let mut now = over(before, 1.0, z);
        for step in 0..40 {
            solver.step(&mut state, StepInput::new(z / OMEGA)).unwrap();
            let [x, v] = phase(&state);
            let error = (x - now[0]).hypot(v - now[1]) / now[0].hypot(now[1]);
            assert!(error < 1e-11, "z {z}, step {step}: {error:e}");
            let next = [0, 1].map(|i| 4.0 * now[i] - before[i]);
            (before, now) = (now, over(next, 3.0, 2.0 * z));
        }
    }
}

#[test]
fn bdf2_shrinks_an_oscillation_by_a_quarter_of_the_fourth_power() {
    let z: Real = 0.05;
    let (particles, springs) = oscillator(OMEGA);
    let mut solver = solver!(Bdf2, &particles, springs, sharp());
    let mut state = start();
    let mut size = 0.0;
    for _ in 0..40 {
        let [x, v] = phase(&state);
        size = x.hypot(v);
        solver.step(&mut state, StepInput::new(z / OMEGA)).unwrap();
    }
    let [x, v] = phase(&state);
    let loss = 1.0 - x.hypot(v) / size;
    assert!((loss / (z.powi(4) / 4.0) - 1.0).abs() < 0.02, "{loss:e}");
}

/// A chain after three steps of BDF2, the third after `change`, of size `dt`; the same by implicit Euler; and how many
/// of the first and the third one started again.
fn third_step(change: impl Fn(&mut State), dt: Real) -> ([State; 2], [u32; 2]) {
    let (particles, springs, positions) = chain(4, 1e3);
    let mut solver = solver!(Bdf2, &particles, springs.clone(), sharp());
    let mut state = State::at_rest(positions);
    state.velocities[4] = Vec3::x();
    let input = |dt| StepInput::new(dt).gravity(DOWN);
    let first = solver.step(&mut state, input(0.01)).unwrap();
    solver.step(&mut state, input(0.01)).unwrap();
    change(&mut state);
    let mut euler = state.clone();
    let third = solver.step(&mut state, input(dt)).unwrap();
    let mut other = solver!(ImplicitEuler, &particles, springs, sharp());
    other.step(&mut euler, input(dt)).unwrap();
    ([state, euler], [first, third].map(|report| report.restarts))
}

#[test]
fn bdf2_starts_again_with_implicit_euler_where_the_past_does_not_fit() {
    let ([bdf2, euler], restarts) = third_step(|state| state.positions[2].x += 1e-9, 0.01);
    assert!(bdf2 == euler, "a moved vertex");
    assert_eq!(restarts, [1, 1]);
    let ([bdf2, euler], restarts) = third_step(|state| state.velocities[3].y = 2.0, 0.01);
    assert!(bdf2 == euler, "a kicked vertex");
    assert_eq!(restarts, [1, 1]);
    let ([bdf2, euler], restarts) = third_step(|_| (), 0.02);
    assert!(bdf2 == euler, "another step size");
    assert_eq!(restarts, [1, 1]);
    let ([bdf2, euler], restarts) = third_step(|_| (), 0.01);
    assert!(largest_difference(&bdf2.positions, &euler.positions) > 1e-6);
    assert_eq!(restarts, [1, 0]);
    let ([steered, euler], restarts) = third_step(|state| state.velocities[0].y = 2.0, 0.01);
    assert!(
        largest_difference(&steered.positions[1..], &euler.positions[1..]) > 1e-6,
        "steering a pin is no restart"
    );
    assert_eq!(restarts, [1, 0]);
}

#[test]
fn a_refused_step_does_not_cost_bdf2_its_memory() {
    let run = |refused: bool| {
        let (particles, springs, positions) = chain(4, 1e3);
        let mut solver = solver!(Bdf2, &particles, springs, sharp());
        let mut state = State::at_rest(positions);
        state.velocities[4] = Vec3::x();
        for _ in 0..5 {
            solver.step(&mut state, StepInput::new(0.01)).unwrap();
            if refused {
                solver.step(&mut state, StepInput::new(-1.0)).unwrap_err();
            }
        }
        state
    };
    assert!(run(true) == run(false));
}

#[test]
fn driven_pins_do_not_spoil_the_second_order() {
    // The free end of a spring whose other end is shaken, against the exact solution by a fine run.
    let run = |steps: u32| {
        let (mut particles, springs, positions) = chain(2, 50.0);
        let mut pins = Pins::new();
        let path = |t: Real| Vec3::new(0.2 * (5.0 * t).sin(), 0.0, 0.1 * t * t);
        pins.add_path(&mut particles, 0, path).unwrap();
        let mut ends = Vec::new();
        for mut solver in [
            Box::new(solver!(
                ImplicitMidpoint,
                &particles,
                springs.clone(),
                sharp()
            )) as Box<dyn Stepper>,
            Box::new(solver!(Bdf2, &particles, springs, sharp())),
        ] {
            let mut state = State::at_rest(positions.clone());
            state.velocities[0] = Vec3::x();
            let dt = 0.8 / Real::from(steps);
            for _ in 0..steps {
                pins.set_velocities(&mut state, dt).unwrap();
                solver
                    .step(&mut state, StepInput::new(dt).gravity(DOWN))
                    .unwrap();
            }
            ends.push(state.positions);
        }
        ends
    };
    let [coarse, fine, reference] = [run(160), run(320), run(2560)];
    for method in 0..2 {
        let error = |ends: &[Vec<Vec3>]| largest_difference(&ends[method], &reference[0]);
        let order = (error(&coarse) / error(&fine)).log2();
        assert!((1.8..2.2).contains(&order), "method {method}: {order}");
    }
}

#[test]
fn a_swing_loses_least_with_midpoint_and_most_with_implicit_euler() {
    let kinetic = |solver: &mut dyn Stepper| {
        let (mesh, model) = hang(8);
        let mut state = State::at_rest(mesh.positions().to_vec());
        for _ in 0..100 {
            let input = StepInput::new(1.0 / 200.0).gravity(DOWN);
            solver.step(&mut state, input).unwrap();
        }
        kinetic_energy(&model.particles, &state.velocities)
    };
    let (_, model) = hang(8);
    let config = ImplicitConfig::default();
    let (p, springs) = (&model.particles, &model.springs);
    let midpoint = kinetic(&mut solver!(ImplicitMidpoint, p, springs.clone(), config));
    let bdf2 = kinetic(&mut solver!(Bdf2, p, springs.clone(), config));
    let euler = kinetic(&mut solver!(ImplicitEuler, p, springs.clone(), config));
    assert!(
        midpoint > bdf2 && bdf2 > euler,
        "{midpoint} {bdf2} {euler} J"
    );
}

/// Two seconds of the hanging sheet. What a step leaves undone is in the way of the next.
#[test]
fn a_hundredth_keeps_the_swing_in_half_of_the_iterations() {
    let (mesh, model) = hang(32);
    let swing = |config: ImplicitConfig| {
        let builder = ImplicitEuler::builder(&model.particles).elements(model.clone().families());
        let mut solver = builder.config(config).build().unwrap();
        let mut state = State::at_rest(mesh.positions().to_vec());
        let (mut kinetic, mut iterations) = (0.0, 0);
        for _ in 0..120 {
            let input = StepInput::new(1.0 / 60.0).gravity(DOWN);
            let report = solver.step(&mut state, input).unwrap();
            iterations += report.iterations;
            kinetic += kinetic_energy(&model.particles, &state.velocities);
        }
        (kinetic, Real::from(iterations))
    };
    let to = |tolerance| {
        let config = ImplicitConfig::default();
        swing(ImplicitConfig {
            tolerance,
            ..config
        })
    };
    let [(right, most), (near, half), (off, _)] = [1e-3, 1e-2, 1e-1].map(to);
    eprintln!("{right} {most} {near} {half} {off}");
    assert!((near / right - 1.0).abs() < 0.005, "{near} {right} J");
    assert!(half < 0.55 * most, "{half} of {most} iterations");
    assert!(off < 0.98 * right, "{off} {right} J");
    let (five, _) = swing(ImplicitConfig {
        max_iterations: 5,
        ..ImplicitConfig::default()
    });
    assert!((five / right - 1.0).abs() > 0.015, "{five} {right} J");
}

#[test]
fn a_linearised_step_costs_one_solve_and_is_exact_for_linear_forces() {
    let (particles, springs) = oscillator(OMEGA);
    let mut full = solver!(ImplicitEuler, &particles, springs.clone(), sharp());
    let linearized = ImplicitConfig::linearized();
    let mut once = solver!(ImplicitEuler, &particles, springs, linearized);
    assert_eq!(once.name(), "linear-implicit");
    let [mut a, mut b] = [start(), start()];
    for _ in 0..10 {
        full.step(&mut a, StepInput::new(0.1)).unwrap();
        let report = once.step(&mut b, StepInput::new(0.1)).unwrap();
        let costs = (
            report.iterations,
            report.factorizations,
            report.linear_solves,
        );
        assert_eq!(costs, (1, 1, 1));
        assert_eq!(report.residual, None);
    }
    assert!(largest_difference(&a.positions, &b.positions) < 1e-14);
}

/// Kinetic, elastic and gravitational energy (J) of the scene `hang` over 300 steps of 1/60 s: at the start, and the
/// largest later on.
fn energies(make: impl Fn(&Particles, Vec<Spring>) -> Box<dyn Stepper>) -> [Real; 2] {
    let (mesh, model) = hang(8);
    let energies = Energies::new(model.particles.len())
        .with(model.springs.clone())
        .unwrap();
    let mut solver = make(&model.particles, model.springs);
    let mut state = State::at_rest(mesh.positions().to_vec());
    let total = |state: &State| {
        kinetic_energy(&model.particles, &state.velocities)
            + energies.value(&state.positions)
            + gravitational_energy(&model.particles, &state.positions, DOWN)
    };
    let first = total(&state);
    let mut largest = Real::MIN;
    for _ in 0..300 {
        let input = StepInput::new(1.0 / 60.0).gravity(DOWN);
        solver.step(&mut state, input).unwrap();
        largest = largest.max(total(&state));
    }
    [first, largest]
}

#[test]
fn midpoint_blows_up_on_stiff_cloth_where_the_others_gain_nothing() {
    let config = ImplicitConfig::default();
    let midpoint = energies(|p, s| Box::new(solver!(ImplicitMidpoint, p, s, config)));
    let bdf2 = energies(|p, s| Box::new(solver!(Bdf2, p, s, config)));
    let euler = energies(|p, s| Box::new(solver!(ImplicitEuler, p, s, config)));
    let linear = energies(|p, s| {
        let config = ImplicitConfig::linearized();
        Box::new(solver!(ImplicitEuler, p, s, config))
    });
    assert!(midpoint[1] > midpoint[0] + 1e3, "midpoint: {midpoint:?} J");
    for [first, largest] in [bdf2, euler, linear] {
        assert!(largest <= first, "from {first} to {largest} J");
    }
}

/// A push of half a newton on 1 kg for a tenth of a second, from the start or later, with gravity on.
#[test]
fn a_push_gives_bdf2_its_momentum_to_rounding_whenever_it_begins() {
    for first in [0, 1, 2, 12] {
        let particles = Particles::new(vec![1.0]).unwrap();
        let mut solver = solver!(Bdf2, &particles, Vec::<Spring>::new(), sharp());
        let mut state = State::at_rest(vec![Vec3::zeros()]);
        let push = [Vec3::x() * 0.5];
        for step in 0..30 {
            let mut input = StepInput::new(1.0 / 60.0).gravity(DOWN);
            if (first..first + 6).contains(&step) {
                input = input.load(&push);
            }
            solver.step(&mut state, input).unwrap();
        }
        let expected = DOWN * 0.5 + Vec3::x() * 0.05;
        let error = (state.velocities[0] - expected).norm();
        assert!(error < 1e-13, "from step {first}: {error:e} m/s");
    }
}
