//! Energies seen from single vertices.

use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::element::Convexity;
use cloth_core::energy::StvkTriangle;
use cloth_core::math::{Mat3, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::method::family::Energies;

/// A crumpled sheet with springs, hinges and triangles.
fn sheet() -> (Energies, Vec<Vec3>) {
    let mesh = grid(9, 7, 1.0, 0.8, Diagonals::Alternating).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::Modulus(1e3),
        bending_rigidity: 1e-3,
    };
    let model = cloth.on(&mesh).unwrap();
    let triangles = StvkTriangle::on(&mesh, 300.0, 0.3);
    let energies = model.energies().unwrap().with(triangles).unwrap();
    let crumpled = |p: &Vec3| p + Vec3::new((7.0 * p.y).sin(), 0.3, (9.0 * p.x).cos()) * 0.05;
    let x = mesh.positions().iter().map(crumpled).collect();
    (energies, x)
}

#[test]
fn vertex_terms_are_the_gradient_and_the_diagonal_blocks_of_the_whole() {
    let (energies, x) = sheet();
    let incidence = energies.incidence();
    let mut whole = vec![Vec3::zeros(); x.len()];
    energies.add_gradient(&x, &mut whole);
    let vertices: Vec<u32> = (0..x.len() as u32).rev().collect();
    for convexity in [
        Convexity::Exact,
        Convexity::Clamp,
        Convexity::Abs,
        Convexity::GaussNewton,
    ] {
        let matrix = energies.hessian(&x, convexity);
        let mut gradient = vec![Vec3::zeros(); x.len()];
        let mut hessian = vec![Mat3::zeros(); x.len()];
        energies.add_at_vertices(
            &incidence,
            &vertices,
            &x,
            convexity,
            &mut gradient,
            &mut hessian,
        );
        for (i, &v) in vertices.iter().enumerate() {
            let slot = matrix.pattern().slot(v, v).unwrap() as usize;
            let block = matrix.blocks()[slot];
            assert!(
                (gradient[i] - whole[v as usize]).norm()
                    < 1e-12 * whole[v as usize].norm().max(1.0)
            );
            assert!((hessian[i] - block).norm() < 1e-12 * block.norm());
        }
    }
}

#[test]
fn no_two_vertices_of_a_color_belong_to_one_element() {
    let (energies, x) = sheet();
    let colors = energies.vertex_colors();
    let mut color_of = vec![None; x.len()];
    for (color, vertices) in colors.iter().enumerate() {
        for &v in vertices {
            assert_eq!(color_of[v as usize].replace(color), None);
        }
    }
    assert!(color_of.iter().all(Option::is_some));
    let pattern = energies.assembly();
    let pattern = pattern.pattern();
    for v in 0..x.len() {
        for &u in &pattern.columns()[pattern.row(v)] {
            assert!(u as usize == v || color_of[u as usize] != color_of[v]);
        }
    }
    // A hinge joins vertices two edges apart: 3 × 3 vertices and the wings beyond.
    assert!(colors.len() <= 12, "{} colours", colors.len());
}
