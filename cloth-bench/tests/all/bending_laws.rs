//! Strips that bend and buckle under their own weight, against the theory of beams.

use crate::law::{detail, holds};
use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::State;
use cloth_core::step::{StepInput, Stepper};
use cloth_massspring::{ImplicitConfig, ImplicitEuler};

const MODELS: [&str; 5] = ["bergou", "curved", "grinspun", "bridson", "cubic"];

fn elastica(pairs: &[String]) -> cloth_bench::laws::Evaluation {
    let pairs: Vec<&str> = pairs.iter().map(String::as_str).collect();
    holds("elastica", &pairs)
}

#[test]
fn a_heavy_strip_sags_as_the_elastica_in_every_model() {
    for gamma in ["0.1", "10", "1000"] {
        for model in MODELS {
            let evaluation = elastica(&[format!("gamma={gamma}"), format!("model={model}")]);
            // At rest: what is left of the forces is rounding, and another step moves nothing.
            let left = detail(&evaluation, "force_left");
            assert!(left < 4.0 * detail(&evaluation, "force_left_by_rounding").max(1e-9));
            assert!(detail(&evaluation, "last_move") < 1e-8, "{gamma} {model}");
            // Span and drop hold one by one, too.
            for name in ["span", "drop"] {
                let expected = detail(&evaluation, &format!("{name}_expected"));
                let error = (detail(&evaluation, name) / expected - 1.0).abs();
                assert!(error < 5e-3, "{name} at {gamma}, {model}: {error:e}");
            }
        }
    }
}

#[test]
fn the_elastica_is_reached_with_second_order() {
    // Triangles so long that Poisson's ratio and the rim leave 0.014 %.
    let error = |model: &str, resolution: u32| {
        let evaluation = elastica(&[
            "gamma=100".into(),
            "elongation=8".into(),
            "across=3".into(),
            format!("model={model}"),
            format!("resolution={resolution}"),
        ]);
        evaluation.measured / evaluation.expected - 1.0
    };
    for model in ["bergou", "dihedral"] {
        let [coarse, middle, fine] = [32, 64, 128].map(|rows| error(model, rows));
        let order = ((coarse - middle) / (middle - fine)).log2();
        assert!((order - 2.0).abs() < 0.15, "{model}: {order}");
        let limit = fine + (fine - middle) / 3.0;
        assert!(limit.abs() < 3e-4, "{model}: {limit:e}");
    }
}

/// A strip of equilateral triangles has ν = −1/3: narrow, it is softer by 1 − ν² = 8/9 than the sheet, and sags by 1/8
/// more.
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
        let evaluation = law.evaluate(&settings).unwrap();
        assert!((detail(&evaluation, "free_rigidity") - 8.0 / 9.0).abs() < 1e-15);
        evaluation.measured / evaluation.expected - 1.0
    };
    // The rim is softer, in proportion to the size of a cell; the clamp keeps the strip from curving across, in
    // proportion to its width.
    let wide = 2.0 * more(128, 17) - more(64, 9);
    let narrow = 2.0 * more(192, 13) - more(96, 7);
    let limit = 2.0 * narrow - wide;
    assert!((limit - 0.125).abs() < 0.004, "{wide} {narrow} {limit}");
}

/// Deflection of the tip of a strip of an alternating grid of square cells, of length 1 m and D = 1 N·m, over that of
/// the beam of rigidity D, `ρ g L⁴/(8D)`.
fn grid_strip(cells: usize, across: usize) -> f64 {
    let h = 1.0 / (cells as f64 + 0.5);
    let mesh = grid(
        cells + 2,
        across + 1,
        h * (cells + 1) as f64,
        h * across as f64,
        Diagonals::Alternating,
    )
    .unwrap();
    let cloth = Cloth {
        areal_density: 1.0,
        membrane: Membrane::Modulus(1e4),
        bending_rigidity: 1.0,
    };
    let mut model = cloth.on(&mesh).unwrap();
    for vertex in 0..mesh.vertex_count() {
        if mesh.positions()[vertex].x < 1.5 * h {
            model.particles.prescribe(vertex).unwrap();
        }
    }
    let to_rounding = ImplicitConfig {
        tolerance: 0.0,
        ..Default::default()
    };
    let mut newton = ImplicitEuler::builder(&model.particles)
        .energy(model.springs)
        .energy(model.hinges)
        .config(to_rounding)
        .build()
        .unwrap();
    let mut state = State::at_rest(mesh.positions().to_vec());
    let gravity = Vec3::z() * -0.05;
    for _ in 0..3 {
        state.velocities.fill(Vec3::zeros());
        let input = StepInput::new(100.0).gravity(gravity);
        newton.step(&mut state, input).unwrap();
    }
    let end = mesh.positions().iter().enumerate().filter(|(_, p)| {
        // The last column, which is 1 m from the middle of the first, held, cell.
        p.x > h * (cells as f64 + 0.75)
    });
    let heights: Vec<f64> = end.map(|(v, _)| -state.positions[v].z).collect();
    heights.iter().sum::<f64>() / heights.len() as f64 / (0.05 / 8.0)
}

/// Vertices of an alternating grid settle at two heights, and a narrow strip curves across: the energy 3 κ² of its
/// hinges falls to 2.4 κ².
#[test]
fn an_alternating_grid_is_softer_at_rest_than_on_a_cylinder() {
    let wide = 2.0 * grid_strip(96, 12) - grid_strip(48, 6);
    let narrow = 2.0 * grid_strip(144, 12) - grid_strip(72, 6);
    // As wide over long as 1/8 and 1/12.
    let limit = 3.0 * narrow - 2.0 * wide;
    assert!((limit - 3.0 / 2.4).abs() < 0.01, "{wide} {narrow} {limit}");
}

#[test]
fn a_strip_held_edge_on_falls_over_where_the_beam_does() {
    for model in MODELS {
        let evaluation = holds("lateral-buckling", &[&format!("model={model}")]);
        let isotropic = 12.8538 * (2.0 / (1.0 - 1.0 / 3.0_f64)).sqrt();
        assert!((evaluation.expected / isotropic - 1.0).abs() < 1e-5);
    }
}

/// Other triangles have another ratio of twist to bending, and the onset follows it from 22.3 to 38.8.
#[test]
fn the_onset_of_buckling_follows_the_stiffness_against_twist() {
    for (elongation, bound) in [("1.2", 1e-3), ("2", 2e-3)] {
        let evaluation = holds("lateral-buckling", &[&format!("elongation={elongation}")]);
        assert!(
            evaluation.error() < bound,
            "{elongation}: {}",
            evaluation.error()
        );
        let [twist, bending] =
            ["twist_rigidity", "bending_rigidity"].map(|name| detail(&evaluation, name));
        let beam = 12.8538 * (twist / bending).sqrt();
        assert!((evaluation.expected / beam - 1.0).abs() < 1e-5);
    }
}

#[test]
fn the_onset_of_buckling_is_approached_by_finer_and_narrower_strips() {
    let evaluation = holds("lateral-buckling", &["across=17", "slenderness=32"]);
    assert!(evaluation.error() < 0.0015, "{}", evaluation.error());
    // One strip alone is not the beam: the docs of the law say by how much.
    let strip = detail(&evaluation, "finest_strip") / evaluation.expected - 1.0;
    assert!((strip + 0.0044).abs() < 3e-4, "{strip}");
}
