//! The air pushes with every method alike.

use crate::common::{converged, methods};
use cloth_bench::run::run;
use cloth_bench::scene::{self, file};
use cloth_bench::settings::Settings;
use cloth_core::math::{Real, Vec3};
use std::path::PathBuf;

/// A flat sheet that falls flat is at rest relative to itself: the drag, half ρ C_D v² of each square metre, alone ends
/// the fall.
#[test]
fn a_falling_sheet_reaches_the_speed_at_which_the_air_carries_it() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("air");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("parachute.toml");
    let text = "[[mesh]]\ngenerator = \"grid:9x9:alternating\"\n[cloth]\ndensity = 0.15\n[air]\ndensity = 1.1\ndrag = 1.4\nlift = 0.5\nwind = [0, 0, 0.6]\n";
    std::fs::write(&path, text).unwrap();
    let scene = file::build(&path, &Settings::default()).unwrap();
    let through_air = (2.0 * 0.15 * 9.81 / (1.1 * 1.4) as Real).sqrt();
    let expected = Vec3::z() * (0.6 - through_air);
    for method in methods() {
        let mut state = scene.start.clone();
        let mut stepper = converged(method, &scene);
        run(
            &scene,
            &mut *stepper,
            &mut state,
            scene.dt,
            200,
            |_, _, _| Ok(()),
        )
        .unwrap();
        let mean = state.velocities.iter().sum::<Vec3>() / state.velocities.len() as Real;
        let off = (mean - expected).norm();
        assert!(off < 1e-12, "{}: {off:e} m/s off", method.name);
        // Rounding of positions some metres from the origin makes the undamped stiff modes of explicit methods tremble.
        let trembling = state.velocities.iter().map(|v| (v - mean).norm());
        let trembling = trembling.fold(0.0, Real::max);
        assert!(trembling < 1e-9, "{}: {trembling:e} m/s", method.name);
    }
}

#[test]
fn a_scene_without_a_table_of_air_has_none() {
    let hang = scene::build("hang", None, &Settings::default()).unwrap();
    assert!(hang.air.is_none() && hang.is_plain());
}
