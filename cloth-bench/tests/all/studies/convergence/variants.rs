//! What the study of convergence compares.

use cloth_bench::method::Method;
use cloth_bench::scene;
use cloth_bench::studies::Scope;
use cloth_bench::studies::convergence::variants::iterated;
use cloth_bench::studies::sheets::{STIFFNESS, hanging, sixteenth_step};
use cloth_core::math::Real;

#[test]
fn xpbd_as_one_system_ends_at_the_step_that_its_sweeps_do_not_reach() {
    let settings = hanging(17, STIFFNESS);
    let scene = scene::build("hang", None, &settings).unwrap();
    let problem = sixteenth_step(&settings).unwrap();
    let errors = |label: &str| -> Vec<Real> {
        let all = iterated(Scope::Quick);
        let variant = all.iter().find(|one| one.label == label).unwrap();
        let method = Method::find(variant.method()).unwrap();
        let mut solver = method.build(&scene, &variant.settings, scene.dt).unwrap();
        let trace = problem.trace(&mut *solver).unwrap();
        trace.iter().map(|sample| sample.error.objective).collect()
    };
    let [direct, swept] = ["xpbd-direct", "xpbd"].map(errors);
    assert!(
        direct
            .windows(2)
            .take(12)
            .all(|pair| pair[1] < 0.5 * pair[0]),
        "{direct:?}"
    );
    assert!(direct[5] < 1e-5 && direct[29].abs() < 1e-14, "{direct:?}");
    assert!((6.0e-3..6.1e-3).contains(&swept[499]), "{:e}", swept[499]);
}
