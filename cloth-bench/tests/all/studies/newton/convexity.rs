//! What is made of Hessians that are not positive definite.

use cloth_bench::studies::newton::convexity::{POLICIES, minimum, newton, take, value};
use cloth_core::element::Convexity;
use cloth_massspring::HessianPolicy;

#[test]
fn the_exact_hessian_climbs_to_the_saddle_point_and_the_others_go_down() {
    let rest = minimum();
    // Stationary, and lower than its neighbours; the middle is stationary, and higher.
    for (y, is_minimum) in [(0.0, false), (rest, true), (-rest, true)] {
        let [below, at, above] = [-1e-5, 0.0, 1e-5].map(|d| value(y + d));
        assert!((above - below).abs() < 1e-9, "{y}");
        assert_eq!(above > at && below > at, is_minimum, "{y}");
    }
    let [exact, clamped, absolute, gauss_newton] = POLICIES.map(|(_, convexity)| newton(convexity));
    assert!(exact[1].abs() < 2e-5 && exact[4].abs() < 1e-40, "{exact:?}");
    // Once too far, where inertia alone resists; in shorter steps never.
    assert!(
        clamped[2] > rest && (clamped[9] - rest).abs() < 1e-9,
        "{clamped:?}"
    );
    assert!(absolute.iter().all(|&y| y < rest) && rest - absolute[20] < 1e-9);
    assert_eq!(clamped, gauss_newton);
}

#[test]
fn the_fewest_iterations_take_the_exact_hessian_where_it_serves() {
    let sharp = |sheet, hessian| {
        let (trace, remark) = take(sheet, 16, hessian).unwrap();
        let there = trace.iter().find(|sample| sample.error.gradient <= 1e-8);
        (there.map(|sample| sample.iteration), remark)
    };
    let of = |sheet, convexity| sharp(sheet, HessianPolicy::Always(convexity));
    let hanging = |convexity| of("hanging", convexity).0.unwrap();
    let blended = sharp("hanging", HessianPolicy::ExactFirst).0.unwrap();
    assert_eq!([blended, hanging(Convexity::Exact)], [7, 7]);
    assert!((11..=13).contains(&hanging(Convexity::Clamp)));
    assert!((18..=20).contains(&hanging(Convexity::Abs)));
    assert!(hanging(Convexity::GaussNewton) > 100);
    let (there, remark) = of("compressed", Convexity::Exact);
    assert_eq!(there, None);
    assert!(remark.contains("not positive definite"), "{remark}");
}
