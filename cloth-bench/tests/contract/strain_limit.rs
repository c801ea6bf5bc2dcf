//! Strain limiting works after a step of any method.

use crate::common::{advance, methods, scene, solver};
use cloth_bench::settings::Settings;
use cloth_core::element::{Constraint, Element};
use cloth_core::energy::{ArapTriangle, AreaTriangle};
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::measure::{Strain, angular_momentum, linear_momentum};
use cloth_core::step::Outcome;
use cloth_pbd::{StrainLimiter, StretchRange};

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

/// Principal stretches, so in every direction, and areas.
#[test]
fn no_method_leaves_a_triangle_beyond_the_limit() {
    let scene = scene("hang", &["n=8", "stiffness=5"]);
    let mesh = scene.mesh.as_ref().unwrap();
    let stretches = ArapTriangle::on(mesh, 1.0);
    let areas = AreaTriangle::on(mesh, 1.0);
    let worst_stretch = |x: &[Vec3]| {
        let rows = stretches.iter().map(|t| t.rows(&gather(x, t.vertices())));
        rows.flatten().map(|row| row.value).fold(0.0, Real::max)
    };
    let worst_area = |x: &[Vec3]| {
        let grown = areas.iter().map(|t| {
            let row = t.rows(&gather(x, t.vertices()))[0];
            row.value / t.rest_area
        });
        grown.fold(0.0, Real::max)
    };
    for method in methods() {
        let run = |of: &str| {
            let settings = Settings::default()
                .with("strain_limit", 0.05)
                .with("strain_limit_of", of)
                .with("strain_limit_passes", 4000);
            let mut solver = method.build(&scene, &settings, scene.dt).unwrap();
            let mut state = scene.start.clone();
            advance(&mut *solver, &scene, &mut state, 20);
            state.positions
        };
        let stretch = worst_stretch(&run("triangles"));
        assert!(stretch < 0.0502, "{}: {stretch}", method.name);
        let x = run("areas");
        let area = worst_area(&x);
        assert!(area < 0.0502, "{}: {area}", method.name);
        assert!(worst_stretch(&x) > 0.06, "{}: shear is free", method.name);
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

/// Whatever the method makes of the momenta, the limiter after its step changes neither.
#[test]
fn limiting_keeps_both_momenta_to_round_off_after_a_step_of_any_method() {
    let scene = scene("drop", &["n=8", "gravity=0", "stiffness=5"]);
    let particles = &scene.model.particles;
    for method in methods() {
        let mut state = scene.start.clone();
        for (i, (x, v)) in state
            .positions
            .iter()
            .zip(&mut state.velocities)
            .enumerate()
        {
            let phase = i as Real;
            let shaken = Vec3::new(phase.sin(), (1.7 * phase).cos(), (0.6 * phase).sin());
            *v = Vec3::new(1.0, 0.3, -0.2) + Vec3::new(0.5, 1.0, 2.0).cross(x) + shaken;
        }
        let mut solver = solver(method, &scene);
        let builder = StrainLimiter::builder(particles).max_passes(2000);
        let range = StretchRange::stretch(0.01);
        let mut limiter = builder
            .springs(&scene.model.springs, range)
            .build()
            .unwrap();
        let mut passes = 0;
        for _ in 0..10 {
            advance(&mut *solver, &scene, &mut state, 1);
            let linear = linear_momentum(particles, &state.velocities);
            let angular = angular_momentum(particles, &state);
            let report = limiter.apply(&mut state, scene.dt).unwrap();
            assert_eq!(report.outcome, Outcome::Converged, "{}", method.name);
            passes += report.passes - 1;
            // What the momenta are sums of.
            let parts = || state.positions.iter().zip(&state.velocities);
            let parts = || parts().zip(particles.mass());
            let size: Real = parts().map(|((_, v), m)| m * v.norm()).sum();
            let error = (linear_momentum(particles, &state.velocities) - linear).norm() / size;
            assert!(error < 1e-14, "{}: linear {error:e}", method.name);
            let size: Real = parts().map(|((x, v), m)| m * x.norm() * v.norm()).sum();
            let error = (angular_momentum(particles, &state) - angular).norm() / size;
            assert!(error < 1e-14, "{}: angular {error:e}", method.name);
        }
        assert!(passes > 20, "{} was hardly limited", method.name);
    }
}
