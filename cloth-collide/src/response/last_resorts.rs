//! What impulses leave: zones that move as rigid bodies, then vertices that are held back.

use super::zones::{make_velocities_rigid, move_rigidly};
use super::{ClothContacts, ContactStage, MOST_ZONE_ROUNDS};
use cloth_core::contact::{ContactError, ContactStep};
use cloth_core::math::Vec3;

impl ClothContacts {
    /// Zones that move as one, and what is left of that held back.
    pub(super) fn last_resorts(
        &mut self,
        step: &ContactStep<'_>,
        positions: &mut [Vec3],
        velocities: &mut [Vec3],
    ) -> Result<(), ContactError> {
        self.move_zones(step, positions)?;
        for zone in self.zones.each() {
            make_velocities_rigid(zone, positions, velocities, step.inverse_mass);
        }
        self.report.zones = self.zones.each().count();
        self.report.largest_zone = self.zones.each().map(<[_]>::len).max().unwrap_or(0);
        if self.is_free() {
            return Ok(());
        }
        self.solved.copy_from_slice(positions);
        self.hold_back(step, positions)?;
        for ((v, x), solved) in velocities.iter_mut().zip(positions).zip(&self.solved) {
            *v += (*x - solved) / step.dt;
        }
        Ok(())
    }

    /// Grows zones until no two pieces of cloth pass through each other, or none is left to join.
    fn move_zones(
        &mut self,
        step: &ContactStep<'_>,
        positions: &mut [Vec3],
    ) -> Result<(), ContactError> {
        self.zones.reset(self.vertex_count);
        self.solved.copy_from_slice(positions);
        for _ in 0..MOST_ZONE_ROUNDS {
            let Some(cloth) = self.cloth.as_ref().filter(|_| !self.hits.is_empty()) else {
                break;
            };
            let pairs = self.hits.iter().map(|&hit| cloth.pair(hit).vertices);
            let joined = pairs.filter(|&pair| self.zones.join(pair)).count();
            if joined == 0 {
                break;
            }
            self.report.stage = ContactStage::Zones;
            self.zones.sort();
            positions.copy_from_slice(&self.solved);
            for zone in self.zones.each() {
                move_rigidly(
                    zone,
                    step.from,
                    positions,
                    &mut self.ways,
                    step.inverse_mass,
                );
            }
            self.after_a_change(step, positions)?;
            self.find(step, positions, None);
        }
        Ok(())
    }

    /// Holds vertices back until nothing passes through anything.
    fn hold_back(
        &mut self,
        step: &ContactStep<'_>,
        positions: &mut [Vec3],
    ) -> Result<(), ContactError> {
        self.report.stage = ContactStage::Held;
        self.hold.start(self.cloth.as_ref(), step);
        while !self.is_free() {
            let mut vertex = 0;
            let mut newly_held = 0;
            if let Some(cloth) = &self.cloth {
                for &hit in &self.hits {
                    let vertices = cloth.pair(hit).vertices;
                    vertex = vertices[0];
                    newly_held += self.hold.pair(vertices, step, positions);
                }
            }
            for &[entering, _] in &self.entering {
                vertex = entering;
                newly_held += self.hold.stop(vertex, step, positions);
            }
            if newly_held == 0 {
                return Err(ContactError::NoWay { vertex });
            }
            let searches = self.report.searches;
            self.after_a_change(step, positions)?;
            if self.report.searches > searches {
                self.hold.learn(self.cloth.as_ref(), step);
            }
            self.find(step, positions, None);
        }
        self.report.held = self.hold.count();
        self.report.smallest_share = self.hold.smallest_share();
        Ok(())
    }
}
