use super::*;
use proptest::prelude::*;
use proptest::strategy::ValueTree;

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

/// The triangle that all constructed cases are held against.
const FLOOR: [[f64; 3]; 3] = [[0., 0., 0.], [4., 0., 0.], [0., 4., 0.]];

/// Asks in all 72 orders of corners and arguments, so that every case checks symmetry too.
fn meets_floor(other: [[f64; 3]; 3]) -> bool {
    let orders = [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [0, 2, 1],
        [2, 1, 0],
        [1, 0, 2],
    ];
    let answers = orders.iter().flat_map(|i| {
        orders.iter().flat_map(move |j| {
            let (a, b) = (i.map(|k| FLOOR[k].into()), j.map(|k| other[k].into()));
            [triangles_meet(a, b), triangles_meet(b, a)]
        })
    });
    let answers: Vec<bool> = answers.collect();
    assert!(
        answers.iter().all(|&answer| answer == answers[0]),
        "not symmetric: {other:?}"
    );
    answers[0]
}

#[test]
fn crossing_counts() {
    assert!(meets_floor([[1., 1., -1.], [1., 1., 1.], [9., 9., 1.]]));
    // Not one edge of the other passes through the floor, but an edge of the floor through it.
    assert!(meets_floor([[2., 2., -9.], [2., 2., 9.], [-9., -9., 0.5]]));
    assert!(meets_floor([[-1., 1., -1.], [-1., 1., 1.], [9., 1., 0.]]));
}

#[test]
fn passing_by_does_not_count() {
    assert!(!meets_floor([[3., 3., -1.], [3., 3., 1.], [9., 9., 1.]]));
    assert!(!meets_floor([[0., 0., 1.], [4., 0., 1.], [0., 4., 1.]]));
    assert!(!meets_floor([[1., 1., 1e-300], [1., 1., 1.], [2., 1., 1.]]));
    // Both planes are crossed, but along different parts of their common line.
    assert!(!meets_floor([[-1., 1., -1.], [-1., 1., 1.], [-9., 1., 0.]]));
}

#[test]
fn touching_counts() {
    assert!(meets_floor([[1., 1., 0.], [1., 1., 1.], [2., 1., 1.]])); // corner on face
    assert!(meets_floor([[2., 2., 0.], [2., 2., 1.], [3., 3., 1.]])); // corner on edge
    assert!(meets_floor([[4., 0., 0.], [5., 0., 1.], [5., 1., 1.]])); // corner on corner
    assert!(meets_floor([[2., -1., 0.], [2., 1., 0.], [2., 0., 1.]])); // edge in face
    assert!(meets_floor([[2., -1., -1.], [2., 1., 1.], [2., -1., 1.]])); // edge on edge
    assert!(meets_floor([[0., 0., 0.], [4., 0., 0.], [0., 0., 4.]])); // a common edge
}

#[test]
fn coplanar_triangles_count_where_they_overlap_or_touch() {
    assert!(meets_floor([[1., 1., 0.], [9., 1., 0.], [1., 9., 0.]])); // overlapping
    assert!(meets_floor([[1., 1., 0.], [1.5, 1., 0.], [1., 1.5, 0.]])); // inside
    assert!(meets_floor([
        [-9., -9., 0.],
        [30., -9., 0.],
        [-9., 30., 0.]
    ])); // around
    assert!(meets_floor(FLOOR)); // the same
    assert!(meets_floor([[4., 0., 0.], [0., 4., 0.], [4., 4., 0.]])); // neighbours
    assert!(meets_floor([[2., 2., 0.], [3., 3., 0.], [3., 4., 0.]])); // corner on edge
    assert!(!meets_floor([[3., 3., 0.], [4., 3., 0.], [3., 4., 0.]])); // apart
    assert!(!meets_floor([[5., 0., 0.], [9., 0., 0.], [5., 4., 0.]])); // apart, on the line of an edge
}

#[test]
fn triangle_without_area_is_a_segment_or_a_point() {
    assert!(meets_floor([[1., 1., -1.], [1., 1., 1.], [1., 1., 3.]]));
    assert!(meets_floor([[1., 1., 0.]; 3]));
    assert!(meets_floor([[-1., 1., 0.], [1., 1., 0.], [9., 1., 0.]]));
    assert!(!meets_floor([[1., 1., 1.]; 3]));
    assert!(!meets_floor([[4., 4., 0.]; 3]));
    assert!(!meets_floor([[3., 3., -1.], [3., 3., 1.], [3., 3., 3.]]));
    // Two segments: crossing; skew with overlapping projections; on one line, touching and apart.
    let x = [v(0., 0., 0.), v(2., 0., 0.), v(4., 0., 0.)];
    assert!(triangles_meet(
        x,
        [v(1., -1., 0.), v(1., 0., 0.), v(1., 5., 0.)]
    ));
    assert!(!triangles_meet(
        x,
        [v(1., -1., -1.), v(1., 1., 2.), v(1., 0., 0.5)]
    ));
    assert!(triangles_meet(
        x,
        [v(4., 0., 0.), v(5., 0., 0.), v(7., 0., 0.)]
    ));
    assert!(!triangles_meet(
        x,
        [v(5., 0., 0.), v(6., 0., 0.), v(7., 0., 0.)]
    ));
    assert!(triangles_meet([v(1., 2., 3.); 3], [v(1., 2., 3.); 3]));
    assert!(!triangles_meet([v(1., 2., 3.); 3], [v(1., 2., 3.5); 3]));
}

#[test]
fn segments_of_one_line_meet_if_they_overlap() {
    for (x, y) in [(1.0, 0.0), (0.0, 1.0), (3.0, -2.0)] {
        let at = |t: f64| Coord { x: x * t, y: y * t };
        assert!(segments_meet([at(0.), at(2.)], [at(3.), at(1.)]));
        assert!(segments_meet([at(0.), at(2.)], [at(2.), at(3.)]));
        assert!(!segments_meet([at(0.), at(2.)], [at(4.), at(3.)]));
        assert!(segments_meet([at(0.), at(2.)], [at(1.), at(1.)]));
        assert!(!segments_meet([at(0.), at(2.)], [at(3.), at(3.)]));
    }
}

/// A tilted plane that holds the diagonal x = y = z exactly, and corners that stand on the diagonal or one unit in
/// the last place beside it. Plain floating point gets most of these wrong.
#[test]
fn one_unit_in_the_last_place_decides() {
    let tilted = [v(0.1, 0.1, 0.1), v(0.75, 0.25, 0.5), v(0.25, 0.75, 0.5)];
    for i in 0..100 {
        let m = 0.11 + 0.003 * f64::from(i);
        let standing = |z| [v(m, m, z), v(0.3, 0.3, 2.0), v(0.4, 0.4, 2.0)];
        assert!(triangles_meet(tilted, standing(m)), "on the plane at {m}");
        assert!(
            triangles_meet(tilted, standing(m.next_down())),
            "through the plane at {m}"
        );
        assert!(
            !triangles_meet(tilted, standing(m.next_up())),
            "above the plane at {m}"
        );
    }
}

/// Exact reference that shares nothing with the code: the sets meet exactly if 0 is in the convex hull of all
/// differences of their corners, and then (Carathéodory) in a simplex of at most four of them whose corners are
/// affinely independent.
mod reference {
    type Point = [i128; 3];

    fn minus(a: Point, b: Point) -> Point {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }
    fn dot(a: Point, b: Point) -> i128 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }
    fn cross(a: Point, b: Point) -> Point {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    }
    fn det(a: Point, b: Point, c: Point) -> i128 {
        dot(a, cross(b, c))
    }
    fn one_sign(weights: &[i128]) -> bool {
        weights.iter().all(|&w| w >= 0) || weights.iter().all(|&w| w <= 0)
    }

    /// Whether the simplex has independent corners and holds the origin: the signs of its barycentric coordinates.
    fn holds_origin(simplex: &[Point]) -> bool {
        match *simplex {
            [a] => a == [0; 3],
            [a, b] => a != b && cross(a, b) == [0; 3] && dot(a, b) <= 0,
            [a, b, c] => {
                let n = cross(minus(b, a), minus(c, a));
                n != [0; 3]
                    && dot(n, a) == 0
                    && one_sign(&[
                        dot(cross(a, b), n),
                        dot(cross(b, c), n),
                        dot(cross(c, a), n),
                    ])
            }
            [a, b, c, d] => {
                det(minus(b, a), minus(c, a), minus(d, a)) != 0
                    && one_sign(&[det(b, c, d), -det(a, c, d), det(a, b, d), -det(a, b, c)])
            }
            _ => unreachable!("at most four corners"),
        }
    }

    fn some_simplex(chosen: &mut Vec<Point>, rest: &[Point]) -> bool {
        if !chosen.is_empty() && holds_origin(chosen) {
            return true;
        }
        chosen.len() < 4
            && (0..rest.len()).any(|i| {
                chosen.push(rest[i]);
                let found = some_simplex(chosen, &rest[i + 1..]);
                chosen.pop();
                found
            })
    }

    pub(super) fn meet(first: &[[i32; 3]], second: &[[i32; 3]]) -> bool {
        let wide = |p: &[i32; 3]| p.map(i128::from);
        let differences: Vec<Point> = first
            .iter()
            .flat_map(|a| second.iter().map(move |b| minus(wide(a), wide(b))))
            .collect();
        some_simplex(&mut Vec::new(), &differences)
    }
}

/// Corners on a small lattice, so that touching, coplanar and degenerate cases are frequent.
fn corners<const N: usize>() -> impl Strategy<Value = [[i32; 3]; N]> {
    let lattice =
        |size: i32| proptest::array::uniform::<_, N>(proptest::array::uniform3(-size..=size));
    prop_oneof![lattice(1), lattice(2), lattice(4), lattice(100)]
}

fn real<const N: usize>(corners: [[i32; 3]; N]) -> [Vec3; N] {
    corners.map(|c| c.map(f64::from).into())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]
    #[test]
    fn triangles_meet_exactly_as_in_integer_arithmetic(a in corners::<3>(), b in corners::<3>()) {
        let expected = reference::meet(&a, &b);
        prop_assert_eq!(triangles_meet(real(a), real(b)), expected);
        prop_assert_eq!(triangles_meet(real(b), real(a)), expected);
    }

    #[test]
    fn coplanar_triangles_meet_exactly_as_in_integer_arithmetic(
        a in corners::<3>(), b in corners::<3>(), u in corners::<2>()
    ) {
        // Both are pressed into the plane (or line) of two lattice vectors.
        let press = |t: [[i32; 3]; 3]| t.map(|[x, y, _]| [0, 1, 2].map(|k| x * u[0][k] + y * u[1][k]));
        let (a, b) = (press(a), press(b));
        prop_assert_eq!(triangles_meet(real(a), real(b)), reference::meet(&a, &b));
    }

    #[test]
    fn segment_meets_triangle_exactly_as_in_integer_arithmetic(s in corners::<2>(), t in corners::<3>()) {
        prop_assert_eq!(segment_meets_triangle(real(s), real(t)), reference::meet(&s, &t));
    }
}

/// The lattice tests are worth something only if both answers and the rare branches come up often.
#[test]
fn lattice_holds_both_answers_and_coplanar_triangles() {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let (mut met, mut coplanar) = (0, 0);
    for _ in 0..1000 {
        let [a, b] =
            [(); 2].map(|()| real(corners::<3>().new_tree(&mut runner).unwrap().current()));
        met += usize::from(triangles_meet(a, b));
        coplanar += usize::from(b.iter().all(|&p| side(a, p) == 0));
    }
    assert!((100..900).contains(&met), "{met} of 1000 meet");
    assert!(
        coplanar > 20,
        "{coplanar} of 1000 are coplanar or degenerate"
    );
}
