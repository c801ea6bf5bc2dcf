//! Sums over each connected piece of the cloth.
//!
//! A step ends when every piece is near enough to where it will be. In a norm over all of the cloth a light piece
//! beside a heavy one would hardly count, and could stay where it was.

use cloth_core::math::Real;

/// Which piece each vertex belongs to: what elements couple, directly or not.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pieces {
    of: Vec<u32>,
    count: usize,
}

impl Pieces {
    /// The pieces of vertices with a label each, the same for all of a piece.
    pub(crate) fn new(labels: &[u32]) -> Self {
        let mut numbers = vec![u32::MAX; labels.len()];
        let mut count = 0;
        let number = |&label: &u32| {
            let number = &mut numbers[label as usize];
            if *number == u32::MAX {
                *number = count;
                count += 1;
            }
            *number
        };
        Self {
            of: labels.iter().map(number).collect(),
            count: count as usize,
        }
    }

    /// Writes to `out` the sum over each piece of what its vertices have.
    pub(crate) fn sum(&self, out: &mut Vec<Real>, of: impl Fn(usize) -> Real) {
        out.clear();
        out.resize(self.count, 0.0);
        for (vertex, &piece) in self.of.iter().enumerate() {
            out[piece as usize] += of(vertex);
        }
    }
}
