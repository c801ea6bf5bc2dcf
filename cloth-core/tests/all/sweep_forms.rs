//! The forms of rows that sweeps visit are the rows.

use cloth_core::element::{Constraint, Row, RowArray, RowForm};
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

fn same<const N: usize>(one: &[Row<N>], other: &[Row<N>]) {
    assert_eq!(one.len(), other.len());
    for (one, other) in one.iter().zip(other) {
        let scale = one.value.abs().max(1.0);
        assert!(
            (one.value - other.value).abs() <= 4e-16 * scale,
            "{one:?} {other:?}"
        );
        assert_eq!(one.stiffness, other.stiffness);
        for i in 0..N {
            assert!((one.gradient[i] - other.gradient[i]).amax() <= 1e-15);
        }
    }
}

fn holds<const N: usize, C: Constraint<N>>(element: &C, x: &[Vec3; N]) {
    let rows = element.rows(x);
    let single = <C::Rows as RowArray<N>>::LEN == 1;
    let (vector, unit) = match element.row_form(x) {
        RowForm::Vector(row) => (Some(row), None),
        RowForm::Unit(row) => (None, Some(row)),
        RowForm::General => (None, None),
    };
    assert_eq!(
        vector.is_some(),
        !single && independent(element, x),
        "{element:?}"
    );
    if let Some(vector) = vector {
        same(rows.as_ref(), &vector.rows(x));
    }
    let is_unit = single
        && rows.as_ref()[0]
            .gradient
            .iter()
            .all(|g| (g.norm() - 1.0).abs() < 1e-14);
    assert_eq!(unit.is_some(), is_unit, "{element:?}");
    if let Some(unit) = unit {
        same(rows.as_ref(), &[unit.row()]);
        let lengths = unit.direction.map(|direction| direction.norm());
        assert!(
            lengths
                .iter()
                .all(|l| (l / unit.length - 1.0).abs() < 1e-15)
        );
    }
}

#[test]
fn every_form_has_the_same_rows() {
    let rest = [[0.0, 0.0], [1.0, 0.0], [0.4, 0.8], [0.5, -0.9]];
    let rest = rest.map(|[x, y]| Vec3::new(x, y, 0.0));
    let x: [Vec3; 4] = std::array::from_fn(|i| rest[i] + Vec3::new(0.1, 0.2, 0.3) * i as Real);
    let k = 2.0;
    let attachment = Attachment {
        vertex: 0,
        target: x[1],
        stiffness: k,
    };
    holds(&attachment, &[x[0]]);
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: k,
    };
    holds(&spring, &[x[0], x[1]]);
    // Where the square of a length is lost, and where there is no length.
    for length in [1e-200, 0.0] {
        holds(&spring, &[x[0] * 0.0, Vec3::new(length, 0.0, 0.0)]);
    }
    holds(&CurvatureHinge::new([0, 1, 2, 3], &rest, k), &x);
    holds(&CurvedHinge::new([0, 1, 2, 3], &rest, k), &x);
    let triangle = [rest[0], rest[1], rest[2]];
    let stvk = StvkTriangle::new([0, 1, 2], &triangle, k, 0.3);
    holds(&stvk, &[x[0], x[1], x[2]]);
}
