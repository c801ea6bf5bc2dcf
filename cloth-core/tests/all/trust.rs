//! The radius within which a direction is tried.

use cloth_core::math::{Real, Vec3};
use cloth_core::method::trust::TrustRadius;

#[test]
fn radius_follows_what_steps_have_come_to() {
    let direction = [Vec3::x() * 3.0, Vec3::y() * 4.0];
    let mut radius = TrustRadius::new(Real::INFINITY, 4.0);
    let whole = radius.trust(&direction);
    assert_eq!((whole.longest, whole.fraction), (4.0, 1.0));
    // A tenth of 4 m: 0.8 m are tried next.
    radius.shorten(0.1 * whole.longest);
    let trusted = radius.trust(&direction);
    assert!((trusted.fraction - 0.2).abs() < 1e-15);
    radius.grow();
    assert!((radius.trust(&direction).fraction - 0.8).abs() < 1e-15);
    // Short directions are not touched.
    assert_eq!(radius.trust(&[Vec3::x()]).fraction, 1.0);
}
