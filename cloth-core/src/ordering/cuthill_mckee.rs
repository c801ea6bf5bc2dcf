//! Breadth first search from a far end, neighbours of few neighbours first.

use crate::topology::EdgeTable;

/// All vertices in Cuthill–McKee order, not yet reversed; pieces follow by their lowest vertex.
pub(super) fn sequence(vertex_count: usize, edges: &EdgeTable) -> Vec<u32> {
    let graph = Graph::new(vertex_count, edges);
    let mut search = Search {
        graph: &graph,
        mark: vec![0; vertex_count],
        round: 0,
        queue: Vec::with_capacity(vertex_count),
    };
    let mut numbered = vec![false; vertex_count];
    let mut sequence = Vec::with_capacity(vertex_count);
    for vertex in 0..vertex_count as u32 {
        if !numbered[vertex as usize] {
            let start = search.far_end(vertex);
            search.run(start);
            for &v in &search.queue {
                numbered[v as usize] = true;
            }
            sequence.extend_from_slice(&search.queue);
        }
    }
    sequence
}

/// Neighbours of each vertex, those with fewer neighbours first, then by number.
struct Graph {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Graph {
    fn new(vertex_count: usize, edges: &EdgeTable) -> Self {
        let mut starts = vec![0_u32; vertex_count + 1];
        for &vertex in edges.ends().as_flattened() {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 0..vertex_count {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut neighbours = vec![0; 2 * edges.len()];
        for &[a, b] in edges.ends() {
            for [from, to] in [[a, b], [b, a]] {
                neighbours[next[from as usize] as usize] = to;
                next[from as usize] += 1;
            }
        }
        let degree = |v: u32| starts[v as usize + 1] - starts[v as usize];
        for range in starts.windows(2) {
            neighbours[range[0] as usize..range[1] as usize]
                .sort_unstable_by_key(|&v| (degree(v), v));
        }
        Self { starts, neighbours }
    }

    fn of(&self, vertex: u32) -> &[u32] {
        let [from, to] = [vertex as usize, vertex as usize + 1].map(|v| self.starts[v] as usize);
        &self.neighbours[from..to]
    }
}

/// Breadth first search whose marks need no clearing between runs.
struct Search<'a> {
    graph: &'a Graph,
    /// In which round a vertex was reached last.
    mark: Vec<u32>,
    round: u32,
    /// The vertices of this round in the order they were reached.
    queue: Vec<u32>,
}

impl Search<'_> {
    /// Fills the queue with the piece of `start`; returns the number of levels and where in the queue
    /// the last one begins.
    fn run(&mut self, start: u32) -> (usize, usize) {
        self.round += 1;
        self.queue.clear();
        self.queue.push(start);
        self.mark[start as usize] = self.round;
        let (mut levels, mut begin) = (0, 0);
        let mut last = 0;
        while begin < self.queue.len() {
            last = begin;
            levels += 1;
            let end = self.queue.len();
            for at in begin..end {
                for &neighbour in self.graph.of(self.queue[at]) {
                    if self.mark[neighbour as usize] != self.round {
                        self.mark[neighbour as usize] = self.round;
                        self.queue.push(neighbour);
                    }
                }
            }
            begin = end;
        }
        (levels, last)
    }

    /// A vertex from which the search takes many levels: go to the last level, take its vertex
    /// with the fewest neighbours, and start again there as long as the number of levels grows.
    fn far_end(&mut self, start: u32) -> u32 {
        let mut end = start;
        let (mut most, mut last) = self.run(start);
        loop {
            let outermost = self.queue[last..].iter().copied();
            let next = outermost.min_by_key(|&v| (self.graph.of(v).len(), v));
            let Some(next) = next else { return end };
            let (levels, last_of_next) = self.run(next);
            if levels <= most {
                return end;
            }
            (end, most, last) = (next, levels, last_of_next);
        }
    }
}
