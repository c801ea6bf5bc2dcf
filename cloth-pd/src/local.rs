//! The local step: every element on its own projects `z = G x` to the nearest point `p` of its set, and pulls its vertices there.

use crate::coarse_family::CoarseFamily;
use crate::global::Term;
use crate::lattice::Lattice;
use crate::pieces::{self, Pieces};
use cloth_core::block_matrix::{BlockMatrix, BlockPattern};
use cloth_core::element::Projective;
use cloth_core::family::check_vertices;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;
use std::fmt::Debug;

/// Takes one entry of the matrix `Σ w GᵀG`: row, column, value (N/m).
pub(crate) type EntrySink<'a> = dyn FnMut(u32, u32, Real) + 'a;

/// Sums over all elements of one kind, with the kind forgotten.
pub(crate) trait Projections: Debug + Send + Sync {
    /// Whether the projections are the same for all positions, so that the energy is quadratic.
    fn is_constant(&self) -> bool;

    /// Hands over the entries of the lower half of `Σ w GᵀG`.
    fn add_matrix(&self, entry: &mut EntrySink<'_>);

    /// Adds `Σ w Gᵀ(p − G x)` to `out` (N) if the projections are constant, else nothing.
    fn add_constant_pull(&mut self, x: &[Vec3], out: &mut [Vec3]);

    /// Adds the gradient `Σ w Gᵀ(G x − p)` at x (m) to `out` (N) and returns the energy `½ Σ w ‖G x − p‖²` (J), unless the
    /// projections are constant.
    fn add_gradient(&mut self, x: &[Vec3], out: &mut [Vec3]) -> Real;

    /// Takes away the element that was given as number `element`, and hands over what it leaves of `Σ w GᵀG`: the rows of its operator, negative.
    /// Returns whether it was there.
    fn remove(&mut self, element: usize, terms: &mut Vec<Term>) -> Option<()>;

    /// Prepares the sums over a coarse grid, and adds the pairs of nodes that the elements tie together.
    fn lay_over(&mut self, lattice: &Lattice, pairs: &mut Vec<[u32; 2]>);

    /// Looks up the places of those pairs.
    fn bind_nodes(&mut self, pattern: &BlockPattern);

    /// Adds the stiffness at x (m), seen through the hats of the coarse grid, to `out` (N/m).
    fn add_coarse_stiffness(&mut self, x: &[Vec3], out: &mut BlockMatrix);
}

/// Where an element that was given is now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    At(u32),
    /// It never had a weight, and nobody misses it.
    Weightless,
    Removed,
}

/// All elements of one kind that have a weight.
#[derive(Debug)]
pub(crate) struct Family<const N: usize, const K: usize, E> {
    elements: Vec<E>,
    /// Place in `elements` of each element that was given.
    places: Vec<Place>,
    pieces: Pieces,
    /// Nothing without a coarse grid.
    coarse: CoarseFamily,
}

impl<const N: usize, const K: usize, E: Projective<N, K>> Family<N, K, E> {
    /// Leaves out the elements that have no weight.
    pub(crate) fn new(mut elements: Vec<E>, particles: &Particles) -> Result<Self, BuildError> {
        check_vertices(&elements, particles.len())?;
        for element in &elements {
            let weight = element.weight();
            if !(weight >= 0.0 && weight.is_finite()) {
                return Err(BuildError::InvalidSetting {
                    name: "the weight of an element",
                    value: weight,
                    range: "zero or a positive finite number",
                });
            }
        }
        let mut count = 0;
        let place = |element: &E| {
            if element.weight() == 0.0 {
                return Place::Weightless;
            }
            count += 1;
            Place::At(count - 1)
        };
        let places = elements.iter().map(place).collect();
        elements.retain(|element| element.weight() > 0.0);
        Ok(Self {
            elements,
            places,
            pieces: Pieces::new(particles.len()),
            coarse: CoarseFamily::default(),
        })
    }

    /// Adds `Σ w Gᵀ pull(element, G x)` to `out` and returns `½ Σ w ‖pull‖²`; on one thread or on several, with the same bits.
    fn sum(
        &mut self,
        x: &[Vec3],
        out: &mut [Vec3],
        pull: impl Fn(&E, [Vec3; K]) -> [Vec3; K] + Sync,
    ) -> Real {
        let weighted = |element: &E| {
            let pull = pull(
                element,
                apply(&element.operator(), &gather(x, element.vertices())),
            );
            let weight = element.weight();
            let squared: Real = pull.iter().map(Vec3::norm_squared).sum();
            (pull.map(|pull| pull * weight), 0.5 * weight * squared)
        };
        #[cfg(feature = "parallel")]
        if pieces::pays(self.elements.len()) {
            return self.pieces.sum(&self.elements, out, weighted);
        }
        self.pieces.values.fill(0.0);
        for element in &self.elements {
            let (pull, value) = weighted(element);
            let operator = element.operator();
            let vertices = element.vertices();
            for i in 0..N {
                out[vertices[i] as usize] += share(&operator, &pull, i);
            }
            self.pieces.values[pieces::of(vertices[0])] += value;
        }
        self.pieces.values.iter().sum()
    }
}

impl<const N: usize, const K: usize, E: Projective<N, K>> Projections for Family<N, K, E> {
    fn is_constant(&self) -> bool {
        E::PROJECTION_IS_CONSTANT
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

    fn add_constant_pull(&mut self, x: &[Vec3], out: &mut [Vec3]) {
        if E::PROJECTION_IS_CONSTANT {
            self.sum(x, out, |element, z| {
                let p = element.project(z);
                std::array::from_fn(|k| p[k] - z[k])
            });
        }
    }

    fn add_gradient(&mut self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        if E::PROJECTION_IS_CONSTANT {
            return 0.0;
        }
        self.sum(x, out, |element, z| {
            let p = element.project(z);
            std::array::from_fn(|k| z[k] - p[k])
        })
    }

    fn remove(&mut self, element: usize, terms: &mut Vec<Term>) -> Option<()> {
        let place = self.places.get_mut(element)?;
        let at = match *place {
            Place::At(at) => at,
            Place::Weightless => {
                *place = Place::Removed;
                return Some(());
            }
            Place::Removed => return None,
        };
        *place = Place::Removed;
        // The order of the others stays: sums come out as without the element.
        let gone = self.elements.remove(at as usize);
        for place in &mut self.places[element + 1..] {
            if let Place::At(at) = place {
                *at -= 1;
            }
        }
        self.pieces.forget();
        terms.extend(gone.operator().map(|row| Term {
            column: gone.vertices().into_iter().zip(row).collect(),
            weight: -gone.weight(),
        }));
        Some(())
    }

    fn lay_over(&mut self, lattice: &Lattice, pairs: &mut Vec<[u32; 2]>) {
        self.coarse = CoarseFamily::new(&self.elements, lattice, pairs);
    }

    fn bind_nodes(&mut self, pattern: &BlockPattern) {
        self.coarse.bind(pattern);
    }

    fn add_coarse_stiffness(&mut self, x: &[Vec3], out: &mut BlockMatrix) {
        self.coarse.add_stiffness(&self.elements, x, out);
    }
}

/// `z = G x`.
#[inline]
pub(crate) fn apply<const N: usize, const K: usize>(
    operator: &[[Real; N]; K],
    x: &[Vec3; N],
) -> [Vec3; K] {
    let mut z = [Vec3::zeros(); K];
    for k in 0..K {
        for i in 0..N {
            z[k] += x[i] * operator[k][i];
        }
    }
    z
}

/// Vertex `i`'s part of `Gᵀ pull`.
#[inline]
pub(crate) fn share<const N: usize, const K: usize>(
    operator: &[[Real; N]; K],
    pull: &[Vec3; K],
    i: usize,
) -> Vec3 {
    let mut sum = Vec3::zeros();
    for k in 0..K {
        sum += pull[k] * operator[k][i];
    }
    sum
}
