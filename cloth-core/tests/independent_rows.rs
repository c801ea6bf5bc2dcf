//! What an element says of its rows holds for its gradients.

use cloth_core::element::{Constraint, RowArray};
use cloth_core::energy::{Attachment, CurvatureHinge, CurvedHinge, Spring, StvkTriangle};
use cloth_core::math::{Real, Vec3};

/// Whether no coordinate of a vertex stands in the gradients of two rows.
fn independent<const N: usize, C: Constraint<N>>(element: &C, x: &[Vec3; N]) -> bool {
    let rows = element.rows(x);
    let users = |i: usize, axis: usize| {
        let rows = rows.as_ref().iter();
        rows.filter(|row| row.gradient[i][axis] != 0.0).count()
    };
    (0..N).all(|i| (0..3).all(|axis| users(i, axis) <= 1))
}

fn says_so<const N: usize, C: Constraint<N>>(element: &C, x: &[Vec3; N]) {
    let single = <C::Rows as RowArray<N>>::LEN == 1;
    assert_eq!(
        C::ROWS_ARE_INDEPENDENT || single,
        independent(element, x),
        "{element:?}"
    );
}

#[test]
fn rows_that_are_called_independent_share_no_coordinate() {
    let rest = [[0.0, 0.0], [1.0, 0.0], [0.4, 0.8], [0.5, -0.9]];
    let rest = rest.map(|[x, y]| Vec3::new(x, y, 0.0));
    let x: [Vec3; 4] = std::array::from_fn(|i| rest[i] + Vec3::new(0.1, 0.2, 0.3) * i as Real);
    let k = 2.0;
    let attachment = Attachment {
        vertex: 0,
        target: x[1],
        stiffness: k,
    };
    says_so(&attachment, &[x[0]]);
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: k,
    };
    says_so(&spring, &[x[0], x[1]]);
    says_so(&CurvatureHinge::new([0, 1, 2, 3], &rest, k), &x);
    says_so(&CurvedHinge::new([0, 1, 2, 3], &rest, k), &x);
    let triangle = [rest[0], rest[1], rest[2]];
    let stvk = StvkTriangle::new([0, 1, 2], &triangle, k, 0.3);
    says_so(&stvk, &[x[0], x[1], x[2]]);
}
