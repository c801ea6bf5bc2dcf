//! Cloth that is pinched: bodies that close on it leave it no feasible path; see the [chapter](super#pinched-cloth).
//!
//! Baraff, Witkin and Kass, "Untangling cloth", ACM Trans. Graph. 22, 2003, section 5.3,
//! <https://doi.org/10.1145/882262.882357>, hold pinched vertices to the mean motion of both bodies instead.

use super::near::Near;
use super::source::Contacts;
use super::surfaces::PotentialContacts;
use cloth_core::contact::ContactError;
use cloth_core::math::{Real, Vec3};

/// Vertices of the cloth that pass through bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Pinched {
    /// A vertex and the number of a body each, in rising order.
    pairs: Vec<[u32; 2]>,
}

impl Pinched {
    /// How many vertices pass through a body, each counted once for each of them.
    pub(super) fn count(&self) -> usize {
        self.pairs.len()
    }

    pub(super) fn passes(&self, vertex: usize, body: usize) -> bool {
        !self.pairs.is_empty()
            && self
                .pairs
                .binary_search(&[vertex as u32, body as u32])
                .is_ok()
    }

    /// Whether one of these vertices passes through a body.
    pub(super) fn any_passes(&self, vertices: &[u32], body: usize) -> bool {
        vertices.iter().any(|&v| self.passes(v as usize, body))
    }

    pub(super) fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// The bodies that something passes through.
    pub(super) fn bodies(&self) -> Vec<usize> {
        let mut bodies: Vec<usize> = self.pairs.iter().map(|pair| pair[1] as usize).collect();
        bodies.sort_unstable();
        bodies.dedup();
        bodies
    }

    pub(super) fn vertices(&self, body: usize) -> impl Iterator<Item = usize> + '_ {
        let of = move |pair: &&[u32; 2]| pair[1] as usize == body;
        self.pairs.iter().filter(of).map(|pair| pair[0] as usize)
    }

    /// More vertices pass through a body each. Returns whether any did not before.
    pub(super) fn extend(&mut self, pairs: impl IntoIterator<Item = [u32; 2]>) -> bool {
        let before = self.pairs.len();
        self.pairs.extend(pairs);
        self.pairs.sort_unstable();
        self.pairs.dedup();
        self.pairs.len() > before
    }

    /// Nothing passes through a body any more.
    pub(super) fn release(&mut self, body: usize) {
        self.retain(|_, of| of != body);
    }

    /// Only these vertices pass through their bodies from now on.
    pub(super) fn retain(&mut self, mut passes: impl FnMut(usize, usize) -> bool) {
        self.pairs
            .retain(|&[v, body]| passes(v as usize, body as usize));
    }
}

impl Near {
    /// Lets vertices pass, with their neighbours, through that of the bodies that block them that has the highest
    /// number: a vertex and a body each. Returns whether any did not before.
    pub(super) fn let_pass(&mut self, blocked: &[[u32; 2]]) -> bool {
        let body = blocked.iter().map(|pair| pair[1]).max();
        let Some(body) = body.filter(|_| self.own.pinched_passes) else {
            return false;
        };
        let seeds = blocked.iter().filter(|pair| pair[1] == body);
        let mut vertices: Vec<u32> = seeds.map(|pair| pair[0]).collect();
        vertices.sort_unstable();
        let ends = self.incidence.edges.iter();
        let around: Vec<u32> = ends
            .filter(|ends| ends.iter().any(|v| vertices.binary_search(v).is_ok()))
            .flatten()
            .copied()
            .collect();
        let vertices = vertices.iter().chain(&around);
        self.pinched.extend(vertices.map(|&v| [v, body]))
    }
}

impl PotentialContacts {
    /// How many vertices of the cloth pass through a body because bodies left them no feasible path, each counted once
    /// for each body; see the [chapter](super#pinched-cloth).
    #[must_use]
    pub fn pinched(&self) -> usize {
        self.contacts.near.pinched.count()
    }

    /// From the next step on leaves out all pairs of primitives in two regions of a pair, and no others; and all before
    /// a body that have a vertex in a region of `passing`, of pairs of a region and a body, until nothing crosses that.
    /// `region` numbers the regions of vertices from 1; 0 for none.
    pub(crate) fn exclude_crossing(
        &mut self,
        region: &[u32],
        pairs: &[[u32; 2]],
        passing: &[[u32; 2]],
    ) {
        let near = &mut self.contacts.near;
        let vertices = passing.iter().flat_map(|&[of, body]| {
            let own = (0..).zip(region).filter(move |(_, r)| **r == of);
            own.map(move |(vertex, _)| [vertex, body])
        });
        let more = near.pinched.extend(vertices);
        self.contacts.is_anew |= near.crossing.replace(region, pairs) | more;
    }

    /// Where nothing crosses a body any more, with everything at `x` (m), and no vertex that passes through it is
    /// inside, nothing passes through it any more. Returns how many vertices still do.
    pub(crate) fn release(&mut self, x: &[Vec3]) -> Result<usize, ContactError> {
        self.contacts.unpinch(x)?;
        Ok(self.pinched())
    }

    /// Moves the vertices of a cloth at `x` (m) that pass through a body and are inside of it towards its surface, by
    /// at most `most` (m), but for prescribed ones.
    pub(crate) fn move_out(&self, x: &mut [Vec3], inverse_mass: &[Real], most: Real) {
        let Contacts { near, bodies, .. } = &self.contacts;
        for (number, (body, _)) in bodies.iter().enumerate() {
            let passing = near.pinched.vertices(number);
            for v in passing.filter(|&v| inverse_mass[v] > 0.0) {
                let at = body.signed_distance(x[v], 0.0);
                if at.value <= 0.0 {
                    x[v] += at.normal * (near.law_at(v).range() - at.value).min(most);
                }
            }
        }
    }
}
