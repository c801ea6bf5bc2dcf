//! Cloth that is stretched farther than cloth can be is told, and numbers beyond all measure end a run.

use crate::program::program;
use crate::scene_text::written;
use serde_json::Value;

/// Exit code, what is said, and the numbers.
fn run(name: &str, scene: &str, method: &str) -> (i32, String, Value) {
    let path = written(name, scene);
    let output = program(&["run", path.to_str().unwrap(), "--json", "--method", method]);
    let said = String::from_utf8(output.stderr).unwrap();
    let end = serde_json::from_slice(&output.stdout).unwrap();
    (output.status.code().unwrap(), said, end)
}

/// Two of its sides are pulled apart to `1 + stretch` times its width, and come back.
fn pulled(stretch: f64) -> String {
    format!(
        "steps = 60\ngravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:2x2:alternating\"\n\
         [[pins]]\nbox = [[-9, -9, -9], [0.1, 9, 9]]\n\
         [[event]]\ntime = 0\ndo = \"grab\"\nbox = [[0.9, -9, -9], [9, 9, 9]]\nmove = [{stretch}, 0, 0]\nduration = 0.5\n\
         [[event]]\ntime = 0.5\ndo = \"drag\"\nbox = [[0.9, -9, -9], [9, 9, 9]]\nmove = [-{stretch}, 0, 0]\nduration = 0.5\n"
    )
}

#[test]
fn a_stretch_on_the_way_is_told_with_its_step() {
    let (code, said, end) = run("pulled-far", &pulled(1.5), "implicit-euler");
    assert_eq!(code, 0, "{said}");
    let [last, most] = ["max_stretch", "max_stretch_of_all"].map(|key| end[key].as_f64().unwrap());
    assert!(last < 1e-9 && (most - 1.5).abs() < 1e-9, "{last} {most}");
    assert!(
        said.contains("after step 30 the edge between vertices "),
        "{said}"
    );
    assert!(
        said.contains("was 2.500 times as long as at rest"),
        "{said}"
    );
    assert!(!said.contains("pressure"), "{said}");
    let (_, said, _) = run("pulled-less", &pulled(0.9), "implicit-euler");
    assert!(!said.contains("stretched"), "{said}");
}

/// Two pieces, of which triangles make one: it is measured too.
#[test]
fn pieces_of_springs_and_of_triangles_are_both_measured() {
    for membrane in ["springs", "stvk", "arap"] {
        let pulled = pulled(0.8).replace("9, 9]", "9, 1]");
        let scene = format!(
            "[cloth]\nmembrane = \"{membrane}\"\n[[mesh]]\ngenerator = \"grid:2x2:alternating\"\n\
             translate = [0, 0, 5]\n[mesh.cloth]\nmembrane = \"springs\"\n"
        );
        let scene = pulled.replacen("[[mesh]]", &format!("{scene}[[mesh]]"), 1);
        let (code, said, end) = run("pulled-one-of-two", &scene, "implicit-euler");
        assert_eq!(code, 0, "{said}");
        let most = end["max_stretch_of_all"].as_f64().unwrap();
        assert!((most - 0.8).abs() < 1e-9, "{membrane}: {most}");
    }
}

/// A ball of linear cloth has an equilibrium up to `½ p R = Y/(4 (1 − ν))`, 937.5 N/m for Y = 2500 N/m and ν = 1/3, and
/// is twice as wide as at rest there.
#[test]
fn a_pressure_that_no_membrane_holds_is_told_or_ends_the_run() {
    let ball = |pressure: f64| {
        format!(
            "steps = 120\ngravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"sphere:5\"\npressure = {pressure}\n\
             [cloth]\nmodulus = 2500\n"
        )
    };
    let held = "can hold no more than 9.3";
    // R = 0.5 m: the largest pressure is 3750 Pa.
    let (code, said, end) = run("ball-holds", &ball(3000.0), "implicit-euler");
    let most = end["max_stretch"].as_f64().unwrap();
    assert!(code == 0 && !said.contains(held), "{said}");
    // x/(1 + x)² = 3000/3750/4.
    assert!((most / 0.382 - 1.0).abs() < 0.1, "{most}");
    for method in ["implicit-euler", "pd", "xpbd"] {
        let (code, said, end) = run("ball-bursts", &ball(1e5), method);
        assert_eq!(code, 1, "{method}: {said}");
        let error = end["error"].as_str().unwrap();
        assert!(
            error.starts_with("step ") && said.contains(error),
            "{error}"
        );
        assert!(error.contains("vert"), "{method}: {error}");
    }
    let (code, said, _) = run("ball-grows", &ball(4500.0), "implicit-euler");
    assert!(
        code == 1 || said.contains("stretched farther than cloth can be"),
        "{said}"
    );
    assert!(said.contains(held), "{said}");
}

/// Whoever has given a number of substeps may have tried more before, and is not sent on and on.
#[test]
fn more_substeps_are_proposed_to_those_who_gave_none() {
    let said = |substeps: &str| {
        let substeps = format!("substeps={substeps}");
        let run = [
            "run", "hang", "--n", "33", "--steps", "30", "--method", "xpbd", "--set", &substeps,
        ];
        String::from_utf8(program(&run).stderr).unwrap()
    };
    let [published, given] = ["published", "5"].map(said);
    assert!(
        published.contains("see what `--set substeps=80` makes of it"),
        "{published}"
    );
    assert!(
        given.contains("what more substeps do not change is the cloth's own"),
        "{given}"
    );
    assert!(!given.contains("--set substeps"), "{given}");
}
