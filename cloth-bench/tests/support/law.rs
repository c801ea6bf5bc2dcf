//! A law put to the test, for the tests of several files.

use cloth_bench::laws::{Law, Verdict};
use cloth_bench::settings::Settings;

/// What the code does, after checking that the law holds.
pub(crate) fn holds(name: &str, pairs: &[&str]) -> Verdict {
    let law = Law::find(name).unwrap();
    let verdict = law.evaluate(&Settings::parse(pairs).unwrap()).unwrap();
    assert!(
        law.holds(&verdict),
        "law {name} {pairs:?}: expected {}, measured {}, error {:e}",
        verdict.expected,
        verdict.measured,
        verdict.error()
    );
    verdict
}

/// A named number of the verdict.
pub(crate) fn detail(verdict: &Verdict, name: &str) -> f64 {
    let found = verdict.details.iter().find(|(key, _)| *key == name);
    found.expect(name).1
}
