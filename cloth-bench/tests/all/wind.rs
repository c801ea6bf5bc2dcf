//! What the wind does to cloth that is held and cloth that is free, with every method and at any step.

use crate::exact_runs::{METHODS, rest, run};
use crate::program::program;
use crate::rigid_bodies::watch;
use crate::scene_text::{scene, written};
use cloth_bench::scene::Scene;
use cloth_core::math::Vec3;
use cloth_core::particles::State;

/// An upright sheet of 0.09 m² and 1.8 g in a wind along y, in which its velocity would be that of the air in a
/// sixtieth of a second several times over.
const LIGHT: &str = "gravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:7x7:alternating\"\nscale = 0.3\n\
     rotate = [1.5707963267948966, 0, 0]\n[cloth]\ndensity = 0.02\nstiffness = 500\n";
const STEPS: [&str; 3] = ["0.0416667", "0.0166667", "0.0041667"];

/// [`METHODS`], with substeps of symplectic Euler that are stable in the longest of these steps.
fn methods() -> impl Iterator<Item = (&'static str, &'static [&'static str])> {
    METHODS.into_iter().map(|(name, settings)| match name {
        "symplectic-euler" => (name, &["substeps=800", "stiffness_damping=1e-5"][..]),
        _ => (name, settings),
    })
}

/// What soft pins pull with (N).
fn reaction(scene: &Scene, state: &State) -> Vec3 {
    let pull = |pin: &cloth_core::energy::SoftPin| {
        let x = state.positions[pin.vertex() as usize];
        (pin.target_at(0.0) - x) * pin.stiffness()
    };
    scene.model.soft_pins().map(pull).sum()
}

/// Area (m²) that the wind along y sees.
fn shadow(scene: &Scene, state: &State) -> f64 {
    let x = &state.positions;
    let triangles = scene.mesh.as_ref().unwrap().triangles().iter();
    let seen = triangles.map(|t| {
        let [a, b, c] = t.map(|v| x[v as usize]);
        0.5 * (b - a).cross(&(c - a)).y.abs()
    });
    seen.sum()
}

/// Springs that hold a sheet against the wind pull with ½ ρ C_D w² of the area that it shows to the wind, whatever the
/// step: with an impulse bounded as if the cloth were free it would be a seventh of that in steps of 1/60 s.
#[test]
fn held_cloth_feels_all_of_the_pressure_at_any_step() {
    for dt in STEPS {
        let text = format!(
            "dt = {dt}\n{LIGHT}[[pins]]\nbox = [[-1, -1, -1], [1, 1, 1]]\nstiffness = 40\n[air]\nwind = [0, 12, 0]\n"
        );
        let scene = scene(&format!("pressure{dt}"), &text);
        for (name, settings) in methods() {
            let state = rest(&scene, name, settings);
            let force = 0.5 * 1.2 * 1.2 * 144.0 * shadow(&scene, &state);
            let error = (reaction(&scene, &state) / force + Vec3::y()).norm();
            assert!(error < 1e-5, "{name}, {dt} s: {error:e} of {force} N");
        }
    }
}

/// Light cloth in a strong wind, flat and at an angle: its mean speed along the wind grows and stays below that of the
/// wind.
#[test]
fn free_cloth_is_never_faster_than_the_wind() {
    for (dt, wind) in [("0.05", [0.0, 20.0, 0.0]), ("0.0166667", [9.0, 12.0, 3.0])] {
        let [x, y, z] = wind;
        let text = format!("dt = {dt}\n{LIGHT}[air]\nlift = 0.8\nwind = [{x:?}, {y:?}, {z:?}]\n");
        let scene = scene(&format!("free{dt}"), &text);
        let speed = Vec3::from(wind).norm();
        let along = Vec3::from(wind) / speed;
        for (name, settings) in methods() {
            let mut before = 0.0;
            watch(&scene, name, settings, 12, |moment| {
                let v = &moment.state.velocities;
                let mean = v.iter().map(|v| v.dot(&along)).sum::<f64>() / v.len() as f64;
                assert!(mean <= speed * (1.0 + 1e-9), "{name}, {dt} s: {mean} m/s");
                assert!(mean >= before - 1e-6 * speed, "{name}, {dt} s: {mean} m/s");
                before = mean;
            });
            assert!(before > 0.4 * speed, "{name}, {dt} s: {before} m/s");
        }
    }
}

/// Two sheets of which one is four times as heavy fly as fast where they can touch each other, and do not, as where
/// they cannot.
#[test]
fn cloth_that_touches_nothing_flies_as_if_it_could_not() {
    let of = |contact: &str| {
        let text = format!(
            "{LIGHT}[[mesh]]\ngenerator = \"grid:7x7:alternating\"\nscale = 0.3\nrotate = [1.5707963, 0, 0]\n\
             translate = [0, -0.3, 0]\n[mesh.cloth]\ndensity = 0.08\n[air]\nwind = [0, 12, 0]\n{contact}"
        );
        scene(&format!("flies{}", contact.len()), &text)
    };
    let (alone, together) = (of(""), of("[contact]\nself = true\n"));
    for (name, settings) in methods() {
        // `auto` is one substep where nothing can be touched, and more where something can.
        let settings = match name {
            "xpbd-direct" => &["substeps=1"][..],
            _ => settings,
        };
        let [expected, velocities] =
            [&alone, &together].map(|scene| run(scene, name, settings, 10).1.velocities);
        let errors = expected
            .iter()
            .zip(&velocities)
            .map(|(a, b)| (a - b).norm());
        let error = errors.fold(0.0, f64::max) / 12.0;
        assert!(error < 1e-9, "{name}: {error:e} of the wind");
    }
}

/// A sheet that the wind has pulled taut comes to rest: what the air has given it is bounded, and no substep adds to
/// it.
#[test]
fn taut_cloth_in_a_steady_wind_takes_no_energy_out_of_it() {
    let text = format!(
        "{}[[pins]]\nselect = \"border\"\n[air]\nwind = [0, 20, 0]\n",
        LIGHT.replace("0.02\nstiffness = 500", "0.1\nstiffness = 2e4")
    );
    let scene = scene("taut", &text);
    let (expected, _) = run(&scene, "implicit-euler", &["tolerance=1e-9"], 120);
    for (name, settings) in [
        ("implicit-euler", &[][..]),
        ("bdf2", &[]),
        ("pd", &[]),
        ("symplectic-euler", &[]),
        ("xpbd", &["substeps=320", "iterations=4"]),
    ] {
        let [early, late] = [60, 120].map(|steps| run(&scene, name, settings, steps).0);
        let given = late.energy_given / early.energy_given;
        assert!((given - 1.0).abs() < 1e-2, "{name}: {given}");
        assert!(
            late.kinetic_energy < 1e-5,
            "{name}: {} J",
            late.kinetic_energy
        );
        let elastic = late.elastic_energy / expected.elastic_energy;
        assert!((elastic - 1.0).abs() < 1e-2, "{name}: {elastic}");
    }
}

/// The forces of the air are summed in one order.
#[test]
fn wind_gives_the_same_bits_with_any_number_of_threads() {
    let text =
        format!("{LIGHT}[[pins]]\nselect = \"highest\"\n[air]\nlift = 0.5\nwind = [1, 7, 2]\n");
    let path = written("threads", &text.replace("7x7", "41x41"));
    for (method, _) in METHODS.iter().filter(|(name, _)| name.len() < 5) {
        let [one, two] = ["1", "2"].map(|threads| {
            let path = path.to_str().unwrap();
            let run = [
                "run",
                path,
                "--method",
                method,
                "--steps",
                "2",
                "--json",
                "--threads",
                threads,
            ];
            let out: serde_json::Value = serde_json::from_slice(&program(&run).stdout).unwrap();
            [&out["kinetic_energy"], &out["elastic_energy"]]
                .map(|value| value.as_f64().unwrap().to_bits())
        });
        assert_eq!(one, two, "{method}");
    }
}

/// Cloth that is held whole at first has a number of substeps too, for the wind that meets it once it is let go.
#[test]
fn cloth_that_is_held_whole_is_let_go_in_the_wind() {
    let text = format!(
        "{LIGHT}[[pins]]\nbox = [[-1, -1, -1], [1, 1, 1]]\nuntil = 0.05\n[air]\nwind = [0, 12, 0]\n"
    );
    let scene = scene("let_go", &text);
    // F/(n l): ½ ρ C_D w² on 0.09 m², at 49 vertices, with 84 edges along the axes and 36 diagonals.
    let force = 0.5 * 1.2 * 1.2 * 144.0 * 0.09;
    let edge = 0.05 * (84.0 + 36.0 * f64::sqrt(2.0)) / 120.0;
    let error = scene.lasting_tension().unwrap() * 49.0 * edge / force - 1.0;
    assert!(error.abs() < 1e-9, "{error:e}");
    let state = run(&scene, "xpbd", &[], 10).1;
    let slowest = state
        .velocities
        .iter()
        .map(|v| v.y)
        .fold(f64::INFINITY, f64::min);
    assert!(slowest > 0.0, "{slowest} m/s");
}
