//! The terms of the second derivative where a pair is pressed: as a primal–dual method has them.

use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactPotential, ContactRow, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

const H: Real = 2e-3;
const KAPPA: Real = 1e6;

/// A triangle a distance d (m) above the middle of a larger one, with a corner down.
fn above(d: Real) -> TriMesh {
    let corners = [[0.0, 0.0], [3.0, 0.0], [0.0, 3.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let tip = Vec3::new(1.0, 1.0, d);
    let upper = [
        tip,
        tip + Vec3::new(0.1, 0.0, 0.5),
        tip + Vec3::new(0.0, 0.1, 0.5),
    ];
    TriMesh::new([corners, upper].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap()
}

/// With k = A ψ″ and the force F of the pair, a solution in which it gets nearer by δ has the force λ = F + k δ there:
/// the next k is λ/d, the one after that is so with that k, and one that gets farther has A ψ″ again.
#[test]
fn a_pressed_pair_is_as_stiff_as_its_multiplier_over_its_distance() {
    let d = 0.1 * H;
    let mesh = above(d);
    let x = mesh.positions().to_vec();
    let mut contacts = PotentialContacts::builder(&mesh)
        .thickness(H)
        .stiffness(KAPPA)
        .friction(0.0)
        .build()
        .unwrap();
    let step = ContactStep {
        from: &x,
        inverse_mass: &[1.0; 6],
        dt: 0.01,
    };
    let mut start = x.clone();
    contacts.begin(&step, &mut start).unwrap();
    contacts.limit(&x, &x).unwrap();
    let stiffness = |contacts: &PotentialContacts| {
        let mut rows: Vec<ContactRow> = Vec::new();
        contacts.linearize(&x, &mut rows);
        assert_eq!(rows.len(), 1);
        rows[0].stiffness
    };
    // A third of the small triangle, and half of that between two sheets.
    let edges = [x[4] - x[3], x[5] - x[3]];
    let area = edges[0].cross(&edges[1]).norm() / 12.0;
    let force = area * KAPPA * H * H / (4.0 * d);
    let close = |found: Real, expected: Real| {
        let error = (found / expected - 1.0).abs();
        assert!(error < 1e-12, "{found} for {expected}");
    };
    close(stiffness(&contacts), force / d);
    let down = |nearer: Real| {
        let mut direction = vec![Vec3::zeros(); 6];
        direction[3].z = -nearer;
        direction
    };
    // Less than half of its distance is no pressure.
    contacts.update_multipliers(&x, &down(0.4 * d));
    close(stiffness(&contacts), force / d);
    contacts.update_multipliers(&x, &down(7.0 * d));
    let first = force + force / d * 7.0 * d;
    close(stiffness(&contacts), first / d);
    contacts.update_multipliers(&x, &down(0.25 * d));
    let second = force + first / d * 0.25 * d;
    close(stiffness(&contacts), second / d);
    contacts.update_multipliers(&x, &down(-0.25 * d));
    close(stiffness(&contacts), force / d);
    // The energy and the force know nothing of it.
    contacts.update_multipliers(&x, &down(7.0 * d));
    let mut gradient = vec![Vec3::zeros(); 6];
    contacts.add_gradient(&x, &mut gradient);
    close(-gradient[3].z, force);
}
