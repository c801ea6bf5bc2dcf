//! Who is whose neighbour, in two arrays.

/// Neighbours of each vertex.
#[derive(Debug)]
pub(crate) struct Graph {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// From pairs of different vertices, each pair once.
    pub(crate) fn new(vertex_count: usize, pairs: impl Iterator<Item = [u32; 2]> + Clone) -> Self {
        let mut starts = vec![0_u32; vertex_count + 1];
        for vertex in pairs.clone().flatten() {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 0..vertex_count {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut neighbours = vec![0; starts[vertex_count] as usize];
        for [a, b] in pairs {
            for [from, to] in [[a, b], [b, a]] {
                neighbours[next[from as usize] as usize] = to;
                next[from as usize] += 1;
            }
        }
        Self { starts, neighbours }
    }

    /// Sorts each vertex's neighbours: those with fewer neighbours first, then by number.
    pub(crate) fn sort_by_degree(&mut self) {
        let starts = &self.starts;
        let degree = |v: u32| starts[v as usize + 1] - starts[v as usize];
        for range in starts.windows(2) {
            self.neighbours[range[0] as usize..range[1] as usize]
                .sort_unstable_by_key(|&v| (degree(v), v));
        }
    }

    /// Number of vertices.
    #[cfg(feature = "cholesky")]
    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Neighbours of a vertex.
    pub(crate) fn of(&self, vertex: u32) -> &[u32] {
        let [from, to] = [vertex as usize, vertex as usize + 1].map(|v| self.starts[v] as usize);
        &self.neighbours[from..to]
    }
}
