//! Sheets that slide and rest, against closed forms.

use cloth_bench::studies::contact::laws::{Measured, methods, rest, rest_at, slide};

/// Below the angle of friction a sheet stays, but for the 12 µm by which the spring that holds it is stretched.
/// Heavy cloth in the many substeps of XPBD still swings about its gap.
#[test]
fn every_method_slides_and_rests_as_the_closed_forms_say() {
    for name in methods() {
        for degrees in [10.0, 20.0, 40.0] {
            let Measured { expected, measured } = slide(name, degrees).unwrap();
            let error = (measured.0 - expected.0).abs();
            let most = 1.3e-5 + 1.1e-3 * expected.0;
            assert!(
                error < most,
                "{name}, {degrees}°: {measured:?} {expected:?}"
            );
        }
        for density in [0.2, 20.0, 80.0] {
            let Measured { expected, measured } = rest(name, density).unwrap();
            let error = (measured.0 - expected.0).abs();
            let most = if name == "xpbd" { 2.1e-5 } else { 1.6e-6 };
            assert!(
                error < most,
                "{name}, {density} kg/m²: {measured:?} {expected:?}"
            );
        }
    }
}

/// Cells have nothing to do with the gap.
#[test]
fn sheets_rest_at_the_same_gap_on_every_mesh() {
    for name in methods() {
        for n in [3.0, 17.0] {
            let Measured { expected, measured } = rest_at(name, n).unwrap();
            let error = (measured.0 - expected.0).abs();
            assert!(error < 5e-7, "{name}, {n}: {measured:?} {expected:?}");
        }
    }
}
