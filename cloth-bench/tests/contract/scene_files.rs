//! The scene files that ship: nothing crosses after any step, and no energy comes from nowhere.

use cloth_bench::method::Method;
use cloth_bench::run::{Plan, SeparationWatch, Solver, run_changing};
use cloth_bench::scene::file;
use cloth_bench::settings::Settings;
use cloth_bench::studies::variants::Variant;
use cloth_core::math::Real;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Scenes that a method has no elements for.
const REFUSED: [(&str, &str); 4] = [
    ("pd", "curtain"),
    ("pd", "ragdoll"),
    ("pd", "soft-ball"),
    ("implicit-euler", "ragdoll"),
];

/// Scenes that start tangled, and are pulled apart on the way.
const TANGLED: [&str; 2] = ["tangled", "pierced"];

/// Steps until every other scene has met what it falls on or is pulled over.
const STEPS: u32 = 20;

/// Dear ones that have met it by then.
const MET_SOON: [(&str, u32); 5] = [
    ("ball", 10),
    ("funnel", 8),
    ("gown", 10),
    ("tablecloth", 8),
    ("turning-sphere", 8),
];

/// What is nearer (m) than any thickness of theirs.
const MET: Real = 3.9e-3;

fn files() -> Vec<(String, PathBuf)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let scenes = paths.filter(|path| path.extension().is_some_and(|kind| kind == "toml"));
    let named = scenes.map(|path| (path.file_stem().unwrap().to_str().unwrap().to_owned(), path));
    let mut all: Vec<_> = named
        .filter(|(name, _)| !TANGLED.contains(&&name[..]))
        .collect();
    all.sort();
    all
}

/// Every file by a method at its default, for its first steps; from nowhere comes at most this share of the energy that
/// was given.
fn keeps_what_is_promised(method: &str, most: Real) {
    let files = files();
    let by = files.par_iter().map(|file| is_kept(method, most, file));
    let refused = REFUSED.iter().filter(|(by, _)| *by == method).count();
    assert_eq!(
        by.filter(|ran| *ran).count() + refused,
        files.len(),
        "{method}"
    );
}

/// The same of one file. Returns whether the method takes its scene.
fn is_kept(method: &str, most: Real, (name, path): &(String, PathBuf)) -> bool {
    let known = Method::find(method).unwrap();
    let settings = Variant::default_of(known).settings;
    let at = format!("{name}, {method}");
    let scene = file::build(path, &Settings::default()).unwrap();
    let mut solver = match Solver::new(known, &settings, &scene, scene.dt) {
        Ok(solver) => solver,
        Err(error) => {
            assert!(REFUSED.contains(&(method, name)), "{at}: {error}");
            return false;
        }
    };
    let mut watch = SeparationWatch::new(&scene).unwrap();
    let mut state = scene.start.clone();
    let soon = MET_SOON.iter().find(|(soon, _)| soon == name);
    let plan = Plan::new(scene.dt, soon.map_or(STEPS, |(_, steps)| *steps));
    let ran = run_changing(&scene, &mut solver, &mut state, plan, |moment| {
        watch.look(moment.scene, moment.state)
    });
    let (summary, _) = ran.unwrap_or_else(|error| panic!("{at}: {error}"));
    let seen = watch.seen();
    assert_eq!(seen.obstacle_crossed_steps, 0, "{at}");
    let nearest = seen.min_clearance.unwrap_or(Real::INFINITY);
    assert!(soon.is_none() || nearest < MET, "{at}: {nearest}");
    // The flag does not touch itself.
    assert!(name == "flag" || seen.crossed_steps == 0, "{at}");
    let share = summary.energy_excess / summary.energy_given;
    assert!(share <= most, "{at}: {share:e}");
    true
}

#[test]
fn pd_keeps_what_is_promised_in_every_scene_file() {
    keeps_what_is_promised("pd", 1e-3);
}

#[test]
fn xpbd_keeps_what_is_promised_in_every_scene_file() {
    // A step that gains more than a hundredth is taken again.
    keeps_what_is_promised("xpbd", 0.012);
}

#[test]
fn implicit_euler_keeps_what_is_promised_in_every_scene_file() {
    keeps_what_is_promised("implicit-euler", 1e-3);
}
