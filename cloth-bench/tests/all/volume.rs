//! Closed pieces that keep their volume, in scenes and with every method that can.

use crate::changes::scale_of_least;
use crate::scene_text::{scene, written};
use cloth_bench::method::{METHODS, Method};
use cloth_bench::run::{Plan, Solver, Summary, run_changing, to_rest};
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;
use cloth_core::particles::State;

/// As `run` would take it.
fn settings_of(name: &str) -> Settings {
    match name {
        "xpbd" => Settings::default().with("substeps", "auto"),
        _ => Settings::default(),
    }
}

fn ran(scene: &Scene, name: &str, dt: f64, steps: u32) -> (Summary, State) {
    let method = Method::find(name).unwrap();
    let settings = settings_of(name);
    let mut solver = Solver::new(method, &settings, scene, dt).unwrap();
    let mut state = scene.start.clone();
    let plan = Plan::new(dt, steps);
    let (summary, _) = run_changing(scene, &mut solver, &mut state, plan, |_| Ok(())).unwrap();
    (summary, state)
}

/// A balloon that is sealed grows until its membrane carries what is left of the pressure: E + ½ k (V − V*)² is least.
#[test]
fn a_sealed_balloon_comes_to_rest_where_its_energy_is_least() {
    let scene = scene(
        "sealed",
        "gravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"sphere:6\"\nscale = 0.4\npressure = 800\n\
         bulk_modulus = 4000\n[cloth]\nmodulus = 2000\nbending = \"none\"\n",
    );
    let rest = &scene.start.positions;
    let energies = scene.model.energies().unwrap();
    let filling = &scene.volumes[0];
    let potential = |s: f64| {
        let x: Vec<Vec3> = rest.iter().map(|x| x * s).collect();
        energies.value(&x) + filling.energy(&x)
    };
    let low = scale_of_least(potential);
    // Scaled alone; relaxed, the vertices of the mesh move a little apart from that.
    let expected = low.powi(3) * filling.rest_volume();
    assert!((1.01..1.05).contains(&low), "{low}");
    let dt = 1.0 / 240.0;
    // Those that minimise agree on where the vertices go.
    let mut relaxed = None;
    for (name, bound) in [
        ("implicit-euler", 2e-4),
        ("linear-implicit", 2e-4),
        ("bdf2", 2e-4),
        ("pd", 2e-4),
        ("symplectic-euler", 1e-3),
        ("xpbd", 0.01),
    ] {
        let (method, settings) = (Method::find(name).unwrap(), settings_of(name));
        let mut stepper = method.build(&scene, &settings, dt).unwrap();
        let mut state = scene.start.clone();
        to_rest(&scene, &mut *stepper, &mut state, dt, 600, 1e-6).unwrap();
        let volume = filling.volume(&state.positions);
        let error = volume / expected - 1.0;
        assert!(error.abs() < bound, "{name}: {error:e}");
        let first = *relaxed.get_or_insert(volume);
        let apart = (volume / first - 1.0).abs();
        assert!(bound > 2e-4 || apart < 1e-6, "{name}: {apart:e}");
    }
}

const WATER: &str = "[[mesh]]\ngenerator = \"sphere:7\"\nscale = 0.1\ntranslate = [0.04, 0, 0.22]\nbulk_modulus = 1e6\n\
     [cloth]\ndensity = 2\nstiffness = 2000\n[[obstacle]]\nshape = \"box\"\nsize = [0.2, 0.4, 0.1]\n\
     position = [-0.1, 0, 0.05]\n[[obstacle]]\nshape = \"plane\"\n[contact]\nfriction = 0.4\n";

/// A ball full of water on the edge of a step: no method loses more than a two-thousandth of it, and none makes energy.
#[test]
fn a_ball_full_of_water_lands_with_all_of_it() {
    let scene = scene("water", WATER);
    for name in [
        "implicit-euler",
        "linear-implicit",
        "bdf2",
        "pd",
        "symplectic-euler",
        "xpbd",
    ] {
        let (summary, _) = ran(&scene, name, 0.01, 60);
        let change = summary.max_volume_change.unwrap();
        assert!(change < 1e-3, "{name}: {change:e}");
        assert_eq!(summary.energy_excess, 0.0, "{name}");
        assert_eq!(summary.obstacle_intersections, Some(0), "{name}");
        assert!(summary.center_of_mass_drop > 0.1, "{name}: {summary:?}");
    }
}

/// As stiff as water is, every step of implicit Euler converges, in as many iterations.
#[test]
fn water_converges_as_air_does() {
    let iterations = |modulus: &str| {
        let text = WATER.replace("bulk_modulus = 1e6", &format!("bulk_modulus = {modulus}"));
        let (summary, _) = ran(&scene("stiff", &text), "implicit-euler", 0.01, 60);
        assert_eq!(summary.converged_steps, 60, "{modulus} Pa");
        assert_eq!(summary.newton_fallbacks, 0, "{modulus} Pa");
        assert_eq!(summary.energy_excess, 0.0, "{modulus} Pa");
        summary.iterations as f64
    };
    let [air, water] = ["1e5", "2e9"].map(iterations);
    assert!(water < 1.5 * air, "{water} iterations, {air} of air");
}

/// Nothing acts on it from outside: neither momentum nor the time of the free fall notice the filling.
#[test]
fn a_filling_exerts_no_force_outwards() {
    let text = "gravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"sphere:5\"\nscale = 0.1\npressure = 2000\n\
         bulk_modulus = 1e5\n[cloth]\ndensity = 2\nstiffness = 2000\n";
    let scene = scene("alone", text);
    let mass = scene.model.particles.mass();
    for method in METHODS.iter().filter(|m| m.name != "explicit-euler") {
        if ["implicit-midpoint", "pbd", "xpbd-direct"].contains(&method.name) {
            continue;
        }
        let (summary, state) = ran(&scene, method.name, 1e-3, 5);
        let momentum: Vec3 = mass
            .iter()
            .zip(&state.velocities)
            .map(|(m, v)| v * *m)
            .sum();
        let size: f64 = mass
            .iter()
            .zip(&state.velocities)
            .map(|(m, v)| m * v.norm())
            .sum();
        assert!(size > 1e-6, "{}: nothing moves", method.name);
        assert!(
            momentum.norm() < 1e-9 * size,
            "{}: {momentum:e}",
            method.name
        );
        assert!(summary.max_volume_change.unwrap() > 1e-3, "{}", method.name);
    }
}

#[test]
fn what_has_no_place_for_a_volume_says_so() {
    let scene = scene("water", WATER);
    let build = |name: &str, pairs: &[&str]| {
        let settings = Settings::parse(pairs).unwrap();
        let built = Method::find(name).unwrap().build(&scene, &settings, 0.01);
        built.err().map(|error| error.to_string())
    };
    for name in ["implicit-midpoint", "pbd", "xpbd-direct"] {
        let told = build(name, &[]).unwrap();
        assert!(
            told.contains("bulk_modulus") && told.contains(name),
            "{told}"
        );
    }
    let told = build("implicit-euler", &["linear=cholesky"]).unwrap();
    assert!(told.contains("bulk_modulus"), "{told}");
    assert_eq!(build("implicit-euler", &[]), None);

    let refused = |text: &str| {
        let built = file::build(&written("refused", text), &Settings::default());
        built.unwrap_err().to_string()
    };
    let sheet = "[[mesh]]\ngenerator = \"grid:3x3:alternating\"\nbulk_modulus = 1e5\n";
    let told = refused(sheet);
    assert!(
        told.contains("line 3") && told.contains("boundary"),
        "{told}"
    );
    let told = refused("[[mesh]]\ngenerator = \"sphere:2\"\nbulk_modulus = 0\n");
    assert!(
        told.contains("line 3") && told.contains("above 0"),
        "{told}"
    );
    let text = "[[mesh]]\ngenerator = \"sphere:2\"\nbulk_modulus = 10\npressure = -10\n";
    let told = refused(text);
    assert!(
        told.contains("line 4") && told.contains("pressure"),
        "{told}"
    );
}
