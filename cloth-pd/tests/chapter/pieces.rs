//! The coarse grid, and where pieces of cloth are and how they lie.

use crate::cloth::{DT, GRAVITY, coarse_solver, distance, sheets};
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, join, tube};
use cloth_core::step::{StepInput, Stepper};
use cloth_pd::PdConfig;

const SIDE: usize = 17;
/// What steps that end at the tolerance of their velocities leave (m), of a fall of 0.3 m.
const NEAR: Real = 2e-3;

/// A sheet, its positions turned by `turn` and shifted by `shift` (m).
fn placed(turn: &Mat3, shift: Vec3) -> TriMesh {
    let mesh = grid(SIDE, SIDE, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let positions = mesh.positions().iter().map(|x| turn * x + shift).collect();
    TriMesh::new(positions, mesh.triangles().to_vec()).unwrap()
}

/// Where a mesh of sheets, each held at two corners, is after a quarter of a second under gravity that is turned too
/// (m); and the number of iterations.
fn hung(mesh: &TriMesh, turn: &Mat3) -> (Vec<Vec3>, u32) {
    hung_with(PdConfig::default(), mesh, turn)
}

fn hung_with(config: PdConfig, mesh: &TriMesh, turn: &Mat3) -> (Vec<Vec3>, u32) {
    let (mut model, mut state) = sheets(mesh, 1e4, 1e-5);
    for first in (0..mesh.vertex_count()).step_by(SIDE * SIDE) {
        for corner in [SIDE * (SIDE - 1), SIDE * SIDE - 1] {
            model.particles.prescribe(first + corner).unwrap();
        }
    }
    let mut solver = coarse_solver(&model, mesh.positions(), config);
    let mut iterations = 0;
    for _ in 0..15 {
        let input = StepInput::new(DT).gravity(turn * GRAVITY);
        let report = solver.step(&mut state, input).unwrap();
        assert_eq!(report.coarse_fallbacks, 0);
        iterations += report.iterations;
    }
    (state.positions, iterations)
}

/// Turned about its edge, so that the lattice is the same; only rounding differs. A lattice along the axes of space
/// would have more nodes around the sheet than motions (up to twice the iterations, and 5 to 10 mm).
#[test]
fn a_sheet_at_an_angle_moves_as_one_along_the_axes() {
    let (expected, iterations) = hung(&placed(&Mat3::identity(), Vec3::zeros()), &Mat3::identity());
    for angle in [0.1, 0.7, 1.2] {
        let turn = *nalgebra::Rotation3::from_axis_angle(&Vec3::x_axis(), angle).matrix();
        let (positions, turned) = hung(&placed(&turn, Vec3::zeros()), &turn);
        let back: Vec<Vec3> = positions.iter().map(|x| turn.tr_mul(x)).collect();
        let apart: Real = distance(&back, &expected);
        assert!(apart < NEAR, "{angle}: {apart:e} m");
        assert!(turned * 10 <= iterations * 11, "{angle}: {turned}");
    }
}

/// Both have a lattice of their own. With one over both a sheet would have a single cell (twice the iterations, and
/// 45 mm).
#[test]
fn a_sheet_moves_as_alone_beside_another_that_is_far_away() {
    let straight = Mat3::identity();
    let [one, other] = [0.0, 10.0].map(|x| placed(&straight, Vec3::x() * x));
    let (expected, iterations) = hung(&one, &straight);
    let (positions, together) = hung(&join(&[one, other]).unwrap(), &straight);
    for (far, piece) in positions.chunks(SIDE * SIDE).enumerate() {
        let shift = Vec3::x() * (10.0 * far as Real);
        let back: Vec<Vec3> = piece.iter().map(|x| x - shift).collect();
        let apart = distance(&back, &expected);
        assert!(apart < NEAR, "piece {far}: {apart:e} m");
    }
    assert!(together * 10 <= iterations * 11, "{together}");
}

/// Both end where they are near enough themselves. In a norm over both the small one has a hundredth of the kinetic
/// energy, a tenth of the velocity: with the default tolerance it was left 26 mm from where it falls alone, with this
/// one 0.3 mm.
#[test]
fn a_light_sheet_moves_as_alone_beside_a_heavy_one() {
    let straight = Mat3::identity();
    let small = placed(&(straight * 0.1), Vec3::zeros());
    let large = placed(&straight, Vec3::x() * 10.0);
    let config = PdConfig {
        velocity_tolerance: 1e-3,
        ..PdConfig::default()
    };
    let (expected, alone) = hung_with(config, &small, &straight);
    let both = join(&[small, large]).unwrap();
    let (positions, together) = hung_with(config, &both, &straight);
    let apart = distance(&positions[..SIDE * SIDE], &expected);
    assert!(apart < 2e-5, "{apart:e} m");
    assert!(together * 10 <= alone * 11, "{alone}, {together}");
}

/// One that has ended stays where it is while others go on. When it did not, rounding made pairs of its forces, which
/// led it out of its free fall, and a step took five times the iterations.
#[test]
fn a_sheet_that_falls_freely_does_not_slow_down_another() {
    let straight = Mat3::identity();
    let hanging = placed(&straight, Vec3::zeros());
    let falling = placed(&(straight * 0.3), Vec3::x() * 10.0);
    let count = |pieces: &[TriMesh]| {
        let mesh = join(pieces).unwrap();
        let (mut model, mut state) = sheets(&mesh, 3e3, 1e-5);
        for corner in [0, SIDE - 1] {
            model.particles.prescribe(corner).unwrap();
        }
        let mut solver = coarse_solver(&model, mesh.positions(), PdConfig::default());
        let mut iterations = 0;
        for _ in 0..15 {
            let input = StepInput::new(2.0 * DT).gravity(GRAVITY);
            iterations += solver.step(&mut state, input).unwrap().iterations;
        }
        iterations
    };
    let alone = count(std::slice::from_ref(&hanging));
    let beside = count(&[hanging, falling]);
    assert!(beside * 10 <= alone * 11, "{alone}, {beside}");
}

/// Nodes around a tube at an angle have motions that move no vertex; its lattice is of use all the same.
#[test]
fn a_tube_at_an_angle_has_a_coarse_grid() {
    let straight = tube(60, 30, 0.159, 0.5).unwrap();
    for turn in 0..6 {
        let angles = Vec3::new(0.5, 0.3, 0.2) + Vec3::new(0.3, -0.2, 0.1) * Real::from(turn);
        let turn = nalgebra::Rotation3::from_scaled_axis(angles);
        let positions = straight.positions().iter().map(|x| turn * x).collect();
        let mesh = TriMesh::new(positions, straight.triangles().to_vec()).unwrap();
        let (mut model, mut state) = sheets(&mesh, 2e4, 1e-5);
        model.particles.prescribe(0).unwrap();
        let mut solver = coarse_solver(&model, mesh.positions(), PdConfig::default());
        let report = solver.step(&mut state, StepInput::new(DT).gravity(GRAVITY));
        assert_eq!(report.unwrap().coarse_fallbacks, 0, "{angles:?}");
    }
}
