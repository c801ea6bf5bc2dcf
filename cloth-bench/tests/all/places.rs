//! What is wrong with a scene file is said with the file, the line, the key and what it may be.

use crate::program::{folder, refused, run_text};
use crate::scene_text::written;

const SHEET: &str = "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n";
const HELD: &str =
    "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n[[pins]]\nselect = \"corners\"\n";

/// The file is refused, and the first word of what is said is its name with this line; these words come after it.
fn wrong(name: &str, text: &str, method: &str, line: usize, words: &[&str]) {
    let path = written(name, text);
    let place = format!("{name}.toml: line {line}: ");
    let words = [&[place.as_str()], words].concat();
    refused(
        &["run", path.to_str().unwrap(), "--method", method],
        2,
        &words,
    );
}

#[test]
fn numbers_of_another_kind_are_refused_with_what_they_may_be() {
    let whole = "a whole number from 0 to 4294967295";
    for (name, top, more, words) in [
        (
            "steps-negative",
            "steps = -1\n",
            "",
            ["steps is `-1`", whole],
        ),
        (
            "steps-many",
            "steps = 99999999999\n",
            "",
            ["steps is `99999999999`", whole],
        ),
        (
            "dt-text",
            "dt = \"1/60\"\n",
            "",
            ["dt is `\"1/60\"`", "a finite number above 0"],
        ),
        (
            "dt-fraction",
            "dt = 1/60 # s\n",
            "",
            ["`dt = 1/60 # s`", "but 0.0166"],
        ),
        ("dt-word", "dt = soon\n", "", ["dt = soon", "quoted"]),
    ] {
        wrong(name, &[top, more, HELD].concat(), "pd", 1, &words);
    }
    let text = format!("{HELD}obstacle = -1\n");
    let words = ["obstacle is `-1`", whole, ", or none"];
    wrong("obstacle-negative", &text, "pd", 5, &words);
    let text = format!("dt = 0.1\ndt = 0.2\n{HELD}");
    wrong(
        "key-twice",
        &text,
        "pd",
        2,
        &["duplicate key", "`dt = 0.2`"],
    );
    let text = format!("{HELD}[method.xpbd]\nenergy_gain = 0\n");
    let words = ["energy_gain is `0`", "above 0, or none, or auto"];
    wrong("no-gain", &text, "xpbd", 6, &words);
}

/// Products of these are no numbers, which would be told of a triangle or of a step.
#[test]
fn sizes_and_masses_beyond_all_measure_are_refused_by_their_keys() {
    let far = "[[obstacle]]\nposition = [0, 0, -1]\nshape = ";
    for (name, more, line, words) in [
        (
            "far-cloth",
            "translate = [1e12, 0, 0]\n".to_owned(),
            3,
            ["translate is", "from -1e9 to 1e9"],
        ),
        (
            "heavy-hem",
            "[[mass]]\nselect = \"border\"\nmass = 1e300\n".to_owned(),
            5,
            ["mass is", "above 0 and below 1e9"],
        ),
        (
            "large-ball",
            format!("{far}\"sphere\"\nradius = 1e300\n"),
            6,
            ["radius is", "above 0 and below 1e9"],
        ),
        (
            "large-box",
            format!("{far}\"box\"\nsize = [1, 1e300, 1]\n"),
            6,
            ["size is", "above 0 and below 1e9"],
        ),
        (
            "heavy-ball",
            format!("{far}\"sphere\"\nradius = 0.1\nmass = 1e300\n"),
            7,
            ["mass is", "above 0 and below 1e9"],
        ),
        (
            "hard-contact",
            format!("{far}\"plane\"\n[contact]\ncontact_stiffness = 1e300\n"),
            7,
            ["contact_stiffness is", "above 0 and below 1e15, or auto"],
        ),
    ] {
        wrong(name, &[SHEET, &more].concat(), "pd", line, &words);
    }
}

#[test]
fn hard_constraints_that_a_method_cannot_take_are_told_where_they_stand() {
    let link = "[[link]]\nmeshes = [0, 1]\nfirst = [0]\nsecond = [0]\n";
    let text = [HELD, SHEET, "translate = [0, 0, 1]\n", link].concat();
    wrong(
        "rigid-links",
        &text,
        "pd",
        8,
        &["[[link]]: `pd` cannot take links"],
    );
    let text = format!("{HELD}[cloth]\nstiffness = inf\n");
    wrong(
        "hard-cloth",
        &text,
        "pd",
        6,
        &["`pd` cannot take stiffness=inf"],
    );
    let text = format!("{HELD}[mesh.cloth]\nstiffness = inf\n");
    let text = text.replace("[[pins]]", "[mesh.cloth]\nstiffness = inf\n[[pins]]");
    let text = text.rsplit_once("[mesh.cloth]").unwrap().0;
    wrong(
        "hard-piece",
        text,
        "pd",
        4,
        &["`pd` cannot take stiffness=inf"],
    );
}

/// A start is the file's; where border vertices lie on each other, the triangles cross because they are not welded.
#[test]
fn a_start_that_crosses_itself_names_the_file_and_what_helps() {
    let contact = "[contact]\nself = true\n";
    let crossed = [
        SHEET,
        SHEET,
        "rotate = [1.5, 0, 0]\ntranslate = [0.01, 0.52, -0.43]\n",
        contact,
    ];
    let (_, code, said) = run_text("crossed", &crossed.concat(), "pd", &[]);
    assert_eq!(code, 2, "{said}");
    for words in ["crossed.toml: step 1: ", "untangle=yes"] {
        assert!(said.contains(words), "{said}");
    }
    // Each triangle with corners of its own.
    let mut text = String::new();
    let quads = (0..9).map(|k| [k / 3, k % 3].map(f64::from));
    for (quad, [x, y]) in quads.enumerate() {
        let corners = [
            [x, y],
            [x + 1.0, y],
            [x + 1.0, y + 1.0],
            [x, y],
            [x + 1.0, y + 1.0],
            [x, y + 1.0],
        ];
        for [x, y] in corners {
            text += &format!("v {} {} 0\n", 0.1 * x, 0.1 * y);
        }
        let v = 6 * quad;
        text += &format!(
            "f {} {} {}\nf {} {} {}\n",
            v + 1,
            v + 2,
            v + 3,
            v + 4,
            v + 5,
            v + 6
        );
    }
    let mesh = folder("unwelded").join("unwelded.obj");
    std::fs::write(&mesh, text).unwrap();
    let piece = format!("[[mesh]]\nfile = {:?}\n", mesh.to_str().unwrap());
    let (_, code, said) = run_text("unwelded", &[&piece, contact].concat(), "pd", &[]);
    assert_eq!(code, 2, "{said}");
    let error = said.lines().last().unwrap();
    assert!(
        error.contains("weld = 0") && !error.contains("untangle"),
        "{said}"
    );
    let welded = [&piece, "weld = 1e-9\n", contact].concat();
    let (_, code, said) = run_text("welded", &welded, "pd", &["--steps", "1"]);
    assert_eq!(code, 0, "{said}");
}

#[test]
fn a_number_of_steps_below_zero_is_refused_as_such() {
    let run = ["run", "hang", "--method", "pd", "--steps", "-1"];
    refused(&run, 2, &["-1", "--steps", "0.."]);
}
