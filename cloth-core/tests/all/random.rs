//! Random numbers against the published sequence.

use cloth_core::random::SplitMix64;

/// The published sequence for seed 1234567.
#[test]
fn splitmix_gives_the_reference_sequence() {
    let mut random = SplitMix64::new(1_234_567);
    assert_eq!(random.next_bits(), 6_457_827_717_110_365_317);
    assert_eq!(random.next_bits(), 3_203_168_211_198_807_973);
    assert_eq!(random.next_bits(), 9_817_491_932_198_370_423);
}
