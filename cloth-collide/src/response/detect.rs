//! Which contacts does a motion make, and is it free?

use super::cloth::Cloth;
use super::memory::Memory;
use super::pair::{Motion, Nearest, Pair, apart_along, first_contact, nearest, room_along};
use super::row::{Row, RowMaker};
use super::{KEPT, NEAR, RECOVERY};
use crate::obstacle::{ObstacleContacts, VertexPath, first_contact as first_obstacle_contact};
use cloth_core::math::{Real, Vec3, gather};

impl Cloth {
    /// Looks at candidate `index`: hands its contact, if it needs one, to `add`. Returns whether the pair may pass through each other or come too near.
    pub(super) fn examine(
        &mut self,
        index: usize,
        look: &Look<'_>,
        mut add: impl FnMut(Row),
    ) -> bool {
        let pair = self.pair(index);
        let motion = Motion {
            from: gather(look.make.from, pair.vertices),
            to: gather(look.to, pair.vertices),
        };
        let clear = NEAR * self.thickness;
        let known = &mut self.known[index];
        if let Some(room) = room_along(pair.kind, &known.normal, &motion, clear) {
            self.sleep.send(index, pair.vertices, room);
            return false;
        }
        let start = nearest(pair.kind, &motion.from);
        known.normal = start.normal;
        if let Some(room) = room_along(pair.kind, &start.normal, &motion, clear) {
            self.sleep.send(index, pair.vertices, room);
            return false;
        }
        if start.distance > self.thickness && motion.is_shift(start.distance) {
            return false;
        }
        let thickness = self.thickness_of(index, &pair);
        // Less than what is worked towards, or pieces that pass through each other would be good enough.
        let tolerance = look.tolerance.min(0.5 * thickness);
        let cloth = |at: &Nearest, offset| look.make.cloth(pair.vertices, at, offset, tolerance);
        let reach = if start.is_at_boundary() { 1.0 } else { NEAR };
        let is_near = start.distance <= reach * thickness;
        let has_row = self.known[index].row_step == self.step;
        let enough = thickness - tolerance;
        // What pushes stays awake.
        let pushes = has_row || is_near && look.recalls(self.key(index));
        if !pushes && let Some(room) = room_along(pair.kind, &start.normal, &motion, enough) {
            self.sleep.send(index, pair.vertices, room);
            return false;
        }
        let verdict = if is_near {
            if has_row {
                Verdict::Satisfied
            } else {
                let missing = (thickness - start.distance).max(0.0);
                let offset = thickness - (1.0 - RECOVERY) * missing;
                let mut row = cloth(&start, offset);
                if let Some(row) = &mut row {
                    row.key = Some(self.key(index));
                }
                // A boundary that only passes by at a distance is no obstacle.
                let passes_by = || nearest(pair.kind, &motion.to).distance >= offset;
                let verdict = match look.judge(row, &mut add) {
                    Verdict::Postponed if !look.first && passes_by() => Verdict::Satisfied,
                    Verdict::Postponed if !look.first => look.insist(row, &mut add),
                    verdict => verdict,
                };
                if verdict == Verdict::Added {
                    self.known[index].row_step = self.step;
                }
                verdict
            }
        } else {
            if look.first && start.is_at_boundary() && start.distance <= NEAR * thickness {
                // Most of these are kept apart by what is found now.
                return true;
            }
            let end = nearest(pair.kind, &motion.to);
            if let Some(room) = room_along(pair.kind, &end.normal, &motion, enough) {
                self.sleep.send(index, pair.vertices, room);
                return false;
            }
            self.continuous_tests += 1;
            let Some(time) = first_contact(pair.kind, &motion, thickness) else {
                return false;
            };
            let at = nearest(pair.kind, &motion.at(time));
            look.judge_or_insist(cloth(&at, thickness), &mut add)
        };
        if verdict != Verdict::Satisfied && !look.certify {
            return true;
        }
        let Some(time) = self.hit(index, &pair, &motion, &start) else {
            return false;
        };
        if verdict == Verdict::Satisfied {
            let at = nearest(pair.kind, &motion.at(time));
            let offset = at.distance + RECOVERY * (thickness - at.distance).max(0.0);
            look.judge_or_insist(cloth(&at, offset), &mut add);
        }
        true
    }

    /// When the pair, nearest at `start` first, comes nearer than the share of that distance, or of the thickness if it is less, that a step has to keep.
    fn hit(&mut self, index: usize, pair: &Pair, motion: &Motion, start: &Nearest) -> Option<Real> {
        let kept = |thickness: Real| KEPT * start.distance.min(thickness);
        if motion.is_shift(start.distance)
            || apart_along(pair.kind, &start.normal, motion, kept(self.thickness))
        {
            return None;
        }
        self.continuous_tests += 1;
        let kept = kept(self.thickness_of(index, pair));
        first_contact(pair.kind, motion, kept)
    }

    /// Whether candidate `index` may pass through each other, or come too near, on the way to `to` (m).
    pub(super) fn hits(&mut self, index: usize, from: &[Vec3], to: &[Vec3]) -> bool {
        let pair = self.pair(index);
        let motion = Motion {
            from: gather(from, pair.vertices),
            to: gather(to, pair.vertices),
        };
        let start = nearest(pair.kind, &motion.from);
        self.hit(index, &pair, &motion, &start).is_some()
    }
}

/// What a look at a motion is made with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look<'a> {
    pub(super) make: RowMaker<'a>,
    /// Where the motion ends (m).
    pub(super) to: &'a [Vec3],
    /// By how much (m) a contact may be violated at most.
    pub(super) tolerance: Real,
    /// Contacts of the last step.
    pub(super) memory: &'a Memory,
    /// Whether this is the first look of the step: contacts of the last one are taken over, and those with the boundary of a triangle or the end of an edge are left for later. Most
    /// boundaries have a neighbour that is the better one to push, and would only get in the way of what slides over them.
    pub(super) first: bool,
    /// Whether it matters if a pair with a violated contact only comes too near, or passes through.
    pub(super) certify: bool,
}

/// What becomes of a possible contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    /// Not violated.
    Satisfied,
    /// It is violated and has a row now, or it had a row and pushed in the last step.
    Added,
    /// It is violated, but with a boundary.
    Postponed,
}

impl Look<'_> {
    /// Whether a contact of the last step is taken over.
    fn recalls(&self, key: u64) -> bool {
        self.first && self.memory.knows(key)
    }

    /// Hands a row to `add` if it is violated, or if its contact pushed in the last step.
    fn judge(&self, row: Option<Row>, add: &mut impl FnMut(Row)) -> Verdict {
        let Some(row) = row else {
            return Verdict::Satisfied;
        };
        let recalled = self
            .memory
            .recall(&row, self.make.dt)
            .filter(|_| self.first);
        if recalled.is_none() && row.excess(self.to) >= -row.tolerance {
            return Verdict::Satisfied;
        }
        if recalled.is_none() && row.is_at_boundary {
            return Verdict::Postponed;
        }
        add(recalled.unwrap_or(row));
        Verdict::Added
    }

    /// The same for a row that is known to be violated.
    fn insist(&self, row: Option<Row>, add: &mut impl FnMut(Row)) -> Verdict {
        if let Some(row) = row {
            add(row);
        }
        Verdict::Added
    }

    /// Postpones contacts with a boundary at the first look only.
    fn judge_or_insist(&self, row: Option<Row>, add: &mut impl FnMut(Row)) -> Verdict {
        match self.judge(row, add) {
            Verdict::Postponed if !self.first => self.insist(row, add),
            verdict => verdict,
        }
    }

    /// What a vertex does to obstacle `number`: hands the row that keeps it out, if it needs one, to `add`, and returns whether it gets inside.
    pub(super) fn obstacle(
        &self,
        obstacles: &ObstacleContacts,
        number: usize,
        vertex: u32,
        mut add: impl FnMut(Row),
    ) -> bool {
        let way = [self.make.from, self.to].map(|x| x[vertex as usize]);
        let Some(contact) = obstacles.contact_of(number, vertex, way, self.make.dt) else {
            return false;
        };
        let law = &obstacles.pairs()[number].1;
        let mut row = self
            .make
            .obstacle(&contact, law.restitution(), self.tolerance);
        if let Some(row) = &mut row {
            row.key = Some(2 << 62 | u64::from(vertex) << 31 | number as u64);
        }
        let verdict = self.judge(row, &mut add);
        verdict != Verdict::Satisfied && !self.certify || self.enters(obstacles, number, way)
    }

    /// Whether a vertex on its `way` (m) gets inside an obstacle, or deeper inside if it was there before, by more than the tolerance.
    fn enters(&self, obstacles: &ObstacleContacts, number: usize, way: [Vec3; 2]) -> bool {
        let obstacle = &obstacles.pairs()[number].0;
        let start = obstacle.clearance(way[0], 0.0).value;
        let kept = if start > 0.0 {
            KEPT * start.min(obstacles.thickness())
        } else {
            start
        };
        let path = VertexPath::straight(way[0], way[1], self.make.dt);
        first_obstacle_contact(obstacle, &path, 0.0, self.make.dt, kept - self.tolerance).is_some()
    }
}
