//! The contact of cloth with cloth as a plain loop over all pairs, beside the real one: two sheets that lie on each
//! other.
//!
//! `cargo run --release -p cloth-collide --example naive_pairs`
//!
//! It costs a number of distances in proportion to the square of the number of vertices: 124,976 pairs of these two
//! sheets of 8 × 8 cells, of which 611 have energy. What the crate adds is to leave out the pairs that cannot be near.
//! Energy, forces and the Gauss–Newton part of the Hessian are compared.

use cloth_collide::QueryKind;
use cloth_collide::obstacle::PenaltyLaw;
use cloth_collide::potential::{Mollifier, Pair, PairContact, PotentialContacts};
use cloth_core::contact::{ContactPotential, ContactStep};
use cloth_core::element::{Convexity, Energy};
use cloth_core::{Diagonals, TriMesh, Vec3, grid};
use std::collections::BTreeMap;

const THICKNESS: f64 = 5e-3; // h (m)
const STIFFNESS: f64 = 1e6; // κ (Pa/m)

/// All pairs of a vertex and a triangle, and of two edges, that share no vertex.
fn all_pairs(mesh: &TriMesh) -> Vec<PairContact> {
    let (rest, law) = (mesh.positions(), PenaltyLaw::new(STIFFNESS, THICKNESS));
    let law = law.expect("positive numbers");
    // Edges push from half of the thickness on.
    let half = PenaltyLaw::new(STIFFNESS, 0.5 * THICKNESS).expect("positive numbers");
    // A third of the area of the triangles around each vertex, and beside each edge.
    let mut of_vertex = vec![0.0; rest.len()];
    let mut of_edge = BTreeMap::new();
    for (&[a, b, c], area) in mesh.triangles().iter().zip(mesh.areas()) {
        for v in [a, b, c] {
            of_vertex[v as usize] += area / 3.0;
        }
        for [a, b] in [[a, b], [b, c], [c, a]] {
            *of_edge.entry([a.min(b), a.max(b)]).or_insert(0.0) += area / 3.0;
        }
    }
    let mut all = Vec::new();
    for &[a, b, c] in mesh.triangles() {
        for vertex in (0..rest.len() as u32).filter(|v| ![a, b, c].contains(v)) {
            let (kind, vertices) = (QueryKind::VertexTriangle, [vertex, a, b, c]);
            all.push(PairContact {
                pair: Pair { kind, vertices },
                // The vertices of both sheets press, so each with half of its area.
                area: 0.5 * of_vertex[vertex as usize],
                law,
                mollifier: None,
            });
        }
    }
    let squared = |[a, b]: [u32; 2]| (rest[a as usize] - rest[b as usize]).norm_squared();
    let edges: Vec<([u32; 2], f64)> = of_edge.into_iter().collect();
    for (k, &(one, area)) in edges.iter().enumerate() {
        let others = edges[k + 1..].iter();
        for &(other, beside) in others.filter(|(other, _)| !other.iter().any(|v| one.contains(v))) {
            let (kind, vertices) = (QueryKind::EdgeEdge, [one[0], one[1], other[0], other[1]]);
            all.push(PairContact {
                pair: Pair { kind, vertices },
                area: f64::min(area, beside),
                law: half,
                mollifier: Some(Mollifier::new([squared(one), squared(other)])),
            });
        }
    }
    all
}

/// Two sheets of 8 × 8 cells, 1.5 to 3.5 mm apart: the vertices push everywhere, edges where it is less than h/2.
fn sheets() -> Result<TriMesh, Box<dyn std::error::Error>> {
    let one = grid(9, 9, 0.4, 0.4, Diagonals::Alternating)?;
    let count = one.vertex_count() as u32;
    let above = |x: &Vec3| {
        let height = 2.5e-3 + 1e-3 * (25.0 * x.x + 10.0 * x.y).sin();
        Vec3::new(0.9 * x.x - 0.3 * x.y, 0.3 * x.x + 0.9 * x.y, height)
    };
    let mut positions = one.positions().to_vec();
    positions.extend(one.positions().iter().map(above));
    let mut triangles = one.triangles().to_vec();
    triangles.extend(one.triangles().iter().map(|t| t.map(|v| v + count)));
    Ok(TriMesh::new(positions, triangles)?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = sheets()?;
    let x = mesh.positions();

    let all = all_pairs(&mesh);
    // Displacements p (m) for pᵀ H p (J): the upper sheet is pulled up and sideways.
    let pull = |x: &Vec3| Vec3::new(x.y, x.x, 1.0) * x.z;
    let p: Vec<Vec3> = x.iter().map(pull).collect();
    let (mut naive, mut slope, mut near) = (0.0, vec![Vec3::zeros(); x.len()], 0);
    let mut bend = 0.0;
    for contact in &all {
        let vertices = contact.pair.vertices.map(|v| v as usize);
        let places = vertices.map(|v| x[v]);
        let (energy, gradient) = contact.value_and_gradient(&places);
        if energy == 0.0 {
            continue;
        }
        naive += energy;
        near += 1;
        // Twelve by twelve numbers, as four by four blocks.
        let blocks = contact.hessian(&places, Convexity::GaussNewton);
        for k in 0..4 {
            slope[vertices[k]] += gradient[k];
            for l in 0..4 {
                bend += p[vertices[k]].dot(&(blocks[k][l] * p[vertices[l]]));
            }
        }
    }

    let mut contacts = PotentialContacts::builder(&mesh)
        .thickness(THICKNESS)
        .stiffness(STIFFNESS)
        .build()?;
    let step = ContactStep {
        from: x,
        inverse_mass: &vec![1.0; x.len()],
        dt: 0.01,
    };
    contacts.begin(&step, &mut x.to_vec())?;
    contacts.limit(x, x)?; // an empty path: finds the pairs
    let mut gradient = vec![Vec3::zeros(); x.len()];
    let real = contacts.add_gradient(x, &mut gradient);
    // The same Hessian as k J Jᵀ, J_i = c_i n: four weights, a normal and a stiffness instead of 144 numbers.
    let mut rows = Vec::new();
    contacts.linearize(x, &mut rows);
    let mut by_rows = 0.0;
    for row in &rows {
        let ends = row.vertices.iter().zip(row.weights);
        let along: f64 = ends.map(|(v, w)| w * row.normal.dot(&p[*v as usize])).sum();
        by_rows += row.stiffness * along * along;
    }

    let differences = slope.iter().zip(&gradient).map(|(a, b)| (a - b).norm());
    let apart = differences.fold(0.0, f64::max);
    let largest = gradient.iter().map(Vec3::norm).fold(0.0, f64::max);
    println!("{near} of {} pairs have energy", all.len());
    println!("{naive:.6} J and {real:.6} J; the forces differ by {apart:.1e} N of {largest:.3} N");
    let edges = |c: &&PairContact| c.mollifier.is_some();
    let energy = |c: &PairContact| c.value(&c.pair.vertices.map(|v| x[v as usize]));
    assert!(all.iter().filter(edges).map(energy).sum::<f64>() > 0.0);
    println!("pᵀ H p is {bend:.6} J and {by_rows:.6} J");
    assert!((naive / real - 1.0).abs() < 1e-12 && apart < 1e-12 * largest);
    assert!((bend / by_rows - 1.0).abs() < 1e-12);
    Ok(())
}

#[test]
fn the_loop_over_all_pairs_and_the_contact_potential_give_the_same_forces() {
    main().unwrap();
}
