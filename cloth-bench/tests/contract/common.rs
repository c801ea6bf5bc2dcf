//! What the claims share: the methods that run, and some scenes.

use cloth_bench::memory::allocated;
use cloth_bench::method::{METHODS, Method};
use cloth_bench::scene::{self, Scene};
use cloth_bench::settings::Settings;
use cloth_core::particles::State;
use cloth_core::step::{StepInput, Stepper};

/// Every method but forward Euler, which refuses every step as unstable.
pub(crate) fn methods() -> impl Iterator<Item = &'static Method> {
    METHODS
        .iter()
        .filter(|method| method.name != "explicit-euler")
}

pub(crate) fn scene(name: &str, pairs: &[&str]) -> Scene {
    scene::build(name, None, &Settings::parse(pairs).unwrap()).unwrap()
}

pub(crate) fn solver(method: &Method, scene: &Scene) -> Box<dyn Stepper> {
    method.build(scene, &Settings::default(), scene.dt).unwrap()
}

/// A method whose iteration goes on to rounding, if it has a tolerance.
pub(crate) fn converged(method: &Method, scene: &Scene) -> Box<dyn Stepper> {
    let is_iterated = matches!(method.name, "implicit-euler" | "bdf2" | "implicit-midpoint");
    let pairs: &[&str] = if is_iterated {
        &["tolerance=1e-12"]
    } else {
        &[]
    };
    let settings = Settings::parse(pairs).unwrap();
    method.build(scene, &settings, scene.dt).unwrap()
}

pub(crate) fn advance(solver: &mut dyn Stepper, scene: &Scene, state: &mut State, steps: usize) {
    for _ in 0..steps {
        solver
            .step(state, StepInput::new(scene.dt).gravity(scene.gravity))
            .unwrap();
    }
}

/// How often `work` asks for memory, on this thread.
pub(crate) fn allocations(work: impl FnOnce()) -> i64 {
    allocated(work).1.count
}

/// How often twenty calls of `step` do, after a first one that may.
pub(crate) fn allocations_once_warm(mut step: impl FnMut()) -> i64 {
    step();
    allocations(|| (0..20).for_each(|_| step()))
}
