//! Directions of vertices that coincide.

use cloth_core::math::{Vec3, length_and_direction};

#[test]
fn direction_of_coincident_vertices_is_a_unit_vector_and_repeats() {
    for pair in [[0, 1], [1, 0], [7, 123_456], [u32::MAX - 1, u32::MAX]] {
        let (length, n) = length_and_direction(Vec3::zeros(), pair);
        assert_eq!(length, 0.0);
        assert!((n.norm() - 1.0).abs() < 1e-14);
        assert_eq!(n, length_and_direction(Vec3::zeros(), pair).1);
    }
}

#[test]
fn arbitrary_directions_have_no_preferred_side() {
    let mean = (0..10_000)
        .map(|i| length_and_direction(Vec3::zeros(), [i, i + 1]).1)
        .sum::<Vec3>()
        / 10_000.0;
    // The mean of n independent unit vectors has a standard deviation of 1/√n.
    assert!(mean.norm() < 0.03, "mean {mean}");
}
