//! Restitution, of methods whose contact is an impulse.

use crate::scene_text::scene;
use cloth_bench::method::Method;
use cloth_bench::run::{Plan, Solver, run, run_changing};
use cloth_bench::settings::Settings;
use cloth_bench::studies::variants::Variant;
use cloth_core::math::Vec3;

const METHODS: [&str; 4] = ["xpbd", "pbd", "symplectic-euler", "xpbd-direct"];

/// A flat sheet falls flat onto a floor: it jumps to e² of the height.
#[test]
fn a_sheet_jumps_to_the_square_of_the_restitution() {
    for (name, e) in METHODS
        .into_iter()
        .flat_map(|m| [(m, 0.0), (m, 0.5), (m, 0.9)])
    {
        let height = 0.1;
        let text = format!(
            "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\nscale = 0.2\ntranslate = [0, 0, {}]\n[cloth]\nstiffness = 1000\n\
             [[obstacle]]\nshape = \"plane\"\n[contact]\nthickness = 2e-3\nrestitution = {e}\n",
            height + 2e-3
        );
        let scene = scene("jump", &text);
        let dt = 1.0 / 240.0;
        let settings = Settings::default().with("substeps", 20);
        let method = Method::find(name).unwrap();
        let mut solver = method.build(&scene, &settings, dt).unwrap();
        let mut state = scene.start.clone();
        let falls = (2.0 * height / 9.81_f64).sqrt();
        let (mut highest, mut fastest) = (0.0_f64, 0.0_f64);
        run(
            &scene,
            &mut *solver,
            &mut state,
            dt,
            100,
            |step, state, _| {
                let time = f64::from(step) * dt;
                let mean = state.positions.iter().map(|x| x.z).sum::<f64>() / 25.0;
                // Until it would come down the second time.
                if time > falls + 2.0 * dt && time < falls * (1.0 + 2.0 * e) {
                    highest = highest.max(mean - 2e-3);
                    let up = state.velocities.iter().map(|v| v.z).sum::<f64>() / 25.0;
                    fastest = fastest.max(up);
                }
                Ok(())
            },
        )
        .unwrap();
        let expected = e * e * height;
        // The impact is resolved to the way of a substep, 1.4 m/s times 0.2 ms.
        let error = (highest - expected).abs() / height;
        assert!(
            e == 0.0 || error < 0.02,
            "{name} {e}: {highest} m, {expected} expected"
        );
        let at_rest = state.positions.iter().map(|x| x.z).fold(0.0, f64::max);
        assert!(e > 0.0 || at_rest < 4e-3, "{name}: {at_rest} m");
    }
}

/// Two free sheets that fly into each other part with e of the speed, and keep their momentum.
#[test]
fn two_sheets_part_with_a_part_of_their_speed() {
    for e in [0.3, 0.8] {
        let text = format!(
            "gravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:4x4:alternating\"\nscale = 0.1\n[[mesh]]\n\
             generator = \"grid:4x4:alternating\"\nscale = 0.1\ntranslate = [0, 0, 0.01]\n[cloth]\nstiffness = 1000\n\
             [contact]\nself = true\nthickness = 2e-3\nrestitution = {e}\nfriction = 0\n"
        );
        let scene = scene("meet", &text);
        let mass = scene.model.particles.mass().to_vec();
        for name in METHODS {
            let settings = Settings::default().with("substeps", 20);
            let dt = 1.0 / 240.0;
            let method = Method::find(name).unwrap();
            let mut solver = method.build(&scene, &settings, dt).unwrap();
            let mut state = scene.start.clone();
            state.velocities[16..].fill(Vec3::new(0.0, 0.0, -1.0));
            run(&scene, &mut *solver, &mut state, dt, 10, |_, _, _| Ok(())).unwrap();
            let half: f64 = mass[..16].iter().sum();
            let [lower, upper] = [0..16, 16..32].map(|own| {
                let momentum: f64 = own.map(|v| mass[v] * state.velocities[v].z).sum();
                momentum / half
            });
            assert!(
                (lower + upper + 1.0).abs() < 1e-9,
                "{name}: {lower} {upper}"
            );
            let part = upper - lower;
            assert!(
                (part - e).abs() < 0.02,
                "{name} {e}: parted with {part} m/s"
            );
        }
    }
}

#[test]
fn what_minimises_refuses_restitution() {
    let text = "[[mesh]]\ngenerator = \"grid:3x3:alternating\"\ntranslate = [0, 0, 1]\n[[obstacle]]\nshape = \"plane\"\n\
        [contact]\nrestitution = 0.5\n";
    let scene = scene("refused", text);
    for name in [
        "implicit-euler",
        "pd",
        "bdf2",
        "linear-implicit",
        "implicit-midpoint",
    ] {
        let built = Method::find(name)
            .unwrap()
            .build(&scene, &Settings::default(), 0.01);
        let told = built.err().unwrap().to_string();
        assert!(
            told.contains("restitution") && told.contains(name),
            "{told}"
        );
    }
}

/// What may not rebound does not, by methods that take impulses and by those that move with the velocity of their step:
/// a sheet that falls flat on a floor lies there.
#[test]
fn nothing_rebounds_with_a_restitution_of_zero() {
    let text = "[[mesh]]\ngenerator = \"grid:9x9:alternating\"\ntranslate = [0, 0, 0.2]\n\
        [[obstacle]]\nshape = \"plane\"\n[contact]\nrestitution = 0\n";
    let scene = scene("flat", text);
    for name in [
        "implicit-euler",
        "linear-implicit",
        "pd",
        "pbd",
        "xpbd",
        "symplectic-euler",
    ] {
        let method = Method::find(name).unwrap();
        let settings = Variant::default_of(method).settings;
        let mut solver = Solver::new(method, &settings, &scene, 1.0 / 60.0).unwrap();
        let mut state = scene.start.clone();
        let (mut touched, mut highest) = (false, 0.0_f64);
        let plan = Plan::new(1.0 / 60.0, 40);
        run_changing(&scene, &mut solver, &mut state, plan, |moment| {
            let x = &moment.state.positions;
            let mean = x.iter().map(|x| x.z).sum::<f64>() / x.len() as f64;
            touched |= mean < 6e-3;
            if touched {
                highest = highest.max(mean);
            }
            Ok(())
        })
        .unwrap();
        assert!(touched && highest < 6e-3, "{name}: {highest} m");
    }
}
