//! `[[force]]` of a scene file: it changes the momentum of the cloth by force times time, and nothing else does.

use cloth_bench::method::{METHODS, Method};
use cloth_bench::run::from_start;
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;
use std::path::PathBuf;

const DT: f64 = 1.0 / 240.0;

fn read(name: &str, text: &str) -> Result<Scene, String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("user-forces");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, text).unwrap();
    file::build(&path, &Settings::default()).map_err(|error| error.to_string())
}

const SHEET: &str =
    "gravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:5x5:alternating\"\nscale = 0.2\n";

/// Forward Euler has no stable step for an undamped cloth.
fn stable() -> impl Iterator<Item = &'static Method> {
    let all = METHODS.iter();
    all.filter(|method| method.name != "explicit-euler")
}

/// On all vertices a force is as good as gravity: the sheet falls as free fall by steps says.
#[test]
fn force_on_everything_is_free_fall() {
    let everything = "[[force]]\nbox = [[-1, -1, -1], [1, 1, 1]]\nforce = [0, 0.01, 0]\n";
    let scene = read("everything", &format!("{SHEET}{everything}")).unwrap();
    let mass: f64 = scene.model.particles.mass().iter().sum();
    for method in stable() {
        let settings = Settings::default();
        let steps = 20;
        let parts = method.substeps(&scene, &settings, DT).unwrap();
        let h = DT / f64::from(parts);
        let expected = 0.5 * 0.01 / mass * h * h * method.free_fall(steps * parts);
        let ran = from_start(&scene, method, &settings, DT, steps, |_, _, _| Ok(()));
        let (summary, end) = ran.unwrap();
        for (x, start) in end.positions.iter().zip(&scene.start.positions) {
            let off = (x - start - Vec3::y() * expected).norm();
            assert!(
                off < 1e-5 * expected,
                "{}: {off} of {expected}",
                method.name
            );
        }
        assert_eq!(summary.rebuilds, 0, "{}", method.name);
        assert!(
            summary.energy_excess < 1e-3 * summary.energy_given,
            "{}",
            method.name
        );
    }
}

/// Two forces on parts of a sheet, each for its own time: momentum is the sum of force times time.
#[test]
fn momentum_is_force_times_time() {
    let forces = format!(
        "[[force]]\nbox = [[-1, -1, -1], [0.11, 1, 1]]\nforce = [0, 0, 0.02]\nfrom = {}\nuntil = {}\n\
         [[force]]\nvertices = [0, 24]\nforce = [0.01, 0, 0]\nuntil = {}\n",
        5.0 * DT,
        15.0 * DT,
        8.0 * DT
    );
    let scene = read("parts", &format!("{SHEET}{forces}")).unwrap();
    let expected = Vec3::new(0.01 * 8.0 * DT, 0.0, 0.02 * 10.0 * DT);
    // Two-step differences remember the force for some steps after its end.
    for method in stable().filter(|method| method.name != "bdf2") {
        let settings = Settings::default();
        let (_, end) = from_start(&scene, method, &settings, DT, 20, |_, _, _| Ok(())).unwrap();
        let moving = end.velocities.iter().zip(scene.model.particles.mass());
        let momentum: Vec3 = moving.map(|(v, m)| v * *m).sum();
        let off = (momentum - expected).norm() / expected.norm();
        println!("{}: {off:e}", method.name);
        assert!(off < 1e-4, "{}: {momentum} {expected}", method.name);
    }
}

#[test]
fn forces_without_effect_are_refused() {
    let held = "[[pins]]\nbox = [[-1, -1, -1], [1, 1, 1]]\n";
    for (name, text, line, words) in [
        (
            "none",
            "[[force]]\nselect = \"corners\"\n".into(),
            5,
            "needs a force",
        ),
        (
            "zero",
            "[[force]]\nselect = \"corners\"\nforce = [0, 0, 0]\n".into(),
            7,
            "does nothing",
        ),
        (
            "times",
            "[[force]]\nselect = \"corners\"\nforce = [1, 0, 0]\nfrom = 2\nuntil = 1\n".into(),
            9,
            "later than from",
        ),
        (
            "held",
            format!("{held}[[force]]\nselect = \"corners\"\nforce = [1, 0, 0]\n"),
            7,
            "all of its vertices are held",
        ),
    ] {
        let text: String = text;
        let said = read(name, &format!("{SHEET}{text}")).unwrap_err();
        let place = format!("{name}.toml: line {line}: ");
        assert!(said.contains(&place) && said.contains(words), "{said}");
    }
    let released = format!("{held}until = 1\n[[force]]\nselect = \"corners\"\nforce = [1, 0, 0]\n");
    assert!(read("released", &format!("{SHEET}{released}")).is_ok());
}
