//! The local step: every element on its own projects `z = G x` to the nearest point `p` of its set, and pulls its vertices there.

use crate::coarse_family::CoarseFamily;
use crate::global::Term;
use crate::lattice::Lattice;
use crate::pieces::Pieces;
use cloth_core::block_matrix::{BlockMatrix, BlockPattern};
use cloth_core::element::{Element, Projective};
use cloth_core::family::check_vertices;
use cloth_core::math::{Real, Vec3};
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

    /// Adds the gradient `Σ w Gᵀ(G x − p)` at x (m) to `out` (N) if the projections are constant, else nothing.
    fn add_constant_gradient(&mut self, x: &[Vec3], out: &mut [Vec3]);

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
    /// Whether all of them project to a sphere.
    are_spheres: bool,
    pieces: Pieces,
    /// Nothing without a coarse grid.
    coarse: CoarseFamily,
}

impl<const N: usize, const K: usize, E: Projective<N, K>> Family<N, K, E> {
    /// Leaves out the elements that have no weight, and sorts the others for the sums.
    pub(crate) fn new(elements: Vec<E>, particles: &Particles) -> Result<Self, BuildError> {
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
        let mut places = vec![Place::Weightless; elements.len()];
        let mut sorted: Vec<(usize, E)> = elements.into_iter().enumerate().collect();
        sorted.retain(|(_, element)| element.weight() > 0.0);
        sorted.sort_by_key(|(given, element)| (key(element), *given));
        for (at, (given, _)) in (0..).zip(&sorted) {
            places[*given] = Place::At(at);
        }
        let elements: Vec<E> = sorted.into_iter().map(|(_, element)| element).collect();
        Ok(Self {
            are_spheres: K == 1 && elements.iter().all(|element| element.sphere().is_some()),
            elements,
            places,
            pieces: Pieces::new(particles.len()),
            coarse: CoarseFamily::default(),
        })
    }

    /// Adds `Σ w Gᵀ(G x − p)` to `out` and returns `½ Σ w ‖G x − p‖²`.
    fn sum(&mut self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        self.pieces.sum(&self.elements, self.are_spheres, x, out)
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
        for place in &mut self.places {
            if let Place::At(after) = place
                && *after > at
            {
                *after -= 1;
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
        let are_spheres = self.are_spheres;
        self.coarse
            .add_stiffness(&self.elements, are_spheres, x, out);
    }
}

/// Elements in the order of these numbers have their vertices near one another; on a mesh that is numbered along rows all of one direction
/// come together, first those of the even vertices, then those of the odd ones.
pub(crate) fn key<const N: usize, E: Element<N>>(element: &E) -> [u32; 4] {
    let vertices = element.vertices();
    let (first, last) = (vertices[0], vertices[N - 1]);
    [first / WINDOW, last.wrapping_sub(first), first % 2, first]
}

/// Vertices that elements stay with before they go on: few enough for positions and sums to stay in the nearest cache.
const WINDOW: u32 = 512;

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

    /// Adds the gradient `Σ w Gᵀ(G x − p)` at the positions x (m) to `out` (N), one of each per particle, and returns the energy `½ Σ w ‖G x − p‖²` (J). Elements
    /// whose projection is constant add nothing: their part is a matrix.
    ///
    /// # Panics
    /// If a vertex of an element has no position or no place in `out`.
    pub fn add_gradient(&mut self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        self.0.add_gradient(x, out)
    }
}

/// `z = G x`.
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

/// Vertex `i`'s part of `Gᵀ pull`.
#[inline(always)]
pub(crate) fn share<const N: usize, const K: usize>(
    operator: &[[Real; N]; K],
    pull: &[Vec3; K],
    i: usize,
) -> Vec3 {
    let mut sum = pull[0] * operator[0][i];
    for k in 1..K {
        sum += pull[k] * operator[k][i];
    }
    sum
}
