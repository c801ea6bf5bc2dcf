//! Rows that say the same, contradict one another, or have nothing to act on.

use crate::direct::{GRAVITY, SYSTEMS, sheet, with};
use cloth_core::energy::{Attachment, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Outcome, StepInput, Stepper};
use cloth_xpbd::direct::{DirectConfig, DirectXpbd, System};

fn link(a: u32, b: u32, rest_length: Real) -> Spring {
    Spring {
        vertices: [a, b],
        rest_length,
        stiffness: Real::INFINITY,
    }
}

/// Four vertices in a plane, all six distances hard: one row too many, and consistent.
#[test]
fn a_rigid_plate_with_a_redundant_link_moves_as_one_without() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let square = square.map(|[x, y]| Vec3::new(x, y, 0.0));
    let pairs = [(0, 1), (1, 2), (2, 3), (3, 0), (0, 2), (1, 3)];
    let links = pairs.map(|(a, b)| link(a, b, (square[a as usize] - square[b as usize]).norm()));
    let mut particles = Particles::new(vec![0.1, 0.2, 0.3, 0.4]).unwrap();
    particles.prescribe(0).unwrap();
    for system in [System::SaddleLdlt, System::SchurCholesky] {
        let run = |links: &[Spring]| {
            let builder = DirectXpbd::builder(&particles).energy(links.to_vec());
            let mut solver = builder.config(with(system)).build().unwrap();
            let mut state = State::at_rest(square.to_vec());
            // It hangs in its own plane.
            for _ in 0..5 {
                let input = StepInput::new(0.01).gravity(Vec3::new(0.0, -9.81, 0.0));
                let report = solver.step(&mut state, input).unwrap();
                assert_eq!(report.outcome, Outcome::Converged, "{system:?}: {report:?}");
                assert!(solver.residuals().compliance < 1e-14, "{system:?}");
            }
            state.positions
        };
        let (all, without) = (run(&links), run(&links[..5]));
        let apart = crate::direct::largest_distance(&all, &without);
        assert!(apart < 1e-9, "{system:?}: {apart:e} m");
    }
}

/// Two hard links of different lengths between the same vertices: there is no solution. The step ends between
/// them, finite, and says that it has not converged.
#[test]
fn links_that_contradict_each_other_are_reported_and_stay_finite() {
    let particles = Particles::new(vec![0.3, 0.7]).unwrap();
    for system in SYSTEMS {
        let links = vec![link(0, 1, 1.0), link(0, 1, 1.2)];
        let builder = DirectXpbd::builder(&particles).energy(links);
        let mut solver = builder.config(with(system)).build().unwrap();
        let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::new(1.5, 0.0, 0.0)]);
        let before = state.clone();
        match solver.step(&mut state, StepInput::new(0.01)) {
            Ok(report) => {
                assert!(report.residual.unwrap() > 0.01, "{system:?}: {report:?}");
                assert_eq!(state.first_non_finite(), None);
            }
            Err(error) => assert!(state == before, "{system:?}: {error}"),
        }
    }
}

/// A sheet that cannot stretch, flat: its rows have self-stresses, and no multiplier bends it. The lengths are
/// met all the same.
#[test]
fn a_flat_sheet_without_stretch_falls_into_folds() {
    let (mesh, mut model) = sheet::held_sheet(6, 1e3);
    for spring in &mut model.springs {
        spring.stiffness = Real::INFINITY;
    }
    let builder = DirectXpbd::builder(&model.particles).energy(model.springs.clone());
    let config = DirectConfig {
        max_iterations: 60,
        ..DirectConfig::default()
    };
    let builder = builder.energy(model.hinges.clone()).config(config);
    let mut solver = builder.build().unwrap();
    let mut state = State::at_rest(mesh.positions().to_vec());
    for _ in 0..10 {
        let input = StepInput::new(1.0 / 60.0).gravity(GRAVITY);
        solver.step(&mut state, input).unwrap();
        assert_eq!(state.first_non_finite(), None);
        let stretch = |s: &Spring| {
            let [a, b] = s.vertices.map(|v| state.positions[v as usize]);
            ((a - b).norm() - s.rest_length).abs()
        };
        let largest = model.springs.iter().map(stretch).fold(0.0, Real::max);
        assert!(largest < 1e-6, "{largest:e} m");
    }
    assert!(solver.regularization() > 0.0);
    let lowest = state.positions.iter().map(|x| x.z).fold(0.0, Real::min);
    assert!(lowest < -0.02, "{lowest} m");
}

#[test]
fn rows_between_pins_without_stiffness_or_length_do_no_harm() {
    let mut particles = Particles::new(vec![1.0; 5]).unwrap();
    for pinned in [0, 1] {
        particles.prescribe(pinned).unwrap();
    }
    for system in SYSTEMS {
        for stiffness in [0.0, 5.0, Real::MAX, Real::INFINITY] {
            let spring = |(vertices, rest_length)| Spring {
                vertices,
                rest_length,
                stiffness,
            };
            let springs = [([0, 1], 9.0), ([1, 2], 0.0), ([2, 3], 0.5), ([3, 4], 0.0)].map(spring);
            let nowhere = Attachment {
                vertex: 4,
                target: Vec3::zeros(),
                stiffness: 0.0,
            };
            let builder = DirectXpbd::builder(&particles).energy(springs.to_vec());
            let builder = builder.energy(vec![nowhere]).config(with(system));
            let mut solver = builder.build().unwrap();
            let mut state = State::at_rest(vec![Vec3::zeros(); 5]);
            state.positions[0].x = 1.0;
            let before = state.clone();
            let report = solver.step(&mut state, StepInput::new(0.01));
            let factored = matches!(system, System::SaddleLdlt | System::SchurCholesky);
            match report {
                Ok(report) => assert_eq!(report.outcome, Outcome::Converged, "{system:?}"),
                Err(error) => {
                    // A hard link of no length and a chain that is one point: too much for a Krylov method.
                    assert!(!factored && state == before, "{system:?}: {error}");
                    continue;
                }
            }
            assert_eq!(state.positions[0], Vec3::new(1.0, 0.0, 0.0));
            assert_eq!(state.positions[1], Vec3::zeros());
            assert_eq!(state.first_non_finite(), None);
            let length = (state.positions[2] - state.positions[3]).norm();
            assert_eq!(length > 0.0, stiffness > 0.0, "{system:?} {stiffness}");
        }
    }
}

#[test]
fn no_constraint_and_no_free_vertex_are_steps_too() {
    let mut particles = Particles::new(vec![1.0; 2]).unwrap();
    for system in SYSTEMS {
        let mut solver = DirectXpbd::builder(&particles)
            .config(with(system))
            .build()
            .unwrap();
        let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x()]);
        let input = StepInput::new(0.1).gravity(GRAVITY);
        solver.step(&mut state, input).unwrap();
        assert!((state.positions[1] - Vec3::new(1.0, 0.0, -0.0981)).norm() < 1e-15);
    }
    particles.prescribe(0).unwrap();
    particles.prescribe(1).unwrap();
    for system in SYSTEMS {
        let mut solver = DirectXpbd::builder(&particles)
            .energy(vec![link(0, 1, 3.0)])
            .config(with(system))
            .build()
            .unwrap();
        let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x()]);
        state.velocities[1].y = 2.0;
        solver.step(&mut state, StepInput::new(0.1)).unwrap();
        assert_eq!(state.positions[1], Vec3::new(1.0, 0.2, 0.0));
    }
}

#[test]
fn a_start_that_overflows_is_refused_and_the_next_step_is_as_good_as_new() {
    let particles = Particles::new(vec![1.0; 2]).unwrap();
    let builder = DirectXpbd::builder(&particles).energy(vec![link(0, 1, 1.0)]);
    let mut solver = builder.config(with(System::SaddleLdlt)).build().unwrap();
    let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x()]);
    state.velocities[0].x = 1e308;
    let before = state.clone();
    assert!(solver.step(&mut state, StepInput::new(1e3)).is_err());
    assert!(state == before);
    state.velocities[0].x = 0.0;
    solver.step(&mut state, StepInput::new(0.01)).unwrap();
    assert!((state.positions[0] - state.positions[1]).norm() - 1.0 < 1e-15);
}
