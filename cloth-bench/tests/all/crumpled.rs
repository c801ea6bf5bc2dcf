//! The folded sheet that searching is measured with.

use cloth_bench::crumpled::{LAYERS, accordion};
use cloth_collide::SeparationProbe;
use cloth_core::math::Real;

/// Sixteen layers, none of them through another one, nearer than a gap and not much nearer than the creases make
/// it.
#[test]
fn accordion_is_folded_and_free_of_crossings() {
    let gap = 0.004;
    let (mesh, positions) = accordion(33, gap).unwrap();
    let found = SeparationProbe::new(&mesh).measure(&positions).unwrap();
    assert_eq!(found.intersecting_pairs, 0);
    assert!(found.min_distance.unwrap() > 0.05 * gap);
    let high = positions.iter().map(|x| x.z).fold(0.0, Real::max);
    assert!((high - Real::from(LAYERS) * gap).abs() < 0.05 * gap);
    let wide = positions.iter().map(|x| x.x).fold(0.0, Real::max);
    assert!((wide - 1.0 / Real::from(LAYERS)).abs() < 0.05 * gap);
}
