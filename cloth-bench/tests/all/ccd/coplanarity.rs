//! What the cubic of the textbooks misses.

use cloth_bench::ccd::coplanarity::first_contact;
use cloth_bench::ccd::exact_queries::{ExactQueries, Family, KnownQuery, Truth};
use cloth_collide::ContinuousTest;
use cloth_collide::QueryKind;

fn each(seed: u64, count: usize, mut check: impl FnMut(&KnownQuery)) {
    for kind in [QueryKind::VertexTriangle, QueryKind::EdgeEdge] {
        let queries = ExactQueries::new(kind, seed).take(count);
        queries.for_each(|known| check(&known));
    }
}

/// The reason for another method: contacts in one plane are missed.
#[test]
fn coplanarity_misses_contacts_and_the_tolerance_does_not_help() {
    const COUNT: usize = 40_000;
    for tolerance in [1e-12, 1e-6] {
        let mut missed = [0, 0];
        each(7, COUNT, |known| {
            if matches!(known.truth, Truth::Contact { .. }) {
                let degenerate = matches!(known.family, Family::Planar | Family::Collapsed);
                let found = first_contact(&known.query, tolerance);
                missed[usize::from(degenerate)] += usize::from(found.is_none());
            }
        });
        assert!(missed[1] > COUNT / 20, "{tolerance:e}: {missed:?}");
    }
}

/// For motions without anything special both methods find the same root, by different means.
#[test]
fn coplanarity_agrees_where_nothing_is_degenerate() {
    let (mut compared, mut agreed) = (0, 0);
    each(11, 8_000, |known| {
        if known.family != Family::General {
            return;
        }
        let one = known.query.first_contact(&ContinuousTest::default());
        let two = first_contact(&known.query, 1e-9);
        if let (Ok(Some(one)), Some(two)) = (one, two) {
            compared += 1;
            let late = two - one.time;
            agreed += usize::from(late.abs() < 1e-9);
            assert!(late > -1e-9, "{late:e} {known:?}");
        }
    });
    // The rest are contacts for longer, with coincident or coplanar vertices on the path.
    assert!(
        compared > 3_000 && agreed > compared * 99 / 100,
        "{agreed} of {compared}"
    );
}
