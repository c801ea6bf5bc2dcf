//! Steps of every size in contact, and starts that pass through themselves.

use cloth_bench::studies::contact::survival::{Fate, follow, recover, scene_of};

#[test]
fn implicit_euler_comes_through_contact_and_the_midpoint_rule_does_not() {
    let scene = scene_of("drape-sphere", 7, "").unwrap();
    for dt in [1.0 / 60.0, 1.0 / 15.0] {
        let (fate, shares) = follow(&scene, "implicit-euler", dt, 1).unwrap();
        assert_eq!(fate, Fate::Ok);
        assert!(
            shares.iter().all(|share| share.0 < 1.0 + 1e-6),
            "{shares:?}"
        );
    }
    let (fate, _) = follow(&scene, "implicit-midpoint", 1.0 / 30.0, 1).unwrap();
    assert!(matches!(fate, Fate::Grew(_)), "{fate:?}");
}

#[test]
fn sheets_that_pass_through_each_other_are_pulled_apart_for_good() {
    for method in ["implicit-euler", "xpbd"] {
        for scene in ["fold", "stack"] {
            let found = recover(scene, method, (9, 40), 1).unwrap();
            assert!(found.pairs_at_start >= 10, "{found:?}");
            assert!(
                found.steps_until_free.is_some_and(|steps| steps < 15),
                "{found:?}"
            );
            assert_eq!(
                [found.pairs_at_end, found.crossings_afterwards as usize],
                [0; 2]
            );
        }
    }
}

#[test]
fn implicit_euler_comes_through_contact_with_springs_of_every_stiffness() {
    for stiffness in ["1", "1e4", "1e6"] {
        let scene = scene_of("drape-sphere", 5, &format!("stiffness={stiffness}")).unwrap();
        for dt in [1.0 / 60.0, 1.0 / 15.0] {
            let (fate, _) = follow(&scene, "implicit-euler", dt, 1).unwrap();
            assert_eq!(fate, Fate::Ok, "{stiffness} N/m, {dt} s");
        }
    }
}
