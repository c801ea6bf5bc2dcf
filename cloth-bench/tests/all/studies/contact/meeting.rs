//! Sheets that meet.

use cloth_bench::studies::contact::laws::methods;
use cloth_bench::studies::contact::meeting::meet;

/// Contact gives one sheet what it takes from the other, and they part, if at all, with what their bending has kept.
#[test]
fn sheets_that_meet_in_free_flight_keep_their_momentum() {
    for name in methods() {
        // The direct solver takes long.
        let speeds: &[f64] = match name {
            "xpbd-direct" => &[0.1],
            _ => &[0.1, 1.0],
        };
        for &speed in speeds {
            let met = meet(name, speed).unwrap();
            let (parting, drift, spin) = (met.parting.0, met.drift.0, met.spin.0);
            assert!(drift < 1e-10, "{name}, {speed} m/s: {drift:e}");
            // Forces of contact act along the lines between points, as those of springs do: what changes the angular
            // momentum is the integrator, which takes them where the points are not, and what a step leaves at its
            // tolerance: of the midpoint rule, which damps nothing, a quarter of 1e-3 (3e-7 with a tolerance of 1e-6).
            let most = match name {
                "symplectic-euler" => 1e-11,
                "implicit-midpoint" => 3e-4,
                "pd" => 5e-4,
                _ => 1e-4,
            };
            assert!(spin < most, "{name}, {speed} m/s: {spin:e}");
            assert!(
                (-0.006 * speed..0.49 * speed).contains(&parting),
                "{name}, {speed} m/s: {parting}"
            );
        }
    }
}
