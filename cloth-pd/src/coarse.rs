//! A coarse grid under the quasi-Newton iteration: a few hundred unknowns that know which way the springs point.
//!
//! The constant matrix is as stiff across a spring as along it, so of the motions that turn springs without stretching them, a global solve
//! takes only a small part; and those are smooth motions of the whole sheet, such as falling and swinging. Let P (a column per
//! node of a coarse [`Lattice`] and axis) interpolate smooth displacements. Then
//!
//! `A⁻¹ + P (Pᵀ H P)⁻¹ Pᵀ`,  `H = M/Δt² + Σ w Gᵀ (I − ∂p/∂z) G`
//!
//! is the constant matrix for what is rough and Newton's method for what is smooth: an additive two-level preconditioner. The first part is
//! symmetric and positive definite, the second symmetric and positive semi-definite (it vanishes on what the hats do not see), so the sum is positive definite and the direction goes down. H is taken where the step's iteration starts, once a step; `PᵀHP` is small, and factorising it
//! costs next to nothing.

use crate::free_pieces::FreePieces;
use crate::lattice::Lattice;
use crate::local::Projections;
use cloth_core::block_matrix::{BlockMatrix, PatternBuilder};
use cloth_core::chunked::map_reduce;
use cloth_core::element::Element;
use cloth_core::energy::Attachment;
use cloth_core::linear::{BlockCholesky, CholeskyError};
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::particles::Particles;

/// Nodes are tied to their neighbours with this part of their stiffness. Where the cloth crosses a cell of the lattice in a plane, hats on it are linearly dependent
/// and `PᵀHP` has a null space, in which P x = 0: the ties change nothing there but that the matrix can be factorised. They do not resist translations, so momentum is kept.
const TIE: Real = 1e-9;

/// P, and the factor of `PᵀHP`.
#[derive(Debug)]
pub(crate) struct CoarseGrid {
    lattice: Lattice,
    /// `Pᵀ M P` (kg): slot in the matrix and value.
    mass: Vec<(u32, Real)>,
    /// What does not change with the positions.
    constant: BlockMatrix,
    matrix: BlockMatrix,
    cholesky: BlockCholesky,
    is_factored: bool,
    /// Hats reach from one piece of the cloth to the next; what nothing holds must not be pushed.
    free_pieces: FreePieces,
    /// A correction (m) over the vertices; unused without free pieces.
    correction: Vec<Vec3>,
    right_hand_side: Vec<Vec3>,
    solution: Vec<Vec3>,
}

/// Two nodes that some element ties to each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodePair(pub(crate) [u32; 2]);

impl Element<2> for NodePair {
    fn vertices(&self) -> [u32; 2] {
        self.0
    }
}

impl CoarseGrid {
    /// Lays a lattice over the cloth and prepares all families for it.
    pub(crate) fn new(
        rest: &[Vec3],
        cells: u32,
        particles: &Particles,
        free_pieces: &FreePieces,
        families: &mut [Box<dyn Projections>],
    ) -> Result<Self, CholeskyError> {
        let is_free = |vertex: usize| !particles.is_prescribed(vertex);
        let lattice = Lattice::over(rest, is_free, cells);
        let node_count = lattice.node_count();
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        for vertex in 0..particles.len() {
            let nodes = lattice.of(vertex);
            for (i, (a, _)) in nodes.iter().enumerate() {
                pairs.extend(nodes[..i].iter().map(|(b, _)| [*a, *b]));
            }
            shorten(&mut pairs, false);
        }
        for family in families.iter_mut() {
            family.lay_over(&lattice, &mut pairs);
        }
        shorten(&mut pairs, true);
        let pairs: Vec<NodePair> = pairs.into_iter().map(NodePair).collect();
        let mut pattern = PatternBuilder::new(node_count);
        pattern.add(&pairs);
        let pattern = pattern.build();
        let mut mass = vec![0.0; pattern.block_count()];
        for vertex in 0..particles.len() {
            let nodes = lattice.of(vertex);
            for (i, (a, wa)) in nodes.iter().enumerate() {
                for (b, wb) in &nodes[..=i] {
                    let slot = pattern.slot(*a, *b).expect("a pair of the pattern");
                    mass[slot as usize] += particles.mass()[vertex] * wa * wb;
                }
            }
        }
        for family in families.iter_mut() {
            family.bind_nodes(&pattern);
        }
        let mut constant = BlockMatrix::zeros(pattern.clone());
        let unused = vec![Vec3::zeros(); particles.len()];
        for family in families.iter_mut().filter(|family| family.is_constant()) {
            family.add_coarse_stiffness(&unused, &mut constant);
        }
        let all = vec![true; node_count];
        Ok(Self {
            cholesky: BlockCholesky::analyze(&pattern, &all)?,
            mass: (0..).zip(mass).filter(|entry| entry.1 > 0.0).collect(),
            matrix: constant.clone(),
            constant,
            is_factored: false,
            free_pieces: free_pieces.clone(),
            correction: vec![Vec3::zeros(); particles.len()],
            right_hand_side: vec![Vec3::zeros(); node_count],
            solution: vec![Vec3::zeros(); node_count],
            lattice,
        })
    }

    /// Takes notice of which pieces of the cloth nothing holds any more, or again.
    pub(crate) fn set_free_pieces(&mut self, free_pieces: &FreePieces) {
        self.free_pieces.clone_from(free_pieces);
    }

    /// Takes `PᵀHP` at x (m) for a step of `dt` (s). Where it cannot be factorised there is no correction until the next call.
    pub(crate) fn prepare(
        &mut self,
        families: &mut [Box<dyn Projections>],
        attachments: &[Attachment],
        x: &[Vec3],
        dt: Real,
    ) {
        let blocks = self.matrix.blocks_mut();
        blocks.copy_from_slice(self.constant.blocks());
        for &(slot, mass) in &self.mass {
            for axis in 0..3 {
                blocks[slot as usize][(axis, axis)] += mass / dt / dt;
            }
        }
        for family in families.iter_mut().filter(|family| !family.is_constant()) {
            family.add_coarse_stiffness(x, &mut self.matrix);
        }
        for attachment in attachments.iter().filter(|a| a.stiffness > 0.0) {
            let nodes = self.lattice.of(attachment.vertex as usize);
            for (i, (a, wa)) in nodes.iter().enumerate() {
                for (b, wb) in &nodes[..=i] {
                    let slot = self.matrix.pattern().slot(*a, *b);
                    let slot = slot.expect("a pair of the pattern") as usize;
                    let stiffness = attachment.stiffness * wa * wb;
                    self.matrix.blocks_mut()[slot] += Mat3::from_diagonal_element(stiffness);
                }
            }
        }
        self.tie_neighbours();
        self.is_factored = self.cholesky.factorize(&self.matrix).is_ok();
    }

    /// Whether it could be factorised.
    pub(crate) fn is_ready(&self) -> bool {
        self.is_factored
    }

    fn tie_neighbours(&mut self) {
        for node in 0..self.lattice.node_count() {
            let row = self.matrix.pattern().row(node);
            let own = row.end - 1;
            for slot in row.start..own {
                let neighbour = self.matrix.pattern().columns()[slot] as usize;
                let other = self.matrix.pattern().row(neighbour).end - 1;
                let blocks = self.matrix.blocks_mut();
                let weakest = blocks[own].trace().min(blocks[other].trace());
                let tie = Mat3::from_diagonal_element(TIE / 3.0 * weakest);
                blocks[own] += tie;
                blocks[other] += tie;
                blocks[slot] -= tie;
            }
        }
    }

    /// Finds `(PᵀHP)⁻¹ Pᵀ r` (m) for a right-hand side r (N).
    pub(crate) fn solve(&mut self, r: &[Vec3]) {
        if !self.is_factored {
            return;
        }
        for (node, sum) in self.right_hand_side.iter_mut().enumerate() {
            let shares = self.lattice.under(node);
            *sum = shares
                .iter()
                .map(|&(vertex, weight)| r[vertex as usize] * weight)
                .sum();
        }
        self.cholesky
            .solve(&self.right_hand_side, &mut self.solution);
    }

    /// Adds P times what was found last (m) to `out`.
    pub(crate) fn add_correction(&mut self, out: &mut [Vec3]) {
        if !self.is_factored {
            return;
        }
        if self.free_pieces.is_empty() {
            return self.interpolate(out);
        }
        let mut correction = std::mem::take(&mut self.correction);
        correction.fill(Vec3::zeros());
        self.interpolate(&mut correction);
        self.free_pieces.align(None, &mut correction);
        cloth_core::vectors::add(out, 1.0, &correction);
        self.correction = correction;
    }

    /// Adds P times the solution to `out`.
    fn interpolate(&self, out: &mut [Vec3]) {
        let (lattice, solution) = (&self.lattice, &self.solution[..]);
        map_reduce(
            out,
            #[inline(always)]
            |start, out: &mut [Vec3]| {
                for (vertex, out) in (start..).zip(out) {
                    let mut sum = *out;
                    for &(node, weight) in lattice.of(vertex) {
                        sum += solution[node as usize] * weight;
                    }
                    *out = sum;
                }
                []
            },
        );
    }
}

/// Pairs are collected with repetitions; this drops them whenever they have become many, or when `now` is set.
pub(crate) fn shorten(pairs: &mut Vec<[u32; 2]>, now: bool) {
    if now || pairs.len() > 1 << 16 {
        pairs.sort_unstable();
        pairs.dedup();
    }
}
