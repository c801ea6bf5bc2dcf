//! The prolongation P: trilinear hat functions on coarse lattices of cubes, one over each piece of the cloth at rest.

use cloth_core::element::Projective;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::block_matrix::BlockPattern;
use cloth_core::method::multigrid::Prolongation;
use std::collections::BTreeMap;

/// For every vertex the lattice nodes around it and their weights, which are trilinear and add up to 1: what moves
/// linearly over the rest shape is represented exactly, rotations of the whole among it.
#[derive(Debug)]
pub(crate) struct Lattice {
    pub(crate) prolongation: Prolongation,
    /// Positions of the nodes (m), piece after piece.
    pub(crate) node_positions: Vec<Vec3>,
}

impl Lattice {
    /// Lays `cells` cubes along the longest side of the box around each piece at rest (m), or so many fewer that there
    /// are two vertices to a node; `piece[v]` tells the piece of vertex v. One lattice over all of them would be
    /// coarser, the farther apart they are, and would couple those that lie on each other. Vertices that are not free
    /// get no weights, nodes near no free vertex no number.
    pub(crate) fn over(
        rest: &[Vec3],
        is_free: impl Fn(usize) -> bool,
        piece: &[u32],
        cells: u32,
    ) -> Self {
        let mut order: Vec<usize> = (0..rest.len()).collect();
        order.sort_by_key(|&vertex| piece[vertex]);
        let mut rows = vec![Vec::new(); rest.len()];
        let mut node_positions = Vec::new();
        for vertices in order.chunk_by(|&a, &b| piece[a] == piece[b]) {
            let mut cells = cells;
            let axes = axes(rest, vertices);
            let one = loop {
                let one = Piece::of(rest, vertices, &axes, &is_free, cells);
                // More nodes than that and few vertices between them: their motions depend on each other.
                if cells == 1 || 2 * one.nodes.len() <= vertices.len() {
                    break one;
                }
                cells -= 1;
            };
            let first = node_positions.len() as u32;
            for (&vertex, mut row) in vertices.iter().zip(one.rows) {
                row.iter_mut().for_each(|(node, _)| *node += first);
                rows[vertex] = row;
            }
            node_positions.extend(one.nodes);
        }
        Self {
            prolongation: Prolongation::new(rows.iter().map(|row| &row[..]), node_positions.len()),
            node_positions,
        }
    }
}

/// The lattice of one piece.
struct Piece {
    /// Nodes around each vertex of the piece, ascending, and their weights.
    rows: Vec<Vec<(u32, Real)>>,
    /// Positions of the nodes (m).
    nodes: Vec<Vec3>,
}

impl Piece {
    fn of(
        rest: &[Vec3],
        vertices: &[usize],
        axes: &Mat3,
        is_free: impl Fn(usize) -> bool,
        cells: u32,
    ) -> Self {
        let position = |vertex: usize| axes * rest[vertex];
        let positions = || vertices.iter().map(|&vertex| position(vertex));
        let low = positions().reduce(|a, b| a.inf(&b)).unwrap_or_default();
        let high = positions().reduce(|a, b| a.sup(&b)).unwrap_or_default();
        let extent = high - low;
        let side = extent.max() / Real::from(cells);
        // Along each axis: the node before, and how far beyond it.
        let locate = |x: Real, axis: usize| -> (u64, Real) {
            if extent[axis] <= FLAT * extent.max() {
                return (0, 0.0);
            }
            let at = (x - low[axis]) / side;
            let last = (extent[axis] / side - 1e-9).ceil().max(1.0) - 1.0;
            let node = at.floor().clamp(0.0, last);
            (node as u64, at - node)
        };
        let around = |vertex: usize| {
            let x = position(vertex);
            let places: [(u64, Real); 3] = std::array::from_fn(|axis| locate(x[axis], axis));
            let corners = (0..8u64).map(move |corner| {
                let (mut key, mut weight) = (0, 1.0);
                for (axis, (node, beyond)) in places.into_iter().enumerate() {
                    let bit = corner >> axis & 1;
                    key = key << 21 | (node + bit);
                    weight *= if bit == 1 { beyond } else { 1.0 - beyond };
                }
                (key, weight)
            });
            corners.filter(|(_, weight)| *weight > SMALLEST_WEIGHT)
        };
        let of_free = || vertices.iter().filter(|vertex| is_free(**vertex));
        let mut nodes: Vec<u64> = of_free().flat_map(|&v| around(v)).map(|(k, _)| k).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let number = |key: u64| nodes.binary_search(&key).unwrap_or_default() as u32;
        let row = |&vertex: &usize| {
            let mut row: Vec<(u32, Real)> = match is_free(vertex) {
                true => around(vertex).map(|(k, w)| (number(k), w)).collect(),
                false => Vec::new(),
            };
            row.sort_unstable_by_key(|entry| entry.0);
            row
        };
        let rows = vertices.iter().map(row).collect();
        let along = |key: u64, axis: u64| (key >> (21 * (2 - axis)) & ((1 << 21) - 1)) as Real;
        let node = |key: &u64| Vec3::new(along(*key, 0), along(*key, 1), along(*key, 2));
        let nodes = nodes
            .iter()
            .map(|key| axes.tr_mul(&(low + node(key) * side)));
        let nodes = nodes.collect();
        Self { rows, nodes }
    }
}

/// The axes of the lattice of a piece, as rows: those of space, but of a thin piece its normal and two across it. A
/// sheet that lies at an angle in cubes has more nodes around it than motions: `PᵀHP` would be singular.
fn axes(rest: &[Vec3], vertices: &[usize]) -> Mat3 {
    let count = vertices.len() as Real;
    let middle = vertices.iter().map(|&v| rest[v]).sum::<Vec3>() / count;
    let from_middle = vertices.iter().map(|&v| rest[v] - middle);
    let spread: Mat3 = from_middle.map(|d| d * d.transpose()).sum();
    let principal = spread.symmetric_eigen();
    let (least, most) = (principal.eigenvalues.imin(), principal.eigenvalues.max());
    let normal = principal.eigenvectors.column(least).into_owned();
    let is_thin = principal.eigenvalues[least] <= THIN * THIN * most;
    if !is_thin || normal.amax() > 1.0 - STRAIGHT {
        return Mat3::identity();
    }
    let along = Vec3::ith(normal.iamin(), 1.0);
    let first = (along - normal * normal.dot(&along)).normalize();
    let second = normal.cross(&first);
    Mat3::from_rows(&[first.transpose(), second.transpose(), normal.transpose()])
}

/// A 3 × 3 block column by column, each with a fourth number, so that sums are of whole registers.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
pub(crate) struct PaddedBlock([Real; 12]);

impl PaddedBlock {
    #[inline(always)]
    pub(crate) fn from(block: &Mat3) -> Self {
        let [[a, b, c], [d, e, f], [g, h, i]] = block.data.0;
        Self([a, b, c, 0.0, d, e, f, 0.0, g, h, i, 0.0])
    }

    /// `self += factor · other`.
    #[inline(always)]
    pub(crate) fn add(&mut self, other: &Self, factor: Real) {
        for lane in 0..12 {
            self.0[lane] += other.0[lane] * factor;
        }
    }

    pub(crate) fn block(&self) -> Mat3 {
        Mat3::from_fn(|row, column| self.0[4 * column + row])
    }
}

/// `S P` of all elements of a family: how much of each node (dimensionless if S is) goes into `z = S x`.
///
/// Elements near one another have the same nodes around them and add to the same blocks of a matrix on the lattice, so
/// those are listed once for all of them.
#[derive(Debug, Default)]
pub(crate) struct ElementProlongation {
    /// The list of each element.
    pub(crate) of_element: Vec<u32>,
    /// Slots of the blocks of some nodes, the lower half row by row, and how many nodes those are.
    lists: Vec<(Vec<u32>, u32)>,
    /// For each element, for each row of its operator, a number per node.
    columns: Vec<Real>,
}

impl ElementProlongation {
    pub(crate) fn of<const N: usize, const K: usize, E: Projective<N, K>>(
        elements: &[E],
        prolongation: &Prolongation,
        pattern: &BlockPattern,
    ) -> Self {
        let mut this = Self::default();
        let mut known: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
        for element in elements {
            let vertices = element.vertices();
            let of_corner = |vertex: u32| prolongation.of_fine(vertex as usize).iter();
            let mut nodes: Vec<u32> = vertices
                .into_iter()
                .flat_map(of_corner)
                .map(|n| n.0)
                .collect();
            nodes.sort_unstable();
            nodes.dedup();
            for row in element.operator() {
                let start = this.columns.len();
                this.columns.resize(start + nodes.len(), 0.0);
                for (vertex, g) in vertices.into_iter().zip(row) {
                    for &(node, weight) in of_corner(vertex) {
                        let at = nodes.binary_search(&node).unwrap_or_default();
                        this.columns[start + at] += g * weight;
                    }
                }
            }
            let next = known.len() as u32;
            let list = *known.entry(nodes).or_insert_with_key(|nodes| {
                let slot = |a: u32, b: u32| pattern.slot(a, b).expect("nodes of one element");
                let pairs = nodes.iter().enumerate();
                let slots = pairs.flat_map(|(i, &a)| nodes[..=i].iter().map(move |&b| slot(a, b)));
                this.lists.push((slots.collect(), nodes.len() as u32));
                next
            });
            this.of_element.push(list);
        }
        this
    }

    /// For each element in their order, the slots of the blocks of its nodes, the lower half row by row, and for each
    /// of the K rows of its operator a number per node.
    #[inline(always)]
    pub(crate) fn each<const K: usize>(&self) -> impl Iterator<Item = (&[u32], [&[Real]; K])> {
        let mut rest = &self.columns[..];
        self.of_element.iter().map(move |&list| {
            let (slots, count) = &self.lists[list as usize];
            let columns = [(); K].map(|()| {
                let (own, others) = rest.split_at(*count as usize);
                rest = others;
                own
            });
            (&slots[..], columns)
        })
    }
}

/// A box thinner than this fraction of its longest side is flat: one layer of nodes, no cells.
const FLAT: Real = 1e-6;
/// A piece is thin if it is less spread along its normal than this fraction of its largest spread, and straight in
/// space if its normal is along an axis but for this.
const THIN: Real = 0.1;
const STRAIGHT: Real = 1e-12;
/// Smaller weights are rounding.
const SMALLEST_WEIGHT: Real = 1e-9;
