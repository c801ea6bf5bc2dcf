//! One step of the hanging sheet, by every method at its published setting, at three sizes; and of a sheet in flight,
//! with and without contact to look for.
//!
//! The limit is that of reading the state and the elements once and writing the state: what no method can do without,
//! however few iterations it needs.

use cloth_bench::method::{METHODS, Method};
use cloth_bench::scene;
use cloth_bench::settings::Settings;
use cloth_bench::yardstick::StepProblem;
use cloth_core::step::StepInput;
use criterion::Criterion;
use support::limit;
use support::sheet::sheet;

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of the hanging sheet");
    group.sample_size(10);
    for n in [32, 64, 128] {
        let scene = sheet(n);
        let model = &scene.model;
        let elements = size_of_val(&model.springs[..]) + size_of_val(&model.hinges[..]);
        let state = size_of_val(&scene.start.positions[..]) * 2;
        let bytes = elements + 2 * state + size_of_val(model.particles.inverse_mass());
        // A quarter of a second into the fall, the same state for every method.
        let problem = StepProblem::after(&scene, 15, scene.dt).expect("a reference");
        // Forward Euler has no stable step.
        for method in METHODS
            .iter()
            .filter(|method| method.name != "explicit-euler")
        {
            let mut solver = method
                .build(&scene, &Settings::default(), scene.dt)
                .expect("a solver");
            let mut state = problem.state().clone();
            limit::bench(&mut group, format!("{}/{n}", method.name), bytes, || {
                state.clone_from(problem.state());
                solver.step(&mut state, StepInput::new(scene.dt).gravity(scene.gravity))
            });
        }
    }
}

/// What it costs a sheet in flight that it could touch itself.
fn flight(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of a sheet in flight");
    group.sample_size(10);
    for n in [64, 128] {
        for (name, own) in [("alone", "self=no"), ("with self-contact", "self=yes")] {
            let settings = Settings::parse(&[own]).expect("a setting").with("n", n);
            let scene = scene::build("drop", None, &settings).expect("a scene");
            let mut contacts = scene.contacts().expect("contact");
            let method = Method::find("xpbd").expect("a method");
            let solver = method.build(&scene, &Settings::default(), scene.dt);
            let mut solver = solver.expect("a solver");
            // Not too fast for coordinates that stay small.
            let mut state = scene.start.clone();
            state.velocities.fill(scene.gravity * 1e-3);
            let bytes = size_of_val(&state.positions[..]) * 4;
            limit::bench(&mut group, format!("{name}/{n}"), bytes, || {
                let mut input = StepInput::new(scene.dt);
                if let Some(contacts) = &mut contacts {
                    input = input.contacts(contacts);
                }
                solver.step(&mut state, input)
            });
        }
    }
}

fn main() {
    limit::main(&[steps, flight]);
}
