//! Links between vertices, braces and joints, in scenes.

use crate::scene_text::{scene, written};
use cloth_bench::method::Method;
use cloth_bench::run::run;
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;
use std::f64::consts::TAU;

/// A rigid body that hangs from a joint below one that is held: 42 vertices each.
const PENDULUM: &str = "[[mesh]]\ngenerator = \"sphere:2\"\nscale = 0.1\nbrace = inf\n\
    [[mesh]]\ngenerator = \"sphere:2\"\nscale = [0.1, 0.12, 0.2]\ntranslate = [0, 0, -0.2]\nbrace = inf\n\
    [[link]]\nmeshes = [0, 1]\nat = [0, 0, -0.1]\n\
    [[pins]]\nbox = [[-0.1, -0.1, -0.06], [0.1, 0.1, 0.06]]\n[cloth]\nstiffness = inf\nbending = \"none\"\n";

/// Lengths of all links and springs relative to those at rest, the worst.
fn worst_length(scene: &Scene, x: &[Vec3]) -> f64 {
    let strain = |spring: &cloth_core::energy::Spring| {
        let [a, b] = spring.vertices.map(|v| x[v as usize]);
        ((a - b).norm() / spring.rest_length - 1.0).abs()
    };
    scene.model.all_springs().map(strain).fold(0.0, f64::max)
}

/// A small swing takes as long as that of a rigid body about the joint, T = 2π √(I/(m g l)).
#[test]
fn a_braced_piece_swings_as_a_rigid_body() {
    let scene = scene("pendulum", PENDULUM);
    let (mass, rest) = (scene.model.particles.mass(), &scene.start.positions);
    let hinge = {
        let own = (42..84).map(|v| rest[v]);
        own.max_by(|a, b| a.z.total_cmp(&b.z)).unwrap()
    };
    let about_y = |v: usize| {
        let arm = rest[v] - hinge;
        mass[v] * (arm.x * arm.x + arm.z * arm.z)
    };
    let inertia: f64 = (42..84).map(about_y).sum();
    let moment: f64 = (42..84).map(|v| mass[v] * (hinge.z - rest[v].z)).sum();
    let period = TAU * (inertia / (moment * 9.81)).sqrt();
    let mut state = scene.start.clone();
    // 0.05 rad: of a second the swing is 0.02 % longer.
    let turn = 0.05 * TAU / period;
    for v in 42..84 {
        let arm = rest[v] - hinge;
        state.velocities[v] = Vec3::new(arm.z, 0.0, -arm.x) * turn;
    }
    let dt = 1.0 / 480.0;
    let method = Method::find("xpbd").unwrap();
    let mut solver = method.build(&scene, &Settings::default(), dt).unwrap();
    let (mut crossings, mut before, mut worst) = (Vec::new(), 0.0_f64, 0.0_f64);
    run(
        &scene,
        &mut *solver,
        &mut state,
        dt,
        1200,
        |step, state, _| {
            let side: f64 = (42..84).map(|v| mass[v] * state.positions[v].x).sum();
            if step > 1 && side * before < 0.0 {
                let part = side / (side - before);
                crossings.push((f64::from(step) - part) * dt);
            }
            before = side;
            worst = worst.max(worst_length(&scene, &state.positions));
            Ok(())
        },
    )
    .unwrap();
    let halves = crossings.len() - 1;
    assert!(halves >= 4, "{crossings:?}");
    let measured = 2.0 * (crossings[halves] - crossings[0]) / halves as f64;
    let error = measured / period - 1.0;
    assert!(
        error.abs() < 2e-3,
        "{measured} s, {period} s expected: {error:e}"
    );
    assert!(worst < 1e-4, "{worst:e}");
}

/// With finite stiffnesses every method takes it, and it hangs as far down as its links are long.
#[test]
fn soft_links_are_springs_for_every_method() {
    let text = PENDULUM
        .replace("brace = inf", "brace = 1e4")
        .replace("stiffness = inf", "stiffness = 1e4")
        .replace("at = [0, 0, -0.1]", "at = [0, 0, -0.1]\nstiffness = 1e4");
    let scene = scene("soft", &text);
    assert!(!scene.is_hard());
    for name in [
        "implicit-euler",
        "pd",
        "xpbd",
        "pbd",
        "symplectic-euler",
        "linear-implicit",
    ] {
        let method = Method::find(name).unwrap();
        let mut solver = method.build(&scene, &Settings::default(), 0.01).unwrap();
        let mut state = scene.start.clone();
        run(&scene, &mut *solver, &mut state, 0.01, 50, |_, _, _| Ok(())).unwrap();
        let worst = worst_length(&scene, &state.positions);
        assert!(worst < 2e-3, "{name}: {worst:e}");
    }
}

#[test]
fn what_cannot_be_linked_is_refused_with_its_line() {
    let refused = |text: &str| {
        let built = file::build(&written("refused", text), &Settings::default());
        built.unwrap_err().to_string()
    };
    let two = "[[mesh]]\ngenerator = \"sphere:2\"\n[[mesh]]\ngenerator = \"sphere:2\"\ntranslate = [2, 0, 0]\n[[link]]\n";
    let told = |more: &str| refused(&format!("{two}{more}"));
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
    let told = refused("[[mesh]]\ngenerator = \"grid:3x3:alternating\"\nbrace = 1e4\n");
    assert!(told.contains("line 3") && told.contains("flat"), "{told}");
    let hard = scene("hard", PENDULUM);
    let built = Method::find("pd")
        .unwrap()
        .build(&hard, &Settings::default(), 0.01);
    assert!(built.err().unwrap().to_string().contains("xpbd takes it"));
}
