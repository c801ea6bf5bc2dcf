//! The pairs of the quasi-Newton method, of each piece of the cloth by itself.
//!
//! Pieces that no element couples are minimised each for itself: the Hessian has no block between two of them. In the
//! products of pairs of all of the cloth a light piece beside a heavy one would hardly count, and its part of the
//! direction would be one for the other.

use cloth_core::math::{Real, Vec3};
use cloth_core::method::limited_memory::{FirstLoop, LimitedMemory};
use cloth_core::method::pieces::Pieces;
use cloth_core::method::vectors::dot;
use std::ops::Range;

/// Beyond so many pieces they have their pairs together.
const MOST_PIECES: usize = 256;

/// Pairs of each piece, whose vertices follow each other.
#[derive(Debug)]
pub(crate) struct Memory {
    parts: Vec<Part>,
    capacity: usize,
}

#[derive(Debug)]
struct Part {
    range: Range<usize>,
    pairs: LimitedMemory<f64>,
    first: Option<FirstLoop>,
}

impl Memory {
    /// Memories of at most `capacity` pairs, empty. If the vertices of a piece do not follow each other, or if there
    /// are too many pieces, there is one for all.
    pub(crate) fn new(pieces: &Pieces, capacity: usize) -> Self {
        let mut ranges = pieces.ranges();
        if ranges.len() != pieces.count() || ranges.len() > MOST_PIECES {
            ranges.clear();
            ranges.push(0..pieces.vertex_count());
        }
        let parts = ranges.into_iter().map(|range| Part {
            pairs: LimitedMemory::new(range.len(), capacity),
            first: None,
            range,
        });
        Self {
            parts: parts.collect(),
            capacity,
        }
    }

    /// The same for other pieces, if they are others.
    pub(crate) fn set_pieces(&mut self, pieces: &Pieces) {
        let new = Self::new(pieces, self.capacity);
        let ranges = |memory: &Self| -> Vec<_> {
            let parts = memory.parts.iter();
            parts.map(|part| part.range.clone()).collect()
        };
        if ranges(&new) != ranges(self) {
            *self = new;
        }
    }

    /// Forgets all pairs.
    pub(crate) fn clear(&mut self) {
        self.parts.iter_mut().for_each(|part| part.pairs.clear());
    }

    /// Forgets all pairs, and keeps at most `capacity` of those to come.
    pub(crate) fn clear_for(&mut self, capacity: usize) {
        for part in &mut self.parts {
            part.pairs.clear_for(capacity);
        }
    }

    /// Adds the pair of a step along `direction` (m), of which it has taken `length`, between two gradients (N).
    /// `slope` is the product of the first with the direction (J).
    pub(crate) fn push(
        &mut self,
        (length, slope): (Real, Real),
        direction: &[Vec3],
        from: &[Vec3],
        to: &[Vec3],
    ) {
        let is_alone = self.parts.len() == 1;
        for Part { range, pairs, .. } in &mut self.parts {
            let (direction, from) = (&direction[range.clone()], &from[range.clone()]);
            let own = match is_alone {
                true => slope,
                false => dot(from, direction),
            };
            pairs.push(length, own, direction, from, &to[range.clone()]);
        }
    }

    /// Writes `−H g` (m) to `out`, with H the inverse Hessian that the pairs make of the first one, which `inverse`
    /// applies; returns its product with g (J). `work` is room for a vector (N).
    pub(crate) fn direction(
        &mut self,
        gradient: &[Vec3],
        work: &mut [Vec3],
        out: &mut [Vec3],
        inverse: impl FnOnce(&[Vec3], &mut [Vec3]),
    ) -> Real {
        for Part {
            range,
            pairs,
            first,
        } in &mut self.parts
        {
            let range = range.clone();
            *first = Some(pairs.first_loop(&gradient[range.clone()], &mut work[range]));
        }
        inverse(work, out);
        let slopes = self.parts.iter().map(|part| {
            let (range, first) = (part.range.clone(), part.first.as_ref());
            let first = first.expect("the first loop was taken");
            let out = &mut out[range.clone()];
            part.pairs.second_loop(first, &gradient[range], out)
        });
        slopes.sum()
    }
}
