//! The global step: one matrix for x, y and z alike, the same in every iteration, factorised once per step size.

use crate::local::Projections;
use cloth_core::linear::{Cholesky, CholeskyError, FactorView, PanelFactor, UpperPattern};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::Particles;
use sprs::{CsMat, TriMat};
use std::fmt;

/// A pivot below this part of its diagonal entry has lost all but a few of its digits.
const SMALLEST_PIVOT: Real = 1e-12;

/// `A = M/Δt² + Σ w GᵀG` over the vertices that are not prescribed, S1 (34), and its factor. The row of a prescribed vertex is that of the identity.
pub(crate) struct GlobalSystem {
    /// Lumped mass (kg) of each vertex; none where it is prescribed.
    mass: Vec<Option<Real>>,
    /// Lower half of `Σ w GᵀG` (N/m) over all vertices, row by row, the diagonal last in each.
    stiffness: CsMat<Real>,
    cholesky: Cholesky,
    /// The factor in the layout that the iterations read; none before the first step.
    panels: Option<PanelFactor>,
    /// The step size (s) that the factor is for.
    factored_for: Option<Real>,
}

impl fmt::Debug for GlobalSystem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GlobalSystem")
            .field("rows", &self.mass.len())
            .field("nonzeros", &self.stiffness.nnz())
            .field("factored_for", &self.factored_for)
            .finish()
    }
}

impl GlobalSystem {
    /// Assembles `Σ w GᵀG` and analyses the pattern.
    pub(crate) fn new(
        particles: &Particles,
        families: &[Box<dyn Projections>],
    ) -> Result<Self, CholeskyError> {
        let stiffness = assemble(particles.len(), families);
        let cholesky = Cholesky::analyze(upper_pattern(&stiffness)?)?;
        let mass = |vertex: usize| {
            let is_free = !particles.is_prescribed(vertex);
            is_free.then(|| particles.mass()[vertex])
        };
        Ok(Self {
            mass: (0..particles.len()).map(mass).collect(),
            stiffness,
            cholesky,
            panels: None,
            factored_for: None,
        })
    }

    /// Makes the factor that of step size `dt` (s); returns the number of factorisations that took.
    pub(crate) fn prepare(&mut self, dt: Real) -> Result<u32, CholeskyError> {
        if self.factored_for == Some(dt) || self.is_empty() {
            return Ok(0);
        }
        self.factored_for = None;
        fill(&self.stiffness, &self.mass, dt, self.cholesky.values_mut());
        self.cholesky.factorize()?;
        let factor = self.cholesky.factor();
        if smallest_pivot(factor, &self.stiffness, &self.mass, dt) < SMALLEST_PIVOT {
            return Err(CholeskyError::NotPositiveDefinite);
        }
        match &mut self.panels {
            Some(panels) => panels.refill(factor),
            None => {
                let places: Vec<u32> = (0..self.mass.len() as u32).collect();
                self.panels = Some(PanelFactor::new(factor, &places));
            }
        }
        self.factored_for = Some(dt);
        Ok(1)
    }

    /// Lower half of `Σ w GᵀG` (N/m) over all vertices.
    pub(crate) fn stiffness(&self) -> &CsMat<Real> {
        &self.stiffness
    }

    /// Whether no vertex can move.
    pub(crate) fn is_empty(&self) -> bool {
        self.mass.iter().all(Option::is_none)
    }

    /// Solves `A d = b` (N to m). `b` has to be zero at prescribed vertices; so is `d`.
    ///
    /// # Panics
    /// If nothing has been prepared.
    pub(crate) fn solve(&mut self, b: &[Vec3], d: &mut [Vec3]) {
        let panels = self.panels.as_mut().expect("prepared");
        panels.solve(b, d);
    }
}

/// The numbers of A for a step of `dt` (s), in the order of its lower half.
fn fill(stiffness: &CsMat<Real>, mass: &[Option<Real>], dt: Real, values: &mut [Real]) {
    let mut values = values.iter_mut();
    for (row, entries) in stiffness.outer_iterator().enumerate() {
        for ((column, &k), value) in entries.iter().zip(&mut values) {
            *value = match (mass[row], mass[column]) {
                (Some(mass), Some(_)) if row == column => k + mass / dt / dt,
                (Some(_), Some(_)) => k,
                _ if row == column => 1.0,
                _ => 0.0,
            };
        }
    }
}

/// The smallest square of a diagonal entry of the factor, relative to the diagonal entry of the matrix that it comes from: what elimination has left of it.
fn smallest_pivot(
    factor: FactorView<'_>,
    stiffness: &CsMat<Real>,
    mass: &[Option<Real>],
    dt: Real,
) -> Real {
    let order = factor.order();
    let row_ends = stiffness.indptr();
    let mut smallest: Real = 1.0;
    for index in 0..factor.supernode_count() {
        let (start, _, block) = factor.supernode(index);
        for column in 0..block.ncols() {
            let row = order[start + column] as usize;
            if let Some(mass) = mass[row] {
                let last = row_ends.outer_inds_sz(row).end - 1;
                let diagonal = stiffness.data()[last] + mass / dt / dt;
                let pivot = block[(column, column)];
                smallest = smallest.min(pivot * pivot / diagonal);
            }
        }
    }
    smallest
}

/// Lower half of `Σ w GᵀG` over all vertices, every diagonal entry present.
fn assemble(vertex_count: usize, families: &[Box<dyn Projections>]) -> CsMat<Real> {
    let mut entries = TriMat::new((vertex_count, vertex_count));
    for row in 0..vertex_count {
        entries.add_triplet(row, row, 0.0);
    }
    for family in families {
        family.add_matrix(&mut |i, j, value| entries.add_triplet(i as usize, j as usize, value));
    }
    entries.to_csr()
}

/// Row i of the lower half, read across, is column i of the upper half, read down.
fn upper_pattern(lower: &CsMat<Real>) -> Result<UpperPattern, CholeskyError> {
    let narrow = |&index: &usize| u32::try_from(index).map_err(|_| CholeskyError::TooLarge);
    let offsets = lower.indptr();
    let offsets = offsets.as_slice().expect("whole").iter().map(narrow);
    Ok(UpperPattern {
        column_offsets: offsets.collect::<Result<_, _>>()?,
        rows: lower
            .indices()
            .iter()
            .map(narrow)
            .collect::<Result<_, _>>()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local::Family;
    use cloth_core::element::{Element, Projective};
    use cloth_core::energy::{Attachment, Spring};

    /// Two rows on three vertices, as an energy of a triangle would have.
    #[derive(Clone, Copy, Debug)]
    struct Corner([u32; 3], [[Real; 3]; 2]);

    impl Element<3> for Corner {
        fn vertices(&self) -> [u32; 3] {
            self.0
        }
    }

    impl Projective<3, 2> for Corner {
        fn operator(&self) -> [[Real; 3]; 2] {
            self.1
        }
        fn weight(&self) -> Real {
            2.5
        }
        fn project(&self, z: [Vec3; 2]) -> [Vec3; 2] {
            z
        }
    }

    type Families = Vec<Box<dyn Projections>>;

    fn family<const N: usize, const K: usize, E: Projective<N, K>>(
        elements: &[E],
        particles: &Particles,
    ) -> Box<dyn Projections> {
        Box::new(Family::new(elements.to_vec(), particles).unwrap())
    }

    /// `w GᵀG` of all elements, entry by entry.
    fn add_dense<const N: usize, const K: usize, E: Projective<N, K>>(
        elements: &[E],
        dense: &mut [[Real; 6]; 6],
    ) {
        for element in elements {
            let mut rows = [[0.0; 6]; K];
            for (row, coefficients) in rows.iter_mut().zip(element.operator()) {
                for (vertex, g) in element.vertices().into_iter().zip(coefficients) {
                    row[vertex as usize] = g;
                }
            }
            for (i, j) in (0..36).map(|at| (at / 6, at % 6)) {
                let product: Real = rows.iter().map(|row| row[i] * row[j]).sum();
                dense[i][j] += element.weight() * product;
            }
        }
    }

    #[test]
    fn the_matrix_is_mass_over_dt_squared_plus_the_sum_of_w_gt_g_over_free_vertices() {
        let mut particles = Particles::new(vec![0.1, 0.2, 0.3, 0.4, 0.5, 0.6]).unwrap();
        particles.prescribe(2).unwrap();
        let spring = |vertices, stiffness| Spring {
            vertices,
            rest_length: 1.0,
            stiffness,
        };
        let springs = [
            spring([1, 0], 3.0),
            spring([0, 1], 4.0),
            spring([2, 5], 5.0),
            spring([5, 3], 0.7),
        ];
        let corners = [
            Corner([4, 2, 0], [[1.0, -3.0, 2.0], [0.5, 0.25, -0.75]]),
            Corner([3, 4, 1], [[0.0, 1.0, -1.0], [2.0, -1.0, -1.0]]),
        ];
        let ties = [Attachment {
            vertex: 3,
            target: Vec3::zeros(),
            stiffness: 9.0,
        }];
        let families: Families = vec![
            family(&springs, &particles),
            family(&corners, &particles),
            family(&ties, &particles),
        ];
        let mut dense = [[0.0; 6]; 6];
        add_dense(&springs, &mut dense);
        add_dense(&corners, &mut dense);
        add_dense(&ties, &mut dense);

        let mut global = GlobalSystem::new(&particles, &families).unwrap();
        for dt in [0.1, 0.3] {
            assert_eq!(global.prepare(dt), Ok(1));
            let mut matrix = dense;
            for (i, mass) in particles.mass().iter().enumerate() {
                matrix[i][i] += mass / (dt * dt);
            }
            for i in 0..6 {
                (matrix[i][2], matrix[2][i]) = (0.0, 0.0);
            }
            matrix[2][2] = 1.0;
            let mut values = global.cholesky.values_mut().iter();
            for (_, (row, column)) in &global.stiffness {
                let error = values.next().unwrap() - matrix[row][column];
                assert!(error.abs() < 1e-13, "{row} {column}: {error:e}");
            }
            // What is stored is all there is: A x = b at the x that the solve gives.
            let mut b: Vec<Vec3> = (0..6).map(|v| Vec3::new(1.0, v as Real, -0.5)).collect();
            b[2] = Vec3::zeros();
            let mut x = vec![Vec3::zeros(); 6];
            global.solve(&b, &mut x);
            assert_eq!(x[2], Vec3::zeros());
            for i in [0, 1, 3, 4, 5] {
                let product: Vec3 = (0..6).map(|j| x[j] * matrix[i][j]).sum();
                assert!((product - b[i]).norm() < 1e-13, "{i}");
            }
        }
    }

    #[test]
    fn elements_that_move_nothing_are_left_out() {
        let mut particles = Particles::new(vec![1.0; 3]).unwrap();
        particles.prescribe(0).unwrap();
        particles.prescribe(1).unwrap();
        let spring = |vertices, stiffness| Spring {
            vertices,
            rest_length: 1.0,
            stiffness,
        };
        let family = |springs: &[Spring]| Family::<2, 1, Spring>::new(springs.to_vec(), &particles);
        assert!(
            family(&[spring([0, 1], 5.0), spring([1, 2], 0.0)])
                .unwrap()
                .is_empty()
        );
        assert!(!family(&[spring([1, 2], 5.0)]).unwrap().is_empty());
    }
}
