//! Sums over elements on threads: vertices in blocks of consecutive numbers, each summed by its owner, with the same
//! bits on any number of threads.

use crate::batch::{BATCH_SIZE, ProjectionBatch};
use crate::deinterleaved::{Run, Runs};
use crate::local::force_on;
use cloth_core::element::Projective;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::chunked::CHUNK;
use cloth_core::method::parallel::wide;

/// The block of a vertex.
#[inline]
pub(crate) fn of(vertex: u32) -> usize {
    vertex as usize / CHUNK
}

/// The elements of a family, by blocks of vertices with consecutive numbers.
///
/// Each block visits the elements that touch it and adds to its own vertices only; an element on the border of two
/// blocks is visited by both. So no two threads write to the same entry, and every vertex adds up the same numbers in
/// the same order on any number of threads. A number per element is added up by the block of its first vertex.
///
/// Meshes are mostly numbered along rows, and then the edges of one direction have their ends one after another as
/// well. Such [`Runs`] need no index per element: their ends are read, and added to, as streams.
#[derive(Debug, Default)]
pub(crate) struct VertexBlocks {
    /// One number per block.
    pub(crate) values: Vec<Real>,
    /// What each block visits; empty before the lists are made, and after the elements have changed.
    blocks: Vec<VertexBlock>,
}

/// What one block visits.
#[derive(Clone, Debug, Default)]
struct VertexBlock {
    runs: Runs,
    /// The numbers of all elements without a run, ascending.
    scattered: Vec<u32>,
}

impl VertexBlocks {
    pub(crate) fn new(vertex_count: usize) -> Self {
        Self {
            values: vec![0.0; vertex_count.div_ceil(CHUNK)],
            blocks: Vec::new(),
        }
    }

    /// Clears the lists, after elements have changed.
    pub(crate) fn clear(&mut self) {
        self.blocks.clear();
    }

    /// Lists the elements, in runs where `in_runs` and they have such.
    fn list<const N: usize, const K: usize, E: Projective<N, K>>(
        &mut self,
        elements: &[E],
        in_runs: bool,
    ) {
        self.blocks = vec![VertexBlock::default(); self.values.len()];
        let mut at = 0;
        while at < elements.len() {
            let run = Run::at(elements, at).filter(|_| in_runs);
            for vertex in elements[at].vertices() {
                let block = &mut self.blocks[of(vertex)];
                if let Some(run) = run {
                    block.runs.push(run, elements);
                } else if block.scattered.last() != Some(&(at as u32)) {
                    block.scattered.push(at as u32);
                }
            }
            at += run.map_or(1, |run| run.elements().len());
        }
    }

    /// Adds `Σ w Sᵀ(S x − p)` to `out`, and returns `½ Σ w ‖S x − p‖²`; on one thread or on several, with the same
    /// bits.
    pub(crate) fn sum<const N: usize, const K: usize, E: Projective<N, K>>(
        &mut self,
        elements: &[E],
        are_spheres: bool,
        x: &[Vec3],
        out: &mut [Vec3],
    ) -> Real {
        if self.blocks.is_empty() {
            self.list(elements, are_spheres);
        }
        let sum = |index: usize, block: &VertexBlock, out: &mut [Vec3], total: &mut Real| {
            *total = wide(
                #[inline(always)]
                || sum_block(block, index, elements, are_spheres, x, out),
            );
        };
        for_each_block(elements.len(), &self.blocks, out, &mut self.values, sum);
        self.values.iter().sum()
    }
}

/// Adds what the elements of a block exert at the vertices of block number `index` to `out`, and returns the energy of
/// those that it counts.
#[inline(always)]
fn sum_block<const N: usize, const K: usize, E: Projective<N, K>>(
    block: &VertexBlock,
    index: usize,
    elements: &[E],
    are_spheres: bool,
    x: &[Vec3],
    out: &mut [Vec3],
) -> Real {
    let mut projections = ProjectionBatch::default();
    let streamed = block.runs.sum(index, elements, x, out);
    let mut total = streamed.unwrap_or(0.0);
    if streamed.is_none() {
        for batch in block
            .runs
            .each()
            .flat_map(|run| elements[run.elements()].chunks(BATCH_SIZE))
        {
            total += sum_batch(batch.iter(), &mut projections, are_spheres, x, (index, out));
        }
    }
    for batch in block.scattered.chunks(BATCH_SIZE) {
        let batch = batch.iter().map(|&element| &elements[element as usize]);
        total += sum_batch(batch, &mut projections, are_spheres, x, (index, out));
    }
    total
}

/// The same for at most [`BATCH_SIZE`] elements from anywhere.
#[inline(always)]
fn sum_batch<'a, const N: usize, const K: usize, E: Projective<N, K>>(
    batch: impl Iterator<Item = &'a E> + Clone,
    projections: &mut ProjectionBatch<K>,
    are_spheres: bool,
    x: &[Vec3],
    (index, out): (usize, &mut [Vec3]),
) -> Real {
    let mut total = 0.0;
    projections.find(batch.clone(), are_spheres, x);
    for (element, (force, energy)) in batch.zip(projections.each()) {
        let (vertices, operator) = (element.vertices(), element.operator());
        for i in 0..N {
            // Wraps to a large number for a vertex before the block, and finds nothing.
            let slot = (vertices[i] as usize).wrapping_sub(index * CHUNK);
            if let Some(out) = out.get_mut(slot) {
                *out += force_on(&operator, force, i);
            }
        }
        if of(vertices[0]) == index {
            total += energy;
        }
    }
    total
}

#[cfg(not(feature = "parallel"))]
fn for_each_block(
    _: usize,
    blocks: &[VertexBlock],
    out: &mut [Vec3],
    values: &mut [Real],
    sum: impl Fn(usize, &VertexBlock, &mut [Vec3], &mut Real),
) {
    for (index, ((block, out), total)) in blocks
        .iter()
        .zip(out.chunks_mut(CHUNK))
        .zip(values)
        .enumerate()
    {
        sum(index, block, out, total);
    }
}

#[cfg(feature = "parallel")]
use threads::for_each_block;
#[cfg(feature = "parallel")]
mod threads {
    use super::{CHUNK, VertexBlock};
    use cloth_core::math::{Real, Vec3};
    use rayon::prelude::*;

    /// Smaller families are visited on one thread: an element costs up to about five nanoseconds (a spring in a stream
    /// 1.7), so these take less than a sixth of a millisecond, and a second thread that has to be woken first saves
    /// nothing of it.
    const SMALLEST_PARALLEL_FAMILY: usize = 32_768;

    /// Each block with its number, its vertices and its value.
    pub(crate) fn for_each_block(
        element_count: usize,
        blocks: &[VertexBlock],
        out: &mut [Vec3],
        values: &mut [Real],
        sum: impl Fn(usize, &VertexBlock, &mut [Vec3], &mut Real) + Send + Sync,
    ) {
        if element_count >= SMALLEST_PARALLEL_FAMILY && rayon::current_num_threads() > 1 {
            let blocks = blocks.par_iter().zip(out.par_chunks_mut(CHUNK)).zip(values);
            let blocks = blocks.enumerate();
            blocks.for_each(|(index, ((block, out), total))| sum(index, block, out, total));
        } else {
            let blocks = blocks.iter().zip(out.chunks_mut(CHUNK)).zip(values);
            let blocks = blocks.enumerate();
            blocks.for_each(|(index, ((block, out), total))| sum(index, block, out, total));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local::key;
    use cloth_core::cloth::{Cloth, Membrane};
    use cloth_core::mesh::generate::{Diagonals, grid};

    /// One edge has no length, which the streams of its block cannot project.
    #[test]
    fn runs_give_the_forces_of_single_elements() {
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
            let mut blocks = VertexBlocks::new(x.len());
            blocks.list(springs, in_runs);
            let mut out = vec![Vec3::zeros(); x.len()];
            for (index, block) in blocks.blocks.iter().enumerate() {
                let len = CHUNK.min(x.len() - index * CHUNK);
                let energy = block.runs.sum(index, springs, &x, &mut out[..len]);
                assert_eq!(energy.is_none(), in_runs && index == 0);
            }
            out.fill(Vec3::zeros());
            let energy = blocks.sum(springs, true, &x, &mut out);
            let runs = blocks.blocks.iter().flat_map(|block| block.runs.each());
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
