//! All vertices against all obstacles: contacts for a solver, or impulses at once.

use super::{
    FirstContact, ImpactLaw, Obstacle, ObstacleError, PenaltyLaw, PlanePenalty, VertexPath,
    first_contact, not_negative, positive,
};
use crate::closest::nearest_on_segment;
use crate::error::CollideError;
use cloth_core::math::{Real, Vec3, is_finite};

/// One vertex near an obstacle, as a row for a solver: n·x ≥ `offset` keeps it out, at the end of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleContact {
    /// The vertex.
    pub vertex: u32,
    /// Which obstacle.
    pub obstacle: u32,
    /// Unit normal n, out of the obstacle.
    pub normal: Vec3,
    /// n·x at the thickness from the surface (m), where the surface is at the end of the step.
    pub offset: Real,
    /// Velocity of the surface (m/s), which friction works towards.
    pub surface_velocity: Vec3,
    /// Coefficient of friction (dimensionless).
    pub friction: Real,
}

impl ObstacleContact {
    /// The contact as an element that pushes from `law.range()` (m) beyond the plane on.
    #[must_use]
    pub fn penalty(&self, law: PenaltyLaw) -> PlanePenalty {
        PlanePenalty {
            vertex: self.vertex,
            normal: self.normal,
            offset: self.offset,
            law,
        }
    }
}

/// The obstacles of a scene and how cloth touches them.
///
/// Nothing is built for obstacles, so nothing is rebuilt when they move. With no obstacle in it, every call returns at
/// once; vertices far from all of them cost a comparison with a ball around each.
#[derive(Clone, Debug)]
pub struct ObstacleContacts {
    obstacles: Vec<(Obstacle, ImpactLaw)>,
    thickness: Real,
    margin: Real,
}

impl ObstacleContacts {
    /// No obstacles yet. Vertices are kept at the distance `thickness` (m); a contact is reported from `margin` (m)
    /// beyond that on.
    ///
    /// # Errors
    /// [`ObstacleError::Negative`].
    pub fn new(thickness: Real, margin: Real) -> Result<Self, ObstacleError> {
        Ok(Self {
            obstacles: Vec::new(),
            thickness: not_negative("thickness of the cloth (m)", thickness)?,
            margin: not_negative("margin of contacts (m)", margin)?,
        })
    }

    /// Adds an obstacle and how it is touched.
    #[must_use]
    pub fn with(mut self, obstacle: Obstacle, law: ImpactLaw) -> Self {
        self.obstacles.push((obstacle, law));
        self
    }

    /// The distance at which vertices are kept (m).
    #[must_use]
    pub fn thickness(&self) -> Real {
        self.thickness
    }

    /// The obstacles, in the order in which they were added.
    pub fn obstacles(&self) -> impl Iterator<Item = &Obstacle> + '_ {
        self.obstacles.iter().map(|(obstacle, _)| obstacle)
    }

    /// The same, to move them.
    pub fn obstacles_mut(&mut self) -> impl Iterator<Item = &mut Obstacle> + '_ {
        self.obstacles.iter_mut().map(|(obstacle, _)| obstacle)
    }

    /// Replaces `out` by the contacts of vertices that move from `from` to `to` (m) within `dt` (s), while the
    /// obstacles move from their time 0 on: those that meet an obstacle on the path, and those that end within the
    /// margin. By vertex, then by obstacle.
    ///
    /// The plane of a vertex that meets an obstacle on the path is the tangent plane where they meet, moved on with the
    /// surface until the end of the step. So a vertex that has passed right through a thin obstacle is sent back to the
    /// side that it came from.
    ///
    /// # Errors
    /// [`CollideError::NonFinitePosition`]; `out` is then empty. [`CollideError::InvalidTimeStep`].
    ///
    /// # Panics
    /// If `from` and `to` are not equally long.
    pub fn detect(
        &self,
        from: &[Vec3],
        to: &[Vec3],
        dt: Real,
        out: &mut Vec<ObstacleContact>,
    ) -> Result<(), CollideError> {
        assert_eq!(from.len(), to.len(), "as many ends as starts are needed");
        out.clear();
        if self.obstacles.is_empty() {
            return Ok(());
        }
        positive("time step (s)", dt).map_err(|_| CollideError::InvalidTimeStep { dt })?;
        let ends = from.iter().zip(to);
        if let Some(vertex) = ends
            .clone()
            .position(|(a, b)| !is_finite(a) || !is_finite(b))
        {
            return Err(CollideError::NonFinitePosition { vertex });
        }
        for (vertex, (&from, &to)) in (0..).zip(ends) {
            for number in 0..self.obstacles.len() {
                out.extend(self.contact_of(number, vertex, [from, to], dt));
            }
        }
        Ok(())
    }

    /// The contact of one vertex, on its path between two positions (m), with obstacle `number`; as in
    /// [`ObstacleContacts::detect`].
    pub(crate) fn contact_of(
        &self,
        number: usize,
        vertex: u32,
        path: [Vec3; 2],
        dt: Real,
    ) -> Option<ObstacleContact> {
        let (obstacle, law) = &self.obstacles[number];
        let contact = self.contact(obstacle, path[0], path[1], dt)?;
        Some(ObstacleContact {
            vertex,
            obstacle: number as u32,
            friction: law.friction(),
            ..contact
        })
    }

    /// The obstacles and how they are touched.
    pub(crate) fn pairs(&self) -> &[(Obstacle, ImpactLaw)] {
        &self.obstacles
    }

    fn contact(
        &self,
        obstacle: &Obstacle,
        from: Vec3,
        to: Vec3,
        dt: Real,
    ) -> Option<ObstacleContact> {
        let position = obstacle.motion().pose.position;
        let moved = position + obstacle.motion().velocity * dt;
        if self.out_of_reach(obstacle, [from, to], [position, moved]) {
            return None;
        }
        let path = VertexPath::straight(from, to, dt);
        let hit = first_contact(obstacle, &path, 0.0, dt, self.thickness).or_else(|| {
            let distance = obstacle.signed_distance(to, dt);
            (distance.value <= self.thickness + self.margin).then_some(FirstContact {
                time: dt,
                distance,
                evaluations: 1,
                certain: true,
            })
        })?;
        let position = if hit.time == dt {
            to
        } else {
            path.position(hit.time)
        };
        let normal = hit.distance.normal;
        let surface_velocity = obstacle.velocity_at(position, hit.time);
        let surface = position - normal * hit.distance.value + surface_velocity * (dt - hit.time);
        Some(ObstacleContact {
            vertex: 0,
            obstacle: 0,
            normal,
            offset: normal.dot(&surface) + self.thickness,
            surface_velocity,
            friction: 0.0,
        })
    }

    /// Whether a vertex on the straight path between `ends` (m) stays away from the ball around an obstacle, whose
    /// frame moves between the `places` (m): a few operations that spare most vertices a search in a mesh.
    fn out_of_reach(&self, obstacle: &Obstacle, ends: [Vec3; 2], places: [Vec3; 2]) -> bool {
        let Some(bounds) = obstacle.shape().bounds() else {
            return false;
        };
        let radius = bounds.lower.abs().sup(&bounds.upper.abs()).norm();
        let start = ends[0] - places[0];
        let displacement = ends[1] - places[1] - start;
        let nearest = start + displacement * nearest_on_segment(-start, displacement);
        let size = [ends[0], ends[1], places[0], places[1]].map(|x| x.amax());
        let rounding = 1e-12 * (size.into_iter().fold(radius, Real::max));
        nearest.norm() > radius + self.thickness + self.margin + rounding
    }

    /// The discrete response: every vertex that is nearer than the thickness gets the impulse of the law, and is moved
    /// out to the thickness. At the obstacles' time `time` (s); `inverse_mass` (1/kg), one per vertex, those with 0
    /// stay as they are. Obstacles take turns in their order.
    ///
    /// Moving a vertex out changes no velocity, but its energy by the weight times the displacement. Returns the
    /// impulse (N·s) that the vertices have received in all, and that the obstacles would receive the other way.
    ///
    /// # Errors
    /// [`CollideError::NonFinitePosition`], also for a velocity. Nothing has then been changed.
    ///
    /// # Panics
    /// If the three are not equally long.
    pub fn respond(
        &self,
        positions: &mut [Vec3],
        velocities: &mut [Vec3],
        inverse_mass: &[Real],
        time: Real,
    ) -> Result<Vec3, CollideError> {
        assert_eq!(positions.len(), velocities.len(), "one velocity a vertex");
        assert_eq!(positions.len(), inverse_mass.len(), "one mass a vertex");
        let mut total = Vec3::zeros();
        if self.obstacles.is_empty() {
            return Ok(total);
        }
        let both = positions.iter().zip(velocities.iter());
        if let Some(vertex) = both
            .clone()
            .position(|(x, v)| !is_finite(x) || !is_finite(v))
        {
            return Err(CollideError::NonFinitePosition { vertex });
        }
        for ((x, v), &w) in positions.iter_mut().zip(velocities).zip(inverse_mass) {
            if w == 0.0 {
                continue;
            }
            for (obstacle, law) in &self.obstacles {
                let motion = obstacle.motion();
                let place = motion.pose.position + motion.velocity * time;
                if self.out_of_reach(obstacle, [*x; 2], [place; 2]) {
                    continue;
                }
                let at = obstacle.signed_distance(*x, time);
                if at.value >= self.thickness {
                    continue;
                }
                let surface = obstacle.velocity_at(*x, time);
                let change = law.velocity_change(*v - surface, at.normal);
                *v += change;
                total += change / w;
                *x += at.normal * (self.thickness - at.value);
            }
        }
        Ok(total)
    }
}
