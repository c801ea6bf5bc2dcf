//! Cloth that is pinched: bodies that close on it leave it no free way; see the [chapter](super#pinched-cloth).
//!
//! Baraff, Witkin and Kass, "Untangling cloth", ACM Trans. Graph. 22, 2003, section 5.3,
//! <https://doi.org/10.1145/882262.882357>, hold pinched vertices to the mean motion of both bodies instead.

use super::near::Near;

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
    /// Lets vertices pass, with their neighbours, through that of the bodies in their way that has the highest number:
    /// a vertex and a body each. Returns whether any did not before.
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
