//! What a scene file lets happen: vertices are grabbed, dragged and released, and triangles torn out along a line.

use crate::exact_runs::refused;
use crate::scene_text::scene;
use cloth_bench::method::METHODS;
use cloth_bench::run::{Plan, Solver, run_changing};
use cloth_bench::scene::{ChangeKind, Scene};
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;

const DT: f64 = 1.0 / 240.0;
const SHEET: &str = "[[mesh]]\ngenerator = \"grid:5x9:alternating\"\nscale = 0.2\n";
const ALL: &str = "select = \"border\"\n";

fn event(deed: &str, step: u32, more: &str) -> String {
    let time = f64::from(step) * DT;
    format!("[[event]]\ntime = {time}\ndo = \"{deed}\"\n{more}")
}

/// A sheet that is grabbed by all vertices and dragged follows its path, from where each motion finds it; released on
/// the way, it flies as any body does. So it is with every method.
#[test]
fn what_is_dragged_follows_its_path_and_flies_on_when_released() {
    let all = "box = [[-1, -1, -1], [1, 1, 1]]\n";
    let shifts = [Vec3::new(0.01, 0.0, -0.02), Vec3::new(-0.03, 0.02, 0.06)];
    let drag = |shift: Vec3, steps: u32| {
        let (shift, duration) = (<[f64; 3]>::from(shift), f64::from(steps) * DT);
        format!("{all}move = {shift:?}\nduration = {duration}\n")
    };
    let text = format!(
        "{SHEET}{}{}{}{}",
        event("release", 20, all),
        event("grab", 0, &drag(shifts[0], 8)),
        event("drag", 10, &drag(shifts[1], 20)),
        event("grab", 30, all),
    );
    let scene = scene("dragged", &text);
    let velocity = shifts[1] / (20.0 * DT);
    for method in METHODS
        .iter()
        .filter(|method| method.name != "explicit-euler")
    {
        let settings = Settings::default();
        let mut solver = Solver::new(method, &settings, &scene, DT).unwrap();
        let mut state = scene.start.clone();
        let name = method.name;
        let parts = method.substeps(&scene, &settings, DT).unwrap();
        let h = DT / f64::from(parts);
        let run = run_changing(
            &scene,
            &mut solver,
            &mut state,
            Plan::new(DT, 35),
            |moment| {
                let step = moment.step;
                let first = shifts[0] * (f64::from(step) / 8.0).min(1.0);
                let second = |step: u32| shifts[1] * (f64::from(step.max(10) - 10) / 20.0);
                // Free from the 20th to the 30th step.
                let free = step.clamp(20, 30) - 20;
                let fall = 0.5 * 9.81 * h * h * method.free_fall(free * parts);
                let flight = velocity * (f64::from(free) * DT) - Vec3::z() * fall;
                let expected = first + second(step.min(20)) + flight;
                for (x, start) in moment.state.positions.iter().zip(&scene.start.positions) {
                    let error = (x - start - expected).norm();
                    assert!(error < 1e-12, "{name}, step {step}: {error:e}");
                }
                Ok(())
            },
        );
        // A solver is made anew for what is held or released, but not for a drag.
        let (summary, end) = run.unwrap();
        assert_eq!(summary.rebuilds, if name == "pd" { 0 } else { 3 }, "{name}");
        assert_eq!(end.model.particles.free_count(), 0, "{name}");
    }
}

/// Projective dynamics is corrected for what is grabbed, released and torn out, and goes on as one that is built anew
/// for every tear: that one is behind a strain limit which is never met, and passes no change on.
#[test]
fn pd_goes_on_through_small_tears_as_if_it_were_built_anew() {
    let cloth = |stiffness: &str| {
        format!(
            "[[mesh]]\ngenerator = \"grid:17x17:alternating\"\nscale = 0.2\n[cloth]\n{stiffness}\n\
             [[pins]]\nvertices = [0, 16]\n{}{}{}{}",
            event("grab", 3, "vertices = [140]\n"),
            event("tear", 6, "box = [[0.099, 0.099, -1], [0.114, 0.114, 1]]\n"),
            event("release", 9, "vertices = [140]\n"),
            event("tear", 12, "line = [[0.101, 0.12, 0], [0.103, 0.16, 0]]\n"),
        )
    };
    let run = |scene: &Scene, settings: &[&str]| {
        let method = cloth_bench::method::Method::find("pd").unwrap();
        let settings = Settings::parse(settings).unwrap();
        let mut solver = Solver::new(method, &settings, scene, DT).unwrap();
        let mut state = scene.start.clone();
        let mut factorizations = Vec::new();
        let run = run_changing(
            scene,
            &mut solver,
            &mut state,
            Plan::new(DT, 20),
            |moment| {
                factorizations.push(moment.report.factorizations);
                Ok(())
            },
        );
        let (summary, end) = run.unwrap();
        (state.positions, summary.rebuilds, factorizations, end)
    };
    let springs = scene("pd-tears", &cloth("stiffness = 500"));
    for acceleration in ["none", "chebyshev", "quasi-newton"] {
        let acceleration = format!("acceleration={acceleration}");
        let settings = ["iterations=10", &acceleration];
        let (went_on, rebuilds, factorizations, end) = run(&springs, &settings);
        let limited = [&settings[..], &["strain_limit=1000"]].concat();
        let (anew, all, _, _) = run(&springs, &limited);
        assert_eq!((rebuilds, all), (0, 4), "{acceleration}");
        let triangles = end.mesh.unwrap().triangle_count();
        assert!(triangles < springs.mesh.as_ref().unwrap().triangle_count() - 8);
        // The first step factorises; a grab, which changes one row, does not, nor a hole of two triangles.
        assert_eq!(factorizations[..7], [1, 0, 0, 0, 0, 0, 0], "{acceleration}");
        let pairs = went_on.iter().zip(&anew);
        let apart = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        println!("{acceleration}: {apart:e}, {factorizations:?}");
        // Ten iterations of the quasi-Newton method make some 1e-9 m of rounding.
        let bound = if acceleration.ends_with("newton") {
            1e-8
        } else {
            1e-14
        };
        assert!(apart < bound, "{acceleration}: {apart:e}");
    }
    // Springs made of a modulus are weaker at a new rim: those are others, and it is built anew.
    let modulus = scene("pd-tears-modulus", &cloth("modulus = 500"));
    assert_eq!(run(&modulus, &[]).1, 2);
}

/// What is left of the triangles of a scene after its only tear.
fn left(scene: &Scene) -> Vec<[u32; 3]> {
    match &scene.changes[..] {
        [change] => match &change.kind {
            ChangeKind::Tear { mesh, .. } => mesh.triangles().to_vec(),
            other => panic!("{other:?}"),
        },
        others => panic!("{others:?}"),
    }
}

/// Twice the area of a triangle in the plane z = 0, positive if its corners go round to the left.
fn area([a, b, c]: [Vec3; 3]) -> f64 {
    (b - a).cross(&(c - a)).z
}

/// The triangles that a line tears out are those in which some of many points along it are, a little to its left.
#[test]
fn a_line_tears_out_the_triangles_that_it_crosses() {
    for (name, [a, b]) in [
        (
            "oblique",
            [Vec3::new(0.013, 0.07, 0.0), Vec3::new(0.17, 0.31, 0.0)],
        ),
        (
            "back",
            [Vec3::new(0.17, 0.31, 0.0), Vec3::new(0.013, 0.07, 0.0)],
        ),
        (
            "edges",
            [Vec3::new(0.1, -0.1, 0.0), Vec3::new(0.1, 0.2, 0.0)],
        ),
        (
            "above",
            [Vec3::new(0.013, 0.07, 0.01), Vec3::new(0.17, 0.31, 0.01)],
        ),
    ] {
        let ends = [a, b].map(<[f64; 3]>::from);
        let scene = scene(
            &format!("tear-{name}"),
            &format!("{SHEET}{}", event("tear", 5, &format!("line = {ends:?}\n"))),
        );
        let (mesh, left) = (scene.mesh.as_ref().unwrap(), left(&scene));
        let along = b - a;
        let aside = Vec3::new(-along.y, along.x, 0.0).normalize() * 5e-5;
        let samples: Vec<Vec3> = (1..200_000)
            .map(|n| a + along * (f64::from(n) / 200_000.0) + aside)
            .collect();
        let mut torn = 0;
        for triangle in mesh.triangles() {
            let corners = triangle.map(|v| mesh.positions()[v as usize]);
            let turn = area(corners).signum();
            let has = |p: &Vec3| {
                (0..3).all(|k| turn * area([corners[k], corners[(k + 1) % 3], *p]) > 0.0)
            };
            let is_crossed = samples.iter().any(has);
            torn += u32::from(is_crossed);
            assert_eq!(!left.contains(triangle), is_crossed, "{name}: {corners:?}");
        }
        assert!(torn > 5, "{name}: {torn}");
    }
}

#[test]
fn events_that_cannot_be_are_refused_with_their_line() {
    let text = |more: &str| format!("{SHEET}[[pins]]\nvertices = [0]\n{more}");
    let timed = "[[pins]]\nvertices = [7]\nfrom = 1\n";
    for (name, more, line, words) in [
        (
            "undone",
            "[[event]]\ntime = 1\n".into(),
            6,
            "needs do = \"grab\"",
        ),
        (
            "timeless",
            "[[event]]\ndo = \"grab\"\nvertices = [3]\n".into(),
            6,
            "needs a time",
        ),
        (
            "do",
            event("grap", 1, ALL),
            8,
            "unknown do `grap`: did you mean `grab`?",
        ),
        (
            "nobody",
            event("grab", 1, ""),
            6,
            "needs one of the keys select, vertices and box",
        ),
        (
            "two-choices",
            event("grab", 1, "vertices = [3]\nselect = \"corners\"\n"),
            6,
            "takes only one of the keys select, vertices and box",
        ),
        (
            "free",
            event("drag", 1, "vertices = [3]\nmove = [1, 0, 0]\n"),
            6,
            "vertex 3 is not held",
        ),
        (
            "still",
            event("drag", 1, "vertices = [0]\n"),
            6,
            "a drag needs a move or a turn",
        ),
        (
            "twice",
            event("grab", 1, ALL),
            6,
            "vertex 0 is held already",
        ),
        (
            "loose",
            event("release", 1, "vertices = [0, 9]\n"),
            6,
            "vertex 9 is not held",
        ),
        (
            "moved",
            event("release", 1, "vertices = [0]\nmove = [1, 0, 0]\n"),
            10,
            "for a release",
        ),
        (
            "pinned",
            format!("{timed}{}", event("grab", 1, "vertices = [7]\n")),
            9,
            "held by [[pins]]",
        ),
        (
            "line",
            event("grab", 1, "vertices = [3]\nline = [[0, 0, 0], [1, 0, 0]]\n"),
            10,
            "but for a tear",
        ),
        (
            "nowhere",
            event("tear", 1, ""),
            6,
            "a tear needs a box or a line",
        ),
        (
            "beside",
            event("tear", 1, "line = [[5, 0, 0], [6, 0, 0]]\n"),
            9,
            "no triangle on the line",
        ),
        (
            "chosen",
            event("tear", 1, "vertices = [3]\n"),
            9,
            "vertices has no meaning for a tear",
        ),
    ] {
        refused(&format!("event-{name}"), &text(&more), line, words);
    }
}
