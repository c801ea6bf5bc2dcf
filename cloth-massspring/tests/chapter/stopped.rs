//! What contact stops stays stopped, and the rest of the cloth does not notice.

use crate::{DOWN, all, sharp, solver};
use cloth_core::contact::{ContactError, ContactSource, ContactStep};
use cloth_core::energy::Attachment;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_massspring::Bdf2;

const DT: Real = 0.01;

/// A floor at z = 0 for vertex 0, which it stops, and of whose way along it it leaves a half.
#[derive(Default)]
struct Floor {
    /// Velocity (m/s) with which the vertex arrived last, if it touched the floor.
    arrived: Option<Vec3>,
}

impl ContactSource for Floor {
    fn resolve(
        &mut self,
        _step: &ContactStep<'_>,
        positions: &mut [Vec3],
        velocities: &mut [Vec3],
    ) -> Result<(), ContactError> {
        self.arrived = None;
        if positions[0].z < 0.0 {
            positions[0].z = 0.0;
            self.arrived = Some(velocities[0]);
            velocities[0] = Vec3::new(0.5 * velocities[0].x, 0.0, 0.0);
        }
        Ok(())
    }
}

/// A mass that flies at `velocity` (m/s) and comes to the floor in the third step.
fn flight(velocity: Vec3) -> (Particles, State) {
    let particles = Particles::new(vec![0.3]).unwrap();
    let height = -2.5 * DT * velocity.z;
    let mut state = State::at_rest(vec![Vec3::new(0.0, 0.0, height)]);
    state.velocities[0] = velocity;
    (particles, state)
}

#[test]
fn a_vertex_that_is_stopped_does_not_bounce() {
    let (particles, start) = flight(-Vec3::z());
    for mut solver in all(&particles, &[]) {
        let mut state = start.clone();
        let mut floor = Floor::default();
        for step in 1..=6 {
            let input = StepInput::new(DT).contacts(&mut floor);
            solver.step(&mut state, input).unwrap();
            let speed = state.velocities[0].z;
            let expected = if step < 3 { -1.0 } else { 0.0 };
            let name = solver.name();
            assert!(
                (speed - expected).abs() < 1e-13,
                "{name}: {speed} m/s after step {step}"
            );
        }
    }
}

/// Under gravity it comes back to the floor with `g Δt` in every step, whatever it had before,
/// and along the floor with what was left.
/// (Forward Euler moves with the velocity before the step, and comes back in every other step only.)
#[test]
fn a_vertex_at_rest_on_the_floor_falls_by_one_step_of_gravity() {
    let (particles, start) = flight(Vec3::new(0.8, 0.0, -1.0));
    for mut solver in all(&particles, &[]).into_iter().skip(1) {
        let mut state = start.clone();
        let mut floor = Floor::default();
        let mut along = 0.8;
        for step in 1..=12 {
            let input = StepInput::new(DT).gravity(DOWN).contacts(&mut floor);
            solver.step(&mut state, input).unwrap();
            let name = solver.name();
            let arrived = floor.arrived.map_or(state.velocities[0], |v| v);
            assert!(
                (arrived.x - along).abs() < 1e-13,
                "{name}: {arrived} after step {step}"
            );
            if floor.arrived.is_some() {
                along *= 0.5;
            }
            if step > 4 {
                let expected = DOWN.z * DT;
                let error = (arrived.z - expected).abs();
                assert!(error < 1e-13, "{name}: {} m/s after step {step}", arrived.z);
            }
        }
    }
}

/// One mass lies on the floor, another one swings on a spring, and nothing is between them: it loses `z⁴/4` a step, as with
/// BDF2 alone.
#[test]
fn contact_costs_the_rest_of_the_cloth_no_order() {
    let z: Real = 0.05;
    let omega = z / DT;
    let particles = Particles::new(vec![1.0; 2]).unwrap();
    let spring = Attachment {
        vertex: 1,
        target: Vec3::zeros(),
        stiffness: omega * omega,
    };
    let mut solver = solver!(Bdf2, &particles, vec![spring], sharp());
    let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x()]);
    let mut floor = Floor::default();
    let mut swing = |steps| {
        for _ in 0..steps {
            let input = StepInput::new(DT).gravity(DOWN).contacts(&mut floor);
            solver.step(&mut state, input).unwrap();
            assert!(floor.arrived.is_some());
        }
        state.positions[1].x.hypot(state.velocities[1].x / omega)
    };
    // The first step is one of implicit Euler, which loses z²/2.
    let first = swing(40);
    let loss = 1.0 - (swing(400) / first).powf(1.0 / 400.0);
    assert!((loss / (z.powi(4) / 4.0) - 1.0).abs() < 0.02, "{loss:e}");
}
