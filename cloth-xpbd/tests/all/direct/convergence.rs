//! Where the iteration ends.

use crate::chain::Chain;
use crate::direct::{
    GRAVITY, SYSTEMS, counting_allocator, largest_distance, sheet, solver, swinging, with,
};
use cloth_core::energy::{CurvatureHinge, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{IncrementalPotential, angular_momentum, linear_momentum, predict};
use cloth_core::method::family::Energies;
use cloth_core::method::position_based::Sweep;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, Outcome, StepInput, Stepper};
use cloth_xpbd::direct::{DirectConfig, DirectStart, DirectXpbd, System};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

/// Takes a step and checks that `‖∇G‖` at its end, in the norm of M⁻¹, is `part` of that at the prediction, or
/// rounding: positions of the order of 1 m are known to ε, and the inertia of 1 kg is divided by h².
fn takes_the_minimum(
    particles: &Particles,
    energies: &Energies,
    solver: &mut dyn Stepper,
    state: &mut State,
    (h, part): (Real, Real),
) {
    let mut predicted = state.positions.clone();
    let input = || StepInput::new(h).gravity(GRAVITY);
    predict(particles, state, &input(), &mut predicted);
    let report = solver.step(state, input()).unwrap();
    assert_eq!(report.outcome, Outcome::Converged, "{report:?}");
    let potential = IncrementalPotential {
        particles,
        energies,
        predicted: &predicted,
        dt: h,
    };
    let mut gradient = predicted.clone();
    potential.gradient_into(&state.positions, &mut gradient);
    let reached = potential.gradient_norm(&gradient);
    potential.gradient_into(&predicted, &mut gradient);
    let bound = part * potential.gradient_norm(&gradient) + Real::EPSILON / (h * h);
    assert!(reached < bound, "{h}: {reached:e} of {bound:e} N/√kg");
}

#[test]
fn the_step_is_the_minimiser_of_implicit_euler_by_every_linear_solver() {
    for system in SYSTEMS {
        for h in [1.0 / 30.0, 1.0 / 480.0] {
            let (chain, mut state) = swinging(200.0);
            let energies = Energies::new(chain.particles.len());
            let energies = energies.with(chain.springs.clone()).unwrap();
            let tight = DirectConfig {
                tolerance: 1e-13,
                ..with(system)
            };
            let mut solver = solver(&chain, tight);
            let particles = &chain.particles;
            takes_the_minimum(particles, &energies, &mut solver, &mut state, (h, 1e-12));
            let residuals = solver.residuals();
            assert!(residuals.compliance < 1e-15, "{system:?}: {residuals:?}");
        }
        let (mesh, model) = sheet::held_sheet(6, 1e4);
        let energies = model.energies().unwrap();
        let mut state = State::at_rest(mesh.positions().to_vec());
        let builder = DirectXpbd::builder(&model.particles).energy(model.springs.clone());
        let builder = builder.energy(model.hinges.clone()).config(with(system));
        let mut solver = builder.build().unwrap();
        for _ in 0..4 {
            let (particles, h) = (&model.particles, 1.0 / 60.0);
            takes_the_minimum(particles, &energies, &mut solver, &mut state, (h, 1e-8));
        }
    }
}

#[test]
fn hard_links_are_met_to_round_off_and_what_is_left_is_momentum() {
    for system in SYSTEMS {
        let (chain, mut state) = swinging(Real::INFINITY);
        let mut solver = solver(&chain, with(system));
        for _ in 0..20 {
            let input = StepInput::new(1.0 / 60.0).gravity(GRAVITY);
            let report = solver.step(&mut state, input).unwrap();
            assert_eq!(report.outcome, Outcome::Converged, "{report:?}");
            for spring in &chain.springs {
                let [a, b] = spring.vertices.map(|v| state.positions[v as usize]);
                assert!(((a - b).norm() - 0.1).abs() < 2e-16);
            }
            let residuals = solver.residuals();
            assert!(residuals.momentum < 1e-5, "{system:?}: {residuals:?}");
        }
    }
}

fn many_sweeps(n: u32, damping: Real) -> XpbdConfig {
    XpbdConfig {
        iterations: n,
        substeps: 1,
        sweep: Sweep::Sequential,
        damping,
        ..XpbdConfig::default()
    }
}

/// Along a straight chain no link turns, and the rows of quadratic hinges are linear: Gauss–Seidel and the
/// direct solver then have one solution.
#[test]
fn sweeps_and_the_direct_solver_agree_where_they_converge() {
    let mut chain = Chain::of(12, 0.1, 0.1, 3e4);
    for (v, mass) in [(3, 0.4), (7, 0.02), (12, 1.0)] {
        chain.particles.set_mass(v, mass).unwrap();
    }
    chain.springs[4].stiffness = Real::INFINITY;
    chain.springs[9].stiffness = 50.0;
    for damping in [0.0, 0.03] {
        let mut start = chain.at_rest();
        start.positions[7].z += 0.02;
        start.velocities[3].z = -1.0;
        let input = || StepInput::new(0.01).gravity(GRAVITY);
        let mut swept = start.clone();
        let builder = XpbdSolver::builder(&chain.particles).energy(chain.springs.clone());
        let mut sweeps = builder
            .config(many_sweeps(40_000, damping))
            .build()
            .unwrap();
        sweeps.step(&mut swept, input()).unwrap();
        for system in SYSTEMS {
            let mut state = start.clone();
            let config = DirectConfig {
                damping,
                ..with(system)
            };
            let mut direct = solver(&chain, config);
            let report = direct.step(&mut state, input()).unwrap();
            assert!(report.iterations <= 3, "{report:?}");
            let apart = largest_distance(&state.positions, &swept.positions);
            assert!(apart < 1e-12, "{system:?}, β {damping}: {apart:e} m");
            let apart = largest_distance(&state.velocities, &swept.velocities);
            assert!(apart < 1e-10, "{system:?}, β {damping}: {apart:e} m/s");
            let (mut own, mut theirs) = (Vec::new(), Vec::new());
            direct.multipliers_into(0, &mut own);
            sweeps.multipliers_into(0, &mut theirs);
            for (own, theirs) in own.iter().zip(&theirs) {
                assert!((own - theirs).abs() < 1e-11, "{system:?}: {own} {theirs}");
            }
        }
    }
}

#[test]
fn sweeps_and_the_direct_solver_agree_on_the_bending_of_a_sheet() {
    let (mesh, model) = sheet::held_sheet(6, 1.0);
    let hinges: Vec<CurvatureHinge> = model
        .hinges
        .iter()
        .map(|hinge| CurvatureHinge {
            stiffness: 1e4 * hinge.stiffness,
            ..*hinge
        })
        .collect();
    let mut start = State::at_rest(mesh.positions().to_vec());
    for (v, x) in start.positions.iter_mut().enumerate() {
        x.z += 0.02 * ((v * v) as Real).sin();
    }
    let builder = XpbdSolver::builder(&model.particles).energy(hinges.clone());
    let mut sweeps = builder.config(many_sweeps(60_000, 0.0)).build().unwrap();
    let mut swept = start.clone();
    sweeps.step(&mut swept, StepInput::new(0.01)).unwrap();
    assert!(sweeps.compliance_residual(&swept.positions) < 1e-13);
    for system in SYSTEMS {
        let mut state = start.clone();
        let builder = DirectXpbd::builder(&model.particles).energy(hinges.clone());
        let mut direct = builder.config(with(system)).build().unwrap();
        direct.step(&mut state, StepInput::new(0.01)).unwrap();
        let apart = largest_distance(&state.positions, &swept.positions);
        assert!(apart < 1e-9, "{system:?}: {apart:e} m");
    }
}

/// Where links turn, converged sweeps end beside the implicit Euler step, by an amount that falls with h.
#[test]
fn where_links_turn_sweeps_near_the_direct_solver_with_smaller_steps() {
    let apart = |h: Real| {
        let (chain, start) = swinging(200.0);
        let input = || StepInput::new(h).gravity(GRAVITY);
        let (mut one, mut other) = (start.clone(), start);
        solver(&chain, with(System::SaddleLdlt))
            .step(&mut one, input())
            .unwrap();
        let builder = XpbdSolver::builder(&chain.particles).energy(chain.springs.clone());
        let mut sweeps = builder.config(many_sweeps(6000, 0.0)).build().unwrap();
        sweeps.step(&mut other, input()).unwrap();
        largest_distance(&one.positions, &other.positions)
    };
    let distances = [1.0 / 60.0, 1.0 / 240.0, 1.0 / 960.0].map(apart);
    println!("{distances:?}");
    for pair in distances.windows(2) {
        let order = (pair[0] / pair[1]).log(4.0);
        assert!(order > 3.0, "{order}: {distances:?}");
    }
}

/// A tip of 10⁵ times the mass of the others. Sweeps see one link at a time.
#[test]
fn a_light_chain_with_a_heavy_end_takes_few_iterations_where_sweeps_stall() {
    let mut chain = Chain::of(20, 0.01, 0.05, Real::INFINITY);
    chain.particles.set_mass(20, 1000.0).unwrap();
    let input = || StepInput::new(1.0 / 60.0).gravity(GRAVITY);
    let stretch = |state: &State| {
        let stretch = |s: &Spring| {
            let [a, b] = s.vertices.map(|v| state.positions[v as usize]);
            ((a - b).norm() - s.rest_length).abs()
        };
        chain.springs.iter().map(stretch).fold(0.0, Real::max)
    };
    let drop = 9.81 / 3600.0;
    let builder = XpbdSolver::builder(&chain.particles).energy(chain.springs.clone());
    let mut sweeps = builder.config(many_sweeps(5000, 0.0)).build().unwrap();
    let mut state = chain.at_rest();
    sweeps.step(&mut state, input()).unwrap();
    let sag = -state.positions[20].z - 1.0;
    assert!(sag > 0.9 * drop, "{sag} of {drop} m");
    for system in [System::SaddleLdlt, System::SchurCholesky] {
        let mut state = chain.at_rest();
        let mut direct = solver(&chain, with(system));
        let report = direct.step(&mut state, input()).unwrap();
        assert!(report.iterations <= 4, "{system:?}: {report:?}");
        assert!(stretch(&state) < 1e-15, "{:e}", stretch(&state));
        // The tension of the first link holds the chain.
        let mut forces = vec![Vec3::zeros(); 21];
        direct.vertex_forces_into(&mut forces);
        let weight = (1000.0 + 19.0 * 0.01) * 9.81;
        assert!((forces[0].norm() / weight - 1.0).abs() < 1e-10);
    }
    // Off the vertical, so that the links turn.
    let mut state = chain.at_rest();
    for (i, x) in state.positions.iter_mut().enumerate() {
        x.x = 0.3 * i as Real * 0.05;
        x.z *= (1.0_f64 - 0.09).sqrt();
    }
    let mut direct = solver(&chain, with(System::SaddleLdlt));
    let mut most = 0;
    for _ in 0..60 {
        let report = direct.step(&mut state, input()).unwrap();
        assert_eq!(report.outcome, Outcome::Converged, "{report:?}");
        most = most.max(report.iterations);
        assert!(stretch(&state) < 1e-15);
    }
    assert!(most <= 20, "{most}");
}

#[test]
fn free_flight_keeps_momentum() {
    let mut particles = Particles::new(vec![0.1, 0.2, 0.3, 0.4]).unwrap();
    particles.set_mass(2, 5.0).unwrap();
    let spring = |(a, b, stiffness)| Spring {
        vertices: [a, b],
        rest_length: 1.0,
        stiffness,
    };
    let springs = [
        (0, 1, Real::INFINITY),
        (1, 2, 40.0),
        (2, 3, Real::INFINITY),
        (3, 0, 1e5),
    ];
    for system in SYSTEMS {
        let builder = DirectXpbd::builder(&particles).energy(springs.map(spring).to_vec());
        let mut solver = builder.config(with(system)).build().unwrap();
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut state = State::at_rest(square.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec());
        for (x, v) in state.positions.iter().zip(&mut state.velocities) {
            *v = Vec3::new(0.3, 0.0, 1.0) + Vec3::new(0.5, 1.0, 4.0).cross(x);
        }
        let before = linear_momentum(&particles, &state.velocities);
        let turning = angular_momentum(&particles, &state);
        for _ in 0..10 {
            solver.step(&mut state, StepInput::new(1e-3)).unwrap();
        }
        let after = linear_momentum(&particles, &state.velocities);
        assert!((after - before).norm() < 1e-11, "{system:?}");
        // Of first order in h, as implicit Euler's.
        let lost = (angular_momentum(&particles, &state) - turning).norm() / turning.norm();
        assert!(lost < 1e-3, "{system:?}: {lost:e}");
    }
}

#[test]
fn the_answer_does_not_depend_on_where_the_iteration_starts() {
    let (chain, start) = swinging(1e4);
    let run = |from, warm_start| {
        let config = DirectConfig {
            start: from,
            warm_start,
            tolerance: 1e-13,
            ..DirectConfig::default()
        };
        let mut solver = solver(&chain, config);
        let mut state = start.clone();
        for _ in 0..5 {
            let input = StepInput::new(1.0 / 60.0).gravity(GRAVITY);
            solver.step(&mut state, input).unwrap();
        }
        state.positions
    };
    let one = run(DirectStart::Predicted, false);
    for (from, warm) in [
        (DirectStart::Previous, false),
        (DirectStart::Predicted, true),
    ] {
        let apart = largest_distance(&one, &run(from, warm));
        assert!(apart < 1e-11, "{from:?} {warm}: {apart:e} m");
    }
}

#[test]
fn nothing_is_allocated_after_the_first_step() {
    let (mesh, model) = sheet::held_sheet(8, 1e4);
    for system in SYSTEMS {
        let builder = DirectXpbd::builder(&model.particles).energy(model.springs.clone());
        let builder = builder.energy(model.hinges.clone());
        let config = DirectConfig {
            damping: 0.001,
            max_krylov: 50,
            max_iterations: 5,
            ..with(system)
        };
        let mut solver = builder.config(config).build().unwrap();
        let mut state = State::at_rest(mesh.positions().to_vec());
        let step = || sheet::fall(&mut solver, &mut state, 1);
        let allocations = counting_allocator::allocations_once_warm(step);
        assert_eq!(allocations, 0, "{system:?}");
    }
}

#[test]
fn settings_and_vertices_out_of_range_are_refused() {
    let chain = Chain::new(2, 1.0);
    let good = DirectConfig::default();
    for config in [
        DirectConfig {
            max_iterations: 0,
            ..good
        },
        DirectConfig {
            tolerance: Real::NAN,
            ..good
        },
        DirectConfig {
            damping: -1.0,
            ..good
        },
        DirectConfig {
            krylov_tolerance: Real::INFINITY,
            ..good
        },
    ] {
        let built = DirectXpbd::builder(&chain.particles).config(config).build();
        assert!(matches!(built, Err(BuildError::OutOfRange(_))));
    }
    let stray = Spring {
        vertices: [0, 3],
        ..chain.springs[0]
    };
    let built = DirectXpbd::builder(&chain.particles)
        .energy(vec![stray])
        .build();
    assert!(matches!(built, Err(BuildError::NoSuchVertex { .. })));
}
