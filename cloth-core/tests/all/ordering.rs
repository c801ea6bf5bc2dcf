//! Vertex orderings: what they are good for, and the way back.

use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, disk, grid, irregular, join, sphere};
use cloth_core::method::ordering::Order;
use cloth_core::random::SplitMix64;
use cloth_core::topology::{EdgeTable, Topology};
use proptest::prelude::*;

/// The same surface with vertices in an order without any sense.
fn shuffled(mesh: &TriMesh) -> TriMesh {
    let n = mesh.vertex_count() as u64;
    // A step without a common divisor with n visits every vertex once; mixing two such walks by
    // parity would be no better at hiding neighbours.
    let gcd = |mut a: u64, mut b: u64| {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let step = (n * 5 / 13..).find(|&s| s > 1 && gcd(s, n) == 1).unwrap();
    let place = |v: u32| ((u64::from(v) * step + 17) % n) as u32;
    let mut positions = vec![Vec3::zeros(); mesh.vertex_count()];
    for (p, v) in mesh.positions().iter().zip(0..) {
        positions[place(v) as usize] = *p;
    }
    let triangles = mesh.triangles().iter().map(|t| t.map(place));
    TriMesh::new(positions, triangles.collect()).unwrap()
}

fn bandwidth(mesh: &TriMesh) -> usize {
    let edges = EdgeTable::build(mesh).unwrap();
    Order::identity(mesh.vertex_count()).bandwidth(&edges)
}

/// Mean difference of the numbers of neighbours.
fn mean_distance(mesh: &TriMesh) -> f64 {
    let edges = EdgeTable::build(mesh).unwrap();
    let sum: u64 = edges.ends().iter().map(|[a, b]| u64::from(b - a)).sum();
    sum as f64 / edges.len() as f64
}

fn cuthill_mckee(mesh: &TriMesh) -> Order {
    Order::reverse_cuthill_mckee(mesh.vertex_count(), &EdgeTable::build(mesh).unwrap())
}

fn is_permutation(order: &Order) -> bool {
    let there_and_back =
        |v: usize| order.new_of_old()[order.old_of_new()[v] as usize] as usize == v;
    order.new_of_old().len() == order.old_of_new().len() && (0..order.len()).all(there_and_back)
}

#[test]
fn cuthill_mckee_brings_a_shuffled_grid_near_its_short_side() {
    for (columns, rows) in [(40, 40), (90, 20), (20, 90)] {
        let mesh = shuffled(&grid(columns, rows, 1.0, 1.0, Diagonals::OneWay).unwrap());
        assert!(bandwidth(&mesh) > 10 * columns.min(rows));
        let order = cuthill_mckee(&mesh);
        let edges = EdgeTable::build(&mesh).unwrap();
        // No numbering is better than the short side; diagonals allow level sets twice as long.
        let reached = order.bandwidth(&edges);
        assert!(
            reached <= 2 * columns.min(rows) + 2,
            "{columns} × {rows}: {reached}"
        );
        assert_eq!(bandwidth(&order.reorder_mesh(&mesh)), reached);
    }
}

#[test]
fn both_orders_bring_neighbours_together() {
    for mesh in [
        irregular(50, 1.0, 1.0, 1).unwrap(),
        sphere(15, 1.0).unwrap(),
    ] {
        let mesh = shuffled(&mesh);
        for order in [Order::morton(mesh.positions()), cuthill_mckee(&mesh)] {
            assert!(is_permutation(&order));
            assert!(mean_distance(&order.reorder_mesh(&mesh)) < 0.15 * mean_distance(&mesh));
        }
    }
}

#[test]
fn results_come_back_in_the_callers_order() {
    let mesh = shuffled(&disk(12, 1.0).unwrap());
    for order in [
        Order::identity(mesh.vertex_count()),
        Order::morton(mesh.positions()),
        cuthill_mckee(&mesh),
    ] {
        let sorted = order.apply(mesh.positions());
        assert_eq!(order.restore(&sorted), mesh.positions());
    }
}

#[test]
fn reordering_changes_numbers_only() {
    let mesh = shuffled(&irregular(12, 1.0, 1.0, 9).unwrap());
    let order = Order::morton(mesh.positions());
    let sorted = order.reorder_mesh(&mesh);
    let count = |m: &TriMesh| Topology::of(m, &EdgeTable::build(m).unwrap());
    assert_eq!(count(&sorted), count(&mesh));
    // The same triangles with the same winding, and the same bits of area.
    let mut here: Vec<_> = mesh
        .triangles()
        .iter()
        .map(|&t| order.renumber(t))
        .collect();
    let mut there = sorted.triangles().to_vec();
    here.sort_unstable();
    there.sort_unstable();
    assert_eq!(here, there);
    let lowest: Vec<u32> = sorted
        .triangles()
        .iter()
        .map(|t| *t.iter().min().unwrap())
        .collect();
    assert!(lowest.is_sorted());
    let bits = |m: &TriMesh| {
        let mut bits: Vec<u64> = m.areas().map(f64::to_bits).collect();
        bits.sort_unstable();
        bits
    };
    assert_eq!(bits(&sorted), bits(&mesh));
}

#[test]
fn every_piece_is_numbered() {
    let piece = sphere(3, 1.0).unwrap();
    let two = shuffled(&join(&[piece.clone(), disk(5, 1.0).unwrap(), piece]).unwrap());
    assert!(is_permutation(&cuthill_mckee(&two)));
}

/// Bit k of a coordinate is bit 3 k of the place along the curve, with those of the other two between.
#[test]
fn morton_interleaves_every_bit() {
    let code = |cell: &[u32; 3]| {
        let bit = |k: usize| u64::from(cell[k % 3] >> (k / 3) & 1) << k;
        (0..63).map(bit).sum::<u64>()
    };
    let last = (1 << 21) - 1;
    let mut cells = vec![[0; 3], [last; 3]];
    for bit in 0..21 {
        cells.extend(
            [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]].map(|axes| axes.map(|a| a << bit)),
        );
    }
    let mut random = SplitMix64::new(1);
    let mut some = || (random.next_bits() >> 43) as u32;
    cells.extend((0..1000).map(|_| [some(), some(), some()]));
    let positions: Vec<Vec3> = cells
        .iter()
        .map(|cell| Vec3::from(cell.map(f64::from)))
        .collect();
    let mut expected: Vec<u32> = (0..cells.len() as u32).collect();
    expected.sort_by_key(|&v| code(&cells[v as usize]));
    assert_eq!(Order::morton(&positions).old_of_new(), expected);
}

#[test]
fn morton_follows_the_curve() {
    let corner = |x: u8, y: u8, z: u8| Vec3::new(x.into(), y.into(), z.into());
    let cube: Vec<Vec3> = (0..8_u8)
        .map(|k| corner(k & 1, k >> 1 & 1, k >> 2))
        .collect();
    assert_eq!(Order::morton(&cube), Order::identity(8));
    let reversed: Vec<Vec3> = cube.iter().rev().copied().collect();
    assert_eq!(Order::morton(&reversed).apply(&reversed), cube);
}

#[test]
fn equal_and_odd_positions_do_no_harm() {
    assert!(Order::morton(&[]).is_empty());
    assert_eq!(Order::morton(&[Vec3::repeat(2.0); 5]), Order::identity(5));
    let odd = [
        f64::NAN,
        1.0,
        f64::INFINITY,
        f64::MAX,
        -f64::MAX,
        0.0,
        f64::NEG_INFINITY,
    ];
    assert!(is_permutation(&Order::morton(&odd.map(Vec3::repeat))));
}

#[test]
#[should_panic(expected = "one value per vertex")]
fn a_wrong_length_is_a_bug_of_the_caller() {
    let _ = Order::identity(3).apply(&[1, 2]);
}

proptest! {
    #[test]
    fn morton_is_a_permutation_of_anything(
        coordinates in prop::collection::vec(prop::array::uniform3(any::<f64>()), 0..50)
    ) {
        let positions: Vec<Vec3> = coordinates.into_iter().map(Vec3::from).collect();
        prop_assert!(is_permutation(&Order::morton(&positions)));
    }
}
