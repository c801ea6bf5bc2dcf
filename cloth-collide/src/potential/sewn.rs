//! Vertices that are sewn together: what has one of them is a neighbour of what has the other.

use crate::incidence::joined;

/// Classes of sewn vertices.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sewn {
    /// A number for each vertex up to the last that is sewn, the same for those that are sewn together, directly or
    /// through others.
    class: Vec<u32>,
}

impl Sewn {
    /// Pairs of vertices that are sewn together.
    pub(crate) fn new(pairs: &[[u32; 2]]) -> Self {
        let last = pairs.iter().flatten().max();
        let count = last.map_or(0, |&last| last as usize + 1);
        Self {
            class: joined(count, pairs),
        }
    }

    /// Pairs that sew the same together.
    pub(crate) fn pairs(&self) -> Vec<[u32; 2]> {
        let classes = (0u32..).zip(&self.class);
        let pairs = classes.map(|(vertex, class)| [*class, vertex]);
        pairs.filter(|[class, vertex]| class != vertex).collect()
    }

    /// One more than the last vertex that is sewn to another.
    pub(crate) fn count(&self) -> usize {
        self.class.len()
    }

    /// Whether two different ones of these vertices are sewn together.
    pub(crate) fn join(&self, vertices: &[u32]) -> bool {
        if self.class.is_empty() {
            return false;
        }
        let class = |v: u32| self.class.get(v as usize);
        let later = |k: usize| &vertices[k + 1..];
        (0..vertices.len()).any(|k| {
            let own = vertices[k];
            let is_sewn = |&other: &u32| other != own && class(other) == class(own);
            class(own).is_some() && later(k).iter().any(is_sewn)
        })
    }
}

#[cfg(test)]
#[path = "../../tests/unit/potential_sewn.rs"]
mod tests;
