//! Shortening the contour: its gradient, and tangles that it undoes.

use cloth_collide::SeparationProbe;
use cloth_collide::untangle::{UntangleOutcome, Untangler};
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, join};

/// A sheet of n × n vertices around the origin (m), moved.
fn sheet(n: usize, size: f64, place: impl Fn(Vec3) -> Vec3) -> TriMesh {
    let flat = grid(n, n, size, size, Diagonals::Alternating).unwrap();
    let middle = Vec3::new(0.5, 0.5, 0.0) * size;
    let positions = flat.positions().iter().map(|x| place(x - middle)).collect();
    TriMesh::new(positions, flat.triangles().to_vec()).unwrap()
}

/// Turned by `angle` (rad) about the axis y.
fn tilted(x: Vec3, angle: f64) -> Vec3 {
    Vec3::new(
        x.x * angle.cos() + x.z * angle.sin(),
        x.y,
        x.z * angle.cos() - x.x * angle.sin(),
    )
}

fn crossings(mesh: &TriMesh, x: &[Vec3]) -> usize {
    SeparationProbe::new(mesh)
        .measure(x)
        .unwrap()
        .intersecting_pairs
}

fn floor() -> TriMesh {
    sheet(11, 1.0, |x| x + Vec3::new(0.0131, 0.0072, 0.0))
}

/// A tilted sheet that comes down through the floor by about 4 cm of its 30, with a corner or, almost level, with an
/// edge.
fn through(turn: f64) -> TriMesh {
    let turned = |x: Vec3| {
        let (s, c) = turn.sin_cos();
        Vec3::new(c * x.x - s * x.y, s * x.x + c * x.y, x.z)
    };
    let reach = 0.15 * (turn.sin() + turn.cos());
    let up = Vec3::z() * (reach * 0.7f64.sin() - 0.04);
    let upper = sheet(9, 0.3, |x| tilted(turned(x), 0.7) + up);
    join(&[floor(), upper]).unwrap()
}

/// A bump of the lower sheet goes through the inside of the upper one, so that the contour is closed in both.
fn bump() -> TriMesh {
    let hill = |x: Vec3| Vec3::z() * 0.12 * (-x.norm_squared() / 0.02).exp();
    let lower = sheet(21, 1.0, |x| x + hill(x));
    let upper = sheet(17, 0.9, |x| x + Vec3::new(0.0131, 0.0072, 0.06));
    join(&[lower, upper]).unwrap()
}

fn largest_motion(mesh: &TriMesh, x: &[Vec3]) -> f64 {
    let displacements = x.iter().zip(mesh.positions()).map(|(a, b)| (a - b).norm());
    displacements.fold(0.0, f64::max)
}

#[test]
fn gradient_is_that_of_differences_of_the_length() {
    for mesh in [through(0.6), bump()] {
        let mut untangler = Untangler::new(&mesh);
        let x = mesh.positions().to_vec();
        let mut gradient = x.clone();
        let length = untangler.contour_length(&x, &mut gradient).unwrap();
        assert!(length > 0.1);
        let mut scratch = x.clone();
        let step = 1e-7;
        let mut touched = 0;
        // All vertices near the contour, and some of the others.
        for v in (0..x.len()).filter(|&v| v % 9 == 0 || gradient[v] != Vec3::zeros()) {
            for axis in 0..3 {
                let mut at = |displacement: f64| {
                    let mut moved = x.clone();
                    moved[v][axis] += displacement;
                    untangler.contour_length(&moved, &mut scratch).unwrap()
                };
                let difference = (at(step) - at(-step)) / (2.0 * step);
                let found = gradient[v][axis];
                assert!(
                    (difference - found).abs() < 1e-6,
                    "{v} {axis}: {found} {difference}"
                );
                touched += usize::from(found != 0.0);
            }
        }
        assert!(touched > 30, "{touched}");
    }
}

/// Two triangles cross at right angles, one end of their common segment in each: its length and its gradient by heart.
#[test]
fn length_of_the_contour_of_two_triangles_is_known() {
    let points = [
        (0.0, 0.0, 0.0),
        (4.0, 0.0, 0.0),
        (0.0, 4.0, 0.0),
        (1.0, 1.0, -1.0),
        (1.0, 1.0, 1.0),
        (5.0, 1.0, 0.0),
    ];
    let x: Vec<Vec3> = points.iter().map(|&(x, y, z)| Vec3::new(x, y, z)).collect();
    let mesh = TriMesh::new(x.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let mut untangler = Untangler::new(&mesh);
    let mut gradient = x.clone();
    // From (1, 1, 0), on the edge of the second, to (3, 1, 0), on that of the first.
    let length = untangler.contour_length(&x, &mut gradient).unwrap();
    assert_eq!(length, 2.0);
    // Moving the edge 3-4 by u along the segment makes it shorter by u.
    assert_eq!((gradient[3] + gradient[4]).x, -1.0);
    // Moving its triangle by u across shortens the other end by u.
    let across: f64 = gradient[3..].iter().map(|g| g.y).sum();
    assert_eq!(across, -1.0);
    let sum: Vec3 = gradient.iter().sum();
    assert!(sum.norm() < 1e-15);
}

/// Undone within `most` iterations, without moving anything farther than `farthest` (m).
fn is_undone(mesh: &TriMesh, most: u32, farthest: f64) {
    let mut x = mesh.positions().to_vec();
    assert!(crossings(mesh, &x) > 5);
    let mut untangler = Untangler::new(mesh);
    let inverse_mass = vec![10.0; x.len()];
    let mut told = Vec::new();
    let report = untangler
        .relax(&mut x, &inverse_mass, most, |at| told.push(at))
        .unwrap();
    assert_eq!(report.outcome, UntangleOutcome::Untangled, "{report:?}");
    assert_eq!(report.pairs_before, crossings(mesh, mesh.positions()));
    assert_eq!((report.pairs_after, crossings(mesh, &x)), (0, 0));
    let last = told.last().unwrap();
    assert_eq!((last.iterations, last.pairs), (report.iterations, 0));
    assert!(untangler.pairs().is_empty());
    assert!(largest_motion(mesh, &x) < farthest);
}

#[test]
fn corner_that_has_gone_through_a_sheet_is_pulled_out() {
    is_undone(&through(std::f64::consts::FRAC_PI_4), 5, 0.06);
}

#[test]
fn edge_that_has_gone_through_a_sheet_is_pulled_out() {
    for turn in [0.0, 0.05, 0.1, 0.2, 0.4] {
        is_undone(&through(turn), 30, 0.12);
    }
}

#[test]
fn bump_that_has_gone_through_a_sheet_is_pulled_out() {
    is_undone(&bump(), 10, 0.1);
}

/// Only the sheet without held vertices moves.
#[test]
fn held_vertices_stay() {
    let mesh = bump();
    let mut x = mesh.positions().to_vec();
    let inverse_mass: Vec<f64> = (0..x.len())
        .map(|v| if v < 441 { 0.0 } else { 1.0 })
        .collect();
    let report = Untangler::new(&mesh)
        .relax(&mut x, &inverse_mass, 100, |_| ())
        .unwrap();
    assert_eq!(report.outcome, UntangleOutcome::Untangled);
    assert_eq!(x[..441], mesh.positions()[..441]);
    assert_eq!(crossings(&mesh, &x), 0);
}

#[test]
fn what_cannot_be_undone_is_said() {
    // All held.
    let mesh = bump();
    let mut x = mesh.positions().to_vec();
    let held = vec![0.0; x.len()];
    let report = Untangler::new(&mesh)
        .relax(&mut x, &held, 100, |_| ())
        .unwrap();
    assert_eq!(report.outcome, UntangleOutcome::Stalled);
    assert_eq!(
        (report.pairs_after, report.length_after),
        (report.pairs_before, report.length_before)
    );
    assert_eq!(x, mesh.positions());

    // The held rims of two sheets are linked, like two rings of a chain.
    let standing = sheet(9, 0.8, |x| Vec3::new(x.x + 0.5, 0.013, x.y + 0.007));
    let mesh = join(&[floor(), standing]).unwrap();
    let mut x = mesh.positions().to_vec();
    let inner = |k: usize, n: usize| (1..n - 1).contains(&(k % n)) && (1..n - 1).contains(&(k / n));
    let free = |v: usize| {
        if v < 121 {
            inner(v, 11)
        } else {
            inner(v - 121, 9)
        }
    };
    let w: Vec<f64> = (0..x.len()).map(|v| f64::from(u8::from(free(v)))).collect();
    let report = Untangler::new(&mesh)
        .relax(&mut x, &w, 1000, |_| ())
        .unwrap();
    assert_eq!(report.outcome, UntangleOutcome::Stalled);
    assert_eq!(report.pairs_after, crossings(&mesh, &x));
    assert!(report.pairs_after > 0);
    assert!(x.iter().all(|x| x.norm() < 2.0));

    // Nothing to do.
    let mesh = floor();
    let mut x = mesh.positions().to_vec();
    let report = Untangler::new(&mesh)
        .relax(&mut x, &[1.0; 121], 10, |_| ())
        .unwrap();
    assert_eq!(
        (report.outcome, report.iterations),
        (UntangleOutcome::Untangled, 0)
    );
    x[7].y = f64::NAN;
    assert!(
        Untangler::new(&mesh)
            .relax(&mut x, &[1.0; 121], 10, |_| ())
            .is_err()
    );
}

/// A sheet that stands in another one, as a cross, is pulled out whole: far more than a step.
#[test]
fn sheet_in_the_middle_of_another_is_pulled_out() {
    let standing = sheet(9, 0.5, |x| Vec3::new(x.x + 0.011, 0.013, x.y + 0.057));
    let mesh = join(&[floor(), standing]).unwrap();
    is_undone(&mesh, 40, 0.5);
}

#[test]
fn result_is_the_same_in_every_run() {
    let run = || {
        let mesh = through(0.1);
        let mut x = mesh.positions().to_vec();
        let report =
            Untangler::new(&mesh).relax(&mut x, &vec![1.0; mesh.vertex_count()], 50, |_| ());
        (x, report)
    };
    assert_eq!(run(), run());
}
