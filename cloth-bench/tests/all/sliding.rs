//! Cloth that slides over a body.

use crate::scene_text::{scene, written};
use cloth_bench::method::Method;
use cloth_bench::run::from_start;
use cloth_bench::settings::Settings;
use cloth_core::math::Real;
use std::f64::consts::PI;
use std::fmt::Write;

/// Cells below the pole on either side, and half around it.
const HANGING: [usize; 2] = [24, 40];
const AROUND: usize = 13;
/// Length (m) of a cell, and the radius (m) that the strip goes around.
const CELL: Real = 0.0125;
const RADIUS: Real = 0.0521;

/// A strip of two cells across (OBJ), hung over a pole along y: its shorter end first.
fn strip() -> String {
    let mut profile: Vec<[Real; 2]> = Vec::new();
    profile.extend(
        (1..=HANGING[0])
            .rev()
            .map(|i| [-RADIUS, -(i as Real) * CELL]),
    );
    profile.extend((0..=AROUND).map(|i| {
        let angle = PI * (1.0 - i as Real / AROUND as Real);
        [RADIUS * angle.cos(), RADIUS * angle.sin()]
    }));
    profile.extend((1..=HANGING[1]).map(|i| [RADIUS, -(i as Real) * CELL]));
    let mut text = String::new();
    for [x, z] in &profile {
        for y in [-0.03, 0.0, 0.03] {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
    }
    for i in 0..profile.len() - 1 {
        for j in 1..3 {
            let a = 3 * i + j;
            writeln!(text, "f {} {} {} {}", a, a + 1, a + 4, a + 3).unwrap();
        }
    }
    text
}

/// Without friction it slides off as a chain does: L s'' = g (2 s + 0.2 m), so s = 0.1 m (cosh √(2 g/L) t − 1). What is
/// linearised once a step does not turn as fast around the pole, and is late; the more, the longer the step.
#[test]
fn strip_slides_off_a_pole_as_a_chain_does() {
    let mesh = written("strip-over-a-pole", "").with_extension("obj");
    std::fs::write(&mesh, strip()).unwrap();
    let text = format!(
        "[[mesh]]\nfile = {:?}\n[[obstacle]]\nshape = \"capsule\"\nradius = 0.05\nlength = 1\n\
         rotate = [1.5707963267948966, 0, 0]\n[contact]\nfriction = 0\n",
        mesh.to_str().unwrap()
    );
    let scene = scene("off-a-pole", &text);
    // Files are sorted anew.
    let start = &scene.start.positions;
    let low = (0..start.len()).min_by(|&a, &b| start[a].z.total_cmp(&start[b].z));
    let low = low.unwrap();
    let length = (HANGING[0] + HANGING[1]) as Real * CELL + PI * RADIUS;
    let time = 0.4;
    let expected = 0.1 * ((time * (2.0 * 9.81 / length).sqrt()).cosh() - 1.0);
    for (method, steps, ratio, within) in [
        ("implicit-euler", 24, 1.0, 0.06),
        ("pd", 24, 1.0, 0.06),
        ("bdf2", 24, 1.0, 0.01),
        ("xpbd", 24, 1.0, 0.03),
        ("symplectic-euler", 24, 1.0, 0.01),
        ("linear-implicit", 24, 0.20, 0.02),
        ("linear-implicit", 96, 0.64, 0.03),
        ("linear-implicit", 384, 0.98, 0.02),
    ] {
        let own = Method::find(method).unwrap();
        let mut slid = 0.0;
        let after = |_, state: &cloth_core::particles::State, _: &_| {
            slid = start[low].z - state.positions[low].z;
            Ok(())
        };
        let dt = time / Real::from(steps);
        from_start(&scene, own, &Settings::default(), dt, steps, after).unwrap();
        println!("{method}, {steps} steps: {slid} of {expected} m");
        assert!(
            (slid / expected - ratio).abs() < within,
            "{method}, {steps} steps: {slid} of {expected} m"
        );
    }
}
