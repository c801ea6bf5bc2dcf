//! The response: what the cloth does where it touches itself or an obstacle (COL-7, COL-8, COL-9).

mod builder;
mod detect;
mod hold;
mod memory;
mod pair;
mod report;
mod row;
mod sets;
mod solve;
mod zones;

pub use builder::ContactsBuilder;
pub use report::{ContactReport, ContactStage};

use crate::obstacle::{Obstacle, ObstacleContacts};
use crate::separation::meet_unduly;
use cloth_core::contact::{ContactError, ContactSource, ContactStep};
use cloth_core::math::{Real, Vec3, is_finite};
use detect::{Cloth, Look};
use hold::Hold;
use memory::Memory;
use row::{Row, RowMaker, into_velocity_rows};
use solve::{MOST_SWEEPS, solve};
use zones::{Zones, make_velocities_rigid, move_rigidly};

/// A step may not bring two pieces nearer than this share of their distance before it, or of the thickness if that is less.
const KEPT: Real = 0.1;
/// Pieces that start nearer than this share of the thickness push along the line between their nearest points then; others along that when they come to the thickness.
const NEAR: Real = 1.0;
/// The share of what is missing to the thickness that one step makes up.
const RECOVERY: Real = 0.5;
/// The margin of the search for candidates, in thicknesses. What it has more than one lets the motion become another one without a new search.
const MARGIN: Real = 4.0;
/// Contacts are satisfied to this share of the thickness.
const TOLERANCE: Real = 1e-2;
/// Rounds of impulses, at most, before zones take over.
const MOST_ROUNDS: u32 = 10;
/// Rounds after which a free motion is good enough, though some contact may still miss its thickness.
const ENOUGH_ROUNDS: u32 = 3;
/// Rounds of growing zones, at most, before vertices are held back.
const MOST_ZONE_ROUNDS: u32 = 20;

/// Contact of a cloth with itself and with obstacles.
#[derive(Debug)]
pub struct ClothContacts {
    vertex_count: usize,
    thickness: Real,
    friction: Real,
    obstacles: Option<ObstacleContacts>,
    cloth: Option<Cloth>,
    /// Positions (m) at the end of the last resolved step: known to be free of crossings.
    safe: Vec<Vec3>,
    /// Positions (m) that were looked at last.
    seen: Vec<Vec3>,
    /// Whether a vertex has moved since then.
    moved: Vec<bool>,
    rows: Vec<Row>,
    /// Candidates that may pass through each other, in rising order.
    hits: Vec<usize>,
    /// Vertices that get inside an obstacle, and which one.
    entering: Vec<[u32; 2]>,
    zones: Zones,
    /// What impulses alone would do (m), and the ways from there.
    solved: Vec<Vec3>,
    ways: Vec<Vec3>,
    hold: Hold,
    memory: Memory,
    report: ContactReport,
}

/// A look for contacts that need impulses.
#[derive(Clone, Copy, Debug)]
struct Pass {
    /// Whether it is the first of the step.
    first: bool,
    /// Whether pairs that need impulses are looked at closely all the same.
    certify: bool,
}

impl ContactSource for ClothContacts {
    fn resolve(
        &mut self,
        step: &ContactStep<'_>,
        positions: &mut [Vec3],
        velocities: &mut [Vec3],
    ) -> Result<(), ContactError> {
        self.check(step, positions, velocities)?;
        self.report = ContactReport {
            smallest_share: 1.0,
            ..ContactReport::default()
        };
        if self.cloth.is_none() && self.obstacles.is_none() {
            return Ok(());
        }
        self.rows.clear();
        self.hits.clear();
        self.entering.clear();
        self.prepare(step, positions)?;
        let free = self.impulses(step, positions)?;
        self.change_velocities(step, velocities);
        if !free {
            self.last_resorts(step, positions, velocities)?;
        }
        self.keep(step, positions)
    }
}

impl ClothContacts {
    /// What the last step has taken.
    #[must_use]
    pub fn report(&self) -> &ContactReport {
        &self.report
    }

    /// The obstacles, if there are any.
    #[must_use]
    pub fn obstacles(&self) -> Option<&ObstacleContacts> {
        self.obstacles.as_ref()
    }

    /// The same, to move them. After each resolved step they have moved on by its time themselves.
    pub fn obstacles_mut(&mut self) -> Option<&mut ObstacleContacts> {
        self.obstacles.as_mut()
    }

    fn check(
        &self,
        step: &ContactStep<'_>,
        positions: &[Vec3],
        velocities: &[Vec3],
    ) -> Result<(), ContactError> {
        let counts = [
            step.from.len(),
            step.inverse_mass.len(),
            positions.len(),
            velocities.len(),
        ];
        if let Some(&found) = counts.iter().find(|&&n| n != self.vertex_count) {
            return Err(ContactError::VertexCount {
                expected: self.vertex_count,
                found,
            });
        }
        let finite = |v: &usize| {
            [step.from, positions, velocities]
                .iter()
                .all(|x| is_finite(&x[*v]))
        };
        match (0..self.vertex_count).find(|v| !finite(v)) {
            Some(vertex) => Err(ContactError::NonFinite { vertex }),
            None => Ok(()),
        }
    }

    fn tolerance(&self) -> Real {
        let obstacles = self.obstacles.as_ref().map(ObstacleContacts::thickness);
        let thickness = obstacles.filter(|&h| h > 0.0).unwrap_or(self.thickness);
        TOLERANCE * thickness.min(self.thickness)
    }

    /// Makes sure that the candidates are those of the motion, if there are none of a motion with room for this one, and that the start is in order.
    fn prepare(&mut self, step: &ContactStep<'_>, positions: &[Vec3]) -> Result<(), ContactError> {
        self.seen.copy_from_slice(positions);
        self.moved.fill(true);
        if self.strayed(step.from) || self.strayed(positions) {
            self.search(step, positions)?;
        }
        let Some(cloth) = &mut self.cloth else {
            return Ok(());
        };
        cloth.forget_rows();
        self.report.candidates = cloth.len();
        if self.safe == step.from {
            return Ok(());
        }
        let triangles = cloth.candidates.triangles();
        let pairs = cloth.candidates.triangle_pairs().iter();
        let meet = |p: &&[u32; 2]| meet_unduly(p.map(|t| triangles[t as usize]), step.from);
        match pairs.filter(meet).count() {
            0 => {
                self.safe.clear();
                self.safe.extend_from_slice(step.from);
                Ok(())
            }
            pairs => Err(ContactError::Tangled { pairs }),
        }
    }

    /// Finds the candidates of the motion.
    fn search(&mut self, step: &ContactStep<'_>, positions: &[Vec3]) -> Result<(), ContactError> {
        self.moved.fill(true);
        // Candidates get new numbers.
        self.hits.clear();
        if let Some(cloth) = &mut self.cloth {
            let margin = MARGIN * self.thickness;
            let updated = cloth.candidates.update(step.from, positions, margin);
            // Everything is finite, but a box around it need not be.
            updated.map_err(|_| ContactError::NonFinite { vertex: 0 })?;
            cloth.forget_rows();
            self.report.searches += 1;
            self.report.candidates = cloth.len();
        }
        Ok(())
    }

    /// Whether a vertex may have come so far from where it was expected that there are pairs that nobody has looked for.
    fn strayed(&self, positions: &[Vec3]) -> bool {
        let Some(cloth) = &self.cloth else {
            return false;
        };
        // Half of the margin is around the box, half of the thickness is needed there.
        let slack = Vec3::repeat(0.5 * self.thickness);
        let boxes = cloth.candidates.vertex_boxes().iter().zip(positions);
        boxes.into_iter().any(|(bounds, x)| {
            let inside = x - slack >= bounds.lower && x + slack <= bounds.upper;
            !inside
        })
    }

    /// Rounds of finding contacts and solving for their impulses. Returns whether the motion is free in the end.
    fn impulses(
        &mut self,
        step: &ContactStep<'_>,
        positions: &mut [Vec3],
    ) -> Result<bool, ContactError> {
        let mut converged = true;
        let mut certify = false;
        for round in 0..=MOST_ROUNDS {
            let before = self.rows.len();
            certify |= round >= ENOUGH_ROUNDS;
            if round == 1 {
                // What was left for later.
                self.doubt();
            }
            self.find(
                step,
                positions,
                Some(Pass {
                    first: round == 0,
                    certify,
                }),
            );
            let mut added = self.rows.len() - before;
            if added == 0 && !certify && !self.is_free() {
                // No more contacts: now it matters which of them are dangerous.
                certify = true;
                self.doubt();
                self.find(
                    step,
                    positions,
                    Some(Pass {
                        first: false,
                        certify,
                    }),
                );
                added = self.rows.len() - before;
            }
            if self.is_free() && (added == 0 || round >= ENOUGH_ROUNDS) {
                return Ok(true);
            }
            if round == MOST_ROUNDS || added == 0 && converged {
                break;
            }
            self.report.stage = ContactStage::Impulses;
            self.report.rounds += 1;
            self.report.contacts = self.rows.len();
            for row in &self.rows[before..] {
                row.apply(row.multiplier, step.inverse_mass, positions);
            }
            let tolerance = 0.1 * self.tolerance();
            let sweeps = solve(&mut self.rows, step.inverse_mass, positions, tolerance);
            converged = sweeps < MOST_SWEEPS;
            self.report.sweeps += sweeps;
            self.after_a_change(step, positions)?;
        }
        Ok(false)
    }

    /// Has everything looked at once more that may be dangerous.
    fn doubt(&mut self) {
        let Self {
            cloth,
            hits,
            entering,
            moved,
            ..
        } = self;
        for &hit in hits.iter() {
            let vertices = cloth.as_ref().map(|cloth| cloth.pair(hit).vertices);
            for v in vertices.into_iter().flatten() {
                moved[v as usize] = true;
            }
        }
        for &[v, _] in entering.iter() {
            moved[v as usize] = true;
        }
    }

    /// Whether what was found last has no contact that the motion goes through.
    fn is_free(&self) -> bool {
        self.hits.is_empty() && self.entering.is_empty()
    }

    /// Notes who has moved since the last look, and looks for further candidates if someone has gone far.
    fn after_a_change(
        &mut self,
        step: &ContactStep<'_>,
        positions: &[Vec3],
    ) -> Result<(), ContactError> {
        let both = self.seen.iter_mut().zip(positions);
        for (moved, (seen, x)) in self.moved.iter_mut().zip(both) {
            *moved = seen != x;
            *seen = *x;
        }
        if self.strayed(positions) {
            self.search(step, positions)?;
        }
        Ok(())
    }

    /// Looks at everything that has moved since it was looked at last: lists what goes through, and on a `pass` for impulses adds the contacts that are violated.
    fn find(&mut self, step: &ContactStep<'_>, positions: &[Vec3], pass: Option<Pass>) {
        let tolerance = self.tolerance();
        let Self {
            obstacles,
            cloth,
            rows,
            hits,
            entering,
            moved,
            memory,
            ..
        } = self;
        let look = Look {
            make: RowMaker {
                from: step.from,
                inverse_mass: step.inverse_mass,
                dt: step.dt,
                friction: self.friction,
            },
            to: positions,
            tolerance,
            memory,
            first: pass.is_some_and(|pass| pass.first),
            certify: pass.is_none_or(|pass| pass.certify),
        };
        let mut add = |row| {
            if pass.is_some() {
                rows.push(row);
            }
        };
        if let Some(obstacles) = obstacles {
            entering.retain(|&[v, _]| !moved[v as usize]);
            let free = |v: usize| moved[v] && step.inverse_mass[v] != 0.0;
            for vertex in (0..self.vertex_count).filter(|&v| free(v)) {
                for number in 0..obstacles.pairs().len() {
                    if look.obstacle(obstacles, number, vertex as u32, &mut add) {
                        entering.push([vertex as u32, number as u32]);
                    }
                }
            }
        }
        if let Some(cloth) = cloth {
            let touched = |cloth: &Cloth, index: usize| {
                let vertices = cloth.pair(index).vertices;
                vertices.iter().any(|&v| moved[v as usize])
            };
            hits.retain(|&index| !touched(cloth, index));
            for index in 0..cloth.len() {
                if !touched(cloth, index) {
                    continue;
                }
                let hit = if pass.is_some() {
                    cloth.examine(index, &look, &mut add)
                } else {
                    cloth.hits(index, step.from, positions)
                };
                if hit {
                    hits.push(index);
                }
            }
            hits.sort_unstable();
            self.report.continuous_tests += std::mem::take(&mut cloth.continuous_tests);
        }
    }

    /// Impulses for the velocities: what has pushed does not come nearer any more, or bounces.
    fn change_velocities(&mut self, step: &ContactStep<'_>, velocities: &mut [Vec3]) {
        if self.rows.is_empty() {
            return;
        }
        into_velocity_rows(&mut self.rows, velocities, step.dt);
        for row in &self.rows {
            row.apply(row.multiplier, step.inverse_mass, velocities);
        }
        let tolerance = 0.1 * self.tolerance() / step.dt;
        self.report.sweeps += solve(&mut self.rows, step.inverse_mass, velocities, tolerance);
        let from_obstacles = self.rows.iter().filter(|row| row.is_obstacle);
        self.report.obstacle_impulse = from_obstacles.map(|row| row.multiplier).sum();
    }

    /// Zones that move as one, and what is left of that held back.
    fn last_resorts(
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
            self.after_a_change(step, positions)?;
            self.find(step, positions, None);
        }
        self.report.held = self.hold.count();
        self.report.smallest_share = self.hold.smallest_share();
        Ok(())
    }

    /// The step is resolved: it ends where the next one may start, and obstacles move on.
    fn keep(&mut self, step: &ContactStep<'_>, positions: &[Vec3]) -> Result<(), ContactError> {
        if let Some(obstacles) = &mut self.obstacles {
            // First of all whether they can.
            let stuck = |obstacle: &Obstacle| obstacle.clone().advance(step.dt).is_err();
            if obstacles.obstacles().any(stuck) {
                return Err(ContactError::NoWay { vertex: 0 });
            }
            for obstacle in obstacles.obstacles_mut() {
                let moved = obstacle.advance(step.dt);
                debug_assert!(moved.is_ok(), "just tried");
            }
        }
        self.memory.replace(&self.rows, step.dt);
        if self.cloth.is_some() {
            self.safe.copy_from_slice(positions);
        }
        Ok(())
    }
}
