//! Rank-one terms of the Hessian that a cycle cannot take, added to an inverse of the rest: those that couple many
//! vertices, such as the volume of a closed component, and contacts that are much stiffer than the cloth.
//!
//! With an inverse P of the rest, `(P⁻¹ + k g gᵀ)⁻¹ r = P r − z (g·P r)/(1/k + g·z)`, where `z = P g` (Sherman,
//! Morrison 1950, <https://doi.org/10.1214/aoms/1177729893>). Of several terms each takes those before it for the rest.

use crate::contact::{ContactPotential, ContactRow, GlobalRows};
use crate::math::{Real, Vec3};
use crate::method::vectors::add;

/// Passes over the stiff contacts in [`GlobalTerms::open`]. As `z` of each has those before it in its matrix, which are
/// stiff, it hardly changes their distances, and the first pass leaves little.
const PASSES: u32 = 2;

/// The terms, with `z` of each.
#[derive(Debug, Default)]
pub(super) struct GlobalTerms {
    rows: GlobalRows,
    /// How many of them couple many vertices: the first ones.
    volumes: usize,
    /// `z = P g` of each (m per unit of g), and `1/(1/k + g·z)`.
    solved: Vec<Vec<Vec3>>,
    weights: Vec<Real>,
    /// An entry for every vertex: g, and a displacement (m).
    dense: Vec<Vec3>,
    displacement: Vec<Vec3>,
}

impl GlobalTerms {
    /// Removes all terms.
    pub(super) fn clear(&mut self) {
        self.rows.clear();
        self.volumes = 0;
        self.weights.clear();
    }

    /// Takes the terms at `x` (m), with stiff contacts, around `inverse`, which writes `P r` to its second list.
    pub(super) fn refresh<'a>(
        &mut self,
        contact: &dyn ContactPotential,
        stiff: impl Iterator<Item = &'a ContactRow>,
        x: &[Vec3],
        is_free: &[bool],
        mut inverse: impl FnMut(&[Vec3], &mut [Vec3]),
    ) {
        self.clear();
        contact.linearize_globally(x, &mut self.rows);
        self.volumes = self.rows.rows().len();
        for row in stiff {
            let term = self.rows.push(row.stiffness);
            term.vertices.extend(row.vertices);
            term.gradient.extend(row.weights.map(|w| row.normal * w));
        }
        self.rows.remove_fixed(|vertex| !is_free[vertex]);
        for number in 0..self.rows.rows().len() {
            self.dense.clear();
            self.dense.resize(x.len(), Vec3::zeros());
            self.rows.rows()[number].add_to(1.0, &mut self.dense);
            if self.solved.len() == number {
                self.solved.push(Vec::new());
            }
            let mut solved = std::mem::take(&mut self.solved[number]);
            solved.resize(x.len(), Vec3::zeros());
            inverse(&self.dense, &mut solved);
            self.correct(&mut solved);
            let row = &self.rows.rows()[number];
            let curvature = row.dot(&solved).max(0.0);
            let weight = row.stiffness / (1.0 + row.stiffness * curvature);
            self.solved[number] = solved;
            self.weights.push(weight);
        }
    }

    /// Adds to `p` (m) `scale` times a displacement that opens the stiff contacts by `by` (m), in their order: with
    /// `z` of each, about the smallest one in the norm of the matrix.
    pub(super) fn open(&mut self, by: &[Real], scale: Real, p: &mut [Vec3]) {
        self.displacement.clear();
        self.displacement.resize(p.len(), Vec3::zeros());
        let first = self.volumes;
        let contacts = || self.rows.rows()[first..].iter().zip(&self.solved[first..]);
        for _ in 0..PASSES {
            for ((row, solved), by) in contacts().zip(by) {
                let missing = by - row.dot(&self.displacement);
                let length = missing / row.dot(solved);
                if length.is_finite() {
                    add(&mut self.displacement, length, solved);
                }
            }
        }
        add(p, scale, &self.displacement);
    }

    /// Whether a term couples many vertices.
    pub(super) fn has_volumes(&self) -> bool {
        self.volumes > 0
    }

    /// Adds the terms times `p` to `out`.
    pub(super) fn add_product(&self, p: &[Vec3], out: &mut [Vec3]) {
        for row in self.rows.rows() {
            row.add_product(p, out);
        }
    }

    /// Applies the Sherman–Morrison corrections of the rows so far to `z = P r`.
    pub(super) fn correct(&self, z: &mut [Vec3]) {
        let terms = self.rows.rows().iter().zip(&self.solved);
        for ((row, solved), weight) in terms.zip(&self.weights) {
            let along = weight * row.dot(z);
            for (z, solved) in z.iter_mut().zip(solved) {
                *z -= solved * along;
            }
        }
    }
}
