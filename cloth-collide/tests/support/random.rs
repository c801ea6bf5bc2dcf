//! Numbers that look random and are the same in every run.

use cloth_core::math::{Real, Vec3};

/// A linear congruential generator (Knuth's constants), of which the upper bits are used.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Self(seed);
        random.next();
        random
    }

    fn next(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 11
    }

    /// Between −size and size.
    pub(crate) fn real(&mut self, size: Real) -> Real {
        size * (2.0 * self.next() as Real / (1_u64 << 53) as Real - 1.0)
    }

    /// In a cube of twice the size.
    pub(crate) fn point(&mut self, size: Real) -> Vec3 {
        Vec3::new(self.real(size), self.real(size), self.real(size))
    }
}
