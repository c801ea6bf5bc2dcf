//! The local step: every element on its own projects `z = G x` to the nearest point `p` of its set, and pulls its vertices there.

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
    /// Hands over the entries of the lower half of `Σ w GᵀG`.
    fn add_matrix(&self, entry: &mut EntrySink<'_>);

    /// Adds what is the same in all iterations of a step with the prediction x̃ (m) to `out` (N): `Σ w Gᵀ(p − G x̃)` where the
    /// projection is constant, `−Σ w GᵀG x̃` where it is not.
    fn add_constant_pull(&mut self, predicted: &[Vec3], out: &mut [Vec3]);

    /// Adds `Σ w Gᵀ p` with the projections `p` of `G x` (m) to `out` (N), unless they are constant.
    fn add_projections(&mut self, x: &[Vec3], out: &mut [Vec3]);
}

/// All elements of one kind that can move something.
#[derive(Debug)]
pub(crate) struct Family<const N: usize, const K: usize, E> {
    elements: Vec<E>,
    #[cfg(feature = "parallel")]
    pieces: crate::parallel::Pieces,
}

impl<const N: usize, const K: usize, E: Projective<N, K>> Family<N, K, E> {
    /// Leaves out the elements that have no weight or no free vertex.
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
        let is_free = |vertex: u32| !particles.is_prescribed(vertex as usize);
        elements.retain(|e| e.weight() > 0.0 && e.vertices().into_iter().any(is_free));
        Ok(Self {
            elements,
            #[cfg(feature = "parallel")]
            pieces: Default::default(),
        })
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.elements.is_empty()
    }

    /// Adds `Σ w Gᵀ goal(element, G x)` to `out`; on one thread or on several, with the same bits.
    fn pull(
        &mut self,
        x: &[Vec3],
        out: &mut [Vec3],
        goal: impl Fn(&E, [Vec3; K]) -> [Vec3; K] + Sync,
    ) {
        let weighted_goal = |element: &E| {
            let z = apply(&element.operator(), &gather(x, element.vertices()));
            goal(element, z).map(|goal| goal * element.weight())
        };
        #[cfg(feature = "parallel")]
        if crate::parallel::pays(self.elements.len()) {
            return self.pieces.sum(&self.elements, out, weighted_goal);
        }
        for element in &self.elements {
            let goal = weighted_goal(element);
            let operator = element.operator();
            let vertices = element.vertices();
            for i in 0..N {
                out[vertices[i] as usize] += share(&operator, &goal, i);
            }
        }
    }
}

impl<const N: usize, const K: usize, E: Projective<N, K>> Projections for Family<N, K, E> {
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

    fn add_constant_pull(&mut self, predicted: &[Vec3], out: &mut [Vec3]) {
        if E::PROJECTION_IS_CONSTANT {
            self.pull(predicted, out, |element, z| {
                let p = element.project(z);
                std::array::from_fn(|k| p[k] - z[k])
            });
        } else {
            self.pull(predicted, out, |_, z| z.map(|z| -z));
        }
    }

    fn add_projections(&mut self, x: &[Vec3], out: &mut [Vec3]) {
        if !E::PROJECTION_IS_CONSTANT {
            self.pull(x, out, E::project);
        }
    }
}

/// `z = G x`.
#[inline]
fn apply<const N: usize, const K: usize>(operator: &[[Real; N]; K], x: &[Vec3; N]) -> [Vec3; K] {
    let mut z = [Vec3::zeros(); K];
    for k in 0..K {
        for i in 0..N {
            z[k] += x[i] * operator[k][i];
        }
    }
    z
}

/// Vertex `i`'s part of `Gᵀ goal`.
#[inline]
pub(crate) fn share<const N: usize, const K: usize>(
    operator: &[[Real; N]; K],
    goal: &[Vec3; K],
    i: usize,
) -> Vec3 {
    let mut sum = Vec3::zeros();
    for k in 0..K {
        sum += goal[k] * operator[k][i];
    }
    sum
}
