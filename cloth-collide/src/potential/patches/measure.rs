//! Where patches are, how they are turned, and how far they go.

use super::Patches;
use super::frame::{Frame, farthest, root, tilt, times};
use super::motions::Motions;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::parallel::wide;
use std::ops::Range;

/// What a path may turn a patch by beyond what was looked at, as a difference of rotations (dimensionless).
pub(super) const TURN: Real = 0.05;
/// Difference of rotations from which on a path is measured as if patches did not turn.
const LARGEST_TURN: Real = 0.5;

/// Bounds on the relative motion of two patches on all paths of which both ends keep them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Allowed {
    /// By how much (m) distances change, besides what both turn together; and by how much the first of the two may
    /// turn, or none if turns are not counted apart.
    change: Real,
    turn: Option<Real>,
}

impl Patches {
    /// The groups of vertices of patch `p`.
    fn range(&self, p: usize) -> Range<usize> {
        self.starts[p]..self.starts[p + 1]
    }

    /// Finds the patches that do not rest at `x` (m).
    #[inline(always)]
    fn find_centres(&self, motions: &mut Motions, x: &[Vec3]) {
        for &p in &self.moving {
            let (p, range) = (p as usize, self.range(p as usize));
            let arms = &mut motions.arms[range.clone()];
            motions.frames[p].place(&self.groups[range], x, arms);
        }
        let centres = motions.frames[..self.cloth].iter().map(|f| f.centre);
        motions.mean = centres.sum::<Vec3>() / self.cloth.max(1) as Real;
    }

    /// Finds how patches are turned that do not rest.
    #[inline(always)]
    fn find_axes(&self, motions: &mut Motions) {
        for &p in &self.moving {
            let (p, range) = (p as usize, self.range(p as usize));
            motions.frames[p].turn(&self.groups[range.clone()], &motions.arms[range]);
        }
    }

    /// Finds how patch `p` is turned at the start of the substep, and how far it has spread.
    pub(super) fn settle(&mut self, p: usize) {
        if std::mem::replace(&mut self.is_settled[p], true) {
            return;
        }
        let range = self.range(p);
        let Self { now, groups, .. } = self;
        let (frame, arms) = (&mut now.frames[p], &now.arms[range.clone()]);
        let (mut spread, mut radius) = ([0.0; 4], [0.0; 4]);
        wide(
            #[inline(always)]
            || {
                frame.turn(&groups[range.clone()], arms);
                for (arms, local) in arms.iter().zip(&self.reference[range]) {
                    farthest(&mut spread, arms, &times(&frame.axes, local));
                    farthest(&mut radius, arms, &[[0.0; 4]; 3]);
                }
            },
        );
        now.radii[p] = root(radius);
        now.spreads[p] = self.reference_spreads[p] + root(spread);
    }

    fn settle_all(&mut self) {
        for k in 0..self.moving.len() {
            self.settle(self.moving[k] as usize);
        }
    }

    /// Takes `x` (m) for the start of the substep, whatever was before.
    pub(super) fn place(&mut self, x: &[Vec3]) {
        let mut now = std::mem::take(&mut self.now);
        wide(
            #[inline(always)]
            || self.find_centres(&mut now, x),
        );
        self.now = now;
        self.is_settled.fill(false);
        self.settle_all();
    }

    /// Looks at the motion from the start of the substep to `to` (m), and at how patches turn on the way if that is
    /// wanted.
    pub(super) fn measure(&mut self, to: &[Vec3], turns: bool) {
        let mut then = std::mem::take(&mut self.then);
        wide(
            #[inline(always)]
            || {
                self.find_centres(&mut then, to);
                self.compare(&mut then);
                if turns {
                    self.find_axes(&mut then);
                    self.compare_turns(&mut then);
                }
            },
        );
        self.then = then;
    }

    /// Compares the start of the substep with its end.
    #[inline(always)]
    fn compare(&mut self, then: &mut Motions) {
        let now = &self.now;
        let shift = then.mean - now.mean;
        then.still = now.still + shift.norm();
        for &p in &self.moving {
            let (p, range) = (p as usize, self.range(p as usize));
            let mut displacement = [0.0; 4];
            for (was, is) in now.arms[range.clone()].iter().zip(&then.arms[range]) {
                farthest(&mut displacement, is, was);
            }
            let displacement = root(displacement);
            self.displacements[p] = displacement;
            then.paths[p] = now.paths[p] + displacement;
            let centre = then.frames[p].centre - now.frames[p].centre - shift;
            self.strays[p] = centre.norm() + displacement;
            then.clocks[p] = now.clocks[p] + self.strays[p];
        }
        for (stray, rests) in self.strays.iter_mut().zip(&self.rests).skip(self.cloth) {
            if *rests {
                *stray = shift.norm();
            }
        }
    }

    #[inline(always)]
    fn compare_turns(&mut self, then: &mut Motions) {
        let now = &self.now;
        for &p in &self.moving {
            let (p, range) = (p as usize, self.range(p as usize));
            let turn = then.frames[p].axes * now.frames[p].axes.transpose();
            let (mut besides, mut radius) = ([0.0; 4], [0.0; 4]);
            for (was, is) in now.arms[range.clone()].iter().zip(&then.arms[range]) {
                farthest(&mut besides, is, &times(&turn, was));
                farthest(&mut radius, is, &[[0.0; 4]; 3]);
            }
            then.radii[p] = root(radius);
            self.besides[p] = root(besides);
            self.turns[p] = turn;
            self.tilts[p] = tilt(&turn, &Frame::NOWHERE.axes);
        }
    }

    /// The substep ends where it was looked at last.
    pub(in crate::potential) fn accept(&mut self) {
        std::mem::swap(&mut self.now, &mut self.then);
        for &p in &self.moving {
            self.is_settled[p as usize] = false;
        }
    }

    /// Counts the spread of patch `p` from the start of the substep on.
    pub(super) fn refer(&mut self, p: usize) {
        self.settle(p);
        let range = self.range(p);
        let inverse = self.now.frames[p].axes.transpose();
        let arms = self.now.arms[range.clone()].iter();
        for (local, arms) in self.reference[range].iter_mut().zip(arms) {
            *local = times(&inverse, arms);
        }
        self.reference_spreads[p] = self.now.spreads[p];
    }

    /// How far patches have gone since pairs of them were searched, at most, besides what all do together (m), at the
    /// start of the substep.
    pub(super) fn stray(&mut self) -> Real {
        self.settle_all();
        let (old, new) = (&self.searched, &self.now);
        let shift = new.mean - old.mean;
        let still = match self.moving.len() < self.members.len() {
            true => shift.norm(),
            false => 0.0,
        };
        let displacements = self.moving.iter().map(|&p| {
            let p = p as usize;
            let (a, b) = (&old.frames[p], &new.frames[p]);
            let turned = tilt(&a.axes, &b.axes) * old.radii[p];
            (b.centre - a.centre - shift).norm() + turned + new.spreads[p] - old.spreads[p]
        });
        displacements.fold(still, Real::max)
    }

    /// Whether some may go farther in the motion that is looked at, with `room` (m) around every path, than pairs of
    /// patches were searched for: by their clocks, or else by where they are.
    pub(super) fn has_strayed(&mut self, room: Real) -> bool {
        let (old, new) = (&self.searched, &self.then);
        let advance = |&p: &u32| new.clocks[p as usize] - old.clocks[p as usize];
        let most = self.moving.iter().map(advance).fold(0.0, Real::max);
        let still = match self.moving.len() < self.members.len() {
            true => new.still - old.still,
            false => 0.0,
        };
        most.max(still) + room > self.reach
            && self.stray() + self.longest_stray() + room > self.reach
    }

    /// How far (m) a patch goes in the motion that is looked at, at most, besides what all do together.
    pub(super) fn longest_stray(&self) -> Real {
        self.strays.iter().copied().fold(0.0, Real::max)
    }

    /// The bound on what two patches, of the pair `k`, have moved relative to each other (m) since their pairs of
    /// primitives were found: their travel, if that tells that nothing new can touch where they move by `once` (m)
    /// more.
    #[inline]
    pub(super) fn moved(&mut self, k: usize, once: Real) -> Real {
        let pair = &self.pairs[k];
        if pair.travel + once <= pair.next {
            return pair.travel;
        }
        let [p, q] = pair.patches.map(|p| p as usize);
        self.settle(p);
        self.settle(q);
        self.pairs[k].moved(&self.now)
    }

    /// The sum of the clocks of two patches (m).
    #[inline]
    pub(super) fn clock(&self, motions: &Motions, patches: [u32; 2]) -> Real {
        let clock = |p: u32| match self.rests[p as usize] {
            true => motions.still,
            false => motions.clocks[p as usize],
        };
        clock(patches[0]) + clock(patches[1])
    }

    /// The most that two patches move relative to each other in the substep (m).
    #[inline]
    pub(super) fn once(&self, patches: [u32; 2]) -> Real {
        let [p, q] = patches.map(|p| p as usize);
        let moved = |p: usize| self.then.frames[p].centre - self.now.frames[p].centre;
        (moved(p) - moved(q)).norm() + self.displacements[p] + self.displacements[q]
    }

    /// By how much distances change in the motion that is looked at, at most (m), by what is known of each patch alone.
    #[inline]
    pub(super) fn roughly(&self, patches: [u32; 2]) -> Real {
        self.strays[patches[0] as usize] + self.strays[patches[1] as usize]
    }

    /// What two patches do in the motion that is looked at, with `room` (m) around every path.
    #[inline]
    pub(super) fn allow(&self, patches: [u32; 2], room: Real) -> Allowed {
        let turn = self.tilts[patches[0] as usize] + TURN;
        let (change, turn) = match turn < LARGEST_TURN {
            true => (self.change(patches), Some(turn)),
            false => (self.once(patches), None),
        };
        Allowed {
            change: change + 2.0 * room,
            turn,
        }
    }

    /// Whether the motion that is looked at is within what was allowed.
    #[inline]
    pub(super) fn is_allowed(&self, patches: [u32; 2], allowed: &Allowed) -> bool {
        if self.roughly(patches) <= allowed.change {
            return true;
        }
        match allowed.turn {
            Some(turn) => {
                self.tilts[patches[0] as usize] <= turn && self.change(patches) <= allowed.change
            }
            None => self.once(patches) <= allowed.change,
        }
    }

    /// By how much the distance of two points changes from the start to the end of the motion, at most (m): the same
    /// as [`Pose::change`](super::motions::Pose::change), with all turned back as the first patch is.
    #[inline]
    pub(super) fn change(&self, patches: [u32; 2]) -> Real {
        let [p, q] = patches.map(|p| p as usize);
        let [before, after] = [&self.now, &self.then]
            .map(|motions| motions.frames[p].centre - motions.frames[q].centre);
        let turned = tilt(&self.turns[p], &self.turns[q]) * self.now.radii[q];
        (after - self.turns[p] * before).norm() + turned + self.besides[p] + self.besides[q]
    }
}

impl Allowed {
    /// As much as makes points nearer by `left` (m), where they must not come as near as `range` (m), if the first
    /// patch may turn by so much.
    pub(super) fn all(turn: Option<Real>, left: Real, range: Real) -> Self {
        let change = match turn {
            Some(turn) => (range + left) * (1.0 - 0.5 * turn * turn) - range,
            None => left,
        };
        Self { change, turn }
    }

    /// The same with all that makes points nearer by `left` (m).
    pub(super) fn extended(&self, left: Real, range: Real) -> Self {
        Self::all(self.turn, left, range)
    }

    /// Whether a motion that changes distances by no more than this (m), `room` (m) around it and no turn, is within.
    pub(super) fn holds(&self, change: Real, room: Real) -> bool {
        change + 2.0 * room <= self.change
    }

    /// By how much nearer (m) than at the start two points can come, of which it matters whether they come as near as
    /// `range` (m).
    ///
    /// Seen from the first patch, a vector d between them is d + e at an end, ‖e‖ ≤ `change`. A straight path between
    /// two places, to which the patch has turned by R₁ and R₂, has it at `((1 − t) R₁ + t R₂) d` and no more than
    /// `change` besides. A mean of two rotations by an angle θ to each other shortens a vector to cos(θ/2), at most,
    /// and θ is no more than the angles of both, whose sines of half are `turn`/2: cos(θ/2) ≥ 1 − `turn`²/2.
    #[inline]
    pub(super) fn nearer(&self, range: Real) -> Real {
        match self.turn {
            Some(turn) => (range + self.change) / (1.0 - 0.5 * turn * turn) - range,
            None => self.change,
        }
    }
}

#[cfg(test)]
#[path = "../../../tests/unit/potential_patches_measure.rs"]
mod tests;
