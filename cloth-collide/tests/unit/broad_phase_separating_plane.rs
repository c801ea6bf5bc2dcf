use super::*;

fn at(x: Real, y: Real) -> Bounds {
    let corner = Vec3::new(x, y, 0.0);
    Bounds {
        lower: corner,
        upper: corner + Vec3::new(1.0, 1.0, 1.0),
    }
}

/// Squares at a corner, 0.1 from touching along the diagonal: neither axis has them apart, the diagonal has.
#[test]
fn plane_is_found_where_no_axis_is() {
    let group = [&at(0.0, 0.0), &at(-1.0, 1.0)];
    let other = at(0.6, 1.6);
    let separating_plane = SeparatingPlane::among(&[*group[0], *group[1], other]);
    let diagonal = Vec3::new(1.0, 1.0, 0.0);
    assert!(!separating_plane.is_plane(&Vec3::x(), &group, &[&other]));
    assert!(!separating_plane.is_plane(&Vec3::y(), &group, &[&other]));
    assert!(separating_plane.is_plane(&diagonal, &group, &[&other]));
    // From either side, and of any length.
    assert!(separating_plane.is_plane(&(diagonal * -1e-3), &[&other], &group));
    assert!(!separating_plane.is_plane(&diagonal, &group, &[&at(0.4, 1.5)]));
}

/// What touches is not apart, and nothing is where numbers fail.
#[test]
fn doubt_parts_nothing() {
    let (a, b) = (at(0.0, 0.0), at(1.0, 0.0));
    let separating_plane = SeparatingPlane::among(&[a, b]);
    assert!(!separating_plane.is_plane(&Vec3::x(), &[&a], &[&b]));
    assert!(!separating_plane.is_plane(&Vec3::zeros(), &[&a], &[&at(9.0, 0.0)]));
    for bad in [Real::NAN, Real::INFINITY, Real::MAX] {
        let direction = Vec3::new(bad, bad, bad);
        assert!(
            !separating_plane.is_plane(&direction, &[&a], &[&at(9.0, 0.0)]),
            "{bad}"
        );
    }
    let far = at(1e308, 1e308);
    let separating_plane = SeparatingPlane::among(&[a, far]);
    assert!(!separating_plane.is_plane(&Vec3::new(10.0, 0.0, 0.0), &[&a], &[&far]));
}
