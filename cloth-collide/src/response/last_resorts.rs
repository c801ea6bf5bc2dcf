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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::obstacle::{HalfSpace, ImpactLaw, Obstacle, ObstacleContacts, Pose, RigidMotion};
    use crate::random::Random;
    use cloth_core::contact::ContactSource;
    use cloth_core::mesh::TriMesh;
    use cloth_core::mesh::generate::{Diagonals, grid};

    /// What has moved as one body goes on as one: no two of its vertices come nearer to each other or go apart. Vertices that the floor or the roof then keeps from
    /// going with their zone are held back, and lose the velocity that would have taken them the rest of the way.
    #[test]
    fn zones_end_with_the_velocities_of_rigid_bodies() {
        let law = ImpactLaw::new(0.3, 0.0).unwrap();
        let wall = |height: f64, up: f64| {
            let still = RigidMotion::still(Pose::at(Vec3::z() * height));
            Obstacle::moving(HalfSpace::new(Vec3::z() * up).unwrap(), still).unwrap()
        };
        let sheet = grid(4, 4, 0.3, 0.3, Diagonals::Alternating).unwrap();
        let layers = (0..3).flat_map(|k| {
            let up = Vec3::new(0.01, 0.02, 0.05) * f64::from(k);
            sheet.positions().iter().map(move |x| x + up)
        });
        let triangles = (0..3u32).flat_map(|k| {
            let of_layer = move |t: &[u32; 3]| t.map(|v| v + 16 * k);
            sheet.triangles().iter().map(of_layer)
        });
        let mesh = TriMesh::new(layers.collect(), triangles.collect()).unwrap();
        let inverse_mass: Vec<_> = (0..48).map(|v| 1.0 + 0.1 * f64::from(v)).collect();
        let (mut moved, mut held, mut stages) = (0, 0, Vec::new());
        for seed in 0..6 {
            let mut random = Random::new(seed);
            let room = ObstacleContacts::new(5e-3, 5e-3).unwrap();
            let room = room.with(wall(-0.1, 1.0), law).with(wall(0.2, -1.0), law);
            let builder = ClothContacts::builder(&mesh).thickness(5e-3).friction(0.3);
            let mut contacts = builder.obstacles(room).build().unwrap();
            let mut positions = mesh.positions().to_vec();
            for _ in 0..10 {
                let from = positions.clone();
                let step = ContactStep {
                    from: &from,
                    inverse_mass: &inverse_mass,
                    dt: 0.03,
                };
                // Drawn together, far beyond what impulses can settle.
                let middle = from.iter().sum::<Vec3>() / 48.0;
                let thrown = |x: &Vec3| random.point(3e3) + (middle - x) * 6e3;
                let mut velocities: Vec<_> = from.iter().map(thrown).collect();
                let ways = positions.iter_mut().zip(&velocities);
                ways.for_each(|(x, v)| *x += v * step.dt);
                contacts
                    .resolve(&step, &mut positions, &mut velocities)
                    .unwrap();
                stages.push(contacts.report.stage);
                match contacts.report.stage {
                    ContactStage::Zones => moved += look_at(&contacts, &positions, &velocities),
                    ContactStage::Held => {
                        let back = contacts.solved.iter().zip(&positions);
                        let with_zone = velocities.iter().zip(back);
                        let with_zone = with_zone.map(|(v, (to, x))| v + (to - x) / step.dt);
                        let with_zone: Vec<_> = with_zone.collect();
                        held += look_at(&contacts, &contacts.solved, &with_zone);
                    }
                    _ => {}
                }
            }
        }
        assert!(moved > 100 && held > 100, "{moved}, {held}, {stages:?}");
    }

    /// How many pairs of vertices are in one zone; none of them changes its distance.
    fn look_at(contacts: &ClothContacts, positions: &[Vec3], velocities: &[Vec3]) -> usize {
        let mut pairs = 0;
        for zone in contacts.zones.each() {
            for [_, a] in zone {
                for [_, b] in zone {
                    let [a, b] = [*a as usize, *b as usize];
                    let apart = positions[a] - positions[b];
                    let rate = apart.dot(&(velocities[a] - velocities[b]));
                    assert!(rate.abs() < 1e-8, "{rate:e} m²/s");
                    pairs += 1;
                }
            }
        }
        pairs
    }
}
