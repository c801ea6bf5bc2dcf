//! A coarse grid under the quasi-Newton iteration: a few hundred unknowns that know which way the springs point.
//!
//! The constant matrix is as stiff across a spring as along it, so of the motions that turn springs without stretching them, a global solve
//! takes only a small part; and those are smooth motions of the whole sheet, such as falling and swinging. Let P (a column per
//! node of a coarse [`Lattice`] and axis) interpolate smooth displacements. Then
//!
//! `A⁻¹ + P V Pᵀ`,  V near `(Pᵀ H P)⁻¹`,  `H = M/Δt² + Σ w Gᵀ (I − ∂p/∂z) G`
//!
//! is the constant matrix for what is rough and Newton's method for what is smooth: an additive two-level preconditioner. V is a cycle of [`Multigrid`] on the
//! lattice and the levels below it. The first part is symmetric and positive definite, the second symmetric and positive semi-definite (it vanishes on what the hats do not see), so the sum is
//! positive definite and the direction goes down. H is taken where the step's iteration starts, once a step, over the elements that the constant matrix has.
//!
//! The lattice is not one of the coarse levels of the mesh. Those are as good where they nest: with 65 vertices a side (a level of 289, 16 iterations) a sheet that swings for five seconds keeps 4 % more kinetic
//! energy with the level than with 16 cells, and its largest stretch differs by 2 %. With 64, where the last cells of a row are of another size, the largest stretch is half as large again as it should be, or twice as large (with 128 too),
//! whether the level is solved exactly or by a cycle: nothing smooths after the correction.

use crate::free_pieces::FreePieces;
use crate::lattice::Lattice;
use crate::local::Projections;
use cloth_core::block_matrix::{BlockMatrix, PatternBuilder};
use cloth_core::energy::Attachment;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::multigrid::Multigrid;
use cloth_core::particles::Particles;
use cloth_core::vectors::add;
use sprs::CsMat;

/// H, and the levels below the lattice.
#[derive(Debug)]
pub(crate) struct CoarseGrid {
    multigrid: Multigrid,
    matrix: BlockMatrix,
    /// Mass (kg) of each vertex.
    mass: Vec<Real>,
    is_ready: bool,
    /// A correction has no momentum, but for rounding; what nothing holds must not be pushed.
    free_pieces: FreePieces,
    /// The last correction (m), over the vertices.
    correction: Vec<Vec3>,
}

impl CoarseGrid {
    /// Lays a lattice of `cells` over the cloth at rest (m), and prepares all families to be summed on `stiffness`, the lower half of `Σ w GᵀG` (N/m).
    pub(crate) fn new(
        rest: &[Vec3],
        cells: u32,
        particles: &Particles,
        stiffness: &CsMat<Real>,
        free_pieces: &FreePieces,
        families: &mut [Box<dyn Projections>],
    ) -> Self {
        let mut pattern = PatternBuilder::new(particles.len());
        for (_, (row, column)) in stiffness {
            if row != column {
                pattern.add_pairs(&[row as u32, column as u32], |_| true);
            }
        }
        let mut matrix = BlockMatrix::zeros(pattern.build());
        let values: Vec<Real> = stiffness.iter().map(|entry| *entry.0).collect();
        for (block, value) in matrix.blocks_mut().iter_mut().zip(values) {
            *block = Mat3::from_diagonal_element(value);
        }
        for family in families.iter_mut() {
            family.bind(matrix.pattern());
        }
        let is_free = |vertex: usize| !particles.is_prescribed(vertex);
        let Lattice {
            prolongation,
            place,
        } = Lattice::over(rest, is_free, cells);
        Self {
            multigrid: Multigrid::below(prolongation, &matrix, place),
            mass: particles.mass().to_vec(),
            matrix,
            is_ready: false,
            free_pieces: free_pieces.clone(),
            correction: vec![Vec3::zeros(); particles.len()],
        }
    }

    /// Takes notice of which pieces of the cloth nothing holds any more, or again.
    pub(crate) fn set_free_pieces(&mut self, free_pieces: &FreePieces) {
        self.free_pieces.clone_from(free_pieces);
    }

    /// Takes H at x (m) for a step of `dt` (s).
    pub(crate) fn prepare(
        &mut self,
        families: &mut [Box<dyn Projections>],
        attachments: &[Attachment],
        x: &[Vec3],
        dt: Real,
    ) {
        self.matrix.set_diagonal(&self.mass, 1.0 / dt / dt);
        for family in families.iter_mut() {
            family.add_stiffness(x, &mut self.matrix);
        }
        for attachment in attachments {
            let vertex = attachment.vertex as usize;
            let own = self.matrix.pattern().row(vertex).end - 1;
            self.matrix.blocks_mut()[own] += Mat3::from_diagonal_element(attachment.stiffness);
        }
        self.is_ready = self.multigrid.refresh(&self.matrix);
    }

    /// Whether the matrix of the coarsest level was positive definite.
    pub(crate) fn is_ready(&self) -> bool {
        self.is_ready
    }

    /// Finds `P V Pᵀ r` (m) for a right-hand side r (N).
    pub(crate) fn solve(&mut self, r: &[Vec3]) {
        self.multigrid.apply(r, &mut self.correction);
        if !self.free_pieces.is_empty() {
            self.free_pieces.align(None, &mut self.correction);
        }
    }

    /// Adds what was found last (m) to `out`.
    pub(crate) fn add_correction(&self, out: &mut [Vec3]) {
        add(out, 1.0, &self.correction);
    }
}
