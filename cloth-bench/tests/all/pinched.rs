//! Cloth between two bodies that close.

use crate::program::run_text;
use serde_json::Value;

/// A sheet hangs between a ball and a box that meet at 0.3 m/s. Their surfaces are 0.14 m from each other at the start,
/// and touch after 0.467 s; the thickness of the cloth on both sides is used up 0.013 s before that, with step 28. They
/// leave each other on the other side after 1.133 s, with step 68.
const JAWS: &str = r#"
steps = 80
[[mesh]]
generator = "grid:15x15:alternating"
scale = 0.4
rotate = [0, 1.5707963, 0]
[[pins]]
select = "highest"
[contact]
self = true
[[obstacle]]
shape = "sphere"
radius = 0.06
position = [-0.12, 0.2, -0.2]
velocity = [0.15, 0, 0]
[[obstacle]]
shape = "box"
size = [0.08, 0.2, 0.08]
position = [0.12, 0.2, -0.2]
velocity = [-0.15, 0, 0]
"#;

/// What a run of so many steps prints, with its exit code and what it says besides.
fn run(method: &str, steps: &str, more: &[&str]) -> (Option<Value>, i32, String) {
    let more = [&["--watch", "--steps", steps], more].concat();
    run_text("jaws", JAWS, method, &more)
}

/// As long as there is room nothing is let go; then the cloth passes through one of the bodies, and when they have left
/// each other it is free of both, and nothing has come from nowhere.
#[test]
fn pinched_cloth_passes_through_a_body_until_it_is_out() {
    for method in ["implicit-euler", "pd", "xpbd"] {
        let (told, code, said) = run(method, "26", &[]);
        assert_eq!(code, 0, "{method}: {said}");
        let count = |told: &Value, key: &str| told[key].as_u64().unwrap();
        let told = told.unwrap();
        for key in ["pinched_steps", "most_obstacle_intersections"] {
            assert_eq!(count(&told, key), 0, "{method}: {key}");
        }
        let (told, code, said) = run(method, "80", &[]);
        assert_eq!(code, 0, "{method}: {said}");
        let told = told.unwrap();
        let pinched = count(&told, "pinched_steps");
        assert!((1..=42).contains(&pinched), "{method}: {pinched}");
        let crossed = count(&told, "obstacle_crossed_steps");
        assert!((1..=pinched).contains(&crossed), "{method}: {crossed}");
        for key in ["obstacle_intersections", "most_intersections"] {
            assert_eq!(count(&told, key), 0, "{method}: {key}");
        }
        let warning = format!("in {pinched} of 80 steps up to");
        assert!(said.contains("bodies have pinched the cloth"), "{said}");
        assert!(said.contains(&warning), "{said}");
        let excess = told["energy_excess"].as_f64().unwrap();
        assert!(excess < 1e-4, "{method}: {excess} J");
    }
}

/// Who wants no such passing gets an error with the vertex that has no feasible path, in the step in which there is
/// none.
#[test]
fn pinched_cloth_ends_a_run_that_refuses_it() {
    let (_, code, said) = run("implicit-euler", "80", &["--set", "pinched=refuse"]);
    assert_eq!(code, 1);
    let step = said.split("step ").nth(1).unwrap();
    let step: u32 = step.split(':').next().unwrap().parse().unwrap();
    assert!((27..=40).contains(&step), "{said}");
    assert!(said.contains("leave no free path to vertex"), "{said}");
    let (_, code, said) = run("implicit-euler", "1", &["--set", "pinched=maybe"]);
    assert_eq!(code, 2);
    assert!(said.contains("(known: pass, refuse)"), "{said}");
}
