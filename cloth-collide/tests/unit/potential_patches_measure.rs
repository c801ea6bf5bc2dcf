use super::*;
use nalgebra::Rotation3;

/// Two points that turn together by θ one way, and by θ the other way on another path: between the two ends they are
/// nearer than at the start by 1 − cos θ, and no nearer than was allowed for.
#[test]
fn what_a_turn_allows_is_the_chord_of_it() {
    for fraction in [0.1, 0.5, 1.0] {
        let angle = 2.0 * (0.5 * fraction * LARGEST_TURN).asin();
        let [one, other] = [angle, -angle].map(|a| *Rotation3::new(Vec3::z() * a).matrix());
        assert!((tilt(&one, &Mat3::identity()) - fraction * LARGEST_TURN).abs() < 1e-15);
        let change = change_for(0.003, 0.002);
        assert!((nearer_by(change, 0.002) - 0.003).abs() < 1e-17);
        // They begin 5 mm apart, and may come as near as 2 mm: what is left besides the turn is the change.
        let halfway = ((one + other) * (Vec3::x() * 0.0025)).norm();
        assert!(halfway - change >= 0.002 - 1e-17);
        assert!(fraction < 1.0 || (halfway - change - 0.002).abs() < 1e-17);
    }
}
