//! The circumstances of a run.

use cloth_bench::report::facts::{collect, date, model};

#[test]
fn dates_agree_with_the_calendar() {
    assert_eq!(date(0), "1970-01-01 00:00");
    assert_eq!(date(951_782_400), "2000-02-29 00:00");
    assert_eq!(date(1_772_283_900), "2026-02-28 13:05");
    assert_eq!(date(4_107_542_399), "2100-02-28 23:59");
    assert_eq!(date(4_107_542_400), "2100-03-01 00:00");
}

#[test]
fn the_model_is_read_from_cpuinfo() {
    let text = "processor\t: 0\nmodel\t\t: 1\nmodel name\t: AMD EPYC 7B13\nflags\t: a\n";
    assert_eq!(model(text).as_deref(), Some("AMD EPYC 7B13"));
    assert_eq!(model("processor : 0\n"), None);
}

#[test]
fn every_fact_has_a_value() {
    let facts = collect();
    assert!(
        facts
            .iter()
            .all(|(name, value)| !name.is_empty() && !value.is_empty())
    );
    for name in ["commit", "processor", "threads", "compiler"] {
        assert!(facts.iter().any(|(known, _)| known == name));
    }
}
