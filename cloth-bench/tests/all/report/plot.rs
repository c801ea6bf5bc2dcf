//! Plots as SVG.

use super::html::assert_well_formed;
use cloth_bench::report::canvas::WIDTH;
use cloth_bench::report::plot::{Axis, Plot, Series, Style};
use cloth_bench::report::scale::Scale;

/// All texts, one after the other: long ones stand in several lines.
fn said(svg: &str) -> String {
    let texts = svg
        .split("<text ")
        .skip(1)
        .filter_map(|text| text.split_once('>'));
    let texts: Vec<&str> = texts
        .filter_map(|(_, text)| text.split_once("</text>"))
        .map(|(text, _)| text.trim())
        .collect();
    texts.join(" ")
}

fn plot(scale: Scale, series: Vec<Series>) -> Plot {
    let axis = |label: &str| Axis {
        label: label.into(),
        scale,
        range: None,
    };
    Plot {
        title: "A & B <test>".into(),
        x: axis("x (s)"),
        y: axis("y \"(m)\""),
        series,
        note: String::new(),
    }
}

#[test]
fn svg_is_well_formed_and_scales() {
    let points: Vec<_> = (1..200)
        .map(|i| (f64::from(i), 1.0 / f64::from(i)))
        .collect();
    for scale in [Scale::Linear, Scale::Log] {
        for style in [
            Style::Line,
            Style::Points,
            Style::LinePoints,
            Style::ExactCurve,
        ] {
            let series = ["pd", "xpbd <4>", "exact & more"];
            let series = series.map(|label| Series::new(label, points.clone()).styled(style));
            let drawing = plot(scale, series.into()).draw();
            assert_well_formed(&drawing.svg);
            assert!(drawing.svg.starts_with("<svg ") && drawing.svg.contains("viewBox=\"0 0 "));
            assert!(drawing.svg.contains("A &amp; B &lt;test&gt;"));
            assert_eq!(drawing.dropped, 0);
        }
    }
}

#[test]
fn what_cannot_be_shown_is_counted_and_said() {
    let a = vec![
        (1.0, 1.0),
        (2.0, 0.0),
        (3.0, 0.0),
        (4.0, -1.0),
        (5.0, f64::NAN),
        (0.0, 1.0),
    ];
    let b = vec![(1.0, f64::INFINITY), (2.0, 1.0)];
    let drawing = plot(
        Scale::Log,
        vec![Series::new("pd", a.clone()), Series::new("pbd", b)],
    )
    .draw();
    assert_eq!(drawing.dropped, 6);
    assert!(said(&drawing.svg).contains(
        "3 points at zero (3 of pd), 1 point below zero (1 of pd), 2 points not finite (1 of pd; 1 of pbd)"
    ));
    let linear = plot(Scale::Linear, vec![Series::new("pd", a.clone())]).draw();
    assert_eq!(linear.dropped, 1);
    let mut cut = plot(Scale::Linear, vec![Series::new("pd", a)]);
    cut.x = cut.x.within(0.0, 2.5);
    assert_eq!(cut.draw().dropped, 3);
}

#[test]
fn curves_on_one_another_are_named() {
    let points = |shift: f64| {
        (1..20)
            .map(|i| (f64::from(i), f64::from(i) + shift))
            .collect()
    };
    let series = |shifts: [f64; 3]| {
        let labels = ["pbd", "xpbd", "pd"].into_iter().zip(shifts);
        labels
            .map(|(label, shift)| Series::new(label, points(shift)))
            .collect()
    };
    let svg = plot(Scale::Linear, series([0.0, 1e-3, 0.0])).draw().svg;
    assert!(svg.contains("On one another: pbd, xpbd under pd."));
    let svg = plot(Scale::Linear, series([0.0, 3.0, 6.0])).draw().svg;
    assert!(!svg.contains("On one another"));
}

#[test]
fn a_gap_breaks_the_line() {
    let points = vec![
        (1.0, 1.0),
        (2.0, 2.0),
        (3.0, f64::NAN),
        (4.0, 2.0),
        (5.0, 3.0),
    ];
    let broken = plot(
        Scale::Linear,
        vec![Series::new("pd", points.clone()).styled(Style::Line)],
    )
    .draw()
    .svg;
    let whole = points.into_iter().filter(|p| !p.1.is_nan()).collect();
    let whole = plot(
        Scale::Linear,
        vec![Series::new("pd", whole).styled(Style::Line)],
    )
    .draw()
    .svg;
    assert_eq!(
        broken.matches("<polyline").count(),
        whole.matches("<polyline").count() + 1
    );
}

#[test]
fn nothing_to_show_is_still_a_figure() {
    for scale in [Scale::Linear, Scale::Log] {
        for series in [
            vec![],
            vec![Series::default()],
            vec![Series::new("pd", vec![(0.0, f64::NAN)])],
        ] {
            let drawing = plot(scale, series).draw();
            assert_well_formed(&drawing.svg);
            assert!(drawing.svg.contains("no data"));
        }
    }
}

#[test]
fn degenerate_values_are_drawn() {
    for values in [
        vec![0.0],
        vec![5.0; 4],
        vec![1e-300, 1e300],
        vec![f64::MAX, 5e-324],
        vec![1.0, 1.0 + f64::EPSILON],
    ] {
        for scale in [Scale::Linear, Scale::Log] {
            let points = values.iter().map(|&v| (v, v)).collect();
            assert_well_formed(&plot(scale, vec![Series::new("pd", points)]).draw().svg);
        }
    }
}

#[test]
fn every_label_and_marker_stays_on_the_canvas() {
    let long = "xpbd with a very long label that goes on and on and has to be wrapped somewhere";
    let series =
        (0..30).map(|i| Series::new(&format!("{long} {i}"), vec![(1.0, 1.0), (10.0, 1e-9)]));
    let svg = plot(Scale::Log, series.collect()).draw().svg;
    let height: f64 = svg
        .split("height=\"")
        .nth(1)
        .unwrap()
        .split('"')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    for text in svg.split("<text ").skip(1) {
        let value = |name: &str| -> f64 {
            text.split(&format!(" {name}=\""))
                .nth(1)
                .or_else(|| text.strip_prefix(&format!("{name}=\"")))
                .unwrap()
                .split('"')
                .next()
                .unwrap()
                .parse()
                .unwrap()
        };
        assert!(
            value("y") / 4.0 < height,
            "{} of {height}",
            value("y") / 4.0
        );
        assert!(value("x") / 4.0 < f64::from(WIDTH));
    }
}
