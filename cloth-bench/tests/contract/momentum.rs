//! A free cloth keeps its momentum.

use crate::common::{advance, methods, scene, solver};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{angular_momentum, linear_momentum};

#[test]
fn a_free_cloth_keeps_its_linear_momentum() {
    let scene = scene(
        "drop",
        &["n=12", "gravity=0", "stiffness=1000", "rigidity=1e-4"],
    );
    for method in methods() {
        let mut state = scene.start.clone();
        for (i, (x, v)) in state
            .positions
            .iter_mut()
            .zip(&mut state.velocities)
            .enumerate()
        {
            let phase = i as Real;
            x.z += 0.02 * phase.sin();
            *v = Vec3::new(1.0 + phase.cos(), 0.5 * (2.0 * phase).sin(), -0.3);
        }
        let particles = &scene.model.particles;
        let before = linear_momentum(particles, &state.velocities);
        let turning = angular_momentum(particles, &state);
        advance(&mut *solver(method, &scene), &scene, &mut state, 20);
        let drift = (linear_momentum(particles, &state.velocities) - before).norm() / before.norm();
        // Newton stops at a gradient of 1e-6 of its start; what is left of it is momentum.
        let newton = ["implicit-euler", "implicit-midpoint", "bdf2"].contains(&method.name);
        let bound = if newton { 1e-7 } else { 1e-11 };
        assert!(
            drift < bound,
            "{} lost {drift:e} of its momentum",
            method.name
        );
        // Of the methods here only symplectic Euler keeps the angular momentum as well.
        if matches!(method.name, "symplectic-euler") {
            let drift = (angular_momentum(particles, &state) - turning).norm() / turning.norm();
            assert!(drift < 1e-11, "{} lost {drift:e} of its spin", method.name);
        }
    }
}
