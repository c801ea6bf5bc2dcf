//! Input that makes no sense: an error that names the thing and a state left alone, or a step that is finite.
//! Never a panic, never a number that is none.

use crate::chapter::GRAVITY;
use cloth_core::energy::{Attachment, CurvatureHinge, Spring, StrainLimitSpring, StvkTriangle};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, StepError, StepInput, Stepper};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

fn spring(rest_length: Real, stiffness: Real) -> Vec<Spring> {
    let vertices = [0, 1];
    vec![Spring {
        vertices,
        rest_length,
        stiffness,
    }]
}

fn solver(springs: Vec<Spring>, particles: &Particles) -> XpbdSolver {
    XpbdSolver::builder(particles)
        .energy(springs)
        .build()
        .unwrap()
}

fn apart(distance: Real) -> State {
    State::at_rest(vec![Vec3::zeros(), Vec3::new(distance, 0.0, 0.0)])
}

/// Takes a step; finite, or refused with the state as it was. Multipliers and forces are numbers in both cases.
fn finite_or_refused(solver: &mut XpbdSolver, mut state: State, dt: Real) {
    let before = state.clone();
    let step = solver.step(&mut state, StepInput::new(dt).gravity(GRAVITY));
    match step {
        Ok(_) => assert_eq!(state.first_non_finite(), None, "{solver:?}"),
        Err(error) => assert!(state == before, "{error}"),
    }
    let mut forces = vec![Vec3::zeros(); state.positions.len()];
    solver.vertex_forces_into(&mut forces);
    let numbers = forces.iter().flatten().all(|f| !f.is_nan());
    assert!(numbers, "{forces:?} at {dt} s: {solver:?}");
    assert!(!solver.compliance_residual(&state.positions).is_nan());
}

#[test]
fn the_largest_and_smallest_numbers_end_in_finite_steps_or_errors() {
    let numbers = [
        0.0,
        Real::MIN_POSITIVE,
        1e-200,
        1e-30,
        1.0,
        1e30,
        1e200,
        Real::MAX,
    ];
    for rest_length in numbers {
        for stiffness in numbers.into_iter().chain([Real::INFINITY]) {
            for mass in [1e-30, 1.0, 1e30] {
                for dt in [1e-200, 1e-12, 1.0, 1e12] {
                    for distance in [0.0, 1e-200, 1.0, 1e150] {
                        let particles = Particles::new(vec![mass, 1.0]).unwrap();
                        let mut solver = solver(spring(rest_length, stiffness), &particles);
                        finite_or_refused(&mut solver, apart(distance), dt);
                    }
                }
            }
        }
    }
}

/// Refused by the number of the family, the kind and the number of the element.
fn refused<S>(built: Result<S, BuildError>, kind: &str) {
    let Err(error) = built else {
        panic!("{kind}: it was built");
    };
    let begins = format!("element 0 of family 0 ({kind}): the ");
    assert!(error.to_string().starts_with(&begins), "{error}");
    assert!(error.to_string().contains("NaN"), "{error}");
}

#[test]
fn a_stiffness_that_is_not_a_number_is_refused() {
    let particles = Particles::new(vec![1.0; 3]).unwrap();
    let attachment = Attachment {
        vertex: 2,
        target: Vec3::x(),
        stiffness: Real::NAN,
    };
    let rest = [Vec3::zeros(), Vec3::x(), Vec3::y()];
    let triangle = StvkTriangle::new([0, 1, 2], &rest, Real::NAN, 0.3);
    let limit = StrainLimitSpring {
        vertices: [0, 1],
        shortest: 0.9,
        longest: 1.1,
        stiffness: Real::NAN,
    };
    for sweep in [Sweep::Colored, Sweep::Sequential, Sweep::Jacobi] {
        let builder = || {
            XpbdSolver::builder(&particles).config(XpbdConfig {
                sweep,
                ..XpbdConfig::default()
            })
        };
        refused(builder().energy(spring(1.0, Real::NAN)).build(), "Spring");
        refused(builder().energy(vec![attachment]).build(), "Attachment");
        refused(builder().energy(vec![triangle]).build(), "StvkTriangle");
        refused(builder().energy(vec![limit]).build(), "StrainLimitSpring");
    }
    #[cfg(feature = "single")]
    {
        use cloth_xpbd::single::SingleXpbd;
        let builder = || SingleXpbd::builder(&particles);
        let springs = builder().springs(&spring(1.0, Real::NAN));
        refused(springs.build(), "Spring");
        refused(builder().vector_rows(&[attachment]).build(), "Attachment");
    }
    #[cfg(feature = "direct")]
    {
        use cloth_xpbd::direct::{DirectConfig, DirectXpbd};
        for system in crate::direct::SYSTEMS {
            let config = DirectConfig {
                system,
                ..DirectConfig::default()
            };
            let builder = || DirectXpbd::builder(&particles).config(config);
            refused(builder().energy(spring(1.0, Real::NAN)).build(), "Spring");
            refused(builder().energy(vec![triangle]).build(), "StvkTriangle");
        }
    }
}

#[test]
fn what_is_not_a_number_is_refused() {
    let particles = Particles::new(vec![1.0; 2]).unwrap();
    for rest_length in [Real::NAN, Real::INFINITY] {
        let builder = XpbdSolver::builder(&particles).energy(spring(rest_length, 1.0));
        let error = builder.build().unwrap_err().to_string();
        assert!(error.contains("(Spring): the rest length"), "{error}");
    }
    let mut solver = solver(spring(1.0, 1.0), &particles);
    for dt in [0.0, -1.0, Real::NAN, Real::INFINITY] {
        let error = solver
            .step(&mut apart(2.0), StepInput::new(dt))
            .unwrap_err();
        assert!(matches!(error, StepError::InvalidTimeStep { .. }), "{dt}");
    }
    let error = solver
        .step(&mut apart(Real::NAN), StepInput::new(0.1))
        .unwrap_err();
    assert!(matches!(
        error,
        StepError::NonFiniteInput {
            vertex: Some(1),
            ..
        }
    ));
    let input = StepInput::new(0.1).gravity(Vec3::new(0.0, Real::INFINITY, 0.0));
    let error = solver.step(&mut apart(2.0), input).unwrap_err();
    assert!(matches!(
        error,
        StepError::NonFiniteInput {
            what: "gravity",
            ..
        }
    ));
    let load = [Vec3::zeros(), Vec3::repeat(Real::NAN)];
    let error = solver
        .step(&mut apart(2.0), StepInput::new(0.1).load(&load))
        .unwrap_err();
    assert!(matches!(
        error,
        StepError::NonFiniteInput {
            vertex: Some(1),
            ..
        }
    ));
    // And it still works.
    solver.step(&mut apart(2.0), StepInput::new(0.1)).unwrap();
}

#[test]
fn an_element_on_a_flat_rest_shape_does_nothing_or_is_refused() {
    let rest = [Vec3::zeros(), Vec3::x(), Vec3::x() * 2.0, Vec3::y()];
    let particles = Particles::new(vec![1.0; 4]).unwrap();
    let hinge = CurvatureHinge::new([0, 1, 2, 3], &rest, 1.0);
    let mut solver = XpbdSolver::builder(&particles).energy(vec![hinge]);
    let mut state = State::at_rest(rest.to_vec());
    let built = solver.build();
    assert!(
        matches!(built, Err(BuildError::InvalidElement { .. })),
        "{built:?}"
    );
    let flat = [rest[0], rest[1], rest[2]];
    let triangle = StvkTriangle::new([0, 1, 2], &flat, 1e3, 0.3);
    solver = XpbdSolver::builder(&particles).energy(vec![triangle]);
    let step = solver
        .build()
        .unwrap()
        .step(&mut state, StepInput::new(0.01));
    assert!(step.is_ok() && state.positions == rest, "{step:?}");
}

#[test]
fn nothing_at_all_and_nothing_that_moves_are_steps_too() {
    let empty = Particles::new(Vec::new());
    if let Ok(particles) = empty {
        let mut solver = solver(Vec::new(), &particles);
        let mut state = State::at_rest(Vec::new());
        solver.step(&mut state, StepInput::new(0.1)).unwrap();
    }
    let mut particles = Particles::new(vec![1.0; 2]).unwrap();
    (0..2).for_each(|v| particles.prescribe(v).unwrap());
    for stiffness in [0.0, 1.0, Real::INFINITY] {
        let mut solver = solver(spring(1.0, stiffness), &particles);
        let mut state = apart(3.0);
        state.velocities[1].y = 2.0;
        let input = StepInput::new(0.5).gravity(GRAVITY);
        solver.step(&mut state, input).unwrap();
        assert_eq!(state.positions[0], Vec3::zeros());
        assert!((state.positions[1] - Vec3::new(3.0, 1.0, 0.0)).norm() < 1e-15);
        assert_eq!(state.velocities[1], Vec3::y() * 2.0);
    }
}

#[test]
fn elements_and_settings_that_do_not_fit_are_named() {
    let particles = Particles::new(vec![1.0; 2]).unwrap();
    let stray = Spring {
        vertices: [0, 7],
        rest_length: 1.0,
        stiffness: 1.0,
    };
    let error = XpbdSolver::builder(&particles).energy(vec![stray]).build();
    assert!(matches!(
        error,
        Err(BuildError::NoSuchVertex { vertex: 7, .. })
    ));
    let chebyshev = |radius, delay| Acceleration {
        chebyshev: Some(Chebyshev { radius, delay }),
        ..Acceleration::default()
    };
    let relaxed = |relaxation| Acceleration {
        relaxation,
        chebyshev: None,
    };
    for acceleration in [
        relaxed(0.0),
        relaxed(2.0),
        relaxed(Real::NAN),
        chebyshev(Radius::Given(1.0), 3),
        chebyshev(Radius::Given(Real::NAN), 3),
        chebyshev(Radius::Given(0.5), 0),
        chebyshev(Radius::Estimated, 1),
    ] {
        for sweep in [Sweep::Colored, Sweep::Jacobi] {
            let config = XpbdConfig {
                acceleration,
                sweep,
                ..XpbdConfig::default()
            };
            let error = XpbdSolver::builder(&particles).config(config).build();
            assert!(
                matches!(error, Err(BuildError::OutOfRange(_))),
                "{config:?}"
            );
        }
    }
}
