//! Vertices that are sewn together make neighbours of the parts of the cloth around them.

use cloth_collide::SeparationProbe;
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactPotential, ContactStep};
use cloth_core::error::OutOfRange;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, join};
use cloth_core::step::BuildError;

const THICKNESS: Real = 0.01;

/// Two sheets of 4 × 4 vertices in a plane, `gap` (m) apart, and the pairs of vertices that face each other.
fn beside(gap: Real) -> (TriMesh, Vec<[u32; 2]>) {
    let one = grid(4, 4, 0.3, 0.3, Diagonals::Alternating).unwrap();
    let shifted = one.positions().iter();
    let shifted = shifted
        .map(|x| x + Vec3::new(0.3 + gap, 0.0, 0.0))
        .collect();
    let other = TriMesh::new(shifted, one.triangles().to_vec()).unwrap();
    let pairs = (0..4).map(|row| [4 * row + 3, 16 + 4 * row]).collect();
    (join(&[one, other]).unwrap(), pairs)
}

/// Energy (J) of contact at rest, and the largest force (N).
fn pushed(contacts: &mut PotentialContacts, x: &[Vec3]) -> (Real, Real) {
    let mut start = x.to_vec();
    let inverse_mass = vec![1.0; x.len()];
    let step = ContactStep {
        from: x,
        inverse_mass: &inverse_mass,
        dt: 0.01,
    };
    contacts.begin(&step, &mut start).unwrap();
    let mut gradient = vec![Vec3::zeros(); x.len()];
    let energy = contacts.add_gradient(x, &mut gradient);
    (energy, gradient.iter().map(Vec3::norm).fold(0.0, Real::max))
}

#[test]
fn a_seam_inside_the_thickness_pushes_nothing() {
    let (mesh, pairs) = beside(1e-4);
    let x = mesh.positions();
    let builder = || PotentialContacts::builder(&mesh).thickness(THICKNESS);
    let mut apart = builder().build().unwrap();
    let (energy, force) = pushed(&mut apart, x);
    assert!(energy > 0.0 && force > 0.0, "{energy:e} J, {force:e} N");
    let mut sewn = builder().sew(&pairs, &[]).build().unwrap();
    assert_eq!(pushed(&mut sewn, x), (0.0, 0.0));
    // Sewn later, and undone.
    apart.sew(&pairs, &[]);
    assert_eq!(pushed(&mut apart, x), (0.0, 0.0));
    apart.sew(&[], &[]);
    assert_eq!(pushed(&mut apart, x), (energy, force));
}

#[test]
fn beyond_the_seam_the_pieces_keep_out_of_each_other() {
    let (mesh, pairs) = beside(1e-4);
    let mut sewn = PotentialContacts::builder(&mesh)
        .thickness(THICKNESS)
        .sew(&pairs, &[])
        .build()
        .unwrap();
    // The second sheet is folded back over the first one, half a thickness above it at its far end.
    let mut x = mesh.positions().to_vec();
    for v in 16..32 {
        let past = x[v].x - 0.3;
        x[v].x = 0.3 - past + 0.01;
        x[v].z = if past < 0.05 { 0.0 } else { 0.5 * THICKNESS };
    }
    let (energy, _) = pushed(&mut sewn, &x);
    assert!(energy > 0.0);
    // Pushed through, it is counted.
    let mut probe = SeparationProbe::new(&mesh).sew(&pairs, &[]);
    assert_eq!(probe.measure(&x).unwrap().intersecting_pairs, 0);
    for v in [18, 22, 26, 30] {
        x[v].z = -0.5 * THICKNESS;
    }
    assert!(probe.measure(&x).unwrap().intersecting_pairs > 0);
}

#[test]
fn triangles_that_meet_at_a_seam_do_not_count_as_crossing() {
    let (mesh, pairs) = beside(-1e-4);
    let x = mesh.positions();
    let all = SeparationProbe::new(&mesh).measure(x).unwrap();
    assert!(all.intersecting_pairs > 0);
    let sewn = SeparationProbe::new(&mesh)
        .sew(&pairs, &[])
        .measure(x)
        .unwrap();
    assert_eq!(sewn.intersecting_pairs, 0);
    assert!(sewn.min_distance.unwrap() > 0.05, "{sewn:?}");
}

#[test]
fn a_sewn_vertex_that_there_is_not_is_refused() {
    let (mesh, _) = beside(1e-4);
    let built = PotentialContacts::builder(&mesh)
        .sew(&[[0, 32]], &[])
        .build();
    match built.map(drop) {
        Err(BuildError::OutOfRange(OutOfRange { name, value, .. })) => {
            assert_eq!((name, value), ("number of a sewn vertex", 32.0));
        }
        other => panic!("{other:?}"),
    }
}

/// However large its number: it is refused, or left out, before anything is made for it.
#[test]
fn sewn_vertices_far_beyond_the_last_one_are_refused_or_left_out() {
    let (mesh, pairs) = beside(1e-4);
    let x = mesh.positions();
    let builder = || PotentialContacts::builder(&mesh).thickness(THICKNESS);
    for (far, onto) in [
        (vec![[0, u32::MAX]], vec![]),
        (vec![], vec![[0, 1, 4_000_000_000]]),
    ] {
        assert!(builder().sew(&far, &onto).build().is_err());
        let all = [&pairs[..], &far].concat();
        let mut contacts = builder().build().unwrap();
        contacts.sew(&all, &onto);
        assert_eq!(pushed(&mut contacts, x), (0.0, 0.0));
        let least = |pairs: &[[u32; 2]], onto: &[[u32; 3]]| {
            let probe = SeparationProbe::new(&mesh).sew(pairs, onto).measure(x);
            probe.unwrap().min_distance
        };
        assert_eq!(least(&all, &onto), least(&pairs, &[]));
    }
}
