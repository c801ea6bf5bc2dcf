//! The elements of a scene are a choice: a method takes those whose view it needs, and refuses the others by name.

use crate::common::{advance, allocations, converged, methods, scene as built, solver};
use cloth_bench::error::BenchError;
use cloth_bench::method::Method;
use cloth_bench::run::run;
use cloth_bench::scene;
use cloth_bench::settings::Settings;
use cloth_bench::yardstick::StepProblem;
use cloth_core::math::Real;
use cloth_core::step::{StepInput, Stepper};
use cloth_massspring::ImplicitEuler;
use cloth_pbd::PbdSolver;
use cloth_pd::PdSolver;
use cloth_xpbd::XpbdSolver;
use cloth_xpbd::direct::DirectXpbd;
use std::fmt::Write;
use std::path::{Path, PathBuf};

const CHOICES: [&str; 12] = [
    "membrane=springs",
    "membrane=stvk",
    "membrane=arap",
    "shear=1e3",
    "bending=dihedral",
    "bending=cubic",
    "bending=curved",
    "bending=spring",
    "bending=none",
    "compression=0.1",
    "slack=0.995,1.005",
    "edges=quads",
];

/// Whether the method has a use for the elements.
fn takes(method: &Method, choice: &str) -> bool {
    !matches!(
        (method.name, choice),
        ("pd", "membrane=stvk" | "bending=dihedral")
            | ("pbd" | "xpbd" | "xpbd-direct" | "pd", "bending=cubic")
    )
}

#[test]
fn a_method_takes_the_elements_it_has_a_view_of_and_no_others() {
    for choice in CHOICES {
        let scene = built("hang", &["n=5", choice]);
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
        let scene = built("drop", &["n=6", choice]);
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

/// A sheet bent to a quarter of a cylinder, as a file.
fn arc() -> PathBuf {
    let mut text = String::new();
    for (i, j) in (0..9).flat_map(|i| (0..5).map(move |j| (i, j))) {
        let (sin, cos) = (0.2 * Real::from(i)).sin_cos();
        writeln!(
            text,
            "v {} {} {}",
            0.5 * sin,
            0.1 * Real::from(j),
            0.5 * cos
        )
        .unwrap();
    }
    for a in (0..8).flat_map(|i| (1..5).map(move |j| 5 * i + j)) {
        writeln!(text, "f {a} {} {}\nf {a} {} {}", a + 5, a + 6, a + 6, a + 1).unwrap();
    }
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("arc.obj");
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn a_sheet_that_is_curved_at_rest_keeps_its_shape() {
    let path = arc();
    // Largest change of a distance (m) between two vertices after half a second of free fall.
    let change = |bending: &str| {
        let settings = Settings::parse(&["rigidity=1e-3", bending]).unwrap();
        let scene = scene::build("drop", path.to_str(), &settings).unwrap();
        let newton = Method::find("implicit-euler").unwrap();
        let mut state = scene.start.clone();
        advance(&mut *solver(newton, &scene), &scene, &mut state, 30);
        let (now, then) = (&state.positions, &scene.start.positions);
        let pairs = (0..now.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let apart =
            |(i, j): (usize, usize)| ((now[i] - now[j]).norm() - (then[i] - then[j]).norm()).abs();
        pairs.map(apart).fold(0.0, Real::max)
    };
    for bending in ["bending=dihedral", "bending=curved"] {
        let change = change(bending);
        assert!(change < 1e-9, "{bending}: {change:e}");
    }
    // The cubic form pulls outwards until the membrane balances it; the quadratic one is flat at rest, and opens.
    let [cubic, quadratic] = ["bending=cubic", "bending=quadratic"].map(change);
    assert!(cubic > 1e-9 && cubic < 1e-5, "{cubic:e}");
    assert!(quadratic > 0.05, "{quadratic:e}");
}

#[test]
fn no_element_makes_a_step_allocate() {
    for choice in CHOICES {
        let scene = built("hang", &["n=8", choice]);
        for method in methods().filter(|method| takes(method, choice)) {
            let mut solver = solver(method, &scene);
            let mut state = scene.start.clone();
            advance(&mut *solver, &scene, &mut state, 1);
            // Newton's method takes its room when the quasi-Newton method is first let down: `pd` has linear iterations
            // then alone.
            let is_pd = method.name == "pd";
            let mut fallbacks = 0;
            for step in 2..=21 {
                let known = fallbacks;
                let count = allocations(|| {
                    let input = StepInput::new(scene.dt).gravity(scene.gravity);
                    let report = solver.step(&mut state, input).unwrap();
                    let goes_on = is_pd && report.linear_iterations > 0;
                    fallbacks += report.newton_fallbacks + u32::from(goes_on);
                });
                let is_first_fallback = known == 0 && fallbacks > 0;
                assert!(
                    count == 0 || is_first_fallback,
                    "{} {choice}: {count} in step {step}",
                    method.name
                );
            }
        }
    }
}

#[test]
fn elements_change_what_hangs() {
    // Elastic energy after a swing: each choice has its own.
    let elastic = |pairs: &[&str]| {
        let scene = built("hang", pairs);
        let method = Method::find("implicit-euler").unwrap();
        let mut stepper = converged(method, &scene);
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
fn converged_pd_and_newton_agree_on_every_element_that_both_take() {
    agree(&["membrane=arap", "bending=curved"]);
    agree(&["compression=0.1"]);
    agree(&["slack=0.995,1.005"]);
    agree(&["edges=quads"]);
}

fn agree(choices: &[&str]) {
    let scene = built("hang", &[&["n=7", "stiffness=100"], choices].concat());
    let problem = StepProblem::after(&scene, 10, scene.dt).unwrap();
    let settings = Settings::parse(&["iterations=20000", "tolerance=1e-10"]).unwrap();
    let pd = Method::find("pd").unwrap();
    let mut stepper = pd.build(&scene, &settings, scene.dt).unwrap();
    let (error, ..) = problem.solve(&mut *stepper).unwrap();
    assert!(error.gradient < 1e-9, "{choices:?}: {:e}", error.gradient);
    let objective: Real = error.objective;
    assert!(objective.abs() < 1e-9, "{choices:?}: {objective:e}");
}

#[test]
fn a_whole_cloth_is_the_same_as_its_families_one_by_one() {
    let scene = built("hang", &["n=7"]);
    let (model, particles) = (&scene.model, &scene.model.particles);
    macro_rules! two_ways {
        ($kind:ident) => {{
            let whole = $kind::builder(particles).elements(model.families());
            let parts = $kind::builder(particles).energy(model.springs.clone());
            let parts = parts.energy(model.hinges.clone());
            let (whole, parts) = (whole.build().unwrap(), parts.build().unwrap());
            [Box::new(whole) as Box<dyn Stepper>, Box::new(parts)]
        }};
    }
    for solvers in [
        two_ways!(ImplicitEuler),
        two_ways!(PbdSolver),
        two_ways!(XpbdSolver),
        two_ways!(DirectXpbd),
        two_ways!(PdSolver),
    ] {
        let [whole, parts] = solvers.map(|mut solver| {
            let mut state = scene.start.clone();
            advance(&mut *solver, &scene, &mut state, 3);
            state.positions
        });
        assert_eq!(whole, parts);
    }
}
