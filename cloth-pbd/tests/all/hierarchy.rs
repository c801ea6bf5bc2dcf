//! Coarse levels: who is on them, what they prolongate, what they leave alone, and what they save.

use crate::counting_allocator;

use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::Strain;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, disk, grid, irregular, tube, without_triangles};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, Observer, StepInput, Stepper};
use cloth_core::topology::EdgeTable;
use cloth_pbd::{Hierarchy, HierarchyConfig, HierarchyError, PbdConfig, PbdSolver, StiffnessRule};
use std::collections::BTreeSet;

fn uneven(mesh: &TriMesh) -> Particles {
    let mass = |v: usize| 0.01 + 0.003 * (v % 5) as Real;
    Particles::new((0..mesh.vertex_count()).map(mass).collect()).unwrap()
}

/// A sheet with a hole.
fn holed() -> TriMesh {
    let sheet = irregular(16, 1.0, 1.0, 11).unwrap();
    let middle = |_, corners: [Vec3; 3]| {
        let centre = corners.iter().sum::<Vec3>() / 3.0;
        (centre - Vec3::new(0.5, 0.5, 0.0)).norm() < 0.25
    };
    without_triangles(&sheet, middle).unwrap()
}

fn meshes() -> Vec<TriMesh> {
    vec![
        grid(17, 13, 1.0, 1.0, Diagonals::Alternating).unwrap(),
        grid(12, 12, 1.0, 1.0, Diagonals::OneWay).unwrap(),
        irregular(20, 1.0, 1.0, 7).unwrap(),
        holed(),
        disk(8, 1.0).unwrap(),
        tube(16, 10, 0.3, 1.0).unwrap(),
    ]
}

fn build(mesh: &TriMesh, particles: &Particles, config: HierarchyConfig) -> Hierarchy {
    Hierarchy::build(mesh, particles, config).unwrap()
}

#[test]
fn every_vertex_is_on_the_next_level_or_has_parents_there() {
    for mesh in meshes() {
        let edges = EdgeTable::build(&mesh).unwrap();
        let rim: BTreeSet<u32> = (0..edges.len())
            .filter(|&edge| edges.is_boundary(edge))
            .flat_map(|edge| edges.ends()[edge])
            .collect();
        let mut particles = uneven(&mesh);
        particles.prescribe(5).unwrap();
        for parents in [1, 2, 3] {
            let config = HierarchyConfig {
                parents,
                ..HierarchyConfig::default()
            };
            let hierarchy = build(&mesh, &particles, config);
            assert!(hierarchy.level_count() >= 2, "{}", hierarchy.level_count());
            let mut finer: BTreeSet<u32> = (0..mesh.vertex_count() as u32).collect();
            for level in 1..=hierarchy.level_count() {
                let coarse: BTreeSet<u32> = hierarchy.vertices(level).iter().copied().collect();
                assert!(coarse.is_subset(&finer) && coarse.contains(&5));
                assert!(5 * coarse.len() <= 4 * finer.len());
                let mut seen = coarse.clone();
                for (child, own) in hierarchy.parents(level) {
                    assert!(finer.contains(&child) && seen.insert(child));
                    assert!(own.iter().all(|(p, _)| coarse.contains(p)));
                    let on_rim = rim.contains(&child);
                    let enough = if on_rim { 2 } else { parents as usize };
                    assert!(own.len() >= enough, "{child}: {own:?}");
                    if on_rim {
                        assert!(own.len() == 2 && own.iter().all(|(p, _)| rim.contains(p)));
                    }
                }
                assert_eq!(seen, finer, "level {level}");
                // Links join vertices of the level, each pair once, and hold all that hangs together together.
                let links = hierarchy.links(level);
                let pairs: BTreeSet<[u32; 2]> = links.iter().map(|l| l.vertices).collect();
                assert_eq!(pairs.len(), links.len());
                let mut reached = BTreeSet::from([hierarchy.vertices(level)[0]]);
                while let Some(&[a, b]) = pairs
                    .iter()
                    .find(|[a, b]| reached.contains(a) != reached.contains(b))
                {
                    reached.extend([a, b]);
                }
                assert_eq!(reached, coarse);
                finer = coarse;
            }
        }
    }
}

#[test]
fn weights_prolongate_translations_exactly_and_linear_fields_nearly() {
    for mesh in meshes() {
        let hierarchy = build(&mesh, &uneven(&mesh), HierarchyConfig::default());
        let at = |v: u32| mesh.positions()[v as usize];
        let (mut exact, mut all) = (0, 0);
        for level in 1..=hierarchy.level_count() {
            for (child, parents) in hierarchy.parents(level) {
                let sum: Real = parents.iter().map(|(_, w)| w).sum();
                assert!((sum - 1.0).abs() < 1e-14);
                assert!(parents.iter().all(|(_, w)| *w >= 0.0));
                let mean: Vec3 = parents.iter().map(|&(p, w)| at(p) * w).sum();
                let reach = parents.iter().map(|&(p, _)| (at(p) - at(child)).norm());
                let aside = (mean - at(child)).norm() / reach.fold(0.0, Real::max);
                all += 1;
                exact += usize::from(aside < 1e-12);
                // At a corner, two neighbours on the rim are all there is, and their mean is off by up to their
                // distance.
                assert!(aside < 1.0, "{child}: {aside}");
            }
        }
        println!("{exact} of {all} exact");
    }
    // On a regular sheet, one level: all but the vertices at a corner.
    let mesh = grid(17, 17, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let config = HierarchyConfig {
        levels: 1,
        ..HierarchyConfig::default()
    };
    let hierarchy = build(&mesh, &uneven(&mesh), config);
    let at = |v: u32| mesh.positions()[v as usize];
    for (child, parents) in hierarchy.parents(1) {
        let mean: Vec3 = parents.iter().map(|&(p, w)| at(p) * w).sum();
        let corner = [0.0, 1.0].contains(&at(child).x) && [0.0, 1.0].contains(&at(child).y);
        let off = (mean - at(child)).norm();
        assert!(corner || off < 0.3 / 16.0 * 1.5, "{child}: {off}");
    }
}

/// Stretched, moved, and by the same amount: the correction acts, and `Σ m x` stays.
#[test]
fn a_correction_of_a_free_cloth_keeps_its_centre_of_mass() {
    for mesh in meshes() {
        let particles = uneven(&mesh);
        let mut hierarchy = build(&mesh, &particles, HierarchyConfig::default());
        let start: Vec<Vec3> = mesh
            .positions()
            .iter()
            .map(|x| Vec3::new(1.3 * x.x, 0.9 * x.y, 1.1 * x.z + 0.2 * x.x * x.x))
            .collect();
        let mut x = start.clone();
        hierarchy.correct(&mut x);
        let moved = || x.iter().zip(&start).zip(particles.mass());
        let sum: Vec3 = moved().map(|((a, b), m)| (a - b) * *m).sum();
        let size: Real = moved().map(|((a, b), m)| (a - b).norm() * m).sum();
        assert!(
            size > 0.0 && sum.norm() < 1e-12 * size,
            "{}",
            sum.norm() / size
        );
        // Carried elsewhere, it does the same there.
        let shift = Vec3::new(3.0, -2.0, 1.0);
        let mut there: Vec<Vec3> = start.iter().map(|x| x + shift).collect();
        hierarchy.correct(&mut there);
        for (a, b) in there.iter().zip(&x) {
            assert!((a - b - shift).norm() < 1e-11);
        }
    }
}

/// Folded, crumpled to a point, rolled up: nothing is longer than at rest, and no coarse level minds.
#[test]
fn what_does_not_stretch_the_cloth_is_left_alone() {
    let flat = grid(17, 17, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let quarter = |x: Real| x.rem_euclid(0.5);
    // An accordion of four folds; the same with an angle; onto a line; into a point.
    let zigzag = |x: Real| quarter(x).min(0.5 - quarter(x));
    let tilted = |p: &Vec3| Vec3::new(p.x * 0.6, p.y, zigzag(p.x) * 0.8);
    let shapes: [&dyn Fn(&Vec3) -> Vec3; 5] = [
        &|p| *p,
        &|p| Vec3::new(zigzag(p.x), p.y, 0.0),
        &tilted,
        &|p| Vec3::new(0.0, p.y, 0.0),
        &|_| Vec3::new(4.0, 5.0, 6.0),
    ];
    let mut hierarchy = build(&flat, &uneven(&flat), HierarchyConfig::default());
    for shape in shapes {
        let start: Vec<Vec3> = flat.positions().iter().map(shape).collect();
        let mut x = start.clone();
        hierarchy.correct(&mut x);
        for (a, b) in x.iter().zip(&start) {
            assert!((a - b).norm() < 1e-14);
        }
    }
    // A tube at rest, cut open and unrolled, is as long as it was around: links run over the cloth, not through
    // the air.
    let around = 24;
    let rolled = tube(around, 8, 0.3, 1.0).unwrap();
    let hierarchy = build(&rolled, &uneven(&rolled), HierarchyConfig::default());
    let chord = |a: Vec3, b: Vec3| (a - b).norm();
    let mut longer = 0;
    for level in 1..=hierarchy.level_count() {
        for link in hierarchy.links(level) {
            let [a, b] = link.vertices.map(|v| rolled.positions()[v as usize]);
            assert!(link.length > chord(a, b) - 1e-14);
            longer += usize::from(link.length > 1.001 * chord(a, b));
        }
    }
    assert!(longer > 20, "{longer}");
}

/// The same on irregular sheets, with a boundary and a hole: whatever brings no two vertices further apart than
/// they are at rest.
#[test]
fn folds_of_irregular_and_holed_sheets_are_left_alone() {
    let along = Vec3::new(0.8, 0.6, 0.0);
    let zigzag = |x: Real| x.rem_euclid(0.3).min(0.3 - x.rem_euclid(0.3));
    // Folded sharp along slanted lines; rolled up tightly.
    let accordion = |p: &Vec3| {
        let x = p.dot(&along);
        p + along * (zigzag(x) - x)
    };
    let rolled = |p: &Vec3| Vec3::new(0.05 * (20.0 * p.x).cos(), p.y, 0.05 * (20.0 * p.x).sin());
    for mesh in [irregular(20, 1.0, 1.0, 7).unwrap(), holed()] {
        let mut hierarchy = build(&mesh, &uneven(&mesh), HierarchyConfig::default());
        assert!(hierarchy.level_count() >= 2);
        let shapes: [&dyn Fn(&Vec3) -> Vec3; 2] = [&accordion, &rolled];
        for shape in shapes {
            let start: Vec<Vec3> = mesh.positions().iter().map(shape).collect();
            let mut x = start.clone();
            hierarchy.correct(&mut x);
            for (a, b) in x.iter().zip(&start) {
                assert!((a - b).norm() < 1e-14);
            }
        }
    }
}

/// A sheet hung over a line, holed in one half: both halves hang down side by side with the hierarchy as without.
#[test]
fn a_sheet_over_a_line_keeps_its_fold() {
    let mesh = {
        let sheet = irregular(16, 1.0, 1.0, 11).unwrap();
        let hole = |_, corners: [Vec3; 3]| {
            let centre = corners.iter().sum::<Vec3>() / 3.0;
            (centre - Vec3::new(0.5, 0.25, 0.0)).norm() < 0.12
        };
        without_triangles(&sheet, hole).unwrap()
    };
    let mut particles = Particles::from_areal_density(&mesh, 0.2).unwrap();
    for (v, x) in mesh.positions().iter().enumerate() {
        if (x.y - 0.5).abs() < 0.04 {
            particles.prescribe(v).unwrap();
        }
    }
    // Both sides of the strip that is held hang down.
    let over = |p: &Vec3| {
        let y = p.y - 0.5;
        let beyond = (y.abs() - 0.04).max(0.0);
        let kept = y.abs() - beyond;
        Vec3::new(p.x, y.signum() * (kept + 0.1 * beyond), -0.99 * beyond)
    };
    let hung = |hierarchy| {
        let mut solver = solver(&mesh, &particles, hierarchy, 60);
        let mut state = State::at_rest(mesh.positions().iter().map(over).collect());
        for _ in 0..60 {
            let input = StepInput::new(1.0 / 60.0).gravity(Vec3::z() * -9.81);
            solver.step(&mut state, input).unwrap();
        }
        state.positions
    };
    let often = HierarchyConfig {
        every: Some(10),
        ..HierarchyConfig::default()
    };
    let (plain, with) = (hung(None), hung(Some(often)));
    let strains = [&plain, &with].map(|x| Strain::of(&springs(&mesh), x).rms);
    assert!(strains[1] < 1.05 * strains[0], "{strains:?}");
    for positions in [&plain, &with] {
        // The ends of the sheet hang side by side, though 1 m apart within the cloth.
        let end = |at: Real| {
            let near = |v: &usize| (mesh.positions()[*v].y - at).abs() < 1e-9;
            let of_end: Vec<usize> = (0..mesh.vertex_count()).filter(near).collect();
            of_end.iter().map(|&v| positions[v]).sum::<Vec3>() / of_end.len() as Real
        };
        let (front, back) = (end(0.0), end(1.0));
        assert!((front - back).norm() < 0.2, "{front} {back}");
        assert!(front.z < -0.4 && back.z < -0.4, "{front} {back}");
    }
}

/// Held along an edge, with a hole: plain sweeps and those after corrections end at one place, that at rest.
#[test]
fn with_a_hierarchy_the_sweeps_converge_to_the_same_answer() {
    for mesh in [holed(), irregular(14, 1.0, 1.0, 3).unwrap()] {
        let mut particles = Particles::from_areal_density(&mesh, 0.2).unwrap();
        for (v, x) in mesh.positions().iter().enumerate() {
            if x.y > 1.0 - 1e-9 {
                particles.prescribe(v).unwrap();
            }
        }
        let settled = |hierarchy, sweeps| {
            let mut state = State::at_rest(mesh.positions().to_vec());
            let input = StepInput::new(0.01).gravity(Vec3::y() * -9.81);
            let mut solver = solver(&mesh, &particles, hierarchy, sweeps);
            solver.step(&mut state, input).unwrap();
            state.positions
        };
        let often = HierarchyConfig {
            every: Some(10),
            ..HierarchyConfig::default()
        };
        let (plain, with) = (settled(None, 20_000), settled(Some(often), 4000));
        for (x, name) in [(&plain, "plain"), (&with, "with a hierarchy")] {
            let off = x.iter().zip(mesh.positions());
            let off = off.map(|(a, b)| (a - b).norm()).fold(0.0, Real::max);
            assert!(off < 1e-13, "{name}: {off:e} m off its place at rest");
        }
    }
}

struct Errors<'a> {
    rest: &'a [Vec3],
    wanted: Real,
    reached: Option<u32>,
}

impl Observer for Errors<'_> {
    fn iteration(&mut self, sweep: u32, x: &[Vec3]) {
        let square = |(x, rest): (&Vec3, &Vec3)| (x - rest).norm_squared();
        let sum: Real = x.iter().zip(self.rest).map(square).sum();
        if sum.sqrt() < self.wanted && self.reached.is_none() {
            self.reached = Some(sweep);
        }
    }
}

fn springs(mesh: &TriMesh) -> Vec<Spring> {
    Spring::along(
        mesh.positions(),
        EdgeTable::build(mesh).unwrap().ends(),
        1.0,
    )
}

fn solver(
    mesh: &TriMesh,
    particles: &Particles,
    hierarchy: Option<HierarchyConfig>,
    iterations: u32,
) -> PbdSolver {
    let config = PbdConfig {
        iterations,
        stiffness: StiffnessRule::Fixed(1.0),
        ..PbdConfig::default()
    };
    let builder = PbdSolver::builder(particles)
        .energy(springs(mesh))
        .config(config);
    let solver = builder.build().unwrap();
    match hierarchy {
        Some(config) => solver
            .with_hierarchy(build(mesh, particles, config))
            .unwrap(),
        None => solver,
    }
}

/// A sheet held along its upper edge, at rest: sweeps until a hundredth is left of what a step of gravity moved.
#[test]
fn a_hanging_sheet_needs_far_fewer_sweeps() {
    for mesh in [
        grid(24, 24, 1.0, 1.0, Diagonals::Alternating).unwrap(),
        irregular(24, 1.0, 1.0, 3).unwrap(),
    ] {
        let mut particles = Particles::from_areal_density(&mesh, 0.2).unwrap();
        for (v, x) in mesh.positions().iter().enumerate() {
            if x.y > 1.0 - 1e-9 {
                particles.prescribe(v).unwrap();
            }
        }
        let needed = |hierarchy| {
            let mut errors = Errors {
                rest: mesh.positions(),
                wanted: 0.01 * 9.81 * 1e-4 * (mesh.vertex_count() as Real).sqrt(),
                reached: None,
            };
            let mut solver = solver(&mesh, &particles, hierarchy, 4000);
            let mut state = State::at_rest(mesh.positions().to_vec());
            let input = StepInput::new(0.01).gravity(Vec3::y() * -9.81);
            solver
                .step(&mut state, input.observer(&mut errors))
                .unwrap();
            errors.reached.expect("reaches a hundredth")
        };
        let often = HierarchyConfig {
            every: Some(10),
            ..HierarchyConfig::default()
        };
        let (plain, with) = (needed(None), needed(Some(often)));
        println!("{plain} plain, {with} with a hierarchy");
        assert!(20 * with < plain, "{plain} {with}");
    }
}

#[test]
fn nothing_is_allocated_and_the_bits_do_not_depend_on_the_threads() {
    let mesh = grid(20, 20, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let mut particles = uneven(&mesh);
    particles.prescribe(0).unwrap();
    let often = HierarchyConfig {
        every: Some(5),
        ..HierarchyConfig::default()
    };
    let gravity = || StepInput::new(0.01).gravity(Vec3::y() * -9.81);
    let mut small = solver(&mesh, &particles, Some(often), 20);
    let mut state = State::at_rest(mesh.positions().to_vec());
    let count = counting_allocator::allocations_once_warm(|| {
        small.step(&mut state, gravity()).unwrap();
    });
    assert_eq!(count, 0);

    let mesh = grid(150, 150, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let particles = uneven(&mesh);
    let run = || {
        let mut state = State::at_rest(mesh.positions().iter().map(|x| x * 1.1).collect());
        let mut solver = solver(&mesh, &particles, Some(often), 6);
        solver.step(&mut state, gravity()).unwrap();
        state
    };
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let one = pool(1).unwrap().install(run);
    for threads in [2, 4] {
        assert!(
            one == pool(threads).unwrap().install(run),
            "{threads} threads"
        );
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let mesh = grid(6, 6, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let particles = uneven(&mesh);
    let good = HierarchyConfig::default();
    for config in [
        HierarchyConfig { levels: 0, ..good },
        HierarchyConfig { parents: 0, ..good },
        HierarchyConfig { sweeps: 0, ..good },
        HierarchyConfig {
            every: Some(0),
            ..good
        },
        HierarchyConfig {
            stiffness: 0.0,
            ..good
        },
        HierarchyConfig {
            stiffness: 1.1,
            ..good
        },
        HierarchyConfig {
            stiffness: Real::NAN,
            ..good
        },
    ] {
        let error = Hierarchy::build(&mesh, &particles, config).unwrap_err();
        assert!(matches!(
            error,
            HierarchyError::Build(BuildError::OutOfRange(_))
        ));
    }
    let fewer = Particles::new(vec![1.0; 3]).unwrap();
    assert!(Hierarchy::build(&mesh, &fewer, good).is_err());
    let hierarchy = build(&mesh, &particles, good);
    let solver = PbdSolver::builder(&fewer).build().unwrap();
    assert!(solver.with_hierarchy(hierarchy).is_err());
    // Too small for any level: no correction, no harm.
    let tiny = grid(2, 2, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let mut hierarchy = build(&tiny, &uneven(&tiny), good);
    let mut x = tiny.positions().to_vec();
    hierarchy.correct(&mut x);
    assert_eq!(x, tiny.positions());
    assert_eq!(hierarchy.level_count(), 0);
}
