//! What the comparison then says of the method.

use crate::DESCENT;
use cloth_bench::method::Method;
use cloth_bench::scene;
use cloth_bench::settings::Settings;
use cloth_bench::yardstick::StepProblem;

/// Error of one step of the hanging sheet after so many iterations: 0 is the minimum, 1 the free flight.
fn error(iterations: u32) -> f64 {
    let scene = scene::build("hang", None, &Settings::default().with("n", 9)).unwrap();
    let problem = StepProblem::after(&scene, 5, scene.dt).unwrap();
    let settings = Settings::default().with("iterations", iterations);
    let mut solver = DESCENT.build(&scene, &settings, scene.dt).unwrap();
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
    cloth_bench::method::register(&[DESCENT]).unwrap();
    assert_eq!(Method::find("descent").unwrap().name, "descent");
    let all: Vec<&str> = cloth_bench::method::all()
        .map(|method| method.name)
        .collect();
    assert_eq!(all.last(), Some(&"descent"));
    assert!(all.contains(&"xpbd"));
    assert!(cloth_bench::method::register(&[DESCENT]).is_err());
}
