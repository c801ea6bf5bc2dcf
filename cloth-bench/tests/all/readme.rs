//! The README and what it links to say what the code can do, and what comes out of it.

use cloth_bench::laws::Law;
use cloth_bench::mesh_spec;
use cloth_bench::method::Method;
use cloth_bench::run::{Summary, from_start};
use cloth_bench::scene;
use cloth_bench::settings::Settings;
use cloth_bench::studies::Study;
use cloth_bench::studies::stability::stable_up_to;
use cloth_core::element::{Constraint, Energy, Projective, RowArray};
use cloth_core::energy::{
    ArapTetrahedron, ArapTriangle, AreaTriangle, Attachment, CubicShell, CurvatureHinge,
    CurvedHinge, DihedralHinge, MidpointHinge, SoftPin, Spring, Stitch, StrainLimitSpring,
    StrainLimitTriangle, StvkTriangle, VolumeTetrahedron,
};
use cloth_core::mesh::obj;
use cloth_core::mesh::ply::{self, Encoding};
use std::collections::BTreeSet;
use std::marker::PhantomData;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const ELEMENTS: &str = include_str!("../../doc/elements.md");
const RESULTS: &str = include_str!("../../doc/results.md");
const README: &str = include_str!("../../../README.md");

/// Asks the compiler what an element of N vertices with K projected vectors has: its own constants come first, where
/// the element has the view, and those of [`Lacking`] otherwise.
struct View<E, const N: usize, const K: usize>(PhantomData<E>);

trait Lacking {
    const ENERGY: bool = false;
    const ROWS: Option<usize> = None;
    const PROJECTIVE: bool = false;
}

impl<E, const N: usize, const K: usize> Lacking for View<E, N, K> {}

impl<E: Energy<N>, const N: usize, const K: usize> View<E, N, K> {
    const ENERGY: bool = true;
}

impl<E: Constraint<N>, const N: usize, const K: usize> View<E, N, K> {
    const ROWS: Option<usize> = Some(<E::Rows as RowArray<N>>::LEN);
}

impl<E: Projective<N, K>, const N: usize, const K: usize> View<E, N, K> {
    const PROJECTIVE: bool = true;
}

/// The cells of an element's line, from the code.
macro_rules! cells {
    ($element:ident, $n:literal) => {{
        let energy = if View::<$element, $n, 0>::ENERGY {
            "yes".to_owned()
        } else {
            "–".to_owned()
        };
        let rows = match View::<$element, $n, 0>::ROWS {
            Some(1) => "1 row".to_owned(),
            Some(rows) => format!("{rows} rows"),
            None => "–".to_owned(),
        };
        let kinds = [
            View::<$element, $n, 1>::PROJECTIVE,
            View::<$element, $n, 2>::PROJECTIVE,
            View::<$element, $n, 3>::PROJECTIVE,
        ];
        let projective = match kinds.iter().position(|&has| has) {
            Some(place) => format!("K = {}", place + 1),
            None => "–".to_owned(),
        };
        (stringify!($element), [energy, rows, projective])
    }};
}

#[test]
fn the_table_of_elements_is_that_of_the_code() {
    let nothing = cells!(String, 1).1;
    assert_eq!(nothing, ["–"; 3], "what has no view is told apart");
    let elements = [
        cells!(Spring, 2),
        cells!(CurvatureHinge, 4),
        cells!(CurvedHinge, 4),
        cells!(DihedralHinge, 4),
        cells!(CubicShell, 4),
        cells!(MidpointHinge, 5),
        cells!(StvkTriangle, 3),
        cells!(ArapTriangle, 3),
        cells!(ArapTetrahedron, 4),
        cells!(AreaTriangle, 3),
        cells!(VolumeTetrahedron, 4),
        cells!(StrainLimitSpring, 2),
        cells!(StrainLimitTriangle, 3),
        cells!(Attachment, 1),
        cells!(SoftPin, 1),
        cells!(Stitch, 2),
    ];
    let mut wrong = Vec::new();
    for (name, cells) in &elements {
        let line = ELEMENTS
            .lines()
            .find(|line| line.starts_with(&format!("| `{name}` ")));
        let written: Vec<&str> =
            line.map_or(Vec::new(), |line| line.split('|').map(str::trim).collect());
        let expected: Vec<&str> = cells.iter().map(String::as_str).collect();
        if written.get(2..5) != Some(&expected[..]) {
            wrong.push(format!(
                "{name}: {} in the code, {written:?} in elements.md",
                expected.join(" | ")
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // And it has no others.
    let rows = ELEMENTS
        .lines()
        .skip_while(|line| !line.starts_with("| element |"))
        .skip(2);
    let rows = rows.take_while(|line| line.starts_with('|')).count();
    assert_eq!(rows, elements.len());
}

/// A table of a study: its lines, cut at the commas.
pub(crate) fn table(study: &[&str], name: &str) -> Vec<Vec<String>> {
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("readme-{name}"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_cloth-bench"));
    command.arg("study").args(study).arg("--out").arg(&out);
    let command = command.stdout(Stdio::null()).stderr(Stdio::null());
    assert!(command.status().unwrap().success());
    let text = std::fs::read_to_string(out.join(format!("data/{name}.csv"))).unwrap();
    let cells = |line: &str| line.split(',').map(str::to_owned).collect();
    text.lines().map(cells).collect()
}

/// The number under `column` in the line that begins with `start`.
fn number(table: &[Vec<String>], start: &[&str], column: &str) -> f64 {
    let place = table[0].iter().position(|name| name == column).unwrap();
    let line = table
        .iter()
        .find(|line| line.iter().zip(start).all(|(a, b)| a == b))
        .unwrap();
    line[place].parse().unwrap()
}

fn assert_says(text: &str, sentence: &str) {
    assert!(text.contains(sentence), "nowhere: {sentence}");
}

#[test]
fn the_floor_of_xpbd_is_the_one_that_the_study_finds() {
    let floors = table(&["xpbd-floor"], "xpbd-floor");
    let floor = |stiffness, rate| {
        let error = number(&floors, &[stiffness, rate], "sweeps: objective error");
        format!("{error:.1e}")
    };
    let powered = |number: String| {
        let (digits, power) = number.split_once("e-").unwrap();
        let high = ["⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"];
        let power = power.bytes().map(|digit| high[usize::from(digit - b'0')]);
        format!("{digits}·10⁻{}", power.collect::<String>())
    };
    let [long, short] = ["30", "1920"].map(|rate| powered(floor("200.0", rate)));
    assert_says(
        RESULTS,
        &format!(
            "what is left of the objective is {long} with steps of 1/30 s and {short} with 1/1920 s (chain of 200 N/m)"
        ),
    );
    for rate in ["60", "240", "960"] {
        let [soft, stiff] = ["200.0", "10000.0"].map(|stiffness| floor(stiffness, rate));
        assert_says(
            include_str!("../../../cloth-xpbd/src/lib.rs"),
            &format!("//!   | 1/{rate} | {soft} | {stiff} |"),
        );
    }
}

#[test]
fn substeps_and_iterations_leave_what_the_readme_says() {
    let sag = |pairs: &[&str]| {
        let settings = Settings::parse(&[&["links=20", "tip_mass=1"], pairs].concat()).unwrap();
        Law::find("sag")
            .unwrap()
            .evaluate(&settings)
            .unwrap()
            .measured
    };
    let [substeps, iterations] = [
        sag(&["substeps=16", "iterations=1"]),
        sag(&["substeps=1", "iterations=16"]),
    ];
    assert_says(
        RESULTS,
        &format!(
            "Substeps: 16 of them leave a chain of 20 rigid links of 1 m a sag of {substeps:.4} m, 16 iterations {iterations:.3} m"
        ),
    );
    let sheets = table(&["sag", "--quick"], "sag-iterations");
    // A chain of as many links as substeps comes to its end between two turns.
    let chain = number(&sheets, &["chain", "sequential", "substeps"], "mean strain");
    let law = 9.81 * (1.0_f64 / 60.0 / 24.0).powi(2) * 24.0 * 23.0 / 2.0;
    assert!((chain / law - 1.0).abs() < 1e-6, "{chain} of {law}");
    let [iterations, substeps] = ["iterations", "substeps"]
        .map(|kind| 100.0 * number(&sheets, &["edge", "colored", kind], "mean strain"));
    assert_says(
        RESULTS,
        &format!(
            "a rigid sheet of 24 edges, hung by its upper edge, is {iterations:.2} % too long after 24 iterations a step of 1/60 s, {substeps:.2} % after 24 substeps"
        ),
    );
}

#[test]
fn a_symmetric_sheet_is_as_lopsided_as_the_study_finds() {
    let sheets = table(&["independence", "--quick"], "independence-order");
    // The name of the method has a comma of its own.
    let off = |sweep: &str, iterations: &str| -> f64 {
        let start = ["\"pbd", &format!(" {sweep}\""), iterations];
        let mut lines = sheets.iter();
        let line = lines.find(|line| line.iter().zip(start).all(|(a, b)| a == b));
        line.unwrap()[3].parse().unwrap()
    };
    let [one, many] = ["1", "16"].map(|iterations| off("colours", iterations));
    assert_says(
        RESULTS,
        &format!(
            "is off its mirror image by {one:.3} m with one iteration of `pbd` a step, by {many:.3} m with 16"
        ),
    );
    assert!(off("Jacobi", "16") < 1e-12);
}

/// The sheet of 64 × 64 vertices after half a second.
fn fallen(method: &str, pairs: &[&str]) -> Summary {
    let sheet = Settings::parse(&["n=64"]).unwrap();
    let scene = scene::build("hang", None, &sheet).unwrap();
    let method = Method::find(method).unwrap();
    let settings = Settings::parse(pairs).unwrap();
    let (summary, _) =
        from_start(&scene, method, &settings, scene.dt, 30, |_, _, _| Ok(())).unwrap();
    summary
}

/// Of the methods that take seconds at most.
#[test]
fn the_sheet_falls_as_far_as_the_readme_says() {
    let [xpbd, pbd, linear, pd, newton] = [
        fallen("xpbd", &[]),
        fallen("pbd", &[]),
        fallen("linear-implicit", &[]),
        fallen("pd", &[]),
        // Far enough for the digits of the RESULTS.
        fallen("implicit-euler", &["tolerance=1e-2"]),
    ];
    let iterated = fallen("xpbd", &["substeps=1", "iterations=20"]);
    let cut = fallen("pbd", &["substeps=20", "iterations=1"]);
    let of = |summary: &Summary| format!("{:.3} m", summary.center_of_mass_drop);
    // With one iteration a substep they are the same method.
    assert_eq!(of(&cut), of(&xpbd));
    let [c, x, p, n] = [&cut, &iterated, &pbd, &newton].map(of);
    for sentence in [
        format!("the 64 × 64 sheet below has fallen {c} with 20 substeps of either"),
        format!("has fallen {x} with XPBD and {p} with PBD; converged implicit Euler has {n}"),
    ] {
        assert_says(RESULTS, &sentence);
    }
    for (method, summary, digits) in [
        ("xpbd", xpbd, 0),
        ("pbd", pbd, 0),
        ("linear-implicit", linear, 1),
        ("pd", pd, 1),
        ("implicit-euler", newton, 1),
    ] {
        let line = RESULTS
            .lines()
            .find(|line| line.starts_with(&format!("| `{method}`")) && line.ends_with("% |"));
        let written: Vec<&str> = line.unwrap().split(" | ").skip(2).collect();
        let fall = format!("{:.3} m", summary.center_of_mass_drop);
        let stretch = format!("{:.digits$} % |", 100.0 * summary.max_stretch);
        assert_eq!(written, [&*fall, &*stretch], "{method}");
        // XPBD of that table has 20 substeps, that of the README its default.
        if method != "xpbd" {
            let line = README
                .lines()
                .find(|line| line.starts_with(&format!("| `{method}`")));
            let cells = format!("| {fall} | {stretch}");
            assert!(line.unwrap().contains(&cells), "{method}: {cells}");
        }
    }
}

#[test]
fn springs_may_be_as_stiff_as_the_readme_says() {
    for method in ["linear-implicit", "pd", "xpbd", "pbd"] {
        let found = stable_up_to(method, 60).unwrap();
        assert_eq!(found.stable, Some(1e9), "{method}");
        let strained = found.strained.map_or(String::new(), |stiffness| {
            let high = ["⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"];
            format!(
                ", strained from 10{}",
                high[stiffness.log10().round() as usize]
            )
        });
        let start = format!("| `{method}`");
        let line = README.lines().find(|line| line.starts_with(&start));
        let cell = format!("| ≥ 10⁹{strained} |");
        assert!(line.unwrap().contains(&cell), "{method}: {cell}");
    }
}

#[test]
fn the_names_of_a_simulation_are_those_at_the_root_of_the_core() {
    let root = include_str!("../../../cloth-core/src/lib.rs");
    let words = |text: &str| -> BTreeSet<String> {
        let words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
        words
            .filter(|word| !word.is_empty())
            .map(str::to_owned)
            .collect()
    };
    let exported = root
        .lines()
        .filter_map(|line| line.strip_prefix("pub use "));
    let exported = exported.flat_map(|line| words(line.rsplit("::").next().unwrap()));
    let (_, rest) = README.split_once("besides its method: ").unwrap();
    let (named, _) = rest.split_once(". ").unwrap();
    assert_eq!(words(named), exported.collect());
}

/// The arguments of every line of a page that starts the program.
fn command_lines(page: &'static str) -> impl Iterator<Item = Vec<&'static str>> {
    let blocks = page.split("```sh\n").skip(1);
    let lines = blocks.flat_map(|block| block.split("```").take(1).flat_map(str::lines));
    lines.filter_map(|line| {
        let mut starts = ["cloth ", "cargo run --release -p cloth-bench -- "].into_iter();
        let arguments = starts.find_map(|start| line.strip_prefix(start))?;
        Some(arguments.split(" #").next()?.split_whitespace().collect())
    })
}

/// With two steps where it is a run; studies, which take minutes, are only looked up.
#[test]
fn the_commands_of_the_pages_run() {
    let folder = crate::program::folder("readme-commands");
    for (file, mesh) in [
        ("shirt.ply", "tube:16x8"),
        ("shirt.obj", "tube:16x8"),
        ("flag.obj", "grid:9x9:alternating"),
        ("garment.obj", "tangled:layers"),
    ] {
        let (mesh, file) = (mesh_spec::load(mesh).unwrap(), folder.join(file));
        match file.extension().unwrap() == "ply" {
            true => ply::write(&file, mesh.positions(), mesh.triangles(), Encoding::Ascii).unwrap(),
            false => obj::write(&file, mesh.positions(), mesh.triangles()).unwrap(),
        }
    }
    let scenes = include_str!("../../scenes/README.md");
    let pages = [README, include_str!("../../doc/commands.md"), scenes];
    let (mut ran, mut wrong) = (0, Vec::new());
    for mut words in pages.into_iter().flat_map(command_lines) {
        match words[0] {
            "study" => {
                let names = words[1..].iter().take_while(|word| !word.starts_with("--"));
                wrong.extend(names.filter_map(|name| Some(Study::find(name).err()?.to_string())));
                continue;
            }
            "merge" => continue, // of what two studies have written
            "run" => match words.iter().position(|&word| word == "--steps") {
                Some(place) => words[place + 1] = "2",
                None => words.extend(["--steps", "2"]),
            },
            _ => {}
        }
        let scene_file = |word: &str| match word.strip_prefix("cloth-bench/") {
            Some(path) => Path::new(env!("CARGO_MANIFEST_DIR")).join(path),
            None => PathBuf::from(word),
        };
        let mut command = Command::new(env!("CARGO_BIN_EXE_cloth-bench"));
        let command = command.args(words.iter().copied().map(scene_file));
        let output = command.current_dir(&folder).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        // Two steps do not untangle.
        if !output.status.success() && !said.contains("untangling has not come to its end") {
            wrong.push(format!("{}: {said}", words.join(" ")));
        }
        ran += 1;
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(ran > 20, "{ran}");
}

#[test]
fn links_of_the_pages_lead_to_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut links = 0;
    for page in [
        "README.md",
        "cloth-bench/CHANGELOG.md",
        "cloth-bench/CONTRIBUTING.md",
        "cloth-bench/doc/commands.md",
        "cloth-bench/doc/elements.md",
        "cloth-bench/doc/results.md",
        "cloth-bench/scenes/README.md",
    ] {
        let page = root.join(page);
        let text = std::fs::read_to_string(&page).unwrap();
        let pages = text.split("](").skip(1).map(|rest| rest.split_once(')'));
        let pictures = text
            .split("src=\"")
            .skip(1)
            .map(|rest| rest.split_once('"'));
        for link in pages.chain(pictures) {
            let link = link.unwrap().0;
            assert!(
                page.with_file_name(link).exists(),
                "{}: {link}",
                page.display()
            );
            links += 1;
        }
    }
    assert!(links > 20, "{links}");
}

#[test]
fn every_scene_is_in_the_table_with_its_picture() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let page = std::fs::read_to_string(folder.join("README.md")).unwrap();
    let mut scenes = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let row = page
            .lines()
            .find(|line| line.starts_with(&format!("| [{name}.toml]")));
        assert!(
            row.is_some_and(|row| row.contains(&format!("pictures/{name}.png"))),
            "{name}"
        );
        let picture = std::fs::read(folder.join(format!("pictures/{name}.png"))).unwrap();
        assert!(picture.starts_with(b"\x89PNG"), "{name}");
        scenes += 1;
    }
    assert!(scenes >= 20, "{scenes}");
}
