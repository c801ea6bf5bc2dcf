//! Damped oscillators against the closed forms of each integrator, and what damping must not do.

use crate::{DOWN, chain, hang, oscillator, sharp, solver};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{gravitational_energy, kinetic_energy, linear_momentum};
use cloth_core::method::family::Energies;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, StepError, StepInput, Stepper};
use cloth_massspring::{
    Bdf2, Damping, ExplicitConfig, ExplicitEuler, ImplicitConfig, ImplicitEuler, ImplicitMidpoint,
    StabilityCheck, SymplecticEuler,
};

const OMEGA: Real = 7.0;
const DAMPING: Damping = Damping {
    air_drag: 0.9,
    stiffness: 0.013,
};
/// 2γ = α + β ω² (1/s).
const TWICE_GAMMA: Real = 0.9 + 0.013 * OMEGA * OMEGA;

fn damped(config: ImplicitConfig) -> ImplicitConfig {
    ImplicitConfig {
        damping: DAMPING,
        ..config
    }
}

fn explicit(damping: Damping) -> ExplicitConfig {
    ExplicitConfig {
        damping,
        stability: StabilityCheck::Off,
        ..ExplicitConfig::default()
    }
}

/// Positions and velocities after each of `steps` steps of `dt` from (0.3, 1.1).
fn orbit(mut solver: impl Stepper, dt: Real, steps: usize) -> Vec<[Real; 2]> {
    let mut state = State::at_rest(vec![Vec3::new(0.3, 0.0, 0.0)]);
    state.velocities[0].x = 1.1;
    let mut orbit = vec![[0.3, 1.1]];
    for _ in 0..steps {
        solver.step(&mut state, StepInput::new(dt)).unwrap();
        orbit.push([state.positions[0].x, state.velocities[0].x]);
    }
    orbit
}

/// `v = v_b − τ(ω² x + 2γ v)`, `x = x_b + τ v`, solved.
fn stage([x, v]: [Real; 2], tau: Real) -> [Real; 2] {
    let speed = (v - tau * OMEGA * OMEGA * x) / (1.0 + tau * TWICE_GAMMA + (tau * OMEGA).powi(2));
    [x + tau * speed, speed]
}

fn agree(measured: &[[Real; 2]], expected: impl Fn(&[[Real; 2]], usize) -> [Real; 2], what: &str) {
    for n in 1..measured.len() {
        let [x, v] = expected(measured, n);
        let error = (measured[n][0] - x).abs() + (measured[n][1] - v).abs() / OMEGA;
        assert!(error < 1e-13, "{what}, step {n}: {error:e}");
    }
}

#[test]
fn every_integrator_damps_an_oscillator_as_its_closed_form_says() {
    let (particles, springs) = oscillator(OMEGA);
    let p = &particles;
    for dt in [0.01, 0.1, 2.0] {
        let implicit = damped(sharp());
        let euler = solver!(ImplicitEuler, p, springs.clone(), implicit);
        agree(
            &orbit(euler, dt, 20),
            |o, n| stage(o[n - 1], dt),
            "implicit Euler",
        );
        let once = damped(ImplicitConfig::linearized());
        let linear = solver!(ImplicitEuler, p, springs.clone(), once);
        agree(
            &orbit(linear, dt, 20),
            |o, n| stage(o[n - 1], dt),
            "linearised",
        );
        let midpoint = solver!(ImplicitMidpoint, p, springs.clone(), implicit);
        let mirrored = |o: &[[Real; 2]], n: usize| {
            let middle = stage(o[n - 1], 0.5 * dt);
            [0, 1].map(|i| 2.0 * middle[i] - o[n - 1][i])
        };
        agree(&orbit(midpoint, dt, 20), mirrored, "midpoint");
        let bdf2 = solver!(Bdf2, p, springs.clone(), implicit);
        let parabola = |o: &[[Real; 2]], n: usize| match n {
            1 => stage(o[0], dt),
            _ => stage(
                [0, 1].map(|i| (4.0 * o[n - 1][i] - o[n - 2][i]) / 3.0),
                2.0 / 3.0 * dt,
            ),
        };
        agree(&orbit(bdf2, dt, 20), parabola, "BDF2");
    }
    let dt = 0.01;
    let kick = |[x, v]: [Real; 2]| v - dt * (OMEGA * OMEGA * x + TWICE_GAMMA * v);
    let symplectic = solver!(SymplecticEuler, p, springs.clone(), explicit(DAMPING));
    let leap = |o: &[[Real; 2]], n: usize| {
        let v = kick(o[n - 1]);
        [o[n - 1][0] + dt * v, v]
    };
    agree(&orbit(symplectic, dt, 20), leap, "symplectic Euler");
    let forward = solver!(ExplicitEuler, p, springs, explicit(DAMPING));
    let drift = |o: &[[Real; 2]], n: usize| [o[n - 1][0] + dt * o[n - 1][1], kick(o[n - 1])];
    agree(&orbit(forward, dt, 20), drift, "forward Euler");
}

#[test]
fn an_oscillation_shrinks_by_the_root_of_the_determinant() {
    let (particles, springs) = oscillator(OMEGA);
    let dt = 0.05;
    let solver = solver!(ImplicitEuler, &particles, springs, damped(sharp()));
    let orbit = orbit(solver, dt, 30);
    // The area between two neighbouring points changes by the square of the factor.
    let area = |n: usize| orbit[n][0] * orbit[n + 1][1] - orbit[n][1] * orbit[n + 1][0];
    let expected = 1.0 / (1.0 + dt * TWICE_GAMMA + (dt * OMEGA).powi(2));
    for n in 0..20 {
        assert!((area(n + 1) / area(n) / expected - 1.0).abs() < 1e-11);
    }
}

#[test]
fn the_stable_step_of_a_damped_spring_is_the_closed_form() {
    let (particles, springs) = oscillator(OMEGA);
    let rate = TWICE_GAMMA;
    let limit = (-rate + (rate * rate + 4.0 * OMEGA * OMEGA).sqrt()) / (OMEGA * OMEGA);
    let config = ExplicitConfig {
        damping: DAMPING,
        ..ExplicitConfig::default()
    };
    let mut solver = solver!(SymplecticEuler, &particles, springs, config);
    let mut state = State::at_rest(vec![Vec3::x()]);
    let error = solver.step(&mut state, StepInput::new(1.01 * limit));
    let Err(StepError::Unstable { stable_dt, .. }) = error else {
        panic!("{error:?}");
    };
    assert!((stable_dt / limit - 1.0).abs() < 1e-3, "{stable_dt}");
    solver
        .step(&mut state, StepInput::new(0.99 * limit))
        .unwrap();
}

/// A free sheet that moves like a rigid body: it shifts and turns.
fn turning() -> (Particles, Vec<Spring>, State) {
    let (mesh, mut model) = hang(6);
    for vertex in 0..model.particles.len() {
        model.particles.release(vertex).unwrap();
    }
    let mut state = State::at_rest(mesh.positions().to_vec());
    for (x, v) in state.positions.iter().zip(&mut state.velocities) {
        *v = Vec3::new(0.3, -0.2, 0.1) + Vec3::new(0.0, 1.0, 2.0).cross(x) * 0.01;
    }
    (model.particles, model.springs, state)
}

#[test]
fn stiffness_damping_leaves_rigid_motion_alone() {
    let (particles, springs, start) = turning();
    let end = |stiffness| {
        let damping = Damping {
            stiffness,
            ..Damping::default()
        };
        let config = ImplicitConfig { damping, ..sharp() };
        let mut solver = solver!(ImplicitEuler, &particles, springs.clone(), config);
        let mut state = start.clone();
        for _ in 0..20 {
            solver.step(&mut state, StepInput::new(1e-3)).unwrap();
        }
        state
    };
    let [free, damped] = [end(0.0), end(0.1)];
    let energy = |state: &State| kinetic_energy(&particles, &state.velocities);
    assert!((energy(&damped) / energy(&free) - 1.0).abs() < 1e-6);
    let momentum = |state: &State| linear_momentum(&particles, &state.velocities);
    assert!((momentum(&damped) - momentum(&start)).norm() < 1e-12);
}

/// A sheet that falls from two corners and crumples holds no more than gravity has given it, however its strain is
/// damped; K of where uniform motion would end gives it energy ([`Damping`]).
#[test]
fn damped_cloth_that_crumples_gets_no_energy() {
    let (mesh, model) = hang(17);
    let p = &model.particles;
    let elastic = Energies::new(p.len()).with(model.springs.clone()).unwrap();
    for stiffness in [1e-3, 1e-2, 0.1] {
        let damping = Damping {
            stiffness,
            ..Damping::default()
        };
        let config = ImplicitConfig {
            damping,
            ..ImplicitConfig::default()
        };
        let solvers: [Box<dyn Stepper>; 2] = [
            Box::new(solver!(ImplicitEuler, p, model.springs.clone(), config)),
            Box::new(solver!(Bdf2, p, model.springs.clone(), config)),
        ];
        for mut solver in solvers {
            let mut state = State::at_rest(mesh.positions().to_vec());
            let held = |state: &State| {
                kinetic_energy(p, &state.velocities)
                    + gravitational_energy(p, &state.positions, DOWN)
                    + elastic.value(&state.positions)
            };
            let start = held(&state);
            let mut most: Real = 0.0;
            for _ in 0..60 {
                solver
                    .step(&mut state, StepInput::new(0.01).gravity(DOWN))
                    .unwrap();
                most = most.max(held(&state) - start);
            }
            let given = start - gravitational_energy(p, &state.positions, DOWN);
            let name = solver.name();
            println!("{name}, β = {stiffness} s: {most:.1e} of {given:.3} J");
            assert!(
                most < 1e-3 * given,
                "{name}, β = {stiffness} s: {most} of {given} J"
            );
        }
    }
}

#[test]
fn drag_alone_slows_a_fall_to_its_terminal_velocity() {
    let particles = Particles::new(vec![0.2, 5.0]).unwrap();
    let damping = Damping {
        air_drag: 2.0,
        stiffness: 0.0,
    };
    let config = ImplicitConfig { damping, ..sharp() };
    let none = Vec::<Spring>::new;
    let solvers: [Box<dyn Stepper>; 4] = [
        Box::new(solver!(ImplicitEuler, &particles, none(), config)),
        Box::new(solver!(ImplicitMidpoint, &particles, none(), config)),
        Box::new(solver!(Bdf2, &particles, none(), config)),
        Box::new(solver!(
            SymplecticEuler,
            &particles,
            none(),
            explicit(damping)
        )),
    ];
    for mut solver in solvers {
        let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x()]);
        for _ in 0..200 {
            solver
                .step(&mut state, StepInput::new(0.1).gravity(DOWN))
                .unwrap();
        }
        for v in &state.velocities {
            assert!((v - DOWN / 2.0).norm() < 1e-11, "{}: {v}", solver.name());
        }
    }
}

#[test]
fn damping_that_is_negative_or_not_finite_is_refused() {
    let (particles, _, _) = chain(5, 1e3);
    for bad in [-1.0, Real::NAN, Real::INFINITY] {
        let drag = Damping {
            air_drag: bad,
            stiffness: 0.0,
        };
        let stiff = Damping {
            air_drag: 0.0,
            stiffness: bad,
        };
        for damping in [drag, stiff] {
            let config = ImplicitConfig { damping, ..sharp() };
            let error = ImplicitEuler::builder(&particles).config(config).build();
            assert!(matches!(error, Err(BuildError::OutOfRange(_))));
            let builder = SymplecticEuler::builder(&particles).config(explicit(damping));
            let error = builder.build();
            assert!(matches!(error, Err(BuildError::OutOfRange(_))));
        }
    }
}

/// [`Damping`]: what K half-way costs a turn in a step of second order, and that K at the end costs it nothing.
#[test]
fn damping_of_second_order_brakes_turns_that_are_not_resolved() {
    let (particles, springs, rest) = turning();
    let middle = rest.positions.iter().sum::<Vec3>() / rest.positions.len() as Real;
    let loss = |omega: Real, stiffness, is_bdf2| {
        let damping = Damping {
            stiffness,
            ..Damping::default()
        };
        let config = ImplicitConfig {
            damping,
            tolerance: 1e-9,
            ..ImplicitConfig::default()
        };
        let mut solver: Box<dyn Stepper> = match is_bdf2 {
            true => Box::new(solver!(Bdf2, &particles, springs.clone(), config)),
            false => Box::new(solver!(
                ImplicitMidpoint,
                &particles,
                springs.clone(),
                config
            )),
        };
        let mut state = rest.clone();
        for (x, v) in state.positions.iter().zip(&mut state.velocities) {
            *v = Vec3::new(0.0, 0.0, omega).cross(&(x - middle));
        }
        let spin = |state: &State| -> Real {
            let of = |v: usize| {
                let arm = state.positions[v] - middle;
                particles.mass()[v] * arm.cross(&state.velocities[v]).z
            };
            (0..particles.len()).map(of).sum()
        };
        let before = spin(&state);
        for _ in 0..60 {
            solver.step(&mut state, StepInput::new(1.0 / 60.0)).unwrap();
        }
        1.0 - spin(&state) / before
    };
    for (is_bdf2, omega, expected) in [
        (true, 1.0, 0.0..=0.0004),
        (true, 3.0, 0.07..=0.08),
        (true, 6.0, 0.5..=0.6),
        (false, 1.0, 0.0..=1e-8),
        (false, 3.0, 0.0..=1e-6),
        (false, 6.0, 0.35..=0.4),
    ] {
        let found = loss(omega, 0.01, is_bdf2);
        assert!(
            expected.contains(&found),
            "BDF2 {is_bdf2}, {omega} rad/s: {found:e}"
        );
    }
    assert!((loss(1.0, 0.0, true) - 3.5e-4).abs() < 1e-5);
}
