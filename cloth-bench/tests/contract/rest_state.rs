//! What is at rest stays at rest; what is held stays held; what is driven follows.

use crate::common::{advance, methods, scene, solver};
use cloth_core::math::{Real, Vec3};
use cloth_core::pin::Pins;
use cloth_core::step::StepInput;

#[test]
fn a_sheet_without_forces_stays_at_rest() {
    let scene = scene("hang", &["n=15", "gravity=0"]);
    for method in methods() {
        let mut state = scene.start.clone();
        advance(&mut *solver(method, &scene), &scene, &mut state, 20);
        let moved = state
            .positions
            .iter()
            .zip(&scene.start.positions)
            .map(|(a, b)| (a - b).norm());
        let moved = moved.fold(0.0, Real::max);
        assert!(moved < 1e-13, "{} moved by {moved:e} m", method.name);
    }
}

#[test]
fn held_vertices_do_not_move_by_a_bit() {
    let scene = scene("hang", &["n=9"]);
    for method in methods() {
        let mut state = scene.start.clone();
        advance(&mut *solver(method, &scene), &scene, &mut state, 10);
        for v in 0..state.positions.len() {
            if scene.model.particles.is_prescribed(v) {
                assert_eq!(
                    state.positions[v], scene.start.positions[v],
                    "{}",
                    method.name
                );
            }
        }
    }
}

#[test]
fn driven_vertices_are_on_their_path_after_every_step() {
    let mut scene = scene("hang", &["n=9"]);
    let centre = scene.start.positions[8];
    let path =
        move |t: Real| centre + Vec3::new(0.1 * (3.0 * t).sin(), 0.0, 0.1 - 0.1 * (3.0 * t).cos());
    let mut pins = Pins::new();
    pins.add_path(&mut scene.model.particles, 8, path).unwrap();
    for method in methods() {
        let mut solver = solver(method, &scene);
        let mut state = scene.start.clone();
        for _ in 0..10 {
            pins.set_velocities(&mut state, scene.dt).unwrap();
            solver
                .step(&mut state, StepInput::new(scene.dt).gravity(scene.gravity))
                .unwrap();
            let off = (state.positions[8] - path(state.time)).norm();
            assert!(off < 1e-14, "{} is {off:e} m off the path", method.name);
        }
    }
}
