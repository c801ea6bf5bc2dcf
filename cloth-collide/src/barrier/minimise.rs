//! The minimiser: Newton steps that never leave the safe set.

use super::guard::{Interval, Motion, visit_cloth, visit_obstacles};
use super::newton::NewtonSystem;
use super::terms::{Surroundings, Terms};
use crate::broad_phase::{ClothCandidates, Hierarchy};
use crate::error::CollideError;
use crate::obstacle::{Obstacle, RigidMotion};
use cloth_core::element::Convexity;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::step::Outcome;

/// F(x) = ½ Σ m/Δt² ‖x − y‖² + Σ A b(d), and a point x that is safe.
#[derive(Debug)]
pub(super) struct Minimiser {
    pub(super) terms: Terms,
    /// None without self-collision.
    candidates: Option<ClothCandidates<Hierarchy>>,
    system: NewtonSystem,
    /// Where the cloth is, x (m).
    pub(super) x: Vec<Vec3>,
    /// Where it would be without contact, y (m); where prescribed vertices have to be.
    pub(super) aim: Vec<Vec3>,
    /// m/Δt² (N/m), zero for prescribed vertices.
    pub(super) weight: Vec<Real>,
    inverse_mass: Vec<Real>,
    /// The obstacles, and copies that stand where they are now.
    pub(super) obstacles: Vec<Obstacle>,
    standing: Vec<Obstacle>,
    thickness: Real,
    /// Time (s) on the clocks of the obstacles.
    now: Real,
    p: Vec<Vec3>,
    to: Vec<Vec3>,
    gradient: Vec<Vec3>,
    pub(super) counts: Counts,
}

/// What the minimiser has done in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Counts {
    pub(super) newton_steps: u32,
    pub(super) capped_steps: u32,
    pub(super) rounds: u32,
}

/// A part of a step that is free of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Safe {
    /// How much of it (dimensionless, 0..=1).
    part: Real,
    /// A vertex of what comes next, if something does.
    vertex: Option<u32>,
}

/// Why there is no next point.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Stuck {
    /// At this vertex.
    NoWay(u32),
    /// Coordinates have grown beyond what the continuous test takes.
    Bad(CollideError),
}

impl From<CollideError> for Stuck {
    fn from(error: CollideError) -> Self {
        Self::Bad(error)
    }
}

/// Part of the decrease that the slope promises, with which a step is content.
const SUFFICIENT: Real = 1e-4;
/// A promised decrease below this part of the energy is not seen in it.
const UNSEEN: Real = 1e-10;
const MOST_HALVINGS: u32 = 50;

impl Minimiser {
    pub(super) fn new(mesh: &TriMesh, terms: Terms, self_collision: bool, thickness: Real) -> Self {
        let zeros = vec![Vec3::zeros(); mesh.vertex_count()];
        Self {
            terms,
            candidates: self_collision.then(|| ClothCandidates::new(mesh, Hierarchy::new())),
            system: NewtonSystem::new(mesh.vertex_count()),
            x: zeros.clone(),
            aim: zeros.clone(),
            weight: vec![0.0; mesh.vertex_count()],
            inverse_mass: vec![0.0; mesh.vertex_count()],
            obstacles: Vec::new(),
            standing: Vec::new(),
            thickness,
            now: 0.0,
            p: zeros.clone(),
            to: zeros.clone(),
            gradient: zeros,
            counts: Counts::default(),
        }
    }

    /// Starts at `from` (m), with the aim `aim` (m); `inverse_mass` in 1/kg, `dt` in s.
    pub(super) fn begin(
        &mut self,
        from: &[Vec3],
        aim: &[Vec3],
        inverse_mass: &[Real],
        dt: Real,
    ) -> Result<(), Stuck> {
        self.x.copy_from_slice(from);
        self.aim.copy_from_slice(aim);
        self.inverse_mass.copy_from_slice(inverse_mass);
        self.terms.set_free(inverse_mass);
        for (weight, w) in self.weight.iter_mut().zip(inverse_mass) {
            *weight = if *w > 0.0 { 1.0 / (w * dt * dt) } else { 0.0 };
        }
        self.counts = Counts::default();
        self.set_time(0.0)?;
        self.to.copy_from_slice(from);
        self.sweep()
    }

    /// Looks for all pairs that can come within the range on the way from x to `to`. What all vertices have in common of the motion changes no pair, and
    /// is left out, or the boxes of a fast cloth would all overlap.
    fn sweep(&mut self) -> Result<(), Stuck> {
        let Some(candidates) = &mut self.candidates else {
            return Ok(());
        };
        let way = |(x, to): (&Vec3, &Vec3)| to - x;
        let sum: Vec3 = self.x.iter().zip(&self.to).map(way).sum();
        let common = sum / self.x.len() as Real;
        for (to, x) in self.p.iter_mut().zip(&self.to) {
            *to = x - common;
        }
        candidates.update(&self.x, &self.p, self.terms.range())?;
        self.terms.take_pairs(candidates, &self.inverse_mass);
        Ok(())
    }

    /// Hands `visit` the vertices of all that comes too near on the way from x to `to`, and when; obstacles move as in `when`, or stand still.
    fn visit_near(
        &self,
        when: Option<Interval>,
        mut visit: impl FnMut(&[u32], Real),
    ) -> Result<(), Stuck> {
        let motion = Motion {
            from: &self.x,
            to: &self.to,
            range: self.terms.range(),
        };
        if let Some(candidates) = &self.candidates {
            visit_cloth(motion, candidates, &mut visit)?;
        }
        let still = Interval {
            start: 0.0,
            duration: 1.0,
        };
        let (obstacles, when) = match when {
            Some(when) => (&self.obstacles, when),
            None => (&self.standing, still),
        };
        visit_obstacles(motion, obstacles, when, self.thickness, &self.weight, visit);
        Ok(())
    }

    /// How far the way from x to `to` is safe.
    fn cap(&self, when: Option<Interval>) -> Result<Safe, Stuck> {
        let mut safe = Safe {
            part: 1.0,
            vertex: None,
        };
        self.visit_near(when, |vertices, part| {
            if part < safe.part {
                (safe.part, safe.vertex) = (part, Some(vertices[0]));
            }
        })?;
        Ok(safe)
    }

    /// ∂F · (to − x) (J).
    fn slope(&self) -> Real {
        let ways = self.to.iter().zip(&self.x).zip(&self.gradient);
        let free = ways.zip(&self.weight).filter(|(_, w)| **w > 0.0);
        free.map(|(((to, x), g), _)| g.dot(&(to - x))).sum()
    }

    /// Takes the obstacles to be where they are at `time` (s).
    fn set_time(&mut self, time: Real) -> Result<(), Stuck> {
        self.now = time;
        self.standing.clear();
        self.standing.extend(self.obstacles.iter().cloned());
        for obstacle in &mut self.standing {
            let pose = obstacle.motion().pose_at(time);
            obstacle
                .set_motion(RigidMotion::still(pose))
                .map_err(|_| CollideError::TooFarApart)?;
        }
        Ok(())
    }

    /// A vertex of what is not in the safe set, if something is not.
    pub(super) fn not_safe(&self) -> Option<u32> {
        self.terms.first_touching(&self.x, self.around())
    }

    /// Pairs and touches that push at the last linearisation.
    pub(super) fn contact_count(&self) -> usize {
        self.terms.pairs.len() + self.terms.touches.len()
    }

    fn around(&self) -> Surroundings<'_> {
        Surroundings {
            obstacles: &self.obstacles,
            time: self.now,
        }
    }

    /// F at `positions` (m), in J.
    fn energy(&self, positions: &[Vec3]) -> Real {
        let ends = positions.iter().zip(&self.aim).zip(&self.weight);
        let inertia: Real = ends
            .map(|((x, y), w)| 0.5 * w * (x - y).norm_squared())
            .sum();
        inertia + self.barriers(positions)
    }

    /// Energy of the barriers alone (J), infinite if something is not safe.
    pub(super) fn barriers(&self, positions: &[Vec3]) -> Real {
        self.terms.energy(positions, self.around())
    }

    /// ∂F/∂x at `positions` (N), with the Hessians of the barriers.
    fn linearise(&mut self, convexity: Convexity) {
        let ends = self.x.iter().zip(&self.aim).zip(&self.weight);
        for (g, ((x, y), w)) in self.gradient.iter_mut().zip(ends) {
            *g = (x - y) * *w;
        }
        let around = Surroundings {
            obstacles: &self.obstacles,
            time: self.now,
        };
        self.terms
            .linearise(&self.x, around, convexity, &mut self.gradient);
    }

    /// The Newton direction p; `given` sets it for the prescribed vertices, and changes the gradient for what else is known to happen. With the true Hessian if
    /// that is positive, otherwise with only the convex part of each pair.
    fn direct(&mut self, given: impl Fn(&mut Self)) {
        for convexity in [Convexity::Exact, Convexity::Clamp] {
            self.linearise(convexity);
            self.p.fill(Vec3::zeros());
            given(self);
            let Self {
                system,
                terms,
                weight,
                gradient,
                p,
                ..
            } = self;
            if system.solve(terms, weight, gradient, p, convexity) {
                break;
            }
        }
    }

    /// Steps towards the minimum until none is longer than `accuracy` (m), or for at most `most` steps.
    pub(super) fn relax(&mut self, accuracy: Real, most: u32) -> Result<Outcome, Stuck> {
        for _ in 0..most {
            if self.barriers(&self.x) == 0.0 && self.is_at_aim() {
                return Ok(Outcome::Converged);
            }
            self.direct(|_| {});
            let longest = self.p.iter().map(Vec3::amax).fold(0.0, Real::max);
            let ends = self.to.iter_mut().zip(&self.x).zip(&self.p);
            for ((to, x), p) in ends {
                *to = x + p;
            }
            // Exactly the aim, where there is nothing in between.
            if self.terms.pairs.is_empty() && self.terms.touches.is_empty() {
                let free = self.to.iter_mut().zip(&self.aim).zip(&self.weight);
                free.filter(|(_, w)| **w > 0.0)
                    .for_each(|((to, y), _)| *to = *y);
            }
            let slope = self.slope();
            self.sweep()?;
            let safe = self.cap(None)?;
            self.counts.newton_steps += 1;
            self.counts.capped_steps += u32::from(safe.part < 1.0);
            let moved = self.descend(safe.part, slope);
            if !moved || (longest <= accuracy && safe.part == 1.0) {
                return Ok(if longest <= accuracy {
                    Outcome::Converged
                } else {
                    Outcome::BudgetSpent
                });
            }
        }
        Ok(Outcome::BudgetSpent)
    }

    fn is_at_aim(&self) -> bool {
        let ends = self.x.iter().zip(&self.aim).zip(&self.weight);
        ends.filter(|(_, w)| **w > 0.0).all(|((x, y), _)| x == y)
    }

    /// Goes from x towards `to`, by at most `part` of the way and by so much less that F falls. Whether it could. `slope` is that of F along the whole way (J).
    fn descend(&mut self, part: Real, slope: Real) -> bool {
        let before = self.energy(&self.x);
        let mut part = part;
        for _ in 0..MOST_HALVINGS {
            self.place(part);
            let after = self.energy(&self.p);
            let enough = after <= before + SUFFICIENT * part * slope;
            // Where the energies cannot tell, the step is Newton's own and tiny.
            let unseen = -slope * part <= UNSEEN * before.abs() && after <= before * (1.0 + UNSEEN);
            if after.is_finite() && (enough || unseen) {
                std::mem::swap(&mut self.x, &mut self.p);
                return true;
            }
            part *= 0.5;
        }
        false
    }

    /// Puts into `p` the positions after `part` of the way from x to `to`.
    fn place(&mut self, part: Real) {
        let ends = self.x.iter().zip(&self.to);
        for (p, (x, to)) in self.p.iter_mut().zip(ends) {
            *p = if part == 1.0 {
                *to
            } else {
                x + (to - x) * part
            };
        }
    }

    /// Brings prescribed vertices and obstacles to where they have to be after `dt` (s), with the others making way, to `accuracy` (m).
    pub(super) fn carry(&mut self, dt: Real, accuracy: Real) -> Result<(), Stuck> {
        let ends = self.x.iter().zip(&self.aim).zip(&self.weight);
        let pins_stay = ends
            .filter(|(_, w)| **w == 0.0)
            .all(|((x, aim), _)| x == aim);
        if pins_stay && self.obstacles.iter().all(|o| o.motion().is_still()) {
            return Ok(());
        }
        let (mut time, mut stuck) = (0.0, 0);
        while self.counts.rounds < MOST_ROUNDS {
            self.counts.rounds += 1;
            let left = dt - time;
            self.direct(|this| this.announce_motion(left));
            for i in 0..self.to.len() {
                self.to[i] = if self.weight[i] == 0.0 {
                    self.aim[i]
                } else {
                    self.x[i] + self.p[i]
                };
            }
            self.sweep()?;
            let safe = self.cap(Some(Interval {
                start: time,
                duration: left,
            }))?;
            self.place(safe.part);
            std::mem::swap(&mut self.x, &mut self.p);
            let Some(vertex) = safe.vertex else {
                return self.set_time(dt);
            };
            time += safe.part * left;
            self.set_time(time)?;
            self.relax(accuracy, STEPS_BETWEEN)?;
            stuck = if safe.part < PROGRESS { stuck + 1 } else { 0 };
            if stuck == MOST_STUCK || self.counts.rounds == MOST_ROUNDS {
                return Err(Stuck::NoWay(vertex));
            }
        }
        unreachable!("the last round returns")
    }

    /// Tells the linear system how prescribed vertices and obstacles will move in the `left` (s) of the step.
    fn announce_motion(&mut self, left: Real) {
        for i in 0..self.p.len() {
            if self.weight[i] == 0.0 {
                self.p[i] = self.aim[i] - self.x[i];
            }
        }
        for touch in &self.terms.touches {
            let way = touch.surface_velocity * left;
            self.gradient[touch.vertex as usize] -= touch.hessian * way;
        }
    }
}

/// Newton steps after each piece of that motion: enough to make way, not more.
const STEPS_BETWEEN: u32 = 5;
/// Most pieces that the motion of prescribed vertices and obstacles is cut into.
const MOST_ROUNDS: u32 = 200;
/// A round that does less than this part of what is left has not moved on,
const PROGRESS: Real = 1e-6;
/// and after so many there is no way.
const MOST_STUCK: u32 = 5;
