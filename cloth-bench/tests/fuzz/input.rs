//! Command lines, and settings of scenes and methods.

use crate::{Random, fuzz};
use clap::Parser;
use cloth_bench::commands::Command;
use cloth_bench::method::METHODS;
use cloth_bench::run::run;
use cloth_bench::scene::{self, SCENES, SceneInfo};
use cloth_bench::settings::{Parameter, Settings};

#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    _command: Command,
}

#[test]
fn command_lines_are_read_or_refused() {
    let words = [
        "run",
        "study",
        "merge",
        "locking",
        "ccd",
        "law",
        "list",
        "hang",
        "fold",
        "--method",
        "xpbd",
        "--n",
        "3",
        "--steps",
        "--dt",
        "0.1",
        "-1",
        "--threads",
        "--set",
        "a=b",
        "=",
        "--json",
        "--quick",
        "--out",
        "--resume",
        "--shard",
        "1/2",
        "0/0",
        "--kind",
        "vf",
        "--mesh",
        "grid:3x3:crossed",
        "--",
        "-",
        "",
        "nan",
        "1e999",
        "99999999999999999999",
        "ä\u{200d}",
        "--export",
        "--format",
        "gltf",
        "--picture",
    ];
    fuzz(5000, |random| {
        let count = random.below(10);
        let line = (0..count).map(|_| random.pick(&words));
        let line: Vec<&str> = std::iter::once("cloth-bench").chain(line).collect();
        if let Err(error) = Arguments::try_parse_from(line) {
            assert!(!error.to_string().is_empty());
        }
    });
}

/// Something to set `parameter` to: one of the words of its description, a number, or neither.
fn value(random: &mut Random, parameter: &Parameter) -> String {
    let words: Vec<&str> = parameter
        .about
        .split(|c: char| !(c.is_alphanumeric() || "-_.".contains(c)))
        .collect();
    match random.below(6) {
        0 | 1 => random.pick(&words).to_owned(),
        2 => parameter.default.to_owned(),
        3 => random.number().to_string(),
        _ => random
            .pick(&[
                "0", "1", "2", "1000", "-1", "0.5", "1e-9", "1e9", "1e308", "1e-308", "nan", "inf",
                "", "0,1", "x",
            ])
            .to_owned(),
    }
}

/// Up to three settings of `groups`, but sizes and contact.
fn settings(random: &mut Random, groups: &[&[Parameter]]) -> Settings {
    let large = ["n", "self", "floor", "pattern"];
    let all: Vec<&Parameter> = groups
        .iter()
        .flat_map(|group| group.iter())
        .filter(|parameter| !large.contains(&parameter.name))
        .collect();
    let mut settings = Settings::default();
    for _ in 0..random.below(4) {
        let parameter = random.pick(&all);
        if settings.get(parameter.name).is_none() {
            settings = settings.with(parameter.name, value(random, parameter));
        }
    }
    settings
}

#[test]
fn settings_are_refused_or_give_finite_runs() {
    let alone = ["hang", "drop", "chain", "cantilever"];
    let scenes: Vec<&SceneInfo> = SCENES.iter().filter(|s| alone.contains(&s.name)).collect();
    fuzz(5000, |random| {
        let info = random.pick(&scenes);
        let small = settings(random, &info.groups()).with("n", 2 + random.below(3));
        let Ok(scene) = scene::build(info.name, None, &small) else {
            return;
        };
        let method = &METHODS[random.below(METHODS.len())];
        let chosen = settings(random, &method.parameters());
        let dt = random.pick(&[1.0 / 60.0, 1.0 / 60.0, 1e-9, 10.0]);
        let substeps = method.substeps(&scene, &chosen, dt);
        if !substeps.is_ok_and(|substeps| substeps <= 10_000) {
            return;
        }
        let Ok(mut stepper) = method.build(&scene, &chosen, dt) else {
            return;
        };
        let mut state = scene.start.clone();
        let _ = run(&scene, &mut *stepper, &mut state, dt, 2, |_, _, _| Ok(()));
        assert_eq!(state.first_non_finite(), None, "{}", method.name);
    });
}
