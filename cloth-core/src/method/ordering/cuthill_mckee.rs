//! Breadth first search from a far end, neighbours of few neighbours first.

use super::graph::Graph;
use crate::topology::EdgeTable;

/// All vertices in Cuthill–McKee order, not yet reversed; pieces follow by their lowest vertex.
pub(super) fn sequence(vertex_count: usize, edges: &EdgeTable) -> Vec<u32> {
    let mut graph = Graph::new(vertex_count, edges.ends().iter().copied());
    graph.sort_by_degree();
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
