//! Seams between chains of different numbers of vertices: each vertex of the finer one goes to a point of the other, by
//! their lengths.

use crate::exact_runs::{METHODS, run};
use crate::scene_text::{scene, written};
use cloth_bench::method::Method;
use cloth_bench::run::{Plan, Solver, run_changing, to_rest};
use cloth_bench::scene::file;
use cloth_bench::settings::Settings;
use cloth_core::element::Element;
use cloth_core::energy::Stitch;
use cloth_core::math::Vec3;
use cloth_core::measure::{angular_momentum, linear_momentum};

/// Sheets of 0.2 m and 5 × 5 and 8 × 8 vertices, 0.1 m apart without gravity, to be sewn along the facing sides.
fn two_free(seam: &str) -> String {
    format!(
        "dt = 0.005\ngravity = [0, 0, 0]\n\
         [[mesh]]\ngenerator = \"grid:5x5:alternating\"\nscale = 0.2\n\
         [[mesh]]\ngenerator = \"grid:8x8:alternating\"\nscale = 0.2\ntranslate = [0.3, 0, 0]\n\
         [cloth]\nstiffness = 1000\n\
         [[seam]]\nmeshes = [0, 1]\nfirst_border = [4, 24]\nsecond_border = [0, 56]\n{seam}"
    )
}

/// Where (m) a vertex and its point on an edge are on their chains, in the order of the chains.
fn along(chain: &[Vec3], x: Vec3) -> f64 {
    let mut before = 0.0;
    for ends in chain.windows(2) {
        let (edge, from) = (ends[1] - ends[0], x - ends[0]);
        let part = from.dot(&edge) / edge.norm_squared();
        if (from - edge * part).norm() < 1e-9 && (-1e-9..=1.0 + 1e-9).contains(&part) {
            return before + from.norm();
        }
        before += edge.norm();
    }
    panic!("{x} is not on the chain");
}

/// Around a corner, with edges of 4 and of 9 cm on one piece and of 5 cm on a straight border of the other.
#[test]
fn points_of_a_seam_are_at_the_same_fraction_of_both_lengths() {
    let text = "[[mesh]]\ngenerator = \"grid:6x5:alternating\"\nscale = [0.2, 0.36, 1]\n\
         [[mesh]]\ngenerator = \"grid:4x2:alternating\"\nscale = 0.15\ntranslate = [0, 1, 0]\n\
         [[seam]]\nmeshes = [0, 1]\nfirst_border = [5, 0, 24]\nsecond_border = [0, 3]\nuntil = 1\n";
    let scene = scene("corner-seam", text);
    let x = &scene.start.positions;
    let first = [5, 4, 3, 2, 1, 0, 6, 12, 18, 24].map(|v: usize| x[v]);
    let second = [30, 31, 32, 33].map(|v: usize| x[v]);
    let length = |chain: &[Vec3]| chain.windows(2).map(|e| (e[1] - e[0]).norm()).sum::<f64>();
    let seam = scene.model.seam();
    assert_eq!(seam.pairs.len() + seam.onto_edges.len(), 10);
    assert_eq!(seam.pairs.len(), 2, "the ends");
    for stitch in &seam.onto_edges {
        let vertex = x[stitch.vertices()[0] as usize];
        let point = vertex - stitch.gap(x);
        let fractions = [
            along(&first, vertex) / length(&first),
            along(&second, point) / length(&second),
        ];
        let error = (fractions[0] - fractions[1]).abs();
        assert!(error < 1e-12, "{stitch:?}: {fractions:?}");
    }
}

/// Every vertex of a chain is held: one between two others of which all points are far away is sewn to the other chain.
#[test]
fn no_vertex_of_the_coarser_chain_is_left_out() {
    // Vertices at 0, 0.45, 0.5, 0.55 and 1 m of one border, and every sixth of it of the other.
    let mut obj = String::new();
    for z in [0.0, 0.2] {
        for x in [0.0, 0.45, 0.5, 0.55, 1.0] {
            obj += &format!("v {x} 0 {z}\n");
        }
    }
    for v in 1..5 {
        obj += &format!("f {v} {} {}\nf {} {} {v}\n", v + 1, v + 6, v + 6, v + 5);
    }
    let text = "[[mesh]]\nfile = \"dense.obj\"\n\
         [[mesh]]\ngenerator = \"grid:6x2:alternating\"\ntranslate = [0, 0.3, 0]\n\
         [[seam]]\nmeshes = [0, 1]\nfirst = [0, 1, 2, 3, 4]\nsecond_border = [0, 5]\nuntil = 1\n";
    let path = written("left-out", text);
    std::fs::write(path.with_file_name("dense.obj"), obj).unwrap();
    let scene = file::build(&path, &Settings::default()).unwrap();
    let order = scene.order.as_ref().unwrap();
    let seam = scene.model.seam();
    let all = seam.sewn_onto_edges().concat();
    let all = [all, seam.sewn_pairs().concat()].concat();
    for old in 0..5 {
        let new = order.new_of_old()[old];
        assert!(all.contains(&new), "{old}: {seam:?}");
    }
    assert_eq!(seam.onto_edges.len() + seam.pairs.len(), 7);
    let settings = ["tolerance=1e-10"];
    let (summary, _) = run(&scene, "implicit-euler", &settings, 120);
    let gap = summary.max_seam_gap.unwrap();
    assert!(gap < 1e-3, "{gap:e} m");
}

/// Stitches onto edges change no momentum, as those between vertices do not.
#[test]
fn a_seam_of_two_counts_keeps_the_momentum_of_free_pieces() {
    let scene = scene("uneven", &two_free("until = 0.1\n"));
    let particles = &scene.model.particles;
    for (name, settings) in METHODS {
        let mut scene = scene.clone();
        for (i, v) in scene.start.velocities.iter_mut().enumerate() {
            let phase = i as f64;
            *v = Vec3::new(0.1 + phase.cos(), (2.0 * phase).sin(), 0.7) * 0.1;
        }
        let moving = linear_momentum(particles, &scene.start.velocities);
        let turning = angular_momentum(particles, &scene.start);
        // Damping of hinges keeps no spin.
        let is_symplectic = name == "symplectic-euler";
        let settings = if is_symplectic { &[] } else { settings };
        let (_, state) = run(&scene, name, settings, 40);
        let lost = (linear_momentum(particles, &state.velocities) - moving).norm() / moving.norm();
        assert!(lost < 1e-10, "{name} lost {lost:e} of its momentum");
        if is_symplectic {
            let lost = (angular_momentum(particles, &state) - turning).norm() / turning.norm();
            assert!(lost < 1e-10, "{name} lost {lost:e} of its spin");
        }
    }
}

/// All stitches close at a constant rate, and are closed then but for what accelerates the sheets.
#[test]
fn a_seam_of_two_counts_closes_in_its_time() {
    let scene = scene("closing", &two_free("until = 0.2\n"));
    // The borders are parallel, so all points face their vertices.
    let seam = scene.model.seam();
    assert_eq!([seam.pairs.len(), seam.onto_edges.len()], [2, 6]);
    for gap in seam.gaps(&scene.start.positions) {
        assert!((gap - Vec3::x() * 0.1).norm() < 1e-15, "{gap}");
    }
    for (name, settings) in METHODS {
        let method = Method::find(name).unwrap();
        let settings = Settings::parse(settings).unwrap();
        let mut solver = Solver::new(method, &settings, &scene, scene.dt).unwrap();
        let mut state = scene.start.clone();
        let mut largest: f64 = 0.0;
        let plan = Plan::new(scene.dt, 80);
        let (summary, _) = run_changing(&scene, &mut solver, &mut state, plan, |moment| {
            let expected = 0.1 * (1.0 - moment.state.time / 0.2).clamp(0.0, 1.0);
            for gap in seam.gaps(&moment.state.positions) {
                largest = largest.max((gap.norm() - expected).abs());
            }
            Ok(())
        })
        .unwrap();
        let gap = summary.max_seam_gap.unwrap();
        assert!(largest < 6e-4, "{name}: {largest:e} m from the schedule");
        assert!(gap < 1e-3, "{name}: {gap:e} m");
        assert!(
            summary.energy_excess <= 0.01 * summary.energy_given,
            "{name}"
        );
    }
}

/// What hangs from such a seam opens it by its weight over the sum of all stiffnesses, in the mean.
#[test]
fn a_sheet_that_hangs_from_an_uneven_seam_opens_it_by_its_weight() {
    const K: f64 = 20.0;
    let text = format!(
        "dt = 0.01\n[[mesh]]\ngenerator = \"grid:7x3:alternating\"\nscale = 0.3\nrotate = [1.5707963267948966, 0, 0]\n\
         [[mesh]]\ngenerator = \"grid:10x7:alternating\"\nscale = [0.3, 0.45, 1]\nrotate = [1.5707963267948966, 0, 0]\n\
         translate = [0, 0, -0.3]\n[cloth]\nstiffness = 500\n[[pins]]\nvertices = {:?}\n\
         [[seam]]\nmeshes = [0, 1]\nfirst_border = [0, 6]\nsecond_border = [60, 69]\nstiffness = {K}\n",
        (0..21).collect::<Vec<u32>>()
    );
    let scene = scene("uneven-weights", &text);
    let seam = scene.model.seam();
    assert!(
        seam.onto_edges.len() == 6 && seam.pairs.len() == 4,
        "{seam:?}"
    );
    let masses = scene.model.particles.mass();
    let weight = 9.81 * masses[21..].iter().sum::<f64>();
    let expected = weight / (10.0 * K);
    for (name, settings) in METHODS {
        let method = Method::find(name).unwrap();
        let settings = Settings::parse(settings).unwrap();
        let mut solver = method.build(&scene, &settings, scene.dt).unwrap();
        let mut state = scene.start.clone();
        to_rest(&scene, &mut *solver, &mut state, scene.dt, 20_000, 1e-9).unwrap();
        let mean = seam.gaps(&state.positions).map(|gap| gap.z).sum::<f64>() / 10.0;
        let error = (mean.abs() / expected - 1.0).abs();
        assert!(error < 1e-6, "{name}: {mean:e} m, {error:e}");
    }
}

/// A sleeve of 18 vertices around is sewn to an armhole of 12, all the way round, without a crossing.
#[test]
fn a_seam_goes_all_the_way_round() {
    let text = "dt = 0.005\ngravity = [0, 0, 0]\n\
         [[mesh]]\ngenerator = \"tube:12x4\"\nscale = [0.4, 0.4, 0.2]\n\
         [[mesh]]\ngenerator = \"tube:18x6\"\nscale = [0.4, 0.4, 0.2]\ntranslate = [0, 0, 0.24]\n\
         [cloth]\nstiffness = 1000\n[contact]\nself = true\n\
         [[seam]]\nmeshes = [0, 1]\nfirst_border = [48, 49, 48]\nsecond_border = [0, 1, 0]\nuntil = 0.3\n";
    let scene = scene("round", text);
    let seam = scene.model.seam();
    assert_eq!([seam.pairs.len(), seam.onto_edges.len()], [6, 12]);
    let x = &scene.start.positions;
    let angle = |x: Vec3| x.y.atan2(x.x);
    for stitch in &seam.onto_edges {
        let vertex = x[stitch.vertices()[0] as usize];
        let apart = (angle(vertex) - angle(vertex - stitch.gap(x))).abs();
        // A third of an edge is not a third of its angle.
        assert!(apart < 0.02, "{apart}");
    }
    for name in ["implicit-euler", "xpbd", "pd"] {
        let (method, settings) = (Method::find(name).unwrap(), Settings::default());
        let mut solver = Solver::new(method, &settings, &scene, scene.dt).unwrap();
        let mut state = scene.start.clone();
        let mut probe = scene.separation_probe().unwrap();
        let mut crossed = 0;
        let plan = Plan::new(scene.dt, 120);
        let (summary, _) = run_changing(&scene, &mut solver, &mut state, plan, |moment| {
            let seen = probe.measure(&moment.state.positions).unwrap();
            crossed += seen.intersecting_pairs;
            Ok(())
        })
        .unwrap();
        let gap = summary.max_seam_gap.unwrap();
        assert!(gap < 1e-3 && crossed == 0, "{name}: {gap:e} m, {crossed}");
    }
}

/// A stitch of a scene that begins later does so with the points of the same edges.
#[test]
fn an_uneven_seam_can_begin_later() {
    let scene = scene("later", &two_free("from = 0.05\nuntil = 0.15\n"));
    assert_eq!(scene.model.seam().onto_edges, Vec::<Stitch<3>>::new());
    for name in ["implicit-euler", "xpbd", "pd"] {
        let (summary, _) = run(&scene, name, &[], 80);
        let gap = summary.max_seam_gap.unwrap();
        assert!(gap < 1e-3, "{name}: {gap:e} m");
        assert_eq!(summary.rebuilds, 1);
    }
}

#[test]
fn what_is_wrong_with_an_uneven_seam_is_said_with_line_and_key() {
    let told = |name: &str, seam: &str| {
        let text = format!(
            "[[mesh]]\ngenerator = \"grid:5x2:alternating\"\n[[mesh]]\ngenerator = \"grid:3x3:alternating\"\n\
             translate = [2, 0, 0]\n[[seam]]\n{seam}"
        );
        let built = file::build(&written(name, &text), &Settings::default());
        built.unwrap_err().to_string()
    };
    for (name, seam, line, words) in [
        (
            "no-edge",
            "meshes = [0, 1]\nfirst = [0, 2, 3]\nsecond = [0, 1]\nuntil = 1\n",
            9,
            "no edge joins vertices 0 and 2",
        ),
        (
            "one",
            "meshes = [0, 1]\nfirst = [0, 1, 2]\nsecond = [0]\nuntil = 1\n",
            9,
            "a chain of one vertex has no length",
        ),
        (
            "half-round",
            "meshes = [0, 1]\nfirst_border = [0, 1, 0]\nsecond_border = [0, 2]\nuntil = 1\n",
            9,
            "one of the chains goes all the way round",
        ),
        (
            "flat",
            "meshes = [0, 0]\nfirst = [8, 7]\nsecond = [1, 2, 3]\nuntil = 1\n",
            9,
            "their triangle would vanish",
        ),
    ] {
        let said = told(name, seam);
        let place = format!("{name}.toml: line {line}: ");
        assert!(said.contains(&place) && said.contains(words), "{said}");
    }
}
