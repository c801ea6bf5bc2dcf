//! The table of `--forces`: what the cloth does to every body in every step.

use crate::run::Moment;
use cloth_core::math::Vec3;
use std::fmt::Write as _;

/// As CSV: a row for each step and body. Bodies are numbered from 0 in the order of the `[[obstacle]]` tables of a
/// scene file, animations among them, and come in this order. The force is the sum of its normal and its friction.
pub(super) struct ForcesTable(String);

impl Default for ForcesTable {
    fn default() -> Self {
        let columns = ["force", "torque", "normal", "friction"].map(|name| {
            let unit = if name == "torque" { "N m" } else { "N" };
            ["x", "y", "z"].map(|axis| format!("{name} {axis} ({unit})"))
        });
        let columns = columns.as_flattened().join(",");
        Self(format!("step,time (s),body,{columns}\n"))
    }
}

impl ForcesTable {
    /// Adds the rows of a step, if its forces are recorded.
    pub(super) fn add(&mut self, moment: &Moment<'_>) {
        let (Some(forces), Some(touch)) = (moment.forces, &moment.scene.touch) else {
            return;
        };
        let (step, time) = (moment.step, moment.state.time);
        let mut rows: Vec<_> = touch.body_numbers().iter().zip(&forces.bodies).collect();
        rows.sort_by_key(|(number, _)| **number);
        for (number, body) in rows {
            let vectors: [Vec3; 4] = [body.force, body.torque, body.normal(), body.friction];
            // Writing to a string cannot fail.
            let _ = write!(self.0, "{step},{time:?},{number}");
            for component in vectors.iter().flat_map(Vec3::iter) {
                let _ = write!(self.0, ",{component:?}");
            }
            self.0.push('\n');
        }
    }

    /// Whether no step has been added.
    pub(super) fn is_empty(&self) -> bool {
        self.0.lines().nth(1).is_none()
    }

    pub(super) fn text(&self) -> &str {
        &self.0
    }
}
