//! What held vertices bear, over the parts of a step.

use cloth_core::math::{Real, Vec3};
use cloth_core::particles::Particles;

/// Forces (N), one per vertex, zero where none is held.
#[derive(Debug)]
pub(super) struct PinLoads {
    /// Of the last part of the step, where a method writes those of the elements; and the mean of its parts so far.
    pub(super) part: Vec<Vec3>,
    pub(super) mean: Vec<Vec3>,
}

impl PinLoads {
    pub(super) fn new(vertices: usize) -> Self {
        let zeros = vec![Vec3::zeros(); vertices];
        Self {
            part: zeros.clone(),
            mean: zeros,
        }
    }

    pub(super) fn begin_step(&mut self) {
        self.mean.fill(Vec3::zeros());
    }

    /// Adds to a part the weight of the held vertices themselves, and the load (N) on them.
    pub(super) fn add_weight(
        &mut self,
        particles: &Particles,
        gravity: Vec3,
        load: Option<&[Vec3]>,
    ) {
        for (v, force) in self.part.iter_mut().enumerate() {
            if particles.is_prescribed(v) {
                *force += gravity * particles.mass()[v];
                *force += load.map_or(Vec3::zeros(), |load| load[v]);
            }
        }
    }

    /// Adds a part that is so much of the step.
    pub(super) fn add(&mut self, share: Real) {
        for (mean, part) in self.mean.iter_mut().zip(&self.part) {
            *mean += part * share;
        }
    }
}
