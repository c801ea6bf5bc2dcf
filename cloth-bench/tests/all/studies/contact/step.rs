//! A step in contact, against its minimiser.

use cloth_bench::method::Method;
use cloth_bench::settings::Settings;
use cloth_bench::studies::Scope;
use cloth_bench::studies::contact::step::{ContactProblem, MOMENTS, traced};

/// The one of a scene, with 9 vertices a side.
fn problem((scene, steps_before): (&str, u32)) -> ContactProblem {
    ContactProblem::new(scene, 9, steps_before).unwrap()
}

/// Distance from the minimiser with one setting of a method.
fn error(problem: &ContactProblem, name: &str, settings: &str) -> f64 {
    let reached = problem.reached(Method::find(name).unwrap(), &Settings::of(settings));
    reached.unwrap().position.0
}

/// Iterations after which each first is within three parts in ten, a tenth and a hundredth of the step.
#[test]
fn every_way_of_the_study_shows_where_its_iterations_lead() {
    let problem = problem(MOMENTS[1]);
    let mut found = Vec::new();
    for variant in traced(Scope::Quick) {
        let method = Method::find(variant.method()).unwrap();
        let trace = problem.trace(method, &variant.settings).unwrap();
        assert!(trace.is_sorted_by_key(|reached| reached.iterations));
        let end = problem.reached(method, &variant.settings).unwrap();
        assert_eq!(
            trace.last().unwrap().position,
            end.position,
            "{}",
            variant.label
        );
        let first = |wanted| trace.iter().find(|at| at.position.0 <= wanted);
        let taken = [0.3, 0.1, 1e-2].map(|wanted| first(wanted).map(|at| at.iterations));
        found.push((variant.label, taken));
    }
    let known = [
        ("implicit-euler", [Some(3), Some(5), Some(12)]),
        ("pd", [Some(5), Some(8), Some(17)]),
        ("xpbd", [Some(4), Some(46), None]),
        ("pbd, from the material", [Some(20), None, None]),
        ("pd, plain", [None; 3]),
        ("xpbd, Chebyshev", [Some(5), Some(34), None]),
    ];
    assert_eq!(found, known.map(|(label, taken)| (label.to_owned(), taken)));
}

/// A step of implicit Euler is as near to the minimiser as its tolerance says, and projective dynamics, which shares
/// neither its matrix nor its iteration, ends at the same place, friction and contact of cloth with itself included.
#[test]
fn two_methods_end_at_the_same_minimiser_with_contact() {
    for moment in MOMENTS {
        let problem = problem(moment);
        for tolerance in [1e-2, 1e-4, 1e-6, 1e-8] {
            let reached = error(
                &problem,
                "implicit-euler",
                &format!("tolerance={tolerance}"),
            );
            assert!(
                reached < 10.0 * tolerance,
                "{moment:?} {tolerance}: {reached}"
            );
        }
        let reached = error(&problem, "pd", "iterations=10000");
        assert!(reached < 1e-8, "{moment:?}: {reached}");
    }
}

/// Where cloth buckles, thirty iterations of projective dynamics with the constant matrix alone leave most of a step,
/// by L-BFGS around a cycle for the Hessian a twentieth, and eighty hardly any; the sweeps of XPBD in one substep come
/// nearer slowly.
#[test]
fn few_iterations_are_far_from_the_minimiser_where_cloth_buckles() {
    let problem = problem(MOMENTS[0]);
    let pd = [30, 80, 160].map(|n| error(&problem, "pd", &format!("iterations={n}")));
    assert!(pd[0] < 0.06 && pd[1] < 1e-3 && pd[2] < 1e-5, "{pd:?}");
    let plain = error(&problem, "pd", "acceleration=none iterations=30");
    assert!(plain > 0.7, "{plain:e}");
    let sweeps = [10, 100, 1000].map(|n| format!("substeps=1 iterations={n}"));
    let xpbd = sweeps.map(|settings| error(&problem, "xpbd", &settings));
    assert!(
        xpbd.is_sorted_by(|a, b| a > b) && xpbd[2] > 0.05,
        "{xpbd:?}"
    );
}
