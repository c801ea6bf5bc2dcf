//! What loads a cloth besides its own weight.

use super::{ChangeKind, Scene};
use crate::error::BenchError;
use cloth_collide::obstacle::Obstacle;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

impl Scene {
    /// The largest tension (N/m) that lasts: by what is inside of closed pieces, where the cloth starts, or by forces,
    /// wind, masses beside its own and bodies that come to hang in it, as far as they are more than its own weight.
    ///
    /// A force F goes through the edges at the vertices on which it acts, and through those at the vertices that are
    /// held. If the fewer of them are n, and edges are l long, that is `F/(n l)`. Cloth that is held whole counts as
    /// loaded whole: it may be let go later.
    pub fn lasting_tension(&self) -> Result<Real, BenchError> {
        let x = &self.start.positions;
        let gases = self.gases.iter().map(|gas| gas.tension(x));
        let all = gases.chain(self.volumes.iter().map(|volume| volume.tension(x)));
        let blown = all.fold(0.0, Real::max);
        let particles = &self.model.particles;
        let free = particles.free_count();
        let held = match particles.len() - free + self.model.soft_pins().count() {
            // On a fold or a rim of some √V vertices.
            0 => (free as Real).sqrt(),
            held => held as Real,
        };
        let loaded = match free {
            0 => particles.len(),
            free => free,
        };
        let gravity = self.gravity.norm();
        let pushes = self.changes.iter().filter_map(|change| match &change.kind {
            ChangeKind::Push {
                vertices, force, ..
            } => Some((vertices.len(), force.norm())),
            _ => None,
        });
        let masses = self.added_masses.iter().map(|(vertices, mass)| {
            let moving = vertices.iter().filter(|v| !particles.is_prescribed(**v));
            let moving = moving.count();
            (moving, mass * moving as Real / vertices.len() as Real)
        });
        let masses: Vec<_> = masses.filter(|(n, _)| *n > 0).collect();
        let weights = masses.iter().map(|&(n, mass)| (n, mass * gravity));
        let area = self.mesh.iter().flat_map(TriMesh::areas).sum::<Real>();
        let wind = self
            .air
            .as_ref()
            .map(|air| (loaded, air.largest_pressure() * area));
        let (mut force, mut along) = (0.0, 0.0);
        let bodies = self.touch.iter().flat_map(|touch| touch.free_bodies());
        let bodies = bodies.filter(|_| self.can_carry());
        let bodies = bodies.map(|(_, body)| (loaded, body.mass() * gravity));
        for (vertices, newtons) in pushes.chain(weights).chain(bodies).chain(wind) {
            force += newtons;
            along += newtons / held.min(vertices as Real);
        }
        let added = masses.iter().map(|(_, mass)| mass).sum::<Real>();
        let whole = particles.mass().iter().zip(particles.inverse_mass());
        let whole = whole.filter(|(_, w)| **w > 0.0).map(|(m, _)| m);
        let beyond = force - gravity * (whole.sum::<Real>() - added);
        if beyond <= 0.0 {
            return Ok(blown);
        }
        let lengths = self.gauges()?;
        let lengths = lengths.iter().map(|spring| spring.rest_length);
        let (count, sum) = lengths.fold((0.0, 0.0), |(n, sum), l| (n + 1.0, sum + l));
        Ok(blown.max(along * (beyond / force) * count / sum))
    }

    /// Whether bodies can hang in the cloth: not if nothing holds it, and nothing is below but floors and tables, on which
    /// they come to lie.
    fn can_carry(&self) -> bool {
        let touch = self.touch.iter();
        let mut stands = touch.flat_map(|touch| touch.standing_obstacles());
        self.model.particles.free_count() < self.model.particles.len()
            || self.model.soft_pins().next().is_some()
            || !self.changes.is_empty()
            || !self.gases.is_empty()
            || !self.volumes.is_empty()
            || !stands.all(|o| self.is_below_all(o))
    }

    /// Whether all of the cloth starts above a level side of the obstacle.
    fn is_below_all(&self, obstacle: &Obstacle) -> bool {
        let level = (1.0 - 1e-9) * self.gravity.norm();
        let up = |x: &Vec3| obstacle.signed_distance(*x, 0.0).normal;
        let mut all = self.start.positions.iter();
        all.all(|x| -up(x).dot(&self.gravity) >= level)
    }
}
