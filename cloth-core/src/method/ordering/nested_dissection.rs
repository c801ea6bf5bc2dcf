//! Nested dissection: cut the graph in two halves, number them first and the cut last, and do the same with each half.
//!
//! What is eliminated on one side of a cut never meets the other side, so the factor has nonzeros in the halves and
//! along the cut only. On a sheet the cut has about √V vertices, and the factor O(V log V) nonzeros, which no ordering
//! can beat by more than a constant.
//!
//! Here a half is what is nearer to one far end of the part than to the other, in steps along edges: no positions are
//! needed. The cut is the side of fewer vertices of those that touch the other half.
//!
//! A. George, "Nested dissection of a regular finite element mesh", SIAM J. Numer. Anal. 10, 1973,
//! <https://doi.org/10.1137/0710032>.

use super::graph::Graph;

/// Parts of at most this many vertices are numbered as they come.
const LEAF: usize = 6;

/// A half has at least this fraction of its part, where the steps allow two values of it.
const LEAST_SHARE: usize = 4;

/// The vertices in their new order.
pub(crate) fn sequence(graph: &Graph) -> Vec<u32> {
    let mut dissection = Dissection {
        graph,
        part: vec![0; graph.len()],
        parts: 1,
        steps: [vec![0; graph.len()], vec![0; graph.len()]],
        seen: vec![0; graph.len()],
        searches: 0,
        queue: Vec::with_capacity(graph.len()),
    };
    // Cuts come first and the whole is turned round in the end.
    let mut backwards = Vec::with_capacity(graph.len());
    let mut waiting: Vec<Vec<u32>> = vec![(0..graph.len() as u32).collect()];
    while let Some(vertices) = waiting.pop() {
        if vertices.len() <= LEAF {
            backwards.extend(vertices);
            continue;
        }
        let [cut, one, other] = dissection.split(&vertices);
        backwards.extend(cut);
        waiting.extend([one, other]);
    }
    backwards.reverse();
    backwards
}

struct Dissection<'a> {
    graph: &'a Graph,
    /// To which part a vertex belongs.
    part: Vec<u32>,
    parts: u32,
    /// Steps along edges from one far end of the part, and from the other.
    steps: [Vec<u32>; 2],
    /// In which search a vertex was reached last.
    seen: Vec<u32>,
    searches: u32,
    /// The vertices of the last search, nearest first.
    queue: Vec<u32>,
}

impl Dissection<'_> {
    /// A cut and two halves. A part in several pieces is split into one of them and the rest, without a cut.
    fn split(&mut self, vertices: &[u32]) -> [Vec<u32>; 3] {
        let one_end = self.search(vertices[0], 0);
        if self.queue.len() < vertices.len() {
            let reached = |v: &u32| self.seen[*v as usize] == self.searches;
            let (piece, rest): (Vec<u32>, _) = vertices.iter().partition(|v| reached(v));
            self.mark(&piece);
            return [Vec::new(), piece, rest];
        }
        let other_end = self.search(one_end, 0);
        self.search(other_end, 1);
        let [one, other] = self.halves(vertices);
        let labels = [self.mark(&one), self.mark(&other)];
        let touches = |v: &u32, label| {
            let mut neighbours = self.graph.of(*v).iter();
            neighbours.any(|&n| self.part[n as usize] == label)
        };
        let cuts: [usize; 2] = [
            one.iter().filter(|v| touches(v, labels[1])).count(),
            other.iter().filter(|v| touches(v, labels[0])).count(),
        ];
        let [cut, rest, whole] = if cuts[0] <= cuts[1] {
            let (cut, rest) = one.iter().partition(|v| touches(v, labels[1]));
            [cut, rest, other]
        } else {
            let (cut, rest) = other.iter().partition(|v| touches(v, labels[0]));
            [cut, rest, one]
        };
        self.mark(&cut);
        [cut, rest, whole]
    }

    /// Breadth first through the part of `start`: fills the queue and the steps; returns the vertex reached last.
    fn search(&mut self, start: u32, end: usize) -> u32 {
        self.searches += 1;
        let (label, steps) = (self.part[start as usize], &mut self.steps[end]);
        self.queue.clear();
        self.queue.push(start);
        self.seen[start as usize] = self.searches;
        steps[start as usize] = 0;
        let mut at = 0;
        while let Some(&vertex) = self.queue.get(at) {
            for &next in self.graph.of(vertex) {
                let new = self.seen[next as usize] != self.searches;
                if new && self.part[next as usize] == label {
                    self.seen[next as usize] = self.searches;
                    steps[next as usize] = steps[vertex as usize] + 1;
                    self.queue.push(next);
                }
            }
            at += 1;
        }
        self.queue[at - 1]
    }

    /// Those nearer to the first end and those nearer to the second, where that makes halves; otherwise the vertices in
    /// that order, cut in the middle.
    fn halves(&self, vertices: &[u32]) -> [Vec<u32>; 2] {
        let lead = |v: u32| {
            let [one, other] = [0, 1].map(|end| i64::from(self.steps[end][v as usize]));
            one - other
        };
        let mut sorted: Vec<(i64, u32)> = vertices.iter().map(|&v| (lead(v), v)).collect();
        sorted.sort_unstable();
        let (count, median) = (sorted.len(), sorted[sorted.len() / 2].0);
        let places = [
            sorted.partition_point(|(lead, _)| *lead < median),
            sorted.partition_point(|(lead, _)| *lead <= median),
        ];
        let [before, after] = places.map(|place| place.min(count - place));
        let mut place = if before >= after {
            places[0]
        } else {
            places[1]
        };
        if LEAST_SHARE * before.max(after) < count {
            place = count / 2;
        }
        let other = sorted.split_off(place);
        [sorted, other].map(|half| half.into_iter().map(|(_, v)| v).collect())
    }

    /// Makes vertices a part of their own; returns its number.
    fn mark(&mut self, vertices: &[u32]) -> u32 {
        let label = self.parts;
        self.parts += 1;
        for &vertex in vertices {
            self.part[vertex as usize] = label;
        }
        label
    }
}
