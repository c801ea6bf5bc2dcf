//! Garments that start tangled come apart, and no vertex goes farther than it has to.

use crate::tangled_garments as garments;

use cloth_collide::SeparationProbe;
use cloth_collide::potential::PotentialContacts;
use cloth_collide::untangle::{UntangleOutcome, Untangler, project_back};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use robust::{Coord, Coord3D, orient2d, orient3d};
use std::collections::BTreeSet;

/// Distance (m) at which layers end.
const THICKNESS: Real = 1e-3;

/// The side of the plane through three points on which a fourth is, exactly.
fn side(plane: [Vec3; 3], point: Vec3) -> i8 {
    let [a, b, c, d] = [plane[0], plane[1], plane[2], point].map(|p| Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    });
    let volume = orient3d(a, b, c, d);
    i8::from(volume > 0.0) - i8::from(volume < 0.0)
}

/// Whether an edge in the plane of a triangle keeps clear of it, seen along one of the axes: a side of the one or the
/// line of the other parts them.
fn apart_in_plane([p, q]: [Vec3; 2], t: [Vec3; 3], axis: usize) -> bool {
    let flat = |v: Vec3| Coord {
        x: v[(axis + 1) % 3],
        y: v[(axis + 2) % 3],
    };
    let turn = |a, b, c| {
        let area = orient2d(flat(a), flat(b), flat(c));
        i8::from(area > 0.0) - i8::from(area < 0.0)
    };
    let by_side = (0..3).any(|k| {
        let [a, b, c] = [0, 1, 2].map(|i| t[(k + i) % 3]);
        let inner = turn(a, b, c);
        inner != 0 && turn(a, b, p) == -inner && turn(a, b, q) == -inner
    });
    let corners = t.map(|c| turn(p, q, c));
    by_side || corners == [1; 3] || corners == [-1; 3]
}

/// How many pairs of an edge and a triangle without a common vertex meet: by looking at all of them, with exact signs
/// of areas and volumes and nothing that the library decides by.
fn pierced(mesh: &TriMesh, x: &[Vec3]) -> usize {
    let sides = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let edges: BTreeSet<[u32; 2]> = mesh
        .triangles()
        .iter()
        .flat_map(sides)
        .map(sorted)
        .collect();
    let boxed = |[p, q]: [Vec3; 2]| (p.inf(&q), p.sup(&q));
    let edges = edges.into_iter().map(|e| (e, e.map(|v| x[v as usize])));
    let edges: Vec<_> = edges.map(|(e, ends)| (e, ends, boxed(ends))).collect();
    let mut count = 0;
    for &triangle in mesh.triangles() {
        let t = triangle.map(|v| x[v as usize]);
        let (low, high) = (t[0].inf(&t[1]).inf(&t[2]), t[0].sup(&t[1]).sup(&t[2]));
        for (edge, [p, q], (first, last)) in &edges {
            let is_clear = (0..3).any(|k| last[k] < low[k] || high[k] < first[k]);
            if is_clear || edge.iter().any(|v| triangle.contains(v)) {
                continue;
            }
            let (p, q) = (*p, *q);
            let ends = [side(t, p), side(t, q)];
            let around = [0, 1, 2].map(|k| side([p, q, t[k]], t[(k + 1) % 3]));
            let meet = match ends {
                [0, 0] => !(0..3).any(|axis| apart_in_plane([p, q], t, axis)),
                _ => ends[0] * ends[1] <= 0 && !(around.contains(&1) && around.contains(&-1)),
            };
            count += usize::from(meet);
        }
    }
    count
}

/// What a garment has become: the farthest that a vertex was moved, and the smallest distance (m).
struct Undone {
    farthest: Real,
    distance: Real,
}

fn all_apart(mesh: &TriMesh) -> PotentialContacts {
    let contacts = PotentialContacts::builder(mesh).thickness(THICKNESS);
    contacts.full_thickness().build().unwrap()
}

fn undone(mesh: &TriMesh) -> Undone {
    assert!(pierced(mesh, mesh.positions()) > 20);
    let mut x = mesh.positions().to_vec();
    let w = vec![1.0; x.len()];
    let report = Untangler::new(mesh)
        .relax(&mut x, &w, 1000, |_| ())
        .unwrap();
    assert_eq!(report.outcome, UntangleOutcome::Untangled, "{report:?}");
    assert_eq!(pierced(mesh, &x), 0);
    project_back(&mut all_apart(mesh), &w, mesh.positions(), &mut x).unwrap();
    assert_eq!(pierced(mesh, &x), 0);
    let measured = SeparationProbe::new(mesh).measure(&x).unwrap();
    let displacements = x.iter().zip(mesh.positions()).map(|(a, b)| (a - b).norm());
    Undone {
        farthest: displacements.fold(0.0, Real::max),
        distance: measured.min_distance.unwrap(),
    }
}

/// Layers pushed through each other by a depth have to come apart by it and the thickness; each of the two goes half of
/// that, and somewhat more at the rim of what was pushed.
#[test]
fn layers_come_apart_by_the_depth_and_the_thickness() {
    for (depth, most) in [(0.01, 0.6), (0.03, 0.82)] {
        let layers = undone(&garments::layers(depth, 2e-3).unwrap());
        let needed = depth + THICKNESS;
        assert!(layers.farthest > 0.5 * needed && layers.farthest < most * needed);
        assert!(layers.distance > 0.95 * THICKNESS);
    }
}

#[test]
fn sleeve_comes_out_of_the_wall_that_it_was_turned_through() {
    let sleeve = undone(&garments::sleeve(0.03).unwrap());
    assert!(sleeve.farthest < 0.03 + THICKNESS && sleeve.distance > 0.95 * THICKNESS);
    // Through more than its own radius: nothing but pushing it back as a whole helps.
    let sleeve = undone(&garments::sleeve(0.1).unwrap());
    assert!(sleeve.farthest < 0.1 + THICKNESS);
}

/// It comes out at its ends by 0.14 sin θ + 0.055 cos θ − 0.06 (m).
#[test]
fn lining_turned_through_its_sleeve_goes_back_inside() {
    for angle in [0.1, 0.2_f64] {
        let depth = 0.14 * angle.sin() + 0.055 * angle.cos() - 0.06;
        let lining = undone(&garments::lining(angle).unwrap());
        assert!(lining.farthest < depth + THICKNESS);
        assert!(lining.distance > 0.95 * THICKNESS);
    }
}

/// It goes up to 6 mm through the dress, in many places; each of the two goes half of the way.
#[test]
fn lining_pushed_through_its_dress_in_spots_goes_back_inside() {
    let dress = undone(&garments::dress(90, 50).unwrap());
    let needed = 6e-3 + THICKNESS;
    assert!(dress.farthest < 0.6 * needed && dress.distance > 0.95 * THICKNESS);
}

/// It goes 6 mm through the sheet.
#[test]
fn pocket_is_pulled_out_of_what_it_is_sewn_onto() {
    for lift in [0.0, 1e-4, 1e-3] {
        let pocket = undone(&garments::pocket(lift).unwrap());
        assert!(pocket.farthest < 6e-3 + THICKNESS && pocket.distance > 0.95 * THICKNESS);
    }
}

/// Borders that lie on each other go half of the thickness each; three that meet in a line have to go farther.
#[test]
fn seams_whose_vertices_coincide_are_opened_by_the_thickness() {
    let rolled = undone(&garments::rolled().unwrap());
    assert!((rolled.farthest - 0.5 * THICKNESS).abs() < 0.01 * THICKNESS);
    assert!((rolled.distance - THICKNESS).abs() < 0.01 * THICKNESS);
    let seams = undone(&garments::seams().unwrap());
    assert!(seams.farthest < 1.05 * THICKNESS && seams.distance > 0.2 * THICKNESS);
}

#[test]
fn way_back_refuses_a_cloth_that_is_tangled() {
    let mesh = garments::rolled().unwrap();
    let w = vec![1.0; mesh.vertex_count()];
    let mut x = mesh.positions().to_vec();
    let error = project_back(&mut all_apart(&mesh), &w, mesh.positions(), &mut x).unwrap_err();
    assert!(error.to_string().contains("pass through each other"));
}
