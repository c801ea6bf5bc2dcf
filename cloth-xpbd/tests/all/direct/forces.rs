//! λ is the force of the end of the step.

use crate::direct::{GRAVITY, SYSTEMS, with};
use cloth_core::energy::{Attachment, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::direct::{DirectConfig, DirectXpbd};

/// A rope between two pins, held up in the middle by a soft attachment, half of its links hard. Its links turn
/// from x̃ to x in every step, also at rest.
#[test]
fn two_supports_and_an_attachment_share_the_weight_at_any_step_size() {
    let (links, mass) = (8_u32, 0.05);
    let mut particles = Particles::new(vec![mass; links as usize + 1]).unwrap();
    particles.prescribe(0).unwrap();
    particles.prescribe(links as usize).unwrap();
    let springs = |i: u32| Spring {
        vertices: [i, i + 1],
        rest_length: 0.14,
        stiffness: if i.is_multiple_of(2) {
            400.0
        } else {
            Real::INFINITY
        },
    };
    let held = Attachment {
        vertex: 4,
        target: Vec3::new(0.5, 0.0, 0.0),
        stiffness: 2.0,
    };
    for system in SYSTEMS {
        let builder = DirectXpbd::builder(&particles)
            .energy((0..links).map(springs).collect::<Vec<_>>())
            .energy(vec![held]);
        let config = DirectConfig {
            tolerance: 1e-13,
            ..with(system)
        };
        let mut solver = builder.config(config).build().unwrap();
        let start = |i: u32| {
            Vec3::new(
                Real::from(i) / 8.0,
                0.0,
                -0.01 * Real::from(i * (links - i)),
            )
        };
        let mut state = State::at_rest((0..=links).map(start).collect());
        let h = 0.1;
        for _ in 0..300 {
            let input = StepInput::new(h).gravity(GRAVITY);
            solver.step(&mut state, input).unwrap();
        }
        let mut forces = vec![Vec3::zeros(); links as usize + 1];
        solver.vertex_forces_into(&mut forces);
        let lift = Vec3::new(0.0, 0.0, 9.81 * mass);
        for force in &forces[1..links as usize] {
            let error = (force - lift).norm();
            assert!(error < 1e-10, "{system:?}: {error:e} N");
        }
        let pull = (held.target - state.positions[4]) * held.stiffness;
        let supports = forces[0] + forces[links as usize];
        let error = (supports + lift * 7.0 - pull).norm();
        assert!(error < 1e-9, "{system:?}: {error:e} N");
        let mut multipliers = Vec::new();
        solver.multipliers_into(1, &mut multipliers);
        let attached = Vec3::from_column_slice(&multipliers) / (h * h);
        assert!((attached - pull).norm() < 1e-11, "{system:?}");
    }
}
