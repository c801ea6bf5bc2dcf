//! Where the mesh begins to lock.

use cloth_bench::studies::locking::sheet::{Kind, Sheet};
use cloth_bench::studies::locking::sweeps::{critical_length, halved_at};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::equilateral;

#[test]
fn a_curve_is_halved_where_it_crosses_half() {
    let power = |x: Real| (x, 3.0 * x.powi(-2));
    let curve = [power(1.0), power(1.3), power(5.0)];
    assert!((halved_at(&curve).unwrap() - 2.0_f64.sqrt()).abs() < 1e-12);
    assert_eq!(halved_at(&curve[..2]), None);
    assert_eq!(halved_at(&[]), None);
}

/// The estimate, `Y l⁴/(702 D R²)`, is the membrane over the bending energy of equilateral springs with all
/// vertices on a cylinder of radius R: an edge at the angle φ to the axis is short by `l² sin⁴φ/(24 R²)`.
#[test]
fn the_estimate_is_the_energy_of_springs_on_a_cylinder() {
    let (cells, radius, modulus) = (40, 20.0, 1e3);
    let mesh = equilateral(cells + 1, cells + 1, 1.0).unwrap();
    let sheet = Sheet::new(mesh, Kind::Springs, modulus, 1.0).unwrap();
    // The mean of sin⁸φ over three directions is that over all, 35/128, but for a term in cos 6φ.
    let energy = |turn: Real| {
        let axis = Vec3::new(turn.cos(), turn.sin(), 0.0);
        let across = Vec3::new(-axis.y, axis.x, 0.0);
        let rolled = sheet.placed(|p| {
            let s = across.dot(p) / radius;
            axis * axis.dot(p) + across * (radius * s.sin()) + Vec3::z() * (radius * s.cos())
        });
        sheet.membrane_energy(&rolled).unwrap() / sheet.bending_energy(&rolled).unwrap()
    };
    let mean = (0..6)
        .map(|k| energy(std::f64::consts::PI * Real::from(k) / 18.0))
        .sum::<Real>()
        / 6.0;
    let estimate = critical_length(radius, modulus, 1.0).powi(-4);
    let (rim, edges) = (mean / estimate, 3.0 / cells as Real);
    assert!((rim - 1.0).abs() < edges, "{rim}");
}
