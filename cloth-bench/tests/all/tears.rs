//! Tears beside all else that a scene has: links, gas, bodies that move, and files of the run.

use crate::exact_runs::refused;
use crate::program::program;
use crate::rigid_bodies::{body, watch};
use crate::scene_text::{scene, written};
use cloth_bench::method::Method;
use cloth_bench::run::{Plan, Solver, run_changing, to_rest};
use cloth_bench::scene::{ChangeKind, Scene};
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::mesh::obj;
use cloth_core::particles::State;

fn run(scene: &Scene, method: &str, settings: &[&str], steps: u32) -> (State, Scene) {
    let method = Method::find(method).unwrap();
    let settings = Settings::parse(settings).unwrap();
    let mut solver = Solver::new(method, &settings, scene, scene.dt).unwrap();
    let mut state = scene.start.clone();
    let plan = Plan::new(scene.dt, steps);
    let ran = run_changing(scene, &mut solver, &mut state, plan, |_| Ok(()));
    (state, ran.unwrap().1)
}

/// Two sheets lie on each other, and a box that is in both tears what it says: out of one of them or, as it stands
/// without a number, out of both; from files, too, whose vertices are put into another order.
#[test]
fn a_tear_with_the_number_of_a_mesh_leaves_the_others_whole() {
    let sheet = grid(5, 9, 0.2, 0.4, Diagonals::Alternating).unwrap();
    for (name, source) in [
        (
            "generated",
            "generator = \"grid:5x9:alternating\"\nscale = 0.2\n",
        ),
        ("file", "file = \"two-torn.obj\"\n"),
    ] {
        let name = format!("two-torn-{name}");
        let torn = |which: &str| {
            let text = format!(
                "[[mesh]]\n{source}[[mesh]]\n{source}translate = [0, 0, 1e-6]\n[[event]]\ndo = \"tear\"\n\
                 time = 0.1\n{which}box = [[-1, 0.14, -1], [1, 0.21, 1]]\n"
            );
            let path = written(&name, &text).with_file_name("two-torn.obj");
            obj::write(&path, sheet.positions(), sheet.triangles()).unwrap();
            let scene = scene(&name, &text);
            let ChangeKind::Tear { mesh, .. } = &scene.changes[0].kind else {
                panic!("{which}");
            };
            let lower = |t: &&[u32; 3]| mesh.positions()[t[0] as usize].z == 0.0;
            let lower = mesh.triangles().iter().filter(lower).count();
            [lower, mesh.triangles().len() - lower]
        };
        let [lower, upper] = torn("");
        assert!(lower == upper && 0 < lower && lower < 64, "{name}: {lower}");
        assert_eq!(torn("mesh = 0\n"), [lower, 64], "{name}");
        assert_eq!(torn("mesh = 1\n"), [64, upper], "{name}");
    }
}

/// A strip hangs from another by links; a row of it is torn out, and the links carry what is left above.
#[test]
fn links_carry_what_a_tear_has_left() {
    let strip = "[[mesh]]\ngenerator = \"grid:3x7:alternating\"\nscale = 0.2\nrotate = [1.5707963267948966, 0, 0]\n";
    let text = format!(
        "dt = 0.01\n{strip}{strip}translate = [0, 0, -0.7]\n[cloth]\nstiffness = 1000\n\
         [[pins]]\nvertices = {:?}\n[[link]]\nmeshes = [0, 1]\nfirst = [0, 1, 2]\nsecond = [18, 19, 20]\n\
         stiffness = 2000\n[[event]]\ndo = \"tear\"\ntime = 0.01\nbox = [[-1, -1, -0.5], [1, 1, -0.4]]\n",
        (0..21).collect::<Vec<u32>>()
    );
    let before = scene("linked", &text);
    for (name, settings) in [
        ("implicit-euler", &["tolerance=1e-12"][..]),
        ("pd", &["iterations=200"]),
        ("xpbd", &[]),
    ] {
        let (_, mut torn) = run(&before, name, settings, 3);
        assert!(torn.mesh.as_ref().unwrap().triangles().len() < 48);
        torn.changes.clear();
        // What falls is held, so that something comes to rest.
        let lost: Vec<usize> = (21..42)
            .filter(|&v| torn.start.positions[v].z < -0.45)
            .collect();
        for &v in &lost {
            torn.model.particles.prescribe(v).unwrap();
        }
        let masses = torn.model.particles.mass();
        let hangs = (21..42).filter(|v| !lost.contains(v));
        let weight = 9.81 * hangs.map(|v| masses[v]).sum::<f64>();
        let method = Method::find(name).unwrap();
        let own = Settings::parse(settings).unwrap();
        let mut solver = method.build(&torn, &own, torn.dt).unwrap();
        let mut state = torn.start.clone();
        to_rest(&torn, &mut *solver, &mut state, torn.dt, 20_000, 1e-9).unwrap();
        let links = torn.model.all_springs().filter(|s| s.stiffness == 2000.0);
        let pull = links.map(|spring| {
            let [a, b] = spring.vertices.map(|v| state.positions[v as usize]);
            let length = (a - b).norm();
            (a - b) * (spring.stiffness * (length - spring.rest_length) / length)
        });
        let error = (pull.sum::<Vec3>() / weight - Vec3::z()).norm();
        assert!(error < 1e-6, "{name}: {error:e}");
    }
}

/// Of two balls one is torn: what is inside of it escapes, and the other keeps its own.
#[test]
fn what_is_inside_escapes_from_a_torn_piece_alone() {
    let mesh = cloth_core::mesh::generate::sphere(4, 0.1).unwrap();
    let corners = mesh.triangles()[0].map(|v| mesh.positions()[v as usize]);
    let middle = corners.iter().sum::<Vec3>() / 3.0;
    let [low, high] = [-1e-4, 1e-4].map(|shift| <[f64; 3]>::from(middle.add_scalar(shift)));
    for (inside, grown) in [
        ("pressure = 300\n", 0.1005),
        ("pressure = 300\nbulk_modulus = 1e5\n", 0.10005),
    ] {
        let ball = format!("[[mesh]]\ngenerator = \"sphere:4\"\nscale = 0.2\n{inside}");
        let text = format!(
            "dt = 0.005\ngravity = [0, 0, 0]\n{ball}{ball}translate = [1, 0, 0]\n\
             [cloth]\nmodulus = 2000\n[[event]]\ndo = \"tear\"\ntime = 0.05\nbox = [{low:?}, {high:?}]\n"
        );
        let before = scene("two-balls", &text);
        assert_eq!(before.gases.len() + before.volumes.len(), 2);
        for name in ["implicit-euler", "xpbd"] {
            let (state, end) = run(&before, name, &[], 30);
            assert_eq!(end.gases.len() + end.volumes.len(), 1);
            let half = before.start.positions.len() / 2;
            let [torn, whole] = [&state.positions[..half], &state.positions[half..]];
            let radius = |x: &[Vec3]| {
                let middle = x.iter().sum::<Vec3>() / x.len() as f64;
                x.iter().map(|x| (x - middle).norm()).sum::<f64>() / x.len() as f64
            };
            assert!(
                radius(whole) > grown && (radius(torn) - 0.1).abs() < 2e-5,
                "{name}"
            );
            // A load that went on would throw the open one away, as a rocket.
            let speed = state.velocities[..half].iter().sum::<Vec3>() / half as f64;
            assert!(speed.norm() < 0.05, "{name}: {speed}");
        }
    }
}

/// The ball and the sheet keep their momentum while the sheet is torn in their flight.
#[test]
fn a_tear_beside_a_free_body_keeps_the_momentum() {
    let text = "dt = 0.01\ngravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:13x13:alternating\"\nscale = 0.4\n\
         translate = [-0.17, -0.23, 0.08]\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.06\nmass = 0.04\n\
         velocity = [0, 0, 2]\nangular_velocity = [1, 0, 3]\n\
         [[event]]\ndo = \"tear\"\ntime = 0.08\nbox = [[-0.1033, -0.1633, -1], [-0.07, -0.13, 1]]\n";
    let scene = scene("torn-flight", text);
    let start = Vec3::z() * 0.08;
    for (method, settings, bound) in [
        ("xpbd", &["substeps=30"][..], 1e-10),
        ("symplectic-euler", &[], 1e-10),
        ("implicit-euler", &["tolerance=1e-9"], 1e-6),
    ] {
        let (mut off, mut slowest, mut jump, mut last): (f64, f64, f64, Option<Vec3>) =
            (0.0, 2.0, 0.0, None);
        let mut triangles = [0; 2];
        watch(&scene, method, settings, 20, |moment| {
            let ball = body(moment);
            let masses = moment.scene.model.particles.mass().iter();
            let cloth = masses.zip(&moment.state.velocities).map(|(m, v)| v * *m);
            let all = ball.velocity * 0.04 + cloth.sum::<Vec3>();
            off = off.max((all - start).norm() / start.norm());
            slowest = slowest.min(ball.velocity.z);
            let at = ball.pose.position;
            if let Some(last) = last {
                jump = jump.max((at - last).norm());
            }
            last = Some(at);
            let count = moment.scene.mesh.as_ref().unwrap().triangles().len();
            triangles[usize::from(moment.step > 8)] = count;
        });
        assert!(
            slowest < 1.9 && triangles[1] < triangles[0],
            "{triangles:?}"
        );
        assert!(off < bound, "{method}: {off:e}");
        assert!(jump < 0.021, "{method}: the ball moves on: {jump}");
    }
}

/// A body that pushes a sheet up goes on to do so where a corner of that is torn out.
#[test]
fn bodies_move_on_beside_a_tear() {
    let sheet = "dt = 0.01\ngravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:13x13:alternating\"\n\
         translate = [-0.5, -0.5, 0]\n[cloth]\nstiffness = 500\n[[pins]]\nselect = \"border\"\n\
         [[event]]\ndo = \"tear\"\ntime = 0.2\nbox = [[-0.41, -0.41, -1], [-0.34, -0.34, 1]]\n[[obstacle]]\n";
    let rigid =
        "shape = \"sphere\"\nradius = 0.1\nposition = [0, 0, -0.15]\nvelocity = [0, 0, 0.8]\n";
    let animated = "shape = \"animation\"\nfolder = \"rising\"\ninterval = 0.4\n";
    let folder = written("rising", "").with_extension("");
    std::fs::create_dir_all(&folder).unwrap();
    for (number, height) in [-0.15, 0.17].into_iter().enumerate() {
        let ball = cloth_core::mesh::generate::sphere(5, 0.1).unwrap();
        let moved: Vec<Vec3> = ball
            .positions()
            .iter()
            .map(|x| x + Vec3::z() * height)
            .collect();
        let text = obj::format(&moved, ball.triangles());
        std::fs::write(folder.join(format!("{number}.obj")), text).unwrap();
    }
    for (kind, obstacle) in [("rigid", rigid), ("animated", animated)] {
        let scene = scene(kind, &format!("{sheet}{obstacle}"));
        let tops = ["implicit-euler", "xpbd", "pd"].map(|name| {
            let (state, end) = run(&scene, name, &[], 40);
            assert!(end.mesh.unwrap().triangles().len() < 288);
            let mut whole = scene.clone();
            whole.changes.clear();
            let (without, _) = run(&whole, name, &[], 40);
            [state, without].map(|state| state.positions.iter().map(|x| x.z).fold(0.0, f64::max))
        });
        // The top of the ball is at −0.15 + 0.8 · 0.4 + 0.1 m.
        for [torn, whole] in tops {
            let is_same = (torn - whole).abs() < 2e-3;
            assert!(torn > 0.27 && is_same, "{kind}: {torn} {whole}");
        }
    }
}

/// Every format of the run has the same triangles in every frame; glTF scales what is torn out to nothing.
#[test]
fn a_gltf_animation_loses_what_is_torn_out() {
    let text = "dt = 0.01\nsteps = 8\n[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n[[pins]]\nselect = \"corners\"\n\
         [[event]]\ndo = \"tear\"\ntime = 0.03\nbox = [[0.3, 0.3, -1], [0.45, 0.45, 1]]\n\
         [[event]]\ndo = \"tear\"\ntime = 0.05\nbox = [[0.55, 0.55, -1], [0.7, 0.7, 1]]\n";
    let path = written("torn-export", text);
    let export = |format: &str| {
        let to = path.with_file_name(format!("torn-{format}"));
        let _ = std::fs::remove_dir_all(&to);
        let out = to.to_str().unwrap();
        let run = [
            "run",
            path.to_str().unwrap(),
            "--method",
            "xpbd",
            "--export",
            out,
        ];
        let ran = program(&[&run[..], &["--format", format]].concat());
        assert!(
            ran.status.success(),
            "{}",
            String::from_utf8_lossy(&ran.stderr)
        );
        to
    };
    let glb = crate::export::Glb::read(&export("gltf").join("run.glb"));
    let frames = export("obj");
    assert_eq!(glb.json["nodes"].as_array().unwrap().len(), 4);
    assert_eq!(
        glb.json["nodes"][0]["children"],
        serde_json::json!([1, 2, 3])
    );
    let sorted = |mut triangles: Vec<[u32; 3]>| {
        triangles.sort_unstable();
        triangles
    };
    let scale = |node: usize, time: f64| {
        let Some([times, scales]) = glb.stepped(node, "scale") else {
            return 1.0;
        };
        let place = times.iter().rposition(|&t| t <= time + 1e-6).unwrap();
        assert_eq!(scales[3 * place], scales[3 * place + 2]);
        scales[3 * place]
    };
    for frame in 0..=8 {
        let file = frames.join(format!("{frame:05}.obj"));
        let expected = cloth_core::mesh::io::read(&file).unwrap();
        let seen = (1..4).filter(|&node| scale(node, 0.01 * f64::from(frame)) == 1.0);
        let corners = seen.map(|node| glb.corners(&glb.mesh_of(node)["primitives"][0]));
        let triangles = corners.collect::<Vec<_>>().concat();
        let triangles = triangles.as_chunks::<3>().0.to_vec();
        assert_eq!(
            sorted(triangles),
            sorted(expected.triangles().to_vec()),
            "{frame}"
        );
    }
    for node in 2..4 {
        assert_eq!(
            glb.animation(node, "weights").unwrap(),
            glb.animation(1, "weights").unwrap()
        );
    }
}

#[test]
fn what_cannot_be_torn_is_said_with_the_reason() {
    let tear =
        "[[mesh]]\ngenerator = \"grid:9x9:alternating\"\n[[event]]\ndo = \"tear\"\ntime = 1\n";
    for (name, more, line, words) in [
        (
            "level",
            "box = [[0.37, 0.37, -1], [0.51, 0.51, 1]]\n[cloth]\nlevel = 1\n",
            8,
            "a coarse level of links is for a whole mesh",
        ),
        (
            "corner",
            "box = [[0, 0, -1], [0.2, 0.2, 1]]\n",
            6,
            "would be left without a triangle: a box may be no wider",
        ),
        (
            "border",
            "line = [[-1, 0.01, 0], [2, 0.01, 0]]\n",
            6,
            "would be left without a triangle: move the line",
        ),
    ] {
        refused(name, &format!("{tear}{more}"), line, words);
    }
}
