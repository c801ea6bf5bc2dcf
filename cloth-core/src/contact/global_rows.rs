//! Terms of a second derivative that couple many vertices.

use crate::math::{Real, Vec3};

/// One term of rank one, `k g gᵀ`, with `g` the gradient of a scalar C, a volume for instance, by all the vertices that
/// it depends on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GlobalRow {
    /// The vertices; none twice.
    pub vertices: Vec<u32>,
    /// g of each of them (unit of C per m).
    pub gradient: Vec<Vec3>,
    /// k, not negative, in the unit that makes `k g gᵀ` a stiffness (N/m): J per squared unit of C.
    pub stiffness: Real,
}

impl GlobalRow {
    /// `g·p` (unit of C), for displacements `p` (m) of all vertices.
    #[must_use]
    pub fn dot(&self, p: &[Vec3]) -> Real {
        let own = self.vertices.iter().zip(&self.gradient);
        own.map(|(&vertex, gradient)| gradient.dot(&p[vertex as usize]))
            .sum()
    }

    /// `k g (g·p)`, for displacements `p` (m) of all vertices: adds it to `out` (N).
    pub fn add_product(&self, p: &[Vec3], out: &mut [Vec3]) {
        self.add_to(self.stiffness * self.dot(p), out);
    }

    /// Adds `scale g` to `out`, which has an entry for every vertex.
    pub fn add_to(&self, scale: Real, out: &mut [Vec3]) {
        for (&vertex, gradient) in self.vertices.iter().zip(&self.gradient) {
            out[vertex as usize] += gradient * scale;
        }
    }
}

/// A list of such terms that keeps its memory when it is cleared.
#[derive(Clone, Debug, Default)]
pub struct GlobalRows {
    rows: Vec<GlobalRow>,
    len: usize,
}

impl GlobalRows {
    /// Removes all terms.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Appends a term without vertices, to be filled.
    pub fn push(&mut self, stiffness: Real) -> &mut GlobalRow {
        if self.len == self.rows.len() {
            self.rows.push(GlobalRow::default());
        }
        self.len += 1;
        let row = &mut self.rows[self.len - 1];
        row.vertices.clear();
        row.gradient.clear();
        row.stiffness = stiffness;
        row
    }

    /// The terms.
    #[must_use]
    pub fn rows(&self) -> &[GlobalRow] {
        &self.rows[..self.len]
    }

    /// Sets the gradients at vertices that do not move to zero.
    pub fn remove_fixed(&mut self, is_fixed: impl Fn(usize) -> bool) {
        for row in self.rows_mut() {
            for (gradient, &vertex) in row.gradient.iter_mut().zip(&row.vertices) {
                if is_fixed(vertex as usize) {
                    *gradient = Vec3::zeros();
                }
            }
        }
    }

    /// The terms, to be changed.
    pub fn rows_mut(&mut self) -> &mut [GlobalRow] {
        &mut self.rows[..self.len]
    }
}
