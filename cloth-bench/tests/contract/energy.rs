//! The energy that a run is given, against closed forms; and that the methods make none of it.

use crate::common::methods;
use cloth_bench::method::Method;
use cloth_bench::run::{Summary, from_start};
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_core::math::Real;
use std::path::PathBuf;

fn scene(name: &str, text: &str) -> Scene {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("energy");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, text).unwrap();
    file::build(&path, &Settings::default()).unwrap()
}

fn summary(scene: &Scene, method: &Method, settings: &[&str], dt: Real, steps: u32) -> Summary {
    let settings = Settings::parse(settings).unwrap();
    let ran = from_start(scene, method, &settings, dt, steps, |_, _, _| Ok(()));
    ran.unwrap_or_else(|error| panic!("{}: {error}", method.name))
        .0
}

/// Symplectic Euler with small steps, which loses and makes next to nothing.
fn nearly_exact(scene: &Scene, dt: Real, steps: u32) -> Summary {
    let method = Method::find("symplectic-euler").unwrap();
    summary(scene, method, &["substeps=1"], dt, steps)
}

#[test]
fn the_work_of_moving_pins_is_all_that_a_pulled_sheet_holds() {
    // Nothing else acts, the pins only ever pull, and they are at rest in the end.
    let pulled = scene(
        "pulled",
        "gravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n[cloth]\nstiffness = 100\nrigidity = 1e-3\n\
         [[pins]]\nselect = \"corners\"\nmove = [0, -0.05, 0.02]\nduration = 0.005\n",
    );
    // The one adds the work up itself, the other does not.
    let bdf2 = Method::find("bdf2").unwrap();
    for (end, bound) in [
        (nearly_exact(&pulled, 1e-6, 50_000), 2.1e-4),
        (summary(&pulled, bdf2, &[], 2e-5, 2500), 2.1e-4),
    ] {
        let held = end.kinetic_energy + end.elastic_energy;
        let off = held / end.energy_given - 1.0;
        let excess = end.energy_excess / held;
        eprintln!("{held} {off:e} {excess:e}");
        assert!(held > 0.01 && off.abs() < bound, "{held} J, {off:e} off");
        assert!(excess < bound, "{excess:e}");
    }
}

#[test]
fn the_work_of_the_wind_is_all_that_a_blown_sheet_holds() {
    let blown = scene(
        "blown",
        "gravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n[air]\nwind = [0, 0, 5]\n",
    );
    let end = nearly_exact(&blown, 1e-4, 2000);
    let off = end.kinetic_energy / end.energy_given - 1.0;
    // A step of constant force that starts at rest takes half of its work; later ones lose Δt/t of theirs.
    assert!(
        end.kinetic_energy > 1.0 && off.abs() < 2e-3,
        "{} J, {off:e} off",
        end.kinetic_energy
    );
}

/// A plate at rest that a floor of speed u catches: the potential has no law of impact, it catches over some distance
/// and may give back what it has stored, but it makes nothing either.
#[test]
fn a_floor_that_catches_a_sheet_makes_no_energy() {
    let text = "gravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n[[obstacle]]\nshape = \"plane\"\nposition = [0, 0, -0.02]\nvelocity = [0, 0, 2]\n";
    let caught = scene("caught", text);
    for method in methods() {
        let end = summary(&caught, method, &[], 1.0 / 60.0, 3);
        assert!(end.kinetic_energy > 0.3, "{}", method.name);
        assert!(
            end.energy_excess <= 1e-9,
            "{}: {:e}",
            method.name,
            end.energy_excess
        );
    }
}

#[test]
fn methods_that_solve_their_step_hold_no_more_than_they_were_given() {
    // Pins that lift and turn, wind, gravity: everything that works at once.
    let flown = scene(
        "flown",
        "[[mesh]]\ngenerator = \"grid:9x9:alternating\"\n[cloth]\nstiffness = 1000\nrigidity = 1e-4\n\
         [[pins]]\nselect = \"corners\"\nmove = [0.2, 0, 0.5]\nturn = [0, 0, 1.5]\nduration = 0.5\n[air]\nwind = [3, 1, 2]\n",
    );
    for name in ["implicit-euler", "xpbd-direct", "pd", "symplectic-euler"] {
        let end = summary(&flown, Method::find(name).unwrap(), &[], 1.0 / 60.0, 60);
        let share = end.energy_excess / end.energy_given;
        assert!(share < 0.01, "{name}: {share:e}");
        assert_eq!(end.energy_gain, None, "{name}");
        assert_eq!(end.energy_warning(), None, "{name}");
    }
}

/// Where cloth is light and soft, a direction of search is many times longer than the cloth, and what truncation vertex
/// by vertex leaves of it goes nowhere: steps that ended there held five times what they were given.
#[test]
fn projective_dynamics_on_the_corner_of_a_table_makes_no_energy() {
    let text = include_str!("../../scenes/handkerchief.toml").replace("41x41", "21x21");
    let small = scene("handkerchief", &text);
    let end = summary(&small, Method::find("pd").unwrap(), &[], 1.0 / 60.0, 20);
    let share = end.energy_excess / end.energy_given;
    assert!(share < 0.01, "{share:e}");
}
