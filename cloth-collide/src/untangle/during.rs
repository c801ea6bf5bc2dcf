//! Untangling in the course of a simulation.

use super::{SMOOTHINGS, Untangler, WORTHWHILE};
use crate::error::CollideError;
use crate::potential::PotentialContacts;
use cloth_core::contact::{ContactError, ContactSource};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::topology::DisjointSets;

/// Rings of neighbours around what crosses that belong to a region: where the contour may go in a step.
const RINGS: u32 = 3;
/// Iterations before each step. One is not enough where contact and elasticity push the other way: two crossing sheets
/// that fall onto a ball become free after 9 to 11 steps with four (implicit Euler, projective dynamics, XPBD), 13 to
/// 18 with three, 22 to 92 with two, and with one in 68 (XPBD) or never.
const ITERATIONS: u32 = 4;

/// Pulls a tangled cloth apart step by step while a method simulates it, and lets contact keep everything else apart.
///
/// Before each step, what crosses now is let go: around the contour, and where it cuts parts off, the cloth falls into
/// *regions*; pairs of pieces in two regions that cross each other are left out of contact, and of its checks. All
/// others keep what [`PotentialContacts`] promises, so nothing can become tangled elsewhere. Then a few iterations move
/// the cloth, as far as those others let it. Elasticity smooths what it leaves. Once nothing crosses, no pair is let go
/// any more, and contact keeps it that way.
#[derive(Debug)]
pub struct StepUntangler {
    untangler: Untangler,
    sets: DisjointSets,
    is_inside: Vec<bool>,
    region: Vec<u32>,
    pairs: Vec<[u32; 2]>,
    moved: Vec<Vec3>,
    /// 1 for vertices that can move, 0 for others.
    is_free: Vec<Real>,
    steps: u32,
    /// The fewest pairs so far, and after how many steps.
    best: Option<(usize, u32)>,
}

impl StepUntangler {
    /// For the cloth `mesh`.
    #[must_use]
    pub fn new(mesh: &TriMesh) -> Self {
        let count = mesh.vertex_count();
        Self {
            untangler: Untangler::new(mesh),
            sets: DisjointSets::default(),
            is_inside: vec![false; count],
            region: vec![0; count],
            pairs: Vec::new(),
            moved: vec![Vec3::zeros(); count],
            is_free: Vec::new(),
            steps: 0,
            best: None,
        }
    }

    /// Before a step from `positions` (m): moves them if anything crosses, and tells `contacts`, which that step has to
    /// take, what is let go. Returns the number of pairs of triangles that crossed. Does nothing any more once that was
    /// 0. Vertices with an `inverse_mass` (1/kg) of 0 stay.
    ///
    /// # Errors
    /// Those of [`ContactSource::keep_free`]; [`ContactError::IntersectingStart`] for triangles of the cloth that cross
    /// a body.
    ///
    /// # Panics
    /// If there is not one position and one inverse mass per vertex.
    pub fn begin_step(
        &mut self,
        contacts: &mut PotentialContacts,
        inverse_mass: &[Real],
        positions: &mut [Vec3],
    ) -> Result<usize, ContactError> {
        assert_eq!(positions.len(), self.moved.len(), "one position a vertex");
        assert_eq!(inverse_mass.len(), self.moved.len(), "one mass a vertex");
        if self.is_done() {
            return Ok(0);
        }
        let crossing = self.look(contacts, positions)?;
        if self.best.is_none_or(|(fewest, _)| crossing < fewest) {
            self.best = Some((crossing, self.steps));
        }
        self.steps += 1;
        self.is_free.clear();
        let free = inverse_mass.iter().map(|w| Real::from(u8::from(*w > 0.0)));
        self.is_free.extend(free);
        for _ in 0..ITERATIONS {
            if self.untangler.contour.meeting.is_empty() {
                break;
            }
            self.moved.copy_from_slice(positions);
            self.untangler.iterate(&mut self.moved, &self.is_free)?;
            contacts.keep_free(positions, inverse_mass, &mut self.moved)?;
            positions.copy_from_slice(&self.moved);
            self.look(contacts, positions)?;
        }
        Ok(crossing)
    }

    /// Whether nothing crossed when a step began: contact does the rest.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.best.is_some_and(|(fewest, _)| fewest == 0)
    }

    /// The pairs of triangles that crossed when the last step began, after they were pulled apart by a step.
    #[must_use]
    pub fn pairs(&self) -> &[[u32; 2]] {
        self.untangler.pairs()
    }

    /// The step, from 0, since which there have not been fewer crossing pairs; none once it is done, or before it has
    /// begun.
    #[must_use]
    pub fn unimproved_since(&self) -> Option<u32> {
        let (fewest, since) = self.best?;
        (fewest > 0).then_some(since)
    }

    /// Finds what crosses, and lets it go. Returns how many pairs.
    fn look(
        &mut self,
        contacts: &mut PotentialContacts,
        positions: &[Vec3],
    ) -> Result<usize, ContactError> {
        self.untangler.contour.find(positions)?;
        self.divide();
        contacts.let_go(&self.region, &self.pairs);
        Ok(self.untangler.contour.meeting.len())
    }

    /// Finds the regions around what crosses.
    fn divide(&mut self) {
        let untangler = &mut self.untangler;
        let (contour, smoother) = (&untangler.contour, &mut untangler.smoother);
        self.pairs.clear();
        if contour.meeting.is_empty() {
            return;
        }
        untangler.pieces.divide(contour.crossings());
        for (vertex, is_inside) in (0..).zip(&mut self.is_inside) {
            *is_inside = untangler.pieces.is_cut_off(vertex);
        }
        let corners = |t: u32| contour.pairs.triangles[t as usize];
        for vertex in contour.meeting.iter().flatten().flat_map(|&t| corners(t)) {
            self.is_inside[vertex as usize] = true;
        }
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
        let of = |t: u32| self.region[corners(t)[0] as usize];
        let crossing = contour.meeting.iter().map(|pair| pair.map(of));
        let sorted = crossing.map(|[a, b]| [a.min(b), a.max(b)]);
        self.pairs.extend(sorted);
        self.pairs.sort_unstable();
        self.pairs.dedup();
    }
}

impl Untangler {
    /// One iteration from positions (m) whose contour has just been found: shortens it with as much averaging as helps,
    /// or pushes what is cut off.
    fn iterate(
        &mut self,
        positions: &mut [Vec3],
        inverse_mass: &[Real],
    ) -> Result<(), CollideError> {
        let before = self.contour.length();
        for rounds in SMOOTHINGS {
            let taken = self.descend(positions, inverse_mass, rounds, self.longest_step)?;
            if taken.is_some() && self.contour.length() < WORTHWHILE * before {
                return Ok(());
            }
            self.contour.find(positions)?;
            if taken.is_some() {
                break;
            }
        }
        self.push(positions, inverse_mass)?;
        Ok(())
    }
}
