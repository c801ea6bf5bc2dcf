//! Remedies against locking: what each gives and what it breaks, against closed forms.

use cloth_core::cloth::{
    BendingElements, Cloth, ClothError, ClothModel, Discretization, Elements, Membrane,
    MembraneElements, SpringEdges, SpringLaw,
};
use cloth_core::dof::{EdgeRank, perturbed};
use cloth_core::element::{Convexity, Energy};
use cloth_core::energy::CurvatureHinge;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{self, Diagonals, equilateral, grid, irregular};
use cloth_core::method::linear::{BlockCholesky, LinearSolver};
use cloth_core::topology::{EdgeTable, HingeTable, Midpoints, Topology, removable_edges};

const STIFF: Cloth = Cloth {
    areal_density: 0.2,
    membrane: Membrane::SpringStiffness(1e3),
    bending_rigidity: 0.0,
};

fn with(law: SpringLaw, edges: SpringEdges) -> Discretization {
    Discretization {
        law,
        edges,
        ..Discretization::default()
    }
}

/// Elastic energy (J) after a displacement of every vertex.
fn stored(model: &ClothModel, mesh: &TriMesh, place: impl Fn(&Vec3) -> Vec3) -> Real {
    let x: Vec<Vec3> = mesh.positions().iter().map(place).collect();
    model.energies().unwrap().value(&x)
}

/// `Σ ½ k (s − 1)² L²` over all edges at a stretch s: what linear springs store.
fn linear(mesh: &TriMesh, stretch: Real) -> Real {
    let edges = EdgeTable::build(mesh).unwrap();
    let x = mesh.positions();
    let squares = |&[a, b]: &[u32; 2]| (x[a as usize] - x[b as usize]).norm_squared();
    let sum: Real = edges.ends().iter().map(squares).sum();
    0.5e3 * (stretch - 1.0).powi(2) * sum
}

fn sheets() -> [TriMesh; 5] {
    [
        grid(9, 9, 1.0, 1.0, Diagonals::OneWay).unwrap(),
        grid(9, 9, 1.0, 1.0, Diagonals::Alternating).unwrap(),
        grid(9, 9, 1.0, 1.0, Diagonals::Crossed).unwrap(),
        equilateral(9, 9, 0.125).unwrap(),
        irregular(9, 1.0, 1.0, 3).unwrap(),
    ]
}

#[test]
fn weaker_springs_under_compression_are_weaker_only_there() {
    for mesh in sheets() {
        for share in [0.0, 0.1, 0.7, 1.0] {
            let discretization = with(SpringLaw::Compression(share), SpringEdges::All);
            let model = STIFF.discretized_with(&discretization, &mesh).unwrap();
            for (stretch, expected) in [(1.02, 1.0), (0.97, share)] {
                let energy = stored(&model, &mesh, |p| p * stretch);
                let wanted = expected * linear(&mesh, stretch);
                assert!((energy - wanted).abs() <= 1e-12 * linear(&mesh, stretch));
            }
        }
    }
}

#[test]
fn slack_springs_resist_only_what_exceeds_their_range() {
    let mesh = equilateral(9, 9, 0.125).unwrap();
    let discretization = with(SpringLaw::DeadZone([0.98, 1.03]), SpringEdges::All);
    let model = STIFF.discretized_with(&discretization, &mesh).unwrap();
    for free in [0.981, 1.0, 1.0299] {
        assert_eq!(stored(&model, &mesh, |p| p * free), 0.0);
    }
    for (stretch, excess) in [(1.05, 1.02), (0.95, 0.97)] {
        let energy = stored(&model, &mesh, |p| p * stretch);
        assert!((energy / linear(&mesh, excess) - 1.0).abs() < 1e-11);
    }
}

/// Triangles with slack cost nothing while both principal stretches are in the range, sheared or not, and beyond it
/// what ARAP triangles cost of the rest.
#[test]
fn slack_triangles_resist_what_exceeds_their_range_in_every_direction() {
    let mesh = equilateral(9, 9, 0.125).unwrap();
    let with_law = |law| Discretization {
        membrane: MembraneElements::Arap,
        law,
        ..Discretization::default()
    };
    let model = |law| STIFF.discretized_with(&with_law(law), &mesh).unwrap();
    let (slack, stiff) = (
        model(SpringLaw::DeadZone([0.98, 1.03])),
        model(SpringLaw::Linear),
    );
    for turn in [0.0, 0.4, 1.1] {
        let axis = Vec3::new(f64::cos(turn), f64::sin(turn), 0.0);
        let along = |stretch: f64| move |p: &Vec3| p + axis * (axis.dot(p) * (stretch - 1.0));
        for free in [0.981, 1.0, 1.0299] {
            assert!(stored(&slack, &mesh, along(free)) < 1e-25);
        }
        for (stretch, excess) in [(1.05, 1.02), (0.95, 0.97)] {
            let ratio =
                stored(&slack, &mesh, along(stretch)) / stored(&stiff, &mesh, along(excess));
            assert!((ratio - 1.0).abs() < 1e-9, "{turn} {stretch}: {ratio}");
        }
    }
}

#[test]
fn no_triangle_loses_two_edges_and_the_count_is_reached() {
    for mesh in sheets() {
        let edges = EdgeTable::build(&mesh).unwrap();
        let order = removable_edges(&mesh, &edges);
        let mut lost = vec![0; mesh.triangle_count()];
        for &edge in &order {
            assert!(!edges.is_boundary(edge as usize));
            for t in edges.sides()[edge as usize] {
                lost[t as usize] += 1;
            }
        }
        assert!(lost.iter().all(|&n| n <= 1));
        // Nothing more could go: every inner edge has a triangle that has lost one.
        for edge in (0..edges.len()).filter(|&e| !edges.is_boundary(e)) {
            assert!(edges.sides()[edge].iter().any(|&t| lost[t as usize] == 1));
        }
        let coordinates = 3 * mesh.vertex_count();
        let counted = |kind: SpringEdges| {
            let model = STIFF.discretized_with(&with(SpringLaw::Linear, kind), &mesh);
            coordinates - model.unwrap().springs.len()
        };
        let (least, most) = (
            coordinates - edges.len(),
            coordinates - edges.len() + order.len(),
        );
        assert_eq!(counted(SpringEdges::Quads), most);
        assert_eq!(counted(SpringEdges::DofFraction(0.0)), least);
        let wanted = 0.5 * (least + most) as Real / coordinates as Real;
        let reached = counted(SpringEdges::DofFraction(wanted)) as Real / coordinates as Real;
        assert!(wanted <= reached && reached < wanted + 1.0 / coordinates as Real);
    }
}

/// First the edges that come nearest to being the longest of both their triangles; the sheet that is to have a given
/// freedom loses the first of them.
#[test]
fn edges_go_in_the_order_of_their_length_beside_their_triangles() {
    for mesh in sheets() {
        let edges = EdgeTable::build(&mesh).unwrap();
        let x = mesh.positions();
        let squared = |[a, b]: [u32; 2]| (x[a as usize] - x[b as usize]).norm_squared();
        // The smaller of its two shares in the square of the longest side.
        let share = |edge: u32| {
            let of = |t: u32| {
                let [a, b, c] = mesh.triangles()[t as usize];
                [[a, b], [b, c], [c, a]]
                    .map(squared)
                    .into_iter()
                    .fold(0.0, Real::max)
            };
            let [one, other] = edges.sides()[edge as usize].map(of);
            squared(edges.ends()[edge as usize]) / one.max(other)
        };
        let order = removable_edges(&mesh, &edges);
        assert!(
            order
                .windows(2)
                .all(|pair| share(pair[0]) > share(pair[1]) - 2e-9)
        );
        // What is passed over has, in one of its triangles, an edge that went before it.
        for edge in (0..edges.len() as u32).filter(|&e| !edges.is_boundary(e as usize)) {
            let rivals = order.iter().filter(|&&gone| {
                let [a, b] = [edge, gone].map(|e| edges.sides()[e as usize]);
                a.iter().any(|t| b.contains(t))
            });
            let longest = rivals.map(|&gone| share(gone)).fold(0.0, Real::max);
            assert!(longest > share(edge) - 2e-9);
        }
        let coordinates = 3 * mesh.vertex_count();
        let count = order.len() / 3;
        let freedom = (coordinates - edges.len() + count) as Real / coordinates as Real;
        let discretization = with(SpringLaw::Linear, SpringEdges::DofFraction(freedom - 1e-9));
        let model = STIFF.discretized_with(&discretization, &mesh).unwrap();
        let is_left = |&edge: &u32| {
            let ends = edges.ends()[edge as usize];
            model.springs.iter().any(|s| s.vertices == ends)
        };
        assert!(!order[..count].iter().any(is_left));
        assert!(order[count..].iter().all(is_left));
    }
}

/// Half of the diagonals of a grid: about half of them in every part of it, and no part is left as stiff as it was.
#[test]
fn a_part_of_the_edges_is_taken_from_the_whole_sheet() {
    let mesh = grid(33, 33, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    let order = removable_edges(&mesh, &edges);
    assert_eq!(order.len(), 1024);
    let mut lost = [[0; 4]; 4];
    for &edge in &order[..512] {
        let [a, b] = edges.ends()[edge as usize].map(|v| mesh.positions()[v as usize]);
        let middle = (a + b) * 2.0;
        lost[middle.x as usize][middle.y as usize] += 1;
    }
    // Of 64 each; chance alone would spread them by 4.
    let (least, most) = (lost.iter().flatten().min(), lost.iter().flatten().max());
    assert!(least >= Some(&20) && most <= Some(&44), "{lost:?}");
}

/// The edges left on a grid are those of its cells; on a bent sheet they are independent.
#[test]
fn quads_have_a_third_of_the_coordinates_free() {
    let n = 9;
    for diagonals in [Diagonals::OneWay, Diagonals::Alternating] {
        let mesh = grid(n, n, 1.0, 1.0, diagonals).unwrap();
        let model = STIFF
            .discretized_with(&with(SpringLaw::Linear, SpringEdges::Quads), &mesh)
            .unwrap();
        assert_eq!(model.springs.len(), 2 * n * (n - 1));
        let cell = 1.0 / (n as Real - 1.0);
        assert!(
            model
                .springs
                .iter()
                .all(|s| (s.rest_length - cell).abs() < 1e-12)
        );
        let ends: Vec<[u32; 2]> = model.springs.iter().map(|s| s.vertices).collect();
        let rank = EdgeRank::of_pairs(&perturbed(mesh.positions()), &ends).unwrap();
        assert_eq!(rank.nullity, 3 * n * n - 2 * n * (n - 1));
    }
}

/// What the subset breaks: of the modulus of shear k/2 that one diagonal a cell gives, the share of diagonals that are
/// left; with none left, nothing resists.
#[test]
fn shear_stiffness_goes_with_the_diagonals_and_axial_stiffness_stays() {
    let n = 33;
    let strain = 1e-4;
    let mesh = grid(n, n, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    let cells = (n - 1) * (n - 1);
    let shear = |kind: SpringEdges| {
        let model = STIFF
            .discretized_with(&with(SpringLaw::Linear, kind), &mesh)
            .unwrap();
        let energy = stored(&model, &mesh, |p| p + Vec3::x() * (strain * p.y));
        let share = (model.springs.len() - 2 * n * (n - 1)) as Real / cells as Real;
        // ½ G γ² per area, G = k/2 for one diagonal of length √2 cells in every cell.
        (energy / (0.5 * strain * strain * 500.0), share)
    };
    let full = (3 * n * n - edges.len()) as Real / (3 * n * n) as Real;
    for freedom in [full, 0.15, 0.25] {
        let (modulus, share) = shear(SpringEdges::DofFraction(freedom));
        assert!((modulus / share - 1.0).abs() < 2e-4, "{modulus} {share}");
    }
    let (modulus, share) = shear(SpringEdges::Quads);
    assert_eq!(share, 0.0);
    assert!(modulus < 1e-7, "{modulus:e}");
    // Pulled along x: k of the lines along x, the same with and without diagonals across.
    let quads = STIFF
        .discretized_with(&with(SpringLaw::Linear, SpringEdges::Quads), &mesh)
        .unwrap();
    let pull = stored(&quads, &mesh, |p| p + Vec3::x() * (strain * p.x));
    // n lines of length 1 m, each ½ k L ε² (n − 1) springs of L = 1/(n − 1).
    let expected = 0.5e3 * strain * strain * n as Real / (n as Real - 1.0);
    assert!((pull / expected - 1.0).abs() < 1e-9);
}

#[test]
fn midpoints_have_e_and_e_b_motions() {
    for mesh in [
        grid(7, 6, 1.0, 1.0, Diagonals::OneWay).unwrap(),
        generate::disk(4, 1.0).unwrap(),
        generate::tube(8, 4, 0.3, 1.0).unwrap(),
        irregular(7, 1.0, 1.0, 3).unwrap(),
    ] {
        let edges = EdgeTable::build(&mesh).unwrap();
        let topology = Topology::of(&mesh, &edges);
        let small = Midpoints::of(&mesh, &edges).unwrap();
        let sides = EdgeTable::build(small.mesh()).unwrap();
        assert_eq!(small.mesh().vertex_count(), topology.edges);
        assert_eq!(sides.len(), 3 * topology.faces);
        let x = small.between(&perturbed(mesh.positions()));
        let rank = EdgeRank::measure(&x, &sides).unwrap();
        assert_eq!(rank.nullity, topology.edges + topology.boundary_edges);
        assert_eq!(rank.self_stresses, 0);
    }
}

/// On positions that fit together at the vertices, midpoints cost what vertices cost.
#[test]
fn midpoints_of_vertices_store_the_energy_of_the_vertices() {
    for mesh in sheets() {
        let x = perturbed(mesh.positions());
        for membrane in [
            MembraneElements::Springs,
            MembraneElements::Stvk { poisson_ratio: 0.3 },
            MembraneElements::Arap,
        ] {
            for resistance in [Membrane::SpringStiffness(1e3), Membrane::Modulus(1e3)] {
                let cloth = Cloth {
                    membrane: resistance,
                    ..STIFF
                };
                let discretization = Discretization {
                    membrane,
                    ..Discretization::default()
                };
                let whole = cloth.discretized_with(&discretization, &mesh).unwrap();
                let halves = cloth.on_midpoints(membrane, &mesh).unwrap();
                let y = halves.midpoints.between(&x);
                let [a, b] = [
                    whole.energies().unwrap().value(&x),
                    halves.model.energies().unwrap().value(&y),
                ];
                assert!((a / b - 1.0).abs() < 1e-10, "{membrane:?}: {a} {b}");
            }
        }
        // The hinge of midpoints with k is that of vertices with k; they differ in what k means.
        let edges = EdgeTable::build(&mesh).unwrap();
        let bending = Cloth {
            membrane: Membrane::SpringStiffness(0.0),
            bending_rigidity: 1.0,
            ..STIFF
        };
        let halves = bending
            .on_midpoints(MembraneElements::Springs, &mesh)
            .unwrap();
        let mut of_vertices = cloth_core::method::family::Energies::new(mesh.vertex_count());
        let hinges = CurvatureHinge::across(&mesh, &HingeTable::build(&mesh, &edges), 3.0);
        of_vertices = of_vertices.with(hinges).unwrap();
        let y = halves.midpoints.between(&x);
        let [a, b] = [
            of_vertices.value(&x),
            halves.model.energies().unwrap().value(&y),
        ];
        assert!((a / b - 1.0).abs() < 1e-10, "{a} {b}");
        // Masses: a third of every triangle at each of its edges.
        let total: Real = halves.model.particles.mass().iter().sum();
        assert!((total / (0.2 * mesh.area()) - 1.0).abs() < 1e-12);
        // And back.
        let back = halves.midpoints.vertices(&y);
        let apart = back.iter().zip(&x).map(|(a, b)| (a - b).norm());
        assert!(apart.fold(0.0, Real::max) < 1e-13);
        // All triangles agree there: the middles between these vertices are the midpoints themselves.
        let again = halves.midpoints.between(&back);
        let gaps = again.iter().zip(&y).map(|(a, b)| (a - b).norm());
        assert!(gaps.fold(0.0, Real::max) < 1e-13);
    }
}

/// What k of the midpoint hinge means: once the midpoints have settled, a cylinder costs ½ k κ² per area, and so does
/// one about any other axis.
#[test]
fn the_coefficient_of_midpoint_hinges_is_the_rigidity() {
    for angle in [0.0, 0.4, 1.1] {
        // The rim is held where the midpoints cannot settle; its part falls with the size of the sheet.
        let [coarse, fine] = [24, 48].map(|n| settled_factor(n, angle) - 1.0);
        assert!(fine.abs() < 1e-2, "{angle}: {fine}");
        assert!(fine.abs() < 0.7 * coarse.abs(), "{angle}: {coarse}, {fine}");
    }
}

/// Energy per area of a cylinder about an axis at `angle` (rad), over ½ k κ², in the inner quarter of a sheet of n × n
/// equilateral cells.
fn settled_factor(n: usize, angle: Real) -> Real {
    const RIGIDITY: Real = 2.0;
    const CURVATURE: Real = 1e-3;
    let triangles = equilateral(n, n, 1.0).unwrap();
    let cloth = Cloth {
        membrane: Membrane::SpringStiffness(0.0),
        bending_rigidity: RIGIDITY,
        ..STIFF
    };
    let cut = cloth
        .on_midpoints(MembraneElements::Springs, &triangles)
        .unwrap();
    let size = n as Real - 1.0;
    let is_inside = |p: &Vec3, margin: Real| {
        let height = size * 0.75_f64.sqrt();
        let sides = [p.x - 0.5, size - p.x, p.y, height - p.y];
        sides.iter().all(|&d| d > margin)
    };
    let axis = Vec3::new(-angle.sin(), angle.cos(), 0.0);
    let raised = |p: &Vec3| p + Vec3::z() * (0.5 * CURVATURE * axis.dot(p).powi(2));
    let flat = cut.midpoints.mesh().positions();
    let mut x: Vec<Vec3> = flat.iter().map(raised).collect();
    let is_free: Vec<bool> = flat.iter().map(|p| is_inside(p, 2.5)).collect();
    // Quadratic: one Newton step is the minimum.
    let energies = cut.model.energies().unwrap();
    let hessian = energies.hessian(&x, Convexity::Exact);
    let mut gradient = vec![Vec3::zeros(); x.len()];
    energies.add_gradient(&x, &mut gradient);
    let mut cholesky = BlockCholesky::analyze(hessian.pattern(), &is_free).unwrap();
    LinearSolver::prepare(&mut cholesky, &hessian).unwrap();
    let mut step = vec![Vec3::zeros(); x.len()];
    LinearSolver::solve(&mut cholesky, &hessian, &gradient, &mut step).unwrap();
    for (point, moved) in x.iter_mut().zip(&step) {
        *point -= moved;
    }
    let Some(Elements::Midpoint(hinges)) = cut.model.others.last() else {
        panic!("{:?}", cut.model.others)
    };
    let (mut energy, mut area) = (0.0, 0.0);
    for hinge in hinges {
        let points = gather(&x, hinge.vertices);
        if points.iter().all(|p| is_inside(p, 0.25 * size)) {
            energy += hinge.value(&points);
            area += RIGIDITY / hinge.stiffness; // (A₀ + A₁)/3 = k/K
        }
    }
    energy / area / (0.5 * RIGIDITY * CURVATURE * CURVATURE)
}

#[test]
fn relief_that_does_not_fit_is_refused_with_numbers() {
    let mesh = grid(5, 5, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let refused = |discretization: Discretization| {
        STIFF.discretized_with(&discretization, &mesh).unwrap_err()
    };
    let quads = with(SpringLaw::Linear, SpringEdges::Quads);
    for discretization in [
        Discretization {
            membrane: MembraneElements::Arap,
            ..quads
        },
        Discretization {
            shear: Some(1.0),
            ..with(SpringLaw::Compression(0.5), SpringEdges::All)
        },
    ] {
        assert_eq!(
            refused(discretization),
            ClothError::LockingRemedyWithoutSprings
        );
    }
    for (law, word) in [
        (SpringLaw::Compression(1.5), "1.5"),
        (SpringLaw::Compression(-0.5), "-0.5"),
        (SpringLaw::Compression(Real::NAN), "NaN"),
        (SpringLaw::DeadZone([1.1, 1.2]), "1.1"),
        (SpringLaw::DeadZone([0.9, Real::INFINITY]), "inf"),
        (SpringLaw::DeadZone([-0.1, 1.0]), "-0.1"),
    ] {
        let words = refused(with(law, SpringEdges::All)).to_string();
        assert!(words.contains(word), "{words}");
    }
    // 75 coordinates, 56 edges, 16 diagonals.
    let too_many = with(SpringLaw::Linear, SpringEdges::DofFraction(0.5));
    assert_eq!(
        refused(too_many),
        ClothError::DofFraction {
            fraction: 0.5,
            most: 19.0 / 75.0 + 16.0 / 75.0
        }
    );
    let bad = Cloth {
        areal_density: 0.2,
        ..STIFF
    };
    let beyond = MembraneElements::Stvk { poisson_ratio: 2.0 };
    assert_eq!(
        bad.on_midpoints(beyond, &mesh).unwrap_err(),
        ClothError::PoissonRatio(2.0)
    );
    let none = Discretization {
        bending: BendingElements::None,
        ..with(SpringLaw::Compression(0.0), SpringEdges::All)
    };
    let model = STIFF.discretized_with(&none, &mesh).unwrap();
    assert!(model.springs.is_empty() && model.families().len() == 1);
}
