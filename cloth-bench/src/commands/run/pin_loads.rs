//! The table of `--pin-loads`: what held vertices bear in every step.

use crate::run::Moment;
use cloth_core::math::Vec3;
use std::fmt::Write as _;

/// As CSV: in each step a row for each held vertex, and one, `all`, for their sum.
pub(super) struct PinLoadsTable(String);

impl Default for PinLoadsTable {
    fn default() -> Self {
        Self("step,time (s),vertex,force x (N),force y (N),force z (N)\n".into())
    }
}

impl PinLoadsTable {
    /// Adds the rows of a step, if its forces are recorded.
    pub(super) fn add(&mut self, moment: &Moment<'_>) {
        let particles = &moment.scene.model.particles;
        let loads = moment.pin_loads.unwrap_or_default();
        let mut sum = Vec3::zeros();
        for (vertex, load) in loads.iter().enumerate() {
            if particles.is_prescribed(vertex) {
                self.row(moment, &vertex.to_string(), load);
                sum += load;
            }
        }
        self.row(moment, "all", &sum);
    }

    fn row(&mut self, moment: &Moment<'_>, vertex: &str, load: &Vec3) {
        let (step, time) = (moment.step, moment.state.time);
        let [x, y, z] = [load.x, load.y, load.z];
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "{step},{time:?},{vertex},{x:?},{y:?},{z:?}");
    }

    /// Whether no step has been added.
    pub(super) fn is_empty(&self) -> bool {
        self.0.lines().nth(1).is_none()
    }

    pub(super) fn text(&self) -> &str {
        &self.0
    }
}
