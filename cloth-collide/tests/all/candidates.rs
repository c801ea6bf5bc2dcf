//! Candidates of a motion: none is missed, whatever the broad phase.

use crate::random::Random;
use crate::shapes::{deformed, sheet};
use cloth_collide::{
    Bounds, BroadPhase, ClothCandidates, CollideError, ContinuousTest, Hierarchy, MortonGrid,
    Query, QueryKind, SpatialHash, edge_edge, point_triangle,
};
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::topology::EdgeTable;

type Pairs = Vec<[u32; 2]>;

/// One of each kind, with its name.
fn all_kinds() -> [(&'static str, Box<dyn BroadPhase>); 3] {
    [
        ("hierarchy", Box::new(Hierarchy::default())),
        ("hash", Box::new(SpatialHash::default())),
        ("morton", Box::new(MortonGrid::default())),
    ]
}

/// Whether the inflated swept boxes of two sets of vertices overlap, axis by axis and written another way than the code
/// has it.
fn near(a: &[u32], b: &[u32], from: &[Vec3], to: &[Vec3], margin: Real) -> bool {
    (0..3).all(|axis| {
        let range = |vertices: &[u32]| {
            let both = |&v: &u32| [from[v as usize][axis], to[v as usize][axis]];
            let all: Vec<Real> = vertices.iter().flat_map(both).collect();
            let low = all.iter().copied().fold(Real::INFINITY, Real::min);
            let high = all.iter().copied().fold(-Real::INFINITY, Real::max);
            (
                (low - 0.5 * margin).next_down(),
                (high + 0.5 * margin).next_up(),
            )
        };
        let ((low, high), (other_low, other_high)) = (range(a), range(b));
        !(high < other_low || other_high < low)
    })
}

fn brute_force(
    mesh: &TriMesh,
    edges: &[[u32; 2]],
    [from, to]: [&[Vec3]; 2],
    margin: Real,
) -> (Pairs, Pairs) {
    let wanted =
        |a: &[u32], b: &[u32]| !a.iter().any(|v| b.contains(v)) && near(a, b, from, to, margin);
    let vertices = 0..mesh.vertex_count() as u32;
    let triangles = || (0..).zip(mesh.triangles());
    let vertex_triangle = vertices
        .flat_map(|v| {
            triangles()
                .filter(move |(_, t)| wanted(&[v], *t))
                .map(move |(t, _)| [v, t])
        })
        .collect();
    let numbered = || (0..).zip(edges);
    let edge_edge = numbered()
        .flat_map(|(i, e)| {
            numbered()
                .skip(i as usize + 1)
                .filter(move |(_, f)| wanted(e, *f))
                .map(move |(j, _)| [i, j])
        })
        .collect();
    (vertex_triangle, edge_edge)
}

/// Motions between all awkward shapes, and worse.
fn motions(mesh: &TriMesh) -> Vec<(String, Vec<Vec3>, Vec<Vec3>)> {
    let shapes = deformed(mesh);
    let mut random = Random::new(1);
    let mut motions = Vec::new();
    let mut add = |name: String, from: &[Vec3], to: &[Vec3]| {
        motions.push((name, from.to_vec(), to.to_vec()));
    };
    let next = shapes.iter().cycle().skip(1);
    for ((name, from), (next, to)) in shapes.iter().zip(next) {
        add(format!("{name} still"), from, from);
        add(format!("{name} to {next}"), from, to);
    }
    let count = mesh.vertex_count();
    let mut scattered = |size: Real| (0..count).map(|_| random.point(size)).collect::<Vec<_>>();
    let soup = scattered(1.0);
    add("random".into(), &soup, &soup);
    let nearby: Vec<Vec3> = soup
        .iter()
        .zip(scattered(0.1))
        .map(|(x, d)| x + d)
        .collect();
    add("random motion".into(), &soup, &nearby);
    let flattened: Vec<Vec3> = soup.iter().map(|x| Vec3::new(x.x, x.y, 0.0)).collect();
    add("flattened".into(), &soup, &flattened);

    let crumpled = &shapes[4].1;
    let changed = |f: &dyn Fn(usize, Vec3) -> Vec3| {
        (0..)
            .zip(crumpled)
            .map(|(i, &x)| f(i, x))
            .collect::<Vec<_>>()
    };
    for factor in [1e-200, 1e-12, 1e9, 1e100] {
        let scaled = changed(&|_, x| x * factor);
        add(format!("times {factor:e}"), &scaled, &scaled);
        let moved = changed(&|_, x| x + Vec3::new(factor, -factor, 0.0));
        add(format!("at {factor:e}"), &moved, &moved);
        let torn = changed(&|i, x| if i % 17 == 3 { x * factor } else { x });
        add(format!("every 17th times {factor:e}"), &torn, &torn);
        let last = changed(&|i, x| if i == 5 { x.add_scalar(factor) } else { x });
        add(format!("one at {factor:e}"), crumpled, &last);
    }
    let graded = changed(&|i, x| x * 1.3f64.powi(i as i32));
    add("of growing size".into(), &graded, &graded);
    motions
}

/// Whether `found` lists the pairs of `all`, in order, apart from some that stay further apart than the margin: the
/// continuous test, which misses no contact, says so. `vertices` are those of a pair.
fn leaves_out_what_is_apart(
    found: &[[u32; 2]],
    all: &[[u32; 2]],
    kind: QueryKind,
    vertices: impl Fn([u32; 2]) -> [u32; 4],
    [from, to]: [&[Vec3]; 2],
    margin: Real,
) -> bool {
    let test = ContinuousTest::new(margin, 0.0).unwrap();
    let is_apart = |pair: [u32; 2]| {
        let query = Query {
            kind,
            from: gather(from, vertices(pair)),
            to: gather(to, vertices(pair)),
        };
        query.first_contact(&test).unwrap().is_none()
    };
    let mut left = found.iter().peekable();
    all.iter()
        .all(|pair| left.next_if_eq(&pair).is_some() || is_apart(*pair))
        && left.next().is_none()
}

/// Whether the candidates are the pairs of boxes, apart from what is further apart than the margin.
fn agree<B: BroadPhase>(
    mesh: &TriMesh,
    candidates: &ClothCandidates<B>,
    vertex_triangle: &[[u32; 2]],
    edge_edge: &[[u32; 2]],
    paths: [&[Vec3]; 2],
    margin: Real,
) -> bool {
    let of_vertex = |[v, t]: [u32; 2]| {
        let [a, b, c] = mesh.triangles()[t as usize];
        [v, a, b, c]
    };
    let of_edges = |pair: [u32; 2]| {
        let [[a, b], [c, d]] = pair.map(|e| candidates.edges()[e as usize]);
        [a, b, c, d]
    };
    leaves_out_what_is_apart(
        candidates.vertex_triangle(),
        vertex_triangle,
        QueryKind::VertexTriangle,
        of_vertex,
        paths,
        margin,
    ) && leaves_out_what_is_apart(
        candidates.edge_edge(),
        edge_edge,
        QueryKind::EdgeEdge,
        of_edges,
        paths,
        margin,
    )
}

#[test]
fn all_three_find_what_brute_force_finds_in_order() {
    let mesh = sheet(7);
    let edges = EdgeTable::build(&mesh).unwrap();
    for (kind, broad_phase) in all_kinds() {
        let mut candidates = ClothCandidates::new(&mesh, broad_phase);
        assert_eq!(candidates.edges(), edges.ends());
        // One after the other, so that what is kept from before would show.
        for (name, from, to) in motions(&mesh) {
            for margin in [0.0, 0.01, 0.3, 10.0] {
                candidates.update(&from, &to, margin).unwrap();
                let paths = [&from[..], &to[..]];
                let (vt, ee) = brute_force(&mesh, edges.ends(), paths, margin);
                let agrees = agree(&mesh, &candidates, &vt, &ee, paths, margin);
                assert!(agrees, "{kind}, {name}, margin {margin}");
            }
        }
    }
}

#[test]
fn what_comes_as_near_as_the_margin_is_a_candidate() {
    let mesh = sheet(5);
    let triangles = mesh.triangles();
    for (name, from, to) in motions(&mesh) {
        let mut candidates = ClothCandidates::new(&mesh, Hierarchy::default());
        let margin = 0.05;
        candidates.update(&from, &to, margin).unwrap();
        for time in [0.0, 0.37, 1.0] {
            let x: Vec<Vec3> = from.iter().zip(&to).map(|(a, b)| a.lerp(b, time)).collect();
            // Where rounding of the position in between exceeds the margin, it says nothing.
            if x.iter().any(|p| p.amax() > 1e6) {
                continue;
            }
            for v in 0..x.len() as u32 {
                for (t, &corners) in (0..).zip(triangles) {
                    let d = point_triangle(x[v as usize], gather(&x, corners)).distance();
                    let is_found = || candidates.vertex_triangle().binary_search(&[v, t]).is_ok();
                    let is_pair = !corners.contains(&v) && d <= margin - 1e-9;
                    assert!(!is_pair || is_found(), "{name}: {v} {t} at {d}");
                }
            }
            for (i, e) in (0..).zip(candidates.edges()) {
                for (j, f) in (0..).zip(candidates.edges()).skip(i as usize + 1) {
                    let d = edge_edge(gather(&x, *e), gather(&x, *f)).distance();
                    let is_found = || candidates.edge_edge().binary_search(&[i, j]).is_ok();
                    let is_pair = !e.iter().any(|v| f.contains(v)) && d <= margin - 1e-9;
                    assert!(!is_pair || is_found(), "{name}: {i} {j} at {d}");
                }
            }
        }
    }
}

#[test]
fn candidates_do_not_depend_on_what_was_asked_before() {
    let mesh = sheet(16);
    let mut all =
        all_kinds().map(|(kind, broad_phase)| (kind, ClothCandidates::new(&mesh, broad_phase)));
    for (name, from, to) in motions(&mesh) {
        let mut fresh = ClothCandidates::new(&mesh, Hierarchy::default());
        fresh.update(&from, &to, 0.02).unwrap();
        for (kind, used) in &mut all {
            used.update(&from, &to, 0.02).unwrap();
            assert_eq!(
                used.vertex_triangle(),
                fresh.vertex_triangle(),
                "{kind}, {name}"
            );
            assert_eq!(used.edge_edge(), fresh.edge_edge(), "{kind}, {name}");
        }
    }
}

#[test]
fn boxes_of_any_number_and_size_give_the_same_pairs() {
    let mut random = Random::new(2);
    let mut kinds = all_kinds();
    for round in 0..200 {
        let count = [0, 1, 2, 3, 5, 17, 120, 300][round % 8];
        // From all alike to twenty powers of ten apart.
        let spread = random.real(10.0).abs();
        let boxes: Vec<Bounds> = (0..count)
            .map(|_| {
                let size = 0.1 * 10f64.powf(random.real(spread));
                let corner = random.point(1.0);
                let other = corner + random.point(size);
                Bounds {
                    lower: corner.inf(&other),
                    upper: corner.sup(&other),
                }
            })
            .collect();
        let mut expected = Vec::new();
        for b in 0..boxes.len() {
            expected.extend(
                (0..b)
                    .filter(|&a| boxes[a].overlaps(&boxes[b]))
                    .map(|a| [a as u32, b as u32]),
            );
        }
        expected.sort_unstable();
        for (kind, broad_phase) in &mut kinds {
            let mut found = vec![[7, 7]];
            broad_phase.overlapping(&boxes, &mut found);
            found.sort_unstable();
            assert_eq!(found, expected, "{kind}, round {round}");
        }
    }
}

#[test]
fn three_triangles_at_an_edge_and_two_cloths_in_one_mesh_are_welcome() {
    let x = [
        [0., 0., 0.],
        [1., 0., 0.],
        [0., 1., 0.],
        [0., 0., 1.],
        [0., -1., 0.],
    ];
    let mut positions: Vec<Vec3> = x.into_iter().map(Vec3::from).collect();
    positions.extend([[0.1, 0.1, 0.05], [0.3, 0.1, 0.05], [0.1, 0.3, 0.05]].map(Vec3::from));
    let triangles = vec![[0, 1, 2], [0, 1, 3], [0, 1, 4], [5, 6, 7]];
    let mesh = TriMesh::new(positions.clone(), triangles).unwrap();
    for (kind, broad_phase) in all_kinds() {
        let mut candidates = ClothCandidates::new(&mesh, broad_phase);
        candidates.update(&positions, &positions, 0.1).unwrap();
        let edges = candidates.edges().to_vec();
        let paths = [&positions[..]; 2];
        let (vt, ee) = brute_force(&mesh, &edges, paths, 0.1);
        let agrees = agree(&mesh, &candidates, &vt, &ee, paths, 0.1);
        assert!(agrees, "{kind}");
        // Three corners are 5 cm above a triangle, and two of them 10 cm before another; edges are 11 cm apart.
        let found = [candidates.vertex_triangle(), candidates.edge_edge()];
        assert_eq!(found.map(<[_]>::len), [5, 0], "{kind}");
    }
}

/// An accordion of eight layers, twice the thickness apart on average, whose cells are four thicknesses wide. Boxes
/// alone find twice as many pairs as come as near as the thickness.
#[test]
fn close_layers_have_few_candidates_that_are_not_near() {
    const THICKNESS: Real = 0.002;
    let mesh = grid(65, 17, 0.512, 0.128, Diagonals::Alternating).unwrap();
    let fold = |x: &Vec3| {
        let (layer, part) = ((x.x / 0.064).floor(), (x.x / 0.064).fract());
        let along = if layer % 2.0 == 0.0 { part } else { 1.0 - part };
        Vec3::new(0.064 * along, x.y, 2.0 * THICKNESS * (layer + part))
    };
    let mut random = Random::new(3);
    let shaken = |x: &Vec3| fold(x) + random.point(0.02 * THICKNESS);
    let from: Vec<Vec3> = mesh.positions().iter().map(shaken).collect();
    let to: Vec<Vec3> = from
        .iter()
        .map(|x| Vec3::new(x.x, x.y, 0.99 * x.z))
        .collect();
    let mut candidates = ClothCandidates::new(&mesh, Hierarchy::default());
    candidates.update(&from, &to, THICKNESS).unwrap();
    let found = candidates.vertex_triangle().len() + candidates.edge_edge().len();
    let paths = [&from[..], &to[..]];
    let (vt, ee) = brute_force(&mesh, candidates.edges(), paths, THICKNESS);
    let at_end =
        |vertices: &[u32]| -> Vec<Vec3> { vertices.iter().map(|&v| to[v as usize]).collect() };
    let near_triangles = vt.iter().filter(|[v, t]| {
        let x = at_end(&mesh.triangles()[*t as usize]);
        point_triangle(to[*v as usize], [x[0], x[1], x[2]]).distance() <= THICKNESS
    });
    let near_edges = ee.iter().filter(|pair| {
        let [e, f] = pair.map(|e| at_end(&candidates.edges()[e as usize]));
        edge_edge([e[0], e[1]], [f[0], f[1]]).distance() <= THICKNESS
    });
    let near = near_triangles.count() + near_edges.count();
    let boxes = vt.len() + ee.len();
    assert!(near > 5000 && 5 * near > 4 * found, "{found} for {near}");
    assert!(boxes > 2 * near, "{boxes} for {near}");
}
#[test]
fn bad_input_is_refused_by_name_and_changes_nothing() {
    let mesh = sheet(4);
    let rest = mesh.positions().to_vec();
    let mut candidates = ClothCandidates::new(&mesh, SpatialHash::default());
    candidates.update(&rest, &rest, 0.5).unwrap();
    let before = (
        candidates.vertex_triangle().to_vec(),
        candidates.edge_edge().to_vec(),
    );
    let mut bad = rest.clone();
    bad[9].y = f64::NAN;
    let vertex = 9;
    let refused = Err(CollideError::NonFinitePosition { vertex });
    assert_eq!(candidates.update(&bad, &rest, 0.5), refused);
    assert_eq!(candidates.update(&rest, &bad, 0.5), refused);
    for margin in [-1.0, f64::NAN, f64::INFINITY] {
        let error = candidates.update(&rest, &rest, margin).unwrap_err();
        assert!(error.to_string().contains("margin"), "{error}");
    }
    assert_eq!(candidates.vertex_triangle(), before.0);
    assert_eq!(candidates.edge_edge(), before.1);
}
