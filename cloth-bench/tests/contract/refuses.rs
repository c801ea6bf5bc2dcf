//! Bad input is an error, and the state is as it was.

use crate::common::{methods, scene, solver};
use cloth_bench::scene::{SCENES, build, file};
use cloth_bench::settings::Settings;
use cloth_core::math::{Real, Vec3};
use cloth_core::step::{StepError, StepInput};

#[test]
fn a_step_that_is_not_a_positive_number_is_refused() {
    let scene = scene("hang", &["n=5"]);
    for method in methods() {
        let mut solver = solver(method, &scene);
        for dt in [0.0, -0.1, Real::NAN, Real::INFINITY] {
            let mut state = scene.start.clone();
            let error = solver.step(&mut state, StepInput::new(dt)).unwrap_err();
            assert!(
                matches!(error, StepError::InvalidTimeStep { .. }),
                "{}: {error}",
                method.name
            );
            assert!(state == scene.start);
        }
    }
}

#[test]
fn input_that_is_not_finite_is_refused_by_name() {
    let scene = scene("hang", &["n=5"]);
    for method in methods() {
        let mut solver = solver(method, &scene);
        let mut state = scene.start.clone();
        state.velocities[7].y = Real::NAN;
        let error = solver
            .step(&mut state, StepInput::new(scene.dt))
            .unwrap_err();
        assert_eq!(
            error,
            StepError::NonFiniteInput {
                what: "the state",
                vertex: Some(7)
            },
            "{}",
            method.name
        );
        let mut state = scene.start.clone();
        let gravity = Vec3::new(0.0, Real::INFINITY, 0.0);
        let error = solver
            .step(&mut state, StepInput::new(scene.dt).gravity(gravity))
            .unwrap_err();
        assert_eq!(
            error,
            StepError::NonFiniteInput {
                what: "gravity",
                vertex: None
            },
            "{}",
            method.name
        );
        assert!(state == scene.start);
        // And the solver still works.
        solver
            .step(&mut state, StepInput::new(scene.dt).gravity(scene.gravity))
            .unwrap();
    }
}

/// A key that nothing reads would leave a default where the caller wanted another value.
#[test]
fn keys_that_are_not_known_are_refused_inside_the_program_too() {
    let unknown = Settings::default().with("link_mass", 0.1);
    for scene in SCENES {
        let error = build(scene.name, None, &unknown).unwrap_err().to_string();
        assert!(error.starts_with("unknown parameter of scene"), "{error}");
    }
    let curtain = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/curtain.toml");
    let error = file::build(curtain.as_ref(), &unknown).unwrap_err();
    assert!(error.to_string().contains("`link_mass`"), "{error}");
    let scene = scene("hang", &["n=5"]);
    for method in methods() {
        let Err(error) = method.build(&scene, &unknown, scene.dt) else {
            panic!("{} takes any key", method.name);
        };
        let told = format!("unknown parameter of method `{}` `link_mass`", method.name);
        assert!(error.to_string().starts_with(&told), "{error}");
    }
}
