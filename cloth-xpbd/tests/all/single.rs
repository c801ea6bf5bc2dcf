//! The sweeps in single precision: the same cloth, to their precision.

use crate::counting_allocator;
use crate::sheet;

use cloth_core::air::{Air, AirConfig};
use cloth_core::cloth::ClothModel;
use cloth_core::energy::{Attachment, SoftPin, Spring, StvkTriangle};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{angular_momentum, linear_momentum};
use cloth_core::particles::{Particles, State};
use cloth_core::pin::PinMotion;
use cloth_core::step::{BuildError, StepError, StepInput, Stepper};
use cloth_xpbd::single::{SingleConfig, SingleXpbd};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

fn pair(k: Real) -> (Particles, SingleXpbd) {
    let particles = Particles::new(vec![0.5, 2.0]).unwrap();
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: k,
    };
    let solver = SingleXpbd::builder(&particles).springs(&[spring]);
    (particles, solver.build().unwrap())
}

#[test]
fn one_spring_ends_where_implicit_euler_does() {
    for k in [0.0, 3.0, 700.0, 2e4, Real::INFINITY] {
        for (substeps, iterations) in [(1, 1), (1, 7), (5, 1)] {
            let (particles, solver) = pair(k);
            let spring = Spring {
                vertices: [0, 1],
                rest_length: 1.0,
                stiffness: k,
            };
            let builder = SingleXpbd::builder(&particles).springs(&[spring]);
            let config = SingleConfig {
                iterations,
                substeps,
            };
            drop(solver);
            let mut solver = builder.config(config).build().unwrap();
            // Far from the origin of the coordinates, which costs no digit.
            let far = Vec3::new(1024.0, -512.0, 2048.0);
            let ends = [far, far + Vec3::new(1.5, 0.0, 0.0)];
            let mut state = State::at_rest(ends.to_vec());
            solver.step(&mut state, StepInput::new(0.01)).unwrap();
            let h = 0.01 / Real::from(substeps);
            let (w, mut value, mut rate) = (2.5, 0.5, 0.0);
            for _ in 0..substeps {
                let z = if k.is_finite() {
                    1.0 / (1.0 + k * h * h * w)
                } else {
                    0.0
                };
                let next = (value + h * rate) * z;
                (rate, value) = ((next - value) / h, next);
            }
            let length = (state.positions[1] - state.positions[0]).norm();
            let error = length - 1.0 - value;
            // Half a unit in the last place at each end, which goes on as a velocity.
            let steps = Real::from(substeps);
            assert!(
                error.abs() < 1.2e-7 * steps * (steps + 1.0) / 2.0,
                "k {k}, {substeps} × {iterations}: {error:e}"
            );
        }
    }
}

#[test]
fn a_pair_without_length_is_pushed_apart() {
    let (_, mut solver) = pair(1e4);
    let mut state = State::at_rest(vec![Vec3::new(1.0, 2.0, 3.0); 2]);
    for _ in 0..200 {
        solver.step(&mut state, StepInput::new(0.01)).unwrap();
    }
    let length = (state.positions[1] - state.positions[0]).norm();
    assert!((length - 1.0).abs() < 1e-3, "{length}");
}

fn solvers(model: &ClothModel) -> (SingleXpbd, XpbdSolver) {
    let single = SingleXpbd::builder(&model.particles).springs(&model.springs);
    let double = XpbdSolver::builder(&model.particles).energy(model.springs.clone());
    (
        single.vector_rows(&model.hinges).build().unwrap(),
        double.energy(model.hinges.clone()).build().unwrap(),
    )
}

/// 33 × 33 vertices of 1 m² with 1e4 N/m, falling for 20 steps, against the same in double precision; then at rest.
#[test]
fn a_falling_sheet_differs_by_its_precision() {
    let (mesh, model) = sheet::held_sheet(33, 1e4);
    let (mut single, mut double) = solvers(&model);
    let mut states = [(); 2].map(|()| State::at_rest(mesh.positions().to_vec()));
    sheet::fall(&mut single, &mut states[0], 20);
    sheet::fall(&mut double, &mut states[1], 20);
    let [a, b] = &states;
    let pairs = a.positions.iter().zip(&b.positions);
    let apart = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, Real::max);
    let strain = |state: &State, spring: &Spring| {
        let [a, b] = spring.vertices.map(|v| state.positions[v as usize]);
        (a - b).norm() / spring.rest_length - 1.0
    };
    let rms = |of: &dyn Fn(&Spring) -> Real| {
        let sum: Real = model.springs.iter().map(|s| of(s).powi(2)).sum();
        (sum / model.springs.len() as Real).sqrt()
    };
    let rough = rms(&|s| strain(a, s) - strain(b, s));
    println!(
        "{apart:e} m, rms strain {rough:e} of {:e}",
        rms(&|s| strain(b, s))
    );
    assert!(apart < 1e-4 && apart > 0.0, "{apart:e} m");
    assert!(rough < 2e-5, "{rough:e}");
}

/// What the air does between two sweeps, the second sweep knows: 17 × 17 vertices of 0.2 kg/m² and 1 m² in a wind of
/// 8 m/s, eight sweeps a step.
#[test]
fn sweeps_know_what_the_air_has_moved() {
    let (mesh, model) = sheet::held_sheet(17, 1e3);
    let config = AirConfig {
        density: 1.2,
        drag: 1.3,
        lift: 0.7,
        wind: Vec3::new(0.0, 0.0, 8.0),
    };
    let single = SingleXpbd::builder(&model.particles).springs(&model.springs);
    let double = XpbdSolver::builder(&model.particles).energy(model.springs.clone());
    let (iterations, substeps) = (8, 1);
    let mut single = single
        .config(SingleConfig {
            iterations,
            substeps,
        })
        .build()
        .unwrap();
    let mut double = double
        .config(XpbdConfig {
            iterations,
            substeps,
            ..XpbdConfig::default()
        })
        .build()
        .unwrap();
    let solvers: [&mut dyn Stepper; 2] = [&mut single, &mut double];
    let [a, b] = solvers.map(|solver| {
        let mut air = Air::new(config, 0.2, &mesh).unwrap();
        let mut state = State::at_rest(mesh.positions().to_vec());
        for _ in 0..5 {
            let input = StepInput::new(1.0 / 60.0).air(&mut air);
            solver.step(&mut state, input).unwrap();
        }
        state.positions
    });
    let apart = a.iter().zip(&b).map(|(a, b)| (a - b).norm());
    let apart = apart.fold(0.0, Real::max);
    println!("{apart:e} m");
    assert!(apart < 2e-6, "{apart:e} m");
}

#[test]
fn springs_and_hinges_keep_momentum_to_single_precision() {
    let (mesh, mut model) = sheet::held_sheet(17, 1e3);
    for vertex in 0..mesh.vertex_count() {
        if model.particles.is_prescribed(vertex) {
            model.particles.release(vertex).unwrap();
        }
    }
    let (mut single, _) = solvers(&model);
    let mut state = State::at_rest(mesh.positions().to_vec());
    for (i, v) in state.velocities.iter_mut().enumerate() {
        *v = Vec3::new((i as Real).sin(), (3.0 * i as Real).cos(), 0.3) * 0.1;
    }
    let measured = |s: &State| {
        let p = linear_momentum(&model.particles, &s.velocities);
        let l = angular_momentum(&model.particles, s);
        (p, l)
    };
    let (p, l) = measured(&state);
    for _ in 0..10 {
        single.step(&mut state, StepInput::new(1.0 / 60.0)).unwrap();
    }
    let (q, m) = measured(&state);
    // A rounding of 3e-8 m is 4e-5 m/s in a substep; 200 of them at random are 14 times that for a vertex, and
    // 289 vertices a seventeenth of that for their mean.
    assert!((q - p).norm() < 6e-6, "{:e}", (q - p).norm());
    assert!(
        (m - l).norm() < 1e-4 * l.norm().max(1.0),
        "{:e}",
        (m - l).norm()
    );
}

/// Where no positive denominator is left, a row with a negative stiffness does nothing, as in double precision.
#[test]
fn a_negative_stiffness_moves_nothing_beyond_bounds() {
    let (_, mut solver) = pair(-1.0);
    let start = State::at_rest(vec![Vec3::zeros(), Vec3::x() * 1.5]);
    let mut state = start.clone();
    solver.step(&mut state, StepInput::new(0.01)).unwrap();
    assert_eq!(state.positions, start.positions);
}

#[test]
fn an_attachment_pulls_to_its_place_wherever_that_is() {
    let particles = Particles::new(vec![1.0]).unwrap();
    let target = Vec3::new(300.0, -20.0, 7.0);
    let attachment = Attachment {
        vertex: 0,
        target,
        stiffness: Real::INFINITY,
    };
    let solver = SingleXpbd::builder(&particles).vector_rows(&[attachment]);
    let mut solver = solver.build().unwrap();
    let mut state = State::at_rest(vec![target + Vec3::new(1.0, 2.0, 3.0)]);
    solver.step(&mut state, StepInput::new(0.01)).unwrap();
    // What is left is the rounding of the way there, swept once more in each of 20 substeps.
    let left = (state.positions[0] - target).norm();
    assert!(left < 1e-5, "{left:e}");
}

#[test]
fn what_it_cannot_take_is_refused_by_name() {
    let (mesh, model) = sheet::held_sheet(3, 1e4);
    let builder = || SingleXpbd::builder(&model.particles);
    let x = mesh.triangles()[0].map(|v| mesh.positions()[v as usize]);
    let stvk = StvkTriangle::new(mesh.triangles()[0], &x, 1.0, 0.3);
    let error = builder().vector_rows(&[stvk]).build().unwrap_err();
    assert!(
        matches!(error, BuildError::SettingsConflict { .. }),
        "{error}"
    );
    let pin = SoftPin::new(0, 1.0, x[0], PinMotion::NONE, 0.0);
    let error = builder().vector_rows(&[pin]).build().unwrap_err();
    let words = "elements whose rest data do not change with time";
    assert!(error.to_string().contains(words), "{error}");
    let far = Spring {
        vertices: [0, 9],
        rest_length: 1.0,
        stiffness: 1.0,
    };
    let error = builder().springs(&[far]).build().unwrap_err();
    assert!(matches!(error, BuildError::NoSuchVertex { vertex: 9, .. }));
    for (iterations, substeps) in [(0, 1), (1, 0)] {
        let config = SingleConfig {
            iterations,
            substeps,
        };
        let error = builder().config(config).build().unwrap_err();
        assert!(matches!(error, BuildError::OutOfRange(_)));
    }
    // Beyond single precision there is an error, and the state is as it was.
    let (_, mut solver) = pair(1e4);
    let start = State::at_rest(vec![Vec3::zeros(), Vec3::new(1e200, 0.0, 0.0)]);
    let mut state = start.clone();
    let error = solver.step(&mut state, StepInput::new(0.01)).unwrap_err();
    assert!(matches!(error, StepError::NonFinite { .. }), "{error}");
    assert_eq!(state, start);
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_a_bit() {
    let (mesh, model) = sheet::held_sheet(120, 1e4);
    let run = || {
        let (mut single, _) = solvers(&model);
        let mut state = State::at_rest(mesh.positions().to_vec());
        sheet::fall(&mut single, &mut state, 2);
        state
    };
    let results = [1, 2, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(run)
    });
    assert!(results[0] == results[1] && results[0] == results[2]);
}

#[test]
fn nothing_is_allocated_after_the_first_step() {
    let (mesh, model) = sheet::held_sheet(24, 1e4);
    let (mut single, _) = solvers(&model);
    let mut state = State::at_rest(mesh.positions().to_vec());
    let step = || sheet::fall(&mut single, &mut state, 1);
    assert_eq!(counting_allocator::allocations_once_warm(step), 0);
}
