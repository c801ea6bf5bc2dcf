//! The table that leads the report.

mod columns;

use cloth_bench::method::Method;
use cloth_bench::report::table::{Cell, Mark};
use cloth_bench::studies::Scope;
use cloth_bench::studies::decision::measure::{Step, hopeless};
use cloth_bench::studies::decision::shown;
use cloth_bench::studies::locking::methods::fold_angle;
use cloth_bench::studies::stability::stable_up_to;

/// What every method makes of a step, a stiff sheet and a fold does not depend on the machine.
#[test]
fn steps_are_ordered_as_theory_has_it() {
    let of = |name: &str| {
        let method = Method::find(name).unwrap();
        Step::measure(Scope::Quick, method).unwrap()
    };
    let names = ["implicit-euler", "pd", "linear-implicit", "pbd"];
    let steps = names.map(of);
    let errors = steps.each_ref().map(|step| step.error.unwrap());
    assert!(errors.is_sorted(), "{errors:?}");
    assert!(errors[0] < 1e-6 && errors[3] > 0.1, "{errors:?}");
    // Solved to the end, a sheet stretches as little as its springs allow; cut short, it stretches more.
    let stretches = steps.each_ref().map(|step| step.stretch.unwrap());
    assert!(stretches[3] > 20.0 * stretches[0], "{stretches:?}");
    for step in &steps {
        assert_eq!(step.stable, Some(1e9), "{step:?}");
        assert_eq!(step.reasons, [""; 0]);
        // None of them locks: edges lie along the fold.
        assert!(step.fold.unwrap() > 1.0, "{step:?}");
    }
}

#[test]
fn failures_that_theory_foretells_are_no_alarm() {
    assert_eq!(hopeless(Scope::Quick).unwrap(), "never, as expected");
    let limit = stable_up_to("symplectic-euler", 20).unwrap();
    assert_eq!(limit, Some(1.0));
    let table = shown(Scope::Quick, &[], "never");
    assert!(table.rows[0].contains(&Cell::Marked("never".into(), Mark::Expected)));
    assert!(!table.to_html().contains("unfit"));
}

/// A sheet that still moves has no angle: without damping it never comes to rest.
#[test]
fn a_fold_that_does_not_rest_is_not_judged() {
    let found = fold_angle("implicit-midpoint", 8);
    let told = found.unwrap_err().to_string();
    assert!(told.contains("not at rest"), "{told}");
}
