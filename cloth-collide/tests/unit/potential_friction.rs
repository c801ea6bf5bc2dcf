use super::*;
use crate::ccd::QueryKind;

/// A vertex before a triangle and two edges can have the same vertices in the same order.
#[test]
fn pairs_of_the_same_vertices_have_stretches_of_their_own() {
    let sticking = |kind: QueryKind, origin: Real| {
        let vertices = [0, 1, 2, 3];
        FrictionContact {
            key: Key::Pair(Pair { kind, vertices }),
            vertices,
            weights: [0.0; 4],
            normal: Vec3::z(),
            most: 1.0,
            origin: Vec3::x() * origin,
        }
    };
    let both = [
        sticking(QueryKind::EdgeEdge, 1.0),
        sticking(QueryKind::VertexTriangle, 2.0),
    ];
    let mut tangential = TangentialDisplacements::default();
    tangential.replace(&both, 5.0, &[Vec3::zeros(); 4]);
    assert_eq!(tangential.of(both[0].key), -Vec3::x());
    assert_eq!(tangential.of(both[1].key), -Vec3::x() * 2.0);
    assert_eq!(tangential.of(Key::Obstacle([0, 1])), Vec3::zeros());
}
