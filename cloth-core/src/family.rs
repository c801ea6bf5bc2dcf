//! A family: all elements of one kind, with the kind forgotten. One virtual call per family, none per element.

use crate::block_matrix::{BlockMatrix, BlockPattern, PatternBuilder};
use crate::element::{Convexity, Energy};
use crate::math::{Mat3, Real, Vec3, gather};
use crate::step::BuildError;
use std::fmt::Debug;
use std::sync::Arc;

/// Sums over all elements of one kind. Implemented by the families of [`Energies`] only.
trait EnergyFamily: Debug + Send + Sync {
    fn value(&self, x: &[Vec3]) -> Real;
    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]);
    fn add_hessian_product(&self, x: &[Vec3], p: &[Vec3], convexity: Convexity, out: &mut [Vec3]);
    fn add_pattern(&self, pattern: &mut PatternBuilder);
    fn bind(&mut self, pattern: &BlockPattern);
    fn add_hessian(&self, x: &[Vec3], scale: Real, convexity: Convexity, out: &mut BlockMatrix);
}

#[derive(Clone, Debug)]
struct Family<const N: usize, E> {
    elements: Vec<E>,
    /// Place of each block of the lower half of each element's Hessian: `N (N + 1)/2` numbers an element, filled by `bind`.
    slots: Vec<u32>,
    /// The Hessian of the whole family, if it is constant: blocks and their places, filled by `bind`.
    constant: Vec<(u32, Mat3)>,
}

impl<const N: usize, E: Energy<N>> EnergyFamily for Family<N, E> {
    fn value(&self, x: &[Vec3]) -> Real {
        let sum = |e: &E| e.value(&gather(x, e.vertices()));
        self.elements.iter().map(sum).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for element in &self.elements {
            let vertices = element.vertices();
            let gradient = element.gradient(&gather(x, vertices));
            for i in 0..N {
                out[vertices[i] as usize] += gradient[i];
            }
        }
    }

    fn add_hessian_product(&self, x: &[Vec3], p: &[Vec3], convexity: Convexity, out: &mut [Vec3]) {
        for element in &self.elements {
            let vertices = element.vertices();
            let (x, p) = (gather(x, vertices), gather(p, vertices));
            let product = element.hessian_product(&x, &p, convexity);
            for i in 0..N {
                out[vertices[i] as usize] += product[i];
            }
        }
    }

    fn add_pattern(&self, pattern: &mut PatternBuilder) {
        pattern.add(&self.elements);
    }

    fn bind(&mut self, pattern: &BlockPattern) {
        self.slots.clear();
        self.slots
            .reserve_exact(self.elements.len() * N * (N + 1) / 2);
        for element in &self.elements {
            let vertices = element.vertices();
            for i in 0..N {
                for j in 0..=i {
                    let slot = pattern.slot(vertices[i], vertices[j]);
                    self.slots
                        .push(slot.expect("the pattern was made from these elements"));
                }
            }
        }
        if E::HESSIAN_IS_CONSTANT {
            let mut sum = vec![Mat3::zeros(); pattern.block_count()];
            self.add_elements(|_| [Vec3::zeros(); N], 1.0, Convexity::Exact, &mut sum);
            self.slots.sort_unstable();
            self.slots.dedup();
            let slots = self.slots.iter();
            self.constant = slots.map(|&slot| (slot, sum[slot as usize])).collect();
            self.slots = Vec::new();
        }
    }

    fn add_hessian(&self, x: &[Vec3], scale: Real, convexity: Convexity, out: &mut BlockMatrix) {
        if E::HESSIAN_IS_CONSTANT {
            assert!(!self.constant.is_empty(), "{UNBOUND}");
            for (slot, block) in &self.constant {
                out.blocks_mut()[*slot as usize] += block * scale;
            }
        } else {
            let local = |vertices| gather(x, vertices);
            self.add_elements(local, scale, convexity, out.blocks_mut());
        }
    }
}

/// Why there is nothing to add.
const UNBOUND: &str = "bind_pattern comes before add_hessian";

impl<const N: usize, E: Energy<N>> Family<N, E> {
    /// Adds the Hessian of every element to the blocks of a matrix; `local` gives the positions (m) of its vertices.
    fn add_elements(
        &self,
        local: impl Fn([u32; N]) -> [Vec3; N],
        scale: Real,
        convexity: Convexity,
        blocks: &mut [Mat3],
    ) {
        let per_element = N * (N + 1) / 2;
        assert_eq!(
            self.slots.len(),
            per_element * self.elements.len(),
            "{UNBOUND}"
        );
        let slots = self.slots.chunks_exact(per_element);
        for (element, slots) in self.elements.iter().zip(slots) {
            let vertices = element.vertices();
            let hessian = element.hessian(&local(vertices), convexity);
            let mut slot = slots.iter();
            for i in 0..N {
                for j in 0..=i {
                    // The matrix keeps the block whose row is the larger vertex number.
                    let block = if vertices[i] >= vertices[j] {
                        &hessian[i][j]
                    } else {
                        &hessian[j][i]
                    };
                    blocks[*slot.next().expect("N (N + 1)/2 slots") as usize] += block * scale;
                }
            }
        }
    }
}

/// The elastic energy of a cloth: a sum of families (J).
///
/// ```
/// use cloth_core::{energy::Spring, family::Energies, math::Vec3};
/// let spring = Spring { vertices: [0, 1], rest_length: 1.0, stiffness: 10.0 };
/// let energies = Energies::new(2).with(vec![spring])?;
/// let stretched = [Vec3::zeros(), Vec3::new(1.5, 0.0, 0.0)];
/// assert_eq!(energies.value(&stretched), 0.5 * 10.0 * 0.5 * 0.5);
/// # Ok::<(), cloth_core::step::BuildError>(())
/// ```
#[derive(Debug)]
pub struct Energies {
    vertex_count: usize,
    families: Vec<Box<dyn EnergyFamily>>,
}

impl Energies {
    /// No energy on `vertex_count` vertices.
    #[must_use]
    pub fn new(vertex_count: usize) -> Self {
        Self {
            vertex_count,
            families: Vec::new(),
        }
    }

    /// Adds a family. An empty one is dropped.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`] if an element names a vertex that does not exist.
    pub fn with<const N: usize, E: Energy<N>>(
        mut self,
        elements: Vec<E>,
    ) -> Result<Self, BuildError> {
        check_vertices(&elements, self.vertex_count)?;
        if !elements.is_empty() {
            self.families.push(Box::new(Family {
                elements,
                slots: Vec::new(),
                constant: Vec::new(),
            }));
        }
        Ok(self)
    }

    /// Number of vertices V.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Number of families that are not empty.
    #[must_use]
    pub fn family_count(&self) -> usize {
        self.families.len()
    }

    /// `E(x)` (J).
    #[must_use]
    pub fn value(&self, x: &[Vec3]) -> Real {
        self.families.iter().map(|family| family.value(x)).sum()
    }

    /// Adds `∂E/∂x` (N) to `out`.
    pub fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for family in &self.families {
            family.add_gradient(x, out);
        }
    }

    /// Adds `∂²E/∂x² p` (N, for a displacement `p` in m) to `out`, without a matrix.
    pub fn add_hessian_product(
        &self,
        x: &[Vec3],
        p: &[Vec3],
        convexity: Convexity,
        out: &mut [Vec3],
    ) {
        for family in &self.families {
            family.add_hessian_product(x, p, convexity, out);
        }
    }

    /// The pattern of the Hessian, and the places of all blocks in it looked up. Call it once, before [`Energies::add_hessian`].
    #[must_use]
    pub fn bind_pattern(&mut self) -> Arc<BlockPattern> {
        let mut builder = PatternBuilder::new(self.vertex_count);
        for family in &self.families {
            family.add_pattern(&mut builder);
        }
        let pattern = builder.build();
        for family in &mut self.families {
            family.bind(&pattern);
        }
        pattern
    }

    /// Adds `scale · ∂²E/∂x²` (N/m) to a matrix on the pattern that [`Energies::bind_pattern`] gave.
    ///
    /// # Panics
    /// If [`Energies::bind_pattern`] was not called since the last family was added.
    pub fn add_hessian(
        &self,
        x: &[Vec3],
        scale: Real,
        convexity: Convexity,
        out: &mut BlockMatrix,
    ) {
        for family in &self.families {
            family.add_hessian(x, scale, convexity, out);
        }
    }
}

/// Whether every element names vertices that exist.
///
/// # Errors
/// [`BuildError::NoSuchVertex`] for the first that does not.
pub fn check_vertices<const N: usize, E: crate::element::Element<N>>(
    elements: &[E],
    vertex_count: usize,
) -> Result<(), BuildError> {
    for (element, stencil) in elements.iter().enumerate() {
        if let Some(vertex) = stencil
            .vertices()
            .into_iter()
            .find(|&v| v as usize >= vertex_count)
        {
            return Err(BuildError::NoSuchVertex {
                element,
                vertex,
                vertex_count,
            });
        }
    }
    Ok(())
}
