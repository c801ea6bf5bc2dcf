//! One step of the hanging sheet, by every method at its published setting, at three sizes.
//!
//! The limit is that of reading the state and the elements once and writing the state: what no method can do without, however few iterations it needs.

#[path = "support/limit.rs"]
mod limit;
#[path = "support/sheet.rs"]
mod sheet;

use cloth_bench::method::METHODS;
use cloth_bench::settings::Settings;
use cloth_bench::yardstick::StepProblem;
use cloth_core::step::StepInput;
use criterion::Criterion;
use sheet::sheet;

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

fn main() {
    limit::main(&[steps]);
}
