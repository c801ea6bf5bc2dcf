//! What the comparison then says of the method.

use crate::VBD;
use cloth_bench::method::Method;
use cloth_bench::run::{SeparationWatch, from_start};
use cloth_bench::scene;
use cloth_bench::settings::Settings;
use cloth_bench::yardstick::StepProblem;
use cloth_core::contact::ContactSource;
use cloth_core::step::StepInput;

/// Error of one step of the hanging sheet after so many iterations: 0 is the minimum, 1 the free flight.
fn error(iterations: u32) -> f64 {
    let scene = scene::build("hang", None, &Settings::default().with("n", 9)).unwrap();
    let problem = StepProblem::after(&scene, 5, scene.dt).unwrap();
    let settings = Settings::default().with("iterations", iterations);
    let mut solver = VBD.build(&scene, &settings, scene.dt).unwrap();
    problem.solve(&mut *solver).unwrap().0.objective
}

#[test]
fn it_goes_down_to_the_minimum_of_implicit_euler() {
    let errors = [1, 10, 100, 3000, 30_000].map(error);
    assert!(errors[0] < 1.0, "{errors:?}");
    assert!(
        errors.windows(2).all(|pair| pair[1] < pair[0]),
        "{errors:?}"
    );
    assert!(errors[4].abs() < 1e-9, "{errors:?}");
}

#[test]
fn it_is_found_by_name_among_all_others() {
    cloth_bench::method::register(&[VBD]).unwrap();
    assert_eq!(Method::find("vbd").unwrap().name, "vbd");
    let all: Vec<&str> = cloth_bench::method::all()
        .map(|method| method.name)
        .collect();
    assert_eq!(all.last(), Some(&"vbd"));
    assert!(all.contains(&"xpbd"));
    assert!(cloth_bench::method::register(&[VBD]).is_err());
}

#[test]
fn its_limit_is_the_step_of_implicit_euler_with_contact_too() {
    let settings = Settings::default()
        .with("n", 9)
        .with("friction", 0)
        .with("stiffness", 200);
    let scene = scene::build("drape-sphere", None, &settings).unwrap();
    let dt = 0.5 * scene.dt;
    let implicit = Method::find("implicit-euler").unwrap();
    let tight = Settings::default().with("tolerance", 1e-10);
    let mut reference = implicit.build(&scene, &tight, dt).unwrap();
    let many = Settings::default().with("iterations", 500);
    let mut vbd = VBD.build(&scene, &many, dt).unwrap();
    let [mut contacts, mut of_vbd] = [(); 2].map(|()| scene.contacts().unwrap().unwrap());
    let mut state = scene.start.clone();
    let (mut apart, mut largest_force): (f64, f64) = (0.0, 0.0);
    for _ in 0..40 {
        let mut by_vbd = state.clone();
        let input = |source| StepInput::new(dt).gravity(scene.gravity).contacts(source);
        vbd.step(&mut by_vbd, input(&mut of_vbd)).unwrap();
        reference.step(&mut state, input(&mut contacts)).unwrap();
        let pairs = by_vbd.positions.iter().zip(&state.positions);
        apart = pairs.map(|(a, b)| (a - b).norm()).fold(apart, f64::max);
        largest_force = largest_force.max(contacts.potential_energy());
    }
    assert!(largest_force > 1e-6, "nothing has touched");
    assert!(apart < 1e-8, "{apart} m apart, {largest_force}");
}

#[test]
fn wrapped_round_a_ball_it_passes_through_nothing() {
    let settings = Settings::default().with("n", 17);
    let scene = scene::build("drape-sphere", None, &settings).unwrap();
    let mut vbd = VBD.build(&scene, &Settings::default(), scene.dt).unwrap();
    let mut contacts = scene.contacts().unwrap().unwrap();
    let mut state = scene.start.clone();
    let mut watch = SeparationWatch::new(&scene).unwrap();
    for _ in 0..60 {
        let input = StepInput::new(scene.dt).gravity(scene.gravity);
        vbd.step(&mut state, input.contacts(&mut contacts)).unwrap();
        watch.look(&scene, &state).unwrap();
    }
    let seen = watch.seen();
    assert_eq!(seen.most_intersections, 0);
    assert_eq!(seen.most_obstacle_intersections, 0);
    assert!(seen.min_clearance.unwrap() > 0.0, "{seen:?}");
}

/// Sheets come down on each other and on a floor. An iteration that took most of each gap would store fifty times what
/// gravity has given in the barrier.
#[test]
fn a_stack_comes_to_rest_without_energy_from_nowhere() {
    let settings = Settings::default().with("n", 7).with("sheets", 2);
    let scene = scene::build("stack", None, &settings).unwrap();
    let settings = Settings::default();
    let ran = from_start(&scene, &VBD, &settings, scene.dt, 30, |_, _, _| Ok(()));
    let (summary, _) = ran.unwrap();
    assert_eq!(summary.energy_excess, 0.0);
    assert_eq!(summary.intersections, Some(0));
    assert!(
        summary.kinetic_energy < 1e-9 * summary.energy_given,
        "{summary:?}"
    );
}

#[test]
fn a_free_fall_is_exact_and_costs_one_iteration() {
    // The start of the iteration is the end of the step where no element is strained.
    let settings = Settings::default().with("n", 9);
    let scene = scene::build("drop", None, &settings).unwrap();
    let one = Settings::default().with("iterations", 1);
    let mut vbd = VBD.build(&scene, &one, scene.dt).unwrap();
    let mut state = scene.start.clone();
    for _ in 0..10 {
        let input = StepInput::new(scene.dt).gravity(scene.gravity);
        vbd.step(&mut state, input).unwrap();
    }
    let fall = scene.gravity * (55.0 * scene.dt * scene.dt);
    for (x, start) in state.positions.iter().zip(&scene.start.positions) {
        assert!((x - start - fall).norm() < 1e-13);
    }
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let scene = scene::build("hang", None, &Settings::default().with("n", 5)).unwrap();
    let error = |key, value| {
        let settings = Settings::default().with(key, value);
        let built = VBD.build(&scene, &settings, scene.dt);
        built.err().unwrap().to_string()
    };
    assert!(error("rho", 1.0).contains("rho"));
    assert!(error("iterations", 0.0).contains("iterations"));
}
