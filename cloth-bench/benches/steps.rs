//! One step of the hanging sheet, by every method at its published setting, at three sizes; and of a sheet in flight,
//! with and without contact to look for; and of one that falls onto a ball.
//!
//! The limit is that of reading the state and the elements once and writing the state: what no method can do without,
//! however few iterations it needs.

use cloth_bench::method::{METHODS, Method};
use cloth_bench::scene::{self, Scene};
use cloth_bench::settings::Settings;
use cloth_bench::studies::variants::Variant;
use cloth_bench::yardstick::StepProblem;
use cloth_core::step::StepInput;
use criterion::Criterion;
use std::time::{Duration, Instant};
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

/// What a body of 30,420 triangles costs beside the signed distance of the same ball: 20 steps of a sheet that falls onto
/// it, or 3 m above it.
fn bodies(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("20 steps of a sheet before a ball");
    group.sample_size(10);
    let shapes = [
        ("distance", "shape = \"sphere\"\nradius = 0.1\n"),
        (
            "triangles",
            "shape = \"mesh\"\ngenerator = \"sphere:39\"\nscale = 0.2\n",
        ),
    ];
    for (place, below) in [("wrapped", 0.0), ("far", 3.0)] {
        for method in ["xpbd", "pd", "implicit-euler"] {
            for (shape, body) in shapes {
                let text = format!(
                    "[[mesh]]\ngenerator = \"grid:64x64:alternating\"\ntranslate = [-0.5, -0.5, 0.15]\n\
                     [[obstacle]]\n{body}position = [0, 0, {:?}]\n[contact]\nself = true\nthickness = 2e-3\n",
                    -below
                );
                let path = std::env::temp_dir().join("cloth-bench-ball.toml");
                std::fs::write(&path, text).expect("a folder for temporary files");
                let scene = scene::file::build(&path, &Settings::default()).expect("a scene");
                let method = Method::find(method).expect("a method");
                let settings = Variant::default_of(method).settings;
                let bytes = size_of_val(&scene.start.positions[..]) * 4 * 20;
                let name = format!("{place}/{}/{shape}", method.name);
                limit::timed(&mut group, &name, bytes, |count| {
                    (0..count)
                        .map(|_| steps_of(&scene, method, &settings))
                        .sum()
                });
            }
        }
    }
}

/// How long 20 steps take, from the start of the scene.
fn steps_of(scene: &Scene, method: &Method, settings: &Settings) -> Duration {
    let solver = method.build(scene, settings, scene.dt);
    let mut solver = solver.expect("a solver");
    let mut contacts = scene.contacts().expect("contact");
    let mut state = scene.start.clone();
    let started = Instant::now();
    for _ in 0..20 {
        let mut input = StepInput::new(scene.dt).gravity(scene.gravity);
        if let Some(contacts) = &mut contacts {
            input = input.contacts(contacts);
        }
        solver.step(&mut state, input).expect("a step");
    }
    started.elapsed()
}

fn main() {
    limit::main(&[steps, flight, bodies]);
}
