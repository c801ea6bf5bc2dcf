//! Cloth that passes through itself at the start of a run: pulled apart on the way where the scene wants that, refused
//! otherwise.

use crate::animations::shapes;
use crate::program::program;
use crate::scene_text::{scene, written};
use cloth_bench::method::Method;
use cloth_bench::run::from_start;
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_collide::{BodyProbe, SeparationProbe};
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::particles::State;

/// Two sheets, the second through the first, and a third close below that nothing passes through.
fn layers(contact: &str) -> String {
    let sheet = "[[mesh]]\ngenerator = \"grid:13x13:alternating\"\nscale = 0.4\n";
    format!(
        "dt = 0.01\n{sheet}translate = [-0.2, -0.2, 0]\n\
         {sheet}rotate = [0, 0.15, 0.4]\ntranslate = [-0.1, -0.2, 0.03]\n\
         {sheet}translate = [-0.2, -0.2, -0.15]\n[contact]\nself = true\nthickness = 4e-3\n{contact}"
    )
}

/// How many pairs of triangles of two of the three sheets, or of one of them with itself, cross.
fn crossing(scene: &Scene, sheets: [usize; 2], x: &[Vec3]) -> usize {
    let (vertices, triangles) = (169, 288);
    let mesh = scene.mesh.as_ref().unwrap();
    let of = |sheet: usize| &mesh.triangles()[sheet * triangles..(sheet + 1) * triangles];
    let place = |v: u32, sheet: usize, place: usize| v - ((sheet - place) * vertices) as u32;
    let both = (0..2).flat_map(|n| {
        of(sheets[n])
            .iter()
            .map(move |t| t.map(|v| place(v, sheets[n], n)))
    });
    let part = |x: &[Vec3]| {
        let own = |sheet: usize| &x[sheet * vertices..(sheet + 1) * vertices];
        [own(sheets[0]), own(sheets[1])].concat()
    };
    let pair = TriMesh::new(part(mesh.positions()), both.collect()).unwrap();
    let measured = SeparationProbe::new(&pair).measure(&part(x)).unwrap();
    measured.intersecting_pairs
}

#[test]
fn layers_come_apart_and_nothing_else_crosses() {
    let scene = scene("layers", &layers("untangle = true\n"));
    for name in ["implicit-euler", "pd", "xpbd", "symplectic-euler"] {
        let method = Method::find(name).unwrap();
        let settings = Settings::default();
        let mut counts = Vec::new();
        let ran = from_start(&scene, method, &settings, 0.01, 60, |_, state, _| {
            let x = &state.positions;
            for clean in [[0, 2], [1, 2]] {
                assert_eq!(crossing(&scene, clean, x), 0, "{name}: {clean:?}");
            }
            counts.push(crossing(&scene, [0, 1], x));
            Ok(())
        });
        let (summary, _) = ran.unwrap();
        let told = &summary.tangled_pairs;
        // What is told before a step is what was there after the one before.
        assert!(told[0] > 20, "{name}: {told:?}");
        assert_eq!(told[1..], counts[..told.len() - 1], "{name}");
        assert_eq!(told.last(), Some(&0), "{name}: {told:?}");
        assert!(
            counts[told.len() - 1..].iter().all(|n| *n == 0),
            "{name}: {counts:?}"
        );
        assert_eq!(
            (summary.intersections, summary.tangled),
            (Some(0), None),
            "{name}"
        );
    }
}

#[test]
fn tangled_start_is_refused_unless_it_shall_be_pulled_apart() {
    let path = written("refused", &layers(""));
    let out = program(&[
        "run",
        path.to_str().unwrap(),
        "--method",
        "xpbd",
        "--steps",
        "3",
    ]);
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("pass through each other"), "{said}");
    let path = written("given-up", &layers("untangle = true\n"));
    let arguments = [
        "run",
        path.to_str().unwrap(),
        "--method",
        "xpbd",
        "--steps",
        "2",
        "--json",
    ];
    let out = program(&arguments);
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(1), "{said}");
    assert!(
        said.contains("untangling has not come to its end"),
        "{said}"
    );
    let object: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(object["tangled_pairs"].as_array().unwrap().len(), 2);
    for (name, contact) in [
        ("alone", "self = false\n"),
        ("none", "contact = \"none\"\n"),
    ] {
        let text = "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n[contact]\nuntangle = true\n";
        let refused = file::build(
            &written(name, &format!("{text}{contact}")),
            &Settings::default(),
        );
        let said = refused.unwrap_err().to_string();
        assert!(said.contains("untangle"), "{said}");
    }
}

/// A sheet that starts in a body, above another one that it does not touch.
fn in_bodies() -> [(&'static str, String); 4] {
    let sheet =
        "steps = 40\ndt = 0.01\n[[mesh]]\ngenerator = \"grid:17x17:alternating\"\nscale = 0.6\n";
    let more = "[contact]\nself = true\nuntangle = true\n";
    let below = "[[obstacle]]\nshape = \"box\"\nsize = [2, 2, 0.1]\nposition = [0, 0, -0.5]\n";
    let wall = [[0.0, -0.9, -0.1], [0.0, 0.9, -0.1], [0.03, 0.0, 0.9]];
    shapes("tangle-wall", &[("0.obj", wall)]);
    [
        (
            "corner",
            format!(
                "{sheet}translate = [-0.3, -0.3, 0]\n{more}[[obstacle]]\nshape = \"box\"\nsize = [0.3, 0.3, 0.3]\n\
                 rotate = [0.6, 0.6, 0]\nposition = [0, 0, -0.15]\n{below}"
            ),
        ),
        // Far more than half of it is inside.
        (
            "inside",
            format!(
                "{sheet}translate = [-0.3, -0.3, 0.06]\n{more}[[obstacle]]\nshape = \"box\"\nsize = [0.8, 0.8, 0.3]\n\
                 position = [0.2, 0, 0]\n{below}"
            ),
        ),
        // Held at its upper border, with an arm through it.
        (
            "arm",
            format!(
                "{sheet}rotate = [1.5707963, 0, 0]\ntranslate = [-0.3, 0, -0.3]\n[[pins]]\nselect = \"highest\"\n{more}\
                 [[obstacle]]\nshape = \"capsule\"\nradius = 0.04\nlength = 0.3\nrotate = [1.5707963, 0, 0]\n\
                 position = [0.02, 0.06, 0.01]\n{below}"
            ),
        ),
        // Open, and known by its triangles alone.
        (
            "wall",
            format!(
                "{sheet}translate = [-0.15, -0.3, 0.2]\n{more}[[obstacle]]\nshape = \"animation\"\n\
                 folder = \"tangle-wall\"\n{below}"
            ),
        ),
    ]
}

/// Pairs of triangles of the cloth and of the body of this number that cross.
fn crossing_body(scene: &Scene, number: usize, state: &State) -> usize {
    let touch = scene.touch.as_ref().unwrap();
    let surfaces = touch.body_surfaces(state.time);
    let body = surfaces.iter().find(|body| body.number == number).unwrap();
    let mesh = TriMesh::new(body.positions.clone(), body.triangles.to_vec()).unwrap();
    let mut probe = BodyProbe::new(scene.mesh.as_ref().unwrap(), &[&mesh]).unwrap();
    probe
        .count(&state.positions, [&body.positions[..]])
        .unwrap()
}

#[test]
fn cloth_comes_out_of_the_body_that_it_starts_in_and_into_no_other() {
    for (name, text) in in_bodies() {
        let scene = scene(name, &text);
        let start = crossing_body(&scene, 0, &scene.start);
        assert!(start > 10, "{name}: {start}");
        for method in ["implicit-euler", "pd", "xpbd"] {
            let kind = Method::find(method).unwrap();
            let settings = Settings::default();
            let mut counts = vec![start];
            let ran = from_start(&scene, kind, &settings, 0.01, scene.steps, |_, state, _| {
                counts.push(crossing_body(&scene, 0, state));
                let x = &state.positions;
                assert_eq!(crossing_body(&scene, 1, state), 0, "{name} {method}");
                let itself = SeparationProbe::new(scene.mesh.as_ref().unwrap()).measure(x);
                assert_eq!(itself.unwrap().intersecting_pairs, 0, "{name} {method}");
                Ok(())
            });
            let (summary, _) = ran.unwrap();
            let told = &summary.tangled_obstacle_pairs;
            assert_eq!(told[..], counts[..told.len()], "{name} {method}");
            assert!(
                summary.tangled_pairs.iter().all(|n| *n == 0),
                "{name} {method}"
            );
            assert_eq!(told.last(), Some(&0), "{name} {method}: {told:?}");
            let free = told.len() - 1;
            assert_eq!(
                summary.untangled_after,
                Some(free as u32),
                "{name} {method}"
            );
            assert!(
                counts[free..].iter().all(|n| *n == 0),
                "{name} {method}: {counts:?}"
            );
            assert_eq!(
                (summary.tangled, summary.pinched_steps),
                (None, 0),
                "{name} {method}"
            );
            let clearance = summary.min_clearance.unwrap();
            assert!(clearance > 0.0, "{name} {method}: {clearance}");
        }
    }
}

/// A sheet whose border is held cannot be pushed over an arm that is longer than the sheet is wide.
#[test]
fn what_stays_in_a_body_is_said_with_the_body() {
    let held: Vec<u32> = (0..81)
        .filter(|v| v % 9 % 8 == 0 || v / 9 % 8 == 0)
        .collect();
    let text = format!(
        "[[mesh]]\ngenerator = \"grid:9x9:alternating\"\nscale = 0.3\ntranslate = [-0.15, -0.15, 0]\n\
         [[pins]]\nvertices = {held:?}\n[[obstacle]]\nshape = \"plane\"\nposition = [0, 0, -2]\n\
         [[obstacle]]\nshape = \"capsule\"\nradius = 0.04\nlength = 3\n"
    );
    let arguments = |path: &str| {
        let list = ["run", path, "--method", "pd", "--steps", "4", "--json"];
        program(&list)
    };
    let path = written(
        "held-on-arm",
        &format!("{text}[contact]\nuntangle = true\n"),
    );
    let out = arguments(path.to_str().unwrap());
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(1), "{said}");
    for words in [
        "untangling has not come to its end",
        "of them of the cloth and a body",
        " of obstacle 1 (from 0)",
        "after 0 steps: 0 crossing pairs of the cloth with itself, ",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let told: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert!(told["untangled_after"].is_null(), "{told}");
    assert!(told["obstacle_intersections"].as_u64().unwrap() > 0);
    let path = written("not-on-arm", &text);
    let out = arguments(path.to_str().unwrap());
    let said = String::from_utf8(out.stderr).unwrap();
    let vertex =
        "starts inside obstacle 1 (capsule), with 5 of its vertices: the deepest is vertex 4";
    for words in [vertex, "m below the surface", "untangle=yes"] {
        assert!(said.contains(words), "{words}: {said}");
    }
}

/// Every line has fewer pairs than the one before, the last has none, and the report has the step.
#[test]
fn a_run_tells_how_the_pairs_become_fewer() {
    let path = written("told", &layers("untangle = true\n"));
    let path = path.to_str().unwrap();
    let out = program(&["run", path, "--method", "xpbd", "--steps", "60", "--json"]);
    let said = String::from_utf8(out.stderr).unwrap();
    assert!(out.status.success(), "{said}");
    let told: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let pairs: Vec<u64> = serde_json::from_value(told["tangled_pairs"].clone()).unwrap();
    let after = told["untangled_after"].as_u64().unwrap();
    assert_eq!(pairs.len() as u64, after + 1);
    let lines: Vec<&str> = said
        .lines()
        .filter(|line| line.starts_with("after "))
        .collect();
    let numbers = |line: &str| -> Vec<u64> {
        line.split(|c: char| !c.is_ascii_digit())
            .filter_map(|n| n.parse().ok())
            .collect()
    };
    let mut fewest = u64::MAX;
    let (last, before) = lines.split_last().unwrap();
    for line in before {
        let [step, own, bodies] = numbers(line)[..] else {
            panic!("{line}")
        };
        assert_eq!((own, bodies), (pairs[step as usize], 0), "{line}");
        assert!(own < fewest, "{line}");
        fewest = own;
    }
    assert_eq!(*last, format!("after {after} steps: untangled"));
}

/// A sheet goes through the first of two that are drawn together, or across the closed seam of two.
#[test]
fn what_a_seam_draws_together_is_not_pulled_apart() {
    let sheet = "[[mesh]]\ngenerator = \"grid:13x13:alternating\"\nscale = 0.4\ntranslate = ";
    let third = "[[mesh]]\ngenerator = \"grid:13x13:alternating\"\nrotate = [0, 0.15, 0.4]\n";
    let closing =
        format!("{sheet}[0.02, -0.2, 0]\n{third}scale = 0.2\ntranslate = [-0.38, -0.1, 0.015]\n");
    let closed =
        format!("{sheet}[-0.02, -0.2, 0]\n{third}scale = 0.4\ntranslate = [-0.22, -0.2, 0.03]\n");
    for (case, pieces, until) in [
        ("closing", closing, "until = 0.2\n"),
        ("closed", closed, ""),
    ] {
        let text = format!(
            "dt = 0.01\ngravity = [0, 0, 0]\n{sheet}[-0.42, -0.2, 0]\n{pieces}[contact]\nself = true\n\
             untangle = true\n[[seam]]\nmeshes = [0, 1]\nfirst_border = [12, 168]\nsecond_border = [0, 156]\n{until}"
        );
        let scene = scene(&format!("sewn-{case}"), &text);
        for name in ["implicit-euler", "pd", "xpbd"] {
            let method = Method::find(name).unwrap();
            let mut counts = Vec::new();
            let mut probe = scene.separation_probe().unwrap();
            let ran = from_start(
                &scene,
                method,
                &Settings::default(),
                0.01,
                60,
                |_, state, _| {
                    counts.push(probe.measure(&state.positions).unwrap().intersecting_pairs);
                    Ok(())
                },
            );
            let (summary, _) = ran.unwrap();
            let told = &summary.tangled_pairs;
            assert!(told[0] > 15, "{case}, {name}: {told:?}");
            assert_eq!(told[1..], counts[..told.len() - 1], "{case}, {name}");
            let free = summary.untangled_after.unwrap() as usize;
            assert!(free > 0, "{case}, {name}: {told:?}");
            assert!(
                counts[free - 1..].iter().all(|n| *n == 0),
                "{case}, {name}: {counts:?}"
            );
            // Contact would keep the two 2 mm apart.
            let gap = summary.max_seam_gap.unwrap();
            assert!(gap < 1e-4, "{case}, {name}: {gap}");
        }
    }
}

/// Two sheets are pulled apart, and a piece that may pass through both stays in the first, where nothing pulls at it.
/// What rounding an iteration of `pd` leaves there grows with the iterations for the others: by 10⁻⁸ m at its default
/// tolerance, by 10⁻⁵ m in the 49,000 of a tight one.
#[test]
fn pieces_that_may_pass_through_each_other_are_left_alone() {
    let sheet = "[[mesh]]\ngenerator = \"grid:13x13:alternating\"\nscale = 0.4\n";
    let text = format!(
        "dt = 0.01\ngravity = [0, 0, 0]\n{sheet}translate = [-0.2, -0.2, 0]\n\
         {sheet}rotate = [0, 0.15, 0.4]\ntranslate = [-0.1, -0.2, 0.03]\n\
         [[mesh]]\ngenerator = \"grid:5x5:alternating\"\nscale = 0.08\nrotate = [0, 1.5707963, 0]\n\
         translate = [-0.17, -0.19, 0.04]\n[mesh.contact]\nexclude = [0, 1]\n[contact]\nself = true\nuntangle = true\n"
    );
    let scene = scene("excluded", &text);
    let mut all = SeparationProbe::new(scene.mesh.as_ref().unwrap());
    let tight: &[&str] = &["velocity_tolerance=1e-4", "most_iterations=3000"];
    for (name, settings, near) in [
        ("implicit-euler", &[][..], 1e-5),
        ("pd", tight, 5e-5),
        ("xpbd", &[], 1e-5),
    ] {
        let method = Method::find(name).unwrap();
        let settings = Settings::parse(settings).unwrap();
        let ran = from_start(&scene, method, &settings, 0.01, 40, |_, _, _| Ok(()));
        let (summary, state) = ran.unwrap();
        assert!(summary.tangled_pairs[0] > 20, "{name}");
        assert!(summary.untangled_after.unwrap() > 0, "{name}");
        assert_eq!(
            (summary.intersections, summary.tangled),
            (Some(0), None),
            "{name}"
        );
        let crossing = all.measure(&state.positions).unwrap().intersecting_pairs;
        assert!(crossing > 0, "{name}: it has been pulled out");
        for (x, start) in state.positions.iter().zip(&scene.start.positions).skip(338) {
            assert!((x - start).norm() < near, "{name}: {x} {start}");
        }
    }
}
