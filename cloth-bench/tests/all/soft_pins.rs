//! Soft pins and added masses.

use crate::exact_runs::{METHODS, refused, rest, run};
use crate::scene_text::scene;
use cloth_bench::method::Method;
use cloth_bench::run::to_rest;
use cloth_bench::scene::Scene;
use cloth_bench::settings::Settings;
use cloth_core::energy::SoftPin;
use cloth_core::math::Vec3;
use cloth_core::particles::State;

/// An upright sheet of 0.3 m, 7 × 7 vertices; the last row is the highest.
const SHEET: &str = "dt = 0.01\n[[mesh]]\ngenerator = \"grid:7x7:alternating\"\nscale = 0.3\n\
     rotate = [1.5707963267948966, 0, 0]\n[cloth]\nstiffness = 500\n";

/// What the pins pull with (N), at a time (s).
fn reaction(scene: &Scene, state: &State, time: f64) -> Vec3 {
    let pull = |pin: &SoftPin| {
        let x = state.positions[pin.vertex() as usize];
        (pin.target_at(time) - x) * pin.stiffness()
    };
    scene.model.soft_pins().map(pull).sum()
}

/// Whatever the cloth does, one pin sags by m g/k, and several pull with m g; a weighted hem counts.
#[test]
fn pins_sag_by_the_weight_over_their_stiffness() {
    const K: f64 = 40.0;
    let hem = "[[mass]]\nbox = [[-1, -1, -0.001], [1, 1, 0.001]]\nmass = 0.03\n";
    for (kind, pins, added) in [
        ("one", "vertices = [45]", ""),
        ("row", "select = \"highest\"", ""),
        ("hem", "select = \"highest\"", hem),
    ] {
        let text = format!("{SHEET}[[pins]]\n{pins}\nstiffness = {K}\n{added}");
        let scene = scene(&format!("sag-{kind}"), &text);
        let mass: f64 = scene.model.particles.mass().iter().sum();
        let area = scene.mesh.as_ref().unwrap().area();
        let expected = 0.2 * area + if added.is_empty() { 0.0 } else { 0.03 };
        assert!((mass / expected - 1.0).abs() < 1e-12, "{mass} kg");
        assert_eq!(scene.model.particles.free_count(), 49);
        let weight = 9.81 * mass;
        for (name, settings) in METHODS {
            let state = rest(&scene, name, settings);
            let error = (reaction(&scene, &state, 0.0) / weight - Vec3::z()).norm();
            assert!(error < 1e-5, "{kind} {name}: {error:e}");
            if kind == "one" {
                let sag = scene.start.positions[45].z - state.positions[45].z;
                let error = (sag / (weight / K) - 1.0).abs();
                assert!(error < 1e-6, "{name}: {sag} m, {error:e}");
            }
        }
    }
}

/// Added masses go evenly to the chosen vertices, each once.
#[test]
fn a_mass_is_spread_evenly_and_held_vertices_carry_it() {
    let plain = scene("plain", &format!("{SHEET}[[pins]]\nselect = \"highest\"\n"));
    let text = format!(
        "{SHEET}[[pins]]\nselect = \"highest\"\n[[mass]]\nvertices = [0, 1, 1, 6]\nmass = 0.06\n\
         [[mass]]\nvertices = [6]\nmass = 0.01\n"
    );
    let heavy = scene("heavy", &text);
    let masses = [&plain, &heavy].map(|scene| scene.model.particles.mass());
    for (v, (plain, heavy)) in masses[0].iter().zip(masses[1]).enumerate() {
        let added = match v {
            0 | 1 => 0.02,
            6 => 0.03,
            _ => 0.0,
        };
        assert!((heavy - plain - added).abs() < 1e-15, "{v}: {heavy}");
    }
    // At rest the springs pull the held row down by the weight of all the others.
    let state = rest(&heavy, "implicit-euler", &["tolerance=1e-12"]);
    let mut gradient = vec![Vec3::zeros(); 49];
    let energies = heavy.model.energies().unwrap();
    energies.add_gradient(&state.positions, &mut gradient);
    let pull: Vec3 = gradient[42..].iter().sum();
    let weight = 9.81 * masses[1][..42].iter().sum::<f64>();
    assert!((pull / weight - Vec3::z()).norm() < 1e-6, "{pull}");
}

/// Points that move take the cloth along, turned and shifted, and give no energy from nowhere.
#[test]
fn soft_pins_take_the_cloth_along() {
    let text = format!(
        "gravity = [0, 0, 0]\n{SHEET}[[pins]]\nbox = [[-1, -1, -1], [1, 1, 1]]\nstiffness = 30\n\
         move = [0.1, 0, 0.05]\nturn = [0, 1, 0]\ncentre = [0.15, 0, 0]\nduration = 0.5\n"
    );
    let scene = scene("along", &text);
    let goal: Vec<Vec3> = scene.model.soft_pins().map(|p| p.target_at(9.0)).collect();
    let turned = nalgebra::Rotation3::new(Vec3::y());
    let centre = Vec3::new(0.15, 0.0, 0.0);
    for (x, goal) in scene.start.positions.iter().zip(&goal) {
        let expected = centre + turned * (x - centre) + Vec3::new(0.1, 0.0, 0.05);
        assert!((goal - expected).norm() < 1e-14);
    }
    for (name, settings) in METHODS {
        let (summary, mut state) = run(&scene, name, settings, 50);
        let excess = summary.energy_excess / summary.energy_given;
        assert!(
            excess < 0.01 && summary.energy_gain.is_none(),
            "{name}: {excess:e}"
        );
        let method = Method::find(name).unwrap();
        let own = Settings::parse(settings).unwrap();
        let mut solver = method.build(&scene, &own, scene.dt).unwrap();
        to_rest(&scene, &mut *solver, &mut state, scene.dt, 20_000, 1e-9).unwrap();
        let off = state
            .positions
            .iter()
            .zip(&goal)
            .map(|(x, goal)| (x - goal).norm());
        let worst = off.fold(0.0, f64::max);
        assert!(worst < 1e-6, "{name}: {worst:e} m");
    }
}

/// Grabbed on the way, from where they are, and let go: nothing pulls any more.
#[test]
fn soft_pins_come_and_go() {
    let text = format!(
        "gravity = [0, 0, 0]\n{SHEET}[start]\nvelocity = [0, 1, 0]\n\
         [[pins]]\nvertices = [0, 6]\nstiffness = 20\nfrom = 0.1\nuntil = 0.2\n"
    );
    let scene = scene("come-and-go", &text);
    let mass: f64 = scene.model.particles.mass().iter().sum();
    for (name, settings) in METHODS {
        let velocity = |steps| {
            let (summary, state) = run(&scene, name, settings, steps);
            let velocities = state.velocities.iter().zip(scene.model.particles.mass());
            let mean = velocities.map(|(v, m)| v * *m).sum::<Vec3>() / mass;
            (mean, summary.rebuilds)
        };
        let [(before, _), (held, _), (after, rebuilds)] = [10, 20, 40].map(velocity);
        let moved = |v: Vec3| (v - Vec3::y()).norm();
        assert!(moved(before) < 1e-10, "{name}: {before}");
        assert!(moved(held) > 0.1, "{name}: {held}");
        assert!((after - held).norm() < 1e-9, "{name}: {held} {after}");
        assert_eq!(rebuilds, 2, "{name}");
    }
}

#[test]
fn what_is_wrong_with_a_pin_or_a_mass_is_said_with_its_line() {
    for (name, more, line, words) in [
        (
            "zero",
            "[[pins]]\nvertices = [0]\nstiffness = 0\n",
            10,
            "above 0, or inf",
        ),
        (
            "twice",
            "[[pins]]\nvertices = [0]\n[[pins]]\nvertices = [0, 1]\nstiffness = 9\n",
            10,
            "vertex 0 is held at the same time by ",
        ),
        ("no-mass", "[[mass]]\nvertices = [0]\n", 8, "needs a mass"),
        (
            "minus",
            "[[mass]]\nvertices = [0]\nmass = -1\n",
            10,
            "mass is `-1`",
        ),
        (
            "nowhere",
            "[[mass]]\nmass = 1\n",
            8,
            "needs one of the keys",
        ),
    ] {
        refused(name, &format!("{SHEET}{more}"), line, words);
    }
}
