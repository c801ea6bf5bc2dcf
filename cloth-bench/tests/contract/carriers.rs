//! The elements of a scene are a choice: a method takes those whose view it needs, and refuses the others by name.

use crate::common::{advance, methods, scene, solver};
use crate::counting_allocator::allocations_once_warm;
use cloth_bench::error::BenchError;
use cloth_bench::method::Method;
use cloth_bench::run::run;
use cloth_bench::settings::Settings;
use cloth_bench::yardstick::StepProblem;
use cloth_core::math::Real;

const CHOICES: [&str; 9] = [
    "membrane=springs",
    "membrane=stvk",
    "membrane=arap",
    "shear=1e3",
    "bending=dihedral",
    "bending=cubic",
    "bending=curved",
    "bending=spring",
    "bending=none",
];

/// Whether the method has a use for the elements.
fn takes(method: &Method, choice: &str) -> bool {
    !matches!(
        (method.name, choice),
        ("pd", "membrane=stvk" | "bending=dihedral") | ("pbd" | "xpbd" | "pd", "bending=cubic")
    )
}

#[test]
fn a_method_takes_the_elements_it_has_a_view_of_and_no_others() {
    for choice in CHOICES {
        let scene = scene("hang", &["n=5", choice]);
        for method in methods() {
            let built = method.build(&scene, &Settings::default(), scene.dt);
            match built {
                Ok(_) => assert!(takes(method, choice), "{} {choice}", method.name),
                Err(BenchError::Usage(message)) => {
                    assert!(!takes(method, choice), "{message}");
                    let named = format!("`{}` cannot take", method.name);
                    assert!(message.contains(&named), "{message}");
                }
                Err(other) => panic!("{other}"),
            }
        }
    }
}

#[test]
fn a_free_sheet_of_any_elements_keeps_its_shape() {
    for choice in CHOICES {
        let scene = scene("drop", &["n=6", choice]);
        for method in methods().filter(|method| takes(method, choice)) {
            let mut state = scene.start.clone();
            advance(&mut *solver(method, &scene), &scene, &mut state, 5);
            let fall = state.positions[0] - scene.start.positions[0];
            for (now, then) in state.positions.iter().zip(&scene.start.positions) {
                let apart = (now - then - fall).norm();
                assert!(apart < 1e-9, "{} {choice}: {apart:e} m", method.name);
            }
        }
    }
}

#[test]
fn no_element_makes_a_step_allocate() {
    for choice in CHOICES {
        let scene = scene("hang", &["n=8", choice]);
        for method in methods().filter(|method| takes(method, choice)) {
            let mut solver = solver(method, &scene);
            let mut state = scene.start.clone();
            let count = allocations_once_warm(|| advance(&mut *solver, &scene, &mut state, 1));
            assert_eq!(count, 0, "{} {choice}", method.name);
        }
    }
}

#[test]
fn elements_change_what_hangs() {
    // Elastic energy after a swing: each choice has its own.
    let elastic = |pairs: &[&str]| {
        let scene = scene("hang", pairs);
        let method = Method::find("implicit-euler").unwrap();
        let mut stepper = solver(method, &scene);
        let mut state = scene.start.clone();
        let done = run(
            &scene,
            &mut *stepper,
            &mut state,
            scene.dt,
            20,
            |_, _, _| Ok(()),
        );
        let summary = done.unwrap();
        assert!(summary.max_stretch > 1e-6 && summary.max_stretch < 0.1);
        summary.elastic_energy
    };
    let base = elastic(&["n=7", "rigidity=1e-3"]);
    for choice in &CHOICES[1..] {
        let mut pairs = vec!["n=7", *choice];
        if !choice.contains("=spring") && !choice.contains("=none") {
            pairs.push("rigidity=1e-3");
        }
        let change = (elastic(&pairs) / base - 1.0).abs();
        // On a sheet that is flat at rest these two are the quadratic model in another form.
        let same = ["bending=cubic", "bending=curved"].contains(choice);
        assert!(
            if same { change < 1e-9 } else { change > 1e-6 },
            "{choice}: {change:e}"
        );
    }
}

#[test]
fn converged_pd_and_newton_agree_on_triangles_and_curved_hinges() {
    let scene = scene(
        "hang",
        &["n=7", "stiffness=100", "membrane=arap", "bending=curved"],
    );
    let problem = StepProblem::after(&scene, 10, scene.dt).unwrap();
    let settings = Settings::parse(&["iterations=20000", "tolerance=1e-10"]).unwrap();
    let pd = Method::find("pd").unwrap();
    let mut stepper = pd.build(&scene, &settings, scene.dt).unwrap();
    let (error, ..) = problem.solve(&mut *stepper).unwrap();
    assert!(error.gradient < 1e-9, "{:e}", error.gradient);
    let objective: Real = error.objective;
    assert!(objective.abs() < 1e-9, "{objective:e}");
}
