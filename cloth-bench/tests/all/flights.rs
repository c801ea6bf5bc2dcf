//! Cloth that flies, in contact with itself or before a body: as fast as cloth at rest, and the same motion.

use crate::rigid_bodies::watch;
use crate::scene_text::scene;
use cloth_core::math::Vec3;

/// A sheet that swings from two corners, which fly along with `velocity` (m/s) as it does.
fn towed(velocity: Vec3) -> String {
    let [x, y, z] = velocity.into();
    format!(
        "[[mesh]]\ngenerator = \"grid:17x17:alternating\"\n[cloth]\nrigidity = 1e-6\n\
        [[pins]]\nselect = \"corners\"\nmove = [{x:?}, {y:?}, {z:?}]\n\
        [start]\nvelocity = [{x:?}, {y:?}, {z:?}]\n[contact]\nself = true\n"
    )
}

/// Pins that fly do not pull the cloth behind them before it has begun to move: no step has more to do than at rest.
/// When they did, `pd` took five times the iterations and twenty times the time.
#[test]
fn a_sheet_that_is_towed_swings_as_one_at_rest() {
    for (method, most) in [("implicit-euler", 1e-4), ("pd", 1e-2)] {
        let swing = |velocity: Vec3| {
            let scene = scene(&format!("towed_{method}"), &towed(velocity));
            let mut last = Vec::new();
            let summary = watch(&scene, method, &[], 20, |moment| {
                let flown = velocity * moment.state.time;
                last = moment.state.positions.iter().map(|x| x - flown).collect();
            });
            (last, summary.iterations)
        };
        let (rest, at_rest) = swing(Vec3::zeros());
        let (flight, in_flight) = swing(Vec3::new(12.0, -9.0, 5.0));
        let far = rest.iter().zip(&flight).map(|(a, b)| (a - b).norm());
        let far = far.fold(0.0, f64::max);
        assert!(
            far < most && in_flight < 2 * at_rest,
            "{method}: {far:e} m, {at_rest} and {in_flight} iterations"
        );
    }
}

/// A linearised step is one linear solve where nothing is touched, however far the cloth moves in it. A path of ten
/// thicknesses is as far as contact tests at once: beyond, such steps took 60 iterations each and ended elsewhere.
#[test]
fn a_linearised_swing_above_a_body_far_away_is_the_same_to_the_bit() {
    let swing = |body: &str| {
        let text = format!(
            "dt = 0.03\n[[mesh]]\ngenerator = \"grid:17x17:alternating\"\n[[pins]]\nselect = \"corners\"\n{body}"
        );
        let scene = scene("linearised_swing", &text);
        let mut last = Vec::new();
        let summary = watch(&scene, "linear-implicit", &[], 20, |moment| {
            last.clone_from(&moment.state.positions);
        });
        (last, summary.iterations)
    };
    let body = "[[obstacle]]\nshape = \"sphere\"\nradius = 0.1\nposition = [20, 0, 0]\n[contact]\nthickness = 5e-4\n";
    let (alone, above) = (swing(""), swing(body));
    assert_eq!(alone.1, 20);
    assert!(alone == above, "{} iterations", above.1);
}

/// Two pieces that are nowhere near each other: of a path of ten thicknesses, as much as contact tests at once, each is
/// followed by itself. When the mean motion of both counted, the one that falls left its free fall after three steps,
/// and `pd` took 881 iterations.
#[test]
fn a_piece_that_falls_far_away_takes_no_iterations() {
    let hanging = "[[mesh]]\ngenerator = \"tube:16x9\"\nscale = 0.1\nrotate = [1.57, 0.5, 0]\ntranslate = [30, 0, 0.3]\n\
        [mesh.cloth]\nstiffness = 300\n";
    let falling =
        "[[mesh]]\ngenerator = \"grid:17x17:alternating\"\nscale = 0.1\nrotate = [0.3, 0.5, 1]\n";
    let pins: Vec<_> = (0..16).map(|vertex| vertex.to_string()).collect();
    let count = |pieces: &str| {
        let text = format!(
            "dt = 0.03\n{pieces}[cloth]\nstiffness = 3000\n[[pins]]\nmesh = 0\nvertices = [{}]\n\
             [[obstacle]]\nshape = \"sphere\"\nradius = 0.05\nposition = [30.21, 0.24, -0.68]\n",
            pins.join(", ")
        );
        let scene = scene("falls_far_away", &text);
        watch(&scene, "pd", &[], 12, |_| {}).iterations
    };
    let (alone, beside) = (count(hanging), count(&format!("{hanging}{falling}")));
    assert!(beside * 10 <= alone * 11, "{alone}, {beside}");
}

/// A step ends when every piece is near enough to where it will be. In a norm over both a patch of 45 mg beside a blanket
/// of 4 kg was 17 mm off after 12 steps with `implicit-euler`, 25 mm with `pd`.
#[test]
fn a_patch_falls_beside_a_blanket_as_it_does_alone() {
    let patch = "[[mesh]]\ngenerator = \"grid:9x9:alternating\"\nscale = 0.03\nrotate = [0, 0.5, 1]\n\
        [mesh.cloth]\ndensity = 0.05\nstiffness = 300\nrigidity = 1e-6\n[[pins]]\nmesh = 0\nvertices = [0, 8]\n";
    let blanket = "[[mesh]]\ngenerator = \"grid:33x33:alternating\"\nscale = 2\ntranslate = [30, 0, 0]\n\
        [mesh.cloth]\ndensity = 1\n[[pins]]\nmesh = 1\nvertices = [0, 32]\n";
    for (method, most) in [("implicit-euler", 1e-4), ("pd", 5e-3)] {
        let fall = |text: &str| {
            let scene = scene(&format!("patch_{method}"), text);
            let mut last = Vec::new();
            watch(&scene, method, &[], 12, |moment| {
                last = moment.state.positions[..81].to_vec();
            });
            last
        };
        let (alone, beside) = (fall(patch), fall(&format!("{patch}{blanket}")));
        let apart = alone.iter().zip(&beside).map(|(a, b)| (a - b).norm());
        let apart = apart.fold(0.0, f64::max);
        println!("{method}: {apart:e} m");
        assert!(apart < most, "{method}: {apart:e} m");
    }
}
