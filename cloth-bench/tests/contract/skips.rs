//! What a scene does not use does not exist.

use crate::common::{scene, solver};
use cloth_bench::method::Method;
use cloth_bench::run::run;
use cloth_core::particles::State;
use cloth_core::step::StepReport;

#[test]
fn without_rigidity_no_bending_is_built() {
    let without = scene("hang", &["n=9", "rigidity=0"]);
    assert!(without.model.hinges.is_empty());
    assert_eq!(without.model.families().len(), 1);
    let with = scene("hang", &["n=9"]);
    assert_eq!(with.model.families().len(), 2);
}

/// A linearised step near which nothing is solves one system, with contact as without it.
#[test]
fn contact_that_is_far_away_leaves_linearised_steps_as_they_are() {
    let settings: [&[&str]; 2] = [&["n=13"], &["n=13", "self=yes"]];
    let ends = settings.map(|settings| {
        let scene = scene("hang", settings);
        let method = Method::find("linear-implicit").unwrap();
        let mut solver = solver(method, &scene);
        let mut state = scene.start.clone();
        let look = |_: u32, _: &State, report: &StepReport| {
            assert_eq!(report.iterations, 1);
            Ok(())
        };
        run(&scene, &mut *solver, &mut state, scene.dt, 10, look).unwrap();
        state
    });
    assert!(ends[0] == ends[1]);
}
