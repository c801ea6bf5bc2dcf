//! The closed form of lateral buckling.

use cloth_bench::laws::buckling::prandtl;

#[test]
fn the_onset_of_the_beam_is_the_published_one() {
    assert!((prandtl() - 12.8538).abs() < 5e-5, "{}", prandtl());
}
