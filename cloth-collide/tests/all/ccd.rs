//! Continuous tests against closed forms, queries of exactly known answer, and bad input.

#[path = "../../../cloth-bench/src/ccd/exact_queries.rs"]
#[allow(unreachable_pub)] // public in the crate that it comes from
mod exact_queries;

use cloth_collide::{CollideError, ContinuousTest, Impact, Query, QueryKind, Stop};
use cloth_core::error::OutOfRange;
use cloth_core::math::{Real, Vec3};
use exact_queries::{ExactQueries, Family, KnownQuery, Truth};
use proptest::prelude::*;

const KINDS: [QueryKind; 2] = [QueryKind::VertexTriangle, QueryKind::EdgeEdge];

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

fn exactly() -> ContinuousTest {
    ContinuousTest::default()
}

/// Largest difference of two coordinates (m): what rounding is relative to.
fn size(query: &Query) -> Real {
    let [a, b, c, d] = query.from;
    let [e, f, g, h] = query.to;
    let all = [
        a - b,
        a - c,
        a - d,
        b - c,
        b - d,
        e - f,
        e - g,
        e - h,
        f - g,
        f - h,
    ];
    all.map(|x| x.amax()).into_iter().fold(0.0, Real::max)
}

mod closed_forms {
    use super::*;

    const FLOOR: [Vec3; 3] = [
        Vec3::new(-1.0, -1.0, 0.0),
        Vec3::new(2.0, -1.0, 0.0),
        Vec3::new(-1.0, 2.0, 0.0),
    ];

    fn falling(height: Real, fall: Real) -> [Vec3; 2] {
        [v(0.25, 0.25, height), v(0.25, 0.25, height - fall)]
    }

    /// Up to 100 m/s in a step of a sixtieth of a second, and on to a speed at which nothing but a continuous test sees
    /// anything.
    #[test]
    fn falling_vertex_hits_the_floor_at_height_over_speed() {
        for height in [1e-6, 0.01, 0.3, 1.0] {
            for fall in [1.0, 100.0 / 60.0, 1e3, 1e9] {
                for lift in [0.0, 1e6] {
                    let up = v(0.0, 0.0, lift);
                    let vertex = falling(height, fall).map(|x| x + up);
                    // What the coordinates are after rounding.
                    let (from, to) = (vertex[0].z - lift, vertex[1].z - lift);
                    let expected = from / (from - to);
                    let triangle = [FLOOR.map(|x| x + up); 2];
                    let query = Query::vertex_triangle(vertex, triangle);
                    let time = query.first_contact(&exactly()).unwrap().unwrap().time;
                    // The allowance for rounding is 2e-15 of the largest difference, which the speed takes to come off.
                    let allowed = 2e-15 * fall.max(3.0) / fall + 1e-15 * expected;
                    let error = expected - time;
                    assert!(error.abs() < allowed, "{height} {fall} {lift}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn separation_and_slack_come_off_the_height() {
        for separation in [0.0, 1e-3, 0.2] {
            for slack in [0.0, 1e-3, 0.1, 0.9] {
                let test = ContinuousTest::new(separation, slack).unwrap();
                let query = Query::vertex_triangle(falling(0.5, 2.0), [FLOOR; 2]);
                let impact = query.first_contact(&test).unwrap().unwrap();
                let gap = 0.5 - 2.0 * impact.time;
                let aim = separation + slack * (0.5 - separation);
                assert!(gap > separation && gap <= aim + 1e-14, "{gap} for {aim}");
            }
        }
    }

    /// The triangle tilts about the y axis, z = t x, and the vertex recedes along x = 1 − t/2 at the height h: t (1 −
    /// t/2) = h.
    #[test]
    fn tilting_triangle_meets_a_receding_vertex_at_a_root() {
        let triangle = |t: Real| [v(0.0, -2.0, 0.0), v(0.0, 2.0, 0.0), v(2.0, 0.0, 2.0 * t)];
        let vertex = |h: Real| [v(1.0, 0.0, h), v(0.5, 0.0, h)];
        let first = |h| {
            let query = Query::vertex_triangle(vertex(h), [triangle(0.0), triangle(1.0)]);
            query.first_contact(&exactly()).unwrap()
        };
        for h in [1e-9_f64, 0.1, 0.375, 0.45, 0.49999] {
            let expected = 1.0 - (1.0 - 2.0 * h as Real).sqrt();
            let time = first(h).unwrap().time;
            let error = expected - time;
            assert!(error.abs() < 1e-13, "{h}: {error:e}");
        }
        // The last moment, without going through; and not quite.
        assert_eq!(first(0.5).unwrap().stop, Stop::Contact);
        assert!(first(0.5).unwrap().time > 1.0 - 1e-14);
        assert_eq!(first(0.5_f64.next_up()), None);
    }

    #[test]
    fn crossing_edges_meet_where_their_lines_do() {
        let first = [v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0)];
        let second = |z: Real| [v(0.25, -1.0, z), v(0.25, 1.0, z)];
        for (start, end) in [(1.0, -1.0), (1e-3, -1.0), (3.0, -1e-3)] {
            let found = Query::edge_edge([first; 2], [second(start), second(end)])
                .first_contact(&exactly());
            let expected = start / (start - end);
            let error = expected - found.unwrap().unwrap().time;
            assert!(
                error.abs() < 1e-14 / (start - end),
                "{start} {end}: {error:e}"
            );
        }
        // Beside it, by as little as can be.
        let beside = |x: Real| [v(x, -1.0, 0.5), v(x, 1.0, 0.5)];
        let drop = v(0.0, 0.0, -1.0);
        let found = |x| {
            let edge = beside(x);
            let query = Query::edge_edge([first; 2], [edge, edge.map(|p| p + drop)]);
            query.first_contact(&exactly()).unwrap()
        };
        assert!(found(1.0).is_some());
        assert_eq!(found(1.0_f64.next_up()), None);
    }

    /// A rigid turn about a common point, at a distance of a billionth: the motion that keeps a bound on the speed from
    /// getting anywhere.
    #[test]
    fn turning_together_at_a_hairbreadth_is_no_contact() {
        let turned = |angle: Real, x: Vec3| {
            let (s, c) = angle.sin_cos();
            v(c * x.x - s * x.z, x.y, s * x.x + c * x.z)
        };
        for gap in [1e-3, 1e-6, 1e-9, 1e-12] {
            let edges = [
                v(-1.0, 0.0, 0.0),
                v(1.0, 0.0, 0.0),
                v(-1.0, 0.0, gap),
                v(1.0, 0.0, gap),
            ];
            let [a, b, c, d] = edges;
            let [a1, b1, c1, d1] = edges.map(|x| turned(1.5, x));
            let found =
                Query::edge_edge([[a, b], [a1, b1]], [[c, d], [c1, d1]]).first_contact(&exactly());
            assert_eq!(found.unwrap(), None, "parallel edges, {gap:e}");
            let corners = [v(-1.0, -1.0, 0.0), v(1.0, -1.0, 0.0), v(0.0, 1.0, 0.0)];
            let vertex = v(0.0, 0.0, gap);
            let query = Query::vertex_triangle(
                [vertex, turned(1.5, vertex)],
                [corners, corners.map(|x| turned(1.5, x))],
            );
            let found = query.first_contact(&exactly());
            assert_eq!(found.unwrap(), None, "vertex, {gap:e}");
        }
    }
}

mod exact {
    use super::*;

    const COUNT: usize = 40_000;

    fn each(seed: u64, mut check: impl FnMut(&KnownQuery)) {
        for kind in KINDS {
            ExactQueries::new(kind, seed)
                .take(COUNT)
                .for_each(|known| check(&known));
        }
    }

    #[test]
    fn no_contact_is_missed_and_no_time_is_late() {
        each(1, |known| {
            if let Truth::Contact { time } = known.truth {
                let found = known.query.first_contact(&exactly()).unwrap();
                let impact = found.unwrap_or_else(|| panic!("missed: {known:?}"));
                assert!(
                    impact.time <= time,
                    "late by {:e}: {known:?}",
                    impact.time - time
                );
                assert_eq!(impact.stop, Stop::Contact, "{known:?}");
            }
        });
    }

    #[test]
    fn no_contact_is_missed_and_no_time_is_late_with_separation_and_slack() {
        each(2, |known| {
            if let Truth::Contact { time } = known.truth {
                for (separation, slack) in [(0.0, 0.1), (1e-9, 0.0), (1e-3, 1e-3), (0.2, 0.5)] {
                    let test = ContinuousTest::new(separation * size(&known.query), slack).unwrap();
                    let found = known.query.first_contact(&test).unwrap();
                    let impact = found.unwrap_or_else(|| panic!("missed: {known:?}"));
                    assert!(impact.time <= time, "late: {known:?}");
                }
            }
        });
    }

    #[test]
    fn nothing_is_reported_where_there_is_a_gap() {
        each(3, |known| {
            if let Truth::Apart { gap } = known.truth {
                let found = known.query.first_contact(&exactly()).unwrap();
                assert_eq!(found, None, "gap {gap:e}: {known:?}");
            }
        });
    }

    /// The separation may come to within rounding of the gap.
    #[test]
    fn separation_just_below_the_gap_is_kept() {
        let mut spent = 0;
        each(4, |known| {
            if let Truth::Apart { gap } = known.truth {
                let separation = gap * (1.0 - 1e-3) - 1e-13 * size(&known.query);
                if separation > 0.0 {
                    let test = ContinuousTest::new(separation, 0.0).unwrap();
                    match known.query.first_contact(&test).unwrap() {
                        None => {}
                        Some(Impact {
                            stop: Stop::Budget, ..
                        }) => spent += 1,
                        Some(impact) => panic!("{impact:?} {known:?}"),
                    }
                }
            }
        });
        assert_eq!(spent, 0);
    }

    /// What was built is there, by the closest points of `f64`. This checks the queries.
    #[test]
    fn queries_are_what_they_say() {
        let mut contacts = 0;
        each(5, |known| {
            let rounding = 1e-13 * size(&known.query);
            let away = known.query.from[0].amax() * 4e-16;
            match known.truth {
                Truth::Contact { time } => {
                    contacts += 1;
                    let distance = known.query.distance(time);
                    assert!(distance <= rounding + 8.0 * away, "{distance:e} {known:?}");
                }
                Truth::Apart { gap } => {
                    for k in 0..=20 {
                        let distance = known.query.distance(f64::from(k) / 20.0);
                        assert!(
                            distance >= gap - rounding - 8.0 * away,
                            "{distance:e} {known:?}"
                        );
                    }
                }
            }
        });
        assert_eq!(contacts, COUNT);
    }

    #[test]
    fn every_family_is_met_with_and_without_contact() {
        let mut met = std::collections::HashSet::new();
        each(6, |known| {
            let contact = matches!(known.truth, Truth::Contact { .. });
            met.insert((format!("{:?}", known.family), contact));
        });
        assert_eq!(met.len(), 2 * Family::ALL.len());
    }
}

mod properties {
    use super::*;
    use proptest::test_runner::FileFailurePersistence;

    fn configured() -> ProptestConfig {
        let known = FileFailurePersistence::Direct("proptest-regressions/ccd.txt");
        ProptestConfig {
            failure_persistence: Some(Box::new(known)),
            ..ProptestConfig::with_cases(20_000)
        }
    }

    /// Coordinates that make coincident points, planes, slivers and tiny gaps frequent.
    fn awkward() -> impl Strategy<Value = Vec3> {
        let whole = prop_oneof![3 => (-2i32..=2).prop_map(f64::from), 1 => -2.0..2.0];
        let part = prop_oneof![
            4 => Just(0.0), 1 => -1e-6..1e-6, 1 => -1e-12..1e-12, 1 => -1e-16..1e-16
        ];
        let coordinate = (whole, part).prop_map(|(whole, part)| whole + part);
        [coordinate.clone(), coordinate.clone(), coordinate].prop_map(Vec3::from)
    }

    fn query() -> impl Strategy<Value = Query> {
        let four = || [awkward(), awkward(), awkward(), awkward()];
        // Some of the vertices stand still, and some only nearly.
        let motion = (
            four(),
            four(),
            prop::array::uniform4(0..3),
            prop::sample::select(&KINDS),
        );
        motion.prop_map(|(from, other, kinds, kind)| {
            let to = std::array::from_fn(|k| match kinds[k] {
                0 => from[k],
                1 => from[k] + other[k] * 1e-9,
                _ => other[k],
            });
            Query { kind, from, to }
        })
    }

    proptest! {
        #![proptest_config(configured())]

        /// Up to the impact the distance is larger than the separation; there it has come down to what was asked for.
        #[test]
        fn distance_is_kept_until_the_impact_and_used_up_there(
            query in query(),
            separation in prop_oneof![Just(0.0), Just(1e-9), Just(1e-3), 0.0..2.0],
            slack in prop_oneof![Just(0.0), Just(1e-6), 0.0..1.0],
        ) {
            let test = ContinuousTest::new(separation, slack).unwrap();
            let found = query.first_contact(&test).unwrap();
            let rounding = 1e-14 * (size(&query) + separation);
            let last = found.map_or(1.0, |impact| impact.time);
            for k in 0..=64 {
                let distance = query.distance(last * f64::from(k) / 64.0);
                let from_start = last == 0.0;
                prop_assert!(from_start || distance > separation - rounding, "{distance:e} {found:?}");
            }
            if let Some(Impact { time, stop }) = found {
                prop_assert!((0.0..=1.0).contains(&time));
                let start = query.distance(0.0) - separation;
                let left = query.distance(time) - separation;
                prop_assert!(left <= slack * start.max(0.0) + rounding || stop == Stop::Budget, "{left:e} {found:?}");
                prop_assert!(time > 0.0 || start <= rounding, "{start:e}");
            }
        }

        /// Twice as large, turned upside down, the other edge first, seen from behind: the same question.
        #[test]
        fn answer_does_not_depend_on_how_the_question_is_put(query in query()) {
            let order = match query.kind {
                QueryKind::VertexTriangle => [0, 3, 1, 2],
                QueryKind::EdgeEdge => [3, 2, 0, 1],
            };
            let other = |x: [Vec3; 4]| order.map(|k| -2.0 * v(x[k].y, x[k].z, x[k].x));
            let image = Query { kind: query.kind, from: other(query.from), to: other(query.to) };
            let time = |query: &Query| {
                let found = query.first_contact(&exactly()).unwrap();
                found.map(|impact| impact.time)
            };
            let (one, two) = (time(&query), time(&image));
            prop_assert_eq!(one.is_some(), two.is_some());
            if let (Some(one), Some(two)) = (one, two) {
                // Near-tangential contacts are found at different moments of the last bit of distance.
                let place = query.distance(one.max(two));
                prop_assert!((one - two).abs() < 1e-12 || place < 1e-14 * size(&query), "{one} {two}");
            }
        }
    }
}

mod bad_input {
    use super::*;

    fn apart() -> Query {
        Query {
            kind: QueryKind::VertexTriangle,
            from: [v(0.2, 0.2, 1.0), Vec3::zeros(), Vec3::x(), Vec3::y()],
            to: [v(0.2, 0.2, 0.5), Vec3::zeros(), Vec3::x(), Vec3::y()],
        }
    }

    #[test]
    fn numbers_that_are_none_are_refused_with_their_vertex() {
        for kind in KINDS {
            for bad in [Real::NAN, Real::INFINITY, -Real::INFINITY] {
                for vertex in 0..4 {
                    for axis in 0..3 {
                        let mut query = Query { kind, ..apart() };
                        query.to[vertex][axis] = bad;
                        let refused = Err(CollideError::NonFinitePosition { vertex });
                        assert_eq!(query.first_contact(&exactly()), refused);
                    }
                }
            }
        }
    }

    #[test]
    fn separation_and_slack_out_of_range_are_refused() {
        for bad in [-1.0, Real::NAN, Real::INFINITY] {
            assert!(matches!(
                ContinuousTest::new(bad, 0.0),
                Err(CollideError::OutOfRange(OutOfRange {
                    name: "separation (m)",
                    ..
                }))
            ));
            assert!(matches!(
                ContinuousTest::new(0.0, bad),
                Err(CollideError::OutOfRange(OutOfRange { name: "slack", .. }))
            ));
        }
        assert!(ContinuousTest::new(0.0, 1.0).is_err());
    }

    /// From the smallest number to the largest that can be squared after scaling, the answer is the same.
    #[test]
    fn unit_of_length_does_not_matter() {
        let hit = Query {
            to: [v(0.2, 0.2, -1.0), Vec3::zeros(), Vec3::x(), Vec3::y()],
            ..apart()
        };
        for exponent in [-1000, -500, -100, 100, 500, 990] {
            let scale = (2.0 as Real).powi(exponent);
            let scaled = |query: &Query| Query {
                from: query.from.map(|x| x * scale),
                to: query.to.map(|x| x * scale),
                ..*query
            };
            assert_eq!(scaled(&apart()).first_contact(&exactly()).unwrap(), None);
            let time = scaled(&hit)
                .first_contact(&exactly())
                .unwrap()
                .unwrap()
                .time;
            assert!((time - 0.5).abs() < 1e-15, "{exponent} {time}");
        }
        let too_large = Query {
            from: apart().from.map(|x| x * 1e305),
            ..apart()
        };
        assert_eq!(
            too_large.first_contact(&exactly()),
            Err(CollideError::TooFarApart)
        );
        let too_large = Query {
            from: apart().from.map(|x| x * 1.7e308),
            to: apart().to.map(|x| x * -1.7e308),
            ..apart()
        };
        assert_eq!(
            too_large.first_contact(&exactly()),
            Err(CollideError::TooFarApart)
        );
    }

    #[test]
    fn everything_at_one_place_is_in_contact() {
        for kind in KINDS {
            for place in [Vec3::zeros(), v(0.1, 1e6, -3.0)] {
                let query = Query {
                    kind,
                    from: [place; 4],
                    to: [place; 4],
                };
                let impact = query.first_contact(&exactly()).unwrap().unwrap();
                assert_eq!((impact.time, impact.stop), (0.0, Stop::Contact));
            }
        }
        // Subnormal numbers.
        let tiny = Real::from_bits(1);
        let query = Query {
            kind: QueryKind::VertexTriangle,
            from: [
                v(0.0, 0.0, tiny),
                Vec3::zeros(),
                v(tiny, 0.0, 0.0),
                v(0.0, tiny, 0.0),
            ],
            to: [Vec3::zeros(); 4],
        };
        assert!(query.first_contact(&exactly()).unwrap().is_some());
    }
}
