//! Where methods stop working.

use cloth_bench::method::Method;
use cloth_bench::studies::Scope;
use cloth_bench::studies::stability::map::{self, MAPS};
use cloth_bench::studies::stability::{Fate, follow, limit};
use cloth_bench::studies::variants::Variant;

#[test]
fn one_run_of_ten_that_fails_fails_the_cell() {
    let fates = |seed: u64| match seed {
        3 => Fate::Strained(7),
        8 => Fate::Diverged(2),
        9 => panic!("nothing is run after a failure"),
        _ => Fate::Ok,
    };
    let of = |runs| map::worst(runs, |seed| Ok(fates(seed))).unwrap();
    assert_eq!(of(2), Fate::Ok);
    assert_eq!(of(7), Fate::Strained(7));
    assert_eq!(of(10), Fate::Diverged(2));
}

/// From passing to failing at once.
fn severity(fate: &Fate) -> u8 {
    match fate {
        Fate::Ok => 0,
        Fate::Strained(_) => 1,
        Fate::Grew(_) => 2,
        Fate::Diverged(_) => 3,
        Fate::Refused(_) => 4,
    }
}

/// Nothing is lost at 10 km, of the digits there are, and everything at 10⁹ km.
#[test]
fn far_from_the_origin_every_method_fares_as_at_it() {
    let map = MAPS.iter().find(|map| map.name == "offset").unwrap();
    for variant in (map.methods)() {
        let row = map.row(Scope::Quick, 1e4, &variant).unwrap();
        assert_eq!(severity(&row[0]), severity(&row[1]), "{}", variant.label);
    }
    let far = map::far_away(1e12, 1e2).unwrap();
    let xpbd = Variant::published(Method::find("xpbd").unwrap());
    let fate = follow(&far, &xpbd, 1.0 / 60.0, 60).unwrap();
    assert!(fate.is_lost(), "{fate:?}");
}

#[test]
fn one_iteration_a_step_does_not_always_serve() {
    let map = MAPS.iter().find(|map| map.name == "one-iteration").unwrap();
    let row = |variant: &Variant, stiffness| {
        let fates = map.row(Scope::Quick, stiffness, variant).unwrap();
        fates.iter().map(severity).collect::<Vec<_>>()
    };
    let cut_short = (map.methods)();
    for (label, stiffness, expected) in [
        ("implicit-euler", 1e6, [0, 1, 2]),
        ("xpbd-direct", 1e6, [0, 1, 2]),
        ("pbd", 1e6, [1, 1, 1]),
        ("pd", 1e2, [2, 2, 0]),
        ("pd, no coarse grid", 1e2, [0, 0, 0]),
        ("linear-implicit", 1e2, [0, 0, 2]),
    ] {
        let cut_short = cut_short.iter().find(|one| one.label == label).unwrap();
        assert_eq!(row(cut_short, stiffness), expected, "{label}");
    }
    let published = Variant::published(Method::find("implicit-euler").unwrap());
    assert_eq!(row(&published, 1e6), [0; 3]);
}

#[test]
fn symplectic_euler_explodes_beyond_its_limit() {
    let limit = limit(1e4).unwrap();
    let error = limit.found.0 / limit.expected.0 - 1.0;
    assert!(error.abs() < 1e-3, "{error:e}");
}
