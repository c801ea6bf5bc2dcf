//! Stitches: their rest length in time, their derivatives, and what they leave alone.

use crate::element_checks::{convex_choices_are_convex, derivatives_agree, is_invariant, shape};
use cloth_core::element::{Constraint, Convexity, Element, Energy, Projective, RowForm};
use cloth_core::energy::{Spring, Stitch};
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::family::Energies;

const K: Real = 40.0;

const FRACTION: Real = 0.3;

fn onto_edge_at(time: Real) -> Stitch<3> {
    let mut stitch = Stitch::onto_edge([3, 8, 5], FRACTION, K).closing(0.6, [1.0, 3.0]);
    stitch.set_time(time);
    stitch
}

fn at(time: Real) -> Stitch {
    let mut stitch = Stitch::pair([3, 8], K).closing(0.6, [1.0, 3.0]);
    stitch.set_time(time);
    stitch
}

#[test]
fn the_rest_length_falls_at_a_constant_rate() {
    let lengths = [0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 7.0].map(|time| at(time).rest_length_at(time));
    let expected = [0.6, 0.6, 0.45, 0.3, 0.15, 0.0, 0.0];
    for (length, expected) in lengths.into_iter().zip(expected) {
        assert!((length - expected).abs() < 1e-15, "{length} {expected}");
    }
    let x = [Vec3::zeros(), Vec3::new(0.0, 0.5, 0.0)];
    assert!((at(2.0).value(&x) - 0.5 * K * 0.04).abs() < 1e-14);
    assert_eq!(at(3.0).value(&x), 0.5 * K * 0.25);
    assert_eq!(Stitch::pair([0, 1], K).value(&x), 0.5 * K * 0.25);
}

#[test]
fn derivatives_and_invariances_hold_open_and_closed() {
    for time in [0.0, 1.7, 3.0] {
        for seed in 0..8 {
            let (stitch, x) = (at(time), shape::<2>(seed));
            derivatives_agree(&stitch, &x, 1.0);
            convex_choices_are_convex(&stitch, &x);
            is_invariant(&stitch, &x);
            let (stitch, x) = (onto_edge_at(time), shape::<3>(seed));
            derivatives_agree(&stitch, &x, 1.0);
            convex_choices_are_convex(&stitch, &x);
            is_invariant(&stitch, &x);
        }
    }
}

/// Its force at the vertex is that of a stitch to the point of the edge, and what the edge gets has the same sum and
/// the same moment.
#[test]
fn a_stitch_onto_an_edge_pulls_at_a_point_of_it() {
    for time in [1.0, 2.2, 3.0] {
        for seed in 0..5 {
            let (stitch, x) = (onto_edge_at(time), shape::<3>(seed));
            let point = x[1] * (1.0 - FRACTION) + x[2] * FRACTION;
            let [alone, at_point] = at(time).gradient(&[x[0], point]);
            let [vertex, first, second] = stitch.gradient(&x);
            assert!((vertex - alone).norm() < 1e-12);
            assert!((first + second - at_point).norm() < 1e-12);
            let moment = x[1].cross(&first) + x[2].cross(&second);
            assert!((moment - point.cross(&at_point)).norm() < 1e-12);
        }
    }
}

#[test]
fn a_closed_stitch_is_smooth_where_its_ends_meet() {
    let x = [Vec3::new(0.3, -0.1, 2.0); 2];
    let stitch = at(3.0);
    assert_eq!(stitch.gradient(&x), [Vec3::zeros(); 2]);
    let k = Mat3::from_diagonal_element(K);
    for convexity in [
        Convexity::Exact,
        Convexity::Clamp,
        Convexity::Abs,
        Convexity::GaussNewton,
    ] {
        assert_eq!(stitch.hessian(&x, convexity), [[k, -k], [-k, k]]);
    }
    assert_eq!(stitch.project([Vec3::zeros()]), [Vec3::zeros()]);
}

#[test]
fn rows_and_projection_give_the_same_force_at_every_length() {
    for time in [1.0, 2.2, 3.0] {
        for seed in 0..5 {
            let (stitch, x) = (at(time), shape::<2>(seed));
            let [z] = [x[0] - x[1]];
            let [p] = stitch.project([z]);
            let [force, _] = stitch.gradient(&x);
            assert!((force - (z - p) * K).norm() < 1e-12);
            // The fast form of the rows, which sweeps use.
            if let RowForm::Vector(row) = stitch.row_form(&x) {
                assert!((force - row.value(&x) * row.stiffness).norm() < 1e-12);
            } else {
                assert!(stitch.rest_length_at(time) > 0.0);
            }
            let [hessian] = stitch.projected_hessian([z]);
            let clamped = stitch.hessian(&x, Convexity::Clamp)[0][0];
            assert!((hessian[0] * K - clamped).amax() < 1e-12);
        }
    }
}

#[test]
fn the_energy_of_a_cloth_tells_what_time_has_changed() {
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: 10.0,
    };
    let stitch = Stitch::pair([0, 1], K).closing(0.6, [1.0, 3.0]);
    let energies = Energies::new(2).with(vec![spring]).unwrap();
    let mut energies = energies.with(vec![stitch]).unwrap();
    let x = [Vec3::zeros(), Vec3::new(0.0, 0.5, 0.0)];
    energies.set_time(2.0);
    assert!((energies.timed_value(&x) - 0.5 * K * 0.04).abs() < 1e-14);
    assert!((energies.value(&x) - 0.5 * K * 0.04 - 0.5 * 10.0 * 0.25).abs() < 1e-14);
}

/// A step may end within rounding of the time at which a stitch closes, its length at a few 1e-17 m: over that length
/// its predicted force would be a stiffness of 1e16 times its own, and a step of any size would count as none.
#[test]
fn a_stitch_about_to_close_is_nearly_a_closed_one() {
    let x = [Vec3::new(0.0, 0.01, 0.0), Vec3::new(0.002, 0.0, 0.001)];
    let moved = |by: Real| [x[0], x[1] + (x[0] - x[1]) * by];
    let closed = at(3.0).mixed_hessian(&x, &x, &x)[0][0];
    assert_eq!(closed, Mat3::identity() * K);
    let closing = at(3.0 - 4.0 * Real::EPSILON);
    assert!(closing.rest_length_at(3.0 - 4.0 * Real::EPSILON) > 0.0);
    // Towards each other, past each other, and apart.
    for by in [0.0, 0.5, 1.5, 30.0, -30.0] {
        let hessian = closing.mixed_hessian(&x, &x, &moved(by))[0][0];
        let off = (hessian - closed).amax();
        assert!(off < 1e-12 * K, "{by}: {off:e}");
    }
    // However long it is, and wherever its ends are predicted to go: the stiffness across is at most twice its own.
    for by in [0.0, 0.5, 0.99, 1.5, 30.0, -30.0] {
        let half_closed = at(2.0).mixed_hessian(&x, &x, &moved(by))[0][0];
        let largest = half_closed.symmetric_eigenvalues().max();
        assert!(largest <= 2.0 * K, "{by}: {largest}");
    }
}
