//! Gas inside closed meshes: its force is p ∂V/∂x, whatever the shape.

use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, join, sphere, torus};
use cloth_core::pressure::{Pressure, PressureError};

fn shaken(x: &[Vec3]) -> Vec<Vec3> {
    let noise = |v: usize| (v as f64 * 12.9898).sin() * 0.01;
    let moved = x.iter().enumerate();
    moved
        .map(|(v, x)| x + Vec3::new(noise(v), noise(v + 7), noise(v + 31)))
        .collect()
}

fn load(gas: &Pressure, x: &[Vec3]) -> Vec<Vec3> {
    let mut load = vec![Vec3::zeros(); x.len()];
    gas.add_load(x, &mut load);
    load
}

#[test]
fn forces_are_the_gradient_of_the_volume() {
    let p = 250.0;
    for mesh in [sphere(3, 0.4).unwrap(), torus(8, 6, 0.5, 0.2).unwrap()] {
        let x = shaken(mesh.positions());
        let gas = Pressure::new(p, &mesh).unwrap();
        let forces = load(&gas, &x);
        let largest = forces.iter().map(Vec3::norm).fold(0.0, f64::max);
        let sum: Vec3 = forces.iter().sum();
        let torque: Vec3 = forces.iter().zip(&x).map(|(f, x)| x.cross(f)).sum();
        assert!(sum.norm() < 1e-13 * largest, "{sum}");
        assert!(torque.norm() < 1e-13 * largest, "{torque}");
        let h = 1e-5;
        for v in [0, 5, x.len() - 1] {
            for axis in 0..3 {
                let at = |shift: f64| {
                    let mut x = x.clone();
                    x[v][axis] += shift;
                    gas.volume(&x)
                };
                // V is linear in each vertex, so the difference is exact but for rounding.
                let slope = p * (at(h) - at(-h)) / (2.0 * h);
                let error = (slope - forces[v][axis]).abs();
                assert!(error < 1e-8 * largest, "{slope} {}", forces[v][axis]);
            }
        }
    }
}

/// The volume does not care which way the triangles of a file run, or what else is in the mesh.
#[test]
fn inside_is_inside_however_the_triangles_run() {
    let ball = sphere(4, 0.3).unwrap();
    let reversed = ball.triangles().iter().map(|&[a, b, c]| [a, c, b]);
    let turned = TriMesh::new(ball.positions().to_vec(), reversed.collect()).unwrap();
    let [one, other] = [&ball, &turned].map(|mesh| Pressure::new(100.0, mesh).unwrap());
    let x = ball.positions();
    assert!((one.volume(x) - other.volume(x)).abs() < 1e-15 && one.volume(x) > 0.1);
    assert_eq!(load(&one, x).len(), load(&other, x).len());
    for (a, b) in load(&one, x).iter().zip(load(&other, x)) {
        assert!((a - b).norm() < 1e-13);
    }
    let sheet = grid(4, 4, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let both = join(&[sheet.clone(), ball.clone()]).unwrap();
    let own = sheet.triangle_count()..both.triangle_count();
    let gas = Pressure::inside(100.0, &both, own).unwrap();
    let forces = load(&gas, both.positions());
    assert!(forces[..16].iter().all(|f| *f == Vec3::zeros()));
    assert_eq!(forces[16..], load(&one, x));
}

#[test]
fn what_has_no_inside_is_refused() {
    let sheet = grid(3, 3, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let open = Pressure::new(1.0, &sheet).unwrap_err();
    assert!(matches!(open, PressureError::Open(_)), "{open}");
    let ball = sphere(2, 0.3).unwrap();
    let mut triangles = ball.triangles().to_vec();
    triangles[3].swap(0, 1);
    let mixed = TriMesh::new(ball.positions().to_vec(), triangles).unwrap();
    let mixed = Pressure::new(1.0, &mixed).unwrap_err();
    assert!(matches!(mixed, PressureError::Disagree(_)), "{mixed}");
    let endless = Pressure::new(f64::INFINITY, &ball).unwrap_err();
    assert!(endless.to_string().contains("finite"), "{endless}");
}
