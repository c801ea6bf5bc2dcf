//! The share of one family in the matrix of the coarse grid.

use crate::coarse::shorten;
use crate::lattice::Lattice;
use crate::local::apply;
use crate::pulls::{BLOCK, Packed, resistances_on_spheres};
use cloth_core::block_matrix::{BlockMatrix, BlockPattern};
use cloth_core::element::Projective;
use cloth_core::math::{Mat3, Real, Vec3, gather};
use cloth_core::wide::wide;

/// Elements with the same nodes under them, one after another: their sum is formed in a small dense matrix and added to the large one once.
#[derive(Debug, Default)]
pub(crate) struct CoarseFamily {
    groups: Vec<Group>,
    /// Elements, group by group.
    order: Vec<u32>,
    /// `G P` of each element in that order: K numbers per node of its group.
    coefficients: Vec<Real>,
    nodes: Vec<u32>,
    /// Places in the matrix of the pairs of nodes of each group, the lower half row by row.
    slots: Vec<u32>,
    sum: Vec<Mat3>,
    packed: Vec<Packed>,
}

#[derive(Clone, Copy, Debug)]
struct Group {
    /// Ends in `order`, `coefficients`, `nodes` and `slots`; each begins where the group before ends.
    ends: [u32; 4],
}

impl CoarseFamily {
    /// Groups the elements, and adds the pairs of nodes that they tie together.
    pub(crate) fn new<const N: usize, const K: usize, E: Projective<N, K>>(
        elements: &[E],
        lattice: &Lattice,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Self {
        let mut offsets = vec![0];
        let mut nodes: Vec<u32> = Vec::new();
        for element in elements {
            let start = nodes.len();
            for vertex in element.vertices() {
                nodes.extend(lattice.of(vertex as usize).iter().map(|entry| entry.0));
            }
            nodes[start..].sort_unstable();
            let mut end = start;
            for at in start..nodes.len() {
                if end == start || nodes[end - 1] != nodes[at] {
                    nodes[end] = nodes[at];
                    end += 1;
                }
            }
            nodes.truncate(end);
            offsets.push(end);
        }
        let list = |element: u32| {
            let element = element as usize;
            &nodes[offsets[element]..offsets[element + 1]]
        };
        let mut order: Vec<u32> = (0..elements.len() as u32).collect();
        order.sort_by(|&a, &b| list(a).cmp(list(b)));
        let mut this = Self::default();
        for same in order.chunk_by(|&a, &b| list(a) == list(b)) {
            let list = list(same[0]);
            for &element in same {
                this.add_coefficients(&elements[element as usize], lattice, list);
            }
            for (i, &a) in list.iter().enumerate() {
                pairs.extend(list[..i].iter().map(|&b| [a, b]));
            }
            shorten(pairs, false);
            this.order.extend_from_slice(same);
            this.nodes.extend_from_slice(list);
            let slot_count = this.groups.last().map_or(0, |group| group.ends[3] as usize)
                + list.len() * (list.len() + 1) / 2;
            this.groups.push(Group {
                ends: [
                    this.order.len() as u32,
                    this.coefficients.len() as u32,
                    this.nodes.len() as u32,
                    slot_count as u32,
                ],
            });
        }
        this
    }

    fn add_coefficients<const N: usize, const K: usize, E: Projective<N, K>>(
        &mut self,
        element: &E,
        lattice: &Lattice,
        nodes: &[u32],
    ) {
        let start = self.coefficients.len();
        self.coefficients.resize(start + nodes.len() * K, 0.0);
        let operator = element.operator();
        for (i, vertex) in element.vertices().into_iter().enumerate() {
            for (node, weight) in lattice.of(vertex as usize) {
                let at = nodes.binary_search(node).expect("a node of the group");
                for k in 0..K {
                    self.coefficients[start + at * K + k] += operator[k][i] * weight;
                }
            }
        }
    }

    /// Looks up the places of all pairs.
    pub(crate) fn bind(&mut self, pattern: &BlockPattern) {
        let mut start = 0;
        for group in &self.groups {
            let nodes = &self.nodes[start..group.ends[2] as usize];
            for (i, &a) in nodes.iter().enumerate() {
                let slot = |&b: &u32| pattern.slot(a, b).expect("a pair of the pattern");
                self.slots.extend(nodes[..=i].iter().map(slot));
            }
            start = group.ends[2] as usize;
        }
        let most = self.groups.iter().scan(0, |start, group| {
            let count = group.ends[3] - *start;
            *start = group.ends[3];
            Some(count as usize)
        });
        let most = most.max().unwrap_or(0);
        self.sum = vec![Mat3::zeros(); most];
        self.packed = vec![[0.0; 8]; most];
    }

    /// Adds `Pᵀ (Σ w Gᵀ (I − ∂p/∂z) G) P` at x (m) to `out` (N/m).
    pub(crate) fn add_stiffness<const N: usize, const K: usize, E: Projective<N, K>>(
        &mut self,
        elements: &[E],
        are_spheres: bool,
        x: &[Vec3],
        out: &mut BlockMatrix,
    ) {
        wide(
            #[inline(always)]
            || {
                let mut starts = [0; 4];
                for group in &self.groups {
                    let ends = group.ends.map(|end| end as usize);
                    let node_count = ends[2] - starts[2];
                    let slots = &self.slots[starts[3]..ends[3]];
                    if node_count == 0 {
                        starts = ends; // prescribed vertices only
                        continue;
                    }
                    let sum = &mut self.sum[..slots.len()];
                    sum.fill(Mat3::zeros());
                    let packed = &mut self.packed[..slots.len()];
                    packed.fill([0.0; 8]);
                    let mut coefficients =
                        self.coefficients[starts[1]..ends[1]].chunks_exact(node_count * K);
                    for block in self.order[starts[0]..ends[0]].chunks(BLOCK) {
                        let block = block.iter().map(|&element| &elements[element as usize]);
                        let on_spheres = if are_spheres {
                            resistances_on_spheres(block.clone(), x)
                        } else {
                            None
                        };
                        if let Some(resistances) = on_spheres {
                            let coefficients = coefficients.by_ref().take(block.len());
                            for (resistance, coefficients) in resistances.iter().zip(coefficients) {
                                add_symmetric_products(resistance, coefficients, packed);
                            }
                            continue;
                        }
                        for (element, coefficients) in block.zip(coefficients.by_ref()) {
                            let z = apply(&element.operator(), &gather(x, element.vertices()));
                            let weight = element.weight();
                            let resistance = element.resistance(z);
                            let resistance = resistance.map(|row| row.map(|block| block * weight));
                            add_products(&resistance, coefficients, sum);
                        }
                    }
                    for (sum, packed) in sum.iter_mut().zip(packed) {
                        *sum += unpacked(packed);
                    }
                    for (slot, sum) in slots.iter().zip(sum.iter()) {
                        out.blocks_mut()[*slot as usize] += sum;
                    }
                    starts = ends;
                }
            },
        );
    }
}

/// Adds `Σₖₗ cₐₖ c_bₗ Sₖₗ` to the block of each pair of nodes a ≥ b.
#[inline(always)]
fn add_products<const K: usize>(
    resistance: &[[Mat3; K]; K],
    coefficients: &[Real],
    sum: &mut [Mat3],
) {
    let mut blocks = sum.iter_mut();
    for (i, a) in coefficients.chunks_exact(K).enumerate() {
        let mut row = [Mat3::zeros(); K];
        for l in 0..K {
            for k in 0..K {
                row[l] += resistance[k][l] * a[k];
            }
        }
        for b in coefficients.chunks_exact(K).take(i + 1) {
            let Some(block) = blocks.next() else { return };
            for l in 0..K {
                *block += row[l] * b[l];
            }
        }
    }
}

/// The same for one row, whose products are symmetric.
#[inline(always)]
fn add_symmetric_products(resistance: &Packed, coefficients: &[Real], sum: &mut [Packed]) {
    let mut blocks = sum.iter_mut();
    for (i, a) in coefficients.iter().enumerate() {
        let row = resistance.map(|entry| entry * a);
        for b in &coefficients[..=i] {
            let Some(block) = blocks.next() else { return };
            for lane in 0..8 {
                block[lane] += row[lane] * b;
            }
        }
    }
}

#[inline(always)]
fn unpacked(&[xx, yx, zx, yy, zy, zz, ..]: &Packed) -> Mat3 {
    Mat3::new(xx, yx, zx, yx, yy, zy, zx, zy, zz)
}
