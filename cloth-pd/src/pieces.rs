//! The cloth cut into pieces of neighbouring vertices, so that sums over elements come out the same on any number of threads.

use crate::local::share;
use crate::pulls::{BLOCK, Pulls};
use cloth_core::element::Projective;
use cloth_core::math::{Real, Vec3};
use cloth_core::wide::wide;

/// Vertices of a piece. Twice as many make half as many elements that are visited twice, and half as many pieces.
pub(crate) const PIECE: usize = 2_048;

/// The piece of a vertex.
#[inline]
pub(crate) fn of(vertex: u32) -> usize {
    vertex as usize / PIECE
}

/// The elements of a family, by pieces of the cloth: vertices with neighbouring numbers.
///
/// Each piece visits the elements that touch it and adds to its own vertices only; an element on the border of two pieces is visited by both. So no two threads write to the same place, and every
/// vertex adds up the same numbers in the same order on any number of threads. A number per element is added up by the piece of its first vertex.
///
/// Meshes are mostly numbered along rows, and then the edges of one direction have their ends one after another as well. Such [`Run`]s need no index per element: their ends are read, and added to, as streams.
#[derive(Debug, Default)]
pub(crate) struct Pieces {
    /// One number per piece.
    pub(crate) values: Vec<Real>,
    /// What each piece visits; empty before the lists are made, and after the elements have changed.
    parts: Vec<Part>,
}

/// What one piece visits.
#[derive(Clone, Debug, Default)]
pub(crate) struct Part {
    pub(crate) runs: Vec<Run>,
    /// The numbers of all elements without a run, ascending.
    pub(crate) scattered: Vec<u32>,
}

/// Elements one after another with the same operator, each with vertices `stride` further than those of the one before. Vertices in the same place of each are in one piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) first: u32,
    pub(crate) len: u32,
    /// 1 or 2.
    pub(crate) stride: u32,
}

/// Fewer elements are not worth the calls.
const SHORTEST_RUN: u32 = 8;

impl Run {
    /// The longest at the front of `elements`, of which the first has number `first`, of a piece.
    fn at<const N: usize, const K: usize, E: Projective<N, K>>(
        elements: &[E],
        first: usize,
    ) -> Self {
        let rest = &elements[first..];
        let (start, operator) = (rest[0].vertices(), rest[0].operator());
        let stride = rest
            .get(1)
            .map_or(1, |second| second.vertices()[0].wrapping_sub(start[0]));
        let continues = |(step, element): &(u32, &E)| {
            let expected = start.map(|vertex| vertex.wrapping_add(step * stride));
            element.vertices() == expected
                && (0..N).all(|i| of(expected[i]) == of(start[i]))
                && element.operator() == operator
        };
        let len = match stride {
            1 | 2 => (0..).zip(rest).take_while(continues).count() as u32,
            _ => 1,
        };
        Self {
            first: first as u32,
            len: len.max(1),
            stride,
        }
    }
}

impl Pieces {
    pub(crate) fn new(vertex_count: usize) -> Self {
        Self {
            values: vec![0.0; vertex_count.div_ceil(PIECE)],
            parts: Vec::new(),
        }
    }

    /// Forgets which elements there are.
    pub(crate) fn forget(&mut self) {
        self.parts.clear();
    }

    /// Lists the elements, in runs where `in_runs` and they have such.
    fn list<const N: usize, const K: usize, E: Projective<N, K>>(
        &mut self,
        elements: &[E],
        in_runs: bool,
    ) {
        self.parts = vec![Part::default(); self.values.len()];
        let mut at = 0;
        while at < elements.len() {
            let run = Run::at(elements, at);
            at += run.len as usize;
            if in_runs && run.len >= SHORTEST_RUN {
                for vertex in elements[run.first as usize].vertices() {
                    let list = &mut self.parts[of(vertex)].runs;
                    if list.last() != Some(&run) {
                        list.push(run);
                    }
                }
                continue;
            }
            for index in run.first..run.first + run.len {
                for vertex in elements[index as usize].vertices() {
                    let list = &mut self.parts[of(vertex)].scattered;
                    if list.last() != Some(&index) {
                        list.push(index);
                    }
                }
            }
        }
    }

    /// Adds `Σ w Gᵀ(G x − p)` to `out`, and returns `½ Σ w ‖G x − p‖²`; on one thread or on several, with the same bits.
    pub(crate) fn sum<const N: usize, const K: usize, E: Projective<N, K>>(
        &mut self,
        elements: &[E],
        are_spheres: bool,
        x: &[Vec3],
        out: &mut [Vec3],
    ) -> Real {
        if self.parts.is_empty() {
            self.list(elements, are_spheres);
        }
        let sum = |piece: usize, part: &Part, out: &mut [Vec3], total: &mut Real| {
            *total = wide(
                #[inline(always)]
                || sum_part(part, piece * PIECE, elements, are_spheres, x, out),
            );
        };
        for_each_part(elements.len(), &self.parts, out, &mut self.values, sum);
        self.values.iter().sum()
    }
}

/// Adds what the elements of a part pull at the vertices of its piece, `out`, of which the first has the number `start`, and returns the energy of those that it counts.
#[inline(always)]
fn sum_part<const N: usize, const K: usize, E: Projective<N, K>>(
    part: &Part,
    start: usize,
    elements: &[E],
    are_spheres: bool,
    x: &[Vec3],
    out: &mut [Vec3],
) -> Real {
    let mut pulls = Pulls::default();
    let mut energies = [0.0; BLOCK];
    for run in &part.runs {
        let elements = &elements[run.first as usize..][..run.len as usize];
        for block in elements.chunks(BLOCK) {
            match run.stride {
                1 => pulls.add_run::<1, N, E>(block, x, (start, out)),
                _ => pulls.add_run::<2, N, E>(block, x, (start, out)),
            }
            if of(block[0].vertices()[0]) == start / PIECE {
                pulls.add_energies(&mut energies);
            }
        }
    }
    let mut total = energies.iter().sum();
    for block in part.scattered.chunks(BLOCK) {
        let block = block.iter().map(|&element| &elements[element as usize]);
        pulls.find(block.clone(), are_spheres, x);
        for (element, (pull, energy)) in block.zip(pulls.each()) {
            let (vertices, operator) = (element.vertices(), element.operator());
            for i in 0..N {
                // Wraps to a large number for a vertex before the piece, and finds nothing.
                if let Some(out) = out.get_mut((vertices[i] as usize).wrapping_sub(start)) {
                    *out += share(&operator, pull, i);
                }
            }
            if of(vertices[0]) == start / PIECE {
                total += energy;
            }
        }
    }
    total
}

#[cfg(not(feature = "parallel"))]
fn for_each_part(
    _: usize,
    parts: &[Part],
    out: &mut [Vec3],
    values: &mut [Real],
    sum: impl Fn(usize, &Part, &mut [Vec3], &mut Real),
) {
    for (piece, ((part, out), total)) in parts
        .iter()
        .zip(out.chunks_mut(PIECE))
        .zip(values)
        .enumerate()
    {
        sum(piece, part, out, total);
    }
}

#[cfg(feature = "parallel")]
use threads::for_each_part;
#[cfg(feature = "parallel")]
pub(crate) use threads::together;

/// Does two things that have nothing to do with each other, one after the other.
#[cfg(not(feature = "parallel"))]
pub(crate) fn together<A, B>(
    _: usize,
    first: impl FnOnce() -> A,
    second: impl FnOnce() -> B,
) -> (A, B) {
    (first(), second())
}

#[cfg(feature = "parallel")]
mod threads {
    use super::{PIECE, Part};
    use cloth_core::math::{Real, Vec3};
    use rayon::prelude::*;

    /// Smaller families are visited on one thread: an element costs about five nanoseconds, so these take less than a sixth of
    /// a millisecond, and a second thread that has to be woken first saves nothing of it.
    const SMALLEST_PARALLEL_FAMILY: usize = 32_768;

    /// Passes over fewer vertices than this take less than it costs to wake a second thread a few times in an iteration.
    const SMALLEST_PARALLEL_CLOTH: usize = 8_192;

    /// Does two things that have nothing to do with each other, at the same time if there are several threads and the cloth has enough vertices.
    pub(crate) fn together<A: Send, B: Send>(
        vertex_count: usize,
        first: impl FnOnce() -> A + Send,
        second: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        if vertex_count >= SMALLEST_PARALLEL_CLOTH && rayon::current_num_threads() > 1 {
            rayon::join(first, second)
        } else {
            (first(), second())
        }
    }

    /// Each part with its number, its vertices and its value.
    pub(crate) fn for_each_part(
        element_count: usize,
        parts: &[Part],
        out: &mut [Vec3],
        values: &mut [Real],
        sum: impl Fn(usize, &Part, &mut [Vec3], &mut Real) + Send + Sync,
    ) {
        if element_count >= SMALLEST_PARALLEL_FAMILY && rayon::current_num_threads() > 1 {
            let pieces = parts.par_iter().zip(out.par_chunks_mut(PIECE)).zip(values);
            let pieces = pieces.enumerate();
            pieces.for_each(|(piece, ((part, out), total))| sum(piece, part, out, total));
        } else {
            let pieces = parts.iter().zip(out.chunks_mut(PIECE)).zip(values);
            let pieces = pieces.enumerate();
            pieces.for_each(|(piece, ((part, out), total))| sum(piece, part, out, total));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_core::cloth::{Cloth, Membrane};
    use cloth_core::mesh::generate::{Diagonals, grid};

    /// One edge has no length, which no stream can project.
    #[test]
    fn runs_pull_as_elements_one_by_one_do() {
        let mesh = grid(80, 60, 1.0, 1.0, Diagonals::Alternating).unwrap();
        let membrane = Membrane::SpringStiffness(3.0);
        let cloth = Cloth {
            areal_density: 0.2,
            membrane,
            bending_rigidity: 0.0,
        };
        let model = cloth.on(&mesh).unwrap();
        let mut x = mesh.positions().to_vec();
        for (i, x) in x.iter_mut().enumerate() {
            x.z = 0.01 * ((i * 31 % 17) as Real);
        }
        x[1000] = x[1001];
        let pulled = |springs: &[_], in_runs: bool| {
            let mut pieces = Pieces::new(x.len());
            pieces.list(springs, in_runs);
            let mut out = vec![Vec3::zeros(); x.len()];
            let energy = pieces.sum(springs, true, &x, &mut out);
            let runs = pieces.parts.iter().flat_map(|part| &part.runs);
            (out, energy, runs.map(|run| run.len).sum::<u32>())
        };
        let mut springs = model.springs;
        springs.sort_by_key(|s| (s.vertices[1] - s.vertices[0], s.vertices[0]));
        for (i, spring) in springs.iter_mut().enumerate() {
            spring.stiffness += (i % 5) as Real;
            spring.rest_length *= 1.0 + 0.1 * (i % 7) as Real;
        }
        let (out, energy, in_runs) = pulled(&springs, true);
        assert!(in_runs as usize > springs.len(), "{in_runs}");
        let (expected, expected_energy, in_runs) = pulled(&springs, false);
        assert_eq!(in_runs, 0);
        assert!((energy - expected_energy).abs() < 1e-13 * energy);
        for v in 0..x.len() {
            let error = (out[v] - expected[v]).norm();
            assert!(error < 1e-14, "{v}: {error:e}");
        }
    }
}
