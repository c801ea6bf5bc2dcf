//! Where the blocks of each element's Hessian go in a matrix, looked up once and used in every iteration.

use super::{Energies, Family};
use crate::element::{Convexity, Energy};
use crate::math::{Blocks, Mat3, Real, Vec3, gather};
use crate::method::block_matrix::{BlockMatrix, BlockPattern};
use std::sync::Arc;

/// The pattern of a Hessian, and the places in it of the blocks of every element of an [`Energies`].
#[derive(Clone, Debug)]
pub struct Assembly {
    pattern: Arc<BlockPattern>,
    families: Vec<FamilySlots>,
    is_lumped: bool,
}

impl Assembly {
    pub(super) fn new(energies: &Energies, pattern: Arc<BlockPattern>, is_lumped: bool) -> Self {
        let families = energies.families.iter();
        Self {
            families: families.map(|family| family.slots(&pattern)).collect(),
            pattern,
            is_lumped,
        }
    }

    /// How a family is linearised where `by` is asked for, if its eigenvalues are numerical or not.
    pub(super) fn linearization<'a>(
        &self,
        are_numerical: bool,
        by: Linearization<'a>,
    ) -> Linearization<'a> {
        let convexity = Convexity::GaussNewton;
        match by {
            _ if !(self.is_lumped && are_numerical) => by,
            Linearization::At { scale, .. } => Linearization::At { scale, convexity },
            Linearization::Mixed { .. } => Linearization::At {
                scale: 1.0,
                convexity,
            },
        }
    }

    /// The pattern.
    #[must_use]
    pub fn pattern(&self) -> &Arc<BlockPattern> {
        &self.pattern
    }

    pub(super) fn families(&self) -> &[FamilySlots] {
        &self.families
    }
}

/// At what the second derivatives are taken.
#[derive(Clone, Copy, Debug)]
pub(super) enum Linearization<'a> {
    /// At the positions.
    At { scale: Real, convexity: Convexity },
    /// At the positions, but for the constraint values: these are linearised at `from` and taken at `to`. By
    /// [`Convexity::Abs`].
    Mixed { from: &'a [Vec3], to: &'a [Vec3] },
}

/// Stands for a pair of vertices that is not in the pattern.
const LUMPED: u32 = u32::MAX;

/// The places of one family.
#[derive(Clone, Debug, Default)]
pub(super) struct FamilySlots {
    /// Place of each block of the lower half of each element's Hessian: `N (N + 1)/2` numbers an element.
    slots: Vec<u32>,
    /// The Hessian of the whole family, if it is constant: blocks and their places, ascending.
    constant: Vec<(u32, Mat3)>,
    /// The same where the blocks are multiples of the identity.
    isotropic: Vec<(u32, Real)>,
}

impl FamilySlots {
    pub(super) fn of<const N: usize, E: Energy<N>>(
        family: &Family<N, E>,
        pattern: &Arc<BlockPattern>,
    ) -> Self {
        let mut own = Self::default();
        own.slots
            .reserve_exact(family.elements.len() * N * (N + 1) / 2);
        for element in &family.elements {
            let vertices = element.vertices();
            for i in 0..N {
                for j in 0..=i {
                    let slot = pattern.slot(vertices[i], vertices[j]);
                    own.slots.push(slot.unwrap_or(LUMPED));
                }
            }
        }
        if E::HESSIAN_IS_CONSTANT {
            let mut sum = BlockMatrix::zeros(Arc::clone(pattern));
            let hessian = |element: &E, _| element.hessian(&[Vec3::zeros(); N], Convexity::Exact);
            own.add_elements(family, hessian, &mut sum);
            let blocks = (0..).zip(sum.blocks());
            for (slot, block) in blocks.filter(|(_, block)| **block != Mat3::zeros()) {
                if *block == Mat3::from_diagonal_element(block.m11) {
                    own.isotropic.push((slot, block.m11));
                } else {
                    own.constant.push((slot, *block));
                }
            }
            own.slots = Vec::new();
        }
        own
    }

    pub(super) fn add<const N: usize, E: Energy<N>>(
        &self,
        family: &Family<N, E>,
        x: &[Vec3],
        by: &Linearization<'_>,
        out: &mut BlockMatrix,
    ) {
        if E::HESSIAN_IS_CONSTANT {
            let scale = match by {
                Linearization::At { scale, .. } => *scale,
                Linearization::Mixed { .. } => 1.0,
            };
            return out.for_each_chunk(
                #[inline(always)]
                |_, first, blocks| {
                    for (place, block) in in_chunk(&self.constant, first, blocks.len()) {
                        blocks[place] += block * scale;
                    }
                    for (place, value) in in_chunk(&self.isotropic, first, blocks.len()) {
                        for axis in 0..3 {
                            blocks[place][(axis, axis)] += value * scale;
                        }
                    }
                },
            );
        }
        match *by {
            Linearization::At { scale, convexity } => self.add_elements(
                family,
                #[inline(always)]
                |element: &E, vertices| {
                    let mut blocks = element.hessian(&gather(x, vertices), convexity);
                    if scale != 1.0 {
                        blocks
                            .iter_mut()
                            .flatten()
                            .for_each(|block| *block *= scale);
                    }
                    blocks
                },
                out,
            ),
            Linearization::Mixed { from, to } => self.add_elements(
                family,
                #[inline(always)]
                |element: &E, vertices| {
                    let (from, to) = (gather(from, vertices), gather(to, vertices));
                    element.mixed_hessian(&gather(x, vertices), &from, &to)
                },
                out,
            ),
        }
    }

    /// Adds the Hessian of every element, as `hessian` makes it from the element and its vertices.
    #[inline(always)]
    fn add_elements<const N: usize, E: Energy<N>>(
        &self,
        family: &Family<N, E>,
        hessian: impl Fn(&E, [u32; N]) -> Blocks<N> + Sync,
        out: &mut BlockMatrix,
    ) {
        let per_element = N * (N + 1) / 2;
        assert_eq!(
            self.slots.len(),
            per_element * family.elements.len(),
            "assembly of another energy"
        );
        out.for_each_chunk(
            #[inline(always)]
            |pattern, first, blocks| {
                let start = pattern.row_of(first);
                family.for_each_at(
                    start,
                    #[inline(always)]
                    |number, element| {
                        let vertices = element.vertices();
                        let local = hessian(element, vertices);
                        let mut slot = self.slots[number * per_element..].iter();
                        for i in 0..N {
                            for j in 0..=i {
                                let slot = *slot.next().expect("N (N + 1)/2 slots");
                                if slot == LUMPED {
                                    let block = without_negative_part(&local[i][j]);
                                    for vertex in [vertices[i], vertices[j]] {
                                        let diagonal = pattern.row(vertex as usize).end - 1;
                                        add_at(blocks, diagonal.wrapping_sub(first), &block);
                                    }
                                    continue;
                                }
                                // The matrix keeps the block whose row is the larger vertex number.
                                let place = (slot as usize).wrapping_sub(first);
                                if vertices[i] >= vertices[j] {
                                    add_at(blocks, place, &local[i][j]);
                                } else {
                                    add_at(blocks, place, &local[i][j].transpose());
                                }
                            }
                        }
                    },
                );
            },
        );
    }
}

/// The entries for `count` places from `first` on, with their places among these.
#[inline(always)]
fn in_chunk<T: Copy>(
    entries: &[(u32, T)],
    first: usize,
    count: usize,
) -> impl Iterator<Item = (usize, T)> {
    let start = entries.partition_point(|entry| (entry.0 as usize) < first);
    let inside = move |entry: &&(u32, T)| (entry.0 as usize) < first + count;
    let entries = entries[start..].iter().take_while(inside);
    entries.map(move |entry| (entry.0 as usize - first, entry.1))
}

/// Adds a block if it is among those of the chunk.
#[inline(always)]
fn add_at(blocks: &mut [Mat3], place: usize, block: &Mat3) {
    if let Some(out) = blocks.get_mut(place) {
        *out += block;
    }
}

/// The symmetric part of a block, raised by the multiple of the identity that takes away its negative eigenvalue if its
/// rank is one or two: the blocks `a bᵀ` between the gradients of one constraint have symmetric parts of rank two.
fn without_negative_part(block: &Mat3) -> Mat3 {
    let mut symmetric = (block + block.transpose()) * 0.5;
    let trace = symmetric.trace();
    let root = (2.0 * symmetric.norm_squared() - trace * trace)
        .max(0.0)
        .sqrt();
    let raise = (0.5 * (root - trace)).max(0.0);
    for axis in 0..3 {
        symmetric[(axis, axis)] += raise;
    }
    symmetric
}
