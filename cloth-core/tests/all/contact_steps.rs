//! Steps that a source of contacts cannot work with.

use cloth_core::contact::{ContactError, ContactStep};
use cloth_core::math::{Real, Vec3};

#[test]
fn what_a_source_cannot_work_with_is_named() {
    let good = [Vec3::zeros(), Vec3::x()];
    let broken = [Vec3::zeros(), Vec3::new(0.0, Real::NAN, 0.0)];
    let step = |from, inverse_mass, dt| ContactStep {
        from,
        inverse_mass,
        dt,
    };
    let found = |step: ContactStep<'_>, x, v| step.check(2, x, v);
    assert_eq!(found(step(&good, &[0.0, 3.0], 0.1), &good, &good), Ok(()));

    let fine = step(&good, &[1.0, 1.0], 0.1);
    let count = Err(ContactError::VertexCount {
        expected: 2,
        found: 1,
    });
    assert_eq!(found(fine, &good[..1], &good), count);
    assert_eq!(found(step(&good, &[1.0], 0.1), &good, &good), count);
    let not_finite = Err(ContactError::NonFinite { vertex: 1 });
    assert_eq!(found(fine, &broken, &good), not_finite);
    assert_eq!(found(fine, &good, &broken), not_finite);
    for dt in [0.0, -1.0, Real::INFINITY] {
        let error = Err(ContactError::InvalidStep { dt });
        assert_eq!(found(step(&good, &[1.0, 1.0], dt), &good, &good), error);
    }
    let nan = found(step(&good, &[1.0, 1.0], Real::NAN), &good, &good);
    assert!(matches!(nan, Err(ContactError::InvalidStep { .. })));
    let negative = found(step(&good, &[1.0, -2.0], 0.1), &good, &good);
    let expected = ContactError::InvalidMass {
        vertex: 1,
        inverse_mass: -2.0,
    };
    assert_eq!(negative, Err(expected));
    let infinite = found(step(&good, &[Real::INFINITY, 1.0], 0.1), &good, &good);
    assert!(infinite.unwrap_err().to_string().contains("vertex 0"));
}
