//! Cloth that is held inside of a body: a flag in its pole, a cape on a shoulder.

use crate::program::run_text;

/// A sheet upright, held by its upper edge; the middle vertex of that is in a ball.
const CAPE: &str = r#"
steps = 30
[[mesh]]
generator = "grid:11x11:alternating"
rotate = [1.5707963267948966, 0, 0]
[[pins]]
select = "highest"
[[obstacle]]
shape = "sphere"
radius = 0.06
position = [0.5, 0, 1]
"#;

/// Pins drive an edge of a carpet through a box and out of it at its top.
const CARPET: &str = r#"
steps = 60
[[mesh]]
generator = "grid:21x9:alternating"
scale = [1.2, 1.2, 1]
translate = [-1.0, -0.24, 0.003]
[cloth]
density = 1.5
stiffness = 20000
[[pins]]
box = [[0.199, -1, 0], [0.21, 1, 1]]
move = [0.3, 0, 0.4]
duration = 0.5
[[obstacle]]
shape = "plane"
[[obstacle]]
shape = "box"
size = [1, 1, 0.15]
position = [0.8, 0, 0.075]
"#;

/// What hangs from the ball hangs as it does without one: the ball is nowhere else in its way but at the four cells
/// around the held vertex. Free vertices stay out of the ball.
#[test]
fn cloth_held_in_a_body_hangs_from_it() {
    for method in ["implicit-euler", "pd", "xpbd"] {
        // As many substeps with something to touch as without.
        let more: &[&str] = match method {
            "xpbd" => &["--set", "strain=0.07"],
            _ => &[],
        };
        let (told, code, said) = run_text("cape", CAPE, method, more);
        assert_eq!(code, 0, "{method}: {said}");
        let warning = "held vertices are in obstacle 0 (sphere), and the triangles around them pass through it: \
                       vertices 115";
        assert!(said.contains(warning), "{said}");
        let alone = CAPE.split("[[obstacle]]").next().unwrap();
        let (free, ..) = run_text("cape-alone", alone, method, more);
        let [with, without] =
            [told, free].map(|told| told.unwrap()["center_of_mass_drop"].as_f64().unwrap());
        assert!(
            (with - without).abs() < 1e-6,
            "{method}: {with} m, {without} m"
        );
    }
}

/// A free vertex in the body has no such way, and is told so.
#[test]
fn free_cloth_in_a_body_is_refused_with_what_to_do() {
    let finer = CAPE.replace("11x11", "41x41");
    let (_, code, said) = run_text("cape-fine", &finer, "implicit-euler", &[]);
    assert_eq!(code, 2, "{said}");
    for part in [
        "obstacle 0 (sphere)",
        "the deepest is vertex",
        "or hold what is to stay inside",
    ] {
        assert!(said.contains(part), "{said}");
    }
}

/// A ball in the middle of a cell touches no vertex: the message names it, and the triangle.
#[test]
fn crossing_triangles_are_named() {
    let between = CAPE
        .replace("radius = 0.06", "radius = 0.02")
        .replace("0.5, 0, 1", "0.53, 0, 0.56");
    let (_, code, said) = run_text("cape-crossed", &between, "implicit-euler", &[]);
    assert_eq!(code, 2, "{said}");
    for part in [
        "step 1:",
        "the vertices 60, ",
        "and one of obstacle 0 (sphere)",
        "untangle=yes",
    ] {
        assert!(said.contains(part), "{said}");
    }
}

/// With every method the run goes on, and once the pins have left the box, it is in the way of the triangles around
/// them again: nothing of the carpet is in the box but what they pulled through its side.
#[test]
fn pins_may_drive_cloth_through_a_body() {
    for method in ["implicit-euler", "pd", "xpbd"] {
        let (_, code, said) = run_text("carpet", CARPET, method, &[]);
        assert_eq!(code, 0, "{method}: {said}");
    }
}
