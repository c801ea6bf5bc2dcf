//! A family: all elements of one kind, with the kind forgotten. One virtual call per family, none per element.

mod assembly;
mod incidence;

pub use assembly::Assembly;
pub use incidence::Incidence;

use crate::element::{Convexity, Energy};
use crate::error::OutOfRange;
use crate::math::{Mat3, Real, Vec3, gather};
use crate::method::block_matrix::{BlockMatrix, BlockPattern, PatternBuilder};
use crate::method::chunked::{CHUNK, map_reduce};
use crate::method::coloring::greedy_vertex_colors;
use crate::step::BuildError;
use assembly::{FamilySlots, Linearization};
use incidence::{FamilyIncidence, VertexTerms};
use std::fmt::Debug;
use std::sync::Arc;

/// Sums over all elements of one kind. Implemented by the families of [`Energies`] only.
trait EnergyFamily: Debug + Send + Sync {
    /// Vertices of an element.
    fn stencil_size(&self) -> usize;
    fn has_numerical_eigenvalues(&self) -> bool;
    fn has_jumps(&self) -> bool;
    fn changes_with_time(&self) -> bool;
    fn is_quadratic(&self) -> bool;
    fn set_time(&mut self, time: Real);
    fn value(&self, x: &[Vec3]) -> Real;
    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real;
    fn add_hessian_product(&self, x: &[Vec3], p: &[Vec3], convexity: Convexity, out: &mut [Vec3]);
    fn for_each_stencil(&self, visit: &mut dyn FnMut(&[u32]));
    fn incidence(&self, vertex_count: usize) -> FamilyIncidence;
    fn add_at_vertices(
        &self,
        incidence: &FamilyIncidence,
        x: &[Vec3],
        convexity: Convexity,
        out: VertexTerms<'_>,
    );
    fn slots(&self, pattern: &Arc<BlockPattern>) -> FamilySlots;
    fn add_hessian(
        &self,
        slots: &FamilySlots,
        x: &[Vec3],
        by: &Linearization<'_>,
        out: &mut BlockMatrix,
    );
}

/// The elements, and which of them touch which chunk of [`CHUNK`] vertices.
///
/// Each chunk visits the elements that touch it and adds to its own vertices only; an element on the border of two
/// chunks is visited by both. So no two threads write to the same place, and every vertex adds up the same numbers in
/// the same order on any number of threads. The energy of an element is counted by the chunk of its first vertex.
#[derive(Clone, Debug)]
struct Family<const N: usize, E> {
    elements: Vec<E>,
    /// The elements at each chunk, ascending; empty if there is one chunk only.
    at_chunk: Vec<Vec<u32>>,
}

impl<const N: usize, E: Energy<N>> Family<N, E> {
    fn new(elements: Vec<E>, vertex_count: usize) -> Self {
        let chunks = vertex_count.div_ceil(CHUNK);
        let mut at_chunk = Vec::new();
        if chunks > 1 {
            at_chunk = vec![Vec::new(); chunks];
            for (element, stencil) in (0u32..).zip(&elements) {
                for vertex in stencil.vertices() {
                    let list = &mut at_chunk[vertex as usize / CHUNK];
                    if list.last() != Some(&element) {
                        list.push(element);
                    }
                }
            }
        }
        Self { elements, at_chunk }
    }

    /// Visits the elements that touch the chunk that begins at a vertex.
    #[inline(always)]
    fn for_each_at(&self, start: usize, mut visit: impl FnMut(usize, &E)) {
        match self.at_chunk.get(start / CHUNK) {
            Some(list) => {
                for &element in list {
                    visit(element as usize, &self.elements[element as usize]);
                }
            }
            None => {
                for (number, element) in self.elements.iter().enumerate() {
                    visit(number, element);
                }
            }
        }
    }
}

impl<const N: usize, E: Energy<N>> EnergyFamily for Family<N, E> {
    fn stencil_size(&self) -> usize {
        N
    }

    fn has_numerical_eigenvalues(&self) -> bool {
        E::HAS_NUMERICAL_EIGENVALUES
    }

    fn has_jumps(&self) -> bool {
        E::HAS_JUMPS && !self.elements.is_empty()
    }

    fn changes_with_time(&self) -> bool {
        E::CHANGES_WITH_TIME
    }

    fn is_quadratic(&self) -> bool {
        E::HESSIAN_IS_CONSTANT
    }

    fn set_time(&mut self, time: Real) {
        if E::CHANGES_WITH_TIME {
            self.elements.iter_mut().for_each(|e| e.set_time(time));
        }
    }

    fn value(&self, x: &[Vec3]) -> Real {
        let sum = |e: &E| e.value(&gather(x, e.vertices()));
        self.elements.iter().map(sum).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        let [total] = map_reduce(
            out,
            #[inline(always)]
            |start, out: &mut [Vec3]| {
                let mut total = 0.0;
                self.for_each_at(
                    start,
                    #[inline(always)]
                    |_, element| {
                        let vertices = element.vertices();
                        let (value, gradient) = element.value_and_gradient(&gather(x, vertices));
                        if (vertices[0] as usize).wrapping_sub(start) < out.len() {
                            total += value;
                        }
                        for i in 0..N {
                            // Wraps to a large number for a vertex before the chunk, and finds nothing.
                            let place = (vertices[i] as usize).wrapping_sub(start);
                            if let Some(out) = out.get_mut(place) {
                                *out += gradient[i];
                            }
                        }
                    },
                );
                [total]
            },
        );
        total
    }

    fn add_hessian_product(&self, x: &[Vec3], p: &[Vec3], convexity: Convexity, out: &mut [Vec3]) {
        map_reduce(
            out,
            #[inline(always)]
            |start, out: &mut [Vec3]| {
                self.for_each_at(
                    start,
                    #[inline(always)]
                    |_, element| {
                        let vertices = element.vertices();
                        let (x, p) = (gather(x, vertices), gather(p, vertices));
                        let product = element.hessian_product(&x, &p, convexity);
                        for i in 0..N {
                            let place = (vertices[i] as usize).wrapping_sub(start);
                            if let Some(out) = out.get_mut(place) {
                                *out += product[i];
                            }
                        }
                    },
                );
                []
            },
        );
    }

    fn for_each_stencil(&self, visit: &mut dyn FnMut(&[u32])) {
        for element in &self.elements {
            visit(&element.vertices());
        }
    }

    fn incidence(&self, vertex_count: usize) -> FamilyIncidence {
        FamilyIncidence::of(&self.elements, vertex_count)
    }

    fn add_at_vertices(
        &self,
        incidence: &FamilyIncidence,
        x: &[Vec3],
        convexity: Convexity,
        out: VertexTerms<'_>,
    ) {
        incidence.add(&self.elements, x, convexity, out);
    }

    fn slots(&self, pattern: &Arc<BlockPattern>) -> FamilySlots {
        FamilySlots::of(self, pattern)
    }

    fn add_hessian(
        &self,
        slots: &FamilySlots,
        x: &[Vec3],
        by: &Linearization<'_>,
        out: &mut BlockMatrix,
    ) {
        slots.add(self, x, by, out);
    }
}

/// The elastic energy of a cloth: a sum of families (J).
///
/// ```
/// use cloth_core::{energy::Spring, method::family::Energies, math::Vec3};
/// let spring = Spring { vertices: [0, 1], rest_length: 1.0, stiffness: 10.0 };
/// let energies = Energies::new(2).with(vec![spring])?;
/// let stretched = [Vec3::zeros(), Vec3::new(1.5, 0.0, 0.0)];
/// assert_eq!(energies.value(&stretched), 0.5 * 10.0 * 0.5 * 0.5);
/// # Ok::<(), cloth_core::step::BuildError>(())
/// ```
#[derive(Debug)]
pub struct Energies {
    vertex_count: usize,
    /// How many families were added, those without elements too.
    given: usize,
    families: Vec<Box<dyn EnergyFamily>>,
}

impl Energies {
    /// Whether all forces are linear in the positions.
    #[must_use]
    pub fn are_quadratic(&self) -> bool {
        self.families.iter().all(|family| family.is_quadratic())
    }

    /// Whether a second derivative jumps within reach ([`Element::HAS_JUMPS`](crate::element::Element::HAS_JUMPS)).
    #[must_use]
    pub fn have_jumps(&self) -> bool {
        self.families.iter().any(|family| family.has_jumps())
    }

    /// No energy on `vertex_count` vertices.
    #[must_use]
    pub fn new(vertex_count: usize) -> Self {
        Self {
            vertex_count,
            given: 0,
            families: Vec::new(),
        }
    }

    /// Adds a family. An empty one is dropped.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`] or [`BuildError::RepeatedVertex`] if an element names a vertex that does not exist,
    /// or one twice; [`BuildError::InvalidElement`] for a number of one.
    pub fn with<const N: usize, E: Energy<N>>(self, elements: Vec<E>) -> Result<Self, BuildError> {
        if E::IS_IN_ELEMENTS {
            self.with_elements(vec![E::into_elements(elements)])
        } else {
            self.with_family(elements)
        }
    }

    /// The same, compiled for these elements here.
    pub(crate) fn with_family<const N: usize, E: Energy<N>>(
        mut self,
        elements: Vec<E>,
    ) -> Result<Self, BuildError> {
        let number = self.given;
        self.given += 1;
        check_vertices(&elements, self.vertex_count).map_err(|error| error.in_family(number))?;
        if !elements.is_empty() {
            self.families
                .push(Box::new(Family::new(elements, self.vertex_count)));
        }
        Ok(self)
    }

    /// Number of vertices V.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Sets the elements to a time (s); see [`Element::set_time`](crate::element::Element::set_time).
    pub fn set_time(&mut self, time: Real) {
        for family in &mut self.families {
            family.set_time(time);
        }
    }

    /// The part of `E(x)` (J, x in m) whose elements change with time. Its change while the vertices stay where they
    /// are is work done on the cloth.
    ///
    /// # Panics
    /// If `x` does not have one entry per vertex.
    #[must_use]
    pub fn timed_value(&self, x: &[Vec3]) -> Real {
        self.check_length(x);
        let timed = self.families.iter().filter(|f| f.changes_with_time());
        timed.map(|family| family.value(x)).sum()
    }

    /// `E(x)` (J), x in m.
    ///
    /// # Panics
    /// If `x` does not have one entry per vertex.
    #[must_use]
    pub fn value(&self, x: &[Vec3]) -> Real {
        self.check_length(x);
        self.families.iter().map(|family| family.value(x)).sum()
    }

    /// Adds `∂E/∂x` (N) at x (m) to `out`, and returns `E(x)` (J).
    ///
    /// # Panics
    /// If a list does not have one entry per vertex.
    pub fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        self.check_length(x);
        self.check_length(out);
        let mut total = 0.0;
        for family in &self.families {
            total += family.add_gradient(x, out);
        }
        total
    }

    /// Adds `∂²E/∂x² p` (N) at x (m), for displacements `p` (m), to `out`, without a matrix.
    ///
    /// # Panics
    /// If a list does not have one entry per vertex.
    pub fn add_hessian_product(
        &self,
        x: &[Vec3],
        p: &[Vec3],
        convexity: Convexity,
        out: &mut [Vec3],
    ) {
        for list in [x, p, &*out] {
            self.check_length(list);
        }
        for family in &self.families {
            family.add_hessian_product(x, p, convexity, out);
        }
    }

    fn check_length(&self, list: &[Vec3]) {
        assert_eq!(list.len(), self.vertex_count, "one entry per vertex");
    }

    /// Visits the vertex of every element that has only one, and so ties it to a place.
    pub fn for_each_anchor(&self, mut visit: impl FnMut(u32)) {
        for family in self.families.iter().filter(|f| f.stencil_size() == 1) {
            family.for_each_stencil(&mut |stencil| visit(stencil[0]));
        }
    }

    /// Which elements each vertex belongs to, for [`Energies::add_at_vertices`].
    #[must_use]
    pub fn incidence(&self) -> Incidence {
        let families = self.families.iter();
        Incidence::new(families.map(|family| family.incidence(self.vertex_count)))
    }

    /// Vertices in sets of which no two belong to one element, so that moving one changes nothing that another of its
    /// set sees: greedily coloured, ascending in each set.
    #[must_use]
    pub fn vertex_colors(&self) -> Vec<Vec<u32>> {
        let mut builder = PatternBuilder::new(self.vertex_count);
        for family in &self.families {
            family.for_each_stencil(&mut |stencil| builder.add_pairs(stencil, |_| true));
        }
        greedy_vertex_colors(&builder.build())
    }

    /// Adds `∂E/∂x_v` (N) and the diagonal block `∂²E/∂x_v²` (N/m) of each of the `vertices` to its place in
    /// `gradient` and `hessian`: what methods need that move one vertex, or one set of [`Energies::vertex_colors`], at
    /// a time. The same bits at any number of threads.
    ///
    /// # Panics
    /// If the incidence is that of another energy, a vertex does not exist, or the lists differ in length.
    pub fn add_at_vertices(
        &self,
        incidence: &Incidence,
        vertices: &[u32],
        x: &[Vec3],
        convexity: Convexity,
        gradient: &mut [Vec3],
        hessian: &mut [Mat3],
    ) {
        let lengths = [gradient.len(), hessian.len(), vertices.len()];
        assert!(
            lengths.windows(2).all(|two| two[0] == two[1]),
            "one place per vertex"
        );
        let incidences = incidence.families();
        assert_eq!(
            incidences.len(),
            self.families.len(),
            "incidence of another energy"
        );
        for (family, incidence) in self.families.iter().zip(incidences) {
            let out = VertexTerms {
                vertices,
                gradient,
                hessian,
            };
            family.add_at_vertices(incidence, x, convexity, out);
        }
    }

    /// Where the blocks of the Hessian go, all of them.
    #[must_use]
    pub fn assembly(&self) -> Assembly {
        let mut builder = PatternBuilder::new(self.vertex_count);
        for family in &self.families {
            family.for_each_stencil(&mut |stencil| builder.add_pairs(stencil, |_| true));
        }
        Assembly::new(self, builder.build(), false)
    }

    /// The same for an approximation with fewer blocks, for preconditioners: pairs of vertices that only elements of
    /// more than three vertices couple, the wing tips of hinges, are *lumped*. (Lumped masses are another thing:
    /// [`Particles`](crate::particles::Particles) has them.)
    ///
    /// - The block B of such a pair is added to the diagonal blocks of both vertices instead: `x₂ᵀB x₃` becomes
    ///   `½ x₂ᵀB x₂ + ½ x₃ᵀB x₃`. The difference is `½ (x₂ − x₃)ᵀB (x₂ − x₃)`: nothing for a translation, and not
    ///   negative for any other displacement if B is positive semidefinite.
    /// - If B is not, its symmetric part S is taken, raised by `½ (√(2 ‖S‖² − (tr S)²) − tr S)` times the identity if
    ///   that is positive. For a rank of at most two this is minus the lower eigenvalue, so that none is negative; of
    ///   the gradients a and b of one constraint, `S = ½ (a bᵀ + b aᵀ)` has such a rank.
    /// - A vertex that has no other elements keeps its pairs.
    /// - Elements with [numerical eigenvalues](crate::element::Element::HAS_NUMERICAL_EIGENVALUES) are taken by
    ///   [`Convexity::GaussNewton`], whatever is asked for: their eigenvalues cost more than all else, and do not save
    ///   iterations.
    #[must_use]
    pub fn lumped_assembly(&self) -> Assembly {
        let mut builder = PatternBuilder::new(self.vertex_count);
        let mut is_covered = vec![false; self.vertex_count];
        let (small, large): (Vec<_>, Vec<_>) = self
            .families
            .iter()
            .partition(|family| family.stencil_size() <= 3);
        for family in small {
            family.for_each_stencil(&mut |stencil| {
                builder.add_pairs(stencil, |_| true);
                if stencil.len() > 1 {
                    stencil.iter().for_each(|&v| is_covered[v as usize] = true);
                }
            });
        }
        for family in large {
            family.for_each_stencil(&mut |stencil| {
                builder.add_pairs(stencil, |pair| {
                    !pair.map(|v| is_covered[v as usize]).contains(&true)
                });
            });
        }
        Assembly::new(self, builder.build(), true)
    }

    /// Adds `scale · ∂²E/∂x²` (N/m) to a matrix on the pattern of the assembly.
    ///
    /// # Panics
    /// If the assembly or the matrix is that of another energy.
    pub fn add_hessian(
        &self,
        assembly: &Assembly,
        x: &[Vec3],
        scale: Real,
        convexity: Convexity,
        out: &mut BlockMatrix,
    ) {
        self.add_by(assembly, x, &Linearization::At { scale, convexity }, out);
    }

    /// `∂²E/∂x²` (N/m) as a matrix of its own.
    #[must_use]
    pub fn hessian(&self, x: &[Vec3], convexity: Convexity) -> BlockMatrix {
        let assembly = self.assembly();
        let mut matrix = BlockMatrix::zeros(Arc::clone(assembly.pattern()));
        self.add_hessian(&assembly, x, 1.0, convexity, &mut matrix);
        matrix
    }

    /// Adds the Hessian of [`Energy::mixed_hessian`] (N/m), whose constraint values are those linearised at
    /// `from` (m) and taken at `to` (m).
    ///
    /// # Panics
    /// If the assembly or the matrix is that of another energy.
    pub fn add_mixed_hessian(
        &self,
        assembly: &Assembly,
        x: &[Vec3],
        from: &[Vec3],
        to: &[Vec3],
        out: &mut BlockMatrix,
    ) {
        self.add_by(assembly, x, &Linearization::Mixed { from, to }, out);
    }

    fn add_by(
        &self,
        assembly: &Assembly,
        x: &[Vec3],
        by: &Linearization<'_>,
        out: &mut BlockMatrix,
    ) {
        assert_eq!(
            assembly.families().len(),
            self.families.len(),
            "assembly of another energy"
        );
        for (family, slots) in self.families.iter().zip(assembly.families()) {
            let by = assembly.linearization(family.has_numerical_eigenvalues(), *by);
            family.add_hessian(slots, x, &by, out);
        }
    }
}

/// The name of a type without its path and its own types.
fn short_name<T>() -> &'static str {
    let whole = std::any::type_name::<T>();
    let path = whole.split('<').next().unwrap_or(whole);
    path.rsplit("::").next().unwrap_or(path)
}

/// For builders: why they refuse an element of a kind, by its number in its family.
#[must_use]
pub fn invalid_element<E>(element: usize, reason: OutOfRange) -> BuildError {
    BuildError::InvalidElement {
        kind: short_name::<E>(),
        family: None,
        element,
        reason,
    }
}

/// Whether every element names vertices that exist, and none twice, and has numbers in their range.
///
/// # Errors
/// [`BuildError::NoSuchVertex`], [`BuildError::RepeatedVertex`] or [`BuildError::InvalidElement`] for the first that
/// does not.
pub fn check_vertices<const N: usize, E: crate::element::Element<N>>(
    elements: &[E],
    vertex_count: usize,
) -> Result<(), BuildError> {
    for (element, stencil) in elements.iter().enumerate() {
        let vertices = stencil.vertices();
        for (corner, &vertex) in vertices.iter().enumerate() {
            if vertex as usize >= vertex_count {
                return Err(BuildError::NoSuchVertex {
                    kind: short_name::<E>(),
                    family: None,
                    element,
                    vertex,
                    vertex_count,
                });
            }
            if vertices[..corner].contains(&vertex) {
                return Err(BuildError::RepeatedVertex {
                    kind: short_name::<E>(),
                    family: None,
                    element,
                    vertex,
                });
            }
        }
        let checked = stencil.check();
        checked.map_err(|reason| invalid_element::<E>(element, reason))?;
    }
    Ok(())
}
