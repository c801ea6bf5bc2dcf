//! Limited memory: what the last iterations say of the Hessian (L-BFGS).
//!
//! J. Nocedal, "Updating quasi-Newton matrices with limited storage", Math. Comp. 35, 1980,
//! <https://doi.org/10.1090/S0025-5718-1980-0572855-7>. The two loops of inner products are taken through the products
//! `sᵢ·yⱼ` of the pairs among themselves, so that all products with one vector take one pass over the memory (R. H.
//! Byrd, J. Nocedal, R. B. Schnabel, "Representations of quasi-Newton matrices and their use in limited memory
//! methods", Math. Prog. 63, 1994, <https://doi.org/10.1007/BF01582063>).

use crate::math::{Real, Vec3};
use crate::method::chunked::map_reduce;
use crate::method::vectors::dot_of_chunk;

/// Pairs that can be kept, at most.
pub const MOST_PAIRS: usize = 32;
/// Smallest cosine between s and y: below, rounding decides its sign.
const CURVED: Real = 1e-12;

/// What the numbers of pairs are kept in.
///
/// Single precision (`f32`) is half the memory to wait for, and what is lost is not in the sums, which all take the
/// same rounded numbers. But directions then have rounding errors of 10⁻⁷ of their own, which may add up to a momentum.
/// Where nothing takes that out again pairs are kept in double precision.
pub trait Stored: nalgebra::Scalar + Copy + Into<Real> + Send + Sync {
    /// The number, rounded.
    fn rounded(x: Real) -> Self;
    /// Zero.
    const ZERO: Self;
}

impl Stored for f32 {
    #[inline(always)]
    fn rounded(x: Real) -> Self {
        x as f32
    }
    const ZERO: Self = 0.0;
}

impl Stored for f64 {
    #[inline(always)]
    fn rounded(x: Real) -> Self {
        x
    }
    const ZERO: Self = 0.0;
}

type Kept<T> = nalgebra::Vector3<T>;

/// Differences of iterates, s (m), and of their gradients, y (N): the last few.
///
/// The inverse Hessian that they make of a first one ([`direction`](Self::direction)) maps y to s for the newest pair.
#[derive(Debug)]
pub struct LimitedMemory<T> {
    vertex_count: usize,
    /// How many pairs are kept, in places from 0.
    capacity: usize,
    pairs: Vec<Pair<T>>,
    /// `sᵢ·g` (J) with the gradient at the newest iterate, by places.
    along: [Real; MOST_PAIRS],
    /// Place of the oldest pair.
    first: usize,
    len: usize,
}

#[derive(Clone, Debug)]
struct Pair<T> {
    step: Vec<Kept<T>>,
    change: Vec<Kept<T>>,
    /// `sᵢ·y` (J) of this y, for all i that are no newer, by places.
    products: [Real; MOST_PAIRS],
}

impl<T: Stored> LimitedMemory<T> {
    /// A memory of at most `capacity` pairs (at most [`MOST_PAIRS`]), empty.
    #[must_use]
    pub fn new(vertex_count: usize, capacity: usize) -> Self {
        let mut this = Self {
            vertex_count,
            capacity: 0,
            pairs: Vec::new(),
            along: [0.0; MOST_PAIRS],
            first: 0,
            len: 0,
        };
        this.clear_for(capacity);
        this
    }

    /// Forgets all pairs.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Forgets all pairs, and keeps at most `capacity` of those to come. Allocates when this is more than ever before.
    ///
    /// # Panics
    /// If there are more than [`MOST_PAIRS`].
    pub fn clear_for(&mut self, capacity: usize) {
        assert!(capacity <= MOST_PAIRS, "{capacity} pairs");
        (self.first, self.len, self.capacity) = (0, 0, capacity);
        if self.pairs.len() < capacity {
            let zeros = vec![Kept::repeat(T::ZERO); self.vertex_count];
            let pair = Pair {
                step: zeros.clone(),
                change: zeros,
                products: [0.0; MOST_PAIRS],
            };
            self.pairs.resize(capacity, pair);
        }
    }

    /// Whether there is no pair.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Places from the oldest pair to the newest.
    fn places(&self) -> impl DoubleEndedIterator<Item = usize> + Clone + use<T> {
        let (first, capacity) = (self.first, self.capacity);
        (0..self.len).map(move |k| (first + k) % capacity)
    }

    /// Adds the pair `s = length · direction`, `y = to − from` (gradients, N), unless the curvature along it is not
    /// positive. A full memory gives up its oldest pair even then. `slope` is `from · direction` (J).
    pub fn push(
        &mut self,
        length: Real,
        slope: Real,
        direction: &[Vec3],
        from: &[Vec3],
        to: &[Vec3],
    ) {
        if self.capacity == 0 {
            return;
        }
        if self.len == self.capacity {
            (self.first, self.len) = ((self.first + 1) % self.capacity, self.capacity - 1);
        }
        let place = (self.first + self.len) % self.capacity;
        let mut step = std::mem::take(&mut self.pairs[place].step);
        let mut change = std::mem::take(&mut self.pairs[place].change);
        let sums: [Real; MOST_PAIRS + 3] = map_reduce(
            ((&mut step[..], &mut change[..]), (direction, (from, to))),
            #[inline(always)]
            |start, ((step, change), (direction, (from, to)))| {
                let (step, change): (&mut [Kept<T>], &mut [Kept<T>]) = (step, change);
                let (direction, from, to): (&[Vec3], &[Vec3], &[Vec3]) = (direction, from, to);
                for (s, p) in step.iter_mut().zip(direction) {
                    *s = kept(&(p * length));
                }
                for ((y, from), to) in change.iter_mut().zip(from).zip(to) {
                    *y = kept(&(to - from));
                }
                let mut sums = [0.0; MOST_PAIRS + 3];
                for other in self.places() {
                    let other_step = &self.pairs[other].step[start..start + change.len()];
                    sums[other] = dot(other_step, change);
                }
                sums[MOST_PAIRS] = dot(step, change);
                sums[MOST_PAIRS + 1] = dot(step, step);
                sums[MOST_PAIRS + 2] = dot(change, change);
                sums
            },
        );
        for other in self.places() {
            self.along[other] += sums[other];
        }
        let pair = &mut self.pairs[place];
        (pair.step, pair.change) = (step, change);
        pair.products.copy_from_slice(&sums[..MOST_PAIRS]);
        let [product, steps, changes] = [0, 1, 2].map(|k| sums[MOST_PAIRS + k]);
        if product > CURVED * (steps * changes).sqrt() {
            pair.products[place] = product;
            self.along[place] = length * slope + product;
            self.len += 1;
        }
    }

    /// Writes `−H g` (m) to `out`, with H the inverse Hessian that the pairs make of the first one, which `inverse`
    /// applies; returns its product with g (J). `work` is room for a vector (N).
    pub fn direction(
        &self,
        gradient: &[Vec3],
        work: &mut [Vec3],
        out: &mut [Vec3],
        inverse: impl FnOnce(&[Vec3], &mut [Vec3]),
    ) -> Real {
        let first = self.first_loop(gradient, work);
        inverse(work, out);
        self.second_loop(&first, gradient, out)
    }

    /// The first loop of [`direction`](Self::direction): writes to `work` what the first inverse Hessian is applied to
    /// (N). The two loops are for callers who apply it to the vectors of several memories at once.
    #[must_use]
    pub fn first_loop(&self, gradient: &[Vec3], work: &mut [Vec3]) -> FirstLoop {
        let mut alpha = [0.0; MOST_PAIRS];
        for k in self.places().rev() {
            let newer = self.places().rev().take_while(|&j| j != k);
            let sum: Real = newer.map(|j| alpha[j] * self.pairs[j].products[k]).sum();
            alpha[k] = (-self.along[k] - sum) / self.pairs[k].products[k];
        }
        map_reduce(
            (work, gradient),
            #[inline(always)]
            |start, (work, gradient): (&mut [Vec3], &[Vec3])| {
                for (work, g) in work.iter_mut().zip(gradient) {
                    *work = -g;
                }
                for k in self.places() {
                    add(work, -alpha[k], &self.pairs[k].change[start..]);
                }
                []
            },
        );
        FirstLoop(alpha)
    }

    /// The second loop: turns `out` (m), to which the first inverse Hessian has brought the vector of the first loop,
    /// into the direction; returns its product with g (J).
    pub fn second_loop(&self, first: &FirstLoop, gradient: &[Vec3], out: &mut [Vec3]) -> Real {
        let across: [Real; MOST_PAIRS] = map_reduce(
            &*out,
            #[inline(always)]
            |start, out: &[Vec3]| {
                let mut sums = [0.0; MOST_PAIRS];
                for k in self.places() {
                    sums[k] = mixed_dot(&self.pairs[k].change[start..start + out.len()], out);
                }
                sums
            },
        );
        let mut gamma = [0.0; MOST_PAIRS];
        for k in self.places() {
            let older = self.places().take_while(|&j| j != k);
            let sum: Real = older.map(|j| gamma[j] * self.pairs[k].products[j]).sum();
            gamma[k] = first.0[k] - (across[k] + sum) / self.pairs[k].products[k];
        }
        let [slope] = map_reduce(
            (out, gradient),
            #[inline(always)]
            |start, (out, gradient): (&mut [Vec3], &[Vec3])| {
                for k in self.places() {
                    add(out, gamma[k], &self.pairs[k].step[start..]);
                }
                [dot_of_chunk(out, gradient)]
            },
        );
        slope
    }
}

/// What the second loop needs of the first: the coefficients of the pairs.
#[derive(Clone, Copy, Debug)]
pub struct FirstLoop([Real; MOST_PAIRS]);

#[inline(always)]
fn kept<T: Stored>(v: &Vec3) -> Kept<T> {
    Kept::new(T::rounded(v.x), T::rounded(v.y), T::rounded(v.z))
}

#[inline(always)]
fn double<T: Stored>(v: &Kept<T>) -> Vec3 {
    Vec3::new(v.x.into(), v.y.into(), v.z.into())
}

/// `out += factor · v`, as far as `out` reaches.
#[inline(always)]
fn add<T: Stored>(out: &mut [Vec3], factor: Real, v: &[Kept<T>]) {
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
fn dot<T: Stored>(a: &[Kept<T>], b: &[Kept<T>]) -> Real {
    sum_of_products(a, b, |a, b| double(a).component_mul(&double(b)))
}

#[inline(always)]
fn mixed_dot<T: Stored>(a: &[Kept<T>], b: &[Vec3]) -> Real {
    sum_of_products(a, b, |a, b| double(a).component_mul(b))
}
