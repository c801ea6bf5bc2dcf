//! Runs by every method that comes to the minimum of its steps, and errors of scene files.

use crate::scene_text::written;
use cloth_bench::method::Method;
use cloth_bench::run::{Plan, Solver, Summary, run_changing, to_rest};
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_core::particles::State;

/// All but forward Euler, which refuses every step, with settings with which they come to the minimum of a step.
pub(crate) const METHODS: [(&str, &[&str]); 9] = [
    // Undamped, a sheet that is let loose hardly comes to rest.
    (
        "symplectic-euler",
        &["stiffness_damping=2e-4", "substeps=120"],
    ),
    ("implicit-euler", &["tolerance=1e-12"]),
    ("linear-implicit", &[]),
    ("implicit-midpoint", &["tolerance=1e-12"]),
    ("bdf2", &["tolerance=1e-12"]),
    // With one visit a substep a row has its own stiffness, whatever its neighbours do.
    ("pbd", &["iterations=1", "substeps=20"]),
    ("xpbd", &[]),
    ("xpbd-direct", &[]),
    ("pd", &["iterations=200"]),
];

/// Where a scene comes to rest.
pub(crate) fn rest(scene: &Scene, method: &str, settings: &[&str]) -> State {
    let method = Method::find(method).unwrap();
    let settings = Settings::parse(settings).unwrap();
    let mut solver = method.build(scene, &settings, scene.dt).unwrap();
    let mut state = scene.start.clone();
    to_rest(scene, &mut *solver, &mut state, scene.dt, 20_000, 1e-9).unwrap();
    state
}

/// So many steps of a scene.
pub(crate) fn run(scene: &Scene, method: &str, settings: &[&str], steps: u32) -> (Summary, State) {
    let method = Method::find(method).unwrap();
    let settings = Settings::parse(settings).unwrap();
    let mut solver = Solver::new(method, &settings, scene, scene.dt).unwrap();
    let mut state = scene.start.clone();
    let plan = Plan::new(scene.dt, steps);
    let (summary, _) = run_changing(scene, &mut solver, &mut state, plan, |_| Ok(())).unwrap();
    (summary, state)
}

/// The scene is refused at that line, with these words.
pub(crate) fn refused(name: &str, text: &str, line: u32, words: &str) {
    let built = file::build(&written(name, text), &Settings::default());
    let said = built.unwrap_err().to_string();
    let place = format!("{name}.toml: line {line}: ");
    assert!(said.contains(&place) && said.contains(words), "{said}");
}
