//! Cloth that starts inside a body is refused before the first step; one nearer than the thickness is warned of.

use crate::exact_runs;
use crate::program::program;
use crate::scene_text::{scene, written};
use cloth_bench::method::{METHODS, Method};
use cloth_bench::run::{self, from_start};
use cloth_bench::scene::file;
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;
use cloth_core::mesh::ply::{self, Encoding};
use cloth_core::mesh::{generate, obj};

/// What is said of a start, if it is refused.
fn refused(name: &str, text: &str) -> Option<String> {
    let scene = scene(&format!("start-{name}"), text);
    let said = ["pd", "xpbd", "symplectic-euler"].map(|method| {
        let method = Method::find(method).unwrap();
        let ran = from_start(
            &scene,
            method,
            &Settings::default(),
            scene.dt,
            1,
            |_, _, _| Ok(()),
        );
        ran.err()
            .map(|error| (error.exit_code(), error.to_string()))
    });
    assert!(said.iter().all(|other| *other == said[0]), "{said:?}");
    let [said, ..] = said;
    said.map(|(code, message)| {
        assert_eq!(code, 2, "{message}");
        message
    })
}

const SHEET: &str = "[[mesh]]\ngenerator = \"grid:11x11:alternating\"\nscale = 0.2\n";

#[test]
fn a_start_inside_a_body_is_refused_with_body_vertex_and_depth() {
    let above = "[[obstacle]]\nshape = \"plane\"\nposition = [0, 0, -3]\n";
    let sheet = |z: f64| format!("{SHEET}translate = [-0.1, -0.1, {z}]\n{above}[[obstacle]]\n");
    let turned = 0.3_f64;
    // The middle of a sphere is (0, 0, 0); the lowest corner below a plane that is turned about x.
    let deepest = 0.1 * turned.sin() - 1e-3 * turned.cos();
    for (name, z, body, kind, count, vertex, depth) in [
        (
            "in-sphere",
            0.1,
            "shape = \"sphere\"\nradius = 0.4\n".into(),
            "sphere",
            121,
            60,
            0.3,
        ),
        (
            "in-box",
            0.03,
            "shape = \"box\"\nsize = [0.3, 0.3, 0.1]\n".into(),
            "box",
            121,
            0,
            0.02,
        ),
        (
            "below-plane",
            1e-3,
            format!("shape = \"plane\"\nrotate = [{turned}, 0, 0]\n"),
            "plane",
            55,
            110,
            deepest,
        ),
        (
            "in-mesh",
            0.0,
            "shape = \"mesh\"\ngenerator = \"sphere:8\"\nscale = 2\n".into(),
            "mesh",
            121,
            60,
            f64::NAN,
        ),
    ] {
        let said = refused(name, &format!("{}{body}", sheet(z))).unwrap();
        let whole = format!(
            "inside obstacle 1 ({kind}), with {count} of its vertices: the deepest is vertex {vertex}, at"
        );
        assert!(said.contains(&whole), "{said}");
        let expected = format!("{depth:.3e} m below the surface");
        assert!(
            depth.is_nan() || said.contains(&expected),
            "{expected}: {said}"
        );
        let advised =
            "the thickness of 0.002 m away (translate of its [[mesh]]), or hold what is to stay";
        assert!(said.contains(advised), "{said}");
        assert!(!said.contains("untangle=yes"), "{said}");
        // What untangling cannot serve: no triangle of the cloth goes through one of the body.
        let text = format!(
            "{}{body}[contact]\nself = true\nuntangle = true\n",
            sheet(z)
        );
        let said = refused(&format!("{name}-untangled"), &text).unwrap();
        assert!(said.contains(&whole), "{said}");
        // Held vertices may be anywhere.
        let held = "[[pins]]\nbox = [[-1, -1, -1], [1, 1, 1]]\n";
        assert_eq!(
            refused(
                &format!("{name}-held"),
                &format!("{}{body}{held}", sheet(z))
            ),
            None
        );
        let off = "[contact]\ncontact = \"none\"\n";
        assert_eq!(
            refused(&format!("{name}-off"), &format!("{}{body}{off}", sheet(z))),
            None
        );
    }
}

/// The vertex has the number that it has in its file, though it is another one in memory.
#[test]
fn the_deepest_vertex_has_the_number_of_its_file() {
    let grid = generate::grid(7, 7, 1.0, 1.0, generate::Diagonals::Alternating).unwrap();
    let path = written(
        "by-number",
        "[[mesh]]\nfile = \"by-number.obj\"\n[[obstacle]]\nshape = \"plane\"\nposition = [0, 0, -0.05]\n",
    );
    for low in [5, 23, 47] {
        let mut x = grid.positions().to_vec();
        x[low] -= Vec3::z() * 0.06;
        std::fs::write(
            path.with_extension("obj"),
            obj::format(&x, grid.triangles()),
        )
        .unwrap();
        let out = program(&["run", path.to_str().unwrap(), "--method", "pd"]);
        let said = String::from_utf8(out.stderr).unwrap();
        assert_eq!(out.status.code(), Some(2), "{said}");
        let expected = format!("with 1 of its vertices: the deepest is vertex {low}, at");
        assert!(
            said.contains(&expected) && said.contains("1.000e-2 m below"),
            "{said}"
        );
    }
}

/// At rest on a floor the potential holds ½ (ρ g)²/κ per area, and that is a part of the potential energy.
#[test]
fn a_sheet_at_rest_holds_the_energy_of_its_contact() {
    let (pressure, stiffness, area) = (0.2 * 9.81, 1e6_f64, 0.04);
    let gap = 4e-3 - pressure / stiffness;
    let floor = "[contact]\nthickness = 4e-3\n[[obstacle]]\nshape = \"plane\"\n";
    let text = format!("{SHEET}translate = [0, 0, {gap:?}]\n{floor}");
    let scene = scene("start-at-rest", &text);
    let expected = 0.5 * pressure * pressure / stiffness * area;
    // Forward Euler is not stable, and the midpoint rule does not rest.
    let restless = ["explicit-euler", "implicit-midpoint"];
    for method in METHODS
        .iter()
        .filter(|method| !restless.contains(&method.name))
    {
        let (summary, _) = exact_runs::run(&scene, method.name, &[], 2);
        let off = summary.contact_energy / expected - 1.0;
        assert!(off.abs() < 1e-9, "{}: {off:e}", method.name);
        let rest = summary.elastic_energy + summary.gravity_energy;
        let sum = rest + summary.contact_energy - summary.potential_energy;
        assert!(sum.abs() < 1e-12 * expected, "{}: {sum:e} J", method.name);
    }
}

/// A sheet of an area A at a distance d above a floor holds ½ k (h − d)² A, or k t² (½ − ln(d/t)) A below t = h/2.
#[test]
fn a_start_nearer_than_the_thickness_is_told_with_its_energy() {
    let floor = "[contact]\nthickness = 4e-3\n[[obstacle]]\nshape = \"plane\"\n";
    let (stiffness, area) = (1e6_f64, 0.04);
    let near = 0.5 * stiffness * 1e-3_f64.powi(2) * area;
    let deep = stiffness * 2e-3_f64.powi(2) * (0.5 - 0.25_f64.ln()) * area;
    for (name, z, expected) in [
        ("near", 3e-3, near),
        ("deep", 5e-4, deep),
        ("far", 4e-3, 0.0),
    ] {
        let text = format!("dt = 0.01\n{SHEET}translate = [0, 0, {z}]\n{floor}");
        let scene = scene(&format!("start-{name}"), &text);
        for method in ["implicit-euler", "pd", "xpbd"] {
            let (summary, _) = exact_runs::run(&scene, method, &[], 1);
            let told = summary.contact_energy_at_start;
            assert!((told - expected).abs() < 1e-12, "{name} {method}: {told}");
            let warning = summary.start_warning();
            assert_eq!(warning.is_some(), z < 4e-3, "{name} {method}: {warning:?}");
            if let Some(warning) = warning {
                // The mass is 0.2 kg/m² times the area.
                let lift = expected / (9.81 * 0.2 * area);
                let lift = format!("a method without damping gives back as {lift:.3} m of height");
                assert!(warning.contains(&lift), "{warning}");
            }
        }
    }
    // On the floor it would hold infinite energy.
    let said = refused("on", &format!("{SHEET}{floor}")).unwrap();
    assert!(
        said.contains("starts on the surface of obstacle 0 (plane), with 121 of its vertices")
            && said.contains("start it outside, the thickness of 0.004 m away"),
        "{said}"
    );
    assert!(!said.contains("untangle"), "{said}");
    let top = "[[obstacle]]\nshape = \"box\"\nsize = [1, 1, 0.1]\nposition = [0, 0, -0.05]\n";
    // Of a sheet that goes beyond the top untangling pulls out what is on it.
    for (scale, is_served) in [(1, false), (10, true)] {
        let sheet = format!("{SHEET}translate = [-0.1, -0.1, 0]\n")
            .replace("0.2", &format!("{}", 0.2 * f64::from(scale)));
        let said = refused(&format!("on-top-{scale}"), &format!("{sheet}{top}")).unwrap();
        assert!(
            said.contains("starts on the surface of obstacle 0 (box)"),
            "{said}"
        );
        assert_eq!(said.contains("untangle=yes"), is_served, "{said}");
    }
}

/// A sheet that has come to rest, exported and read in again as the start, stays at rest, and its pins where they are.
#[test]
fn a_run_goes_on_from_an_exported_step() {
    let mesh = generate::irregular(9, 0.4, 0.3, 3).unwrap();
    let file = written("start-mesh", "").with_extension("obj");
    obj::write(&file, mesh.positions(), mesh.triangles()).unwrap();
    let text = format!(
        "dt = 0.01\n[[mesh]]\nfile = {file:?}\n[[pins]]\nselect = \"corners\"\nmove = [0, 0.02, 0]\nduration = 0.05\n"
    );
    let first = scene("start-first", &text);
    let settings = Settings::default().with("tolerance", 1e-9);
    let method = Method::find("implicit-euler").unwrap();
    let mut solver = method.build(&first, &settings, 0.01).unwrap();
    let mut state = first.start.clone();
    run::to_rest(&first, &mut *solver, &mut state, 0.01, 4000, 1e-9).unwrap();
    let order = first.order.as_ref().unwrap();
    let moved = order.restore(&state.positions);
    let end = file.with_file_name("start-end.obj");
    obj::write(&end, &moved, mesh.triangles()).unwrap();
    let still = text.replace("move = [0, 0.02, 0]\nduration = 0.05\n", "");
    let second = scene(
        "start-second",
        &format!("{still}[start]\npositions = {end:?}\n"),
    );
    let mut solver = method.build(&second, &settings, 0.01).unwrap();
    let mut state = second.start.clone();
    run::run(
        &second,
        &mut *solver,
        &mut state,
        0.01,
        20,
        |_, _, _| Ok(()),
    )
    .unwrap();
    for (x, start) in state.positions.iter().zip(&second.start.positions) {
        assert!((x - start).norm() < 1e-8, "{x} for {start}");
    }
    let wrong = format!("{SHEET}[start]\npositions = {end:?}\n");
    let error = file::build(&written("start-wrong", &wrong), &Settings::default()).unwrap_err();
    assert!(
        error.to_string().contains("vertices, but the meshes have"),
        "{error}"
    );
}

/// Vertices inside a solid are in no triangle of its surface, and are read all the same.
#[test]
fn the_exported_step_of_a_solid_is_a_start() {
    let text = "[[mesh]]\ngenerator = \"ball:3\"\n[mesh.solid]\ndensity = 300\nmodulus = 1e4\npoisson = 0.3\n\
                [start]\n";
    let first = scene(
        "start-solid-first",
        &format!("{text}velocity = [0, 0, 1]\n"),
    );
    let method = Method::find("implicit-euler").unwrap();
    let ran = from_start(&first, method, &Settings::default(), 0.01, 3, |_, _, _| {
        Ok(())
    });
    let end = ran.unwrap().1.positions;
    let mesh = first.mesh.as_ref().unwrap();
    for ending in ["obj", "ply"] {
        let file = written("start-solid-end", "").with_extension(ending);
        match ending {
            "obj" => obj::write(&file, &end, mesh.triangles()).unwrap(),
            _ => ply::write(&file, &end, mesh.triangles(), Encoding::Ascii).unwrap(),
        }
        let second = scene(
            "start-solid-second",
            &format!("{text}positions = {file:?}\n"),
        );
        assert_eq!(second.start.positions, end, "{ending}");
    }
}
