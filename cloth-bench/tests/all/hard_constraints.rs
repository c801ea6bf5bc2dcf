//! `stiffness = inf`: springs as hard constraints of XPBD, with the compliance 0.

use cloth_bench::method::{METHODS, Method};
use cloth_bench::run::{Summary, from_start};
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
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
