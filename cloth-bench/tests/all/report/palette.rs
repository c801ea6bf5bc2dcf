//! Colours and markers of a plot.

use cloth_bench::method::{METHODS, Method};
use cloth_bench::report::palette::{
    Look, Marker, Rgb, exact_look, from_linear, gap, looks, to_linear,
};

/// Machado, Oliveira and Fernandes 2009 (doi:10.1109/TVCG.2009.113), severity 1: what is left
/// of linear RGB without the green (first) or red (second) cones.
const DEFICIENCIES: [[[f64; 3]; 3]; 2] = [
    [
        [0.367, 0.861, -0.228],
        [0.280, 0.673, 0.047],
        [-0.012, 0.043, 0.969],
    ],
    [
        [0.152, 1.053, -0.205],
        [0.115, 0.786, 0.099],
        [-0.004, -0.048, 1.052],
    ],
];

/// CIE L*a*b* (D65) of linear RGB.
fn lab(rgb: [f64; 3]) -> [f64; 3] {
    let row = |r: [f64; 3]| r.iter().zip(rgb).map(|(a, b)| a * b.max(0.0)).sum::<f64>();
    let x = row([0.4124, 0.3576, 0.1805]) / 0.9505;
    let y = row([0.2126, 0.7152, 0.0722]);
    let z = row([0.0193, 0.1192, 0.9505]) / 1.089;
    let f = |t: f64| {
        if t > 0.008856 {
            t.cbrt()
        } else {
            7.787 * t + 16.0 / 116.0
        }
    };
    [
        116.0 * f(y) - 16.0,
        500.0 * (f(x) - f(y)),
        200.0 * (f(y) - f(z)),
    ]
}

fn distance(a: Rgb, b: Rgb, seen: impl Fn([f64; 3]) -> [f64; 3]) -> f64 {
    let [a, b] = [a, b].map(|colour| lab(seen(colour.map(to_linear))));
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).powi(2))
        .sum::<f64>()
        .sqrt()
}

fn assert_distinct(colours: &[Rgb]) {
    for (i, &a) in colours.iter().enumerate() {
        for &b in &colours[..i] {
            let normal = distance(a, b, |c| c);
            assert!(normal > 20.0, "{a:?} and {b:?}: {normal}");
            for matrix in DEFICIENCIES {
                let seen = distance(a, b, |c| {
                    matrix.map(|row| row.iter().zip(c).map(|(m, c)| m * c).sum())
                });
                assert!(
                    seen > 8.0,
                    "{a:02x?} and {b:02x?} for the colour blind: {seen}"
                );
            }
        }
    }
}

/// The look of the reference that several plots have, beside the methods.
const NEWTON: (Rgb, Marker) = ([0x33, 0x33, 0x33], Marker::Circle);

/// The methods and the reference with their colours and markers.
fn known() -> Vec<(&'static str, (Rgb, Marker))> {
    let look = |method: &Method| (method.name, method.look());
    METHODS
        .iter()
        .map(look)
        .chain([("newton", NEWTON)])
        .collect()
}

/// The colours of labels that do not begin with the name of a method.
fn others() -> Vec<Rgb> {
    let labels = ["a", "b", "c", "d", "e", "f", "g", "h"];
    looks(&labels).iter().map(|look| look.colour).collect()
}

#[test]
fn colours_stay_apart_for_the_colour_blind() {
    assert_distinct(&known().iter().map(|known| known.1.0).collect::<Vec<_>>());
    assert_distinct(&others());
}

#[test]
fn colours_stand_out_from_white() {
    for colour in known().iter().map(|known| known.1.0).chain(others()) {
        let [r, g, b] = colour.map(to_linear);
        let contrast = 1.05 / (0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05);
        assert!(contrast > 2.3, "{colour:02x?}: {contrast}");
    }
}

#[test]
fn a_method_looks_the_same_in_every_plot() {
    let a = looks(&["pd", "exact", "xpbd, 4 substeps"]);
    let b = looks(&["xpbd", "something", "pd (dense)"]);
    assert_eq!((a[0], a[2]), (b[2], b[0]));
    for (name, (colour, marker)) in known() {
        let hollow = false;
        let look = Look {
            colour,
            marker,
            hollow,
        };
        assert_eq!(looks(&[name]), [look]);
    }
    let other = looks(&["something"]);
    assert_eq!(looks(&["pdx"]), other);
    assert_eq!(looks(&["pd-like"]), other);
}

#[test]
fn series_of_one_method_differ() {
    let looks = looks(&["xpbd, 1", "xpbd, 2", "xpbd, 3", "xpbd, 4", "xpbd, 5"]);
    for (i, a) in looks.iter().enumerate() {
        for b in &looks[..i] {
            assert_ne!(a.colour, b.colour);
            assert_ne!((a.marker, a.hollow), (b.marker, b.hollow));
        }
    }
}

#[test]
fn other_labels_keep_away_from_the_methods_present() {
    let methods = ["xpbd", "pbd", "pd"];
    let looks = looks(&[&methods[..], &["first", "second"]].concat());
    for other in &looks[3..] {
        assert!(
            looks[..3]
                .iter()
                .all(|look| gap(look.colour, other.colour) > 70.0)
        );
    }
}

#[test]
fn a_closed_form_looks_like_what_it_describes() {
    let labels = ["xpbd, 1", "xpbd, 16", "sag"];
    let measured: Vec<_> = labels.into_iter().zip(looks(&labels)).collect();
    let exact = |label| exact_look(label, &measured);
    assert_eq!(exact("xpbd, 16, exact"), Some(measured[1].1));
    assert_eq!(exact("sag, closed form"), Some(measured[2].1));
    assert_eq!(exact("pd, exact"), Some(looks(&["pd"])[0]));
    assert_eq!(exact("order 2"), None);
}

#[test]
fn linear_light_reads_back() {
    assert!((0..=255).all(|channel| from_linear(to_linear(channel)) == channel));
}
