//! The share of one family in the matrix of the coarse grid.

use crate::coarse::shorten;
use crate::lattice::Lattice;
use crate::local::apply;
use crate::pulls::{BLOCK, Packed, resistances_on_spheres};
use cloth_core::block_matrix::{BlockMatrix, BlockPattern};
use cloth_core::element::Projective;
use cloth_core::math::{Mat3, Real, Vec3, gather};
use cloth_core::parallel::join;
use cloth_core::parallel::wide;
use std::ops::Range;

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
    /// A sum per slot, and room to form it in.
    sums: Vec<Mat3>,
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
        self.sums = vec![Mat3::zeros(); self.slots.len()];
        self.packed = vec![[0.0; 8]; self.slots.len()];
    }

    /// Adds `Pᵀ (Σ w Gᵀ (I − ∂p/∂z) G) P` at x (m) to `out` (N/m).
    pub(crate) fn add_stiffness<const N: usize, const K: usize, E: Projective<N, K>>(
        &mut self,
        elements: &[E],
        are_spheres: bool,
        x: &[Vec3],
        out: &mut BlockMatrix,
    ) {
        let mut sums = std::mem::take(&mut self.sums);
        let mut packed = std::mem::take(&mut self.packed);
        let add_up = |group, sums: &mut [Mat3], packed: &mut [Packed]| {
            wide(
                #[inline(always)]
                || self.add_up(group, elements, are_spheres, x, sums, packed),
            );
        };
        self.for_each(0..self.groups.len(), &mut sums, &mut packed, &add_up);
        for (slot, sum) in self.slots.iter().zip(&sums) {
            out.blocks_mut()[*slot as usize] += sum;
        }
        (self.sums, self.packed) = (sums, packed);
    }

    /// Hands each group its sums, on several threads where that pays.
    fn for_each(
        &self,
        groups: Range<usize>,
        sums: &mut [Mat3],
        packed: &mut [Packed],
        visit: &(impl Fn(usize, &mut [Mat3], &mut [Packed]) + Sync),
    ) {
        if groups.len() < 2 {
            return groups.for_each(|group| visit(group, sums, packed));
        }
        let middle = (groups.start + groups.end) / 2;
        let at = self.starts(middle)[3] - self.starts(groups.start)[3];
        let (first_sums, second_sums) = sums.split_at_mut(at);
        let (first_packed, second_packed) = packed.split_at_mut(at);
        join(
            self.order.len() * groups.len() / self.groups.len(),
            || self.for_each(groups.start..middle, first_sums, first_packed, visit),
            || self.for_each(middle..groups.end, second_sums, second_packed, visit),
        );
    }

    /// Where a group begins in `order`, `coefficients`, `nodes` and `slots`.
    fn starts(&self, group: usize) -> [usize; 4] {
        let before = group.checked_sub(1).map(|before| self.groups[before].ends);
        before.unwrap_or_default().map(|end| end as usize)
    }

    /// Fills in the sums of one group; `packed` is room to work in.
    #[inline(always)]
    fn add_up<const N: usize, const K: usize, E: Projective<N, K>>(
        &self,
        group: usize,
        elements: &[E],
        are_spheres: bool,
        x: &[Vec3],
        sums: &mut [Mat3],
        packed: &mut [Packed],
    ) {
        let (starts, ends) = (self.starts(group), self.starts(group + 1));
        let node_count = ends[2] - starts[2];
        if node_count == 0 {
            return; // prescribed vertices only
        }
        sums.fill(Mat3::zeros());
        packed.fill([0.0; 8]);
        let mut coefficients = self.coefficients[starts[1]..ends[1]].chunks_exact(node_count * K);
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
                add_products(&resistance, coefficients, sums);
            }
        }
        for (sum, packed) in sums.iter_mut().zip(packed) {
            *sum += unpacked(packed);
        }
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
