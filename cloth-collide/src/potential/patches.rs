//! Which pairs can touch in a substep, from bounds on the relative motion of patches of the cloth.
//!
//! # The bound
//!
//! A patch is at most 32 neighbouring triangles. Its motion is described by a frame, which is the centre c, the mean of
//! its vertices, and axes F, a rotation that turns with them (`frame`); and by its spread s (m). The spread is counted
//! from reference positions x̄: those that its vertices had at one moment, when it had the frame c̄, F̄ and the spread
//! s̄. At the positions x it is
//!
//! s = s̄ + max ‖(x − c) − F F̄ᵀ (x̄ − c̄)‖ over the vertices of the patch.
//!
//! Where reference positions are taken anew (`refer`), s̄ becomes what s is there, so s does not jump. Let 0 be a
//! moment at which those of both patches p and q were taken, the last one or an earlier one. Seen from the frame of p,
//! q has the centre a = F_pᵀ (c_q − c_p) and the axes P = F_pᵀ F_q (`Pose`). Since moment 0 the distance of any point
//! of p from any point of q has changed by no more than
//!
//! ‖a − a₀‖ + ‖P − P₀‖₂ r_q + (s_p − s_p₀) + (s_q − s_q₀),
//!
//! r_q the distance of the farthest vertex of q from its centre at moment 0.
//!
//! This is so because a vertex has left its place in the frame by no more than s − s̄ since the last reference
//! positions, and from one set of them to the next by no more than the difference of their s̄. These add up to s − s₀,
//! and a point of a triangle is a mean of vertices. A point of q that was at z in its frame, ‖z‖ ≤ r_q, was at a₀ + P₀
//! z as seen from p and is at a + P z. From another moment the inequality does not hold: a vertex that goes back
//! towards its reference position moves, and s falls. So each detection between two patches first takes the reference
//! positions of both anew (`find`), and each search for pairs of patches those of all (`search`). What is kept to
//! compare with (`pose` and `spread` of a `PatchPair`, `searched` of `Patches`) is from these moments.
//!
//! # What follows from it
//!
//! Detection between two patches finds all pairs of primitives nearer than h plus a motion bound (`room` in the code),
//! and sorts them by d − h. As long as the expression above is less than the bound, the list is complete, and only the
//! pairs at its beginning, with d − h below the expression, can touch. What two patches do together, move and turn,
//! cancels, so cloth that flies or swings as a whole needs no detection: where a sheet falls into hanging, neighbouring
//! patches turn by far more than they bend.
//!
//! Nobody has to keep a promise: each path is measured before it is used (`look` of a substep, again after its sweeps;
//! `choose` and `holds` of a minimisation), and a bound that it exceeds is a new detection. Which patches are near each
//! other is found by a broad phase from their boxes, moved outwards by r + h/2. That is valid while no patch goes
//! farther than r besides what all do together: the mean edge, or twice the displacement of the path if that is more.
//!
//! # Measures of motion
//!
//! All are in metres, and each bounds a motion from other moments on.
//!
//! - *Spread* of a patch, *change* of a pose: as above, since the last detection. What goes to and fro does not add up.
//!   They tell whether a list is complete, and which pairs at its beginning may touch. They are found for two patches
//!   only where the travel of the two does not tell it (`moved`).
//! - *Stray* of a patch (`stray`): how far it has gone since pairs of patches were searched, besides the mean of all of
//!   the cloth, by its centre, its axes and its spread. As long as no stray is more than r, only pairs of patches that
//!   were found can be near each other.
//! - *Change* of two patches on a path (`change`): the same as that of a pose, from the start to the end of one path.
//!   In between, where vertices go straight and the patches turn, it is the chord that counts (`Allowed::nearer`).
//! - *Path* of a patch (`Motions::paths`): how far a vertex goes relative to the centre in a substep, at most, added up
//!   over the substeps. *Travel* of two (`PatchPair::travel`): the displacements of c_p − c_q and the paths of both,
//!   added up from look to look (`bring_up`) since the last detection. It never falls, and bounds the relative motion
//!   since each look in between: a pair that lacks something then need not be asked before the travel has grown by that
//!   (`wakes`), and nearest points stay what they are for a travel of 0.02 h (`known_at`). For the paths of a
//!   minimisation it is the changes that are added up, and nearest points are not kept.
//! - *Clock* of a patch (`Motions::clocks`): the displacement of its centre besides that of the mean of all of the
//!   cloth, and its path, added up over the substeps. It never goes back, and two patches move relative to each other
//!   by no more than both clocks advance together. So a look notes the sum of two clocks until which nothing can happen
//!   (`quiet`); to ask again takes one sum and one comparison for each pair of patches.
//! - *Aim*: where the centres were to end in the substep when it was looked at first. *Drift* of a patch: by how much
//!   it can have moved farther than on the way to the aim, where the substep, after sweeps, ends elsewhere. The first
//!   look allows for 0.05 h more than the motion at hand; while the drifts of two patches are together within that,
//!   they need no other.

mod between;
mod detect;
mod frame;
mod measure;
mod motion;
mod motions;

use super::near::Near;
use crate::bounds::Bounds;
use crate::broad_phase::BroadPhase;
use crate::pair::Pair;
use between::{PatchPair, Visits};
use cloth_core::math::{Mat3, Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use detect::Look;
use frame::{Four, Group};
use measure::Allowed;
use motions::Motions;

/// Looks at pairs of patches whose rows are in one list.
const LOOKS: usize = 512;
/// Triangles in a patch, at most.
const PATCH: usize = 32;
/// Room (in thicknesses) of a search for pairs, at least.
const LEAST_ROOM: Real = 0.5;
/// Room of a search, in paths of the substep that needs it.
const HOLD: Real = 60.0;
/// Room (in mean edges) of a search, at most, unless one substep needs more.
const MOST_ROOM: Real = 0.5;
/// Path (in mean edges) that a patch may go until pairs of patches are searched anew, at least; and in one substep, at
/// most.
const REACH: Real = 1.0;
const FARTHEST: Real = 30.0;

/// Two primitives that can touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearPair {
    /// What they lacked to contact (m) when they were found.
    room: Real,
    /// Distance (m) at which they begin to touch.
    pub(super) range: Real,
    /// Area (m²) that they stand for.
    pub(super) area: Real,
    pub(super) pair: Pair,
    /// Travel of the patches (m) at which their nearest points were found; −∞ where these are not known.
    pub(super) known_at: Real,
    /// The substep that they were looked at in, from 1 on, and where their row is: the number of the list, and in it.
    seen: u32,
    row: [u32; 2],
}

#[derive(Debug, Default)]
pub(super) struct Patches {
    /// Patches of the cloth; the others are those of bodies.
    cloth: usize,
    /// Patches of bodies that have not moved, and the numbers of the others.
    rests: Vec<bool>,
    moving: Vec<u32>,
    /// Triangles and vertices of each patch.
    members: Vec<(Vec<u32>, Vec<u32>)>,
    edge: Real,
    /// Path (m) that a patch may go besides what all do together, until pairs of patches are searched anew.
    reach: Real,
    /// Groups of vertices of all patches, and where those of each begin.
    groups: Vec<Group>,
    starts: Vec<usize>,
    /// Positions (m) of the vertices in the frame of the patch, from which its spread is counted, and the spread there.
    reference: Vec<Four>,
    reference_spreads: Vec<Real>,
    /// At the start of the substep, and at the end that is looked at.
    now: Motions,
    then: Motions,
    /// Whether axes, radius and spread of a patch are known at the start.
    is_settled: Vec<bool>,
    /// How far a vertex goes in between (m), besides its centre, besides what all do together, and besides the frame;
    /// how the frame turns, and the difference of that from no turn.
    displacements: Vec<Real>,
    strays: Vec<Real>,
    besides: Vec<Real>,
    turns: Vec<Mat3>,
    tilts: Vec<Real>,
    /// Where a substep was to end when pairs were looked into first, how far a vertex was to go besides its centre (m),
    /// and the drift of each patch from there (m) at another look; of each pair of patches, the substep at whose
    /// beginning it was looked into.
    aim: Vec<Vec3>,
    aim_displacements: Vec<Real>,
    drift: Vec<Real>,
    awake_in: Vec<u32>,
    /// For paths: what was allowed to the two patches of each pair when pairs were chosen.
    allowed: Vec<Allowed>,
    /// When pairs of patches were searched.
    searched: Motions,
    boxes: Vec<Bounds>,
    broad_phase: Box<dyn BroadPhase>,
    pairs: Vec<PatchPair>,
    /// The two patches of each of them, and the sum of their clocks (m; how far they have moved, see above), for paths
    /// their travel, until which nothing can happen between them.
    ids: Vec<[u32; 2]>,
    quiet: Vec<Real>,
    before: Vec<PatchPair>,
    /// Lists to be used again.
    spare: Vec<PatchPair>,
    /// Pairs of patches that the motion at hand asks for.
    looks: Vec<Look>,
    is_known: bool,
    /// Number of the substep, and how many lists of rows it has begun with.
    substep: u32,
    filled: usize,
    /// Pairs of patches that were looked into in this substep.
    awake: u32,
    /// Searches among pairs of patches so far, and among their triangles.
    pub(super) searches: u32,
    pub(super) detections: u32,
}

impl Patches {
    pub(super) fn new(mesh: &TriMesh, near: &Near) -> Self {
        let piece = &near.piece[..];
        let edges = &near.incidence.edges;
        let x = mesh.positions();
        let length = |[a, b]: &[u32; 2]| (x[*a as usize] - x[*b as usize]).norm();
        let own = || edges.iter().filter(|ends| (ends[0] as usize) < near.cloth);
        let edge = own().map(length).sum::<Real>() / own().count().max(1) as Real;
        let middle = |t: u32| gather(x, mesh.triangles()[t as usize]).iter().sum::<Vec3>() / 3.0;
        let mut all: Vec<u32> = (0..mesh.triangle_count() as u32).collect();
        all.sort_by_key(|&t| piece[mesh.triangles()[t as usize][0] as usize]);
        let mut members = Vec::new();
        let of = |t: &u32| piece[mesh.triangles()[*t as usize][0] as usize];
        for piece in all.chunk_by_mut(|a, b| of(a) == of(b)) {
            halve(piece, &middle, &mut |triangles| {
                let corners = triangles.iter().flat_map(|&t| mesh.triangles()[t as usize]);
                let mut vertices: Vec<u32> = corners.collect();
                vertices.sort_unstable();
                vertices.dedup();
                members.push((triangles.to_vec(), vertices));
            });
        }
        let is_own = |(_, vertices): &&(Vec<u32>, Vec<u32>)| (vertices[0] as usize) < near.cloth;
        let count = members.len();
        let (mut groups, mut starts) = (Vec::new(), vec![0]);
        for (_, vertices) in &members {
            groups.extend(frame::groups(vertices, x));
            starts.push(groups.len());
        }
        let motions = || Motions::new(count, groups.len());
        Self {
            cloth: members.iter().take_while(is_own).count(),
            rests: vec![false; count],
            edge,
            reference: vec![[[0.0; 4]; 3]; groups.len()],
            reference_spreads: vec![0.0; count],
            now: motions(),
            then: motions(),
            displacements: vec![0.0; count],
            is_settled: vec![false; count],
            strays: vec![0.0; count],
            besides: vec![0.0; count],
            turns: vec![Mat3::identity(); count],
            tilts: vec![0.0; count],
            drift: vec![0.0; count],
            boxes: vec![Bounds::around([Vec3::zeros()]); count],
            members,
            groups,
            starts,
            broad_phase: near.own.broad_phase.create(),
            ..Self::default()
        }
    }

    /// Forgets the motion so far, for a cloth that is at `x` (m) now and was elsewhere before.
    pub(super) fn forget(&mut self, x: &[Vec3], is_resting: &[bool]) {
        let count = self.members.len();
        // All move until they have been found once.
        self.moving.clear();
        self.moving.extend(0..count as u32);
        self.reference_spreads.fill(0.0);
        self.place(x);
        let now = &mut self.now;
        now.still = 0.0;
        for numbers in [&mut now.spreads, &mut now.paths, &mut now.clocks] {
            numbers.fill(0.0);
        }
        (0..count).for_each(|p| self.refer(p));
        self.then.copy(&self.now);
        self.displacements.fill(0.0);
        self.strays.fill(0.0);
        self.besides.fill(0.0);
        self.turns.fill(Mat3::identity());
        self.tilts.fill(0.0);
        for (p, (_, vertices)) in self.members.iter().enumerate().skip(self.cloth) {
            self.rests[p] = vertices.iter().all(|&v| is_resting[v as usize]);
        }
        let rests = &self.rests;
        self.moving.retain(|&p| !rests[p as usize]);
        self.is_known = false;
    }

    /// Brings what is known to `to` (m), in substeps that could be left out.
    pub(super) fn skip(&mut self, to: &[Vec3]) {
        self.measure(to, false);
        self.accept();
    }

    /// Brings the travel of two patches up to the start of the substep.
    fn bring_up(&mut self, k: usize) {
        let pair = &mut self.pairs[k];
        let (apart, path) = self.now.of(pair.patches);
        pair.travel += (apart - pair.last_apart).norm() + path - pair.last_path;
        (pair.last_apart, pair.last_path) = (apart, path);
    }

    /// How far (m) every vertex may go from where it is now, besides what all do together, while nothing comes near;
    /// nothing if something has just been looked into.
    pub(super) fn margin(&mut self) -> Option<Real> {
        if self.awake > 0 || !self.is_known {
            return None;
        }
        let known = self.reach - self.stray();
        let pairs = self.ids.iter().zip(&self.quiet);
        let left = pairs.map(|(&patches, quiet)| quiet - self.clock(&self.now, patches));
        Some(0.5 * left.fold(known, Real::min))
    }

    /// Whether a pair has a row of this substep, or of the one before.
    fn has_row(&self, pair: &NearPair) -> bool {
        pair.seen > 0 && self.substep - pair.seen <= 1
    }

    /// Number of pairs of patches that are near enough to be looked at.
    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.pairs.len()
    }

    /// Makes sure that the pairs are complete for a substep from `x` to `to` (m), and adds rows to `lists` of those
    /// that the motion can bring into contact: all if the substep `begins`, and what it has not seen if the motion has
    /// become another one. Returns false if a path is longer than some edges, which needs more room than patches have.
    ///
    /// `visit` adds one row to the list that it gets, for a pair, with where its row of the substep before is, if it
    /// had one, and the travel (m) of its patches; it returns what the pair lacks to contact (m).
    pub(super) fn look<T: Send>(
        &mut self,
        near: &Near,
        [x, to]: [&[Vec3]; 2],
        begins: bool,
        lists: &mut Vec<Vec<T>>,
        visit: impl Fn(&mut Vec<T>, &mut NearPair, Option<[u32; 2]>, Real) -> Real + Sync,
    ) -> bool {
        self.measure(to, false);
        let (aim, then) = (&mut self.aim, &self.then);
        if begins {
            self.substep += 1;
            self.awake = 0;
            let centres = then.frames.iter().map(|frame| frame.centre);
            aim.clear();
            aim.extend(centres);
            self.aim_displacements.clone_from(&self.displacements);
            self.drift.fill(0.0);
        } else {
            for (p, drift) in self.drift.iter_mut().enumerate() {
                let further = self.displacements[p] - self.aim_displacements[p];
                let centre = then.frames[p].centre - aim[p];
                *drift = centre.norm() + further.max(0.0);
            }
        }
        if !self.is_known || self.has_strayed(0.0) {
            let displacement = self.longest_stray();
            if displacement > FARTHEST * self.edge {
                self.is_known = false;
                return false;
            }
            self.reach = (2.0 * displacement).max(REACH * self.edge);
            self.search(near, x);
        }
        let slack = super::rows::SLACK * near.law.range();
        let mut looks = std::mem::take(&mut self.looks);
        looks.clear();
        for k in 0..self.pairs.len() {
            if self.clock(&self.then, self.ids[k]) > self.quiet[k] {
                // What was looked into with the slack needs no other look for less.
                let [p, q] = self.ids[k].map(|p| p as usize);
                let seen = self.awake_in[k] == self.substep;
                if seen && self.drift[p] + self.drift[q] <= slack {
                    continue;
                }
                if begins {
                    self.awake_in[k] = self.substep;
                }
                self.awake += 1;
                self.bring_up(k);
                let once = self.once(self.ids[k]) + slack;
                let now = self.moved(k, once);
                let (moved, pair) = (now + once, &self.pairs[k]);
                let again = pair.looked_in == self.substep;
                if !again || moved > pair.looked[0] || pair.travel + once > pair.looked[1] {
                    looks.push(Look::new(k, [now, moved, once]));
                }
            }
        }
        self.find(near, x, &mut looks);
        // What is seen at the beginning fills some lists, and what else comes the next one.
        let first = if begins { 0 } else { self.filled };
        let count = match begins {
            true => looks.len().div_ceil(LOOKS),
            false => 1,
        };
        if begins {
            self.filled = count;
        }
        if lists.len() <= first + count {
            lists.resize_with(first + count + 1, Vec::new);
        }
        let visits = Visits {
            substep: self.substep,
            vertices: x.len(),
            visit: &visit,
        };
        let lists = &mut lists[first..first + count];
        visits.wake_all(&mut looks, (&mut self.pairs, 0), (lists, first as u32));
        for look in &looks {
            let k = look.number as usize;
            self.quiet[k] = self.clock(&self.now, self.ids[k]) + look.left - slack;
        }
        self.looks = looks;
        true
    }

    /// Finds the pairs of patches that are near each other now.
    fn search(&mut self, near: &Near, x: &[Vec3]) {
        self.searches += 1;
        let moving = std::mem::take(&mut self.moving);
        moving.iter().for_each(|&p| self.refer(p as usize));
        self.moving = moving;
        let reach = self.reach + 0.5 * near.law.range();
        for (bounds, (_, vertices)) in self.boxes.iter_mut().zip(&self.members) {
            *bounds = around(vertices, x).inflated(reach);
        }
        self.broad_phase.overlapping(&self.boxes, &mut self.ids);
        let own = (0..self.members.len() as u32).map(|p| [p, p]);
        self.ids.extend(own);
        let members = &self.members;
        let meet = |pair: &[u32; 2]| near.patches_meet(pair.map(|p| members[p as usize].1[0]));
        self.ids.retain(meet);
        self.ids.sort_unstable();
        self.searched.copy(&self.now);
        std::mem::swap(&mut self.pairs, &mut self.before);
        let mut known = self.before.drain(..).peekable();
        for &patches in &self.ids {
            while let Some(old) = known.next_if(|old| old.patches < patches) {
                self.spare.push(old);
            }
            if let Some(old) = known.next_if(|old| old.patches == patches) {
                // What is not known any more leaves lists of the right size.
                let keeps = self.is_known;
                self.pairs.push(if keeps { old } else { old.of(patches) });
                continue;
            }
            let spare = self.spare.pop().unwrap_or_default();
            self.pairs.push(spare.of(patches));
        }
        self.quiet.clear();
        self.quiet.resize(self.ids.len(), Real::NEG_INFINITY);
        self.awake_in.clear();
        self.awake_in.resize(self.ids.len(), 0);
        self.spare.extend(known);
        self.is_known = true;
    }
}

fn around(vertices: &[u32], x: &[Vec3]) -> Bounds {
    let mut bounds = Bounds::around([x[vertices[0] as usize]]);
    for &v in &vertices[1..] {
        bounds.lower = bounds.lower.inf(&x[v as usize]);
        bounds.upper = bounds.upper.sup(&x[v as usize]);
    }
    bounds
}

/// Cuts a set of triangles across its longest side, until the parts are small enough.
fn halve(triangles: &mut [u32], middle: &impl Fn(u32) -> Vec3, done: &mut impl FnMut(&[u32])) {
    if triangles.len() <= PATCH {
        done(triangles);
        return;
    }
    let first = middle(triangles[0]);
    let (lower, upper) = triangles.iter().fold((first, first), |(low, high), &t| {
        (low.inf(&middle(t)), high.sup(&middle(t)))
    });
    let axis = (upper - lower).imax();
    triangles.sort_by(|&a, &b| middle(a)[axis].total_cmp(&middle(b)[axis]));
    let (a, b) = triangles.split_at_mut(triangles.len() / 2);
    halve(a, middle, done);
    halve(b, middle, done);
}
