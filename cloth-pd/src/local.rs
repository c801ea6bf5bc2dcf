//! The local step: every element on its own projects `z = S x` to the nearest point `p` of its set, which gives the
//! forces on its vertices.
//!
//! *A spring, a curved hinge.* ‖z − p‖ ≥ |‖z‖ − r| for every p of length r (triangle inequality), with equality for
//! p = r z/‖z‖. So `½ w ‖z − p‖² = ½ w (‖z‖ − r)²`, Hooke's law, and the gradient `w (z − p) = w (‖z‖ − r) z/‖z‖`
//! is the tension of the spring. At z = 0 every point of the sphere is as near; p is then r times a unit
//! vector that the numbers of two vertices give ([`length_and_direction`](cloth_core::math::length_and_direction)).
//!
//! *Why S takes differences.* The same spring has another S: z = (x₀, x₁), and for a set all pairs of points at the
//! distance L. The nearest pair moves either end by half of what the length is off, as in position-based dynamics with
//! equal masses, so `½ w ‖z − p‖² = ¼ w (‖x₀ − x₁‖ − L)²`, for w = 2k the same energy. But `w SᵀS` is then 2k I, and
//! not `k [[1, −1], [−1, 1]]`. It is larger by `k [[1, 1], [1, 1]]`, which resists a translation. The minimum is the
//! same, but the iteration slower: for A′ ≥ A and ∇²G ≥ 0 each eigenvalue λ of A′⁻¹ ∇²G, in ascending order, is at most
//! that of A⁻¹ ∇²G (Courant–Fischer), and near the minimum an iteration leaves 1 − λ of an error. And momentum is right
//! at convergence only. Where each row of S adds up to zero a translation costs nothing, and every iteration keeps the
//! momentum (`components.rs`). Bouaziz et al. (2014) subtract the mean of an element's vertices to the same end.
//!
//! *Which energies are squared distances.* Of ψ(z) = ½ w ‖z − p‖² the gradient is w (z − p). So two conditions are
//! necessary, and easy to check: `‖∇ψ‖² = 2 w ψ` where ψ is differentiable, and ½ w ‖z‖² − ψ is convex (proof below),
//! so no curvature of ψ is above w.
//!
//! | ψ | squared distance |
//! |---|---|
//! | Hooke's spring, ½ k (‖z‖ − L)² | both hold for w = k |
//! | quadratic, ½ zᵀQz with a symmetric Q | if Q² = w Q, so if all eigenvalues are 0 or w. Else one element for each |
//! | StVK, of degree four in F | no: its curvature grows with ‖F‖², beyond any w |
//! | neo-Hookean, ½ μ ‖F‖² − μ ln det F + … | no: its curvature has no bound near det F = 0 |
//! | a spring with the force k s + c s³, s = ‖z‖ − L | no: (k s + c s³)² is not 2 w (½ k s² + ¼ c s⁴) |
//!
//! (In the last row the terms in s² ask for w = k, those in s⁴ for w = 4k.) Where the second condition fails A is not
//! above the Hessian, and an iteration without a line search may raise `G` (`objective.rs`).
//!
//! *A hinge* has the q and w of the [crate page](crate#idea). Its first triangle adds cot α₁ (x₀ − x₂) + cot α₀ (x₁ −
//! x₂) to Σ qᵢ xᵢ. The height h of the tip x₂ over the edge meets it at b, at h cot α₀ from x₀ and h cot α₁ from x₁, so
//! e = h (cot α₀ + cot α₁) and b = (h cot α₁ x₀ + h cot α₀ x₁)/e: what it adds is (e/h) (b − x₂), a vector of length e,
//! that of the edge, at right angles to it, from the tip to the edge. The other adds the like from its own tip. In a
//! flat hinge the two cancel, and with a fold θ the angle between them is π − θ, so 2 e sin(θ/2) is left. Of the areas
//! A₀ and A₁ of its triangles a third is the edge's, `a = (A₀ + A₁)/3`: e θ/a is a curvature, and
//! `½ (D/3) (e θ/a)² a = ½ D (e θ)²/(A₀ + A₁)` gives w, with D/3 so that a cylinder of equilateral triangles stores ½ D
//! κ² per area ([`CurvatureHinge`](cloth_core::energy::CurvatureHinge) has each step, after Bergou et al. 2006, whose
//! K₀ is q).
//!
//! *Nearest to F = U Σ Vᵀ* is p = U clamp(Σ) Vᵀ: ‖F − p‖² = ‖F‖² − 2 F:p + ‖p‖², and F:p ≤ Σ σᵢ(F) σᵢ(p) (von Neumann),
//! with equality for p with the singular vectors of F. For two singular values: with p = Σ τⱼ aⱼ bⱼᵀ, F:p = Σᵢⱼ σᵢ τⱼ
//! (uᵢ·aⱼ)(vᵢ·bⱼ) ≤ Σᵢⱼ σᵢ τⱼ Dᵢⱼ, Dᵢⱼ = ½ ((uᵢ·aⱼ)² + (vᵢ·bⱼ)²). A row or column of D adds up to at most 1, as the uᵢ,
//! aⱼ, vᵢ and bⱼ are orthonormal. Put σ₁ = σ₂ + α and τ₁ = τ₂ + β with α, β ≥ 0: the sum is αβ D₁₁ + α τ₂ (D₁₁ + D₁₂) +
//! β σ₂ (D₁₁ + D₂₁) + σ₂ τ₂ Σ D ≤ αβ + α τ₂ + β σ₂ + 2 σ₂ τ₂ = σ₁ τ₁ + σ₂ τ₂. Then ‖F − p‖² ≥ Σ (σᵢ − τᵢ)², and what is
//! left is one clamp per σᵢ, which keeps their order; limits [1, 1] give U Vᵀ. F of a triangle is 3 × 2, so there are
//! no reflections to exclude: what is turned over in space is a rotation.
//!
//! *A tetrahedron* (`project` of [`ArapTetrahedron`](cloth_core::energy::ArapTetrahedron)) has F of 3 × 3, and its p
//! must be a rotation: with plain singular values U Vᵀ would be a reflection where det F < 0, and a tetrahedron turned
//! inside out would be at rest. So U and V are taken as rotations, and the smallest singular value gets the sign of det
//! F: σ₁ ≥ σ₂ ≥ |σ₃|. Then U Vᵀ is the nearest rotation: F:p = Σ σᵢ rᵢᵢ with the rotation r = Uᵀ p V. The diagonal of a
//! rotation with the unit quaternion (a, b, c, d) is (a² + b² − c² − d², a² − b² + c² − d², a² − b² − c² + d²), a mean
//! of (1, 1, 1), (1, −1, −1), (−1, 1, −1) and (−1, −1, 1) with the weights a², b², c² and d². Of these the first has
//! the largest Σ σᵢ rᵢᵢ, by 2 (σ₂ + σ₃) at least; it is that of r = I. `½ w Σ (σᵢ − 1)²` with σ₃ < 0 then pushes the
//! tetrahedron back through σ₃ = 0. p is unique where σ₂ + σ₃ > 0.
//!
//! *A triangle* (`project` of [`ArapTriangle`](cloth_core::energy::ArapTriangle) and
//! [`StrainLimitTriangle`](cloth_core::energy::StrainLimitTriangle)): the singular values of F = (f, g), 3 × 2, by one
//! rotation in the plane of the rest shape (a Jacobi rotation, which makes FᵀF diagonal). There is no iteration.
//! ```text
//! φ = ½ atan2(2 f·g, f·f − g·g),  c = cos φ,  s = sin φ
//! f' = c f + s g,  g' = c g − s f                    f'·g' = 0 and ‖f'‖ ≥ ‖g'‖
//! u₁ = f'/‖f'‖,  σ₁ = ‖f'‖;   g' ← g' − (u₁·g') u₁,  u₂ = g'/‖g'‖,  σ₂ = ‖g'‖
//! v₁ = (c, s),  v₂ = (−s, c)
//! p = σ₁' u₁ v₁ᵀ + σ₂' u₂ v₂ᵀ                        σ' = 1, or σ clamped to the limits
//! ```
//!
//! | F | p | continuous there |
//! |---|---|---|
//! | σ₁ = σ₂ > 0 | φ is arbitrary, the sum p is not | yes |
//! | turned over in space | its own nearest map: U Vᵀ has no sign to choose | yes |
//! | σ₂ = 0: a line | u₂ is some vector at right angles to u₁ | no: across it u₂ becomes −u₂ |
//! | F = 0: a point | u₁, u₂ are two fixed axes | no |
//!
//! "Zero" is a squared length of at most 10⁻²⁸⁰. A change dF changes U Vᵀ by at most ‖dF‖/σ₂: its derivative is 2/(σ₁ +
//! σ₂) for a turn in the plane of the triangle, 1/σₖ for one out of it, and 0 else. So a triangle pressed flat to a
//! line meets no infinite energy and passes through: `½ w ((σ₁ − 1)² + (σ₂ − 1)²)` has a ridge at σ₂ = 0, from which it
//! is pushed to either side. Turned over it is at rest as before; only the hinges to its neighbours are not. On
//! the ridge the energy is continuous and any of the nearest p bounds it, so the iteration descends from there too.
//! With a lower limit of 0 the set is convex, and p continuous everywhere.
//!
//! *The Hessian* of an element is `w Sᵀ (I − ∂p/∂z) S`, in which ∂p/∂z has no negative eigenvalue. Proof:
//! `½ ‖z − p‖² = ½ ‖z‖² − (p·z − ½ ‖p‖²)`, so the nearest p is the one in the set for which `p·z − ½ ‖p‖²` is largest.
//! For a fixed p that is linear in z, and the largest of linear functions is convex: call it φ(z). Its gradient is the
//! p that makes it largest, so ∂p/∂z = ∇²φ, the Hessian of a convex function. In closed form
//! ([`Projective::projected_hessian`] of each element):
//!
//! | set | eigenvalues of I − ∂p/∂z |
//! |---|---|
//! | sphere of radius r (spring, curved hinge, stitch) | 1 along z; 1 − r/‖z‖ across it, twice |
//! | maps without strain (triangle) | 1, three times; 1 − 2/(σ₁ + σ₂), a turn in the plane; 1 − 1/σₖ, out of it |
//! | rotations (tetrahedron) | 1, six times; 1 − 2/(σᵢ + σⱼ) for each of three pairs |
//! | limit of a spring, c = clamp(‖z‖) | 0 along z within the range, 1 beyond it; 1 − c/‖z‖ across it, twice |
//! | limit of a triangle, c = clamp(σ) | 0 or 1 likewise for each σₖ; 1 − (c₁ + c₂)/(σ₁ + σ₂), 1 − (c₁ − c₂)/(σ₁ − σ₂), 1 − cₖ/σₖ |
//! | a point (flat hinge, attachment) | 1 |
//!
//! *Why.* On a sphere ∂p/∂z = (r/‖z‖) (I − n nᵀ), n = z/‖z‖; beyond the range of a limit c in the place of r, and
//! within it p = z, so I − ∂p/∂z = 0 (in the table c = ‖z‖). A set of maps is the same after a rotation Q of space or R
//! of the rest shape, so p(QF) = Q p(F) and p(FR) = p(F) R. Turned by a small angle δ, F = Σ σₖ uₖ vₖᵀ and p = Σ cₖ uₖ
//! vₖᵀ change by
//! ```text
//! in space, from u₁ to u₂       dF = δ (σ₁ u₂ v₁ᵀ − σ₂ u₁ v₂ᵀ),  dp = δ (c₁ u₂ v₁ᵀ − c₂ u₁ v₂ᵀ)
//! at rest, from v₁ to v₂        dF = δ (σ₁ u₁ v₂ᵀ − σ₂ u₂ v₁ᵀ),  dp = δ (c₁ u₁ v₂ᵀ − c₂ u₂ v₁ᵀ)
//! their difference              dF = δ (σ₁ + σ₂) T,  dp = δ (c₁ + c₂) T,   T = u₂ v₁ᵀ − u₁ v₂ᵀ, a turn
//! their sum                     dF = δ (σ₁ − σ₂) Z,  dp = δ (c₁ − c₂) Z,   Z = u₂ v₁ᵀ + u₁ v₂ᵀ, a shear
//! out of the plane, uₖ to u₃    dF = δ σₖ u₃ vₖᵀ,  dp = δ cₖ u₃ vₖᵀ        (3 × 2 only)
//! a stretch                     dF = δ uₖ vₖᵀ,  dp = δ c′(σₖ) uₖ vₖᵀ       c′ is 0 or 1
//! ```
//! so each direction is an eigenvector of ∂p/∂z, with the quotient of dp and dF for its eigenvalue. There are as many
//! of them as F has entries: 1 + 1 + 2 + 2 = 6 for 3 × 2, and T and Z for three pairs and three stretches, 9, for 3 × 3
//! (with σ₃ < 0 too, as U and V are rotations). Where all cₖ are 1, Z and stretches have 0. At σ₁ = σ₂ the quotient of
//! Z has the limit c′.
//!
//! One below zero belongs to a compressed element, whose energy falls when it turns. H has its absolute value
//! ([`Convexity::Abs`](cloth_core::element::Convexity::Abs)), and 1 if that is more, element by element, so each adds a
//! positive semi-definite matrix, and `H = M/Δt² + Σ w Sᵀ |I − ∂p/∂z| S` is positive definite, at least M/Δt², and at
//! most `M/Δt² + Σ w SᵀS` over the same elements: A, for the elements that A has.

use crate::batch::{BATCH_SIZE, projected_hessians_on_spheres, unpacked};
use crate::global::Term;
use crate::lattice::{ElementProlongation, PaddedBlock};
use crate::vertex_blocks::VertexBlocks;
use cloth_core::element::{Element, Projective};
use cloth_core::error::not_negative;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::method::block_matrix::BlockPattern;
use cloth_core::method::family::{check_vertices, invalid_element};
use cloth_core::method::multigrid::Prolongation;
use cloth_core::method::parallel::wide;
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;
use std::fmt::Debug;

/// Takes one entry of the matrix `Σ w SᵀS`: row, column, value (N/m).
pub(crate) type EntrySink<'a> = dyn FnMut(u32, u32, Real) + 'a;

/// Sums over all elements of one type, behind a trait object.
pub(crate) trait Projections: Debug + Send + Sync {
    /// Whether the projections are the same for all positions, so that the energy is quadratic.
    fn is_constant(&self) -> bool;

    /// Sets the elements to a time (s).
    fn set_time(&mut self, time: Real);

    /// Hands over the entries of the lower half of `Σ w SᵀS`.
    fn add_matrix(&self, entry: &mut EntrySink<'_>);

    /// Adds the gradient `Σ w Sᵀ(S x − p)` at x (m) to `out` (N) if the projections are constant, else nothing.
    fn add_constant_gradient(&mut self, x: &[Vec3], out: &mut [Vec3]);

    /// Adds the gradient `Σ w Sᵀ(S x − p)` at x (m) to `out` (N) and returns the energy `½ Σ w ‖S x − p‖²` (J), unless
    /// the projections are constant.
    fn add_gradient(&mut self, x: &[Vec3], out: &mut [Vec3]) -> Real;

    /// Takes away the element that was given as number `element`, and hands over what that adds to `Σ w SᵀS`: the rows
    /// of its operator, with the weight −w. `None` if there is no such element.
    fn remove(&mut self, element: usize, terms: &mut Vec<Term>) -> Option<()>;

    /// Hands over the vertices of each element.
    fn for_each_stencil(&self, visit: &mut dyn FnMut(&[u32]));

    /// `S P` of the elements, for matrices with `pattern` on a space from which P leads to the vertices.
    fn prolongation(
        &self,
        to_vertices: &Prolongation,
        pattern: &BlockPattern,
    ) -> ElementProlongation;

    /// Adds `Pᵀ (Σ w Sᵀ (I − ∂p/∂z) S) P` at x (m) to a matrix on that pattern (N/m), or nothing if S P is empty.
    fn add_stiffness(&self, on: &ElementProlongation, x: &[Vec3], out: &mut [PaddedBlock]);
}

/// The state of an element that the caller gave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slot {
    At(u32),
    /// It has no weight, and is not kept.
    Weightless,
    Removed,
}

/// All elements of one kind that have a weight.
#[derive(Debug)]
pub(crate) struct Family<const N: usize, const K: usize, E> {
    elements: Vec<E>,
    /// Index in `elements` of each element that was given.
    slots: Vec<Slot>,
    /// Whether all of them project to a sphere.
    are_spheres: bool,
    blocks: VertexBlocks,
}

impl<const N: usize, const K: usize, E: Projective<N, K>> Family<N, K, E> {
    /// Leaves out the elements that have no weight, and sorts the others for the sums. Of an element vertices,
    /// weight, and that its numbers are numbers are checked: not the sign of a rest length, for instance.
    pub(crate) fn new(mut elements: Vec<E>, particles: &Particles) -> Result<Self, BuildError> {
        check_vertices(&elements, particles.len())?;
        for (number, element) in elements.iter().enumerate() {
            let weight = not_negative("weight of an element", element.weight());
            weight.map_err(|reason| invalid_element::<E>(number, reason))?;
        }
        let mut slots = vec![Slot::Weightless; elements.len()];
        let numbered = (0u32..).zip(&elements);
        let weighted = numbered.filter(|(_, element)| element.weight() > 0.0);
        let order = sorted(
            weighted
                .map(|(given, element)| (key(element), given))
                .collect(),
        );
        for (at, &given) in (0..).zip(&order) {
            slots[given as usize] = Slot::At(at);
        }
        elements = order
            .iter()
            .map(|&given| elements[given as usize])
            .collect();
        Ok(Self {
            are_spheres: K == 1 && elements.iter().all(|element| element.sphere().is_some()),
            elements,
            slots,
            blocks: VertexBlocks::new(particles.len()),
        })
    }

    /// Adds `Σ w Sᵀ(S x − p)` to `out` and returns `½ Σ w ‖S x − p‖²`.
    fn sum(&mut self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        self.blocks.sum(&self.elements, self.are_spheres, x, out)
    }
}

impl<const N: usize, const K: usize, E: Projective<N, K>> Projections for Family<N, K, E> {
    fn is_constant(&self) -> bool {
        E::PROJECTION_IS_CONSTANT
    }

    fn set_time(&mut self, time: Real) {
        if E::CHANGES_WITH_TIME {
            self.elements.iter_mut().for_each(|e| e.set_time(time));
        }
    }

    fn add_matrix(&self, entry: &mut EntrySink<'_>) {
        for element in &self.elements {
            let vertices = element.vertices();
            let operator = element.operator();
            for i in 0..N {
                for j in 0..N {
                    if vertices[i] >= vertices[j] {
                        let product: Real = operator.iter().map(|row| row[i] * row[j]).sum();
                        entry(vertices[i], vertices[j], element.weight() * product);
                    }
                }
            }
        }
    }

    fn add_constant_gradient(&mut self, x: &[Vec3], out: &mut [Vec3]) {
        if E::PROJECTION_IS_CONSTANT {
            self.sum(x, out);
        }
    }

    fn add_gradient(&mut self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        if E::PROJECTION_IS_CONSTANT {
            return 0.0;
        }
        self.sum(x, out)
    }

    fn remove(&mut self, element: usize, terms: &mut Vec<Term>) -> Option<()> {
        let slot = self.slots.get_mut(element)?;
        let at = match *slot {
            Slot::At(at) => at,
            Slot::Weightless => {
                *slot = Slot::Removed;
                return Some(());
            }
            Slot::Removed => return None,
        };
        *slot = Slot::Removed;
        // The order of the others stays: sums come out as without the element.
        let gone = self.elements.remove(at as usize);
        for slot in &mut self.slots {
            if let Slot::At(after) = slot
                && *after > at
            {
                *after -= 1;
            }
        }
        self.blocks.clear();
        terms.extend(gone.operator().map(|row| Term {
            column: gone.vertices().into_iter().zip(row).collect(),
            weight: -gone.weight(),
        }));
        Some(())
    }

    fn for_each_stencil(&self, visit: &mut dyn FnMut(&[u32])) {
        self.elements.iter().for_each(|e| visit(&e.vertices()));
    }

    fn prolongation(
        &self,
        to_vertices: &Prolongation,
        pattern: &BlockPattern,
    ) -> ElementProlongation {
        ElementProlongation::of(&self.elements, to_vertices, pattern)
    }

    fn add_stiffness(&self, on: &ElementProlongation, x: &[Vec3], out: &mut [PaddedBlock]) {
        if on.of_element.is_empty() {
            return;
        }
        let (elements, are_spheres) = (&self.elements, self.are_spheres);
        wide(
            #[inline(always)]
            || add_stiffness(elements, on, are_spheres, x, out),
        );
    }
}

/// Elements in the order of these numbers have their vertices near one another; on a mesh that is numbered along rows
/// all of one direction come together, first those of the even vertices, then those of the odd ones.
pub(crate) fn key<const N: usize, E: Element<N>>(element: &E) -> [u32; 4] {
    let vertices = element.vertices();
    let (first, last) = (vertices[0], vertices[N - 1]);
    [first / WINDOW, last.wrapping_sub(first), first % 2, first]
}

/// The numbers of elements in the order of their keys; not generic, so that it is compiled once.
fn sorted(mut keyed: Vec<([u32; 4], u32)>) -> Vec<u32> {
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, given)| given).collect()
}

/// Vertices that elements stay with before they go on: few enough for positions and sums to stay in the nearest cache.
const WINDOW: u32 = 512;

/// Adds `Pᵀ w Sᵀ (I − ∂p/∂z) S P` of elements with their prolongation.
#[inline(always)]
fn add_stiffness<const N: usize, const K: usize, E: Projective<N, K>>(
    elements: &[E],
    prolongation: &ElementProlongation,
    are_spheres: bool,
    x: &[Vec3],
    blocks: &mut [PaddedBlock],
) {
    let mut prolongation = prolongation.each::<K>();
    for elements in elements.chunks(BATCH_SIZE) {
        let on_spheres = if are_spheres {
            projected_hessians_on_spheres(elements.iter(), x)
        } else {
            None
        };
        for (lane, element) in elements.iter().enumerate() {
            let hessian = match &on_spheres {
                Some(packed) => [[unpacked(&packed[lane]); K]; K],
                None => {
                    let z = apply(&element.operator(), &gather(x, element.vertices()));
                    let weight = element.weight();
                    element
                        .projected_hessian(z)
                        .map(|row| row.map(|block| block * weight))
                }
            };
            let Some((slots, columns)) = prolongation.next() else {
                return;
            };
            for k in 0..K {
                for l in 0..K {
                    let own = PaddedBlock::from(&hessian[k][l]);
                    let mut slots = slots.iter();
                    for (i, a) in columns[k].iter().enumerate() {
                        for (b, &slot) in columns[l][..=i].iter().zip(&mut slots) {
                            blocks[slot as usize].add(&own, a * b);
                        }
                    }
                }
            }
        }
    }
}

/// The local step of one family alone, for those who want to time it or look at it.
#[derive(Debug)]
pub struct LocalStep(Box<dyn Projections>);

impl LocalStep {
    /// Takes the elements over, without those that have no weight.
    ///
    /// # Errors
    /// As for [`PdBuilder::build`](crate::PdBuilder::build).
    pub fn new<const N: usize, const K: usize, E: Projective<N, K>>(
        particles: &Particles,
        elements: Vec<E>,
    ) -> Result<Self, BuildError> {
        Ok(Self(Box::new(Family::new(elements, particles)?)))
    }

    /// Adds the gradient `Σ w Sᵀ(S x − p)` at the positions x (m) to `out` (N), one of each per particle, and returns
    /// the energy `½ Σ w ‖S x − p‖²` (J). Elements whose `PROJECTION_IS_CONSTANT` is set add nothing and return 0,
    /// since the solver sums them as one matrix (`quadratic.rs`): check those with the flag off.
    ///
    /// # Panics
    /// If a vertex of an element has no position or no entry in `out`.
    pub fn add_gradient(&mut self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        self.0.add_gradient(x, out)
    }
}

/// `z = S x`.
#[inline(always)]
pub(crate) fn apply<const N: usize, const K: usize>(
    operator: &[[Real; N]; K],
    x: &[Vec3; N],
) -> [Vec3; K] {
    let mut z = [Vec3::zeros(); K];
    for k in 0..K {
        z[k] = x[0] * operator[k][0];
        for i in 1..N {
            z[k] += x[i] * operator[k][i];
        }
    }
    z
}

/// The entry of vertex `i` in `Sᵀ force`.
#[inline(always)]
pub(crate) fn force_on<const N: usize, const K: usize>(
    operator: &[[Real; N]; K],
    force: &[Vec3; K],
    i: usize,
) -> Vec3 {
    let mut sum = force[0] * operator[0][i];
    for k in 1..K {
        sum += force[k] * operator[k][i];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_core::cloth::{Cloth, Membrane};
    use cloth_core::mesh::generate::{Diagonals, grid};
    use cloth_core::method::block_matrix::{BlockMatrix, PatternBuilder};

    /// Where nothing is compressed, `Σ w Sᵀ (I − ∂p/∂z) S` is the derivative of the gradient. The second family is
    /// stored with its ends turned.
    #[test]
    fn the_stiffness_of_taut_springs_is_the_derivative_of_their_gradient() {
        let mesh = grid(6, 5, 1.0, 1.0, Diagonals::Alternating).unwrap();
        let cloth = Cloth {
            areal_density: 0.2,
            membrane: Membrane::SpringStiffness(1e3),
            bending_rigidity: 1e-3,
        };
        let model = cloth.on(&mesh).unwrap();
        let count = mesh.vertex_count();
        let mut turned = model.springs.clone();
        turned
            .iter_mut()
            .for_each(|spring| spring.vertices.reverse());
        let mut pattern = PatternBuilder::new(count);
        pattern.add(&model.springs);
        let pattern = pattern.build();
        let own: Vec<[(u32, Real); 1]> = (0..count).map(|v| [(v as u32, 1.0)]).collect();
        let every_vertex = Prolongation::new(own.iter().map(|row| &row[..]), count);
        let wave = |scale: Real| {
            let wave = move |v: usize, axis: usize| scale * ((v * (axis + 2)) as Real).sin();
            (0..count).map(move |v| Vec3::from_fn(|axis, _| wave(v, axis)))
        };
        let x: Vec<Vec3> = mesh
            .positions()
            .iter()
            .zip(wave(0.01))
            .map(|(x, d)| x * 1.3 + d)
            .collect();
        let along: Vec<Vec3> = wave(1.0).collect();
        let step = 1e-5;
        let ends = [step, -step]
            .map(|step| -> Vec<Vec3> { x.iter().zip(&along).map(|(x, d)| x + d * step).collect() });
        for springs in [model.springs, turned] {
            let mut family = Family::new(springs, &model.particles).unwrap();
            let operator = family.prolongation(&every_vertex, &pattern);
            let mut blocks = vec![PaddedBlock::default(); pattern.block_count()];
            family.add_stiffness(&operator, &x, &mut blocks);
            let mut matrix = BlockMatrix::zeros(pattern.clone());
            for (block, sum) in matrix.blocks_mut().iter_mut().zip(&blocks) {
                *block = sum.block();
            }
            let mut product = vec![Vec3::zeros(); count];
            matrix.multiply(&along, &mut product);
            let mut gradients = [vec![Vec3::zeros(); count], vec![Vec3::zeros(); count]];
            for (x, out) in ends.iter().zip(&mut gradients) {
                family.add_gradient(x, out);
            }
            for v in 0..count {
                let expected = (gradients[0][v] - gradients[1][v]) / (2.0 * step);
                let error = (product[v] - expected).norm();
                assert!(error < 1e-4, "{v}: {error:e} N/m");
            }
        }
    }
}
