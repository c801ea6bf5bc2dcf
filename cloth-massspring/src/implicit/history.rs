//! Limited memory: what the last iterations say of the Hessian (L-BFGS).
//!
//! J. Nocedal, "Updating quasi-Newton matrices with limited storage", Math. Comp. 35, 1980,
//! <https://doi.org/10.1090/S0025-5718-1980-0572855-7>. The two loops of inner products are taken through the products
//! `sᵢ·yⱼ` of the pairs among themselves, so that all products with one vector take one pass over the memory (R. H.
//! Byrd, J. Nocedal, R. B. Schnabel, "Representations of quasi-Newton matrices and their use in limited memory
//! methods", Math. Prog. 63, 1994, <https://doi.org/10.1007/BF01582063>).

use cloth_core::math::{Real, Vec3};
use cloth_core::method::chunked::map_reduce;
use cloth_core::method::vectors::dot_of_part;

/// Pairs that are kept.
const PAIRS: usize = 5;
/// Smallest cosine between s and y: below, rounding decides its sign.
const CURVED: Real = 1e-12;

/// A vector in single precision: half the memory to wait for, and what is lost is not in the sums, which all take the
/// same rounded numbers.
type Single = nalgebra::Vector3<f32>;

/// Differences of iterates, s (m), and of their gradients, y (N).
#[derive(Debug)]
pub(super) struct History {
    steps: [Vec<Single>; PAIRS],
    changes: [Vec<Single>; PAIRS],
    /// `sᵢ·yⱼ` (J) for i no newer than j, by places.
    products: [[Real; PAIRS]; PAIRS],
    /// `sᵢ·g` (J) with the gradient at the newest iterate, by places.
    along: [Real; PAIRS],
    /// Place of the oldest pair.
    first: usize,
    len: usize,
}

impl History {
    pub(super) fn new(vertex_count: usize) -> Self {
        let zeros = || std::array::from_fn(|_| vec![Single::zeros(); vertex_count]);
        Self {
            steps: zeros(),
            changes: zeros(),
            products: [[0.0; PAIRS]; PAIRS],
            along: [0.0; PAIRS],
            first: 0,
            len: 0,
        }
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    pub(super) fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Places from the oldest pair to the newest.
    fn places(&self) -> impl DoubleEndedIterator<Item = usize> + Clone + use<> {
        let first = self.first;
        (0..self.len).map(move |k| (first + k) % PAIRS)
    }

    /// Adds the pair `s = length · direction`, `y = to − from` (gradients, N), in the place of the oldest if there are
    /// many, unless the curvature along it is not positive. `slope` is `from · direction` (J).
    pub(super) fn push(
        &mut self,
        length: Real,
        slope: Real,
        direction: &[Vec3],
        from: &[Vec3],
        to: &[Vec3],
    ) {
        if self.len == PAIRS {
            (self.first, self.len) = ((self.first + 1) % PAIRS, PAIRS - 1);
        }
        let place = (self.first + self.len) % PAIRS;
        let mut step = std::mem::take(&mut self.steps[place]);
        let mut change = std::mem::take(&mut self.changes[place]);
        let sums: [Real; PAIRS + 3] = map_reduce(
            ((&mut step[..], &mut change[..]), (direction, (from, to))),
            #[inline(always)]
            |start, ((step, change), (direction, (from, to)))| {
                let (step, change): (&mut [Single], &mut [Single]) = (step, change);
                let (direction, from, to): (&[Vec3], &[Vec3], &[Vec3]) = (direction, from, to);
                for (s, p) in step.iter_mut().zip(direction) {
                    *s = single(&(p * length));
                }
                for ((y, from), to) in change.iter_mut().zip(from).zip(to) {
                    *y = single(&(to - from));
                }
                let mut sums = [0.0; PAIRS + 3];
                for other in self.places() {
                    sums[other] = dot(&self.steps[other][start..start + change.len()], change);
                }
                sums[PAIRS] = dot(step, change);
                sums[PAIRS + 1] = dot(step, step);
                sums[PAIRS + 2] = dot(change, change);
                sums
            },
        );
        (self.steps[place], self.changes[place]) = (step, change);
        for other in self.places() {
            self.products[other][place] = sums[other];
            self.along[other] += sums[other];
        }
        let [product, steps, changes] = [sums[PAIRS], sums[PAIRS + 1], sums[PAIRS + 2]];
        if product > CURVED * (steps * changes).sqrt() {
            self.products[place][place] = product;
            self.along[place] = length * slope + product;
            self.len += 1;
        }
    }

    /// Writes `−H g` (m) to `out`, with H the inverse Hessian that the pairs make of the first one, which `inverse`
    /// applies; returns its product with g (J). `work` is room for a vector (N).
    pub(super) fn direction(
        &self,
        gradient: &[Vec3],
        work: &mut [Vec3],
        out: &mut [Vec3],
        inverse: impl FnOnce(&[Vec3], &mut [Vec3]),
    ) -> Real {
        let mut alpha = [0.0; PAIRS];
        for k in self.places().rev() {
            let newer = self.places().rev().take_while(|&j| j != k);
            let sum: Real = newer.map(|j| alpha[j] * self.products[k][j]).sum();
            alpha[k] = (-self.along[k] - sum) / self.products[k][k];
        }
        map_reduce(
            (&mut *work, gradient),
            #[inline(always)]
            |start, (work, gradient): (&mut [Vec3], &[Vec3])| {
                for (work, g) in work.iter_mut().zip(gradient) {
                    *work = -g;
                }
                for k in self.places() {
                    add(work, -alpha[k], &self.changes[k][start..]);
                }
                []
            },
        );
        inverse(work, out);
        let across: [Real; PAIRS] = map_reduce(
            &*out,
            #[inline(always)]
            |start, out: &[Vec3]| {
                let mut sums = [0.0; PAIRS];
                for k in self.places() {
                    sums[k] = mixed_dot(&self.changes[k][start..start + out.len()], out);
                }
                sums
            },
        );
        let mut gamma = [0.0; PAIRS];
        for k in self.places() {
            let older = self.places().take_while(|&j| j != k);
            let sum: Real = older.map(|j| gamma[j] * self.products[j][k]).sum();
            gamma[k] = alpha[k] - (across[k] + sum) / self.products[k][k];
        }
        let [slope] = map_reduce(
            (out, gradient),
            #[inline(always)]
            |start, (out, gradient): (&mut [Vec3], &[Vec3])| {
                for k in self.places() {
                    add(out, gamma[k], &self.steps[k][start..]);
                }
                [dot_of_part(out, gradient)]
            },
        );
        slope
    }
}

#[inline(always)]
fn single(v: &Vec3) -> Single {
    Single::new(v.x as f32, v.y as f32, v.z as f32)
}

#[inline(always)]
fn double(v: &Single) -> Vec3 {
    Vec3::new(Real::from(v.x), Real::from(v.y), Real::from(v.z))
}

/// `out += factor · v`, as far as `out` reaches.
#[inline(always)]
fn add(out: &mut [Vec3], factor: Real, v: &[Single]) {
    for (out, v) in out.iter_mut().zip(v) {
        *out += double(v) * factor;
    }
}

/// `Σ aᵢ·bᵢ`, with as many sums beside each other as keep the processor busy.
#[inline(always)]
fn sum_of_products<A, B>(a: &[A], b: &[B], product: impl Fn(&A, &B) -> Vec3) -> Real {
    let mut sums = [Vec3::zeros(); 4];
    let ((a, a_last), (b, b_last)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    for (a, b) in a.iter().zip(b) {
        for lane in 0..4 {
            sums[lane] += product(&a[lane], &b[lane]);
        }
    }
    for (a, b) in a_last.iter().zip(b_last) {
        sums[0] += product(a, b);
    }
    sums.iter().sum::<Vec3>().sum()
}

#[inline(always)]
fn dot(a: &[Single], b: &[Single]) -> Real {
    sum_of_products(a, b, |a, b| double(a).component_mul(&double(b)))
}

#[inline(always)]
fn mixed_dot(a: &[Single], b: &[Vec3]) -> Real {
    sum_of_products(a, b, |a, b| double(a).component_mul(b))
}
