//! Where patches are, how they are turned, and how far they go.

use super::Patches;
use super::frame::{Four, Frame, farthest, root, tilt, times};
use crate::bounds::{self, mean};
use crate::potential::near::Near;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::parallel::wide;
use std::ops::Range;

/// Difference of rotations (dimensionless) up to which a path counts the turn of a patch apart from its change.
const LARGEST_TURN: Real = 0.2;
/// What a straight path leaves of a vector that turns by so much one way at one end, and the other way at the other.
const CHORD: Real = 1.0 - 0.5 * LARGEST_TURN * LARGEST_TURN;

/// All patches at one moment.
#[derive(Clone, Debug, Default)]
pub(super) struct Places {
    /// Centre (m) and axes; its vertices, from the centre (m); the distance (m) of the farthest of them; and the
    /// spread (m).
    pub(super) frames: Vec<Frame>,
    pub(super) arms: Vec<Four>,
    pub(super) radii: Vec<Real>,
    pub(super) spreads: Vec<Real>,
    /// Mean of the centres of the cloth (m).
    pub(super) mean: Vec3,
}

/// What one patch does in the motion at hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct PatchMotion {
    /// Displacement of the centre (m), the rotation that is counted apart, and how far (m) a vertex goes besides both.
    shift: Vec3,
    turn: Mat3,
    rest: Real,
    /// How far (m) a vertex goes relative to the mean motion of the cloth.
    pub(super) stray: Real,
}

/// The second of two patches in the frame of the first: centre (m), axes, and radius (m).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RelativePose {
    centre: Vec3,
    axes: Mat3,
    radius: Real,
}

impl RelativePose {
    /// By how much (m) distances between points of the two have changed, at most, from this one to another, besides
    /// what their spreads have grown.
    #[inline]
    pub(super) fn change(&self, other: &Self) -> Real {
        (other.centre - self.centre).norm() + tilt(&self.axes, &other.axes) * self.radius
    }
}

impl PatchMotion {
    pub(super) const NONE: Self = Self {
        shift: Vec3::new(0.0, 0.0, 0.0),
        turn: Frame::NOWHERE.axes,
        rest: 0.0,
        stray: 0.0,
    };
}

impl Places {
    /// Of `count` patches with `groups` groups of vertices, which are nowhere yet.
    pub(super) fn new(count: usize, groups: usize) -> Self {
        Self {
            frames: vec![Frame::NOWHERE; count],
            arms: vec![[[0.0; 4]; 3]; groups],
            radii: vec![0.0; count],
            spreads: vec![0.0; count],
            mean: Vec3::zeros(),
        }
    }

    /// Takes over everything of another, in the memory that is there.
    pub(super) fn copy(&mut self, other: &Self) {
        self.frames.clone_from(&other.frames);
        self.arms.clone_from(&other.arms);
        self.radii.clone_from(&other.radii);
        self.spreads.clone_from(&other.spreads);
        self.mean = other.mean;
    }

    /// From the centre of the second of two patches to that of the first (m).
    #[inline]
    fn apart(&self, [p, q]: [u32; 2]) -> Vec3 {
        self.frames[p as usize].centre - self.frames[q as usize].centre
    }

    /// Sum of the spreads (m).
    #[inline]
    pub(super) fn spread(&self, [p, q]: [u32; 2]) -> Real {
        self.spreads[p as usize] + self.spreads[q as usize]
    }

    #[inline]
    pub(super) fn pose(&self, [p, q]: [u32; 2]) -> RelativePose {
        let (one, other) = (&self.frames[p as usize], &self.frames[q as usize]);
        RelativePose {
            centre: one.axes.tr_mul(&(other.centre - one.centre)),
            axes: one.axes.tr_mul(&other.axes),
            radius: self.radii[q as usize],
        }
    }
}

impl Patches {
    /// The groups of vertices of patch `p`.
    fn range(&self, p: usize) -> Range<usize> {
        self.starts[p]..self.starts[p + 1]
    }

    /// Finds the patches that do not rest at `x` (m).
    #[inline(always)]
    fn find_centres(&self, places: &mut Places, x: &[Vec3]) {
        for &p in &self.moving {
            let (p, range) = (p as usize, self.range(p as usize));
            let arms = &mut places.arms[range.clone()];
            places.frames[p].place(&self.groups[range], x, arms);
        }
        let centres = places.frames[..self.cloth].iter().map(|f| f.centre);
        places.mean = centres.sum::<Vec3>() / self.cloth.max(1) as Real;
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

    /// Takes `x` (m) for the start of the substep, whatever was before.
    pub(super) fn place(&mut self, x: &[Vec3]) {
        let mut now = std::mem::take(&mut self.now);
        wide(
            #[inline(always)]
            || self.find_centres(&mut now, x),
        );
        self.now = now;
        self.is_settled.fill(false);
        for k in 0..self.moving.len() {
            self.settle(self.moving[k] as usize);
        }
    }

    /// Measures the motion from the start of the substep to `to` (m), with the turns of patches apart if that is
    /// wanted.
    pub(super) fn measure(&mut self, to: &[Vec3], turns: bool) {
        self.turns = turns;
        let mut then = std::mem::take(&mut self.then);
        wide(
            #[inline(always)]
            || {
                self.find_centres(&mut then, to);
                self.compare(&mut then);
            },
        );
        self.then = then;
    }

    #[inline(always)]
    fn compare(&mut self, then: &mut Places) {
        let now = &self.now;
        let mean = then.mean - now.mean;
        for &p in &self.moving {
            let (p, range) = (p as usize, self.range(p as usize));
            let arms = || {
                now.arms[range.clone()]
                    .iter()
                    .zip(&then.arms[range.clone()])
            };
            let mut rest = [0.0; 4];
            arms().for_each(|(was, is)| farthest(&mut rest, is, was));
            let (shift, rest) = (then.frames[p].centre - now.frames[p].centre, root(rest));
            let motion = &mut self.motions[p];
            *motion = PatchMotion {
                shift,
                rest,
                stray: (shift - mean).norm() + rest,
                ..PatchMotion::NONE
            };
            if !self.turns {
                continue;
            }
            then.frames[p].turn(&self.groups[range.clone()], &then.arms[range.clone()]);
            let turn = then.frames[p].axes * now.frames[p].axes.transpose();
            let (mut besides, mut radius) = ([0.0; 4], [0.0; 4]);
            for (was, is) in arms() {
                farthest(&mut besides, is, &times(&turn, was));
                farthest(&mut radius, is, &[[0.0; 4]; 3]);
            }
            then.radii[p] = root(radius);
            if tilt(&turn, &PatchMotion::NONE.turn) <= LARGEST_TURN {
                (motion.turn, motion.rest) = (turn, root(besides));
            }
        }
        for (motion, rests) in self.motions.iter_mut().zip(&self.rests).skip(self.cloth) {
            if *rests {
                motion.stray = mean.norm();
            }
        }
    }

    /// The substep ends where it was measured last.
    pub(in crate::potential) fn accept(&mut self) {
        for k in 0..self.pairs.len() {
            let change = self.change(k, 0.0);
            self.pairs[k].travel += change;
            self.left[k] -= change;
        }
        let strays = self.longest_strays();
        let all = self.strayed.iter_mut().zip(strays);
        all.for_each(|(strayed, stray)| *strayed += stray);
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

    /// Whether the motion at hand, with all within `margin` (m) of its end, may go farther than pairs of patches were
    /// searched for.
    pub(super) fn goes_too_far(&self, margin: Real) -> bool {
        let strays = self.longest_strays();
        let mut all = self.strayed.iter().zip(strays).zip(self.reach);
        all.any(|((strayed, stray), reach)| strayed + stray + margin > reach)
    }

    /// The same where the motion begins at `x` (m), by how far each vertex is from where it was at that search.
    pub(super) fn has_strayed(&mut self, near: &Near, x: &[Vec3], margin: Real) -> bool {
        if !self.goes_too_far(margin) {
            return false;
        }
        let (was, is) = (self.searched.split_at(near.cloth), x.split_at(near.cloth));
        let shift = mean(is.0) - mean(was.0);
        let far = |was, is| bounds::farthest(was, is, shift);
        self.strayed = [far(was.0, is.0), far(was.1, is.1)];
        self.goes_too_far(margin)
    }

    /// How far (m) a vertex of the cloth goes in the motion at hand, at most, relative to the mean motion, and one of a
    /// body.
    pub(super) fn longest_strays(&self) -> [Real; 2] {
        let (own, bodies) = self.motions.split_at(self.cloth);
        [own, bodies].map(|motions| {
            let strays = motions.iter().map(|motion| motion.stray);
            strays.fold(0.0, Real::max)
        })
    }

    /// The bound on what two patches, of the pair `k`, have moved relative to each other (m) since their pairs of
    /// primitives were found: their travel, if that tells that no other pair can touch where they move by `once` (m)
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

    /// By how much (m) distances between the patches of pair `k` change in the motion at hand, at most. What is known
    /// of each patch alone is enough if it is no more than `enough` (m).
    #[inline]
    pub(super) fn change(&self, k: usize, enough: Real) -> Real {
        let patches = self.ids[k];
        let [one, other] = patches.map(|p| &self.motions[p as usize]);
        let strays = one.stray + other.stray;
        if strays <= enough {
            return strays;
        }
        if !self.turns {
            return (one.shift - other.shift).norm() + one.rest + other.rest;
        }
        let turned = tilt(&one.turn, &other.turn) * self.now.radii[patches[1] as usize];
        let shift = self.then.apart(patches) - one.turn * self.now.apart(patches);
        strays.min(shift.norm() + turned + one.rest + other.rest)
    }
}

/// By how much (m) distances may change at both ends of a path on which points come nearer by `nearer` (m), where they
/// must not come as near as `range` (m).
///
/// Seen from the first patch, a vector d between them is d + e at an end, ‖e‖ no more than the change. A straight path
/// between two places, to which the patch has turned by R₁ and R₂, has it at `((1 − t) R₁ + t R₂) d` and no more than
/// the change besides. A mean of two rotations by an angle θ to each other shortens a vector to cos(θ/2), at most, and
/// θ is no more than the angles of both, whose sines of half are at most `LARGEST_TURN`/2: cos(θ/2) ≥ `CHORD`.
pub(super) fn change_for(nearer: Real, range: Real) -> Real {
    (range + nearer) * CHORD - range
}

/// The other way round: by how much nearer (m) than at the start points can come.
pub(super) fn nearer_by(change: Real, range: Real) -> Real {
    (range + change) / CHORD - range
}

#[cfg(test)]
#[path = "../../../tests/unit/potential_patches_measure.rs"]
mod tests;
