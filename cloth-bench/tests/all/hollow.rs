//! Rigid bodies without an inside: `shape = "mesh"` of a mesh that is open, or goes through itself.

use crate::program::program;
use crate::rigid_bodies::watch;
use crate::scene_text::{scene, written};
use cloth_bench::run::SeparationWatch;
use cloth_bench::scene::file;
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{cuboid, join};
use cloth_core::mesh::{TriMesh, obj};

const METHODS: [(&str, &str); 3] = [
    ("implicit-euler", "tolerance=1e-9"),
    ("xpbd", "substeps=20"),
    ("pd", "velocity_tolerance=1e-3"),
];

const SHEET: &str = "dt = 0.01\n[[mesh]]\ngenerator = \"grid:9x9:alternating\"\nscale = 0.3\n";

/// Two boxes as one mesh, the second turned and through the first, beside a scene file of this name.
fn crossed_boxes(name: &str) -> String {
    let one = cuboid([0.3, 0.3, 0.05]).unwrap();
    let turned = |x: &Vec3| Vec3::new(x.y + 0.2, x.z, x.x) * 0.4 - Vec3::z() * 0.08;
    let x = one.positions().iter().map(turned).collect();
    let other = TriMesh::new(x, one.triangles().to_vec()).unwrap();
    let both = join(&[one, other]).unwrap();
    let file = written(name, "").with_extension("obj");
    obj::write(&file, both.positions(), both.triangles()).unwrap();
    format!("file = \"{name}.obj\"\n")
}

/// A sheet comes to rest on a body 1 m away from the origin, and presses on it with its weight, at its middle.
#[test]
fn open_and_self_intersecting_bodies_carry_the_weight() {
    let bodies = [
        (
            "open",
            "generator = \"grid:4x4:one-way\"\nscale = 1\n".to_owned(),
            [0.5, 0.5, 0.0],
        ),
        ("crossed", crossed_boxes("crossed"), [1.0, 1.0, -0.05]),
    ];
    for (name, source, position) in bodies {
        let text = format!(
            "{SHEET}translate = [0.85, 0.87, 0.003]\n[contact]\nself = true\n[[obstacle]]\nshape = \"mesh\"\n{source}\
             position = {position:?}\n"
        );
        let scene = scene(name, &text);
        let touch = scene.touch.as_ref().unwrap();
        let notes: Vec<&str> = touch.notes().collect();
        assert_eq!(notes.len(), 1, "{notes:?}");
        assert!(
            notes[0].starts_with("obstacle 0 has no inside"),
            "{notes:?}"
        );
        let masses = scene.model.particles.mass();
        let mass: f64 = masses.iter().sum();
        for (method, setting) in METHODS {
            let mut crossings = SeparationWatch::new(&scene).unwrap();
            let mut last = None;
            let settings: Vec<&str> = setting.split_whitespace().collect();
            watch(&scene, method, &settings, 150, |moment| {
                crossings.look(moment.scene, moment.state).unwrap();
                let points = moment.state.positions.iter().zip(masses);
                let middle = points.map(|(x, m)| x * *m).sum::<Vec3>() / mass;
                last = Some((moment.forces.unwrap().bodies[0], middle));
            });
            let seen = crossings.seen();
            assert_eq!(seen.most_obstacle_intersections, 0, "{name} {method}");
            // On the upper side of both, half a thickness from edges at least.
            let clearance = seen.min_clearance.unwrap();
            assert!((9e-4..2.1e-3).contains(&clearance), "{clearance}");
            let (body, middle) = last.unwrap();
            let weight = scene.gravity * mass;
            let off = (body.force - weight).norm() / weight.norm();
            assert!(off < 1e-2, "{name} {method}: {off}");
            // About the position of the body.
            let torque = (middle - Vec3::from(position)).cross(&weight);
            let off = (body.torque - torque).norm() / (0.1 * weight.norm());
            assert!(off < 1e-2, "{name} {method}: {off}");
        }
    }
}

/// An open plate that sets out takes along a sheet that lies on it with friction, and none that lies on it without.
#[test]
fn open_body_moves_and_friction_takes_the_cloth_along() {
    const SPEED: f64 = 0.2;
    for (friction, expected) in [(0.5, SPEED), (0.0, 0.0)] {
        let text = format!(
            "{SHEET}translate = [0, 0, 0.0019]\n[contact]\nself = true\nfriction = {friction}\n[[obstacle]]\n\
             shape = \"mesh\"\ngenerator = \"grid:4x4:one-way\"\nposition = [-0.5, -0.4, 0]\nvelocity = [{SPEED}, 0, 0]\n"
        );
        let scene = scene(&format!("plate-{friction}"), &text);
        for (method, setting) in METHODS {
            let mut last = Vec3::zeros();
            let settings: Vec<&str> = setting.split_whitespace().collect();
            watch(&scene, method, &settings, 50, |moment| {
                let v = &moment.state.velocities;
                last = v.iter().sum::<Vec3>() / v.len() as f64;
            });
            let off = (last - Vec3::x() * expected).norm();
            assert!(off < 5e-3, "{method}, friction {friction}: {last}");
        }
    }
}

#[test]
fn what_needs_an_inside_says_so_and_a_run_notes_that_there_is_none() {
    let with = |more: &str| {
        format!(
            "{SHEET}translate = [0, 0, 0.1]\n[[obstacle]]\nshape = \"mesh\"\ngenerator = \"grid:4x4:one-way\"\n{more}"
        )
    };
    let refused = |name: &str, text: &str| {
        let built = file::build(&written(name, text), &Settings::default());
        built.unwrap_err().to_string()
    };
    let told = refused("hollow-sampled", &with("sampled = 0.01\n"));
    assert!(
        told.contains("is not closed") && told.contains("sampled needs an inside"),
        "{told}"
    );
    let told = refused("hollow-dense", &with("density = 100\n"));
    assert!(
        told.contains("density needs an inside, but the mesh is not closed"),
        "{told}"
    );
    let crossed = crossed_boxes("hollow-heavy");
    let text = with("density = 100\n").replace("generator = \"grid:4x4:one-way\"\n", &crossed);
    let told = refused("hollow-heavy", &text);
    assert!(
        told.contains("goes through itself") && told.contains("density needs an inside"),
        "{told}"
    );
    // Turned inside out it would be a slip.
    let ball = cuboid([0.1; 3]).unwrap();
    let swapped = ball.triangles().iter().map(|&[a, b, c]| [a, c, b]);
    let file = written("inside-out", "").with_extension("obj");
    obj::write(&file, ball.positions(), &swapped.collect::<Vec<_>>()).unwrap();
    let text = with("").replace(
        "generator = \"grid:4x4:one-way\"",
        "file = \"inside-out.obj\"",
    );
    let told = refused("inside-out", &text);
    assert!(
        told.contains("counter-clockwise seen from outside"),
        "{told}"
    );

    let path = written("noted", &with(""));
    let out = program(&[
        "run",
        path.to_str().unwrap(),
        "--method",
        "pd",
        "--steps",
        "2",
    ]);
    let said = String::from_utf8(out.stderr).unwrap();
    assert!(out.status.success(), "{said}");
    assert!(
        said.contains("note: obstacle 0 has no inside, since the mesh is not closed"),
        "{said}"
    );
}
