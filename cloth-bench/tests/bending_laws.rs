//! Strips that bend and buckle under their own weight, against the theory of beams.

#[path = "support/law.rs"]
mod support;

use support::{detail, holds};

const MODELS: [&str; 5] = ["bergou", "curved", "grinspun", "bridson", "cubic"];

fn elastica(pairs: &[String]) -> cloth_bench::laws::Verdict {
    let pairs: Vec<&str> = pairs.iter().map(String::as_str).collect();
    holds("elastica", &pairs)
}

#[test]
fn a_heavy_strip_sags_as_the_elastica_in_every_model() {
    for gamma in ["0.1", "1", "10", "100", "1000"] {
        for model in MODELS {
            let verdict = elastica(&[format!("gamma={gamma}"), format!("model={model}")]);
            // At rest: what is left of the forces is rounding, and another step moves nothing.
            let left = detail(&verdict, "force_left");
            assert!(left < 4.0 * detail(&verdict, "force_left_by_rounding").max(1e-9));
            assert!(detail(&verdict, "last_move") < 1e-8, "{gamma} {model}");
            // Span and drop hold one by one, too.
            for name in ["span", "drop"] {
                let expected = detail(&verdict, &format!("{name}_expected"));
                let error = (detail(&verdict, name) / expected - 1.0).abs();
                assert!(error < 5e-3, "{name} at {gamma}, {model}: {error:e}");
            }
        }
    }
}

#[test]
fn the_elastica_is_reached_with_second_order() {
    // Triangles so long that Poisson's ratio and the rim leave 0.014 %.
    let error = |model: &str, resolution: u32| {
        let verdict = elastica(&[
            "gamma=100".into(),
            "elongation=8".into(),
            "across=3".into(),
            format!("model={model}"),
            format!("resolution={resolution}"),
        ]);
        verdict.measured / verdict.expected - 1.0
    };
    for model in ["bergou", "dihedral"] {
        let [coarse, middle, fine] = [32, 64, 128].map(|rows| error(model, rows));
        let order = ((coarse - middle) / (middle - fine)).log2();
        assert!((order - 2.0).abs() < 0.15, "{model}: {order}");
        let limit = fine + (fine - middle) / 3.0;
        assert!(limit.abs() < 3e-4, "{model}: {limit:e}");
    }
}

/// A strip of equilateral triangles has ν = −1/3: narrow, it is softer by 1 − ν² = 8/9 than the sheet, and sags by 1/8 more.
#[test]
fn a_narrow_strip_of_equilateral_triangles_is_softer_by_its_poisson_ratio() {
    let more = |resolution: u32, across: u32| {
        let pairs = [
            "gamma=0.1".to_owned(),
            "elongation=0.8660254037844386".into(),
            format!("resolution={resolution}"),
            format!("across={across}"),
        ];
        let settings = cloth_bench::settings::Settings::parse(&pairs).unwrap();
        let law = cloth_bench::laws::Law::find("elastica").unwrap();
        let verdict = law.evaluate(&settings).unwrap();
        assert!((detail(&verdict, "free_rigidity") - 8.0 / 9.0).abs() < 1e-15);
        verdict.measured / verdict.expected - 1.0
    };
    // The rim is softer, in proportion to the size of a cell; the clamp keeps the strip from curving across, in proportion to its width.
    let wide = 2.0 * more(128, 17) - more(64, 9);
    let narrow = 2.0 * more(192, 13) - more(96, 7);
    let limit = 2.0 * narrow - wide;
    assert!((limit - 0.125).abs() < 0.004, "{wide} {narrow} {limit}");
}

#[test]
fn a_strip_held_edge_on_falls_over_where_the_beam_does() {
    for model in MODELS {
        let verdict = holds("lateral-buckling", &[&format!("model={model}")]);
        let isotropic = 12.8538 * (2.0 / (1.0 - 1.0 / 3.0_f64)).sqrt();
        assert!((verdict.expected / isotropic - 1.0).abs() < 1e-5);
    }
}

#[test]
fn the_onset_of_buckling_is_approached_by_finer_and_narrower_strips() {
    let verdict = holds("lateral-buckling", &["across=17", "slenderness=32"]);
    assert!(verdict.error() < 0.0015, "{}", verdict.error());
    // One strip alone is not the beam: the docs of the law say by how much.
    let strip = detail(&verdict, "finest_strip") / verdict.expected - 1.0;
    assert!((strip + 0.0044).abs() < 3e-4, "{strip}");
}
