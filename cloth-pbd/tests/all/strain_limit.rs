//! Strain limiting: ranges are reached, momentum is kept, and what cannot be done is said.

use crate::counting_allocator;
use crate::sheet;

use cloth_core::energy::{ArapTriangle, AreaTriangle, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{Strain, angular_momentum, linear_momentum};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, irregular};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, Outcome, StepError, StepInput, Stepper};
use cloth_core::topology::EdgeTable;
use cloth_pbd::{PbdSolver, StrainLimiter, StrainLimiterBuilder, StretchRange, WithStrainLimit};

fn wave(v: usize, a: Real) -> Real {
    (a * v as Real + 1.0).sin()
}

/// Masses from 10 to 22 g.
fn uneven(count: usize) -> Particles {
    Particles::new((0..count).map(|v| 0.01 + 0.003 * (v % 5) as Real).collect()).unwrap()
}

fn springs(mesh: &TriMesh) -> Vec<Spring> {
    Spring::along(
        mesh.positions(),
        EdgeTable::build(mesh).unwrap().ends(),
        1.0,
    )
}

/// Pulled out of shape and in motion, by so much (m) and so fast (m/s).
fn shaken(mesh: &TriMesh, size: Real, speed: Real) -> State {
    let mut state = State::at_rest(mesh.positions().to_vec());
    for (v, x) in state.positions.iter_mut().enumerate() {
        *x += Vec3::new(wave(v, 1.7), wave(v, 2.3), wave(v, 0.9)) * size;
    }
    for (v, u) in state.velocities.iter_mut().enumerate() {
        *u = Vec3::new(wave(v, 0.3), wave(v, 3.1), wave(v, 5.7)) * speed;
    }
    state
}

type Kind = fn(StrainLimiterBuilder, &TriMesh, StretchRange) -> StrainLimiterBuilder;

const KINDS: [(&str, Kind); 3] = [
    ("springs", |b, mesh, range| b.springs(&springs(mesh), range)),
    ("areas", |b, mesh, range| {
        b.areas(&AreaTriangle::on(mesh, 1.0), range)
    }),
    ("stretches", |b, mesh, range| {
        b.stretches(&ArapTriangle::on(mesh, 1.0), range)
    }),
];

#[test]
fn a_free_sheet_reaches_its_ranges_and_keeps_both_momenta() {
    for mesh in [
        grid(9, 9, 1.0, 1.0, Diagonals::Alternating).unwrap(),
        irregular(7, 1.0, 1.0, 4).unwrap(),
    ] {
        let particles = uneven(mesh.vertex_count());
        for (name, add) in KINDS {
            for range in [StretchRange::stretch(0.05), StretchRange::both(0.1)] {
                let builder = add(StrainLimiter::builder(&particles), &mesh, range);
                let mut limiter = builder.tolerance(1e-3).max_passes(5000).build().unwrap();
                let mut state = shaken(&mesh, 0.03, 2.0);
                let linear = linear_momentum(&particles, &state.velocities);
                let angular = angular_momentum(&particles, &state);
                let report = limiter.apply(&mut state, 0.01).unwrap();
                assert_eq!(
                    report.outcome,
                    Outcome::Converged,
                    "{name} {range:?}: {report:?}"
                );
                assert!(report.violation <= 1e-3 && report.passes > 1);
                println!("{name} {range:?}: {} passes", report.passes);
                // What went through: the sum of the sizes of its parts.
                let parts = || {
                    state
                        .positions
                        .iter()
                        .zip(&state.velocities)
                        .zip(particles.mass())
                };
                let size: Real = parts().map(|((_, v), m)| m * v.norm()).sum();
                let error = (linear_momentum(&particles, &state.velocities) - linear).norm() / size;
                assert!(error < 1e-12, "{name}: linear {error:e}");
                let size: Real = parts().map(|((x, v), m)| m * x.norm() * v.norm()).sum();
                let error = (angular_momentum(&particles, &state) - angular).norm() / size;
                assert!(error < 1e-12, "{name}: angular {error:e}");
                // Once there, nothing changes any more.
                let there = state.clone();
                let again = limiter.apply(&mut state, 0.01).unwrap();
                assert_eq!((again.passes, again.outcome), (1, Outcome::Converged));
                assert!(state == there);
            }
        }
    }
}

#[test]
fn the_ranges_are_those_of_lengths_areas_and_stretches() {
    let mesh = grid(6, 6, 1.0, 1.0, Diagonals::Crossed).unwrap();
    let particles = uneven(mesh.vertex_count());
    let tight = |add: Kind, range| {
        let builder = add(StrainLimiter::builder(&particles), &mesh, range);
        let mut limiter = builder.tolerance(1e-6).max_passes(20_000).build().unwrap();
        let mut state = shaken(&mesh, 0.03, 0.0);
        let report = limiter.apply(&mut state, 0.01).unwrap();
        assert_eq!(report.outcome, Outcome::Converged);
        state.positions
    };
    let range = StretchRange {
        min: 0.95,
        max: 1.02,
    };
    let x = tight(KINDS[0].1, range);
    let strain = Strain::of(&springs(&mesh), &x);
    assert!(
        strain.max < 0.020_001 && strain.min > -0.050_001,
        "{strain:?}"
    );
    assert!(strain.max > 0.019_999 && strain.min < -0.049_999);
    let x = tight(KINDS[1].1, range);
    let deformed = TriMesh::new(x, mesh.triangles().to_vec()).unwrap();
    for (area, rest) in deformed.areas().zip(mesh.areas()) {
        assert!(
            (0.949_999..1.020_001).contains(&(area / rest)),
            "{}",
            area / rest
        );
    }
    // No direction is stretched beyond the range: not the edges, nor the line from a corner to the middle of
    // its opposite edge.
    let x = tight(KINDS[2].1, range);
    for t in mesh.triangles() {
        let of = |x: &[Vec3], k: usize| {
            let [a, b, c] = [0, 1, 2].map(|i| x[t[(i + k) % 3] as usize]);
            [(a - b).norm(), (a - (b + c) / 2.0).norm()]
        };
        for k in 0..3 {
            for (now, rest) in of(&x, k).into_iter().zip(of(mesh.positions(), k)) {
                assert!(
                    (0.949_99..1.020_01).contains(&(now / rest)),
                    "{}",
                    now / rest
                );
            }
        }
    }
}

/// Two vertices, 1 m apart at rest, turning about their centre of mass 2 m apart: pulled in, they turn faster,
/// `r² ω` as before.
#[test]
fn what_is_pulled_in_turns_faster() {
    let particles = Particles::new(vec![1.0, 3.0]).unwrap();
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: 1.0,
    };
    let builder = StrainLimiter::builder(&particles);
    let mut limiter = builder
        .springs(&[spring], StretchRange::stretch(0.25))
        .build()
        .unwrap();
    let mut state = State::at_rest(vec![Vec3::new(1.5, 0.0, 0.0), Vec3::new(-0.5, 0.0, 0.0)]);
    state.velocities = vec![Vec3::new(0.0, 1.5, 0.0), Vec3::new(0.0, -0.5, 0.0)];
    limiter.apply(&mut state, 0.1).unwrap();
    let apart = state.positions[0] - state.positions[1];
    assert!((apart - Vec3::new(1.25, 0.0, 0.0)).norm() < 1e-15);
    let speed = state.velocities[0] - state.velocities[1];
    // Inwards by 0.75 m in 0.1 s; across, 2 m/s times 2/1.25.
    assert!(
        (speed - Vec3::new(-7.5, 3.2, 0.0)).norm() < 1e-13,
        "{speed}"
    );
}

#[test]
fn a_prescribed_vertex_stays_and_angular_momentum_about_it_is_kept() {
    let mesh = grid(5, 5, 1.0, 1.0, Diagonals::Alternating).unwrap();
    for (name, add) in KINDS {
        let mut particles = uneven(mesh.vertex_count());
        particles.prescribe(7).unwrap();
        let builder = add(
            StrainLimiter::builder(&particles),
            &mesh,
            StretchRange::stretch(0.02),
        );
        let mut limiter = builder.tolerance(1e-3).max_passes(5000).build().unwrap();
        let mut state = shaken(&mesh, 0.03, 2.0);
        state.velocities[7] = Vec3::zeros();
        let held = state.positions[7];
        let about = |state: &State| {
            let mut moved = state.clone();
            moved.positions.iter_mut().for_each(|x| *x -= held);
            angular_momentum(&particles, &moved)
        };
        let before = about(&state);
        let report = limiter.apply(&mut state, 0.01).unwrap();
        assert_eq!(report.outcome, Outcome::Converged, "{name}");
        assert_eq!(
            (state.positions[7], state.velocities[7]),
            (held, Vec3::zeros())
        );
        let size: Real = state.velocities.iter().map(|v| 0.02 * v.norm()).sum();
        let error = (about(&state) - before).norm() / size;
        assert!(error < 1e-12, "{name}: {error:e}");
    }
}

#[test]
fn what_cannot_be_done_is_reported() {
    // Three links between two pins 3.6 m apart, stretched by no more than 10 %.
    let mut particles = Particles::new(vec![1.0; 4]).unwrap();
    particles.prescribe(0).unwrap();
    particles.prescribe(3).unwrap();
    let chain: Vec<Spring> = (0..3)
        .map(|i| Spring {
            vertices: [i, i + 1],
            rest_length: 1.0,
            stiffness: 1.0,
        })
        .collect();
    let limiter = |strain| {
        let builder = StrainLimiter::builder(&particles);
        let builder = builder.springs(&chain, StretchRange::stretch(strain));
        builder.max_passes(400).tolerance(1e-6).build().unwrap()
    };
    let at = |x: Real| Vec3::new(x, 0.0, 0.0);
    let start = State::at_rest(vec![at(0.0), at(1.0), at(2.9), at(3.6)]);
    let mut state = start.clone();
    let report = limiter(0.1).apply(&mut state, 0.01).unwrap();
    assert_eq!((report.outcome, report.passes), (Outcome::BudgetSpent, 400));
    assert!(report.violation > 0.09, "{report:?}");
    assert!(state.first_non_finite().is_none());
    // By 20 % is possible, just.
    let mut state = start.clone();
    let report = limiter(0.200_001).apply(&mut state, 0.01).unwrap();
    assert_eq!(report.outcome, Outcome::Converged, "{report:?}");
    // An edge between two pins cannot be helped at all.
    let rigid = [Spring {
        vertices: [0, 3],
        rest_length: 1.0,
        stiffness: 1.0,
    }];
    let builder = StrainLimiter::builder(&particles).springs(&rigid, StretchRange::stretch(0.0));
    let mut state = start.clone();
    let report = builder.build().unwrap().apply(&mut state, 0.01).unwrap();
    assert_eq!(report.outcome, Outcome::BudgetSpent);
    assert!((report.violation - 2.6).abs() < 1e-15);
    assert!(state == start);
}

/// A sheet that hangs by its upper edge, stretched by 10 %, and may be stretched by 5 %: passes grow with the square
/// of the vertices a side.
#[test]
fn passes_to_a_limit_by_vertices_a_side() {
    let passes = |n: usize| {
        let (mesh, _) = sheet::held_sheet(n, 1.0);
        let mut particles = Particles::new(vec![1.0; n * n]).unwrap();
        (n * (n - 1)..n * n).for_each(|v| particles.prescribe(v).unwrap());
        let builder = StrainLimiter::builder(&particles).max_passes(10_000);
        let builder = builder.springs(&springs(&mesh), StretchRange::stretch(0.05));
        let mut limiter = builder.tolerance(1e-3).build().unwrap();
        let top = mesh.positions()[n * n - 1].y;
        let stretched = |x: &Vec3| Vec3::new(x.x, top + 1.1 * (x.y - top), x.z);
        let mut state = State::at_rest(mesh.positions().iter().map(stretched).collect());
        let report = limiter.apply(&mut state, 0.01).unwrap();
        assert_eq!(report.outcome, Outcome::Converged);
        assert!(Strain::of(&springs(&mesh), &state.positions).max < 0.051_001);
        report.passes
    };
    assert_eq!([9, 17, 33, 65].map(passes), [112, 438, 1718, 6752]);
}

#[test]
fn collapsed_elements_open_again_and_springs_without_length_are_left_out() {
    let mesh = grid(4, 4, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let particles = uneven(mesh.vertex_count());
    for (name, add) in KINDS {
        let range = StretchRange { min: 0.5, max: 2.0 };
        let builder = add(StrainLimiter::builder(&particles), &mesh, range);
        let mut limiter = builder.max_passes(2000).tolerance(1e-3).build().unwrap();
        for flat in [
            Vec3::zeros(),
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(1.0, 1.0, 0.0),
        ] {
            let squeezed = mesh
                .positions()
                .iter()
                .map(|x| x.component_mul(&flat) * 0.4);
            let mut state = State::at_rest(squeezed.collect());
            let report = limiter.apply(&mut state, 0.01).unwrap();
            assert!(state.first_non_finite().is_none());
            println!("{name}, onto {flat:?}: {report:?}");
            // A triangle without any extent has no direction for its area to grow in.
            if name != "areas" || flat != Vec3::zeros() {
                assert_eq!(report.outcome, Outcome::Converged, "{name} {flat}");
            }
        }
    }
    let tie = Spring {
        vertices: [0, 1],
        rest_length: 0.0,
        stiffness: 1.0,
    };
    let builder = StrainLimiter::builder(&particles).springs(&[tie], StretchRange::both(0.1));
    let mut state = shaken(&mesh, 0.1, 1.0);
    let report = builder.build().unwrap().apply(&mut state, 0.01).unwrap();
    assert_eq!(report.outcome, Outcome::Converged);
    assert!(state == shaken(&mesh, 0.1, 1.0));
}

#[test]
fn any_method_can_be_limited_and_on_an_error_the_state_is_as_it_was() {
    // So soft that it would hang like rubber.
    let (mesh, model) = sheet::held_sheet(12, 5.0);
    let solver = || {
        let builder = PbdSolver::builder(&model.particles).energy(model.springs.clone());
        Box::new(builder.build().unwrap())
    };
    let limiter = |strain| {
        let builder = StrainLimiter::builder(&model.particles).max_passes(1000);
        let range = StretchRange::stretch(strain);
        builder
            .springs(&model.springs, range)
            .tolerance(1e-3)
            .build()
            .unwrap()
    };
    let stretch = |method: &mut dyn Stepper| {
        let mut state = State::at_rest(mesh.positions().to_vec());
        sheet::fall(method, &mut state, 60);
        Strain::of(&model.springs, &state.positions).max
    };
    assert!(stretch(&mut *solver()) > 0.5);
    let mut limited = WithStrainLimit::new(solver(), limiter(0.05));
    assert!(stretch(&mut limited) < 0.0511);
    assert_eq!(limited.last_report().unwrap().outcome, Outcome::Converged);
    assert_eq!(limited.name(), "pbd");
    // Nothing is allocated once it runs.
    let mut state = State::at_rest(mesh.positions().to_vec());
    let step = || sheet::fall(&mut limited, &mut state, 1);
    assert_eq!(counting_allocator::allocations_once_warm(step), 0);
    // Velocities that the limiter cannot hold in a number.
    let error = limited
        .step(&mut state, StepInput::new(Real::NAN))
        .unwrap_err();
    assert!(matches!(error, StepError::InvalidTimeStep { .. }));
    let mut wild = State::at_rest(mesh.positions().iter().map(|x| x * 2.0).collect());
    wild.positions[0] = mesh.positions()[0];
    let kept = wild.clone();
    let error = limited.step(&mut wild, StepInput::new(1e-312)).unwrap_err();
    assert!(matches!(error, StepError::NonFinite { .. }), "{error}");
    assert!(wild == kept);
}

#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    let mesh = grid(150, 150, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let particles = uneven(mesh.vertex_count());
    let run = || {
        let builder = StrainLimiter::builder(&particles).max_passes(5);
        let builder = builder.springs(&springs(&mesh), StretchRange::both(0.01));
        let builder = builder.stretches(&ArapTriangle::on(&mesh, 1.0), StretchRange::stretch(0.01));
        let mut state = shaken(&mesh, 0.002, 1.0);
        builder.build().unwrap().apply(&mut state, 0.01).unwrap();
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
fn settings_out_of_range_are_refused() {
    let mesh = grid(3, 3, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let particles = uneven(mesh.vertex_count());
    let builder = || StrainLimiter::builder(&particles);
    for (min, max) in [
        (-0.1, 1.0),
        (Real::NAN, 1.0),
        (1.1, 1.0),
        (0.0, 0.0),
        (0.5, Real::NAN),
    ] {
        for (_, add) in KINDS {
            let error = add(builder(), &mesh, StretchRange { min, max })
                .build()
                .unwrap_err();
            assert!(matches!(error, BuildError::OutOfRange(_)), "{min} {max}");
        }
    }
    assert!(builder().tolerance(-1.0).build().is_err());
    assert!(builder().tolerance(Real::NAN).build().is_err());
    assert!(builder().max_passes(0).build().is_err());
    let stray = Spring {
        vertices: [0, 9],
        rest_length: 1.0,
        stiffness: 1.0,
    };
    let error = builder()
        .springs(&[stray], StretchRange::both(0.1))
        .build()
        .unwrap_err();
    assert!(matches!(error, BuildError::NoSuchVertex { vertex: 9, .. }));
    // An infinite upper limit is none.
    let open = StretchRange {
        min: 0.9,
        max: Real::INFINITY,
    };
    let mut state = shaken(&mesh, 0.0, 0.0);
    state.positions.iter_mut().for_each(|x| *x *= 7.0);
    let mut limiter = builder().springs(&springs(&mesh), open).build().unwrap();
    assert_eq!(limiter.apply(&mut state, 0.1).unwrap().violation, 0.0);
}
