//! The coarse grid: an additive two-level preconditioner of Schwarz type (a one-level method and a coarse space:
//! Nicolaides 1987, Dryja and Widlund 1987). The fine part is the method's own constant matrix, the coarse part the
//! Galerkin operator `PᵀHP` of the projected Hessian on a few hundred unknowns. (Galerkin multigrid for projective
//! dynamics and Newton's method, as the solver and not beside a factor: Z. Xian, X. Tong, T. Liu, "A scalable Galerkin
//! multigrid method for real-time simulation of deformable objects", ACM Trans. Graph. 38(6), 162, 2019,
//! <https://doi.org/10.1145/3355089.3356486>.)
//!
//! The constant matrix is as stiff across a spring as along it, so of the motions that turn springs without stretching
//! them, a global solve removes only a small fraction. The large ones among these are smooth motions of the whole
//! sheet, such as falling and swinging. Let P (a column per node of a coarse [`Lattice`] and axis) interpolate smooth
//! displacements. Then
//!
//! `A⁻¹ + P V Pᵀ`,  V near `(Pᵀ H P)⁻¹`,  `H = M/Δt² + Σ w Sᵀ |I − ∂p/∂z| S`
//!
//! is the constant matrix for what stretches springs and Newton's method for what is smooth. What is both, smooth
//! stretching, is corrected up to twice, as the parts are added, not applied one after the other, which would take a
//! further product with H: |I − ∂p/∂z| (`local.rs`) lies between 0 and the I that A has, so 0 < H ≤ A. With an exact
//! coarse solve A⁻¹H and P V PᵀH then have eigenvalues from 0 to 1, their sum up to 2, and a step of length 1 may turn
//! such an error round. Pairs and line search mend that. What is neither, short waves across the cloth, both leave: A keeps
//! more of a wave the shorter it is ([crate page][1]), and the hats do not have it. Waves of shear that the hats do not
//! have, long beside the springs all the same, A reduces by a quarter an iteration.
//!
//! V is a cycle of [`Multigrid`] on the lattice and the levels below it. The first part is symmetric and positive
//! definite, the second symmetric and positive semi-definite (it vanishes on the r with Pᵀr = 0), so the sum is
//! positive definite and the direction goes down. H is taken where the step's iteration starts, over the elements that
//! the constant matrix has, so H ≤ A; ( )₊ sets negative eigenvalues to zero (`local.rs`). It is needed afresh in every
//! step: kept for two, the hanging sheet (64 vertices a side, ten iterations a step) loses 74 % of the kinetic energy
//! of its swing, and about half with a fresh one; taken several times in a step, it is no better than once.
//!
//! *The correction.* Of the model `gᵀd + ½ dᵀHd` the best d = P c has `PᵀHP c = −Pᵀg`: that is P (PᵀHP)⁻¹ Pᵀ times −g.
//! With e = H⁻¹g that is −Π e, Π = P (PᵀHP)⁻¹ PᵀH. As Π² = Π and HΠ is symmetric, Π projects orthogonally in the inner
//! product of H: it has the eigenvalues 1 (on the hats) and 0, and takes the hats' part of the error exactly. A⁻¹H is
//! symmetric in the same inner product, so the largest eigenvalue of the sum is at most the sum of the largest, 2.
//!
//! The matrix is summed element by element: `Pᵀ H P` is never a matrix of the whole cloth first, which would take 0.65
//! ms of a step of 3.5 ms at 64 a side, and takes 0.36 so (AMD EPYC, Zen 4, one thread, commit f08e9736).
//!
//! *Why a lattice*, and not one of the coarse levels that multigrid makes of the mesh itself: where such a level fits
//! the mesh (65 vertices a side, every fourth of them) it is as good. Where it does not (64 or 128 a side, the last
//! cells of a row of another size), a sheet that swings for five seconds has 1.5 to 2 times the largest stretch that it
//! should: the correction is added, and nothing smooths the iterate after it.
//!
//! [1]: crate#what-the-constant-matrix-loses-and-how-it-is-won-back

use crate::components::FreeComponents;
use crate::global::GlobalSystem;
use crate::lattice::{ElementProlongation, Lattice, PaddedBlock};
use crate::local::Projections;
use cloth_core::energy::Attachment;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::block_matrix::{BlockMatrix, BlockPattern, PatternBuilder};
use cloth_core::method::chunked::map_reduce;
use cloth_core::method::multigrid::{Multigrid, Prolongation};
use cloth_core::method::vectors::add;
use cloth_core::particles::Particles;
use std::sync::Arc;

/// `Pᵀ H P`, and the levels below the lattice.
#[derive(Debug)]
pub(crate) struct CoarseGrid {
    multigrid: Multigrid,
    prolongation: Prolongation,
    /// `Pᵀ H P` (N/m).
    matrix: BlockMatrix,
    /// S P of each family; nothing of those that the constant matrix does not have.
    operators: Vec<ElementProlongation>,
    /// `Pᵀ M P` (kg), block by block.
    mass: Vec<Real>,
    /// The part of it that elements add (N/m).
    stiffness: Vec<PaddedBlock>,
    /// Over the nodes: `Pᵀ r` (N), and how they move (m).
    right_hand_side: Vec<Vec3>,
    solution: Vec<Vec3>,
    is_ready: bool,
    /// A correction has no momentum, but for rounding; what nothing holds must not be pushed.
    free_components: FreeComponents,
    /// The last correction (m), over the vertices.
    correction: Vec<Vec3>,
}

impl CoarseGrid {
    /// Lays a lattice of `cells` over each piece of the cloth at rest (m), for the families that `global` has.
    pub(crate) fn new(
        rest: &[Vec3],
        cells: u32,
        particles: &Particles,
        global: &GlobalSystem,
        free_components: &FreeComponents,
        families: &[Box<dyn Projections>],
    ) -> Self {
        let is_free = |vertex: usize| !particles.is_prescribed(vertex);
        let Lattice {
            prolongation,
            node_positions,
        } = Lattice::over(rest, is_free, free_components.pieces().of_each(), cells);
        let nodes = |vertex: usize| prolongation.of_fine(vertex).iter();
        let mut pattern = PatternBuilder::new(node_positions.len());
        let mut around: Vec<u32> = Vec::new();
        for (_, (row, column)) in global.stiffness() {
            around.clear();
            around.extend(nodes(row).chain(nodes(column)).map(|entry| entry.0));
            pattern.add_pairs(&around, |_| true);
        }
        let pattern = pattern.build();
        // Couplings as a Laplacian has them, which say what coarser levels keep.
        let mut matrix = BlockMatrix::zeros(Arc::clone(&pattern));
        for (&value, (row, column)) in global.stiffness() {
            for &(a, in_row) in nodes(row) {
                for &(b, in_column) in nodes(column).filter(|entry| entry.0 != a && row != column) {
                    let slot = pattern.slot(a, b).expect("a pair of the pattern");
                    let coupling = value.abs() * in_row * in_column;
                    matrix.blocks_mut()[slot as usize] += Mat3::from_diagonal_element(coupling);
                }
            }
        }
        let is_free = vec![true; node_positions.len()];
        let multigrid = Multigrid::new(&matrix, &is_free, &node_positions);
        let mut mass = vec![0.0; pattern.block_count()];
        for (vertex, own) in particles.mass().iter().enumerate() {
            for_each_pair(&prolongation, &pattern, vertex, |slot, weight| {
                mass[slot] += own * weight;
            });
        }
        let operators =
            (families.iter().enumerate()).map(|(index, family)| match global.includes(index) {
                true => family.prolongation(&prolongation, &pattern),
                false => ElementProlongation::default(),
            });
        Self {
            multigrid,
            operators: operators.collect(),
            right_hand_side: vec![Vec3::zeros(); node_positions.len()],
            solution: vec![Vec3::zeros(); node_positions.len()],
            prolongation,
            stiffness: vec![PaddedBlock::default(); pattern.block_count()],
            matrix,
            mass,
            is_ready: false,
            free_components: free_components.clone(),
            correction: vec![Vec3::zeros(); particles.len()],
        }
    }

    /// Replaces the unconstrained components, which attachments have changed.
    pub(crate) fn set_free_components(&mut self, free_components: &FreeComponents) {
        self.free_components.clone_from(free_components);
    }

    /// Takes H at x (m) for a step of `dt` (s).
    pub(crate) fn prepare(
        &mut self,
        families: &[Box<dyn Projections>],
        attachments: &[Attachment],
        x: &[Vec3],
        dt: Real,
    ) {
        self.stiffness.fill(PaddedBlock::default());
        for (family, operator) in families.iter().zip(&self.operators) {
            family.add_stiffness(operator, x, &mut self.stiffness);
        }
        let sums = self.mass.iter().zip(&self.stiffness);
        for (block, (mass, stiffness)) in self.matrix.blocks_mut().iter_mut().zip(sums) {
            *block = stiffness.block() + Mat3::from_diagonal_element(mass / dt / dt);
        }
        let pattern = Arc::clone(self.matrix.shared_pattern());
        for attachment in attachments {
            let blocks = self.matrix.blocks_mut();
            let vertex = attachment.vertex as usize;
            for_each_pair(&self.prolongation, &pattern, vertex, |slot, weight| {
                blocks[slot] += Mat3::from_diagonal_element(attachment.stiffness * weight);
            });
        }
        // Nodes around a curved piece can have motions that move no vertex. Such a matrix is singular but for rounding,
        // and is solved with a slightly larger diagonal.
        let _ = self.multigrid.refresh(&self.matrix);
        self.is_ready = self.multigrid.is_ready();
    }

    /// Whether the matrix of the coarsest level was positive definite, or is with a slightly larger diagonal.
    pub(crate) fn is_ready(&self) -> bool {
        self.is_ready
    }

    /// Finds `P V Pᵀ r` (m) for a right-hand side r (N).
    pub(crate) fn solve(&mut self, r: &[Vec3]) {
        let prolongation = &self.prolongation;
        map_reduce(
            &mut self.right_hand_side[..],
            #[inline(always)]
            |start, own: &mut [Vec3]| {
                for (node, own) in (start..).zip(own) {
                    let entries = prolongation.of_coarse(node).iter();
                    *own = entries
                        .map(|&(vertex, weight)| r[vertex as usize] * weight)
                        .sum();
                }
                []
            },
        );
        self.multigrid
            .apply(&self.right_hand_side, &mut self.solution);
        let solution = &self.solution;
        map_reduce(
            &mut self.correction[..],
            #[inline(always)]
            |start, own: &mut [Vec3]| {
                for (vertex, own) in (start..).zip(own) {
                    let entries = prolongation.of_fine(vertex).iter();
                    *own = entries
                        .map(|&(node, weight)| solution[node as usize] * weight)
                        .sum();
                }
                []
            },
        );
        if !self.free_components.is_empty() {
            self.free_components.center(&mut self.correction);
        }
    }

    /// Adds what was found last (m) to `out`.
    pub(crate) fn add_correction(&self, out: &mut [Vec3]) {
        add(out, 1.0, &self.correction);
    }
}

/// The block of every pair of nodes around a vertex, and the product of their weights.
fn for_each_pair(
    prolongation: &Prolongation,
    pattern: &BlockPattern,
    vertex: usize,
    mut visit: impl FnMut(usize, Real),
) {
    let nodes = prolongation.of_fine(vertex);
    for (i, &(row, a)) in nodes.iter().enumerate() {
        for &(column, b) in &nodes[..=i] {
            let slot = pattern.slot(row, column).expect("nodes of one vertex");
            visit(slot as usize, a * b);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local::Family;
    use cloth_core::cloth::{Cloth, Membrane};
    use cloth_core::mesh::generate::{Diagonals, grid};

    /// On few nodes, which are solved directly, the correction z is the best there is in their space:
    /// `Pᵀ(r − H z) = 0`, with H summed over the mesh instead of the lattice.
    #[test]
    fn the_correction_leaves_no_residual_on_the_lattice() {
        let mesh = grid(17, 17, 1.0, 1.0, Diagonals::Alternating).unwrap();
        let cloth = Cloth {
            areal_density: 0.2,
            membrane: Membrane::SpringStiffness(1e3),
            bending_rigidity: 1e-5,
        };
        let mut model = cloth.on(&mesh).unwrap();
        model.particles.prescribe(0).unwrap();
        let particles = &model.particles;
        let families = |springs| -> Vec<Box<dyn Projections>> {
            vec![Box::new(Family::new(springs, particles).unwrap())]
        };
        let on_lattice = families(model.springs.clone());
        let global = GlobalSystem::new(particles, &on_lattice, vec![false]).unwrap();
        let entries = global.stiffness().iter().map(|(&k, (i, j))| (i, j, k));
        let none = FreeComponents::of(&entries.collect::<Vec<_>>(), particles);
        let rest = mesh.positions();
        let mut coarse = CoarseGrid::new(rest, 4, particles, &global, &none, &on_lattice);
        let x: Vec<Vec3> = (rest.iter().enumerate())
            .map(|(v, x)| x * 1.1 + Vec3::z() * 0.01 * (v as Real).sin())
            .collect();
        let attachments = [Attachment {
            vertex: 100,
            target: x[100],
            stiffness: 50.0,
        }];
        let dt = 1.0 / 60.0;
        coarse.prepare(&on_lattice, &attachments, &x, dt);
        assert!(coarse.is_ready());
        let r: Vec<Vec3> = (0..289)
            .map(|v| Vec3::from_fn(|axis, _| ((3 * v + axis) as Real * 1.7).sin()))
            .collect();
        coarse.solve(&r);

        let own: Vec<[(u32, Real); 1]> = (0..289).map(|v| [(v, 1.0)]).collect();
        let every_vertex = Prolongation::new(own.iter().map(|row| &row[..]), 289);
        let mut pattern = PatternBuilder::new(289);
        pattern.add(&model.springs);
        let pattern = pattern.build();
        let on_mesh = families(model.springs.clone());
        let operator = on_mesh[0].prolongation(&every_vertex, &pattern);
        let mut stiffness = vec![PaddedBlock::default(); pattern.block_count()];
        on_mesh[0].add_stiffness(&operator, &x, &mut stiffness);
        let mut matrix = BlockMatrix::zeros(pattern);
        matrix.set_diagonal(particles.mass(), 1.0 / dt / dt);
        for (block, sum) in matrix.blocks_mut().iter_mut().zip(&stiffness) {
            *block += sum.block();
        }
        let z = &coarse.correction;
        let mut product = vec![Vec3::zeros(); 289];
        matrix.multiply(z, &mut product);
        product[100] += z[100] * attachments[0].stiffness;
        assert_eq!(z[0], Vec3::zeros());
        assert_eq!(coarse.right_hand_side.len(), 25);
        for node in 0..25 {
            let fine = coarse.prolongation.of_coarse(node).iter();
            let rest = fine.map(|&(v, w)| (r[v as usize] - product[v as usize]) * w);
            let rest = rest.sum::<Vec3>().norm();
            assert!(rest < 1e-4, "{node}: {rest:e} N");
        }
    }
}
