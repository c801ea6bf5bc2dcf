//! Which pairs can touch in a substep, from bounds on the relative motion of patches of the cloth.
//!
//! # Words
//!
//! | word | what it is (m) | in the code |
//! |---|---|---|
//! | spread | by how much a patch has deformed, at most, beside its rigid motion | `spreads` |
//! | change | by how much distances of two patches change in the motion at hand, at most | `change` |
//! | travel | sum of the changes since the last detection between the two | `travel` |
//! | moved | the bound from the two poses and spreads, at the last detection and now | `moved` |
//! | stray | how far a vertex goes relative to the mean motion of the whole cloth | `stray`, `strayed` |
//! | settle | not a length: finds axes and spread of a patch, once they are needed | `settle` |
//!
//! # The bound
//!
//! A patch is at most 32 neighbouring triangles. Its motion is described by a frame, which is the centre c, the mean of
//! its vertices, and axes F, a rotation that turns with them (`frame`); and by its spread s (m). The spread is counted
//! from a *reference*, a moment at which the patch had the positions x̄, the frame c̄, F̄ and the spread s̄:
//!
//! s = s̄ + max ‖(x − c) − F F̄ᵀ (x̄ − c̄)‖ over the vertices of the patch.
//!
//! A new reference (`refer`) takes what s is there for its s̄, so s does not jump. Each detection between two patches p
//! and q first takes a new one for both (`find`); let the index 0 stand for that moment. Seen from the frame of p, q
//! has the centre a = F_pᵀ (c_q − c_p) and the axes P = F_pᵀ F_q (`RelativePose`). Since the detection the distance of
//! any point of p from any point of q has changed by no more than
//!
//! ‖a − a₀‖ + ‖P − P₀‖₂ r_q + (s_p − s_p₀) + (s_q − s_q₀),
//!
//! r_q the distance of the farthest vertex of q from its centre at the detection.
//!
//! The reason:
//!
//! - A point of q that was at z in its frame, ‖z‖ ≤ r_q, was at a₀ + P₀ z as seen from p. If it keeps its place in the
//!   frame, it is at a + P z now.
//! - A vertex has left its place in the frame by no more than s − s̄ since the last reference, and from each reference to
//!   the next by no more than s̄ has grown. Together that is s − s₀, and a point of a triangle is a mean of vertices.
//! - This needs a reference at the detection. With an older one a vertex that goes back to x̄ moves while s falls.
//!
//! # What follows from it
//!
//! Detection between two patches finds all pairs of primitives nearer than their range plus a motion bound, and sorts
//! them by their excess gap (the distance less the range). As long as the expression above is less than the bound, the
//! list is complete, and only the pairs at its beginning, with an excess gap below the expression, can touch. A common
//! motion of two patches cancels, and what goes to and fro does not add up. So cloth that flies or swings as a whole
//! needs no detection.
//!
//! # The motion at hand
//!
//! Each path is measured before it is used (`detect_for_substep`, before the sweeps and again after them; `choose` and
//! `holds` of a minimisation). From its start to its end, a distance between p and q changes by no more than
//!
//! ‖b′ − R_p b‖ + ‖R_p − R_q‖₂ r_q + e_p + e_q, b = c_p − c_q at its start, b′ at its end.
//!
//! Here R_p and R_q are any rotations, and e_p is the most by which a vertex of p leaves R_p: one at x − c from the
//! centre before is at R_p (x − c) and something of at most e_p from the centre after; e_q is the same of q. The
//! reason: the difference of a point of p and one of q is d before. After it is R_p d + (b′ − R_p b) + (R_p − R_q) z
//! and what the two leave, where z goes from the centre of q to its point. So its length has changed by no more than
//! the lengths of the other terms.
//!
//! Which rotations. A substep is short and takes R = 1. That leaves ‖b′ − b‖ and the largest displacements relative to
//! the centres. A path of a minimisation takes the turns of the frames, unless they are more than 0.2.
//!
//! In between the two ends vertices go straight, while the patches turn: a vertex cuts across the arc, along its chord,
//! and comes nearer by up to the height of that. `change_for` allows for it. The sum of both is the *change* of two
//! patches, and is added up to their *travel* since the last detection. The travel never falls, and so bounds the
//! relative motion from each moment in between. It has three uses:
//!
//! - a pair of primitives with a known excess gap need not be asked before the travel has grown by that
//!   (`active_from`);
//! - two patches need not be asked before it has grown by the least of these (`left`), which takes one comparison;
//! - nearest points are kept for a travel of 0.02 h (`known_at`).
//!
//! Only where the travel does not tell is the bound since the last detection evaluated (`moved`), which is dearer.
//!
//! The predicted motion of a substep is asked about with 0.05 h to spare. Where the sweeps change it by less, nothing
//! is asked after them (`allowed`).
//!
//! Which patches are near each other is found by a broad phase from their boxes, moved outwards by l + h/2. Here l is
//! 0.3 mean edges, or twice the longest displacement of the path if that is more; displacements are relative to the
//! mean motion. The answer is good while no vertex has gone farther than l. A bound on that is the sum of the longest
//! displacements of all motions since; only where it exceeds l is it measured for each vertex (`has_strayed`). Bodies
//! have an l of their own: before a cloth that falls they go as fast as it does, while its own parts keep together. If
//! they are farther away than that, it is as much as leaves none of them near.

mod between;
mod detect;
mod frame;
mod lists;
mod measure;
mod path;

use super::constraints::DETECTION_MARGIN;
use super::near::Near;
use crate::bounds::Bounds;
use crate::broad_phase::{BroadPhase, OfKind};
use crate::pair::Pair;
use between::{PatchPair, Visits};
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use detect::PatchQuery;
use frame::{Four, Group};
use lists::LATER;
pub(super) use lists::Lists;
use measure::{PatchMotion, Places};

/// Queries whose constraints are in one list.
const QUERIES: usize = 512;
/// Triangles in a patch, at most.
const PATCH: usize = 32;
/// Motion bound (in thicknesses) of a detection, at least.
const LEAST_BOUND: Real = 0.5;
/// The same, in paths of the substep that needs it.
const MOTIONS: Real = 60.0;
/// The same (in mean edges), at most, unless one substep needs more.
const LARGEST_BOUND: Real = 0.5;
/// Pairs of patches for each patch, above which the largest bound is less in the same measure: where many layers lie on
/// each other, it would reach across several of them.
const CROWDED: Real = 8.0;
/// Path (in mean edges) that a patch may go until pairs of patches are searched anew, at least; and in one substep, at
/// most.
const REACH: Real = 0.3;
const FARTHEST: Real = 30.0;
/// Fraction of their distance that bodies may come nearer, at least, before that.
const FURTHER: Real = 0.9;

/// Two primitives that can touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearPair {
    /// Excess gap (m) when they were found.
    excess: Real,
    /// Distance (m) at which they begin to touch.
    pub(super) range: Real,
    /// Area (m²) that they stand for.
    pub(super) area: Real,
    pub(super) pair: Pair,
    /// Travel of the patches (m) at which their nearest points were found; −∞ where these are not known.
    pub(super) known_at: Real,
    /// The substep in which they got a constraint last, from 1 on, and where it is: the number of the list, and in it.
    seen: u32,
    constraint: [u32; 2],
}

#[derive(Clone, Debug, Default)]
pub(super) struct Patches {
    /// Patches of the cloth; the others are those of bodies.
    cloth: usize,
    /// Patches of bodies that have not moved, and the numbers of the others.
    rests: Vec<bool>,
    moving: Vec<u32>,
    /// Triangles and vertices of each patch.
    members: Vec<(Vec<u32>, Vec<u32>)>,
    edge: Real,
    /// How far (m) a vertex of the cloth may go relative to the mean motion, and one of a body, until pairs of patches
    /// are searched anew; how far one has gone, at most; and where all were at the last search (m).
    reach: [Real; 2],
    strayed: [Real; 2],
    searched: Vec<Vec3>,
    /// Groups of vertices of all patches, and where those of each begin.
    groups: Vec<Group>,
    starts: Vec<usize>,
    /// Positions (m) of the vertices in the frame of the patch, from which its spread is counted, and the spread there.
    reference: Vec<Four>,
    reference_spreads: Vec<Real>,
    /// At the start of the substep, and at the end of the motion at hand.
    now: Places,
    then: Places,
    /// Whether axes, radius and spread of a patch are known at the start.
    is_settled: Vec<bool>,
    /// The motion at hand, and whether it counts turns apart.
    motions: Vec<PatchMotion>,
    turns: bool,
    boxes: Vec<Bounds>,
    broad_phase: OfKind,
    pairs: Vec<PatchPair>,
    /// The two patches of each of them; how far they may move (m) from where they are at the start of the substep until
    /// a pair may touch that has not been asked; and the change (m) that present constraints or choices are good for.
    ids: Vec<[u32; 2]>,
    left: Vec<Real>,
    allowed: Vec<Real>,
    before: Vec<PatchPair>,
    /// Lists to be used again.
    spare: Vec<PatchPair>,
    queries: Vec<PatchQuery>,
    is_known: bool,
    /// The largest motion bound of a detection: this fraction of what it is where cloth lies in few layers.
    share: Real,
    /// Number of the substep, and whether anything was asked in it.
    substep: u32,
    has_asked: bool,
    /// Searches among pairs of patches so far, and among their triangles.
    pub(super) searches: u32,
    pub(super) detections: u32,
}

impl Patches {
    pub(super) fn new(mesh: &TriMesh, near: &Near) -> Self {
        let component = &near.component[..];
        let edges = &near.incidence.edges;
        let x = mesh.positions();
        let length = |[a, b]: &[u32; 2]| (x[*a as usize] - x[*b as usize]).norm();
        let own = || edges.iter().filter(|ends| (ends[0] as usize) < near.cloth);
        let edge = own().map(length).sum::<Real>() / own().count().max(1) as Real;
        let middle = |t: u32| gather(x, mesh.triangles()[t as usize]).iter().sum::<Vec3>() / 3.0;
        let mut all: Vec<u32> = (0..mesh.triangle_count() as u32).collect();
        all.sort_by_key(|&t| component[mesh.triangles()[t as usize][0] as usize]);
        let mut members = Vec::new();
        let of = |t: &u32| component[mesh.triangles()[*t as usize][0] as usize];
        for component in all.chunk_by_mut(|a, b| of(a) == of(b)) {
            halve(component, &middle, &mut |triangles| {
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
        let places = || Places::new(count, groups.len());
        Self {
            cloth: members.iter().take_while(is_own).count(),
            rests: vec![false; count],
            edge,
            reference: vec![[[0.0; 4]; 3]; groups.len()],
            reference_spreads: vec![0.0; count],
            now: places(),
            then: places(),
            is_settled: vec![false; count],
            motions: vec![PatchMotion::NONE; count],
            boxes: vec![Bounds::around([Vec3::zeros()]); count],
            members,
            groups,
            starts,
            broad_phase: OfKind::new(near.own.broad_phase),
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
        (0..count).for_each(|p| self.refer(p));
        self.then.copy(&self.now);
        self.motions.fill(PatchMotion::NONE);
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

    /// How far (m) every vertex may go from where it is now, relative to the mean motion, while nothing of the cloth
    /// comes near the cloth; and how far that and the mean motion may go, each, while it comes near no body that rests.
    /// Nothing if something has just been asked.
    pub(super) fn margins(&self) -> Option<[Real; 2]> {
        if self.has_asked || !self.is_known {
            return None;
        }
        let mut margins = [0, 1].map(|of| self.reach[of] - self.strayed[of]);
        for ([_, other], left) in self.ids.iter().zip(&self.left) {
            let margin = &mut margins[usize::from(*other as usize >= self.cloth)];
            *margin = margin.min(*left);
        }
        Some(margins.map(|margin| 0.5 * margin))
    }

    /// Whether a pair has a constraint of this substep, or of the one before.
    fn has_constraint(&self, pair: &NearPair) -> bool {
        pair.seen > 0 && self.substep - pair.seen <= 1
    }

    /// Number of pairs of patches that are near enough to be asked.
    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.pairs.len()
    }

    /// Makes sure that the pairs are complete for a substep from `x` to `to` (m), and adds constraints to `lists` of
    /// those that the motion can bring into contact: all if the substep `begins`, and what has none yet if the motion
    /// has become another one. Returns false if a path is longer than some edges, which is more than patches allow for.
    ///
    /// `visit` adds one constraint to the list that it gets, for a pair, with where its constraint of the substep
    /// before is, if it had one, and the travel (m) of its patches; it returns the excess gap of the pair (m).
    pub(super) fn detect_for_substep<T: Send>(
        &mut self,
        near: &Near,
        [x, to]: [&[Vec3]; 2],
        begins: bool,
        lists: &mut Lists<T>,
        visit: impl Fn(&mut Vec<T>, &mut NearPair, Option<[u32; 2]>, Real) -> Real + Sync,
    ) -> bool {
        self.measure(to, false);
        if begins {
            self.substep += 1;
            self.has_asked = false;
            self.allowed.fill(Real::NEG_INFINITY);
        }
        if !self.is_known || self.has_strayed(near, x, 0.0) {
            let too_far = FARTHEST * self.edge;
            let [own, bodies] = self.longest_strays();
            if own <= too_far {
                self.search(near, x, 0.0);
            }
            if own > too_far || bodies > too_far && self.has_bodies_near() {
                self.is_known = false;
                return false;
            }
        }
        let margin = DETECTION_MARGIN * near.law.range();
        let mut queries = std::mem::take(&mut self.queries);
        queries.clear();
        for k in 0..self.pairs.len() {
            self.allowed[k] = self.allowed[k].max(self.left[k] - margin);
            if self.change(k, self.allowed[k]) > self.allowed[k] {
                let once = self.change(k, 0.0) + margin;
                self.allowed[k] = once;
                let now = self.moved(k, once);
                queries.push(PatchQuery::new(k, now, once));
            }
        }
        self.has_asked |= !queries.is_empty();
        self.find(near, x, &mut queries);
        let visits = Visits {
            substep: self.substep,
            vertices: x.len(),
            visit: &visit,
        };
        let (lists, first) = match begins {
            true => (lists.begin(queries.len().div_ceil(QUERIES)), 0),
            false => (std::slice::from_mut(&mut lists.later), LATER),
        };
        visits.ask_all(&mut queries, (&mut self.pairs, 0), (lists, first));
        for query in &queries {
            self.left[query.number as usize] = query.left;
        }
        self.queries = queries;
        true
    }

    /// Whether one of the patches that are near each other is that of a body.
    fn has_bodies_near(&self) -> bool {
        let cloth = self.cloth as u32;
        self.ids.iter().any(|[_, other]| *other >= cloth)
    }

    /// Finds the pairs of patches that are near each other now, for the motion at hand with all within `margin` (m) of
    /// its end, and more.
    fn search(&mut self, near: &Near, x: &[Vec3], margin: Real) {
        self.searches += 1;
        for (bounds, (_, vertices)) in self.boxes.iter_mut().zip(&self.members) {
            *bounds = Bounds::of_vertices(vertices, x);
        }
        let h = near.law.range();
        let least = REACH * self.edge;
        self.reach = self
            .longest_strays()
            .map(|stray| (2.0 * (stray + margin)).max(least));
        let (own, bodies) = self.boxes.split_at_mut(self.cloth);
        let around = |boxes: &[Bounds]| boxes.iter().copied().reduce(|a, b| a.joined(&b));
        if let (Some(own), Some(bodies)) = (around(own), around(bodies)) {
            let apart = own.axis_gap(&bodies) - h - self.reach[0];
            self.reach[1] = self.reach[1].max(FURTHER * apart);
        }
        for (boxes, reach) in [own, bodies].into_iter().zip(self.reach) {
            for bounds in boxes {
                *bounds = bounds.inflated(reach + 0.5 * h);
            }
        }
        self.broad_phase.overlapping(&self.boxes, &mut self.ids);
        let own = (0..self.members.len() as u32).map(|p| [p, p]);
        self.ids.extend(own);
        let members = &self.members;
        let meet = |pair: &[u32; 2]| near.patches_meet(pair.map(|p| members[p as usize].1[0]));
        self.ids.retain(meet);
        self.ids.sort_unstable();
        self.share = (CROWDED * self.members.len() as Real / self.ids.len() as Real).min(1.0);
        x.clone_into(&mut self.searched);
        self.strayed = [0.0; 2];
        std::mem::swap(&mut self.pairs, &mut self.before);
        let mut left = std::mem::take(&mut self.allowed);
        left.clear();
        let mut known = self.before.drain(..).zip(&self.left).peekable();
        for &patches in &self.ids {
            while let Some((old, _)) = known.next_if(|(old, _)| old.patches < patches) {
                self.spare.push(old);
            }
            match known.next_if(|(old, _)| old.patches == patches) {
                Some((old, still)) if self.is_known => {
                    self.pairs.push(old);
                    left.push(*still);
                }
                // What is not known any more leaves lists of the right size.
                old => {
                    let old = old.map(|(old, _)| old).or_else(|| self.spare.pop());
                    self.pairs.push(old.unwrap_or_default().of(patches));
                    left.push(Real::NEG_INFINITY);
                }
            }
        }
        self.spare.extend(known.map(|(old, _)| old));
        self.allowed = std::mem::replace(&mut self.left, left);
        self.allowed.clear();
        self.allowed.resize(self.ids.len(), Real::NEG_INFINITY);
        self.is_known = true;
    }
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
