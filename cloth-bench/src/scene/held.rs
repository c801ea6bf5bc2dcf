//! Vertices that are held, and go where they or a body are told to.

use super::Scene;
use crate::error::BenchError;
use cloth_core::particles::State;
use cloth_core::pin::PinMotion;
use std::sync::Arc;

/// How held vertices move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeldMotion {
    /// By themselves.
    Own(PinMotion),
    /// With a body of this number in the scene, from where they are.
    With(usize),
}

impl Scene {
    /// Holds these vertices, which are in this state, from now on.
    pub(super) fn hold(
        &mut self,
        vertices: &[usize],
        motion: HeldMotion,
        state: &State,
    ) -> Result<(), BenchError> {
        let mut pins = self.pins.as_deref().cloned().unwrap_or_default();
        for &vertex in vertices {
            let (start, since) = (state.positions[vertex], state.time);
            let particles = &mut self.model.particles;
            let held = match motion {
                HeldMotion::Own(motion) => {
                    let path = move |time| motion.position(start, since, time);
                    pins.add_path(particles, vertex, path)
                }
                HeldMotion::With(body) => {
                    let touch = self.touch.as_ref();
                    let path = touch.map(|touch| touch.path(body, start, since));
                    let nothing = || BenchError::Failed(format!("there is no obstacle {body}"));
                    pins.add_path(particles, vertex, path.ok_or_else(nothing)??)
                }
            };
            held.map_err(BenchError::failed)?;
        }
        self.carried
            .retain(|(vertex, _)| !vertices.contains(vertex));
        if let HeldMotion::With(body) = motion {
            self.carried
                .extend(vertices.iter().map(|&vertex| (vertex, body)));
        }
        self.pins = Some(Arc::new(pins)).filter(|pins| !pins.is_empty());
        Ok(())
    }

    /// Lets the vertices that a body takes along go on with it: it has other velocities from now on.
    pub(super) fn carry_on(&mut self, body: usize, state: &State) -> Result<(), BenchError> {
        let carried = self.carried.iter().filter(|(_, own)| *own == body);
        let vertices: Vec<usize> = carried.map(|(vertex, _)| *vertex).collect();
        self.hold(&vertices, HeldMotion::With(body), state)
    }
}
