//! What is inside closed meshes: the force of a gas is p ∂V/∂x, whatever the shape, and that of a filling is the
//! derivative of its energy.

use cloth_core::contact::{
    ContactConstraints, ContactPotential, ContactSource, ContactStep, GlobalRows,
};
use cloth_core::enclosure::{ClosedVolume, Enclosed, EnclosureError, NoContact, Pressure};
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, join, sphere, torus};
use cloth_core::step::StepInput;

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
    assert!(matches!(open, EnclosureError::Open(_)), "{open}");
    let ball = sphere(2, 0.3).unwrap();
    let mut triangles = ball.triangles().to_vec();
    triangles[3].swap(0, 1);
    let mixed = TriMesh::new(ball.positions().to_vec(), triangles).unwrap();
    let mixed = Pressure::new(1.0, &mixed).unwrap_err();
    assert!(
        matches!(mixed, EnclosureError::InconsistentlyOriented(_)),
        "{mixed}"
    );
    let endless = Pressure::new(f64::INFINITY, &ball).unwrap_err();
    assert!(endless.to_string().contains("finite"), "{endless}");
}

/// Energy, gradient and the part of rank one belong together, at a place where the filling presses.
#[test]
fn a_volume_is_one_energy_in_all_its_views() {
    let both = join(&[sphere(3, 0.4).unwrap(), sphere(2, 0.2).unwrap()]).unwrap();
    let own = both.triangle_count() - sphere(2, 0.2).unwrap().triangle_count();
    let (modulus, pressure) = (3e4, 500.0);
    let filling = ClosedVolume::inside(modulus, &both, own..both.triangle_count()).unwrap();
    let filling = filling.pressure(pressure).unwrap();
    let rest = both.positions();
    assert!((filling.gauge_pressure(rest) / pressure - 1.0).abs() < 1e-12);
    let expected = 0.5 * filling.rest_volume() * pressure * pressure / modulus;
    assert!((filling.energy(rest) / expected - 1.0).abs() < 1e-12);

    let x = shaken(rest);
    let mut gradient = vec![Vec3::zeros(); x.len()];
    let energy = filling.add_gradient(&x, &mut gradient);
    assert!((energy / filling.energy(&x) - 1.0).abs() < 1e-14);
    let inside = Enclosed::alone(vec![filling.clone()]);
    let mut rows = GlobalRows::default();
    inside.linearize_globally(&x, &mut rows);
    let [row] = rows.rows() else {
        panic!("{rows:?}");
    };
    let p = filling.gauge_pressure(&x);
    let moved = shaken(&x);
    let steps: Vec<Vec3> = moved.iter().zip(&x).map(|(a, b)| (a - b) * 1e-4).collect();
    let at =
        |scale: f64| -> Vec<Vec3> { x.iter().zip(&steps).map(|(x, p)| x + p * scale).collect() };
    // The gradient of E is −p times that of V, and both are slopes.
    let slope = (filling.energy(&at(1.0)) - filling.energy(&at(-1.0))) / 2.0;
    let along: f64 = gradient.iter().zip(&steps).map(|(g, p)| g.dot(p)).sum();
    assert!((slope / along - 1.0).abs() < 1e-6, "{slope} {along}");
    assert!((-p * row.dot(&steps) / along - 1.0).abs() < 1e-12);
    assert!((row.stiffness - modulus / filling.rest_volume()).abs() < 1e-9 * row.stiffness);
    // Vertices of the other piece have no part in it.
    let first = rest.len() - row.vertices.len();
    assert!(row.vertices.iter().all(|&v| v as usize >= first));
    assert!(gradient[..first].iter().all(|g| *g == Vec3::zeros()));
}

/// Radial motion of a sphere without a membrane is an oscillation of ω² = k Σ w ‖∂V‖²; a substep of XPBD is one of
/// implicit Euler on it, C₁ = C₀/(1 + h²ω²), exact where V is linear.
#[test]
fn the_projection_is_an_implicit_step() {
    let ball = sphere(5, 0.3).unwrap();
    let filling = ClosedVolume::new(2e3, &ball).unwrap();
    let count = ball.vertex_count();
    let w = vec![40.0; count];
    let mut rows = GlobalRows::default();
    let mut inside = Enclosed::alone(vec![filling.clone()]);
    inside.linearize_globally(ball.positions(), &mut rows);
    let row = &rows.rows()[0];
    let square: f64 = row.gradient.iter().map(|g| 40.0 * g.norm_squared()).sum();
    for h in [1e-4, 1e-3, 1e-1] {
        let mut x: Vec<Vec3> = ball.positions().iter().map(|x| x * (1.0 + 1e-7)).collect();
        let step = ContactStep {
            from: ball.positions(),
            inverse_mass: &w,
            dt: h,
        };
        let before = filling.volume(&x) - filling.rest_volume();
        inside.begin_substep(&step, &x).unwrap();
        inside.sweep(&step, &mut x);
        let after = filling.volume(&x) - filling.rest_volume();
        let expected = before / (1.0 + h * h * row.stiffness * square);
        assert!(
            (after - expected).abs() < 1e-6 * before,
            "{h}: {after} {expected}"
        );
        // A second sweep of the same substep finds nothing left to do.
        inside.sweep(&step, &mut x);
        let again = filling.volume(&x) - filling.rest_volume();
        assert!(
            (again - after).abs() < 1e-6 * before,
            "{h}: {again} {after}"
        );
    }
}

/// Prescribed vertices that press a filling together do the work that it stores.
#[test]
fn the_work_of_pins_is_the_energy_of_the_filling() {
    let ball = sphere(4, 0.3).unwrap();
    let filling = ClosedVolume::new(1e4, &ball).unwrap();
    let mut inside = Enclosed::alone(vec![filling]);
    let pinned = vec![0.0; ball.vertex_count()];
    let mut from = ball.positions().to_vec();
    let mut work = 0.0;
    for _ in 0..100 {
        let to: Vec<Vec3> = from.iter().map(|x| x * 0.999).collect();
        let step = ContactStep {
            from: &from,
            inverse_mass: &pinned,
            dt: 0.01,
        };
        inside.begin_step(&step).unwrap();
        inside.end_step(&to);
        work += inside.work();
        from = to;
    }
    // By the mean of the forces at both ends: the error falls with the square of the steps.
    let stored = inside.potential_energy();
    assert!(
        stored > 1.0 && (work / stored - 1.0).abs() < 1e-4,
        "{work} J, {stored} J"
    );
}

#[test]
fn a_filling_without_meaning_is_refused() {
    let ball = sphere(2, 0.3).unwrap();
    for modulus in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        let told = ClosedVolume::new(modulus, &ball).unwrap_err().to_string();
        assert!(told.contains("bulk modulus"), "{told}");
    }
    let filling = ClosedVolume::new(1e4, &ball).unwrap();
    for pressure in [-1e4, f64::NAN] {
        let told = filling.clone().pressure(pressure).unwrap_err().to_string();
        assert!(told.contains("pressure"), "{told}");
    }
    let sheet = grid(3, 3, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let open = ClosedVolume::new(1.0, &sheet).unwrap_err();
    assert!(matches!(open, EnclosureError::Open(_)), "{open}");
    // Two sheets in one plane, joined all around.
    let x = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.3, 0.3], [0.3, 0.3]];
    let x = x.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec();
    let up = [[0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let down = up.map(|[a, b, _]| [b, a, 4]);
    let flat = TriMesh::new(x, [up, down].concat()).unwrap();
    let empty = ClosedVolume::new(1.0, &flat).unwrap_err();
    assert_eq!(empty, EnclosureError::Empty);
}

/// A source is lent to volumes, and both to a step; afterwards it is there again.
#[test]
fn lent_contacts_are_contacts() {
    let ball = sphere(2, 0.3).unwrap();
    let mut contacts = NoContact;
    {
        let volumes = vec![ClosedVolume::new(1e4, &ball).unwrap()];
        let mut lent = Enclosed::new(volumes, &mut contacts);
        let mut both = &mut lent;
        let input = StepInput::new(0.01).contacts(&mut both);
        assert!(input.contacts.is_some());
    }
    assert!(contacts.can_touch());
}
