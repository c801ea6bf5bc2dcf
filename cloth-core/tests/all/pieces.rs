//! A cloth of several materials: each piece is what its own material says, and nothing else changes.

use cloth_core::cloth::{
    BendingElements, Cloth, ClothError, ClothModel, Discretization, Membrane, MembraneElements,
    Piece,
};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, join};

const COTTON: Cloth = Cloth {
    areal_density: 0.2,
    membrane: Membrane::Modulus(1000.0),
    bending_rigidity: 1e-5,
};
const LEATHER: Cloth = Cloth {
    areal_density: 0.8,
    membrane: Membrane::SpringStiffness(4e4),
    bending_rigidity: 1e-3,
};

fn sheet() -> TriMesh {
    grid(5, 4, 1.0, 0.7, Diagonals::Alternating).unwrap()
}

fn piece(cloth: Cloth, discretization: Discretization, triangles: std::ops::Range<u32>) -> Piece {
    Piece {
        cloth,
        discretization,
        triangles: triangles.collect(),
    }
}

#[test]
fn one_piece_of_all_triangles_is_the_whole_cloth() {
    let mesh = sheet();
    let all = mesh.triangles().len() as u32;
    for bending in [BendingElements::Quadratic, BendingElements::Dihedral] {
        let discretization = Discretization {
            bending,
            ..Discretization::default()
        };
        let model =
            ClothModel::of_pieces(&mesh, &[piece(COTTON, discretization, 0..all)], &[]).unwrap();
        assert_eq!(
            model,
            COTTON.discretized_with(&discretization, &mesh).unwrap()
        );
    }
}

/// Two sheets in one mesh hold the masses and the energy of the two alone.
#[test]
fn pieces_apart_are_the_cloths_they_would_be_alone() {
    let stvk = Discretization {
        membrane: MembraneElements::Stvk { poisson_ratio: 0.2 },
        bending: BendingElements::Dihedral,
        ..Discretization::default()
    };
    let sheet = sheet();
    let (count, triangles) = (sheet.vertex_count(), sheet.triangles().len() as u32);
    let both = join(&[sheet.clone(), sheet.clone()]).unwrap();
    for (first, second) in [
        (Discretization::default(), Discretization::default()),
        (Discretization::default(), stvk),
        (stvk, stvk),
    ] {
        let pieces = [
            piece(COTTON, first, 0..triangles),
            piece(LEATHER, second, triangles..2 * triangles),
        ];
        let model = ClothModel::of_pieces(&both, &pieces, &[]).unwrap();
        let alone = [(COTTON, first), (LEATHER, second)].map(|(cloth, discretization)| {
            cloth.discretized_with(&discretization, &sheet).unwrap()
        });
        let masses = alone.each_ref().map(|model| model.particles.mass());
        assert_eq!(model.particles.mass(), masses.concat());
        let x: Vec<_> = (0..2 * count)
            .map(|v| both.positions()[v] * (1.0 + 0.01 * v as f64))
            .collect();
        let energy = |model: &ClothModel, x| model.energies().unwrap().value(x);
        let sum = energy(&alone[0], &x[..count]) + energy(&alone[1], &x[count..]);
        let found = energy(&model, &x);
        assert!((found - sum).abs() < 1e-13 * sum, "{found} {sum}");
    }
}

/// Triangles in no piece carry nothing: the springs left are those of the mesh without them.
#[test]
fn what_is_in_no_piece_carries_nothing() {
    let mesh = sheet();
    let is_kept = |triangle: &u32| *triangle != 9;
    let kept: Vec<u32> = (0..mesh.triangles().len() as u32).filter(is_kept).collect();
    let corners = kept.iter().map(|&t| mesh.triangles()[t as usize]);
    let rest = TriMesh::new(mesh.positions().to_vec(), corners.collect());
    let pieces = [Piece {
        cloth: LEATHER,
        discretization: Discretization::default(),
        triangles: kept,
    }];
    let model = ClothModel::of_pieces(&mesh, &pieces, &[]).unwrap();
    let alone = LEATHER.on(&rest.unwrap()).unwrap();
    assert_eq!(model, alone);
}

#[test]
fn pieces_that_do_not_fit_are_refused() {
    let mesh = sheet();
    let all = mesh.triangles().len() as u32;
    let plain = Discretization::default();
    let refused = |pieces: &[Piece]| ClothModel::of_pieces(&mesh, pieces, &[]).unwrap_err();
    let beyond = refused(&[piece(COTTON, plain, 0..all + 1)]);
    assert_eq!(beyond, ClothError::NoSuchTriangle(all));
    let twice = refused(&[piece(COTTON, plain, 0..all), piece(LEATHER, plain, 3..4)]);
    assert_eq!(twice, ClothError::InTwoPieces(3));
    let lonely = refused(&[piece(COTTON, plain, 0..2)]).to_string();
    assert!(lonely.contains("mass"), "{lonely}");
    let massless = Cloth {
        areal_density: 0.0,
        ..COTTON
    };
    let density = refused(&[piece(massless, plain, 0..all)]).to_string();
    assert!(density.contains("density"), "{density}");
}
