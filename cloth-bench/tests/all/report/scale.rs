//! Ranges and ticks of axes.

use cloth_bench::report::scale::{Scale, range, ticks};

fn texts(scale: Scale, low: f64, high: f64) -> Vec<String> {
    ticks(scale, (low, high), 8)
        .labelled
        .into_iter()
        .map(|(_, text)| text)
        .collect()
}

#[test]
fn linear_ticks_are_round() {
    assert_eq!(
        texts(Scale::Linear, -0.04, 1.04),
        ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"].map(|t| t.replace("0.0", "0"))
    );
    assert_eq!(texts(Scale::Linear, 0.0, 2e-7)[1], "0.25e-7");
    assert_eq!(texts(Scale::Linear, -4.0, 4.0)[0], "−4");
}

#[test]
fn log_ticks_are_decades() {
    assert_eq!(
        texts(Scale::Log, -3.2, 0.3),
        ["1e-3", "1e-2", "1e-1", "1e0"]
    );
    assert_eq!(
        texts(Scale::Log, 0.0, 4.1),
        ["1", "10", "100", "1000", "10000"]
    );
    let wide = texts(Scale::Log, -16.0, 0.0);
    assert!(
        wide.len() >= 4 && wide.len() <= 9 && wide.contains(&"1e-9".to_owned()),
        "{wide:?}"
    );
}

#[test]
fn short_log_ranges_still_have_ticks() {
    assert_eq!(texts(Scale::Log, -0.1, 1.1), ["1", "2", "5", "10"]);
    assert!(texts(Scale::Log, 0.30, 0.31).len() >= 2);
}

#[test]
fn degenerate_ranges_have_width() {
    for scale in [Scale::Linear, Scale::Log] {
        for places in [
            vec![],
            vec![0.0],
            vec![3.0, 3.0],
            vec![-1e-300, 1e-300],
            vec![1.0, 1.0 + 1e-15],
        ] {
            let (low, high) = range(scale, places.iter().copied());
            assert!(low < high && (high - low).is_finite(), "{places:?}");
            assert!(places.iter().all(|p| *p >= low && *p <= high));
            assert!(
                ticks(scale, (low, high), 8).labelled.len() >= 2,
                "{scale:?} {places:?}"
            );
        }
    }
}

#[test]
fn every_range_gives_ticks_inside_it_in_moderate_number() {
    for i in 0..400 {
        let low = -12.0 + 0.057 * f64::from(i);
        for span in [0.01, 0.5, 1.0, 2.2, 7.0, 40.0, 300.0] {
            for scale in [Scale::Linear, Scale::Log] {
                let ticks = ticks(scale, (low, low + span), 8).labelled;
                assert!(
                    (2..=10).contains(&ticks.len()),
                    "{scale:?} {low} {span} {ticks:?}"
                );
                assert!(
                    ticks
                        .iter()
                        .all(|(p, _)| *p >= low - 1e-9 && *p <= low + span + 1e-9)
                );
            }
        }
    }
}
