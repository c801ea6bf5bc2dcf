//! Area and volume constraints: derivatives, invariances, degenerate shapes, and what position-based sweeps make of
//! them.

use crate::element_checks::{
    balanced, convex_choices_are_convex, derivatives_agree, is_invariant, noise, shape,
};
use cloth_core::element::{Constraint, Energy};
use cloth_core::energy::{AreaTriangle, VolumeTetrahedron};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate;

const REST: [Vec3; 4] = [
    Vec3::new(0.1, 0.2, 0.3),
    Vec3::new(1.3, 0.1, -0.2),
    Vec3::new(0.5, 0.9, 0.1),
    Vec3::new(0.4, 0.3, 1.1),
];

fn triangle() -> [Vec3; 3] {
    [REST[0], REST[1], REST[2]]
}

fn area() -> AreaTriangle {
    AreaTriangle::new([0, 1, 2], &triangle(), 40.0)
}

fn volume() -> VolumeTetrahedron {
    VolumeTetrahedron::new([0, 1, 2, 3], &REST, 40.0)
}

#[test]
fn derivatives_agree_with_differences() {
    for seed in 0..60 {
        let x: [Vec3; 3] = shape(seed);
        let height = (x[1] - x[0]).cross(&(x[2] - x[0])).norm();
        if height > 0.02 {
            derivatives_agree(&area(), &x, height.min(1.0));
        }
        derivatives_agree(&volume(), &shape(seed), 1.0);
        convex_choices_are_convex(&area(), &x);
        convex_choices_are_convex(&volume(), &shape(seed));
    }
    for scale in [0.2, 0.9, 1.0, 1.5] {
        derivatives_agree(&area(), &triangle().map(|x| x * scale), 1.0);
        derivatives_agree(&volume(), &REST.map(|x| x * scale), 1.0);
    }
    // Flat, and inside out: nothing special about them.
    let flat = REST.map(|x| x.component_mul(&Vec3::new(1.0, 1.0, 0.0)));
    let mirrored = REST.map(|x| x.component_mul(&Vec3::new(1.0, 1.0, -0.8)));
    derivatives_agree(&volume(), &flat, 1.0);
    derivatives_agree(&volume(), &mirrored, 1.0);
}

#[test]
fn rigid_motions_are_not_noticed_and_the_rest_shape_costs_nothing() {
    for seed in 0..20 {
        is_invariant(&area(), &shape(seed));
        is_invariant(&volume(), &shape(seed));
    }
    assert!(area().value(&triangle()) < 1e-28 && volume().value(&REST) < 1e-28);
}

#[test]
fn moduli_are_energies_per_rest_size() {
    let s: Real = 1.1;
    let law = 0.5 * 40.0 * (s * s - 1.0).powi(2) * area().rest_area;
    assert!((area().value(&triangle().map(|x| x * s)) / law - 1.0).abs() < 1e-13);
    let law = 0.5 * 40.0 * (s.powi(3) - 1.0).powi(2) * volume().rest_volume.abs();
    assert!((volume().value(&REST.map(|x| x * s)) / law - 1.0).abs() < 1e-13);
    // Sheared, both keep their size.
    let shear = |x: Vec3| x + Vec3::new(0.7 * x.z, 0.0, 0.0);
    assert!(volume().value(&REST.map(shear)) < 1e-27);
    // On a mesh.
    let mesh = generate::irregular(6, 1.0, 1.0, 2).unwrap();
    let areas: Real = AreaTriangle::on(&mesh, 1.0)
        .iter()
        .map(|a| a.rest_area)
        .sum();
    assert!((areas - 1.0).abs() < 1e-13);
}

#[test]
fn a_tetrahedron_turned_inside_out_has_its_volume_with_the_other_sign() {
    let mirrored = REST.map(|x| x.component_mul(&Vec3::new(1.0, 1.0, -1.0)));
    let [row] = volume().rows(&mirrored);
    assert!((row.value + 2.0 * volume().rest_volume).abs() < 1e-15);
}

#[test]
fn collapsed_shapes_are_finite_everywhere() {
    let line = [0.0, 1.0, 3.0, 4.0].map(|t| Vec3::new(t, 0.3 * t, -t));
    let doubled = [REST[0], REST[1], REST[1], REST[1]];
    for start in [line, doubled, [noise(1); 4], [Vec3::zeros(); 4]] {
        for size in [0.0, 1e-300, 1e-100, 1e-12, 1e-8] {
            let x: [Vec3; 4] = std::array::from_fn(|i| start[i] + noise(i + 9) * size);
            balanced(&volume(), &x);
            balanced(&area(), &[x[0], x[1], x[2]]);
            // Nothing is left of the volume or area, so all of it is missing: E = ½ k V₀².
            let [row] = volume().rows(&x);
            let missing = 0.5 * row.stiffness * volume().rest_volume.powi(2);
            assert!((volume().value(&x) / missing - 1.0).abs() < 1e-6);
            let [row] = area().rows(&[x[0], x[1], x[2]]);
            let missing = 0.5 * row.stiffness * area().rest_area.powi(2);
            assert!(
                start == doubled
                    || (area().value(&[x[0], x[1], x[2]]) / missing - 1.0).abs() < 1e-6
            );
        }
    }
}

#[test]
fn a_flattened_triangle_is_pulled_apart_across_its_line() {
    for x in [
        [0.0, 1.0, 3.0].map(|t| Vec3::new(t, 0.0, 0.0)),
        [0.0, 1.0, 3.0].map(|t| Vec3::new(t, -2.0 * t, t)),
        [Vec3::zeros(), Vec3::zeros(), Vec3::new(0.0, 0.0, 2.0)],
    ] {
        let [row] = area().rows(&x);
        assert_eq!(row.value, -area().rest_area);
        let along = (x[2] - x[0]).normalize();
        for g in row.gradient {
            assert!(g.dot(&along).abs() < 1e-15);
        }
        let size: Real = row.gradient.iter().map(Vec3::norm).sum();
        // Half of what is opposite to each: the perimeter, twice the longest side.
        assert!((size - (x[2] - x[0]).norm()).abs() < 1e-14, "{size}");
    }
}
