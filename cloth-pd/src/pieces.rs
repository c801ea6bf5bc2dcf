//! The cloth cut into pieces of neighbouring vertices, so that sums over elements come out the same on any number of threads.

use crate::local::share;
use crate::planes::{Run, Runs};
use crate::pulls::{BLOCK, Pulls};
use cloth_core::chunked::CHUNK;
use cloth_core::element::Projective;
use cloth_core::math::{Real, Vec3};
use cloth_core::parallel::wide;

/// The piece of a vertex.
#[inline]
pub(crate) fn of(vertex: u32) -> usize {
    vertex as usize / CHUNK
}

/// The elements of a family, by pieces of the cloth: vertices with neighbouring numbers.
///
/// Each piece visits the elements that touch it and adds to its own vertices only; an element on the border of two pieces is visited by both. So no two threads write to the same place, and every
/// vertex adds up the same numbers in the same order on any number of threads. A number per element is added up by the piece of its first vertex.
///
/// Meshes are mostly numbered along rows, and then the edges of one direction have their ends one after another as well. Such [`Runs`] need no index per element: their ends are read, and added to, as streams.
#[derive(Debug, Default)]
pub(crate) struct Pieces {
    /// One number per piece.
    pub(crate) values: Vec<Real>,
    /// What each piece visits; empty before the lists are made, and after the elements have changed.
    parts: Vec<Part>,
}

/// What one piece visits.
#[derive(Clone, Debug, Default)]
struct Part {
    runs: Runs,
    /// The numbers of all elements without a run, ascending.
    scattered: Vec<u32>,
}

impl Pieces {
    pub(crate) fn new(vertex_count: usize) -> Self {
        Self {
            values: vec![0.0; vertex_count.div_ceil(CHUNK)],
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
            let run = Run::at(elements, at).filter(|_| in_runs);
            for vertex in elements[at].vertices() {
                let part = &mut self.parts[of(vertex)];
                if let Some(run) = run {
                    part.runs.push(run, elements);
                } else if part.scattered.last() != Some(&(at as u32)) {
                    part.scattered.push(at as u32);
                }
            }
            at += run.map_or(1, |run| run.elements().len());
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
                || sum_part(part, piece, elements, are_spheres, x, out),
            );
        };
        for_each_part(elements.len(), &self.parts, out, &mut self.values, sum);
        self.values.iter().sum()
    }
}

/// Adds what the elements of a part pull at the vertices of its piece to `out`, and returns the energy of those that it counts.
#[inline(always)]
fn sum_part<const N: usize, const K: usize, E: Projective<N, K>>(
    part: &Part,
    piece: usize,
    elements: &[E],
    are_spheres: bool,
    x: &[Vec3],
    out: &mut [Vec3],
) -> Real {
    let mut pulls = Pulls::default();
    let streamed = part.runs.sum(piece, elements, x, out);
    let mut total = streamed.unwrap_or(0.0);
    if streamed.is_none() {
        for block in part
            .runs
            .each()
            .flat_map(|run| elements[run.elements()].chunks(BLOCK))
        {
            total += sum_block(block.iter(), &mut pulls, are_spheres, x, (piece, out));
        }
    }
    for block in part.scattered.chunks(BLOCK) {
        let block = block.iter().map(|&element| &elements[element as usize]);
        total += sum_block(block, &mut pulls, are_spheres, x, (piece, out));
    }
    total
}

/// The same for at most [`BLOCK`] elements from anywhere.
#[inline(always)]
fn sum_block<'a, const N: usize, const K: usize, E: Projective<N, K>>(
    block: impl Iterator<Item = &'a E> + Clone,
    pulls: &mut Pulls<K>,
    are_spheres: bool,
    x: &[Vec3],
    (piece, out): (usize, &mut [Vec3]),
) -> Real {
    let mut total = 0.0;
    pulls.find(block.clone(), are_spheres, x);
    for (element, (pull, energy)) in block.zip(pulls.each()) {
        let (vertices, operator) = (element.vertices(), element.operator());
        for i in 0..N {
            // Wraps to a large number for a vertex before the piece, and finds nothing.
            let place = (vertices[i] as usize).wrapping_sub(piece * CHUNK);
            if let Some(out) = out.get_mut(place) {
                *out += share(&operator, pull, i);
            }
        }
        if of(vertices[0]) == piece {
            total += energy;
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
        .zip(out.chunks_mut(CHUNK))
        .zip(values)
        .enumerate()
    {
        sum(piece, part, out, total);
    }
}

#[cfg(feature = "parallel")]
use threads::for_each_part;
#[cfg(feature = "parallel")]
mod threads {
    use super::{CHUNK, Part};
    use cloth_core::math::{Real, Vec3};
    use rayon::prelude::*;

    /// Smaller families are visited on one thread: an element costs about five nanoseconds, so these take less than a sixth of
    /// a millisecond, and a second thread that has to be woken first saves nothing of it.
    const SMALLEST_PARALLEL_FAMILY: usize = 32_768;

    /// Each part with its number, its vertices and its value.
    pub(crate) fn for_each_part(
        element_count: usize,
        parts: &[Part],
        out: &mut [Vec3],
        values: &mut [Real],
        sum: impl Fn(usize, &Part, &mut [Vec3], &mut Real) + Send + Sync,
    ) {
        if element_count >= SMALLEST_PARALLEL_FAMILY && rayon::current_num_threads() > 1 {
            let pieces = parts.par_iter().zip(out.par_chunks_mut(CHUNK)).zip(values);
            let pieces = pieces.enumerate();
            pieces.for_each(|(piece, ((part, out), total))| sum(piece, part, out, total));
        } else {
            let pieces = parts.iter().zip(out.chunks_mut(CHUNK)).zip(values);
            let pieces = pieces.enumerate();
            pieces.for_each(|(piece, ((part, out), total))| sum(piece, part, out, total));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local::key;
    use cloth_core::cloth::{Cloth, Membrane};
    use cloth_core::mesh::generate::{Diagonals, grid};

    /// One edge has no length, which the streams of its piece cannot project.
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
            for (piece, part) in pieces.parts.iter().enumerate() {
                let len = CHUNK.min(x.len() - piece * CHUNK);
                let energy = part.runs.sum(piece, springs, &x, &mut out[..len]);
                assert_eq!(energy.is_none(), in_runs && piece == 0);
            }
            out.fill(Vec3::zeros());
            let energy = pieces.sum(springs, true, &x, &mut out);
            let runs = pieces.parts.iter().flat_map(|part| part.runs.each());
            (
                out,
                energy,
                runs.map(|run| run.elements().len()).sum::<usize>(),
            )
        };
        let mut springs = model.springs;
        springs.sort_by_key(key);
        for (i, spring) in springs.iter_mut().enumerate() {
            spring.stiffness += (i % 5) as Real;
            spring.rest_length *= 1.0 + 0.1 * (i % 7) as Real;
        }
        let (out, energy, in_runs) = pulled(&springs, true);
        assert!(in_runs > springs.len(), "{in_runs}");
        let (expected, expected_energy, in_runs) = pulled(&springs, false);
        assert_eq!(in_runs, 0);
        assert!((energy - expected_energy).abs() < 1e-13 * energy);
        for v in 0..x.len() {
            let error = (out[v] - expected[v]).norm();
            assert!(error < 1e-14, "{v}: {error:e}");
        }
    }
}
