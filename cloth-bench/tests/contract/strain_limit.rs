//! Strain limiting works after a step of any method.

use crate::common::{advance, methods, scene};
use cloth_bench::settings::Settings;
use cloth_core::measure::{Strain, linear_momentum};

#[test]
fn no_method_leaves_a_spring_beyond_the_limit() {
    // So soft that it would stretch by half and more.
    let scene = scene("hang", &["n=8", "stiffness=5"]);
    let limited = ["strain_limit=0.05", "strain_limit_passes=2000"];
    let settings = Settings::parse(&limited).unwrap();
    for method in methods() {
        let run = |settings: &Settings| {
            let mut solver = method.build(&scene, settings, scene.dt).unwrap();
            let mut state = scene.start.clone();
            advance(&mut *solver, &scene, &mut state, 40);
            Strain::of(&scene.model.springs, &state.positions).max
        };
        let stretch = run(&settings);
        assert!(stretch < 0.0502, "{}: {stretch}", method.name);
        assert!(run(&Settings::default()) > 0.2, "{}", method.name);
    }
}

#[test]
fn a_limited_cloth_keeps_its_linear_momentum() {
    let scene = scene("drop", &["n=8", "gravity=0", "stiffness=5"]);
    let settings = Settings::parse(&["strain_limit=0.01"]).unwrap();
    for method in methods() {
        let mut state = scene.start.clone();
        for (i, v) in state.velocities.iter_mut().enumerate() {
            v.x = 1.0 + (i as f64).sin();
        }
        let particles = &scene.model.particles;
        let before = linear_momentum(particles, &state.velocities);
        let mut solver = method.build(&scene, &settings, scene.dt).unwrap();
        advance(&mut *solver, &scene, &mut state, 10);
        let drift = (linear_momentum(particles, &state.velocities) - before).norm() / before.norm();
        let newton = ["implicit-euler", "implicit-midpoint", "bdf2"].contains(&method.name);
        let bound = if newton { 1e-6 } else { 1e-11 };
        assert!(
            drift < bound,
            "{} lost {drift:e} of its momentum",
            method.name
        );
    }
}
