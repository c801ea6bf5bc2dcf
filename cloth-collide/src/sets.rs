//! Disjoint sets of vertices.

/// Which vertices belong together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sets {
    parent: Vec<u32>,
}

impl Sets {
    /// Every vertex on its own.
    pub(crate) fn reset(&mut self, count: usize) {
        self.parent.clear();
        self.parent.extend(0..count as u32);
    }

    /// The lowest vertex of the set of each of `count` vertices, when these pairs are joined.
    pub(crate) fn classes(count: usize, pairs: impl IntoIterator<Item = [u32; 2]>) -> Vec<u32> {
        let mut sets = Self::default();
        sets.reset(count);
        pairs.into_iter().for_each(|[a, b]| sets.join(a, b));
        (0..count as u32).map(|vertex| sets.of(vertex)).collect()
    }

    /// The lowest vertex of the set of `vertex`.
    pub(crate) fn of(&mut self, vertex: u32) -> u32 {
        let mut root = vertex;
        while self.parent[root as usize] != root {
            // Halves the way for those who come after.
            let next = self.parent[root as usize];
            self.parent[root as usize] = self.parent[next as usize];
            root = next;
        }
        root
    }

    /// Joins the sets of two vertices.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.of(a), self.of(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}
