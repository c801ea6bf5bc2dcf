//! `stiffness = inf`: springs as hard constraints of XPBD, with the compliance 0.

use cloth_bench::method::{METHODS, Method};
use cloth_bench::run::{Summary, from_start, to_rest};
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;
use cloth_core::particles::State;
use std::path::PathBuf;

fn read(name: &str, text: &str) -> Result<Scene, String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("hard-constraints");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, text).unwrap();
    file::build(&path, &Settings::default()).map_err(|error| error.to_string())
}

fn ran(scene: &Scene, settings: &[&str], steps: u32) -> (Summary, State) {
    let settings = Settings::parse(settings).unwrap();
    let method = Method::find("xpbd").unwrap();
    from_start(scene, method, &settings, scene.dt, steps, |_, _, _| Ok(())).unwrap()
}

/// A pendulum of 1 m that starts level: its length stays, and its speed is that of free fall from the same height.
#[test]
fn link_keeps_its_length_and_gives_its_height_for_speed() {
    let text = "dt = 0.01\n[chain]\nn = 1\nlink = 1\nmass = 0.3\ntip_mass = 0.3\nstiffness = ";
    let hard = read("pendulum", &format!("{text}inf\n")).unwrap();
    let (summary, end) = ran(&hard, &["substeps=400"], 40);
    let length = (end.positions[1] - end.positions[0]).norm();
    assert!((length - 1.0).abs() < 1e-7, "{length}");
    let drop = hard.start.positions[1].z - end.positions[1].z;
    let speed = end.velocities[1].norm();
    let exact = (2.0 * 9.81 * drop).sqrt();
    assert!(drop > 0.5, "it swings: {drop}");
    assert!((speed / exact - 1.0).abs() < 2e-3, "{speed} {exact}");
    assert_eq!(summary.elastic_energy, 0.0);
    assert!(summary.energy_excess < 1e-3 * summary.energy_given);
    // A spring of 1000 N/m is stretched by what swings on it.
    let soft = read("soft", &format!("{text}1e3\n")).unwrap();
    let (_, end) = ran(&soft, &["substeps=400"], 40);
    assert!((end.positions[1] - end.positions[0]).norm() > 1.0 + 1e-3);
}

/// What is left of stretch in a sheet is what the sweeps have left: four times as many substeps leave at most a fifth.
#[test]
fn sheet_stretches_by_no_more_than_the_sweeps_leave() {
    let text = "dt = 0.01\n[[mesh]]\ngenerator = \"grid:9x9:alternating\"\n[[pins]]\nselect = \"corners\"\n\
                [cloth]\nstiffness = inf\n";
    let scene = read("sheet", text).unwrap();
    let [few, many] = ["substeps=25", "substeps=100"].map(|set| ran(&scene, &[set], 60).0);
    println!("{} {}", few.rms_strain, many.rms_strain);
    assert!(many.rms_strain < 0.2 * few.rms_strain && many.rms_strain < 1e-3);
    assert!(many.energy_excess < 0.01 * many.energy_given);
}

#[test]
fn other_methods_and_other_elements_are_refused_with_a_reason() {
    let sheet = "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n[cloth]\nstiffness = inf\n";
    let scene = read("refused", sheet).unwrap();
    for method in METHODS.iter().filter(|method| method.name != "xpbd") {
        let built = method.build(&scene, &Settings::default(), scene.dt);
        let said = built
            .err()
            .map(|error| error.to_string())
            .unwrap_or_default();
        let expected = format!("`{}` cannot take stiffness=inf: ", method.name);
        assert!(said.contains(&expected), "{}: {said}", method.name);
    }
    let linked = "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n\
                  [[link]]\nmeshes = [0, 0]\nfirst = [0]\nsecond = [4]\n";
    for (cloth, words) in [
        ("", "links without a finite stiffness"),
        ("[cloth]\nstiffness = inf\n", "stiffness=inf: "),
    ] {
        let scene = read("linked", &format!("{linked}{cloth}")).unwrap();
        let built = Method::find("pd")
            .unwrap()
            .build(&scene, &Settings::default(), scene.dt);
        let said = built.err().unwrap().to_string();
        assert!(
            said.contains(&format!("`pd` cannot take {words}")),
            "{said}"
        );
    }
    for other in [
        "membrane = \"stvk\"",
        "shear = 10",
        "bending = \"spring\"",
        "slack = [0.9, 1.1]",
    ] {
        let said = read("beside", &format!("{sheet}{other}\n")).unwrap_err();
        let words = "beside.toml: line 4: stiffness=inf is of one spring on every edge";
        assert!(said.contains(words), "{said}");
    }
    for wrong in ["stiffness = -inf", "stiffness = nan"] {
        let said = read("wrong", &sheet.replace("stiffness = inf", wrong)).unwrap_err();
        assert!(said.contains("wrong.toml: line 4: stiffness is "), "{said}");
    }
    let rigid = sheet.replace("stiffness = inf", "rigidity = inf");
    let said = read("rigid", &rigid).unwrap_err();
    assert!(
        said.contains("rigid.toml: line 4: rigidity is `inf`"),
        "{said}"
    );
}

/// A chain of 1 m and ten links between two supports at the same height: depth of its middle, of rigid links by
/// bisection of the horizontal tension, for every link spans l(H, V)/T.
fn rigid_depth(span: f64, weight: f64) -> f64 {
    let pulls = [4.5, 3.5, 2.5, 1.5, 0.5].map(|count| count * weight);
    let along = |h: f64, of: fn(f64, f64) -> f64| -> f64 {
        pulls.iter().map(|v| 0.1 * of(h, *v) / h.hypot(*v)).sum()
    };
    let (mut low, mut high) = (0.0, 1e3);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        match along(middle, |h, _| h) < 0.5 * span {
            true => low = middle,
            false => high = middle,
        }
    }
    along(low, |_, v| v)
}

/// The stiffer its springs, the nearer is a chain at rest to the one of rigid links: the error of its depth is as 1/k,
/// through every method that shows the stiffness that it is given. Of XPBD the sweeps, which pull along where the links
/// were, leave more, as the square of the substep: 1.1e-4 m in one of 0.01 s, 3e-7 m in a twentieth of it.
#[test]
fn every_method_nears_rigid_links_as_one_over_k() {
    let (span, mass) = (0.8, 0.05);
    let place = |i: u32| {
        let s = f64::from(i) / 10.0;
        Vec3::new(span * s, 0.0, -s * (1.0 - s))
    };
    let exact = rigid_depth(span, mass * 9.81);
    let error = |(name, settings): (&str, &str), stiffness: f64| {
        let text = format!(
            "[chain]\nn = 10\nlink = 0.1\nmass = {mass}\ntip_mass = {mass}\nstiffness = {stiffness}\n"
        );
        let mut scene = read("supports", &text).unwrap();
        scene.model.particles.prescribe(10).unwrap();
        scene.start.positions = (0..=10).map(place).collect();
        let settings: Vec<&str> = settings.split_whitespace().collect();
        let settings = Settings::parse(&settings).unwrap();
        let method = Method::find(name).unwrap();
        let mut solver = method.build(&scene, &settings, 0.01).unwrap();
        let mut state = scene.start.clone();
        let rest = to_rest(&scene, &mut *solver, &mut state, 0.01, 20_000, 1e-7).unwrap();
        assert!(
            rest.is_some(),
            "{name} at {stiffness} N/m does not come to rest"
        );
        -state.positions[5].z - exact
    };
    for method in [
        ("symplectic-euler", "air_drag=10"),
        ("implicit-euler", "tolerance=1e-8"),
        ("bdf2", "tolerance=1e-8"),
        ("linear-implicit", ""),
        ("xpbd", "substeps=20 iterations=20"),
        ("xpbd-direct", ""),
        ("pd", "iterations=100"),
    ] {
        let errors = [1e3, 1e4, 1e5].map(|stiffness| error(method, stiffness));
        println!("{method:?} {errors:?}");
        let ratios = [errors[0] / errors[1], errors[1] / errors[2]];
        assert!((ratios[1] - 10.0).abs() < 0.2, "{method:?}: {errors:?}");
        assert!((ratios[0] - 10.0).abs() < 1.0, "{method:?}: {errors:?}");
    }
    let hard = error(("xpbd", "substeps=20 iterations=200"), f64::INFINITY);
    assert!(hard.abs() < 5e-7, "{hard:e}");
}
