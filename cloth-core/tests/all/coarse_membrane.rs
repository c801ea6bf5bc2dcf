//! A coarse level that carries the cloth: what it gives and what it breaks, against closed forms.

use cloth_core::cloth::{
    Cloth, ClothError, ClothModel, CoarseMembrane, Discretization, Elements, Membrane,
    MembraneElements, SpringEdges, SpringLaw,
};
use cloth_core::dof::{EdgeRank, perturbed};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, disk, equilateral, grid, irregular, tube};
use cloth_core::method::multigrid::{CoarseLevel, coarse_levels};
use cloth_core::random::SplitMix64;
use cloth_core::topology::EdgeTable;

const STIFF: Cloth = Cloth {
    areal_density: 0.2,
    membrane: Membrane::Modulus(1e3),
    bending_rigidity: 0.0,
};
const SHARE: Real = 0.03;

fn carried(level: u32) -> Discretization {
    Discretization {
        coarse_membrane: Some(CoarseMembrane {
            level,
            fine_fraction: SHARE,
        }),
        ..Discretization::default()
    }
}

/// Elastic energy (J) with every vertex moved by `place`.
fn stored(model: &ClothModel, mesh: &TriMesh, place: impl Fn(&Vec3) -> Vec3) -> Real {
    let x: Vec<Vec3> = mesh.positions().iter().map(place).collect();
    model.energies().unwrap().value(&x)
}

fn coarse(mesh: &TriMesh, level: usize) -> CoarseLevel {
    let edges = EdgeTable::build(mesh).unwrap();
    let mut levels = coarse_levels(mesh, &edges, |_| false, 2, level);
    assert_eq!(levels.len(), level);
    levels.pop().unwrap()
}

/// Sheets without obtuse triangles; the first two have a straight rim, and all straight ways are found.
fn sheets() -> [TriMesh; 3] {
    [
        grid(17, 17, 1.0, 1.0, Diagonals::OneWay).unwrap(),
        grid(17, 13, 1.0, 0.7, Diagonals::Alternating).unwrap(),
        equilateral(17, 17, 0.1).unwrap(),
    ]
}

#[test]
fn pulled_it_is_as_stiff_as_springs_and_pushed_as_its_edges() {
    for mesh in &sheets()[..2] {
        let springs = STIFF.on(mesh).unwrap();
        for level in 1..=4 {
            let model = STIFF.discretized_with(&carried(level), mesh).unwrap();
            for (stretch, expected) in [(1.02, 1.0), (0.98, SHARE)] {
                let [found, plain] = [&model, &springs].map(|m| stored(m, mesh, |p| p * stretch));
                let error = found / plain / expected - 1.0;
                assert!(error.abs() < 1e-9, "level {level}, {stretch}: {error:e}");
            }
        }
    }
}

/// With obtuse triangles some ways are found too long, and round the notches of a zigzag rim they are; those links come
/// late.
#[test]
fn obtuse_triangles_and_notches_take_little_of_the_stiffness() {
    for (mesh, least) in [
        (equilateral(17, 17, 0.1).unwrap(), 0.82),
        (grid(17, 17, 1.0, 1.0, Diagonals::Crossed).unwrap(), 0.97),
        (irregular(17, 1.0, 1.0, 3).unwrap(), 0.97),
    ] {
        let springs = STIFF.on(&mesh).unwrap();
        for level in 1..=4 {
            let model = STIFF.discretized_with(&carried(level), &mesh).unwrap();
            let [found, plain] = [&model, &springs].map(|m| stored(m, &mesh, |p| p * 1.02));
            let share = found / plain;
            assert!(
                (least..1.0 + 1e-9).contains(&share),
                "level {level}: {share}"
            );
        }
    }
}

/// A sheet rolled up without stretch, where no two edges are alike: the springs pay with their share, the links
/// nothing.
#[test]
fn no_link_resists_a_bend() {
    for mesh in sheets() {
        for level in 1..=4 {
            let model = STIFF.discretized_with(&carried(level), &mesh).unwrap();
            let springs = STIFF.on(&mesh).unwrap();
            for (turn, radius) in [(0.3_f64, 0.4), (1.2, 0.1)] {
                let axis = Vec3::new(turn.cos(), turn.sin(), 0.0);
                let across = Vec3::new(-axis.y, axis.x, 0.0);
                let rolled = |p: &Vec3| {
                    let s = across.dot(p) / radius;
                    axis * axis.dot(p) + (across * s.sin() + Vec3::z() * s.cos()) * radius
                };
                let [found, plain] = [&model, &springs].map(|m| stored(m, &mesh, rolled));
                let error = found / (SHARE * plain) - 1.0;
                assert!(
                    plain > 0.0 && error.abs() < 1e-12,
                    "level {level}: {error:e}"
                );
            }
        }
    }
}

/// What it breaks: between the vertices of the coarse level the cloth can be drawn out of place, and only the edges
/// resist.
#[test]
fn what_the_coarse_level_does_not_see_meets_the_edges_only() {
    let mut random = SplitMix64::new(3);
    for mesh in sheets() {
        for level in 1..=4 {
            let kept = coarse(&mesh, level).vertices;
            let model = STIFF
                .discretized_with(&carried(level as u32), &mesh)
                .unwrap();
            let mut x = mesh.positions().to_vec();
            for (v, x) in x.iter_mut().enumerate() {
                if !kept.contains(&(v as u32)) {
                    *x += Vec3::new(random.symmetric(), random.symmetric(), 0.0) * 0.02;
                }
            }
            let springs = STIFF.on(&mesh).unwrap().energies().unwrap().value(&x);
            let found = model.energies().unwrap().value(&x);
            assert!(
                (found / (SHARE * springs) - 1.0).abs() < 1e-12,
                "level {level}"
            );
        }
    }
}

/// Shear pulls along one diagonal and pushes along the other; half of the stiffness is left, as far as links lie alike
/// in all directions.
#[test]
fn about_half_of_the_stiffness_against_shear_is_left() {
    for mesh in [
        grid(33, 33, 1.0, 1.0, Diagonals::Alternating).unwrap(),
        equilateral(33, 33, 0.03).unwrap(),
    ] {
        let springs = STIFF.on(&mesh).unwrap();
        for level in [1, 2] {
            let model = STIFF.discretized_with(&carried(level), &mesh).unwrap();
            let sheared = |p: &Vec3| p + Vec3::x() * (1e-3 * p.y);
            let [found, plain] = [&model, &springs].map(|m| stored(m, &mesh, sheared));
            let share = found / plain;
            assert!((0.35..0.6).contains(&share), "level {level}: {share}");
        }
    }
}

/// Drawn out along one axis, a sheet that narrows along the other is held by links and braces along that axis: without
/// braces a level 1 of alternating diagonals would have 0.08 of that stiffness along x.
#[test]
fn a_sheet_that_narrows_is_held_along_both_axes() {
    for diagonals in [
        Diagonals::Alternating,
        Diagonals::OneWay,
        Diagonals::Crossed,
    ] {
        let mesh = grid(33, 33, 1.0, 1.0, diagonals).unwrap();
        let springs = STIFF.on(&mesh).unwrap();
        for level in [1, 2] {
            let model = STIFF.discretized_with(&carried(level), &mesh).unwrap();
            for stretch in [Vec3::new(1.001, 0.999, 1.0), Vec3::new(0.999, 1.001, 1.0)] {
                let drawn = |p: &Vec3| p.component_mul(&stretch);
                let [found, plain] = [&model, &springs].map(|m| stored(m, &mesh, drawn));
                let share = found / plain;
                assert!(
                    share > 0.38,
                    "{diagonals:?}, level {level}, {}: {share}",
                    stretch.x
                );
            }
        }
    }
}

/// Conditions are the links: three quarters of those of the level before, or fewer.
#[test]
fn the_links_leave_most_coordinates_free() {
    for mesh in [
        grid(17, 17, 1.0, 1.0, Diagonals::Alternating).unwrap(),
        irregular(17, 1.0, 1.0, 3).unwrap(),
        tube(16, 16, 0.2, 1.0).unwrap(),
        disk(8, 0.5).unwrap(),
    ] {
        let x = perturbed(mesh.positions());
        let mut before = EdgeTable::build(&mesh).unwrap().len();
        for level in 1..=4 {
            let model = STIFF.discretized_with(&carried(level), &mesh).unwrap();
            let [Elements::Limited(links)] = &model.others[..] else {
                panic!("{:?}", model.others)
            };
            let ends: Vec<[u32; 2]> = links.iter().map(|link| link.vertices).collect();
            let rank = EdgeRank::of_pairs(&x, &ends).unwrap();
            assert_eq!(
                rank.nullity,
                3 * x.len() - ends.len() + rank.self_stresses,
                "level {level}"
            );
            assert!(ends.len() < 3 * before / 4, "level {level}");
            before = ends.len();
        }
    }
}

#[test]
fn the_whole_modulus_on_one_side_leaves_nothing_on_the_other() {
    let mesh = grid(9, 9, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let with = |fine_fraction| {
        let coarse_membrane = Some(CoarseMembrane {
            level: 1,
            fine_fraction,
        });
        let discretization = Discretization {
            coarse_membrane,
            ..Discretization::default()
        };
        STIFF.discretized_with(&discretization, &mesh).unwrap()
    };
    assert_eq!(with(1.0).energies().unwrap().value(mesh.positions()), 0.0);
    assert_eq!(with(1.0).springs, STIFF.on(&mesh).unwrap().springs);
    assert!(with(1.0).families().len() == 1);
    assert!(with(0.0).springs.is_empty() && with(0.0).families().len() == 1);
}

#[test]
fn what_does_not_fit_is_refused_with_numbers() {
    let mesh = grid(9, 9, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let refused = |discretization: Discretization| {
        STIFF.discretized_with(&discretization, &mesh).unwrap_err()
    };
    for discretization in [
        Discretization {
            membrane: MembraneElements::Arap,
            ..carried(1)
        },
        Discretization {
            shear: Some(1.0),
            ..carried(1)
        },
        Discretization {
            law: SpringLaw::Compression(0.5),
            ..carried(1)
        },
        Discretization {
            edges: SpringEdges::Quads,
            ..carried(1)
        },
    ] {
        assert_eq!(
            refused(discretization),
            ClothError::CoarseMembraneWithoutSprings
        );
    }
    let words = refused(carried(40)).to_string();
    assert!(
        words.contains("level 40") && words.contains("from 1 to"),
        "{words}"
    );
    assert_eq!(
        refused(carried(0)),
        ClothError::NoSuchLevel { level: 0, most: 1 }
    );
    for (fine_fraction, word) in [(1.5, "1.5"), (-0.5, "-0.5"), (Real::NAN, "NaN")] {
        let coarse_membrane = Some(CoarseMembrane {
            level: 1,
            fine_fraction,
        });
        let words = refused(Discretization {
            coarse_membrane,
            ..Discretization::default()
        })
        .to_string();
        assert!(words.contains(word), "{words}");
    }
}
