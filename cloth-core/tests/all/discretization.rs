//! One description of a cloth, carried by different elements.

use cloth_core::cloth::{
    BendingElements, Cloth, ClothError, ClothModel, Discretization, Elements, Membrane,
    MembraneElements,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, equilateral, grid};
use cloth_core::topology::{EdgeTable, HingeTable};

const COTTON: Cloth = Cloth {
    areal_density: 0.2,
    membrane: Membrane::SpringStiffness(1e3),
    bending_rigidity: 1e-5,
};
const TRIANGLES: MembraneElements = MembraneElements::Stvk {
    poisson_ratio: 1.0 / 3.0,
};

fn sheet(diagonals: Diagonals) -> TriMesh {
    grid(9, 9, 1.0, 1.0, diagonals).unwrap()
}

/// Elastic energy (J) after a displacement of every vertex.
fn stored(model: &ClothModel, mesh: &TriMesh, place: impl Fn(&Vec3) -> Vec3) -> Real {
    let x: Vec<Vec3> = mesh.positions().iter().map(place).collect();
    model.energies().unwrap().value(&x)
}

#[test]
fn the_default_is_springs_and_quadratic_hinges() {
    let mesh = sheet(Diagonals::Alternating);
    let model = COTTON.on(&mesh).unwrap();
    assert_eq!(
        model,
        COTTON
            .discretized_with(&Discretization::default(), &mesh)
            .unwrap()
    );
    assert_eq!((model.springs.len(), model.hinges.len()), (208, 176));
    assert!(model.others.is_empty());
    let names: Vec<&str> = model.families().iter().map(Elements::name).collect();
    assert_eq!(names, ["springs", "quadratic hinges"]);
}

#[test]
fn triangles_get_the_modulus_that_the_springs_have() {
    let strain = 1e-5;
    for (mesh, modulus) in [
        (sheet(Diagonals::Alternating), 1e3 * 4.0 / 3.0),
        (equilateral(9, 9, 0.1).unwrap(), 1e3 * 2.0 / 3.0_f64.sqrt()),
    ] {
        for (membrane, poisson) in [(TRIANGLES, 1.0 / 3.0), (MembraneElements::Arap, 0.0)] {
            let discretization = Discretization {
                membrane,
                ..Default::default()
            };
            let model = COTTON.discretized_with(&discretization, &mesh).unwrap();
            assert!(model.springs.is_empty());
            let energy = stored(&model, &mesh, |p| p * (1.0 + strain)) / mesh.area();
            let expected = modulus * strain * strain / (1.0 - poisson);
            assert!((energy / expected - 1.0).abs() < 3.0 * strain, "{energy}");
        }
    }
}

/// Axial k1 and both diagonals k2 are isotropic if k1 = 2 k2, and only then.
#[test]
fn a_grid_with_both_diagonals_is_isotropic_when_they_are_half_as_stiff() {
    for diagonals in [Diagonals::OneWay, Diagonals::Alternating] {
        let mesh = sheet(diagonals);
        let edges = EdgeTable::build(&mesh).unwrap();
        let spread = |shear: Real| {
            let discretization = Discretization {
                shear: Some(shear),
                bending: BendingElements::None,
                ..Default::default()
            };
            let mut model = COTTON.discretized_with(&discretization, &mesh).unwrap();
            assert_eq!(model.others[0].len(), 64);
            // In the unbounded grid a spring on the rim belongs to this patch by half.
            for (edge, spring) in model.springs.iter_mut().enumerate() {
                if edges.is_boundary(edge) {
                    spring.stiffness *= 0.5;
                }
            }
            // Stretched in one direction and held in the other: ½ Y ε²/(1 − ν²) per area.
            let values = [0.0, 0.2, 0.5, 0.785, 2.0].map(|angle: Real| {
                let d = Vec3::new(angle.cos(), angle.sin(), 0.0);
                stored(&model, &mesh, |p| p + d * (1e-5 * d.dot(p))) / (0.5 * 1e-10)
            });
            let least = values.iter().copied().fold(Real::INFINITY, Real::min);
            let most = values.iter().copied().fold(0.0, Real::max);
            (least, most)
        };
        let (least, most) = spread(500.0);
        let expected = 1e3 * 4.0 / 3.0 / (1.0 - 1.0 / 9.0);
        assert!((least / expected - 1.0).abs() < 1e-4 && (most / expected - 1.0).abs() < 1e-4);
        let (least, most) = spread(1000.0);
        assert!(most > 1.1 * least, "{least} {most}");
    }
}

#[test]
fn every_kind_of_hinge_gets_its_constant_from_one_rigidity() {
    let mesh = sheet(Diagonals::Alternating);
    let cloth = Cloth {
        membrane: Membrane::SpringStiffness(0.0),
        ..COTTON
    };
    let energy = |bending| {
        let discretization = Discretization {
            bending,
            ..Default::default()
        };
        let model = cloth.discretized_with(&discretization, &mesh).unwrap();
        stored(&model, &mesh, |p| Vec3::new(p.x, p.y, 5e-4 * p.x * p.x))
    };
    let quadratic = energy(BendingElements::Quadratic);
    // ½ D κ² with κ = 10⁻³/m, on all but half a cell at either end.
    assert!((quadratic / (0.5e-5 * 1e-6 * 7.0 / 8.0) - 1.0).abs() < 1e-5);
    for bending in [
        BendingElements::Dihedral,
        BendingElements::Bridson,
        BendingElements::Cubic,
        BendingElements::Curved,
    ] {
        assert!((energy(bending) / quadratic - 1.0).abs() < 1e-5);
    }
    assert_eq!(energy(BendingElements::None), 0.0);
}

#[test]
fn bending_springs_stand_across_every_hinge() {
    let mesh = sheet(Diagonals::OneWay);
    let discretization = Discretization {
        bending: BendingElements::Springs(7.0),
        ..Default::default()
    };
    let model = COTTON.discretized_with(&discretization, &mesh).unwrap();
    let hinges = HingeTable::build(&mesh, &EdgeTable::build(&mesh).unwrap());
    let [Elements::Springs(springs)] = &model.others[..] else {
        panic!("{:?}", model.others)
    };
    assert_eq!(springs.len(), hinges.len());
    for (spring, hinge) in springs.iter().zip(hinges.hinges()) {
        assert_eq!(spring.vertices, [hinge[2], hinge[3]]);
        assert_eq!(spring.stiffness, 7.0);
    }
    assert!(model.hinges.is_empty());
}

#[test]
fn choices_that_do_not_fit_are_refused() {
    let grid = sheet(Diagonals::OneWay);
    let refused = |cloth: Cloth, discretization: Discretization, mesh: &TriMesh| {
        cloth.discretized_with(&discretization, mesh).unwrap_err()
    };
    let shear = Discretization {
        shear: Some(1.0),
        ..Default::default()
    };
    let by_modulus = Cloth {
        membrane: Membrane::Modulus(1.0),
        ..COTTON
    };
    assert_eq!(
        refused(by_modulus, shear, &grid),
        ClothError::ShearWithoutStiffness
    );
    let beside_triangles = Discretization {
        membrane: MembraneElements::Arap,
        ..shear
    };
    assert_eq!(
        refused(COTTON, beside_triangles, &grid),
        ClothError::ShearWithoutStiffness
    );
    let triangles = equilateral(4, 4, 1.0).unwrap();
    assert_eq!(refused(COTTON, shear, &triangles), ClothError::NoRectangles);
    for poisson_ratio in [1.0, -1.0, Real::NAN] {
        let discretization = Discretization {
            membrane: MembraneElements::Stvk { poisson_ratio },
            ..Default::default()
        };
        let words = refused(COTTON, discretization, &grid).to_string();
        assert!(words.contains("Poisson"), "{words}");
    }
    for (discretization, word) in [
        (
            Discretization {
                shear: Some(-1.0),
                ..Default::default()
            },
            "shear stiffness",
        ),
        (
            Discretization {
                bending: BendingElements::Springs(Real::INFINITY),
                ..Default::default()
            },
            "bending springs",
        ),
    ] {
        let words = refused(COTTON, discretization, &grid).to_string();
        assert!(words.contains(word), "{words}");
    }
}

/// The rim stands for half a cell: the whole k on it is k/n too much, with n cells across the pull.
#[test]
fn equal_springs_up_to_the_rim_are_stiffer_along_it_by_k_over_n() {
    let (mesh, strain) = (sheet(Diagonals::Alternating), 1e-5);
    let stiffness = |membrane| {
        let model = Cloth { membrane, ..COTTON }.on(&mesh).unwrap();
        let pull = |p: &Vec3| Vec3::new(p.x * (1.0 + strain), p.y, 0.0);
        2.0 * stored(&model, &mesh, pull) / (strain * strain) / 1e3
    };
    let half = stiffness(Membrane::Modulus(1e3 * 4.0 / 3.0));
    assert!((half / 1.5 - 1.0).abs() < 3.0 * strain, "{half}");
    let whole = stiffness(Membrane::SpringStiffness(1e3));
    assert!(
        (whole / (1.5 + 1.0 / 8.0) - 1.0).abs() < 3.0 * strain,
        "{whole}"
    );
}
