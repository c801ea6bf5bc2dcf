//! Seams: two borders are drawn together and stay so, by every method, and nothing is crossed or pushed for it.

use crate::scene_text::scene;
use cloth_bench::error::BenchError;
use cloth_bench::method::Method;
use cloth_bench::run::{Plan, Solver, Summary, run_changing, simulate, to_rest};
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_collide::SeparationProbe;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{angular_momentum, linear_momentum};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::State;
use std::path::{Path, PathBuf};

/// Those that sew: all but forward Euler, which refuses every step.
const METHODS: [&str; 9] = [
    "symplectic-euler",
    "implicit-euler",
    "linear-implicit",
    "implicit-midpoint",
    "bdf2",
    "pbd",
    "xpbd",
    "xpbd-direct",
    "pd",
];

fn build(name: &str, text: &str) -> Result<Scene, BenchError> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("seam");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, text).unwrap();
    file::build(&path, &Settings::default())
}

/// Settings with which an iteration goes on to rounding, if it has a tolerance.
fn converged(method: &str) -> Settings {
    let pairs: &[&str] = match method {
        "implicit-euler" | "bdf2" | "implicit-midpoint" => &["tolerance=1e-12"],
        "pd" => &["iterations=200"],
        // With one visit a substep a row has its own stiffness, whatever its neighbours do.
        "pbd" => &["iterations=1", "substeps=20"],
        _ => &[],
    };
    Settings::parse(pairs).unwrap()
}

/// A run; `after` sees every state.
fn run(
    scene: &Scene,
    method: &str,
    settings: &Settings,
    steps: u32,
    mut after: impl FnMut(&Scene, &State),
) -> (Summary, State) {
    let method = Method::find(method).unwrap();
    let mut solver = Solver::new(method, settings, scene, scene.dt).unwrap();
    let mut state = scene.start.clone();
    let plan = Plan::new(scene.dt, steps);
    let see = |moment: &cloth_bench::run::Moment<'_>| {
        after(moment.scene, moment.state);
        Ok(())
    };
    let (summary, _) = run_changing(scene, &mut solver, &mut state, plan, see).unwrap();
    (summary, state)
}

/// The vectors (m) between sewn vertices.
fn gaps(pairs: &[[u32; 2]], x: &[Vec3]) -> Vec<Vec3> {
    let of = |pair: &[u32; 2]| x[pair[0] as usize] - x[pair[1] as usize];
    pairs.iter().map(of).collect()
}

/// Two sheets of 0.2 m beside each other, 0.1 m apart, without gravity.
fn two_free(seam: &str) -> String {
    format!(
        "dt = 0.005\ngravity = [0, 0, 0]\n\
         [[mesh]]\ngenerator = \"grid:5x5:alternating\"\nscale = 0.2\n\
         [[mesh]]\ngenerator = \"grid:5x5:alternating\"\nscale = 0.2\ntranslate = [0.3, 0, 0]\n\
         [cloth]\nstiffness = 1000\n\
         [[seam]]\nmeshes = [0, 1]\nfirst = [4, 9, 14, 19, 24]\nsecond = [0, 5, 10, 15, 20]\n{seam}"
    )
}

#[test]
fn a_sheet_that_hangs_from_a_seam_opens_it_by_its_weight() {
    const K: Real = 20.0;
    let text = format!(
        "dt = 0.01\n[[mesh]]\ngenerator = \"grid:7x3:alternating\"\nscale = 0.3\nrotate = [1.5707963267948966, 0, 0]\n\
         [[mesh]]\ngenerator = \"grid:7x7:alternating\"\nscale = 0.3\nrotate = [1.5707963267948966, 0, 0]\n\
         translate = [0, 0, -0.3]\n[cloth]\nstiffness = 500\n[[pins]]\nvertices = {:?}\n\
         [[seam]]\nmeshes = [0, 1]\nfirst_border = [0, 6]\nsecond_border = [42, 48]\nstiffness = {K}\n",
        (0..21).collect::<Vec<u32>>()
    );
    let scene = build("weights", &text).unwrap();
    let pairs = scene.sewn();
    assert_eq!(pairs.len(), 7);
    let masses = scene.model.particles.mass();
    let weight: Real = 9.81 * masses[21..].iter().sum::<Real>();
    let expected = weight / (7.0 * K);
    for name in METHODS {
        let method = Method::find(name).unwrap();
        let mut solver = method.build(&scene, &converged(name), scene.dt).unwrap();
        let mut state = scene.start.clone();
        to_rest(&scene, &mut *solver, &mut state, scene.dt, 20_000, 1e-9).unwrap();
        let all = gaps(&pairs, &state.positions);
        let mean = all.iter().map(|gap| gap.z).sum::<Real>() / 7.0;
        let error = (mean / expected - 1.0).abs();
        assert!(error < 1e-7, "{name}: {mean:e} m, {error:e}");
    }
}

#[test]
fn sewing_keeps_the_momentum_of_free_pieces() {
    let scene = build("momentum", &two_free("until = 0.1\n")).unwrap();
    let particles = &scene.model.particles;
    for name in METHODS {
        let mut scene = scene.clone();
        for (i, v) in scene.start.velocities.iter_mut().enumerate() {
            let phase = i as Real;
            *v = Vec3::new(
                0.1 + phase.cos(),
                (2.0 * phase).sin(),
                0.7 - 0.2 * phase.sin(),
            ) * 0.2;
        }
        let moving = linear_momentum(particles, &scene.start.velocities);
        let turning = angular_momentum(particles, &scene.start);
        let (_, state) = run(&scene, name, &converged(name), 40, |_, _| {});
        let drift = (linear_momentum(particles, &state.velocities) - moving).norm() / moving.norm();
        assert!(drift < 1e-10, "{name} lost {drift:e} of its momentum");
        // The other methods do not keep it of springs either.
        if name == "symplectic-euler" {
            let drift = (angular_momentum(particles, &state) - turning).norm() / turning.norm();
            assert!(drift < 1e-10, "{name} lost {drift:e} of its spin");
        }
    }
}

/// Before `from` nothing moves; then the distance follows the rest length, but for what accelerates the sheets.
#[test]
fn the_distance_falls_at_a_constant_rate_and_stays_zero() {
    const START: Real = 0.1;
    for (text, from, until) in [
        ("until = 0.2\n", 0.0, 0.2),
        ("from = 0.05\nuntil = 0.25\n", 0.05, 0.25),
    ] {
        // Pieces that are not sewn would be kept 2 mm apart.
        let text = two_free(text) + "[contact]\nself = true\nthickness = 2e-3\n";
        let scene = build(&format!("schedule-{from}"), &text).unwrap();
        for name in METHODS {
            let mut largest: Real = 0.0;
            let pairs = [4, 9, 14, 19, 24].map(|v| [v, 21 + v]);
            let (summary, state) = run(&scene, name, &converged(name), 80, |_, state| {
                let past = (state.time - from) / (until - from);
                let expected = START * (1.0 - past).clamp(0.0, 1.0);
                for gap in gaps(&pairs, &state.positions) {
                    largest = largest.max((gap.norm() - expected).abs());
                }
            });
            assert!(largest < 6e-4, "{name}: {largest:e} m from the schedule");
            let left = gaps(&pairs, &state.positions);
            assert!(left.iter().all(|gap| gap.norm() < 1e-3), "{name}: {left:?}");
            assert_eq!(summary.rebuilds, u32::from(from > 0.0), "{name}");
            assert!(
                summary.energy_excess <= 0.01 * summary.energy_given,
                "{name}: {summary:?}"
            );
        }
    }
}

/// It refuses motion that was not given, and a seam that closes at a constant rate takes nothing of what gravity gives:
/// the panels of the shipped scene, with no arm between them.
#[test]
fn symplectic_euler_sews_panels_that_fall() {
    const STEPS: u32 = 50;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/seam.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let (panels, _) = text.split_once("[[obstacle]]").unwrap();
    let scene = build("falling", panels).unwrap();
    let settings = Settings::default();
    let (summary, state) = run(&scene, "symplectic-euler", &settings, STEPS, |_, _| {});
    assert!(summary.max_seam_gap.unwrap() < 1e-3, "{summary:?}");
    let particles = &scene.model.particles;
    let mass: Real = particles.mass().iter().sum();
    let fall = linear_momentum(particles, &state.velocities) / mass;
    let expected = Vec3::z() * (-9.81 * scene.dt * Real::from(STEPS));
    assert!((fall - expected).norm() < 1e-10, "{fall}");
}

#[test]
fn projective_dynamics_factorises_once_while_a_seam_closes() {
    let scene = build("matrix", &two_free("until = 0.2\n")).unwrap();
    let method = Method::find("pd").unwrap();
    let mut stepper = method
        .build(&scene, &Settings::default(), scene.dt)
        .unwrap();
    let mut state = scene.start.clone();
    let mut factorizations = 0;
    for _ in 0..60 {
        let input = cloth_core::step::StepInput::new(scene.dt);
        factorizations += stepper.step(&mut state, input).unwrap().factorizations;
    }
    assert_eq!(factorizations, 1);
    let left = gaps(&scene.sewn(), &state.positions);
    assert!(left.iter().all(|gap| gap.norm() < 1e-3), "{left:?}");
}

/// The cloth with sewn vertices as one, where their middle is.
fn welded(mesh: &TriMesh, pairs: &[[u32; 2]], x: &[Vec3]) -> TriMesh {
    let mut same: Vec<usize> = (0..x.len()).collect();
    let mut middle = x.to_vec();
    for [a, b] in pairs.iter().map(|pair| pair.map(|v| v as usize)) {
        same[b] = a;
        middle[a] = (x[a] + x[b]) / 2.0;
    }
    let kept: Vec<usize> = (0..x.len()).filter(|&v| same[v] == v).collect();
    let place = |v: u32| kept.binary_search(&same[v as usize]).unwrap() as u32;
    let triangles = mesh.triangles().iter().map(|t| t.map(place)).collect();
    TriMesh::new(kept.iter().map(|&v| middle[v]).collect(), triangles).unwrap()
}

/// The sleeve of the shipped scene: its seams close to far less than the thickness of contact, and nothing crosses.
#[test]
fn a_sleeve_is_sewn_around_an_arm_without_a_crossing() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/seam.toml");
    let scene = file::build(&path, &Settings::default()).unwrap();
    let pairs = scene.sewn();
    for name in ["xpbd", "pd", "implicit-euler"] {
        let mut probe = scene.separation_probe().unwrap();
        let mut crossed = 0;
        let (summary, state) = run(&scene, name, &Settings::default(), 60, |_, state| {
            crossed += probe.measure(&state.positions).unwrap().intersecting_pairs;
        });
        assert_eq!(crossed, 0, "{name}");
        assert_eq!(summary.obstacle_intersections, Some(0), "{name}");
        let left = gaps(&pairs, &state.positions);
        let widest = left.iter().map(Vec3::norm).fold(0.0, Real::max);
        assert_eq!(summary.max_seam_gap, Some(widest), "{name}");
        assert!(widest < 2e-4, "{name}: {widest:e} m apart");
        let mesh = scene.mesh.as_ref().unwrap();
        let mesh = welded(mesh, &pairs, &state.positions);
        let met = SeparationProbe::new(&mesh)
            .measure(mesh.positions())
            .unwrap();
        assert_eq!(met.intersecting_pairs, 0, "{name}");
    }
}

/// Two sheets that lie on each other's border, sewn from the start: contact leaves the seam alone, and they fall as
/// one.
#[test]
fn a_seam_that_is_closed_at_the_start_falls_without_a_push() {
    let text = "dt = 0.005\n[[mesh]]\ngenerator = \"grid:5x5:alternating\"\nscale = 0.2\n\
         [[mesh]]\ngenerator = \"grid:5x5:alternating\"\nscale = 0.2\ntranslate = [0.2, 0, 0]\n\
         [[seam]]\nmeshes = [0, 1]\nfirst_border = [4, 24]\nsecond_border = [0, 20]\n\
         [contact]\nself = true\nthickness = 5e-3\n";
    let scene = build("closed", text).unwrap();
    for name in METHODS {
        let (_, state) = run(&scene, name, &converged(name), 20, |_, _| {});
        for gap in gaps(&scene.sewn(), &state.positions) {
            assert!(gap.norm() < 1e-12, "{name}: {gap}");
        }
        let fall = Vec3::new(0.0, 0.0, -9.81 * 0.1);
        for v in &state.velocities {
            assert!((v - fall).norm() < 1e-9, "{name}: {v}");
        }
    }
}

#[test]
fn a_tear_and_a_hand_leave_seams_as_they_are() {
    let more = "until = 0.1\n[[event]]\ndo = \"tear\"\ntime = 0.05\nbox = [[0.06, 0.11, -1], [0.09, 0.14, 1]]\n\
         [[pins]]\nvertices = [0]\nfrom = 0.03\nuntil = 0.12\n";
    let scene = build("torn", &two_free(more)).unwrap();
    for name in ["implicit-euler", "xpbd", "pd"] {
        let (summary, state) = run(&scene, name, &converged(name), 60, |scene, _| {
            assert_eq!(scene.sewn().len(), 5, "{name}");
        });
        // Projective dynamics corrects its factor instead.
        assert_eq!(summary.rebuilds > 0, name != "pd", "{name}");
        let left = gaps(&scene.sewn(), &state.positions);
        assert!(left.iter().all(|gap| gap.norm() < 1e-3), "{name}: {left:?}");
    }
}

/// Vertices of files are renumbered; a seam joins the same points all the same.
#[test]
fn seams_of_meshes_from_files_join_the_vertices_that_are_named() {
    let by_generator = build("generated", &two_free("until = 1\n")).unwrap();
    let sheet = grid(5, 5, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let mut obj = String::new();
    for x in sheet.positions() {
        obj += &format!("v {} {} {}\n", x.x, x.y, x.z);
    }
    for [a, b, c] in sheet.triangles() {
        obj += &format!("f {} {} {}\n", a + 1, b + 1, c + 1);
    }
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("seam");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("grid.obj"), obj).unwrap();
    let text = two_free("until = 1\n");
    let text = text.replace(
        "generator = \"grid:5x5:alternating\"",
        "file = \"grid.obj\"",
    );
    let by_file = build("filed", &text).unwrap();
    assert!(by_file.order.is_some());
    let ends = |scene: &Scene| -> Vec<[Vec3; 2]> {
        let x = |v: u32| scene.start.positions[v as usize];
        scene.sewn().iter().map(|pair| pair.map(x)).collect()
    };
    assert_eq!(ends(&by_file), ends(&by_generator));
    assert_ne!(by_file.sewn(), by_generator.sewn());
}

#[test]
fn what_is_wrong_with_a_seam_is_said_with_line_and_key() {
    let told = |name: &str, seam: &str| {
        let text = format!(
            "[[mesh]]\ngenerator = \"grid:4x4:alternating\"\n[[mesh]]\ngenerator = \"grid:3x3:alternating\"\ntranslate = [2, 0, 0]\n[[seam]]\n{seam}"
        );
        build(name, &text).unwrap_err().to_string()
    };
    for (name, seam, line, words) in [
        (
            "mesh",
            "meshes = [0, 2]\nfirst = [0, 1]\nsecond = [0, 1]\n",
            7,
            "there is no mesh 2",
        ),
        (
            "inner",
            "meshes = [0, 1]\nfirst = [0, 5]\nsecond = [0, 1]\n",
            8,
            "vertex 5 of mesh 0 is not on its border",
        ),
        (
            "repeated",
            "meshes = [0, 1]\nfirst = [0, 1]\nsecond = [2, 2]\n",
            9,
            "vertex 2 is there twice",
        ),
        (
            "beyond",
            "meshes = [0, 1]\nfirst = [0, 1]\nsecond = [2, 9]\n",
            9,
            "mesh 1 has no vertex 9, only 0 to 8",
        ),
        (
            "none",
            "meshes = [0, 1]\nfirst = [0, 1]\nuntil = 1\n",
            6,
            "needs one of the keys second and second_border",
        ),
        (
            "both-ways",
            "meshes = [0, 1]\nfirst_border = [0, 15]\nsecond = [0]\n",
            8,
            "name a vertex in between",
        ),
        (
            "itself",
            "meshes = [0, 0]\nfirst = [0, 1]\nsecond = [1, 2]\n",
            9,
            "vertex 1 is in both chains",
        ),
        (
            "edge",
            "meshes = [0, 0]\nfirst = [0]\nsecond = [1]\n",
            9,
            "ends of one edge",
        ),
        (
            "apart",
            "meshes = [0, 1]\nfirst = [0]\nsecond = [0]\n",
            6,
            "needs until",
        ),
        (
            "order",
            "meshes = [0, 1]\nfirst = [0]\nsecond = [0]\nfrom = 2\nuntil = 1\n",
            11,
            "until has to be later than from",
        ),
        (
            "twice",
            "meshes = [0, 1]\nfirst = [0]\nsecond = [0]\nuntil = 1\n[[seam]]\nmeshes = [1, 0]\nfirst = [0]\nsecond = [0]\n",
            11,
            "sewn together by another",
        ),
    ] {
        let told = told(name, seam);
        let place = format!("{name}.toml: line {line}: ");
        assert!(told.contains(&place) && told.contains(words), "{told}");
    }
}

/// Four seams along the sides of a pillow share its corners: every pair is sewn once, as by one seam all the way round.
#[test]
fn seams_that_meet_at_corners_sew_every_pair_once() {
    let sheet = "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n";
    let sewn = |chains: &[&str]| {
        let seam = |chain: &&str| {
            format!(
                "[[seam]]\nmeshes = [0, 1]\nfirst_border = {chain}\nsecond_border = {chain}\nuntil = 1\n"
            )
        };
        let seams: String = chains.iter().map(seam).collect();
        let text = format!("{sheet}{sheet}translate = [0, 0, 0.1]\n{seams}");
        let mut pairs = build("pillow", &text).unwrap().sewn();
        pairs.sort_unstable();
        pairs
    };
    let sides = sewn(&["[0, 4]", "[4, 24]", "[24, 20]", "[20, 0]"]);
    assert_eq!(sides.len(), 16);
    assert_eq!(sides, sewn(&["[0, 4, 0]"]));
}

#[test]
fn a_chain_goes_along_the_border_the_way_that_is_named() {
    let chain = |border: &str, count: usize| {
        let other: Vec<usize> = (0..count).collect();
        let text = format!(
            "[[mesh]]\ngenerator = \"grid:4x4:alternating\"\n[[mesh]]\ngenerator = \"grid:24x2:alternating\"\ntranslate = [2, 0, 0]\n\
             [[seam]]\nmeshes = [0, 1]\nfirst_border = {border}\nsecond = {other:?}\nuntil = 1\n"
        );
        let sewn = build("way", &text).unwrap().sewn();
        sewn.iter().map(|pair| pair[0]).collect::<Vec<u32>>()
    };
    assert_eq!(chain("[0, 3]", 4), [0, 1, 2, 3]);
    assert_eq!(chain("[3, 0]", 4), [3, 2, 1, 0]);
    assert_eq!(chain("[1, 4]", 3), [1, 0, 4]);
    assert_eq!(chain("[0, 3, 15]", 7), [0, 1, 2, 3, 7, 11, 15]);
    assert_eq!(chain("[0, 12, 15]", 7), [0, 4, 8, 12, 13, 14, 15]);
    assert_eq!(chain("[0, 15, 3]", 10), [0, 4, 8, 12, 13, 14, 15, 11, 7, 3]);
}

/// A method without a place for a rest length that changes says so.
#[test]
fn single_precision_refuses_seams_by_name() {
    let scene = build("single", &two_free("until = 0.2\n")).unwrap();
    let settings = Settings::parse(&["precision=single"]).unwrap();
    let refused = Method::find("xpbd")
        .unwrap()
        .build(&scene, &settings, scene.dt);
    let told = refused.map(drop).unwrap_err().to_string();
    assert!(told.contains("stitches"), "{told}");
}

/// Two sheets that are sewn together in 0.15 s and then fall on a ball. What the seam stores as it closes is far more
/// than the cloth has by its motion, and no measure of what that may gain.
#[test]
fn a_seam_that_closes_hides_no_energy_from_nowhere() {
    let sheet = |cells: u32, height: f64| {
        format!(
            "[[mesh]]\ngenerator = \"grid:{cells}x{cells}:alternating\"\nscale = [0.4, 0.4, 1]\n\
             translate = [-0.2, -0.2, {height}]\n"
        )
    };
    let text = format!(
        "steps = 30\n{}{}[cloth]\ndensity = 0.2\nstiffness = 3000\n[[seam]]\nmeshes = [0, 1]\n\
         first_border = [0, 1, 0]\nsecond_border = [0, 1, 0]\nuntil = 0.15\n[[obstacle]]\nshape = \"sphere\"\n\
         radius = 0.14\nposition = [0.01, 0.005, 0.15]\n[contact]\nself = true\n",
        sheet(21, 0.4),
        sheet(17, 0.43)
    );
    let scene = scene("sewn-falls", &text);
    let method = Method::find("xpbd").unwrap();
    let settings = Settings::parse(&["substeps=auto"]).unwrap();
    let (end, _) = simulate(&scene, method, &settings, scene.dt, scene.steps).unwrap();
    let (excess, given) = (end.energy_excess, end.energy_given);
    assert!(excess < 0.01 * given, "{excess} J of {given}");
}

/// Both sheets are held by their far sides: a soft seam cannot close, and the run says so, once it should have.
#[test]
fn a_seam_that_cannot_close_is_told() {
    let pins = "[[pins]]\nvertices = [0, 5, 10, 15, 20, 29, 34, 39, 44, 49]\n";
    let scene = build(
        "held",
        &format!("{}{pins}", two_free("until = 0.05\nstiffness = 10\n")),
    )
    .unwrap();
    let ends = |steps| {
        run(
            &scene,
            "implicit-euler",
            &Settings::default(),
            steps,
            |_, _| (),
        )
        .0
    };
    assert_eq!(ends(8).open_seam, None);
    let (told, gap) = (ends(20).open_seam.unwrap(), ends(20).max_seam_gap.unwrap());
    assert!(
        told.contains(&format!("open by {gap:.4} m between vertices")),
        "{told}"
    );
    // What nothing holds closes.
    let free = build("closes", &two_free("until = 0.05\n")).unwrap();
    assert_eq!(
        run(&free, "implicit-euler", &Settings::default(), 20, |_, _| ())
            .0
            .open_seam,
        None
    );
}
