//! Untangling in the course of a simulation.

use super::{Untangler, World};
use crate::potential::PotentialContacts;
use cloth_core::contact::{ContactError, ContactSource};
use cloth_core::math::{Real, Vec3};
use cloth_core::topology::DisjointSets;

/// Rings of neighbours around what crosses that belong to a region: where the contour may go in a step.
const RINGS: u32 = 3;
/// Iterations before each step. One is not enough where contact and elasticity push the other way in the step itself:
/// four take two crossing sheets that fall onto a ball apart in about ten steps, one may never do so.
const ITERATIONS: u32 = 4;
/// And one more for each step without fewer crossing pairs, up to this many: elasticity pulls back what is moved.
const MORE_ITERATIONS: u32 = 16;

/// Pulls a tangled cloth apart step by step while a method simulates it, and lets contact keep everything else apart.
///
/// Before each step, what crosses now is excluded: around the contour, and where it cuts parts off, the cloth falls
/// into *regions*; pairs of primitives in two regions that cross each other are left out of contact, and of its checks.
/// All others keep what [`PotentialContacts`] guarantees, so nothing can become tangled elsewhere. Then a few
/// iterations move the cloth, as far as those others let it. Elasticity smooths what it leaves. Once nothing crosses,
/// no pair is excluded any more, and contact keeps it that way.
///
/// Bodies take part as triangles that stay where they are. A region that crosses one passes through it until nothing
/// crosses it any more and no vertex that passes is inside, as [pinched cloth](crate::potential#pinched-cloth) does.
#[derive(Debug)]
pub struct StepUntangler {
    untangler: Untangler,
    cloth: usize,
    sets: DisjointSets,
    is_inside: Vec<bool>,
    region: Vec<u32>,
    /// Pairs of regions that cross, and pairs of a region and the body that it crosses.
    pairs: Vec<[u32; 2]>,
    passing: Vec<[u32; 2]>,
    /// Places (m) of the cloth, followed by those of bodies.
    places: Vec<Vec3>,
    /// 1 for vertices that can move, 0 for others.
    is_free: Vec<Real>,
    /// Where the cloth was before the step (m).
    start: Vec<Vec3>,
    is_done: bool,
    steps: u32,
    /// The fewest pairs so far, and after how many steps.
    best: Option<(usize, u32)>,
}

/// Pairs of triangles that cross.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CrossingPairs {
    /// Of the cloth with itself.
    pub own: usize,
    /// Of one of the cloth and one of a body.
    pub bodies: usize,
}

impl CrossingPairs {
    /// All of them.
    #[must_use]
    pub fn count(&self) -> usize {
        self.own + self.bodies
    }
}

impl StepUntangler {
    /// For the cloth and the bodies of `contacts`; none if these know no triangles that could cross. What is sewn
    /// together moves together, and is no crossing; nor are primitives that may pass through each other.
    #[must_use]
    pub fn new(contacts: &PotentialContacts) -> Option<Self> {
        let (mesh, cloth) = (contacts.mesh()?, contacts.near().cloth);
        let count = mesh.vertex_count();
        Some(Self {
            untangler: Untangler::among(mesh, cloth, &contacts.near().own.sewn.pairs()),
            cloth,
            sets: DisjointSets::default(),
            is_inside: vec![false; count],
            region: vec![0; cloth],
            pairs: Vec::new(),
            passing: Vec::new(),
            places: vec![Vec3::zeros(); count],
            is_free: vec![0.0; count],
            start: vec![Vec3::zeros(); cloth],
            is_done: false,
            steps: 0,
            best: None,
        })
    }

    /// Before a step from `positions` (m): moves them if anything crosses, and tells `contacts`, of which this was made
    /// and which that step has to take, what is excluded. Returns how many pairs of triangles crossed. Does nothing any
    /// more once there were none. Vertices with an `inverse_mass` (1/kg) of 0 stay. `velocities` (m/s) lose what goes
    /// against that motion: what is pushed up a body does not fall on meanwhile.
    ///
    /// # Errors
    /// Those of [`ContactSource::keep_free`].
    ///
    /// # Panics
    /// If there is not one position, one inverse mass and one velocity per vertex.
    pub fn begin_step(
        &mut self,
        contacts: &mut PotentialContacts,
        inverse_mass: &[Real],
        positions: &mut [Vec3],
        velocities: &mut [Vec3],
    ) -> Result<CrossingPairs, ContactError> {
        assert_eq!(positions.len(), self.cloth, "one position a vertex");
        assert_eq!(inverse_mass.len(), self.cloth, "one mass a vertex");
        assert_eq!(velocities.len(), self.cloth, "one velocity a vertex");
        if self.is_done() {
            return Ok(CrossingPairs::default());
        }
        for (is_free, w) in self.is_free.iter_mut().zip(inverse_mass) {
            *is_free = Real::from(u8::from(*w > 0.0));
        }
        contacts.place_bodies(&mut self.places[self.cloth..]);
        self.find_crossings(contacts, positions)?;
        let crossing = self.crossing();
        let count = crossing.count();
        let fewest = self.best.filter(|(fewest, _)| count >= *fewest);
        let best = fewest.unwrap_or((count, self.steps));
        let since = self.steps - best.1;
        self.best = Some(best);
        self.steps += 1;
        self.start.copy_from_slice(positions);
        if count == 0 {
            self.is_done = contacts.release(&self.places)? == 0;
            if !self.is_done {
                // Swallowed whole: there is no contour that would tell the direction.
                let own = &mut self.places[..self.cloth];
                contacts.move_out(own, &self.is_free, self.untangler.longest_step);
                contacts.keep_free(positions, inverse_mass, own)?;
                positions.copy_from_slice(own);
            }
        }
        for _ in 0..ITERATIONS + since.min(MORE_ITERATIONS) {
            if self.untangler.contour.meeting.is_empty() {
                break;
            }
            let world = World {
                inverse_mass: &self.is_free,
                contacts: Some(contacts),
            };
            self.untangler.iterate(&mut self.places, world)?;
            let own = &mut self.places[..self.cloth];
            contacts.keep_free(positions, inverse_mass, own)?;
            positions.copy_from_slice(own);
            self.find_crossings(contacts, positions)?;
        }
        for ((v, x), start) in velocities.iter_mut().zip(positions).zip(&self.start) {
            let displacement = *x - start;
            let against = v.dot(&displacement).min(0.0);
            if against < 0.0 {
                *v -= displacement * (against / displacement.norm_squared());
            }
        }
        Ok(crossing)
    }

    /// What crosses where it was found last.
    fn crossing(&self) -> CrossingPairs {
        let is_own = |pair: &&[u32; 2]| pair.iter().all(|&t| self.is_own(t));
        let meeting = &self.untangler.contour.meeting;
        let own = meeting.iter().filter(is_own).count();
        CrossingPairs {
            own,
            bodies: meeting.len() - own,
        }
    }

    fn is_own(&self, triangle: u32) -> bool {
        let corners = self.untangler.contour.pairs.triangles[triangle as usize];
        (corners[0] as usize) < self.cloth
    }

    /// Whether nothing crossed when a step began: contact does the rest.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.is_done
    }

    /// The pairs of triangles that crossed when the last step began, after they were pulled apart by a step. Those of
    /// bodies are counted on from those of the cloth: of obstacles with a surface first, in their order, then animated.
    #[must_use]
    pub fn pairs(&self) -> &[[u32; 2]] {
        self.untangler.pairs()
    }

    /// The step, from 0, since which there have not been fewer crossing pairs; none once it is done, or before it has
    /// begun.
    #[must_use]
    pub fn unimproved_since(&self) -> Option<u32> {
        let best = self.best.filter(|_| !self.is_done);
        best.map(|(_, since)| since)
    }

    /// Finds what crosses with the cloth at `positions` (m), and excludes it.
    fn find_crossings(
        &mut self,
        contacts: &mut PotentialContacts,
        positions: &[Vec3],
    ) -> Result<(), ContactError> {
        self.places[..self.cloth].copy_from_slice(positions);
        let world = World {
            inverse_mass: &self.is_free,
            contacts: Some(contacts),
        };
        self.untangler.contour.find(&self.places, world)?;
        self.divide(contacts);
        contacts.exclude_crossing(&self.region, &self.pairs, &self.passing);
        Ok(())
    }

    /// Finds the regions around what crosses.
    fn divide(&mut self, contacts: &PotentialContacts) {
        let untangler = &mut self.untangler;
        let (contour, smoother) = (&untangler.contour, &mut untangler.smoother);
        self.pairs.clear();
        self.passing.clear();
        if contour.meeting.is_empty() {
            return;
        }
        let world = World {
            inverse_mass: &self.is_free,
            contacts: Some(contacts),
        };
        let is_inside = |vertex| world.is_inside(vertex, &self.places);
        untangler.components.divide(contour.crossings(), is_inside);
        for (vertex, is_inside) in (0..).zip(&mut self.is_inside) {
            *is_inside = untangler.components.is_cut_off(vertex);
        }
        let corners = |t: u32| contour.pairs.triangles[t as usize];
        for vertex in contour.meeting.iter().flatten().flat_map(|&t| corners(t)) {
            self.is_inside[vertex as usize] = true;
        }
        // Bodies are passed through as a whole.
        self.is_inside[self.cloth..].fill(false);
        for _ in 0..RINGS {
            smoother.grow(&mut self.is_inside);
        }
        self.sets.reset(self.is_inside.len());
        for &[a, b] in &smoother.edges {
            if self.is_inside[a as usize] && self.is_inside[b as usize] {
                self.sets.join(a, b);
            }
        }
        for (vertex, region) in (0..).zip(&mut self.region) {
            *region = match self.is_inside[vertex as usize] {
                true => self.sets.root(vertex) + 1,
                false => 0,
            };
        }
        for first in contour
            .meeting
            .iter()
            .map(|pair| pair.map(|t| corners(t)[0]))
        {
            let of = |v: u32| self.region[v as usize];
            match first.map(|v| contacts.near().body_of(v)) {
                [None, None] => {
                    let [a, b] = first.map(of);
                    self.pairs.push([a.min(b), a.max(b)]);
                }
                [None, Some(body)] => self.passing.push([of(first[0]), body as u32]),
                [Some(body), None] => self.passing.push([of(first[1]), body as u32]),
                // Bodies do not touch each other.
                [Some(_), Some(_)] => {}
            }
        }
        for pairs in [&mut self.pairs, &mut self.passing] {
            pairs.sort_unstable();
            pairs.dedup();
        }
    }
}
