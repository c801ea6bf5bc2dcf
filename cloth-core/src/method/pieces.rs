//! Sums over each connected piece of the cloth.
//!
//! A step ends when every piece is near enough to where it will be. In a norm over all of the cloth a light piece
//! beside a heavy one would hardly count, and could stay where it was.

use crate::math::Vec3;
use std::ops::{AddAssign, Range};

/// Which piece each vertex belongs to: what elements couple, directly or not.
#[derive(Clone, Debug, Default)]
pub struct Pieces {
    of: Vec<u32>,
    count: usize,
}

impl Pieces {
    /// The pieces of vertices with a label each, the same for all of a piece.
    ///
    /// # Panics
    /// If a label is not below the number of vertices.
    #[must_use]
    pub fn new(labels: &[u32]) -> Self {
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

    /// The number of the piece of each vertex, from 0 in the order of their lowest vertices.
    #[must_use]
    pub fn of_each(&self) -> &[u32] {
        &self.of
    }

    /// Number of pieces.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.of.len()
    }

    /// Vertices that follow each other and belong to one piece; as many as pieces if all vertices of each do.
    #[must_use]
    pub fn ranges(&self) -> Vec<Range<usize>> {
        let mut end = 0;
        let runs = self.of.chunk_by(|a, b| a == b);
        runs.map(|run| {
            let start = end;
            end += run.len();
            start..end
        })
        .collect()
    }

    /// Sets to zero what the vertices of some pieces have.
    pub fn clear(&self, which: &[bool], of: &mut [Vec3]) {
        for (of, &piece) in of.iter_mut().zip(&self.of) {
            if which[piece as usize] {
                *of = Vec3::zeros();
            }
        }
    }

    /// Writes to `out` the sum over each piece of what its vertices have.
    pub fn sum<T: Copy + Default + AddAssign>(&self, out: &mut Vec<T>, of: impl Fn(usize) -> T) {
        out.clear();
        out.resize(self.count, T::default());
        let mut vertex = 0;
        for run in self.of.chunk_by(|a, b| a == b) {
            // A sum that stays in a register.
            let mut sum = out[run[0] as usize];
            for _ in run {
                sum += of(vertex);
                vertex += 1;
            }
            out[run[0] as usize] = sum;
        }
    }
}
