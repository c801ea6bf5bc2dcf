//! The global step: one matrix for x, y and z alike, the same in every iteration, factorised once per step size.

use crate::local::Projections;
use cloth_core::linear::{Cholesky, CholeskyError, PanelFactor, UpperPattern};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::Particles;
use sprs::{CsMat, TriMat};
use std::fmt;

/// `A = M/Δt² + Σ w GᵀG` over the vertices that are not prescribed, S1 (34), and its factor.
pub(crate) struct GlobalSystem {
    /// The vertex of each row.
    vertices: Vec<u32>,
    /// Lumped mass (kg) of each row.
    mass: Vec<Real>,
    /// Lower half of `Σ w GᵀG` (N/m), row by row, the diagonal last in each.
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
            .field("rows", &self.vertices.len())
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
        let all = 0..particles.len() as u32;
        let vertices: Vec<u32> = all
            .filter(|&vertex| !particles.is_prescribed(vertex as usize))
            .collect();
        let stiffness = assemble(particles.len(), &vertices, families);
        let cholesky = Cholesky::analyze(upper_pattern(&stiffness)?)?;
        Ok(Self {
            mass: vertices
                .iter()
                .map(|&v| particles.mass()[v as usize])
                .collect(),
            vertices,
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
        let values = self.cholesky.values_mut();
        values.copy_from_slice(self.stiffness.data());
        let row_ends = self.stiffness.indptr();
        for (end, mass) in row_ends
            .as_slice()
            .expect("whole")
            .iter()
            .skip(1)
            .zip(&self.mass)
        {
            values[end - 1] += mass / (dt * dt);
        }
        self.cholesky.factorize()?;
        let factor = self.cholesky.factor();
        match &mut self.panels {
            Some(panels) => panels.refill(factor),
            None => self.panels = Some(PanelFactor::new(factor, &self.vertices)),
        }
        self.factored_for = Some(dt);
        Ok(1)
    }

    /// Whether no vertex can move.
    pub(crate) fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Solves `A d = b` (N to m) over the free vertices; the entries of the others are neither read nor written.
    ///
    /// # Panics
    /// If nothing has been prepared.
    pub(crate) fn solve(&mut self, b: &[Vec3], d: &mut [Vec3]) {
        let panels = self.panels.as_mut().expect("prepared");
        panels.solve(b, d);
    }
}

/// Lower half of `Σ w GᵀG` over the rows `vertices`, every diagonal entry present.
fn assemble(
    vertex_count: usize,
    vertices: &[u32],
    families: &[Box<dyn Projections>],
) -> CsMat<Real> {
    const PRESCRIBED: usize = usize::MAX;
    let mut row_of = vec![PRESCRIBED; vertex_count];
    for (row, &vertex) in vertices.iter().enumerate() {
        row_of[vertex as usize] = row;
    }
    let mut entries = TriMat::new((vertices.len(), vertices.len()));
    for row in 0..vertices.len() {
        entries.add_triplet(row, row, 0.0);
    }
    for family in families {
        family.add_matrix(&mut |i, j, value| {
            // Rows ascend with vertices, so the lower half stays the lower half.
            let (row, column) = (row_of[i as usize], row_of[j as usize]);
            if row != PRESCRIBED && column != PRESCRIBED {
                entries.add_triplet(row, column, value);
            }
        });
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
