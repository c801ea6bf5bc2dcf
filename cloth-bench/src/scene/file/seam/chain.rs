//! Chains of vertices, and which point of the other each of them is sewn to.

use cloth_core::math::Real;
use cloth_core::method::ordering::Order;

/// The vertices of one side of a seam; of one that goes all the way round, the first is the last too.
pub(super) struct Chain {
    pub(super) vertices: Vec<u32>,
    /// How far (m) along the chain each of them is.
    pub(super) along: Vec<Real>,
    /// Two that follow each other and are not the ends of an edge, numbered in their own piece.
    pub(super) gap: Option<[usize; 2]>,
}

/// What is sewn together, in the caller's numbers and later in those of the scene.
#[derive(Default)]
pub(in crate::scene::file) struct Ends {
    pub(super) pairs: Vec<[u32; 2]>,
    /// A vertex and the ends of an edge, with the fraction of the way from the first of these to the second at which it
    /// is sewn onto that.
    pub(super) onto_edges: Vec<([u32; 3], Real)>,
}

impl Chain {
    pub(super) fn is_closed(&self) -> bool {
        self.vertices.len() > 1 && self.vertices.first() == self.vertices.last()
    }

    /// Number of different vertices.
    fn count(&self) -> usize {
        self.vertices.len() - usize::from(self.is_closed())
    }

    /// Vertex to vertex if there are as many in both chains. Otherwise each vertex of the chain with more of them goes
    /// to the point of the other chain at the same fraction of its length; and a vertex of the other that holds no such
    /// point goes to one of the first in the same way.
    pub(super) fn sewn_to(&self, other: &Self) -> Result<Ends, String> {
        let mut ends = Ends::default();
        let counts = [self, other].map(Self::count);
        if counts[0] == counts[1] {
            let pairs = self.vertices.iter().zip(&other.vertices).take(counts[0]);
            ends.pairs = pairs.map(|(&a, &b)| [a, b]).collect();
            return Ok(ends);
        }
        let (finer, coarser) = if counts[0] > counts[1] {
            (self, other)
        } else {
            (other, self)
        };
        if let Some([a, b]) = finer.gap.or(coarser.gap) {
            return Err(format!(
                "the chains have {} and {} vertices and are sewn by their lengths, but no edge joins vertices {a} and \
                 {b}, which follow each other",
                counts[0], counts[1]
            ));
        }
        if coarser.vertices.len() < 2 {
            return Err(
                "a chain of one vertex has no length by which others could be sewn to it".into(),
            );
        }
        for place in 0..finer.count() {
            finer.sew_vertex(place, coarser, &mut ends);
        }
        let held = |vertex: &u32, ends: &Ends| {
            ends.pairs.iter().flatten().any(|v| v == vertex)
                || ends
                    .onto_edges
                    .iter()
                    .any(|(corners, _)| corners[1..].contains(vertex))
        };
        for place in 0..coarser.count() {
            if !held(&coarser.vertices[place], &ends) {
                coarser.sew_vertex(place, finer, &mut ends);
            }
        }
        Ok(ends)
    }

    /// Sews a vertex to the point of another chain at the same fraction of its length.
    fn sew_vertex(&self, place: usize, other: &Self, ends: &mut Ends) {
        /// Points nearer to a vertex than this part of an edge are that vertex.
        const AT_VERTEX: Real = 1e-6;
        let [whole, of_other] = [self, other].map(|chain| chain.along[chain.along.len() - 1]);
        let point = self.along[place] / whole * of_other;
        let after = other.along.partition_point(|&along| along <= point);
        let end = after.clamp(1, other.along.len() - 1);
        let [start, stop] = [other.along[end - 1], other.along[end]];
        let fraction = ((point - start) / (stop - start)).clamp(0.0, 1.0);
        let (vertex, edge) = (
            self.vertices[place],
            [other.vertices[end - 1], other.vertices[end]],
        );
        if fraction < AT_VERTEX {
            ends.pairs.push([vertex, edge[0]]);
        } else if fraction > 1.0 - AT_VERTEX {
            ends.pairs.push([vertex, edge[1]]);
        } else {
            ends.onto_edges.push(([vertex, edge[0], edge[1]], fraction));
        }
    }
}

impl Ends {
    /// The same where vertices are in another order.
    pub(super) fn reorder(&mut self, order: &Order) {
        let onto_edges = self.onto_edges.iter_mut().flat_map(|(corners, _)| corners);
        let vertices = self.pairs.iter_mut().flatten().chain(onto_edges);
        vertices.for_each(|v| *v = order.new_of_old()[*v as usize]);
    }
}
