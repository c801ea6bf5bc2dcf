//! One step of the hanging sheet, by every method at its published setting, at three sizes.

use cloth_bench::method::METHODS;
use cloth_bench::scene;
use cloth_bench::settings::Settings;
use cloth_bench::yardstick::StepProblem;
use cloth_core::step::StepInput;
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of the hanging sheet");
    group.sample_size(10);
    for n in [32, 64, 128] {
        let scene = scene::build("hang", None, &Settings::default().with("n", n)).expect("a scene");
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
            group.bench_function(BenchmarkId::new(method.name, n), |bencher| {
                bencher.iter_batched_ref(
                    || problem.state().clone(),
                    |state| solver.step(state, StepInput::new(scene.dt).gravity(scene.gravity)),
                    criterion::BatchSize::LargeInput,
                );
            });
        }
    }
}

criterion_group!(benches, steps);
criterion_main!(benches);
