//! The contact potential as one vertex sees it: linearised once an iteration, up to date in where the others are.

use cloth_core::contact::{ContactPotential, ContactRow};
use cloth_core::math::{Mat3, Real, Vec3};

/// `g + Σ k J Jᵀ (x − x₀)`: the gradient of the contact energy near x₀.
#[derive(Debug)]
pub struct LinearizedContact {
    rows: Vec<ContactRow>,
    /// J (x₀) of each row (m).
    at_start: Vec<Real>,
    /// g (N), and the energy there (J).
    gradient: Vec<Vec3>,
    energy: Real,
    /// The rows of vertex v are `of_vertex[starts[v]..starts[v + 1]]`, with its place in the row.
    starts: Vec<u32>,
    of_vertex: Vec<(u32, u32)>,
}

impl LinearizedContact {
    /// Nothing touches.
    pub fn new(vertex_count: usize) -> Self {
        Self {
            rows: Vec::new(),
            at_start: Vec::new(),
            gradient: vec![Vec3::zeros(); vertex_count],
            energy: 0.0,
            starts: vec![0; vertex_count + 1],
            of_vertex: Vec::new(),
        }
    }

    /// Nothing touches any longer.
    pub fn clear(&mut self) {
        if !self.rows.is_empty() {
            self.rows.clear();
            self.starts.fill(0);
            self.energy = 0.0;
        }
    }

    /// Linearises at `x` (m).
    pub fn linearize(&mut self, contact: &dyn ContactPotential, x: &[Vec3]) {
        self.clear();
        contact.linearize(x, &mut self.rows);
        if self.rows.is_empty() {
            return;
        }
        self.gradient.fill(Vec3::zeros());
        self.energy = contact.add_gradient(x, &mut self.gradient);
        self.at_start.clear();
        self.at_start
            .extend(self.rows.iter().map(|row| along(row, x)));
        // Counted, summed up, and filled from the end of each vertex to its start.
        let ends = |row: &ContactRow| row.vertices.into_iter().zip(row.weights).zip(0..);
        let takes_part = |(_, weight): &(u32, Real)| *weight != 0.0;
        for ((vertex, weight), _) in self.rows.iter().flat_map(ends) {
            self.starts[vertex as usize] += u32::from(takes_part(&(vertex, weight)));
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.of_vertex.resize(sum as usize, (0, 0));
        for (number, row) in (0..).zip(&self.rows) {
            for (end, place) in ends(row).filter(|(end, _)| takes_part(end)) {
                let start = &mut self.starts[end.0 as usize];
                *start -= 1;
                self.of_vertex[*start as usize] = (number, place);
            }
        }
    }

    /// The energy (J) where it has been linearised.
    pub fn energy(&self) -> Real {
        self.energy
    }

    /// Whether a vertex has contacts.
    pub fn touches(&self, vertex: usize) -> bool {
        self.starts[vertex] < self.starts[vertex + 1]
    }

    /// Adds the gradient (N) and the Hessian (N/m) of a vertex, all vertices being at `x` (m).
    pub fn add(&self, vertex: u32, x: &[Vec3], gradient: &mut Vec3, hessian: &mut Mat3) {
        let v = vertex as usize;
        if !self.touches(v) {
            return;
        }
        *gradient += self.gradient[v];
        for &(row, place) in &self.of_vertex[self.starts[v] as usize..self.starts[v + 1] as usize] {
            let start = self.at_start[row as usize];
            let row = &self.rows[row as usize];
            let scaled = row.normal * (row.stiffness * row.weights[place as usize]);
            *gradient += scaled * (along(row, x) - start);
            *hessian += scaled * row.normal.transpose() * row.weights[place as usize];
        }
    }
}

/// J x (m).
fn along(row: &ContactRow, x: &[Vec3]) -> Real {
    let ends = row.vertices.iter().zip(row.weights);
    let sum: Vec3 = ends.map(|(&v, w)| x[v as usize] * w).sum();
    row.normal.dot(&sum)
}
