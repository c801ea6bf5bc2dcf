//! What the program refuses in its arguments: names, keys, values, and what does not go together, each in one sentence
//! with exit code 2.

use crate::program::refused;

#[test]
fn unknown_names_are_answered_with_the_nearest_known_one() {
    refused(
        &["run", "hnag", "--method", "pbd"],
        2,
        &["`hnag`", "`hang`"],
    );
    refused(
        &["run", "hang", "--method", "xpdb"],
        2,
        &["`xpdb`", "`xpbd`"],
    );
    refused(
        &["run", "hang", "--method", "pbd", "--set", "stifness=3"],
        2,
        &["`stifness`", "`stiffness`"],
    );
    refused(&["law", "oscilator"], 2, &["`oscilator`", "`oscillator`"]);
    refused(
        &["law", "sag", "--set", "link=3"],
        2,
        &["`link`", "`links`"],
    );
    refused(
        &["study", "convergance"],
        2,
        &["`convergance`", "`convergence`"],
    );
    refused(&["locking", "grd:3x3:one-way"], 2, &["`grd`", "`grid`"]);
}

/// Before the run that they would end, of which nothing would be left.
#[test]
fn files_that_cannot_be_written_are_refused_before_the_run() {
    let run = |more: &[&str], code, words: &[&str]| {
        let all = [
            "run",
            "hang",
            "--method",
            "pd",
            "--n",
            "5",
            "--steps",
            "1000000000",
        ];
        refused(&[&all[..], more].concat(), code, words);
    };
    let folder = env!("CARGO_TARGET_TMPDIR");
    let file = format!("{folder}/in-the-way");
    std::fs::write(&file, "").unwrap();
    let below = format!("{file}/end.png");
    run(&["--picture", &below], 1, &[&below]);
    run(&["--pin-loads", folder], 1, &[folder]);
    let untangle = ["untangle", "sphere:2", "--thickness", "1e-3", "--out"];
    let below = format!("{file}/end.obj");
    refused(&[&untangle[..], &[&below]].concat(), 1, &[&below]);
    let both = format!("{folder}/both.png");
    run(
        &["--picture", &both, "--pin-loads", &both],
        2,
        &[&both, "twice"],
    );
}

/// Each key does something beside other settings, and nothing beside these.
#[test]
fn settings_without_effect_are_refused_by_name() {
    for (scene, method, settings, words) in [
        (
            "hang",
            "xpbd-direct",
            "mode=stable iterations=3",
            "iterations mode=converged",
        ),
        (
            "hang",
            "xpbd-direct",
            "mode=plain tolerance=1e-3",
            "tolerance mode=converged",
        ),
        (
            "hang",
            "pd",
            "acceleration=none history=3",
            "history quasi-newton",
        ),
        (
            "hang",
            "pd",
            "acceleration=chebyshev coarse=4",
            "coarse quasi-newton",
        ),
        (
            "hang",
            "pd",
            "spectral_radius=0.9",
            "spectral_radius chebyshev",
        ),
        (
            "hang",
            "pbd",
            "chebyshev_delay=3",
            "chebyshev_delay chebyshev",
        ),
        (
            "hang",
            "xpbd",
            "chebyshev_delay=3",
            "chebyshev_delay chebyshev",
        ),
        (
            "hang",
            "xpbd",
            "chebyshev=auto",
            "chebyshev chebyshev_delay iterations",
        ),
        (
            "hang",
            "implicit-euler",
            "linear=cholesky linear_tolerance=1e-3",
            "linear_tolerance iterative",
        ),
        (
            "hang",
            "bdf2",
            "linear=cholesky linear_iterations=9",
            "linear_iterations iterative",
        ),
        (
            "hang",
            "pd",
            "strain_limit_passes=9",
            "strain_limit_passes strain_limit",
        ),
        ("hang", "pd", "contact=potential", "contact self=yes"),
        (
            "drape-sphere",
            "implicit-euler",
            "linear=cholesky",
            "linear=cholesky contact linear=multigrid",
        ),
        ("hang", "pd", "thickness=1e-3", "thickness self=yes"),
        ("hang", "pd", "friction=0.5", "friction self=yes"),
    ] {
        let mut arguments = vec!["run", scene, "--n", "5", "--steps", "1", "--method", method];
        for pair in settings.split(' ') {
            arguments.extend(["--set", pair]);
        }
        let words: Vec<&str> = words.split(' ').collect();
        refused(&arguments, 2, &words);
    }
}

#[test]
fn values_out_of_range_are_refused_by_name() {
    let run = |more: &[&'static str], words: &[&str]| {
        let arguments: Vec<&str> = ["run", "hang", "--n", "5", "--method", "pbd"]
            .into_iter()
            .chain(more.iter().copied())
            .collect();
        refused(&arguments, 2, words);
    };
    run(&["--dt", "0"], &["dt", "0 s"]);
    run(&["--dt", "-0.1"], &["dt", "-0.1"]);
    run(&["--dt", "nan"], &["dt", "NaN"]);
    run(&["--set", "density=-1"], &["density", "-1"]);
    run(&["--set", "pins=99"], &["vertex 99"]);
    run(&["--set", "pins=top"], &["pins"]);
    run(&["--set", "iterations=0"], &["iterations"]);
    run(&["--set", "stiffness=-5"], &["stiffness", "-5"]);
    run(&["--set", "projection=1.5"], &["1.5"]);
    run(&["--set", "n"], &["key=value"]);
    refused(
        &[
            "run",
            "hang",
            "--method",
            "implicit-euler",
            "--set",
            "linear=conjugate-gradients",
            "--set",
            "linear_tolerance=1e-300",
        ],
        2,
        &["linear_tolerance is `1e-300`", "above 1e-16 and below 1"],
    );
    run(&["--mesh", "disk:3"], &["n shapes", "--mesh"]);
    run(&["--threads", "0"], &["--threads", "1 to"]);
    run(&["--threads", "100000"], &["--threads", "1 to"]);
    refused(
        &["law", "pbd-constraint", "--set", "stiffness=1"],
        2,
        &["stiffness", "below 1"],
    );
    refused(&["law", "oscillator", "--set", "z=-1"], 2, &["z", "-1"]);
    refused(
        &["run", "chain", "--method", "pbd", "--mesh", "disk:3"],
        2,
        &["chain", "--mesh"],
    );
    // 2 π 0.025 m × 7 turns are 1.10 m of a towel of 1 m, either way round.
    let twist = |pairs: &[&'static str], words: &[&str]| {
        let sets = pairs.iter().flat_map(|pair| ["--set", pair]);
        let run = ["run", "twist", "--n", "5", "--method", "pbd"];
        refused(&run.into_iter().chain(sets).collect::<Vec<_>>(), 2, words);
    };
    twist(&["turns=7"], &["cannot be turned 7 times", "1.10 m"]);
    twist(&["turns=-7"], &["cannot be turned -7 times", "1.10 m"]);
    twist(
        &["rope=0.05"],
        &["cannot be turned 4 times", "0.05 m", "1.26 m"],
    );
    twist(&["turns=nan"], &["turns"]);
}

#[test]
fn elements_without_the_view_of_a_method_are_refused() {
    let run = |method: &str, set: &[&str], words: &[&str]| {
        let mut arguments = vec!["run", "hang", "--n", "5", "--method", method];
        set.iter()
            .for_each(|pair| arguments.extend(["--set", pair]));
        refused(&arguments, 2, words);
    };
    run(
        "pd",
        &["membrane=stvk"],
        &["`pd`", "StVK triangles", "distance"],
    );
    run("pd", &["bending=dihedral"], &["`pd`", "dihedral hinges"]);
    run(
        "xpbd",
        &["bending=cubic"],
        &["`xpbd`", "cubic-shell", "squares"],
    );
    run("pbd", &["membrane=stvkk"], &["`stvkk`", "`stvk`"]);
    // What nothing would use is no choice either.
    run("pbd", &["poisson=0.3"], &["poisson", "membrane=stvk"]);
    run("pbd", &["bending_stiffness=3"], &["bending_stiffness"]);
    run("pbd", &["bending=none", "rigidity=1"], &["rigidity"]);
    run(
        "pbd",
        &["modulus=1", "stiffness=1"],
        &["modulus", "stiffness"],
    );
    run("pbd", &["modulus=1", "shear=1"], &["shear"]);
    run("pbd", &["shear=-1"], &["shear", "-1"]);
    run(
        "pbd",
        &["membrane=stvk", "poisson=1"],
        &["poisson", "above -1 and below 1"],
    );
}

#[test]
fn a_method_with_another_aim_is_not_compared_with_implicit_euler() {
    let arguments = [
        "run",
        "hang",
        "--n",
        "5",
        "--steps",
        "2",
        "--method",
        "bdf2",
        "--reference",
    ];
    refused(&arguments, 2, &["`bdf2`", "--reference"]);
}
