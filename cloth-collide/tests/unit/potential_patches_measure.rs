use super::*;
use cloth_core::math::Mat3;
use nalgebra::Rotation3;

/// Two points that turn together by θ one way, and by θ the other way on another path: between the two ends they are
/// nearer than at the start by 1 − cos θ, and no nearer than was allowed for.
#[test]
fn what_a_turn_allows_is_the_chord_of_it() {
    for angle in [0.01_f64, 0.1, 0.4] {
        let [one, other] = [angle, -angle].map(|a| *Rotation3::new(Vec3::z() * a).matrix());
        let turn = tilt(&one, &Mat3::identity());
        assert!((turn - 2.0 * (0.5 * angle).sin()).abs() < 1e-15);
        let allowed = Allowed::all(Some(turn), 0.003, 0.002);
        assert!((allowed.nearer(0.002) - 0.003).abs() < 1e-17);
        // They begin 5 mm apart, and may come as near as 2 mm: what is left besides the turn is the change.
        let halfway = (one + other) * (Vec3::x() * 0.0025);
        assert!((halfway.norm() - allowed.change - 0.002).abs() < 1e-17);
    }
}
