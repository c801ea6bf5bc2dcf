//! What the pairs cost that a quasi-Newton iteration of projective dynamics remembers: ten iterations of the hanging
//! sheet, without bending, with none, two and eight of them.
//!
//! The limit is that of an iteration's data, ten times: the elements, the factor twice, and of each pair two vectors
//! that are read and of one two that are written. The searches for a step length may try more with some histories than
//! with others, so each line prints how many.

use cloth_bench::scene;
use cloth_bench::settings::Settings;
use cloth_bench::studies::constant_matrix;
use cloth_core::math::{Real, Vec3};
use cloth_core::step::{StepInput, Stepper};
use cloth_pd::{Acceleration, PdConfig, PdSolver};
use criterion::Criterion;
use support::limit;
use support::limit::Moved;

const ITERATIONS: u32 = 10;

fn histories(criterion: &mut Criterion) {
    for side in [32, 64, 128] {
        // Springs alone, all of which are in the factor.
        let springs = Settings::default().with("n", side).with("bending", "none");
        let scene = scene::build("hang", None, &springs).expect("a scene");
        let model = &scene.model;
        let factor = constant_matrix(&scene).expect("a factor").factor_len() * size_of::<Real>();
        let elements = size_of_val(&model.springs[..]);
        let vector = size_of::<Vec3>() * scene.start.positions.len();
        let mut group = criterion.benchmark_group(format!("quasi-Newton, {side} a side"));
        group.sample_size(10);
        for history in [0, 2, 8] {
            let mut solver = PdSolver::builder(&model.particles)
                .energy(model.springs.clone())
                .config(PdConfig {
                    iterations: Some(ITERATIONS),
                    acceleration: Acceleration::QuasiNewton { history },
                    ..PdConfig::default()
                })
                .build()
                .expect("a solver");
            // A quarter of a second into the fall.
            let mut start = scene.start.clone();
            let input = || StepInput::new(scene.dt).gravity(scene.gravity);
            for _ in 0..15 {
                solver.step(&mut start, input()).expect("a step");
            }
            let pairs = 2 * history as usize + if history > 0 { 2 } else { 0 };
            let moved = Moved::times(ITERATIONS, elements + 2 * factor + (4 + pairs) * vector);
            let mut state = start.clone();
            let name = format!("{ITERATIONS} iterations, {history} pairs");
            limit::bench(&mut group, name, moved, || {
                state.clone_from(&start);
                solver.step(&mut state, input())
            });
            state.clone_from(&start);
            println!("{:?}", solver.step(&mut state, input()));
        }
    }
}

fn main() {
    limit::main(&[histories]);
}
