//! Cloth that passes through itself at the start of a run: pulled apart on the way where the scene wants that, refused
//! otherwise.

use crate::program::program;
use crate::scene_text::{scene, written};
use cloth_bench::method::Method;
use cloth_bench::run::from_start;
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_collide::SeparationProbe;
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;

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
    assert_eq!(out.status.code(), Some(1), "{said}");
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
