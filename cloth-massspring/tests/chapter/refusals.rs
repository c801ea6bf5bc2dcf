//! What is refused, and that the state is then as it was.

use crate::{DOWN, all, chain};
use cloth_core::element::Convexity;
use cloth_core::energy::Spring;
use cloth_core::error::OutOfRange;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, StepError, StepInput, Stepper};
use cloth_massspring::{
    ExplicitConfig, HessianPolicy, ImplicitConfig, ImplicitEuler, LinearMethod, Solve,
    StoppingCriteria, SymplecticEuler,
};

/// Steps from `state`, which must not change.
fn refused(solver: &mut dyn Stepper, state: &State, input: StepInput<'_>) -> StepError {
    let mut after = state.clone();
    let error = solver.step(&mut after, input).unwrap_err();
    // As text, because NaN is not equal to itself.
    assert_eq!(format!("{after:?}"), format!("{state:?}"));
    error
}

#[test]
fn time_steps_that_are_none() {
    let (particles, springs, positions) = chain(2, 10.0);
    let state = State::at_rest(positions);
    for solver in &mut all(&particles, &springs) {
        for dt in [0.0, -1.0, Real::NAN, Real::INFINITY] {
            let error = refused(solver.as_mut(), &state, StepInput::new(dt));
            assert!(
                matches!(error, StepError::InvalidTimeStep { .. }),
                "{error:?}"
            );
        }
    }
}

#[test]
fn input_that_is_not_finite() {
    let (particles, springs, positions) = chain(2, 10.0);
    let good = State::at_rest(positions);
    let mut bad = good.clone();
    bad.velocities[2].y = Real::NAN;
    let load = [Vec3::zeros(), Vec3::repeat(Real::INFINITY), Vec3::zeros()];
    for solver in &mut all(&particles, &springs) {
        let error = refused(solver.as_mut(), &bad, StepInput::new(0.01));
        assert!(matches!(
            error,
            StepError::NonFiniteInput {
                vertex: Some(2),
                ..
            }
        ));
        let error = refused(solver.as_mut(), &good, StepInput::new(0.01).load(&load));
        assert!(matches!(
            error,
            StepError::NonFiniteInput {
                vertex: Some(1),
                ..
            }
        ));
        let gravity = Vec3::repeat(Real::NAN);
        let error = refused(
            solver.as_mut(),
            &good,
            StepInput::new(0.01).gravity(gravity),
        );
        assert!(matches!(
            error,
            StepError::NonFiniteInput { vertex: None, .. }
        ));
    }
}

#[test]
fn a_result_that_overflows() {
    let (particles, springs, positions) = chain(2, 1e300);
    let mut state = State::at_rest(positions);
    state.positions[2] *= 1e200;
    for solver in &mut all(&particles, &springs) {
        let error = refused(solver.as_mut(), &state, StepInput::new(1e10));
        assert!(
            matches!(error, StepError::NonFinite { step: 1, .. }),
            "{error:?}"
        );
    }
}

#[test]
fn an_indefinite_matrix_where_nothing_may_be_dropped() {
    // Three vertices in line, both springs compressed: the middle one wants to buckle.
    let (particles, springs, positions) = buckling();
    let config = ImplicitConfig {
        hessian: HessianPolicy::Always(Convexity::Exact),
        solve: Solve::Newton,
        ..ImplicitConfig::default()
    };
    let builder = ImplicitEuler::builder(&particles).energy(springs);
    let mut solver = builder.config(config).build().unwrap();
    let state = State::at_rest(positions);
    let error = refused(&mut solver, &state, StepInput::new(1.0).gravity(DOWN));
    assert_eq!(
        error,
        StepError::NotPositiveDefinite {
            iteration: 1,
            step: 1
        }
    );
}

/// A vertex between two prescribed ones, on springs that are pressed to half their length.
pub(crate) fn buckling() -> (Particles, Vec<Spring>, Vec<Vec3>) {
    let mut particles = Particles::new(vec![1.0; 3]).unwrap();
    particles.prescribe(0).unwrap();
    particles.prescribe(2).unwrap();
    let positions = vec![Vec3::zeros(), Vec3::x(), Vec3::x() * 2.0];
    let springs = [[0, 1], [1, 2]].map(|vertices| Spring {
        vertices,
        rest_length: 2.0,
        stiffness: 100.0,
    });
    (particles, springs.to_vec(), positions)
}

#[test]
fn settings_out_of_range() {
    let (particles, springs, _) = chain(2, 10.0);
    for config in [
        ImplicitConfig {
            tolerance: Real::NAN,
            ..ImplicitConfig::default()
        },
        ImplicitConfig {
            tolerance: -1.0,
            ..ImplicitConfig::default()
        },
        ImplicitConfig {
            max_iterations: 0,
            ..ImplicitConfig::default()
        },
        // Of the solver that would only take over.
        ImplicitConfig {
            linear: LinearMethod::Multigrid(StoppingCriteria {
                tolerance: Real::NAN,
                ..StoppingCriteria::default()
            }),
            ..ImplicitConfig::default()
        },
    ] {
        let error = ImplicitEuler::builder(&particles)
            .config(config)
            .build()
            .unwrap_err();
        assert!(matches!(error, BuildError::OutOfRange(_)));
    }
    let config = ExplicitConfig {
        substeps: 0,
        ..ExplicitConfig::default()
    };
    let error = SymplecticEuler::builder(&particles)
        .config(config)
        .build()
        .unwrap_err();
    assert!(matches!(
        error,
        BuildError::OutOfRange(OutOfRange {
            name: "substeps",
            ..
        })
    ));
    let mut stray = springs;
    stray[0].vertices[0] = 9;
    let error = ImplicitEuler::builder(&particles)
        .energy(stray)
        .build()
        .unwrap_err();
    assert!(matches!(error, BuildError::NoSuchVertex { vertex: 9, .. }));
}

#[test]
fn there_is_no_step_after_the_last_number() {
    let (particles, springs, positions) = chain(2, 10.0);
    let mut state = State::at_rest(positions);
    state.steps = u64::MAX;
    for solver in &mut all(&particles, &springs) {
        let error = refused(solver.as_mut(), &state, StepInput::new(0.01));
        let told = error.to_string();
        assert_eq!(told, "the number of the next step is not finite");
    }
}

/// Beyond what can be set there is no advice.
#[test]
fn steps_that_no_number_of_substeps_makes_stable() {
    let told = |dt| StepError::Unstable {
        dt,
        stable_dt: 0.01,
        step: 1,
    };
    assert!(told(0.05).to_string().contains("at least 5 times as many"));
    assert!(
        told(1e9)
            .to_string()
            .ends_with("no number of substeps makes up for that")
    );
}
