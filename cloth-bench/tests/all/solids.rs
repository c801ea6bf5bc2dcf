//! Solids in scene files: what they weigh, how far they stretch and how hard they press is known.

use crate::exact_runs::refused;
use crate::rigid_bodies::watch;
use crate::scene_text::{scene, written};
use cloth_bench::method::{METHODS, Method};
use cloth_bench::run::{Moment, simulate};
use cloth_bench::scene::Scene;
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;

/// A bar of 0.1 × 0.1 × 0.4 m that hangs by its upper end.
fn bar(name: &str, generator: &str, density: f64, poisson: f64, more: &str) -> Scene {
    let text = format!(
        "dt = 0.01\n[[mesh]]\ngenerator = \"{generator}\"\nscale = 0.1\ntranslate = [0, 0, -0.4]\n\
         [mesh.solid]\ndensity = {density:?}\nmodulus = 4e4\npoisson = {poisson:?}\n\
         [[pins]]\nbox = [[-1, -1, -0.0001], [1, 1, 1]]\n[contact]\ncontact = \"none\"\n{more}"
    );
    scene(name, &text)
}

/// Where it comes to rest, with velocities taken away whenever they have grown.
fn at_rest(scene: &Scene, method: &str, settings: &[&str]) -> Vec<Vec3> {
    let (method, settings) = (
        Method::find(method).unwrap(),
        Settings::parse(settings).unwrap(),
    );
    let mut solver = method.build(scene, &settings, scene.dt).unwrap();
    let mut state = scene.start.clone();
    let rest = cloth_bench::run::to_rest(scene, &mut *solver, &mut state, scene.dt, 3000, 1e-6);
    assert!(rest.unwrap().is_some(), "{}: at rest", method.name);
    state.positions
}

/// How far the lower end has come down on average (m).
fn drop(scene: &Scene, x: &[Vec3]) -> f64 {
    let start = &scene.start.positions;
    let lowest = start.iter().map(|x| x.z).fold(0.0, f64::min);
    let ends: Vec<usize> = (0..start.len())
        .filter(|&v| start[v].z < lowest + 1e-9)
        .collect();
    ends.iter().map(|&v| start[v].z - x[v].z).sum::<f64>() / ends.len() as f64
}

/// Hung up by one end, a bar stretches by its own weight: ρ g L²/(2E). For ν = 0 that is so up to the masses of
/// vertices, which differ in a layer: less so with finer tetrahedra, and the same with every method that has come to
/// rest.
#[test]
fn a_hanging_bar_stretches_by_its_own_weight() {
    let law = 1000.0 * 9.81 * 0.4 * 0.4 / (2.0 * 4e4);
    let error = |generator: &str, poisson: f64| {
        let scene = bar("bar", generator, 1000.0, poisson, "");
        let x = at_rest(&scene, "implicit-euler", &["tolerance=1e-9"]);
        (drop(&scene, &x) / law - 1.0).abs()
    };
    let [coarse, fine] = ["block:2x2x8", "block:4x4x16"].map(|generator| error(generator, 0.0));
    println!("ν = 0: {coarse:e} {fine:e}");
    assert!(coarse < 1e-3 && fine < 0.4 * coarse, "{coarse:e} {fine:e}");
    // With another ν the held end, which cannot become narrower, is stiffer, by a part of the width over the length.
    let [coarse, fine] = ["block:1x1x4", "block:4x4x16"].map(|generator| error(generator, 0.3));
    println!("ν = 0.3: {coarse} {fine}");
    assert!(fine < 0.03 && fine < 0.5 * coarse, "{coarse} {fine}");

    let scene = bar("bar", "block:2x2x8", 1000.0, 0.0, "");
    let x = at_rest(&scene, "implicit-euler", &["tolerance=1e-9"]);
    for (method, settings, bound) in [
        ("linear-implicit", &[][..], 1e-5),
        ("bdf2", &["tolerance=1e-9"], 1e-5),
        ("xpbd", &["substeps=100"], 1e-3),
        ("pd", &["tolerance=1e-7", "most_iterations=2000"], 1e-4),
        ("symplectic-euler", &[], 1e-3),
    ] {
        let own = at_rest(&scene, method, settings);
        let apart = x
            .iter()
            .zip(&own)
            .map(|(a, b)| (a - b).norm())
            .fold(0.0, f64::max);
        println!("{method}: {:e}", apart / law);
        assert!(apart < bound * law, "{method}: {apart:e}");
    }
}

/// Pulled by a known weight at its end, a bar becomes longer by σ/E and narrower by ν of that, and its volume grows by
/// σ/(3K), K = E/(3(1 − 2ν)) its bulk modulus: all measured in the middle, far from the ends, of which one is held.
/// There the lower half of the bar weighs too.
#[test]
fn a_pulled_bar_keeps_the_volume_that_its_bulk_modulus_says() {
    let (nu, stress) = (0.4, 100.0);
    let mass = stress * 0.01 / 9.81;
    let weight = format!("[[mass]]\nbox = [[-1, -1, -1], [1, 1, -0.3999]]\nmass = {mass:?}\n");
    let scene = bar("pulled", "block:4x4x16", 1.0, nu, &weight);
    let x = at_rest(&scene, "implicit-euler", &["tolerance=1e-10"]);
    let start = &scene.start.positions;
    let size = |x: &[Vec3], axis: usize| {
        let among = |v: &usize| (-0.25 - 1e-9..-0.15 + 1e-9).contains(&start[*v].z);
        let chosen: Vec<usize> = (0..x.len()).filter(among).collect();
        let end = |sign: f64| {
            let edge = chosen
                .iter()
                .map(|&v| sign * start[v][axis])
                .fold(f64::MIN, f64::max);
            let at = |v: &&usize| (sign * start[**v][axis] - edge).abs() < 1e-9;
            let ends: Vec<f64> = chosen.iter().filter(at).map(|&v| x[v][axis]).collect();
            ends.iter().sum::<f64>() / ends.len() as f64
        };
        end(1.0) - end(-1.0)
    };
    let strains = [0, 1, 2].map(|axis| size(&x, axis) / size(start, axis) - 1.0);
    let law = (stress + 9.81 * 0.2) / 4e4;
    println!("{strains:?} {law}");
    assert!((strains[2] / law - 1.0).abs() < 5e-3, "{strains:?}");
    for side in &strains[..2] {
        assert!((side / (-nu * law) - 1.0).abs() < 5e-3, "{strains:?}");
    }
    let volume: f64 = strains.iter().map(|e| 1.0 + e).product();
    let grown = (1.0 - 2.0 * nu) * law;
    assert!(
        ((volume - 1.0) / grown - 1.0).abs() < 0.01,
        "{volume} {grown}"
    );
}

/// A block that falls on the floor comes to rest there: the floor carries its weight, and it is pressed by half of that
/// on average.
#[test]
fn a_block_rests_on_the_floor_with_its_weight() {
    let text = "dt = 0.01\n[[mesh]]\ngenerator = \"block:3x3x3\"\nscale = 0.1\ntranslate = [0, 0, 0.01]\n\
         [mesh.solid]\ndensity = 500\nmodulus = 2e4\npoisson = POISSON\n[[obstacle]]\nshape = \"plane\"\n";
    let weight = 500.0 * 0.001 * 9.81;
    for (method, settings, poisson) in [
        ("implicit-euler", &[][..], "0.3"),
        ("bdf2", &[], "0.3"),
        ("linear-implicit", &[], "0.3"),
        ("xpbd", &["substeps=20", "damping=0.01"], "0.3"),
        ("pd", &[], "0"),
        (
            "symplectic-euler",
            &["stiffness_damping=0.005", "substeps=60"],
            "0.3",
        ),
    ] {
        let scene = scene(
            &format!("floor-{method}"),
            &text.replace("POISSON", poisson),
        );
        let mass: f64 = scene.model.particles.mass().iter().sum();
        assert!((mass / 0.5 - 1.0).abs() < 1e-12);
        let (mut forces, mut lowest) = (Vec::new(), f64::INFINITY);
        watch(&scene, method, settings, 200, |moment: &Moment<'_>| {
            let normal = &moment.forces.unwrap().normal;
            forces.push(normal.iter().map(|f| f.z).sum::<f64>());
            let heights = moment.state.positions.iter().map(|x| x.z);
            lowest = heights.fold(lowest, f64::min);
        });
        let late: f64 = forces[150..].iter().sum::<f64>() / 50.0;
        println!("{method}: {late} of {weight}, {lowest}");
        assert!(
            (late / weight - 1.0).abs() < 0.02,
            "{method}: {late} of {weight}"
        );
        assert!(lowest > 0.0, "{method}: {lowest}");
    }
}

/// Every method takes a solid, or says what it cannot take.
#[test]
fn every_method_takes_a_solid_or_says_why_not() {
    let text = "[[mesh]]\ngenerator = \"ball:2\"\nscale = 0.2\n[mesh.solid]\nmodulus = 1e4\npoisson = POISSON\n";
    for poisson in ["0", "0.3"] {
        let scene = scene("any", &text.replace("POISSON", poisson));
        let count = scene.mesh.as_ref().unwrap().vertex_count();
        assert_eq!(count, 1 + 12 + 42);
        // Forward Euler refuses every step.
        for method in METHODS.iter().filter(|m| m.name != "explicit-euler") {
            let name = method.name;
            let ran = simulate(&scene, method, &Settings::default(), scene.dt, 5);
            if (name, poisson) == ("pd", "0.3") {
                let error = ran.unwrap_err().to_string();
                assert!(
                    error.contains("`pd` cannot take tetrahedra with a volume"),
                    "{error}"
                );
                assert!(error.contains("poisson = 0"), "{error}");
                continue;
            }
            let (_, state) = ran.unwrap();
            // It falls and keeps its shape.
            let moved: Vec<Vec3> = state
                .positions
                .iter()
                .zip(&scene.start.positions)
                .map(|(a, b)| a - b)
                .collect();
            let apart = moved
                .iter()
                .map(|d| (d - moved[0]).norm())
                .fold(0.0, f64::max);
            assert!(moved[0].z < -0.01 && apart < 1e-9, "{name}: {apart:e}");
        }
    }
    let scene = scene("any", &text.replace("POISSON", "0"));
    let set = Settings::parse(&["hierarchy=once"]).unwrap();
    let error = simulate(&scene, Method::find("pbd").unwrap(), &set, scene.dt, 1).unwrap_err();
    assert!(
        error.to_string().contains("cannot be with a solid"),
        "{error}"
    );
}

/// A sheet and a solid in one scene, with the vertices of a file in any order: the same as from the generator.
#[test]
fn a_solid_from_a_file_is_the_one_of_its_generator() {
    let solid = cloth_core::mesh::generate::block([2, 2, 2], Vec3::repeat(1.0)).unwrap();
    let x = solid.surface().positions();
    let mut msh = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n",
        x.len()
    );
    for (v, x) in x.iter().enumerate() {
        msh += &format!("{} {:?} {:?} {:?}\n", v + 1, x.x, x.y, x.z);
    }
    msh += &format!("$EndNodes\n$Elements\n{}\n", solid.tetrahedra().len());
    for (n, t) in solid.tetrahedra().iter().enumerate() {
        let [a, b, c, d] = t.map(|v| v + 1);
        msh += &format!("{} 4 2 0 1 {a} {b} {c} {d}\n", n + 1);
    }
    msh += "$EndElements\n";
    let path = written("block", "").with_file_name("block.msh");
    std::fs::write(path, msh).unwrap();
    let text = |source: &str| {
        format!(
            "[[mesh]]\ngenerator = \"grid:3x3:crossed\"\ntranslate = [0, 0, -0.5]\n[[mesh]]\n{source}\nscale = 0.3\n\
             [mesh.solid]\n[[pins]]\nselect = \"corners\"\n"
        )
    };
    let ends = ["generator = \"block:2x2x2\"", "file = \"block.msh\""].map(|source| {
        let scene = scene("from-file", &text(source));
        let method = Method::find("implicit-euler").unwrap();
        let settings = Settings::parse(&["tolerance=1e-11"]).unwrap();
        let (_, state) = simulate(&scene, method, &settings, scene.dt, 5).unwrap();
        let order = scene.order;
        order.map_or(state.positions.clone(), |order| {
            order.restore(&state.positions)
        })
    });
    for (a, b) in ends[0].iter().zip(&ends[1]) {
        assert!((a - b).norm() < 1e-9, "{a} {b}");
    }
}

/// A ball joint carries one solid below another: its links keep their length, and what hangs there does not fall.
#[test]
fn a_joint_carries_a_solid_below_another_one() {
    let block = "[[mesh]]\ngenerator = \"block:2x2x2\"\nscale = 0.1\n";
    let text = format!(
        "dt = 0.01\n{block}[mesh.solid]\n{block}translate = [0, 0, -0.11]\n[mesh.solid]\n\
         [[link]]\nmeshes = [0, 1]\nat = [0.05, 0.05, -0.01]\n[[pins]]\nbox = [[-1, -1, 0.09], [1, 1, 1]]\n"
    );
    let scene = scene("jointed", &text);
    let links: Vec<_> = scene.model.all_springs().copied().collect();
    assert_eq!(links.len(), 3);
    let method = Method::find("xpbd").unwrap();
    let (_, state) = simulate(&scene, method, &Settings::default(), scene.dt, 60).unwrap();
    for link in links {
        let [a, b] = link.vertices.map(|v| state.positions[v as usize]);
        let error = ((a - b).norm() / link.rest_length - 1.0).abs();
        assert!(error < 1e-3, "{error:e}");
    }
    let lowest = state.positions.iter().map(|x| x.z).fold(0.0, f64::min);
    assert!((-0.125..-0.1).contains(&lowest), "{lowest}");
}

#[test]
fn what_is_no_solid_is_refused_with_its_line() {
    let block = "[[mesh]]\ngenerator = \"block:2x2x2\"\n";
    let solid = format!("{block}[mesh.solid]\n");
    for (name, text, line, words) in [
        (
            "bare",
            block.to_owned(),
            2,
            "tetrahedra are for a [[mesh]] with",
        ),
        (
            "sheet",
            "[[mesh]]\ngenerator = \"grid:3x3:crossed\"\n[mesh.solid]\n".into(),
            2,
            "a solid is made of tetrahedra",
        ),
        (
            "obj",
            "[[mesh]]\nfile = \"a.obj\"\n[mesh.solid]\n".into(),
            2,
            "a solid is made of tetrahedra",
        ),
        (
            "msh",
            "[[mesh]]\nfile = \"a.msh\"\n".into(),
            2,
            "tetrahedra are for a [[mesh]] with",
        ),
        (
            "missing",
            "[[mesh]]\nfile = \"none.msh\"\n[mesh.solid]\n".into(),
            2,
            "none.msh: the file cannot be read",
        ),
        (
            "form",
            "[[mesh]]\ngenerator = \"block:2x2\"\n[mesh.solid]\n".into(),
            2,
            "those are block:NxMxK and ball:N",
        ),
        (
            "none",
            "[[mesh]]\ngenerator = \"ball:0\"\n[mesh.solid]\n".into(),
            2,
            "at least 1",
        ),
        ("poisson", format!("{solid}poisson = 0.5\n"), 4, "poisson"),
        ("density", format!("{solid}density = 0\n"), 4, "density"),
        (
            "gas",
            format!("{block}pressure = 10\n[mesh.solid]\n"),
            3,
            "for a solid",
        ),
        (
            "weld",
            format!("{block}weld = 0.1\n[mesh.solid]\n"),
            3,
            "for a solid",
        ),
        (
            "cloth",
            format!("{solid}[mesh.cloth]\ndensity = 1\n"),
            4,
            "has no meaning for a solid",
        ),
        (
            "air",
            format!("{solid}[air]\n"),
            4,
            "cannot be with [mesh.solid]",
        ),
        (
            "tear",
            format!("{solid}[[event]]\ntime = 1\ndo = \"tear\"\nbox = [[-1, -1, -1], [2, 2, 2]]\n"),
            7,
            "a solid is there, which cannot be torn",
        ),
    ] {
        refused(&format!("solid-{name}"), &text, line, words);
    }
}
