//! λ is a force.

use crate::chain::Chain;
use crate::chapter::{GRAVITY, iterations, solver};
use cloth_core::energy::{Attachment, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

const G: Real = 9.81;

#[test]
fn the_support_of_a_hanging_chain_bears_its_weight() {
    for stiffness in [80.0, 3e3, Real::INFINITY] {
        let (links, mass) = (8_u32, 0.05);
        let chain = Chain::of(links, mass, 0.1, stiffness);
        let config = XpbdConfig {
            substeps: 3,
            damping: 0.01,
            ..iterations(900)
        };
        let mut solver = solver(&chain, config);
        chain.sag_at_rest(&mut solver, 0.1, 400);
        let mut forces = vec![Vec3::zeros(); links as usize + 1];
        solver.vertex_forces_into(&mut forces);
        let weight = Real::from(links) * mass * G;
        let error = (forces[0] - Vec3::new(0.0, 0.0, -weight)).norm() / weight;
        assert!(error < 1e-10, "k {stiffness}: {error:e}");
        // Every free vertex is held against its own weight.
        for force in &forces[1..] {
            let error = (force - Vec3::new(0.0, 0.0, mass * G)).norm() / (mass * G);
            assert!(error < 1e-9, "k {stiffness}: {error:e}");
        }
        let mut seen = 0;
        solver.each_force(0, |force| {
            let below = Real::from(links) - force.index as Real;
            let tension = below * mass * G;
            assert!((force.magnitude / -tension - 1.0).abs() < 1e-10);
            assert_eq!(force.vertices, [force.index as u32, force.index as u32 + 1]);
            assert!((force.on(0).norm() - tension).abs() < 1e-9);
            assert_eq!(force.on(0), -force.on(1));
            seen += 1;
        });
        assert_eq!(seen, links);
    }
}

/// A rope between two pins, held up in the middle by a soft attachment too, at rest under substeps of `h` (s):
/// the largest missing force (N) at a free vertex, and at the supports together.
fn missing(h: Real) -> [Real; 2] {
    let (links, mass, k) = (8_u32, 0.05, 400.0);
    let mut particles = Particles::new(vec![mass; links as usize + 1]).unwrap();
    particles.prescribe(0).unwrap();
    particles.prescribe(links as usize).unwrap();
    let springs = |i| Spring {
        vertices: [i, i + 1],
        rest_length: 0.14,
        stiffness: k,
    };
    let held = Attachment {
        vertex: 4,
        target: Vec3::new(0.5, 0.0, 0.0),
        stiffness: 2.0,
    };
    let builder = XpbdSolver::builder(&particles)
        .energy((0..links).map(springs).collect::<Vec<_>>())
        .energy(vec![held]);
    let config = XpbdConfig {
        damping: 0.05,
        ..iterations(100)
    };
    let mut solver = builder.config(config).build().unwrap();
    let start = |i: u32| {
        Vec3::new(
            Real::from(i) / 8.0,
            0.0,
            -0.01 * Real::from(i * (links - i)),
        )
    };
    let mut state = State::at_rest((0..=links).map(start).collect());
    // First with large steps, which damp, then with those asked for.
    for (dt, steps) in [(0.1, 400), (0.02, 2000), (h, 20_000)] {
        for _ in 0..steps {
            let input = StepInput::new(dt).gravity(GRAVITY);
            solver.step(&mut state, input).unwrap();
        }
    }
    let speed = state.velocities.iter().map(Vec3::norm);
    let speed = speed.fold(0.0, Real::max);
    assert!(speed < 1e-9, "{speed:e} m/s");
    let mut forces = vec![Vec3::zeros(); links as usize + 1];
    solver.vertex_forces_into(&mut forces);
    let lift = Vec3::new(0.0, 0.0, mass * G);
    let free = forces[1..links as usize].iter();
    let largest = free.map(|force| (force - lift).norm());
    // The attachment pulls at one vertex with k (p − x).
    let pull = (held.target - state.positions[4]) * held.stiffness;
    let mut attached = Vec3::zeros();
    solver.each_force(1, |force| attached += force.on(0));
    assert!((attached - pull).norm() < 1e-11);
    let supports = forces[0] + forces[links as usize];
    [
        largest.fold(0.0, Real::max),
        (supports + lift * 7.0 - pull).norm(),
    ]
}

/// λ belongs to the gradients of the places where the corrections were made, the force is read with those of
/// the end. Where the links turn within a substep, also at rest, from x̃ to x, that is another force, by an
/// amount of order h².
#[test]
fn two_supports_and_an_attachment_share_the_weight() {
    let [coarse, fine] = [missing(0.01), missing(0.005)];
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        let order = (coarse / fine).log2();
        assert!(
            fine < 3e-3 && (order - 2.0).abs() < 0.1,
            "{coarse:e} {fine:e}"
        );
    }
}

#[test]
fn there_is_no_force_before_the_first_step_and_after_one_that_failed() {
    let chain = Chain::new(2, 10.0);
    let mut solver = solver(&chain, iterations(3));
    let mut forces = vec![Vec3::x(); 3];
    solver.vertex_forces_into(&mut forces);
    assert_eq!(forces, [Vec3::zeros(); 3]);
    let mut state = chain.at_rest();
    let step = |solver: &mut XpbdSolver, state: &mut State| {
        solver.step(state, StepInput::new(0.1).gravity(GRAVITY))
    };
    step(&mut solver, &mut state).unwrap();
    let mut multipliers = Vec::new();
    solver.multipliers_into(0, &mut multipliers);
    assert!(multipliers[0] != 0.0);
    state.velocities[1].x = 1e308;
    assert!(step(&mut solver, &mut state).is_err());
    solver.multipliers_into(0, &mut multipliers);
    assert_eq!(multipliers, [0.0; 2]);
    solver.vertex_forces_into(&mut forces);
    assert_eq!(forces, [Vec3::zeros(); 3]);
}

/// A step that is refused at once leaves what is known of the last one.
#[test]
fn forces_outlast_a_step_that_is_refused() {
    let chain = Chain::of(4, 0.05, 0.1, 80.0);
    let mut solver = solver(&chain, iterations(3));
    let mut state = chain.at_rest();
    let told = |solver: &XpbdSolver, state: &State| {
        let mut forces = vec![Vec3::zeros(); 5];
        solver.vertex_forces_into(&mut forces);
        (forces, solver.compliance_residual(&state.positions))
    };
    let input = |dt| StepInput::new(dt).gravity(GRAVITY);
    solver.step(&mut state, input(0.01)).unwrap();
    let before = told(&solver, &state);
    assert!(before.0[0].norm() > 0.0 && before.1 > 0.0);
    solver.step(&mut state, input(Real::NAN)).unwrap_err();
    assert_eq!(told(&solver, &state), before);
}
