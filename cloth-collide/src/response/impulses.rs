//! The first stage: rounds of finding contacts and solving for their impulses.

use super::detect::Look;
use super::row::{RowMaker, into_velocity_rows};
use super::solve::{MOST_SWEEPS, solve};
use super::{ClothContacts, ContactStage, ENOUGH_ROUNDS, MOST_ROUNDS};
use cloth_core::contact::{ContactError, ContactStep};
use cloth_core::math::Vec3;

/// A look for contacts that need impulses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// Whether it is the first of the step.
    pub(super) first: bool,
    /// Whether pairs that need impulses are looked at closely all the same.
    pub(super) certify: bool,
}

impl ClothContacts {
    /// Rounds of finding contacts and solving for their impulses. Returns whether the motion is free in the end.
    pub(super) fn impulses(
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
            let sweeps = solve(&mut self.rows, step.inverse_mass, positions);
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
    pub(super) fn is_free(&self) -> bool {
        self.hits.is_empty() && self.entering.is_empty()
    }

    /// Notes who has moved since the last look, and looks for further candidates if someone has gone far.
    pub(super) fn after_a_change(
        &mut self,
        step: &ContactStep<'_>,
        positions: &[Vec3],
    ) -> Result<(), ContactError> {
        if let Some(cloth) = &mut self.cloth {
            cloth.travelled(&self.seen, positions);
        }
        let both = self.seen.iter_mut().zip(positions);
        for (moved, (seen, x)) in self.moved.iter_mut().zip(both) {
            *moved = seen != x;
            *seen = *x;
        }
        if self
            .cloth
            .as_ref()
            .is_some_and(|cloth| cloth.strayed(positions))
        {
            self.search(step, positions)?;
        }
        Ok(())
    }

    /// Looks at everything that has moved since it was looked at last: lists what goes through, and on a `pass` for impulses adds the contacts that are violated.
    pub(super) fn find(&mut self, step: &ContactStep<'_>, positions: &[Vec3], pass: Option<Pass>) {
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
            // One that sleeps is no hit.
            hits.retain(|&index| !cloth.is_due(index, moved));
            for index in 0..cloth.len() {
                if !cloth.is_due(index, moved) {
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
    pub(super) fn change_velocities(&mut self, step: &ContactStep<'_>, velocities: &mut [Vec3]) {
        if self.rows.is_empty() {
            return;
        }
        into_velocity_rows(&mut self.rows, velocities, step.dt);
        for row in &self.rows {
            row.apply(row.multiplier, step.inverse_mass, velocities);
        }
        self.report.sweeps += solve(&mut self.rows, step.inverse_mass, velocities);
        let from_obstacles = self.rows.iter().filter(|row| row.is_obstacle);
        self.report.obstacle_impulse = from_obstacles.map(|row| row.multiplier).sum();
    }
}
