//! Vertices that are sewn together: what has one of them is a neighbour of what has the other.

use cloth_core::topology::joined;

/// Classes of sewn vertices.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sewn {
    /// A number for each vertex, the same for those that are sewn together, directly or through others; empty if none
    /// are.
    class: Vec<u32>,
    /// Pairs of classes of which one has a vertex that is sewn onto an edge and the other an end of that; sorted.
    onto: Vec<[u32; 2]>,
}

impl Sewn {
    /// Pairs of vertices that are sewn together, and vertices that are sewn onto an edge, each with the ends of that.
    /// The ends are its neighbours, and through it nobody else's. What has a vertex beyond `vertex_count` is left out.
    pub(crate) fn new(pairs: &[[u32; 2]], onto_edges: &[[u32; 3]], vertex_count: usize) -> Self {
        if pairs.is_empty() && onto_edges.is_empty() {
            return Self::default();
        }
        let is_known = |v: &u32| (*v as usize) < vertex_count;
        let mut pairs = pairs.to_vec();
        pairs.retain(|pair| pair.iter().all(is_known));
        let class = joined(vertex_count, pairs.iter().copied());
        let onto_edges = onto_edges.iter().filter(|all| all.iter().all(is_known));
        let ends = onto_edges.flat_map(|&[v, a, b]| [[v, a], [v, b]]);
        let of = |v: u32| class[v as usize];
        let mut onto: Vec<[u32; 2]> = ends.map(|[v, end]| sorted(of(v), of(end))).collect();
        onto.sort_unstable();
        Self { class, onto }
    }

    /// Pairs that sew the same together.
    pub(crate) fn pairs(&self) -> Vec<[u32; 2]> {
        let classes = (0u32..).zip(&self.class);
        let pairs = classes.map(|(vertex, class)| [*class, vertex]);
        pairs.filter(|[class, vertex]| class != vertex).collect()
    }

    /// Whether two different ones of these vertices are sewn together.
    pub(crate) fn join(&self, vertices: &[u32]) -> bool {
        if self.class.is_empty() {
            return false;
        }
        let class = |v: u32| self.class.get(v as usize).copied();
        let later = |k: usize| &vertices[k + 1..];
        (0..vertices.len()).any(|k| {
            let own = vertices[k];
            class(own).is_some_and(|of_own| {
                let is_sewn = |&other: &u32| match class(other) {
                    Some(same) if same == of_own => other != own,
                    Some(of_other) => self.onto.binary_search(&sorted(of_own, of_other)).is_ok(),
                    None => false,
                };
                later(k).iter().any(is_sewn)
            })
        })
    }
}

fn sorted(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
#[path = "../../tests/unit/potential_sewn.rs"]
mod tests;
