//! Which pairs can touch in a substep, from bounds on the relative motion of patches of the cloth.
//!
//! # The bound
//!
//! A patch is at most 32 neighbouring triangles. Its motion is described by its centre c, the mean of its vertices, and
//! by its spread s (m). The spread is counted from reference positions x̄: those that its vertices had at one moment,
//! when it had the centre c̄ and the spread s̄. At the positions x it is
//!
//! s = s̄ + max ‖(x − c) − (x̄ − c̄)‖ over the vertices of the patch.
//!
//! Where reference positions are taken anew (`refer`), s̄ becomes what s is there, so s does not jump. Let 0 be a
//! moment at which those of both patches p and q were taken, the last one or an earlier one. Since then two points of p
//! and q have moved relative to each other by no more than
//!
//! ‖(c_p − c_q) − (c_p − c_q)₀‖ + (s_p − s_p₀) + (s_q − s_q₀).
//!
//! This is so because a vertex has moved relative to the centre by no more than s − s̄ since the last reference
//! positions, and from one set of them to the next by no more than the difference of their s̄. These add up to s − s₀,
//! and a point of a triangle is a mean of vertices. From another moment the inequality does not hold: a vertex that
//! goes back towards its reference position moves, and s falls. So each detection between two patches first takes the
//! reference positions of both anew (`find`), and each search for pairs of patches those of all (`search`). What is
//! kept to compare with (`apart` and `spread` of a `PatchPair`, `searched` of `Patches`) is from these moments.
//!
//! # What follows from it
//!
//! Detection between two patches finds all pairs of primitives nearer than h plus a motion bound (`room` in the code),
//! and sorts them by d − h. As long as the expression above is less than the bound, the list is complete, and only the
//! pairs at its beginning, with d − h below the expression, can touch. The common motion of two patches cancels in
//! c_p − c_q, so cloth that flies as a whole needs no detection.
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
//! - *Spread* of a patch, *bound* of two (`Motions::bound`): as above, since the last detection. What goes to and fro
//!   does not add up. They tell whether a list is complete, and which pairs at its beginning may touch.
//! - *Stray* of a patch (`stray`): how far it has gone since pairs of patches were searched, besides the mean of all of
//!   the cloth, by its centre and its spread. As long as no stray is more than r, only pairs of patches that were found
//!   can be near each other.
//! - *Path* of a patch (`Motions::paths`): how far a vertex goes relative to the centre in a substep, at most, added up
//!   over the substeps. *Travel* of two (`PatchPair::travel`): the displacements of c_p − c_q and the paths of both,
//!   added up from look to look (`bring_up`) since the last detection. It never falls, and bounds the relative motion
//!   since each look in between: a pair that lacks something then need not be asked before the travel has grown by that
//!   (`wakes`), and nearest points stay what they are for a travel of 0.02 h (`Known`).
//! - *Clock* of a patch (`Motions::clocks`): the displacement of its centre besides that of the mean of all of the
//!   cloth, and its path, added up over the substeps. It never goes back, and two patches move relative to each other
//!   by no more than both clocks advance together. So a look notes the sum of two clocks until which nothing can happen
//!   (`quiet`); to ask again takes one sum and one comparison for each pair of patches.
//! - *Aim*: where the substep was to end when it was looked at first. *Drift* of a patch: by how much it can have moved
//!   farther than on the way to the aim, where the substep, after sweeps, ends elsewhere. The first look allows for
//!   0.05 h more than the motion at hand; while the drifts of two patches are together within that, they need no other.

mod between;
mod detect;
mod motion;
mod motions;

use super::near::Near;
use crate::bounds::Bounds;
use crate::broad_phase::BroadPhase;
use crate::pair::{Gap, Pair};
use between::PatchPair;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use detect::Look;
use motions::Motions;

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
    /// The substep that they were looked at in.
    seen: u32,
    /// The number of what is remembered of them, if anything is.
    memory: u32,
}

/// What is remembered of two primitives that have been looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Memory {
    pair: Pair,
    /// By how much friction has been stretched (m).
    pub(super) stretch: Vec3,
    /// Across a plane that has had the two apart.
    pub(super) normal: Vec3,
    /// Where they were nearest when that was last found.
    pub(super) known: Option<Known>,
}

/// Nearest points of two primitives, which stay while their patches hardly move against each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    pub(super) gap: Gap,
    /// Area (m²) that they stand for.
    pub(super) area: Real,
    /// Travel of the patches (m).
    pub(super) travel: Real,
}

/// Where a pair is: its patches, the number that they had then, and its number there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    patches: [u32; 2],
    number: u32,
    index: u32,
}

#[derive(Debug, Default)]
pub(super) struct Patches {
    /// Patches of the cloth; the others are those of bodies.
    cloth: usize,
    /// Patches of prescribed vertices that have not moved.
    rests: Vec<bool>,
    /// Triangles and vertices of each patch.
    members: Vec<(Vec<u32>, Vec<u32>)>,
    edge: Real,
    /// Path (m) that a patch may go besides what all do together, until pairs of patches are searched anew.
    reach: Real,
    /// Positions (m) of the vertices of each patch from which its spread is counted, their centre, and the spread
    /// there.
    reference: Vec<Vec<Vec3>>,
    reference_centres: Vec<Vec3>,
    reference_spreads: Vec<Real>,
    /// At the start of the substep, and at the end that is looked at.
    now: Motions,
    then: Motions,
    /// How far a vertex goes besides its centre in between (m).
    displacements: Vec<Real>,
    /// Where a substep was to end when pairs were looked into first, how far a vertex was to go besides its centre (m),
    /// and the drift of each patch from there (m) at another look; of each pair of patches, the substep at whose
    /// beginning it was looked into.
    aim: Motions,
    aim_displacements: Vec<Real>,
    drift: Vec<Real>,
    awake_in: Vec<u32>,
    /// What was allowed for when pairs were chosen: relative motion (m) of two patches between which something can
    /// touch, by their number, and of a patch and all.
    allowed: Vec<(u32, Real)>,
    stray_allowed: Vec<Real>,
    /// When pairs of patches were searched.
    searched: Motions,
    boxes: Vec<Bounds>,
    broad_phase: Box<dyn BroadPhase>,
    found: Vec<[u32; 2]>,
    pairs: Vec<PatchPair>,
    /// The two patches of each of them, and the sum of their clocks (m; how far they have moved, see above) until which
    /// nothing can happen between them.
    ids: Vec<[u32; 2]>,
    quiet: Vec<Real>,
    before: Vec<PatchPair>,
    /// Lists to be used again.
    spare: Vec<PatchPair>,
    /// Pairs of patches that the motion at hand asks for.
    looks: Vec<Look>,
    is_known: bool,
    /// Whether patches have been where they rest now.
    is_placed: bool,
    /// Number of the substep.
    substep: u32,
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
        let places = |(_, vertices): &(Vec<u32>, Vec<u32>)| vec![Vec3::zeros(); vertices.len()];
        Self {
            cloth: members.iter().take_while(is_own).count(),
            rests: vec![false; count],
            edge,
            reference: members.iter().map(places).collect(),
            reference_centres: vec![Vec3::zeros(); count],
            reference_spreads: vec![0.0; count],
            now: Motions::new(count),
            then: Motions::new(count),
            displacements: vec![0.0; count],
            drift: vec![0.0; count],
            boxes: vec![Bounds::around([Vec3::zeros()]); count],
            members,
            broad_phase: near.own.broad_phase.create(),
            ..Self::default()
        }
    }

    /// Forgets the motion so far, for a cloth that is at `x` (m) now and was elsewhere before.
    pub(super) fn forget(&mut self, x: &[Vec3], is_resting: &[bool]) {
        for (rests, (_, vertices)) in self.rests.iter_mut().zip(&self.members) {
            *rests = vertices.iter().all(|&v| is_resting[v as usize]);
        }
        for (p, (_, vertices)) in self.members.iter().enumerate() {
            let places = self.reference[p].iter_mut().zip(vertices);
            places.for_each(|(place, &v)| *place = x[v as usize]);
            self.reference_centres[p] = middle(vertices, x);
        }
        self.reference_spreads.fill(0.0);
        self.now.paths.fill(0.0);
        self.now.clocks.fill(0.0);
        self.is_placed = false;
        self.place(x);
        self.is_known = false;
    }

    /// The most that two patches move relative to each other in the substep (m).
    #[inline]
    fn once(&self, pair: &PatchPair) -> Real {
        let [p, q] = pair.patches.map(|p| p as usize);
        let (now, then) = (&self.now, &self.then);
        let displacement = then.centres[p] - now.centres[p] - (then.centres[q] - now.centres[q]);
        displacement.norm() + self.displacements[p] + self.displacements[q]
    }

    /// The substep ends where it was looked at last.
    pub(super) fn accept(&mut self) {
        std::mem::swap(&mut self.now, &mut self.then);
    }

    /// Brings what is known from `from` to `to` (m), in substeps that could be left out.
    pub(super) fn skip(&mut self, from: &[Vec3], to: &[Vec3]) {
        self.measure(from, to);
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
    pub(super) fn margin(&self) -> Option<Real> {
        if self.awake > 0 || !self.is_known {
            return None;
        }
        let pairs = self.ids.iter().zip(&self.quiet);
        let left = pairs.map(|(&patches, quiet)| quiet - self.now.clock(patches));
        let known = self.reach - Self::stray(&self.searched, &self.now);
        Some(0.5 * left.fold(known, Real::min))
    }

    /// The pair at a place, or where it has gone since, and what is remembered of it.
    pub(super) fn pair_mut(
        &mut self,
        place: Place,
        pair: Pair,
    ) -> Option<(&NearPair, &mut Memory)> {
        let number = place.number as usize;
        let number = match self.ids.get(number) {
            Some(ids) if *ids == place.patches => number,
            _ => self.ids.binary_search(&place.patches).ok()?,
        };
        let between = &mut self.pairs[number];
        let pairs = &mut between.pairs;
        let is_it = |found: &NearPair| found.pair == pair;
        let index = match place.index as usize {
            index if pairs.get(index).is_some_and(is_it) => index,
            _ => pairs.iter().position(is_it)?,
        };
        let found = &mut pairs[index];
        let memory = found.remember(&mut between.memories);
        Some((found, memory))
    }

    /// Number of pairs of patches that are near enough to be looked at.
    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.pairs.len()
    }

    /// Takes `x` (m) for the start of the substep.
    pub(super) fn place(&mut self, x: &[Vec3]) {
        let now = &mut self.now;
        for (p, (_, vertices)) in self.members.iter().enumerate() {
            if self.rests[p] && self.is_placed {
                continue;
            }
            let centre = middle(vertices, x);
            let displacement = centre - self.reference_centres[p];
            let places = vertices.iter().zip(&self.reference[p]);
            let besides =
                places.map(|(&v, from)| (x[v as usize] - from - displacement).norm_squared());
            let most = besides.fold(0.0, Real::max).sqrt();
            now.centres[p] = centre;
            now.spreads[p] = self.reference_spreads[p] + most;
        }
        now.finish(self.cloth);
        self.is_placed = true;
    }

    /// Looks at the motion from the start of the substep, `x`, to `to` (m).
    fn measure(&mut self, x: &[Vec3], to: &[Vec3]) {
        let (now, then) = (&self.now, &mut self.then);
        for (p, (_, vertices)) in self.members.iter().enumerate() {
            if self.rests[p] {
                then.centres[p] = now.centres[p];
                then.spreads[p] = now.spreads[p];
                self.displacements[p] = 0.0;
                continue;
            }
            let centre = middle(vertices, to);
            let since = centre - self.reference_centres[p];
            let displacement = centre - now.centres[p];
            let (mut spread, mut besides): (Real, Real) = (0.0, 0.0);
            for (&v, from) in vertices.iter().zip(&self.reference[p]) {
                let to = to[v as usize];
                spread = spread.max((to - from - since).norm_squared());
                besides = besides.max((to - x[v as usize] - displacement).norm_squared());
            }
            then.centres[p] = centre;
            then.spreads[p] = self.reference_spreads[p] + spread.sqrt();
            self.displacements[p] = besides.sqrt();
        }
        then.finish(self.cloth);
        let shift = then.mean - now.mean;
        for (p, besides) in self.displacements.iter().enumerate() {
            then.paths[p] = now.paths[p] + besides;
            let displacement = then.centres[p] - now.centres[p] - shift;
            then.clocks[p] = now.clocks[p] + displacement.norm() + besides;
        }
    }

    /// Counts the spread of patch `p` from `x` (m) on, the start of the substep.
    fn refer(&mut self, p: usize, x: &[Vec3]) {
        let places = self.reference[p].iter_mut().zip(&self.members[p].1);
        places.for_each(|(place, &v)| *place = x[v as usize]);
        self.reference_centres[p] = self.now.centres[p];
        self.reference_spreads[p] = self.now.spreads[p];
        self.then.spreads[p] = self.now.spreads[p] + self.displacements[p];
    }

    /// Makes sure that the pairs are complete for a substep from `x` to `to` (m), and hands `visit` those that the
    /// motion can bring into contact: all if the substep `begins`, and what it has not seen if the motion has become
    /// another one. Returns false if a path is longer than some edges, which needs more room than patches have.
    pub(super) fn look(
        &mut self,
        near: &Near,
        [x, to]: [&[Vec3]; 2],
        begins: bool,
        mut visit: impl FnMut(Place, &NearPair, &mut Memory, Real) -> Real,
    ) -> bool {
        self.measure(x, to);
        let (aim, then) = (&mut self.aim, &self.then);
        if begins {
            self.substep += 1;
            self.awake = 0;
            aim.copy(then);
            self.aim_displacements.clone_from(&self.displacements);
            self.drift.fill(0.0);
        } else {
            for (p, drift) in self.drift.iter_mut().enumerate() {
                let further = (self.displacements[p] - self.aim_displacements[p])
                    .max(then.spreads[p] - aim.spreads[p]);
                *drift = (then.centres[p] - aim.centres[p]).norm() + further.max(0.0);
            }
        }
        if !self.is_known || Self::stray(&self.searched, &self.then) > self.reach {
            let displacement = Self::stray(&self.now, &self.then);
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
            if self.then.clock(self.ids[k]) > self.quiet[k] {
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
                let pair = &self.pairs[k];
                let (now, once) = (self.now.bound(pair), self.once(pair) + slack);
                let moved = now.max(self.then.bound(pair)) + slack;
                let again = pair.looked_in == self.substep;
                if !again || moved > pair.looked[0] || pair.travel + once > pair.looked[1] {
                    looks.push(Look::new(k, [now, moved, once]));
                }
            }
        }
        self.find(near, x, &mut looks);
        let substep = self.substep;
        for look in &looks {
            let k = look.number as usize;
            let pair = &mut self.pairs[k];
            let (patches, begun) = (pair.patches, pair.travel);
            pair.looked = [look.moved, begun + look.once];
            pair.looked_in = substep;
            let left = pair.wake(look, |index, one, memories| {
                // Once in a substep.
                (std::mem::replace(&mut one.seen, substep) != substep).then(|| {
                    let place = Place {
                        patches,
                        number: look.number,
                        index,
                    };
                    let memory = one.remember(memories);
                    visit(place, one, memory, begun)
                })
            });
            self.quiet[k] = self.now.clock(patches) + left - slack;
        }
        self.looks = looks;
        true
    }

    /// How far a patch has gone, besides what all do together (m).
    fn stray(old: &Motions, new: &Motions) -> Real {
        let shift = new.mean - old.mean;
        let patches = old.centres.iter().zip(&old.spreads);
        let patches = patches.zip(new.centres.iter().zip(&new.spreads));
        let displacements = patches.map(|((c, s), (d, t))| (d - c - shift).norm() + t - s);
        displacements.fold(0.0, Real::max)
    }

    /// Finds the pairs of patches that are near each other now.
    fn search(&mut self, near: &Near, x: &[Vec3]) {
        self.searches += 1;
        (0..self.members.len()).for_each(|p| self.refer(p, x));
        let reach = self.reach + 0.5 * near.law.range();
        for (bounds, (_, vertices)) in self.boxes.iter_mut().zip(&self.members) {
            *bounds = around(vertices, x).inflated(reach);
        }
        self.broad_phase.overlapping(&self.boxes, &mut self.found);
        let own = (0..self.members.len() as u32).map(|p| [p, p]);
        self.found.extend(own);
        let members = &self.members;
        let meet = |pair: &[u32; 2]| near.patches_meet(pair.map(|p| members[p as usize].1[0]));
        self.found.retain(meet);
        self.found.sort_unstable();
        self.searched.copy(&self.now);
        std::mem::swap(&mut self.pairs, &mut self.before);
        let mut known = self.before.drain(..).peekable();
        for &patches in &self.found {
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
        self.ids.clone_from(&self.found);
        self.quiet.clear();
        self.quiet.resize(self.found.len(), Real::NEG_INFINITY);
        self.awake_in.clear();
        self.awake_in.resize(self.found.len(), 0);
        self.spare.extend(known);
        self.is_known = true;
    }
}

/// The mean (m) of some vertices.
fn middle(vertices: &[u32], x: &[Vec3]) -> Vec3 {
    vertices.iter().map(|&v| x[v as usize]).sum::<Vec3>() / vertices.len() as Real
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
