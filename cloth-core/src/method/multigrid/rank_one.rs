//! Additions of rank one that come and go: contacts between vertices that the pattern of the matrix does not couple.
//!
//! Each is `k J Jᵀ` with `J_i = w_i n`, so on every level it is a list of weighted vertices: `PᵀJ` has the weights
//! `Pᵀw`. Nothing is assembled and no pattern changes. Relaxation keeps the product `s = J·x` of each up to date as
//! vertices move, as position-based methods do with their constraints.

use super::blocks::{Lanes, lanes, plus, vector};
use super::prolongation::Prolongation;
use crate::contact::ContactRow;
use crate::math::{Mat3, Real};

/// Weights below this part of the largest one are left out of a coarse level.
const NEGLIGIBLE: Real = 1e-3;

/// The additions on one level.
#[derive(Debug, Default)]
pub(super) struct RankOne {
    /// Vertices and weights of each, one after another, and where each one's begin.
    members: Vec<(u32, Real)>,
    starts: Vec<u32>,
    /// `√k n` (√(N/m)) of each.
    normals: Vec<Lanes>,
    /// Of each vertex: which it takes part in, and `√k w n`; and where each vertex's begin.
    entries: Vec<(u32, Lanes)>,
    offsets: Vec<u32>,
    /// `s` of each (√(N m)).
    sums: Vec<f32>,
    /// Room for the weights of one on the next level.
    gathered: Vec<(u32, Real)>,
}

impl RankOne {
    pub(super) fn is_empty(&self) -> bool {
        self.normals.is_empty()
    }

    /// Takes over those of the finest level, without vertices that do not move.
    pub(super) fn set(&mut self, rows: &[ContactRow], is_free: &[bool]) {
        self.clear();
        for row in rows {
            let root = row.stiffness.sqrt();
            let n = row.normal * root;
            for (&vertex, weight) in row.vertices.iter().zip(row.weights) {
                if weight != 0.0 && is_free[vertex as usize] {
                    self.members.push((vertex, weight));
                }
            }
            self.close(lanes(&n));
        }
        self.index(is_free.len());
    }

    /// Takes over those of a finer level.
    pub(super) fn restrict(&mut self, fine: &Self, prolongation: &Prolongation) {
        self.clear();
        let mut gathered = std::mem::take(&mut self.gathered);
        for number in 0..fine.normals.len() {
            gathered.clear();
            for &(vertex, weight) in fine.members(number) {
                for &(parent, fraction) in prolongation.of_fine(vertex as usize) {
                    gathered.push((parent, weight * fraction));
                }
            }
            gathered.sort_unstable_by_key(|member| member.0);
            gathered.dedup_by(|next, first| {
                let same = next.0 == first.0;
                if same {
                    first.1 += next.1;
                }
                same
            });
            let largest = gathered.iter().fold(0.0, |a: Real, m| a.max(m.1.abs()));
            let counts = gathered.iter().filter(|m| m.1.abs() > NEGLIGIBLE * largest);
            self.members.extend(counts);
            self.close(fine.normals[number]);
        }
        self.gathered = gathered;
        self.index(prolongation.coarse_count());
    }

    fn clear(&mut self) {
        self.members.clear();
        self.normals.clear();
        self.starts.clear();
        self.starts.push(0);
    }

    /// Ends the list of one.
    fn close(&mut self, normal: Lanes) {
        self.starts.push(self.members.len() as u32);
        self.normals.push(normal);
    }

    fn members(&self, number: usize) -> &[(u32, Real)] {
        &self.members[self.starts[number] as usize..self.starts[number + 1] as usize]
    }

    /// Sorts the members by vertex.
    fn index(&mut self, vertex_count: usize) {
        self.offsets.clear();
        self.offsets.resize(vertex_count + 1, 0);
        for &(vertex, _) in &self.members {
            self.offsets[vertex as usize + 1] += 1;
        }
        for vertex in 0..vertex_count {
            self.offsets[vertex + 1] += self.offsets[vertex];
        }
        self.entries.clear();
        self.entries.resize(self.members.len(), (0, Lanes::ZERO));
        for number in 0..self.normals.len() {
            for member in self.starts[number] as usize..self.starts[number + 1] as usize {
                let (vertex, weight) = self.members[member];
                // Used as the next free place; put back below.
                let place = &mut self.offsets[vertex as usize];
                let jacobian = plus(Lanes::ZERO, weight as f32, &self.normals[number]);
                self.entries[*place as usize] = (number as u32, jacobian);
                *place += 1;
            }
        }
        for vertex in (0..vertex_count).rev() {
            self.offsets[vertex + 1] = self.offsets[vertex];
        }
        self.offsets[0] = 0;
        self.sums.clear();
        self.sums.resize(self.normals.len(), 0.0);
    }

    fn entries(&self, vertex: usize) -> &[(u32, Lanes)] {
        &self.entries[self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize]
    }

    /// What they add to the diagonal block of a vertex (N/m).
    pub(super) fn diagonal(&self, vertex: usize) -> Mat3 {
        let mut sum = Mat3::zeros();
        for (_, jacobian) in self.entries(vertex) {
            let j = vector(jacobian);
            sum += j * j.transpose();
        }
        sum
    }

    /// All pairs of members with the product of their parts, `J_i J_jᵀ` (N/m).
    pub(super) fn for_each_block(&self, mut visit: impl FnMut(usize, usize, Mat3)) {
        for number in 0..self.normals.len() {
            let n = vector(&self.normals[number]);
            let across = n * n.transpose();
            for &(a, by_a) in self.members(number) {
                for &(b, by_b) in self.members(number) {
                    visit(a as usize, b as usize, across * (by_a * by_b));
                }
            }
        }
    }

    /// Takes the products of all with `x` (m); with nothing for zero.
    pub(super) fn start(&mut self, x: Option<&[Lanes]>) {
        self.sums.fill(0.0);
        let Some(x) = x else {
            return;
        };
        for (vertex, x) in x.iter().enumerate() {
            self.moved(vertex, x, 1.0);
        }
    }

    /// Takes notice that a vertex has moved by `times · displacement` (m).
    #[inline(always)]
    pub(super) fn moved(&mut self, vertex: usize, displacement: &Lanes, times: f32) {
        let places = self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize;
        let displacement = displacement.to_array();
        for (number, jacobian) in &self.entries[places] {
            let j = jacobian.to_array();
            let along = j[0] * displacement[0] + j[1] * displacement[1] + j[2] * displacement[2];
            self.sums[*number as usize] += times * along;
        }
    }

    /// `rest − Σ J_i s` (N): the force on a vertex without that of what has been taken in.
    #[inline(always)]
    pub(super) fn without(&self, vertex: usize, mut rest: Lanes) -> Lanes {
        for (number, jacobian) in self.entries(vertex) {
            rest = plus(rest, -self.sums[*number as usize], jacobian);
        }
        rest
    }

    /// The same for all vertices.
    pub(super) fn subtract(&self, residual: &mut [Lanes]) {
        for (vertex, residual) in residual.iter_mut().enumerate() {
            *residual = self.without(vertex, *residual);
        }
    }
}
