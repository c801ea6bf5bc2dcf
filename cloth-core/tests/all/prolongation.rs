//! Prolongation and restriction.

use cloth_core::math::Real;
use cloth_core::method::multigrid::Prolongation;

#[test]
fn the_transpose_lists_the_same_weights() {
    let rows: [&[(u32, Real)]; 4] = [&[(1, 1.0)], &[(0, 0.25), (2, 0.75)], &[], &[(2, 1.0)]];
    let p = Prolongation::new(rows, 3);
    assert_eq!([p.fine_count(), p.coarse_count()], [4, 3]);
    assert_eq!(p.of_coarse(0), [(1, 0.25)]);
    assert_eq!(p.of_coarse(1), [(0, 1.0)]);
    assert_eq!(p.of_coarse(2), [(1, 0.75), (3, 1.0)]);
}
