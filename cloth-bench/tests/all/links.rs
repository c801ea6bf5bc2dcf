//! Links between vertices, and joints, in scenes.

use crate::scene_text::{scene, written};
use cloth_bench::method::{METHODS, Method};
use cloth_bench::run::{run, to_rest};
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;
use cloth_core::particles::State;

/// A ball that hangs from a joint below one that is held, 42 vertices each; %K is the stiffness of the links.
const HANGING: &str = "[[mesh]]\ngenerator = \"sphere:2\"\nscale = 0.1\n\
    [[mesh]]\ngenerator = \"sphere:2\"\nscale = [0.1, 0.12, 0.2]\ntranslate = [0, 0, -0.2]\npressure = 1000\n\
    bulk_modulus = 1e5\n[[link]]\nmeshes = [0, 1]\nat = [0, 0, -0.1]\nstiffness = %K\n\
    [[pins]]\nbox = [[-0.1, -0.1, -0.06], [0.1, 0.1, 0.06]]\n[cloth]\ndensity = 2\nstiffness = 2000\n";

/// Where a method leaves a scene that has come to rest.
fn at_rest(scene: &Scene, name: &str) -> State {
    let method = Method::find(name).unwrap();
    let settings = match name {
        "implicit-euler" => Settings::default().with("tolerance", 1e-9),
        _ => Settings::default(),
    };
    let mut solver = method.build(scene, &settings, 0.01).unwrap();
    let mut state = scene.start.clone();
    to_rest(scene, &mut *solver, &mut state, 0.01, 4000, 1e-9).unwrap();
    state
}

/// At rest the links of a joint carry the weight of what hangs from it.
#[test]
fn a_joint_carries_what_hangs_from_it() {
    let scene = scene("hanging", &HANGING.replace("%K", "1e4"));
    let mass: f64 = scene.model.particles.mass()[42..].iter().sum();
    let is_link = |ends: &[u32; 2]| (ends[0] < 42) != (ends[1] < 42);
    let springs: Vec<_> = scene
        .model
        .all_springs()
        .filter(|s| is_link(&s.vertices))
        .collect();
    assert_eq!(springs.len(), 3);
    for (name, bound) in [("implicit-euler", 1e-6), ("pd", 1e-3)] {
        let state = at_rest(&scene, name);
        let force = |spring: &&cloth_core::energy::Spring| {
            let [a, b] = spring.vertices.map(|v| state.positions[v as usize]);
            let length = (a - b).norm();
            (a - b) * (spring.stiffness * (length - spring.rest_length) / length)
        };
        let sum: Vec3 = springs.iter().map(force).sum();
        let error = (sum - Vec3::new(0.0, 0.0, mass * 9.81)).norm() / (mass * 9.81);
        assert!(error < bound, "{name}: {sum} N, error {error:e}");
    }
}

/// Rigid links keep their length through a swing of a quarter of a turn, and are for xpbd alone.
#[test]
fn rigid_links_keep_their_length() {
    let text = HANGING.replace("%K", "inf") + "[start]\nvelocity = [1.5, 0, 0]\n";
    let scene = scene("rigid", &text);
    let settings = Settings::default().with("substeps", "auto");
    let method = Method::find("xpbd").unwrap();
    let mut solver = method.build(&scene, &settings, 0.01).unwrap();
    let mut state = scene.start.clone();
    let links = scene
        .model
        .all_springs()
        .filter(|s| s.stiffness.is_infinite());
    let links: Vec<_> = links.collect();
    assert_eq!(links.len(), 3);
    let (mut worst, mut highest) = (0.0_f64, f64::NEG_INFINITY);
    let summary = run(
        &scene,
        &mut *solver,
        &mut state,
        0.01,
        100,
        |_, state, _| {
            for spring in &links {
                let [a, b] = spring.vertices.map(|v| state.positions[v as usize]);
                worst = worst.max(((a - b).norm() / spring.rest_length - 1.0).abs());
            }
            let middle = state.positions[42..].iter().map(|x| x.z).sum::<f64>() / 42.0;
            highest = highest.max(middle);
            Ok(())
        },
    );
    assert!(highest > -0.15, "it has hardly swung: {highest} m");
    // What one sweep a substep leaves.
    assert!(worst < 1e-2, "{worst:e}");
    assert_eq!(summary.unwrap().energy_excess, 0.0);
    for name in ["pd", "implicit-euler", "pbd"] {
        let built = Method::find(name)
            .unwrap()
            .build(&scene, &Settings::default(), 0.01);
        let told = built.err().unwrap().to_string();
        assert!(told.contains("xpbd takes it"), "{told}");
    }
}

#[test]
fn what_cannot_be_linked_is_refused_with_its_line() {
    let two = "[[mesh]]\ngenerator = \"sphere:2\"\n[[mesh]]\ngenerator = \"sphere:2\"\ntranslate = [2, 0, 0]\n[[link]]\n";
    let told = |more: &str| {
        let built = file::build(
            &written("refused", &format!("{two}{more}")),
            &Settings::default(),
        );
        built.unwrap_err().to_string()
    };
    let cases = [
        ("meshes = [0, 2]\nat = [1, 0, 0]\n", "line 7", "no mesh"),
        ("meshes = [0, 1]\n", "line 6", "needs first and second"),
        (
            "meshes = [0, 1]\nfirst = [0]\nsecond = [0, 1]\n",
            "line 9",
            "every link",
        ),
        (
            "meshes = [0, 1]\nfirst = [42]\nsecond = [0]\n",
            "line 8",
            "no vertex 42",
        ),
        (
            "meshes = [0, 0]\nfirst = [1]\nsecond = [1]\n",
            "line 6",
            "same place",
        ),
        (
            "meshes = [0, 1]\nat = [1, 0, 0]\nstiffness = 0\n",
            "line 9",
            "above 0",
        ),
        ("meshes = [0, 0]\nat = [1, 0, 0]\n", "line 8", "two pieces"),
    ];
    for (more, line, what) in cases {
        let told = told(more);
        assert!(told.contains(line) && told.contains(what), "{more}: {told}");
    }
}

/// A small sheet that hangs by its middle from one that is held, on a rope of 0.3 m.
const ROPE: &str = "[[mesh]]\ngenerator = \"grid:3x3:alternating\"\nscale = 0.1\n[[mesh]]\n\
    generator = \"grid:3x3:alternating\"\nscale = 0.1\ntranslate = [0, 0, -0.3]\n[[link]]\nmeshes = [0, 1]\n\
    first = [4]\nsecond = [4]\nstiffness = 500\nslack = true\n[[pins]]\nbox = [[0, 0, -0.1], [1, 1, 0.1]]\n";

/// A rope does not push: what flies towards its end flies freely, by every method but PBD, which has no stiffness.
#[test]
fn a_rope_lets_fly_what_comes_nearer() {
    let scene = scene("rope", &format!("{ROPE}[start]\nvelocity = [0, 0, 1]\n"));
    let dt = 1.0 / 240.0;
    for method in METHODS
        .iter()
        .filter(|method| method.name != "explicit-euler")
    {
        let settings = Settings::default();
        let mut solver = method.build(&scene, &settings, dt).unwrap();
        let mut state = scene.start.clone();
        let parts = method.substeps(&scene, &settings, dt).unwrap();
        run(&scene, &mut *solver, &mut state, dt, 30, |_, _, _| Ok(())).unwrap();
        let h = dt / f64::from(parts);
        let rise = 30.0 * dt - 0.5 * 9.81 * h * h * method.free_fall(30 * parts);
        for (x, start) in state.positions.iter().zip(&scene.start.positions).skip(9) {
            let error = (x - start - Vec3::z() * rise).norm();
            assert!(error < 1e-8, "{}: {error:e}", method.name);
        }
    }
}

/// At rest it carries the weight, stretched by m g/k.
#[test]
fn a_rope_carries_what_hangs_from_it() {
    let scene = scene("hung", ROPE);
    let mass: f64 = scene.model.particles.mass()[9..].iter().sum();
    for (name, bound) in [("implicit-euler", 1e-6), ("pd", 1e-3)] {
        let state = at_rest(&scene, name);
        let stretch = (state.positions[4] - state.positions[13]).norm() - 0.3;
        let expected = mass * 9.81 / 500.0;
        let error = (stretch / expected - 1.0).abs();
        assert!(error < bound, "{name}: {stretch:e} m for {expected:e}");
    }
}

#[test]
fn a_rope_needs_a_stiffness() {
    let text = ROPE.replace("stiffness = 500\n", "");
    let error = file::build(&written("stiff-rope", &text), &Settings::default()).unwrap_err();
    let error = error.to_string();
    assert!(
        error.contains("a link with slack needs a stiffness (N/m)"),
        "{error}"
    );
}
