//! Which pairs can touch in a substep, from bounds on the relative motion of patches of the cloth.
//!
//! A patch is some tens of neighbouring triangles. It is known by its centre c, the mean of its vertices, and by its spread s: how far a vertex has
//! gone at most besides the centre since the patch was last looked at, and before that from one look to the next. Since a moment 0, two points of patches p and q
//! have moved relative to each other by no more than
//!
//! ‖(c_p − c_q) − (c_p − c_q)₀‖ + (s_p − s_p₀) + (s_q − s_q₀).
//!
//! So pairs of primitives, found once with some room and sorted by what they lack to contact, need no look as long as this is less than the room, and of those
//! that are known only the first ones do. Patches that fly together cost nothing, whatever their common motion.

use super::gap::Gap;
use super::near::Near;
use crate::bounds::Bounds;
use crate::broad_phase::{BroadPhase, Hierarchy};
use crate::ccd::QueryKind;
use crate::closest::{edge_edge, point_triangle};
use crate::incidence::{Owned, edge_numbers, owned};
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;

/// Triangles in a patch, at most.
const PATCH: usize = 32;
/// Room (in thicknesses) of a search for pairs, at least.
const LEAST_ROOM: Real = 0.5;
/// Room of a search, in ways of the substep that needs it.
const HOLD: Real = 20.0;
/// Room (in mean edges) of a search, at most, unless one substep needs more.
const MOST_ROOM: Real = 0.5;
/// Way (in mean edges) that a patch may go until pairs of patches are searched anew, at least; and in one substep, at most.
const REACH: Real = 1.0;
const FARTHEST: Real = 30.0;

/// Two primitives that can touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearPair {
    pub(super) kind: QueryKind,
    pub(super) vertices: [u32; 4],
    /// Distance (m) at which they begin to touch.
    pub(super) range: Real,
    /// Area (m²) that they stand for.
    pub(super) area: Real,
    /// What they lacked to contact when they were found (m).
    room: Real,
    /// The travel (m) of their patches until which they lack something, and the substep that they were looked at in.
    wake: Real,
    seen: u32,
    /// By how much friction has been stretched (m).
    pub(super) stretch: Vec3,
    /// Across a plane that has had the two apart.
    pub(super) normal: Vec3,
}

/// Two patches, or one with itself, and what can touch between them.
#[derive(Debug)]
struct PatchPair {
    patches: [u32; 2],
    /// Difference of the centres (m), and sum of the spreads (m), when the pairs were found.
    apart: Vec3,
    spread: Real,
    /// Relative motion (m) for which the pairs are complete.
    budget: Real,
    /// In the order of what they lack to contact.
    pairs: Vec<NearPair>,
    /// The travel (m) until which each pair lacks something to contact, where ways are looked at.
    wakes: Vec<Real>,
    /// Sum of the relative motions (m) of all substeps, at the start of this one.
    travel: Real,
    /// Relative motion and travel (m) that were looked at in this substep.
    looked: [Real; 2],
}

/// The motion needs more room than patches have: a way in one substep is longer than some edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TooFar;

/// Where a pair is: its patches, and its number there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    patches: [u32; 2],
    index: u32,
}

#[derive(Debug)]
pub(super) struct Patches {
    triangles: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    triangle_edges: Vec<[u32; 3]>,
    owned: Vec<Owned>,
    /// Triangles and vertices of each patch.
    members: Vec<(Vec<u32>, Vec<u32>)>,
    edge: Real,
    /// Way (m) that a patch may go besides what all do together, until pairs of patches are searched anew.
    reach: Real,
    /// Positions (m) of the vertices of each patch from which its spread is counted, their centre, and the spread there.
    reference: Vec<Vec<Vec3>>,
    reference_centres: Vec<Vec3>,
    reference_spreads: Vec<Real>,
    /// At the start of the substep, and at the end that is looked at.
    now: Motions,
    then: Motions,
    /// How far a vertex goes besides its centre in between (m).
    ways: Vec<Real>,
    /// What was allowed for when pairs were chosen: relative motion of two patches, and of a patch and all (m).
    allowed: Vec<Real>,
    stray_allowed: Vec<Real>,
    /// When pairs of patches were searched.
    searched: Motions,
    boxes: Vec<Bounds>,
    inflated: Vec<Bounds>,
    hierarchy: Hierarchy,
    found: Vec<[u32; 2]>,
    pairs: Vec<PatchPair>,
    before: Vec<PatchPair>,
    /// Lists to be used again.
    spare: Vec<Vec<NearPair>>,
    memory: Vec<NearPair>,
    is_known: bool,
    /// Number of the substep.
    substep: u32,
    /// Searches among pairs of patches so far, and among their triangles.
    pub(super) searches: u32,
    pub(super) detections: u32,
}

/// Centre (m) and spread (m) of each patch, and the mean of the centres.
#[derive(Clone, Debug, Default)]
struct Motions {
    centres: Vec<Vec3>,
    spreads: Vec<Real>,
    mean: Vec3,
}

impl Motions {
    fn clear(&mut self) {
        self.centres.clear();
        self.spreads.clear();
    }

    fn push(&mut self, centre: Vec3, spread: Real) {
        self.centres.push(centre);
        self.spreads.push(spread);
    }

    /// All patches have been told.
    fn finish(&mut self) {
        self.mean = self.centres.iter().sum::<Vec3>() / self.centres.len().max(1) as Real;
    }

    fn copy(&mut self, other: &Self) {
        self.centres.clone_from(&other.centres);
        self.spreads.clone_from(&other.spreads);
        self.mean = other.mean;
    }

    /// The bound on what two patches have moved relative to each other (m).
    #[inline]
    fn bound(&self, pair: &PatchPair) -> Real {
        let [p, q] = pair.patches.map(|p| p as usize);
        let apart = self.centres[p] - self.centres[q] - pair.apart;
        apart.norm() + self.spreads[p] + self.spreads[q] - pair.spread
    }
}

impl Patches {
    pub(super) fn new(mesh: &TriMesh, piece: &[u32]) -> Self {
        let (edges, triangle_edges) = edge_numbers(mesh.triangles());
        let x = mesh.positions();
        let length = |[a, b]: &[u32; 2]| (x[*a as usize] - x[*b as usize]).norm();
        let edge = edges.iter().map(length).sum::<Real>() / edges.len().max(1) as Real;
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
        let nothing = vec![Bounds::around([Vec3::zeros()]); members.len()];
        Self {
            triangles: mesh.triangles().to_vec(),
            edges,
            triangle_edges,
            owned: owned(mesh),
            edge,
            reach: 0.0,
            reference: members
                .iter()
                .map(|(_, vertices)| vec![Vec3::zeros(); vertices.len()])
                .collect(),
            reference_centres: vec![Vec3::zeros(); members.len()],
            reference_spreads: vec![0.0; members.len()],
            ways: vec![0.0; members.len()],
            allowed: Vec::new(),
            stray_allowed: Vec::new(),
            members,
            now: Motions::default(),
            then: Motions::default(),
            searched: Motions::default(),
            inflated: nothing.clone(),
            boxes: nothing,
            hierarchy: Hierarchy::new(),
            found: Vec::new(),
            pairs: Vec::new(),
            before: Vec::new(),
            spare: Vec::new(),
            memory: Vec::new(),
            is_known: false,
            substep: 0,
            searches: 0,
            detections: 0,
        }
    }

    /// Forgets the motion so far, for a cloth that is at `x` (m) now and was elsewhere before.
    pub(super) fn forget(&mut self, x: &[Vec3]) {
        for (p, (_, vertices)) in self.members.iter().enumerate() {
            let places = self.reference[p].iter_mut().zip(vertices);
            places.for_each(|(place, &v)| *place = x[v as usize]);
            self.reference_centres[p] = middle(vertices, x);
        }
        self.reference_spreads.fill(0.0);
        self.place(x);
        self.is_known = false;
    }

    /// Begins a substep from `x` to `to` (m): makes sure that the pairs are complete, and hands `visit` those that the motion can bring into contact.
    pub(super) fn begin(
        &mut self,
        near: &Near,
        x: &[Vec3],
        to: &[Vec3],
        mut visit: impl FnMut(Place, &mut NearPair) -> Real,
    ) -> Result<(), TooFar> {
        self.bound(x);
        self.measure(x, to);
        for pair in &mut self.pairs {
            pair.looked = [-1.0; 2];
        }
        self.substep += 1;
        self.look(near, x, &mut visit)
    }

    /// The same for a motion that has become another one: hands `visit` only what has not been seen.
    pub(super) fn extend(
        &mut self,
        near: &Near,
        x: &[Vec3],
        to: &[Vec3],
        mut visit: impl FnMut(Place, &mut NearPair) -> Real,
    ) -> Result<(), TooFar> {
        self.measure(x, to);
        self.look(near, x, &mut visit)
    }

    /// Looks at the way from `x` to `to` (m), and at everything within `room` (m) of it: makes sure that the pairs are complete, and hands `visit` those that may
    /// touch there, with how much nearer they can come to each other than they are at `x` (m); it returns what they lack to contact there (m), at most. `place` is the `x` of the choice before.
    ///
    /// [`Patches::holds`] tells for which other places the choice is good.
    pub(super) fn choose(
        &mut self,
        near: &Near,
        place: &[Vec3],
        [x, to]: [&[Vec3]; 2],
        room: Real,
        mut visit: impl FnMut(&NearPair, Real) -> Real,
    ) {
        self.bound(x);
        if self.is_known {
            // From where pairs were chosen last.
            self.measure(place, x);
            self.accept();
        }
        self.place(x);
        self.measure(x, to);
        let strayed = self.strayed().max(Self::stray(&self.searched, &self.now));
        if !self.is_known || strayed + room > self.reach {
            let way = Self::stray(&self.now, &self.then) + room;
            self.reach = (2.0 * way).max(REACH * self.edge);
            self.search(near, x);
        }
        self.allowed.clear();
        for k in 0..self.pairs.len() {
            let nearer = self.once(&self.pairs[k]) + 2.0 * room;
            let mut moved = self.now.bound(&self.pairs[k]) + nearer;
            if moved > self.pairs[k].budget {
                self.detect(near, x, k, nearer);
                moved = nearer;
            }
            self.allowed.push(nearer);
            let pair = &mut self.pairs[k];
            let first = pair.pairs.partition_point(|pair| pair.room < moved);
            let until = pair.travel + nearer;
            let wakes = pair.wakes[..first].iter_mut().zip(&pair.pairs);
            for (wake, one) in wakes {
                if *wake < until {
                    *wake = pair.travel + visit(one, nearer);
                }
            }
        }
        self.stray_allowed.clear();
        let (from, to) = (&self.now, &self.then);
        let shift = to.mean - from.mean;
        let ways = from.centres.iter().zip(&to.centres).zip(&self.ways);
        self.stray_allowed
            .extend(ways.map(|((a, b), besides)| (b - a - shift).norm() + besides + room));
    }

    /// Whether what was chosen last holds at `x` (m), which was chosen for ways from `place` (m) on.
    pub(super) fn holds(&mut self, place: &[Vec3], x: &[Vec3]) -> bool {
        self.measure(place, x);
        let (from, to) = (&self.now, &self.then);
        let shift = to.mean - from.mean;
        let ways = from.centres.iter().zip(&to.centres).zip(&self.ways);
        let mut ways = ways.zip(&self.stray_allowed);
        ways.all(|(((a, b), besides), allowed)| (b - a - shift).norm() + besides <= *allowed)
            && self
                .pairs
                .iter()
                .zip(&self.allowed)
                .all(|(pair, allowed)| self.once(pair) <= *allowed)
    }

    /// The most that two patches move relative to each other in the substep (m).
    #[inline]
    fn once(&self, pair: &PatchPair) -> Real {
        let [p, q] = pair.patches.map(|p| p as usize);
        let (now, then) = (&self.now, &self.then);
        let way = then.centres[p] - now.centres[p] - (then.centres[q] - now.centres[q]);
        way.norm() + self.ways[p] + self.ways[q]
    }

    /// The substep ends where it was looked at last.
    pub(super) fn accept(&mut self) {
        for k in 0..self.pairs.len() {
            self.pairs[k].travel += self.once(&self.pairs[k]);
        }
        std::mem::swap(&mut self.now, &mut self.then);
    }

    /// The pair at a place, or where it has gone since.
    pub(super) fn pair_mut(&mut self, place: Place, vertices: [u32; 4]) -> Option<&mut NearPair> {
        let found = self
            .pairs
            .binary_search_by_key(&place.patches, |pair| pair.patches);
        let pairs = &mut self.pairs[found.ok()?].pairs;
        let index = place.index as usize;
        if pairs
            .get(index)
            .is_some_and(|pair| pair.vertices == vertices)
        {
            return pairs.get_mut(index);
        }
        pairs.iter_mut().find(|pair| pair.vertices == vertices)
    }

    /// Boxes around the patches at `x` (m).
    fn bound(&mut self, x: &[Vec3]) {
        for (bounds, (_, vertices)) in self.boxes.iter_mut().zip(&self.members) {
            *bounds = around(vertices, x);
        }
    }

    /// Number of pairs of patches that are near enough to be looked at.
    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.pairs.len()
    }

    /// Takes `x` (m) for the start of the substep.
    pub(super) fn place(&mut self, x: &[Vec3]) {
        let mut now = std::mem::take(&mut self.now);
        now.clear();
        for (p, (_, vertices)) in self.members.iter().enumerate() {
            let centre = middle(vertices, x);
            let way = centre - self.reference_centres[p];
            let places = vertices.iter().zip(&self.reference[p]);
            let besides = places.map(|(&v, from)| (x[v as usize] - from - way).norm_squared());
            let most = besides.fold(0.0, Real::max).sqrt();
            now.push(centre, self.reference_spreads[p] + most);
        }
        now.finish();
        self.now = now;
    }

    /// Looks at the motion from the start of the substep, `x`, to `to` (m).
    fn measure(&mut self, x: &[Vec3], to: &[Vec3]) {
        let mut then = std::mem::take(&mut self.then);
        then.clear();
        for (p, (_, vertices)) in self.members.iter().enumerate() {
            let centre = middle(vertices, to);
            let since = centre - self.reference_centres[p];
            let way = centre - self.now.centres[p];
            let (mut spread, mut besides): (Real, Real) = (0.0, 0.0);
            for (&v, from) in vertices.iter().zip(&self.reference[p]) {
                let to = to[v as usize];
                spread = spread.max((to - from - since).norm_squared());
                besides = besides.max((to - x[v as usize] - way).norm_squared());
            }
            then.push(centre, self.reference_spreads[p] + spread.sqrt());
            self.ways[p] = besides.sqrt();
        }
        then.finish();
        self.then = then;
    }

    /// Counts the spread of patch `p` from `x` (m) on, the start of the substep.
    fn refer(&mut self, p: usize, x: &[Vec3]) {
        let places = self.reference[p].iter_mut().zip(&self.members[p].1);
        places.for_each(|(place, &v)| *place = x[v as usize]);
        self.reference_centres[p] = self.now.centres[p];
        self.reference_spreads[p] = self.now.spreads[p];
        self.then.spreads[p] = self.now.spreads[p] + self.ways[p];
    }

    fn look(
        &mut self,
        near: &Near,
        x: &[Vec3],
        visit: &mut impl FnMut(Place, &mut NearPair) -> Real,
    ) -> Result<(), TooFar> {
        if !self.is_known || self.strayed() > self.reach {
            let way = Self::stray(&self.now, &self.then);
            if way > FARTHEST * self.edge {
                self.is_known = false;
                return Err(TooFar);
            }
            self.reach = (2.0 * way).max(REACH * self.edge);
            self.search(near, x);
        }
        let slack = super::rows::SLACK * near.law().range();
        for k in 0..self.pairs.len() {
            let pair = &self.pairs[k];
            let once = self.once(pair);
            let mut moved = self.now.bound(pair).max(self.then.bound(pair));
            if moved <= pair.looked[0] && pair.travel + once <= pair.looked[1] {
                continue;
            }
            if moved + slack > pair.budget {
                self.detect(near, x, k, once);
                moved = once;
            }
            let pair = &mut self.pairs[k];
            let travel = pair.travel + once + slack;
            pair.looked = [moved + slack, travel];
            for (index, one) in (0..).zip(&mut pair.pairs) {
                if one.room >= moved + slack {
                    break;
                }
                if one.wake < travel && one.seen != self.substep {
                    one.seen = self.substep;
                    let place = Place {
                        patches: pair.patches,
                        index,
                    };
                    one.wake = pair.travel + visit(place, one);
                }
            }
        }
        Ok(())
    }

    /// How far a patch has gone from where it was searched, besides what all do together (m).
    fn strayed(&self) -> Real {
        Self::stray(&self.searched, &self.then)
    }

    fn stray(old: &Motions, new: &Motions) -> Real {
        let shift = new.mean - old.mean;
        let patches = old.centres.iter().zip(&old.spreads);
        let patches = patches.zip(new.centres.iter().zip(&new.spreads));
        let ways = patches.map(|((c, s), (d, t))| (d - c - shift).norm() + t - s);
        ways.fold(0.0, Real::max)
    }

    /// Finds the pairs of patches that are near each other now.
    fn search(&mut self, near: &Near, x: &[Vec3]) {
        self.searches += 1;
        (0..self.members.len()).for_each(|p| self.refer(p, x));
        let reach = self.reach + 0.5 * near.law().range();
        for (inflated, bounds) in self.inflated.iter_mut().zip(&self.boxes) {
            *inflated = bounds.inflated(reach);
        }
        self.hierarchy.overlapping(&self.inflated, &mut self.found);
        let own = (0..self.members.len() as u32).map(|p| [p, p]);
        self.found.extend(own);
        self.found.sort_unstable();
        self.searched.copy(&self.now);
        std::mem::swap(&mut self.pairs, &mut self.before);
        let mut known = self.before.drain(..).peekable();
        for &patches in &self.found {
            while let Some(old) = known.next_if(|old| old.patches < patches) {
                self.spare.push(old.pairs);
            }
            let same = |old: &PatchPair| self.is_known && old.patches == patches;
            if let Some(old) = known.next_if(same) {
                self.pairs.push(old);
                continue;
            }
            let mut pairs = self.spare.pop().unwrap_or_default();
            pairs.clear();
            self.pairs.push(PatchPair {
                patches,
                apart: Vec3::zeros(),
                spread: 0.0,
                budget: -1.0,
                pairs,
                wakes: Vec::new(),
                travel: 0.0,
                looked: [-1.0; 2],
            });
        }
        self.spare.extend(known.map(|old| old.pairs));
        self.is_known = true;
    }

    /// Finds the pairs between two patches anew, with room for the present motion and more.
    fn detect(&mut self, near: &Near, x: &[Vec3], k: usize, once: Real) {
        let h = near.law().range();
        let [p, q] = self.pairs[k].patches.map(|p| p as usize);
        self.refer(p, x);
        self.refer(q, x);
        let pair = &mut self.pairs[k];
        pair.apart = self.now.centres[p] - self.now.centres[q];
        pair.spread = self.now.spreads[p] + self.now.spreads[q];
        pair.travel = 0.0;
        let once = once + 2.0 * super::rows::SLACK * h;
        let room = (HOLD * once).clamp(LEAST_ROOM * h, (MOST_ROOM * self.edge).max(h));
        let room = room.max(1.5 * once);
        let mut pairs = std::mem::take(&mut pair.pairs);
        self.memory.clear();
        let stretched = pairs.iter().filter(|pair| pair.stretch != Vec3::zeros());
        self.memory.extend(stretched);
        pairs.clear();
        let gap = self.boxes[p].squared_gap(&self.boxes[q]).sqrt();
        let mut budget = room;
        if gap > h + room {
            budget = gap - h;
        } else {
            self.detections += 1;
            self.collect(near, x, [p, q], h + room, &mut pairs);
            pairs.sort_unstable_by(|a, b| {
                let of = |pair: &NearPair| (pair.kind == QueryKind::EdgeEdge, pair.vertices);
                a.room.total_cmp(&b.room).then_with(|| of(a).cmp(&of(b)))
            });
            for old in &self.memory {
                let same =
                    |pair: &&mut NearPair| pair.vertices == old.vertices && pair.kind == old.kind;
                if let Some(pair) = pairs.iter_mut().find(same) {
                    pair.stretch = old.stretch;
                }
            }
        }
        let pair = &mut self.pairs[k];
        pair.wakes.clear();
        pair.wakes.extend(pairs.iter().map(|pair| pair.room));
        pair.pairs = pairs;
        pair.budget = budget;
    }

    /// Appends the pairs of primitives of two patches that are nearer than `reach` (m) at `x` (m).
    fn collect(
        &self,
        near: &Near,
        x: &[Vec3],
        [p, q]: [usize; 2],
        reach: Real,
        out: &mut Vec<NearPair>,
    ) {
        let big = [p, q].map(|p| self.boxes[p].loosened(reach));
        let at = |v: u32| x[v as usize];
        let bounds = |t: u32| Bounds::around(self.triangles[t as usize].map(at));
        let mut others: [(u32, Bounds); PATCH] = [(0, big[0]); PATCH];
        let mut count = 0;
        for &u in &self.members[q].0 {
            let bounds = bounds(u);
            if bounds.overlaps(&big[0]) {
                others[count] = (u, bounds);
                count += 1;
            }
        }
        for &t in &self.members[p].0 {
            let own = bounds(t);
            let wide = own.loosened(reach);
            if !wide.overlaps(&self.boxes[q]) {
                continue;
            }
            for (u, other) in &others[..count] {
                if (p == q && *u <= t) || !wide.overlaps(other) {
                    continue;
                }
                self.add_vertices(near, x, [t, *u], other, reach, out);
                self.add_vertices(near, x, [*u, t], &own, reach, out);
                self.add_edges(near, x, [t, *u], other, reach, out);
            }
        }
    }

    fn add_vertices(
        &self,
        near: &Near,
        x: &[Vec3],
        [t, u]: [u32; 2],
        bounds: &Bounds,
        reach: Real,
        out: &mut Vec<NearPair>,
    ) {
        let corners = self.triangles[u as usize];
        for k in (0..3).filter(|&k| self.owned[t as usize].vertices[k]) {
            let vertex = self.triangles[t as usize][k];
            let place = Bounds::around([x[vertex as usize]]);
            if corners.contains(&vertex) || place.squared_gap(bounds) > reach * reach {
                continue;
            }
            let distance = point_triangle(x[vertex as usize], gather(x, corners)).distance();
            if distance < reach {
                let vertices = [vertex, corners[0], corners[1], corners[2]];
                let rest = |x: &[Vec3; 4]| Gap::vertex_triangle(x).distance;
                let range = near.law_of(vertices, rest).range();
                let area = near.vertex_area[vertex as usize];
                push(
                    near,
                    QueryKind::VertexTriangle,
                    vertices,
                    [range, area, distance],
                    out,
                );
            }
        }
    }

    fn add_edges(
        &self,
        near: &Near,
        x: &[Vec3],
        [t, u]: [u32; 2],
        bounds: &Bounds,
        reach: Real,
        out: &mut Vec<NearPair>,
    ) {
        for i in (0..3).filter(|&i| self.owned[t as usize].edges[i]) {
            let e = self.triangle_edges[t as usize][i] as usize;
            let first = self.edges[e];
            let own = Bounds::around(gather(x, first));
            if own.squared_gap(bounds) > reach * reach {
                continue;
            }
            for j in (0..3).filter(|&j| self.owned[u as usize].edges[j]) {
                let f = self.triangle_edges[u as usize][j] as usize;
                let second = self.edges[f];
                if first.iter().any(|v| second.contains(v)) {
                    continue;
                }
                let other = gather(x, second);
                if own.squared_gap(&Bounds::around(other)) > reach * reach {
                    continue;
                }
                let distance = edge_edge(gather(x, first), other).distance();
                if distance < reach {
                    let vertices = [first[0], first[1], second[0], second[1]];
                    let rest = |x: &[Vec3; 4]| Gap::edge_edge(x).distance;
                    let range = near.law_of(vertices, rest).range();
                    let area = near.edge_area[e].min(near.edge_area[f]);
                    push(
                        near,
                        QueryKind::EdgeEdge,
                        vertices,
                        [range, area, distance],
                        out,
                    );
                }
            }
        }
    }
}

fn push(
    near: &Near,
    kind: QueryKind,
    vertices: [u32; 4],
    [range, area, distance]: [Real; 3],
    out: &mut Vec<NearPair>,
) {
    if vertices.iter().any(|&v| near.is_free[v as usize]) {
        out.push(NearPair {
            kind,
            vertices,
            range,
            area,
            room: distance - range,
            wake: distance - range,
            seen: 0,
            stretch: Vec3::zeros(),
            normal: Vec3::zeros(),
        });
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
