//! Every law holds, over its parameters.

mod buckling;
mod elastica;

use crate::law::{detail, holds};
use cloth_bench::laws::{LAWS, Law};
use cloth_bench::method::METHODS;
use cloth_bench::settings::Settings;

#[test]
fn every_law_holds_at_its_defaults() {
    for law in LAWS {
        holds(law.name, &[]);
    }
}

#[test]
fn one_oscillator_is_amplified_and_turned_as_the_closed_form_says() {
    for scheme in [
        "explicit-euler",
        "symplectic-euler",
        "implicit-euler",
        "linear-implicit",
        "implicit-midpoint",
        "bdf2",
        "xpbd",
        "pd",
    ] {
        for z in ["0.001", "0.1", "0.7", "1.9", "2.5", "30"] {
            let evaluation = holds(
                "oscillator",
                &[&format!("scheme={scheme}"), &format!("z={z}")],
            );
            let [expected, measured] =
                ["phase_expected", "phase_measured"].map(|name| detail(&evaluation, name));
            assert!(
                (expected - measured).abs() < 1e-11,
                "{scheme}, z = {z}: {expected} against {measured}"
            );
        }
    }
}

#[test]
fn a_free_sheet_falls_without_changing_its_shape() {
    for method in METHODS {
        let evaluation = holds("free-fall", &[&format!("method={}", method.name)]);
        let bound = evaluation.rounding.max(1e-12);
        assert!(
            detail(&evaluation, "largest_strain") < bound,
            "{}",
            method.name
        );
    }
}

#[test]
fn one_xpbd_constraint_has_its_own_stiffness_at_any_iteration_count() {
    for iterations in [1, 2, 50] {
        for stiffness in ["0.1", "100", "1e6"] {
            for dt in ["1e-3", "0.0166"] {
                let [i, k, h] = [
                    format!("iterations={iterations}"),
                    format!("stiffness={stiffness}"),
                    format!("dt={dt}"),
                ];
                holds("xpbd-constraint", &[&i, &k, &h]);
            }
        }
    }
}

#[test]
fn a_damped_xpbd_constraint_takes_the_step_of_implicit_euler() {
    for iterations in [1, 20] {
        for stiffness in ["1", "100", "1e6"] {
            for damping in ["0", "1e-3", "10"] {
                for speed in ["0", "-3", "40"] {
                    let pairs = [
                        format!("iterations={iterations}"),
                        format!("stiffness={stiffness}"),
                        format!("damping={damping}"),
                        format!("speed={speed}"),
                    ];
                    holds("xpbd-damping", &pairs.each_ref().map(String::as_str));
                }
            }
        }
    }
}

#[test]
fn converged_xpbd_leaves_a_floor_that_falls_with_the_step() {
    let floor = |dt: &str| {
        let evaluation = holds("xpbd-compliance", &[&format!("dt={dt}")]);
        detail(&evaluation, "objective_floor")
    };
    let [large, small] = [floor("0.0166666667"), floor("0.00104166667")];
    assert!(large > 1e-6 && small < 1e-2 * large, "{large:e} {small:e}");
    holds("xpbd-compliance", &["tip_mass=100", "iterations=100000"]);
}

#[test]
fn the_direct_solver_takes_the_step_of_implicit_euler() {
    for system in ["saddle", "saddle-minres", "schur", "schur-cg"] {
        for stiffness in ["200", "1e4"] {
            let pairs = [format!("system={system}"), format!("stiffness={stiffness}")];
            holds("direct-step", &pairs.each_ref().map(String::as_str));
        }
    }
    holds("direct-step", &["tip_mass=1000"]);
}

#[test]
fn a_support_bears_the_weight_of_the_chain() {
    for pairs in [
        &["stiffness=1e5"][..],
        &["links=1", "iterations=1"],
        &["links=4", "mass=1", "stiffness=100", "iterations=200"],
        &["links=3", "tip_mass=5", "iterations=100000"],
    ] {
        holds("support-force", pairs);
    }
}

#[test]
fn one_pbd_constraint_stiffens_with_iterations_and_step_size() {
    for iterations in [1, 3, 10] {
        for s in ["0.05", "0.5", "0.9"] {
            holds(
                "pbd-constraint",
                &[
                    &format!("iterations={iterations}"),
                    &format!("stiffness={s}"),
                ],
            );
            holds(
                "pbd-constraint",
                &[
                    &format!("iterations={iterations}"),
                    &format!("stiffness={s}"),
                    "dt=1e-3",
                ],
            );
        }
    }
}

#[test]
fn sweeps_over_a_chain_converge_at_the_rate_of_the_closed_form() {
    for method in ["pbd", "xpbd"] {
        for solver in ["jacobi", "gauss-seidel", "sor", "chebyshev"] {
            for links in [2, 5, 20, 60] {
                let pairs = [
                    format!("method={method}"),
                    format!("solver={solver}"),
                    format!("links={links}"),
                ];
                let evaluation = holds("chain-rate", &pairs.each_ref().map(String::as_str));
                assert!(
                    evaluation.rounding < 1e-9,
                    "{pairs:?}: {:e}",
                    evaluation.rounding
                );
                assert!(detail(&evaluation, "off_mode") < 1e-11);
            }
        }
        holds("chain-rate", &[&format!("solver={method}")]);
    }
    // Iterations per decade for 20 links.
    for (solver, printed) in [
        ("jacobi", 746.0),
        ("gauss-seidel", 373.0),
        ("chebyshev", 29.3),
        ("sor", 14.6),
    ] {
        let factor = holds("chain-rate", &[&format!("solver={solver}")]).measured;
        let per_decade = -1.0 / factor.log10();
        assert!(
            (per_decade / printed - 1.0).abs() < 3e-3,
            "{solver}: {per_decade}"
        );
    }
}

#[test]
fn a_chain_sags_as_far_as_the_sweeps_leave_it() {
    for [links, substeps, iterations, tip] in [
        [20, 1, 1, 1],
        [20, 10, 1, 1],
        [5, 4, 1, 1],
        [20, 1, 10, 1],
        [10, 2, 3, 100],
        [10, 1, 1, 100_000],
        [5, 4, 3, 100_000],
        [20, 10, 1, 1000],
        [1, 3, 2, 7],
    ] {
        let pairs = [
            format!("links={links}"),
            format!("substeps={substeps}"),
            format!("iterations={iterations}"),
            format!("tip_mass={tip}"),
        ];
        holds("sag", &pairs.each_ref().map(String::as_str));
    }
    // Light and heavy tips, few and many sweeps, each kind of effort.
    for tip in ["1", "1e3", "1e5"] {
        for effort in ["substeps", "iterations"] {
            let other = if effort == "substeps" {
                "iterations=1"
            } else {
                "substeps=1"
            };
            for count in [1, 16, 256] {
                let effort = format!("{effort}={count}");
                holds("sag", &[&format!("tip_mass={tip}"), &effort, other]);
            }
        }
    }
}

#[test]
fn a_hanging_chain_stretches_by_its_weight() {
    for [links, tip] in [[1, 0], [20, 0], [20, 100], [200, 1]] {
        holds(
            "hanging-chain",
            &[&format!("links={links}"), &format!("tip_mass={tip}")],
        );
    }
}

#[test]
fn a_pendulum_swings_slower_the_higher_it_starts() {
    for method in ["implicit-midpoint", "bdf2"] {
        for (angle, period) in [("10", 1.001_907_2), ("90", 1.180_340_6), ("160", 2.007_5)] {
            let evaluation = holds(
                "pendulum",
                &[&format!("method={method}"), &format!("angle_deg={angle}")],
            );
            assert!((evaluation.expected - period).abs() < 1e-4, "{angle}");
        }
    }
}

#[test]
fn small_swings_of_a_chain_have_the_frequencies_of_laguerre() {
    for links in [1, 2, 5, 12] {
        for mode in [1, links.min(2), links] {
            holds(
                "chain-swing",
                &[&format!("links={links}"), &format!("mode={mode}")],
            );
        }
    }
    holds("chain-swing", &["method=bdf2"]);
}

#[test]
fn a_chain_between_two_supports_hangs_as_a_catenary() {
    for links in [2, 7, 20, 100] {
        for [span, drop] in [
            ["0.6", "0.1"],
            ["0.5", "0.3"],
            ["0.95", "0"],
            ["1.3", "-0.4"],
        ] {
            for stiffness in ["500", "1e5"] {
                let pairs = [
                    format!("links={links}"),
                    format!("span={span}"),
                    format!("drop={drop}"),
                    format!("stiffness={stiffness}"),
                ];
                let evaluation = holds("catenary", &pairs.each_ref().map(String::as_str));
                let distance = detail(&evaluation, "largest_distance");
                assert!(distance < 1e-8, "{pairs:?}: {distance:e} m");
            }
        }
    }
}

#[test]
fn lattices_have_their_modulus_in_every_direction() {
    for pattern in ["equilateral", "alternating", "one-way"] {
        for angle in ["0", "17", "45", "90", "-45", "120"] {
            holds(
                "lattice-modulus",
                &[&format!("pattern={pattern}"), &format!("angle_deg={angle}")],
            );
        }
    }
    for [angle, modulus] in [[0.0, 1.0], [45.0, 2.0], [-45.0, 0.4]] {
        let evaluation = holds(
            "lattice-modulus",
            &["pattern=one-way", &format!("angle_deg={angle}")],
        );
        assert!(
            (evaluation.expected - modulus).abs() < 1e-12,
            "{angle}: {}",
            evaluation.expected
        );
    }
}

#[test]
fn sheets_answer_a_pull_in_any_direction_with_their_closed_form() {
    for element in ["stvk", "arap", "springs"] {
        for direction in ["0", "17", "45", "-63"] {
            for stretch in ["0.9", "1", "1.01", "1.4"] {
                for load in ["uniaxial", "equibiaxial"] {
                    let pairs = [
                        format!("element={element}"),
                        format!("direction_deg={direction}"),
                        format!("stretch={stretch}"),
                        format!("load={load}"),
                    ];
                    let evaluation = holds("patch", &pairs.each_ref().map(String::as_str));
                    let [expected, measured] =
                        ["lateral_expected", "lateral"].map(|name| detail(&evaluation, name));
                    assert!((expected - measured).abs() < 1e-12, "{pairs:?}");
                    let inner = detail(&evaluation, "force_on_inner_vertices");
                    assert!(inner < 1e-14, "{pairs:?}: {inner:e}");
                }
            }
        }
    }
    for poisson in ["-0.4", "0", "0.49"] {
        holds("patch", &[&format!("poisson={poisson}")]);
    }
    // Springs have no pull per modulus of their own at large stretch: it depends on the direction.
    let [a, b] = ["0", "30"].map(|direction| {
        let direction = format!("direction_deg={direction}");
        holds("patch", &["element=springs", "stretch=1.4", &direction]).measured
    });
    assert!((a / b - 1.0).abs() > 1e-2);
}

#[test]
fn a_bending_spring_resists_with_the_fourth_power_of_the_fold() {
    for angle in ["0.1", "2", "20"] {
        let evaluation = holds("bending-spring", &[&format!("angle_deg={angle}")]);
        assert!((detail(&evaluation, "exponent") - 4.0).abs() < 0.02);
    }
}

#[test]
fn quadratic_bending_has_the_factors_of_its_pattern() {
    let factor = |pattern: &str, surface: &str, angle: f64| {
        let pairs = [
            format!("pattern={pattern}"),
            format!("surface={surface}"),
            format!("angle_deg={angle}"),
        ];
        holds("bending-factor", &pairs.each_ref().map(String::as_str)).measured
    };
    for angle in [0.0, 10.0, 45.0, 77.0, 135.0] {
        let published = [
            ("equilateral", 3.0, 3.0, 1.0),
            ("one-way", 3.0, 9.0, 1.5),
            ("alternating", 3.0, 4.5, 1.5),
        ];
        for (pattern, low, high, sphere) in published {
            let cylinder = factor(pattern, "cylinder", angle);
            assert!(
                cylinder > low - 1e-9 && cylinder < high + 1e-9,
                "{pattern} at {angle}: {cylinder}"
            );
            assert!((factor(pattern, "sphere", angle) - sphere).abs() < 1e-9);
            factor(pattern, "saddle", angle);
        }
    }
    assert!((factor("one-way", "cylinder", 45.0) - 9.0).abs() < 1e-9);
    assert!((factor("alternating", "cylinder", 45.0) - 4.5).abs() < 1e-9);
}

#[test]
fn vertices_of_two_kinds_settle_at_two_heights() {
    for surface in ["cylinder", "sphere", "saddle"] {
        for angle in ["0", "25", "45"] {
            for (pattern, settles) in [
                ("alternating", surface != "saddle"),
                ("equilateral", false),
                ("one-way", false),
            ] {
                for model in ["bergou", "grinspun"] {
                    let settled = |settled: &str| {
                        let pairs = [
                            format!("pattern={pattern}"),
                            format!("surface={surface}"),
                            format!("angle_deg={angle}"),
                            format!("model={model}"),
                            format!("settled={settled}"),
                        ];
                        holds("bending-factor", &pairs.each_ref().map(String::as_str)).measured
                    };
                    let relief = 1.0 - settled("yes") / settled("no");
                    assert_eq!(relief > 0.1, settles, "{pattern} {surface}: {relief}");
                }
            }
        }
    }
}

#[test]
fn every_bending_model_has_the_factors_of_its_pattern_times_its_own() {
    let models = [
        ("grinspun", 2.0),
        ("bridson", 1.0 / 12.0),
        ("cubic", 1.0),
        ("curved", 1.0),
    ];
    for (model, own) in models {
        for pattern in ["equilateral", "one-way", "alternating"] {
            for surface in ["cylinder", "sphere", "saddle"] {
                for angle in ["0", "10", "45", "77", "135"] {
                    let measured = |model: &str| {
                        let pairs = [
                            format!("model={model}"),
                            format!("pattern={pattern}"),
                            format!("surface={surface}"),
                            format!("angle_deg={angle}"),
                        ];
                        holds("bending-factor", &pairs.each_ref().map(String::as_str)).measured
                    };
                    let ratio = measured(model) / measured("bergou");
                    assert!((ratio / own - 1.0).abs() < 1e-9, "{model}: {ratio}");
                }
            }
        }
    }
}

#[test]
fn degrees_of_freedom_are_those_of_euler_and_the_boundary() {
    let meshes = [
        "grid:9x9:one-way",
        "grid:9x13:alternating",
        "grid:7x7:crossed",
        "equilateral:8x9",
        "irregular:12",
        "disk:5",
        "tube:9x6",
        "sphere:4",
        "torus:12x8",
        "moebius:16x3",
    ];
    for mesh in meshes {
        holds("count", &[&format!("mesh={mesh}")]);
        holds("null-space", &[&format!("mesh={mesh}")]);
    }
    let evaluation = holds("null-space", &["mesh=grid:9x9:alternating"]);
    assert_eq!(
        (evaluation.measured, detail(&evaluation, "nullity_flat")),
        (35.0, 84.0)
    );
    assert_eq!(holds("null-space", &["mesh=sphere:5"]).measured, 6.0);
    assert_eq!(holds("count", &["mesh=torus:12x8"]).measured, 0.0);
}

#[test]
fn converged_pd_and_converged_newton_are_one() {
    for stiffness in ["10", "100"] {
        holds("same-minimum", &[&format!("stiffness={stiffness}")]);
    }
}

#[test]
fn a_sheet_slides_if_the_tangent_of_the_slope_exceeds_the_friction() {
    for (angle, friction) in [
        ("5", "0"),
        ("20", "0.36"),
        ("20", "0.37"),
        ("45", "0.99"),
        ("80", "2"),
    ] {
        for method in ["xpbd", "pbd", "symplectic-euler"] {
            let pairs = [
                format!("angle_deg={angle}"),
                format!("friction={friction}"),
                format!("method={method}"),
            ];
            let evaluation = holds("incline", &pairs.each_ref().map(String::as_str));
            let tangent = angle.parse::<f64>().unwrap().to_radians().tan();
            let slides = tangent > friction.parse().unwrap();
            assert_eq!(evaluation.expected > 0.0, slides, "{pairs:?}");
            assert_eq!(evaluation.measured > 1e-4, slides, "{pairs:?}");
        }
    }
}

/// Angles between them would be those of the next whole edge.
#[test]
fn a_strip_goes_around_by_whole_edges() {
    for (law, given, words) in [
        ("capstan", "angle_deg=40", "give 33.75 or 45"),
        ("pressure", "angle_deg=1", "give 0 or 11.25"),
    ] {
        let law = Law::find(law).unwrap();
        let settings = Settings::parse(&[given]).unwrap();
        let error = law.evaluate(&settings).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn a_sheet_bounces_to_the_square_of_the_restitution() {
    for method in ["xpbd", "pbd", "symplectic-euler"] {
        for (restitution, height, bounces) in
            [("0.3", "1", "1"), ("0.8", "0.05", "2"), ("0", "1", "1")]
        {
            let pairs = [
                format!("method={method}"),
                format!("restitution={restitution}"),
                format!("height={height}"),
                format!("bounces={bounces}"),
            ];
            holds("bounce", &pairs.each_ref().map(String::as_str));
        }
    }
}

/// Below half of the thickness the potential is a barrier.
#[test]
fn a_sheet_rests_where_the_potential_bears_it() {
    for density in ["0.2", "80", "150", "1000"] {
        for method in ["pd", "implicit-euler"] {
            let pairs = [format!("density={density}"), format!("method={method}")];
            holds("barrier-gap", &pairs.each_ref().map(String::as_str));
        }
    }
}
