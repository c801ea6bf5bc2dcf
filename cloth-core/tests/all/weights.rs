//! How a vertex follows its parents: weights of a single vertex, which no level shows alone.

// Not to be had from outside, and what is built of it is rounded.
#[path = "../../src/method/multigrid/weights.rs"]
mod formula;

use cloth_core::math::{Real, Vec3};
use formula::linear_weights;

/// Among its parents a vertex gets what a linear function has there, whatever they weigh by distance; outside,
/// weights stop at the least.
#[test]
fn weights_are_exact_for_linear_functions_among_the_parents() {
    let place = [
        Vec3::new(0.2, 0.1, 0.3),
        Vec3::new(1.0, 0.0, 0.5),
        Vec3::new(-0.7, 0.9, 0.0),
        Vec3::new(-0.4, -1.1, 0.1),
        Vec3::new(0.1, 0.2, 0.9),
    ];
    let linear = |x: &Vec3| 3.0 + Vec3::new(1.0, -2.0, 0.5).dot(x);
    for power in [1, 2] {
        let nearness = |p: u32| (place[p as usize] - place[0]).norm().powi(-power);
        let weigh = |of: &[u32], least| {
            let mut parents: Vec<_> = of.iter().map(|&p| (p, nearness(p))).collect();
            let aside = linear_weights(0, &mut parents, &place, least);
            (parents, aside)
        };
        // Three in whose plane the vertex is not: nothing can be exact across it.
        let (_, aside) = weigh(&[1, 2, 3], -0.5);
        assert!(aside > 0.02, "{aside}");
        let (parents, aside) = weigh(&[1, 2, 3, 4], -0.5);
        let value: Real = parents
            .iter()
            .map(|&(p, w)| w * linear(&place[p as usize]))
            .sum();
        let error = value - linear(&place[0]);
        assert!(aside < 1e-14 && error.abs() < 1e-14, "{aside:e} {error:e}");
        // Two on one side: the farther one would have to be negative.
        for least in [0.0, -0.5] {
            let (parents, aside) = weigh(&[1, 4], least);
            let sum: Real = parents.iter().map(|entry| entry.1).sum();
            assert!((sum - 1.0).abs() < 1e-14 && aside > 0.1, "{aside}");
            assert!(parents.iter().all(|entry| entry.1 >= least));
        }
    }
    assert_eq!(linear_weights(0, &mut [], &place, 0.0), Real::INFINITY);
}
