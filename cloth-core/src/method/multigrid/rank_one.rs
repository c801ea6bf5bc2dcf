//! Additions of rank one that come and go: contacts between vertices that the pattern of the matrix does not couple.
//!
//! Each is `k J Jᵀ` with `J_i = w_i n`, so on every level it is a list of weighted vertices: `PᵀJ` has the weights
//! `Pᵀw`. Nothing is assembled and no pattern changes. Where a level is coarser than contacts are dense, many of them
//! press on the same vertices along the same normal: they are one there ([`RankOne::restrict`]). Relaxation keeps the
//! product `s = J·x` of each up to date as vertices move, as position-based methods do with their constraints.

use super::blocks::{Lanes, lanes, plus, vector};
use super::prolongation::Prolongation;
use crate::contact::ContactRow;
use crate::math::{Mat3, Real, Vec3};

/// Weights below this fraction of the largest one are left out of a coarse level.
const NEGLIGIBLE: Real = 1e-3;

/// Sorts weights by vertex, from the one of number `first` on, and adds up those of one vertex.
fn add_up(weights: &mut Vec<(u32, Real)>, first: usize) {
    weights[first..].sort_unstable_by_key(|member| member.0);
    let mut last = first;
    for k in first + 1..weights.len() {
        if weights[k].0 == weights[last].0 {
            weights[last].1 += weights[k].1;
        } else {
            last += 1;
            weights[last] = weights[k];
        }
    }
    weights.truncate((last + 1).min(weights.len()));
}

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
    /// Room for the weights of one, and for the numbers of those that become one on this level.
    gathered: Vec<(u32, Real)>,
    groups: Vec<(u64, u32)>,
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

    /// Takes over those of a finer level, and merges those that are nearly the same on this level. Two are, if their
    /// weights of either sign are largest at the same two coarse vertices, and their normals are nearest to the same
    /// axis.
    ///
    /// Let `Jᵢ = wᵢ nᵢ`, w the weights on this level, with signs that make the nᵢ agree. The merged one, `k J Jᵀ`, has
    ///
    /// - as w the mean of the wᵢ, and as n the direction of the mean of the nᵢ, both weighted by the stiffnesses kᵢ;
    /// - the stiffness k with `k ‖w‖² = Σ kᵢ ‖wᵢ‖²`. That is the trace of the sum of all.
    ///
    /// If all w and n are alike this is the sum itself. If they are not, only the trace is, the sum of the eigenvalues:
    /// what the others resist across the mean is counted along it. Such a level is off by that, but `k J Jᵀ` is
    /// positive semidefinite, so the cycle stays a preconditioner. The finest level, and what is iterated around the
    /// cycle, have all of them as they are. An error here costs iterations, not accuracy.
    pub(super) fn restrict(&mut self, fine: &Self, prolongation: &Prolongation) {
        self.clear();
        let mut groups = std::mem::take(&mut self.groups);
        groups.clear();
        let numbers = 0..fine.normals.len() as u32;
        groups.extend(numbers.map(|number| (fine.key(number as usize, prolongation), number)));
        groups.sort_unstable();
        let mut gathered = std::mem::take(&mut self.gathered);
        for alike in groups.chunk_by(|a, b| a.0 == b.0) {
            gathered.clear();
            let (mut normal, mut stiffness, mut trace) = (Vec3::zeros(), 0.0, 0.0);
            for &(_, number) in alike {
                let number = number as usize;
                let mut n = vector(&fine.normals[number]);
                let k = n.norm_squared();
                let along = if normal.dot(&n) < 0.0 { -1.0 } else { 1.0 };
                n *= along;
                normal += n * k.sqrt();
                stiffness += k;
                let first = gathered.len();
                for &(vertex, weight) in fine.members(number) {
                    for &(parent, fraction) in prolongation.of_fine(vertex as usize) {
                        gathered.push((parent, weight * fraction * along * k));
                    }
                }
                add_up(&mut gathered, first);
                trace += gathered[first..].iter().map(|m| m.1 * m.1).sum::<Real>() / k;
            }
            add_up(&mut gathered, 0);
            let largest = gathered.iter().fold(0.0, |a: Real, m| a.max(m.1.abs()));
            gathered.retain(|m| m.1.abs() > NEGLIGIBLE * largest);
            let squares = gathered.iter().map(|m| m.1 * m.1).sum::<Real>();
            let length = normal.norm();
            if squares > 0.0 && length > 0.0 {
                let members = gathered.iter().map(|&(vertex, w)| (vertex, w / stiffness));
                self.members.extend(members);
                let k = trace * stiffness * stiffness / squares;
                self.close(lanes(&(normal * (k.sqrt() / length))));
            }
        }
        (self.gathered, self.groups) = (gathered, groups);
        self.index(prolongation.coarse_count());
    }

    /// What tells apart those that stay apart on the next level: the vertices there of the largest weights of both
    /// signs, and the axis that is nearest to the normal.
    fn key(&self, number: usize, prolongation: &Prolongation) -> u64 {
        let mut ends = [u32::MAX; 2];
        let mut most = [0.0; 2];
        for &(vertex, weight) in self.members(number) {
            let side = usize::from(weight < 0.0);
            let parents = prolongation.of_fine(vertex as usize).iter();
            for &(parent, fraction) in parents {
                let size = weight.abs() * fraction;
                if size > most[side] {
                    (ends[side], most[side]) = (parent, size);
                }
            }
        }
        ends.sort_unstable();
        let axis = vector(&self.normals[number]).iamax();
        let ends = ends.map(|end| u64::from(end & 0x3fff_ffff));
        ends[0] << 34 | ends[1] << 2 | axis as u64
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
