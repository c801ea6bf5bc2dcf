//! A law put to the test, for the tests of several files.

use cloth_bench::laws::{Evaluation, Law};
use cloth_bench::settings::Settings;

/// What the code does, after checking that the law holds.
pub(crate) fn holds(name: &str, pairs: &[&str]) -> Evaluation {
    let law = Law::find(name).unwrap();
    let evaluation = law.evaluate(&Settings::parse(pairs).unwrap()).unwrap();
    assert!(
        law.holds(&evaluation),
        "law {name} {pairs:?}: expected {}, measured {}, error {:e}",
        evaluation.expected,
        evaluation.measured,
        evaluation.error()
    );
    evaluation
}

/// A named number of the evaluation.
pub(crate) fn detail(evaluation: &Evaluation, name: &str) -> f64 {
    let found = evaluation.details.iter().find(|(key, _)| *key == name);
    found.expect(name).1
}
