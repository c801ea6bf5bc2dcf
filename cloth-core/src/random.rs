//! Random numbers that are the same in every run and with every version of every crate.

use crate::math::Real;

/// A generator of three lines (G. L. Steele, D. Lea, C. H. Flood, *Fast splittable pseudorandom
/// number generators*, 2014, doi:10.1145/2660193.2660195).
#[derive(Clone, Debug)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// The sequence that belongs to `seed`; any seed is as good as any other.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub fn next_bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Evenly distributed in [−1, 1).
    pub fn symmetric(&mut self) -> Real {
        // The upper 53 bits are a whole number that an f64 holds exactly.
        (self.next_bits() >> 11) as Real / (1_u64 << 52) as Real - 1.0
    }
}
