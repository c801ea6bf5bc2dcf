//! The table that leads the report.

mod columns;

use cloth_bench::method::Method;
use cloth_bench::report::table::{Cell, Mark};
use cloth_bench::studies::Scope;
use cloth_bench::studies::decision::measure::{Cost, Step, hopeless};
use cloth_bench::studies::decision::{Row, shown, verdict};
use cloth_bench::studies::locking::methods::fold_angle;
use cloth_bench::studies::stability::stable_up_to;
use cloth_core::math::Real;

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
    // One linear solve and sweeps that end before they have converged leave more in stiff springs than the fall gives.
    let strained = steps.each_ref().map(|step| step.stable.strained);
    assert_eq!(strained, [None, None, Some(1e5), Some(10.0)]);
    for step in &steps {
        assert_eq!(step.stable.stable, Some(1e9), "{step:?}");
        assert_eq!(step.reasons, [""; 0]);
        // None of them locks: edges lie along the fold.
        assert!(step.fold.unwrap() > 1.0, "{step:?}");
    }
}

#[test]
fn failures_that_theory_foretells_are_no_alarm() {
    assert_eq!(hopeless(Scope::Quick).unwrap(), "never, as expected");
    let limit = stable_up_to("symplectic-euler", 20).unwrap();
    assert_eq!(limit.stable, Some(1.0));
    let table = shown(Scope::Quick, &[], "never", Some(2e7));
    assert!(table.rows[0].contains(&Cell::Marked("never".into(), Mark::Expected)));
    assert!(table.rows[0].contains(&Cell::said("20 MB")));
    assert!(!table.to_html().contains("unfit"));
}

/// Swept or solved, explicit or implicit: the sheet does not lock along the lines of its edges, and every method that
/// comes to rest has an angle. That of the midpoint rule, which damps nothing, does not.
#[test]
fn a_fold_that_does_not_rest_is_not_judged() {
    let [explicit, implicit] =
        ["symplectic-euler", "implicit-euler"].map(|name| fold_angle(name, 8).unwrap());
    assert!(
        (explicit / implicit - 1.0).abs() < 0.07,
        "{explicit} {implicit}"
    );
    let found = fold_angle("implicit-midpoint", 8);
    let told = found.unwrap_err().to_string();
    assert!(told.contains("not at rest"), "{told}");
}

/// A method that is fast and wrong is not the one to take.
#[test]
fn what_is_unfit_is_best_at_nothing() {
    let row = |method, ms: Real, error, stretch| Row {
        method,
        cost: Some(Cost {
            sides: [10, 20],
            ms: [Some(ms), Some(8.0 * ms)],
            memory: None,
        }),
        step: Some(Step {
            error: Some(error),
            stretch: Some(stretch),
            ..Step::default()
        }),
        contact: None,
    };
    let rows = [
        row("implicit-euler", 2.0, 1e-9, 0.01),
        row("pd", 1.0, 1e-3, 0.01),
        row("pbd", 0.1, 0.9, 0.5),
    ];
    let told = verdict(&rows);
    let [fit, unfit] = [
        "right: implicit-euler, pd.",
        "pbd (error of a step, stretch)",
    ];
    assert!(told.contains(fit) && told.contains(unfit), "{told}");
    let best = [
        "large sheet: pd (8 ms)",
        "implicit Euler step: implicit-euler (1e-9)",
    ];
    assert!(best.iter().all(|best| told.contains(best)), "{told}");
    // What is not to be had says why.
    let cells = shown(Scope::Quick, &rows, "never", None).rows;
    let failed = Cell::Marked("failed".into(), Mark::Unfit);
    assert!(cells[0].contains(&failed) && !cells.concat().contains(&Cell::Missing));
}
