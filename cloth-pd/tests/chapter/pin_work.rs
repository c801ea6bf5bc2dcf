//! The work of prescribed vertices, in steps that do not converge.

use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::State;
use cloth_core::step::{StepInput, Stepper};
use cloth_pd::{PdConfig, PdSolver};

/// A sheet that is dragged along by one side: its pins move with the constant velocity u. What they do in a step is u
/// times the momentum that the cloth gets, after 3 iterations as after 300, in and across its plane. With the forces of
/// the last iterate it would be off by 120 % after 3.
#[test]
fn work_of_pins_is_their_velocity_times_the_momentum_they_give() {
    let mesh = grid(17, 17, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e4),
        bending_rigidity: 1e-5,
    };
    let mut model = cloth.on(&mesh).unwrap();
    for vertex in (0..mesh.vertex_count()).filter(|&v| mesh.positions()[v].x == 0.0) {
        model.particles.prescribe(vertex).unwrap();
    }
    let dt = 1.0 / 60.0;
    for u in [Vec3::new(0.0, 0.0, 0.3), Vec3::new(-0.3, 0.0, 0.1)] {
        for (iterations, bound) in [(3, 0.02), (300, 3e-3)] {
            let config = PdConfig {
                iterations: Some(iterations),
                ..PdConfig::default()
            };
            let mut solver = PdSolver::builder(&model.particles)
                .config(config)
                .energy(model.springs.clone())
                .energy(model.hinges.clone())
                .build()
                .unwrap();
            let mut state = State::at_rest(mesh.positions().to_vec());
            let momentum = |state: &State| -> Vec3 {
                let particles = &model.particles;
                let free = (0..particles.len()).filter(|&v| !particles.is_prescribed(v));
                free.map(|v| state.velocities[v] * particles.mass()[v])
                    .sum()
            };
            let mut largest: Real = 0.0;
            let mut wrong: Real = 0.0;
            for _ in 0..20 {
                for (v, velocity) in state.velocities.iter_mut().enumerate() {
                    if model.particles.is_prescribed(v) {
                        *velocity = u;
                    }
                }
                let before = momentum(&state);
                let input = StepInput::new(dt);
                let report = solver.step(&mut state, input).unwrap();
                let expected = u.dot(&(momentum(&state) - before));
                let found = report.pin_work.unwrap();
                largest = largest.max(expected.abs());
                wrong = wrong.max((found - expected).abs());
            }
            assert!(
                wrong < bound * largest,
                "{iterations} iterations: {wrong} J of {largest} J"
            );
        }
    }
}
