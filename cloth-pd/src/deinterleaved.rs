//! Springs in structure-of-arrays buffers of x, y and z, read from end to end (as streams), so that whole registers are
//! read, projected and added.
//!
//! Positions and sums of a block are deinterleaved once, into [`Buffers`], for all elements that touch it. An element
//! needs a root and a division, and the rest of its work, done for one register of elements after the other, takes
//! about as long: the processor does both at the same time.
//!
//! Where the vertices are numbered along rows, as on a grid, the ends of neighbouring springs are neighbours too, and
//! both are read and added to as streams, without an index: x, y and z apart, even vertices apart from odd ones, eight
//! springs side by side. What is left is the square root and the division of each spring (0.7 ns of 1.7 on one thread,
//! commit 246fbcc0), the sums, and taking x, y and z apart and together again. Cloth in another order takes the ends
//! one by one.

use crate::vertex_blocks::of;
use cloth_core::element::Projective;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::chunked::CHUNK;
use std::ops::Range;

/// Elements that are projected side by side: two registers of four.
const LANES: usize = 8;

/// One number for each vertex of a block, first of the even vertices, then of the odd ones; then the vertices of a run
/// that are in another block, and padding for its last lanes.
///
/// So neighbours along a row are far apart, and a sum over one does not wait for what was just written for the other;
/// and edges at every second vertex, such as the diagonals of an alternating grid, are as good a stream as the others.
type Buffer = [Real; BUFFER_LEN];

const BUFFER_LEN: usize = CHUNK + LONGEST_RUN + LANES;

/// x, y and z.
type Buffers = [Buffer; 3];

/// The slot in a buffer of a vertex of a block that starts with vertex `start`.
fn slot(vertex: u32, start: usize) -> usize {
    let (pair, side) = ((vertex as usize - start) / 2, vertex as usize % 2);
    pair + side * (CHUNK / 2)
}

/// Elements one after another with the same operator, each with vertices two further than those of the one before.
/// Vertices in the same slot of each are in one block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    first: u32,
    len: u32,
}

/// Fewer elements are not worth a loop of their own.
const SHORTEST_RUN: usize = LANES;

const LONGEST_RUN: usize = 256;

impl Run {
    /// The longest at the front of `elements`, of which the first has number `first`. None where it is not worth it, or
    /// elements have more than two vertices: there is room for one end outside a block.
    pub(crate) fn at<const N: usize, const K: usize, E: Projective<N, K>>(
        elements: &[E],
        first: usize,
    ) -> Option<Self> {
        let rest = &elements[first..elements.len().min(first + LONGEST_RUN)];
        let (start, operator) = (rest[0].vertices(), rest[0].operator());
        let continues = |(step, element): &(u32, &E)| {
            let expected = start.map(|vertex| vertex.wrapping_add(2 * step));
            element.vertices() == expected
                && (0..N).all(|i| of(expected[i]) == of(start[i]))
                && element.operator() == operator
        };
        let len = (0..).zip(rest).take_while(continues).count();
        (N <= 2 && len >= SHORTEST_RUN).then_some(Self {
            first: first as u32,
            len: len as u32,
        })
    }

    /// The numbers of its elements.
    pub(crate) fn elements(self) -> Range<usize> {
        self.first as usize..(self.first + self.len) as usize
    }
}

/// What elements side by side project to.
#[derive(Clone, Debug)]
struct Spheres {
    radius: [Real; LANES],
    /// Zero after the last element.
    weight: [Real; LANES],
}

/// The runs that touch a block, all of elements that project to spheres.
#[derive(Clone, Debug, Default)]
pub(crate) struct Runs {
    runs: Vec<Run>,
    /// Of all elements in their order; each run starts a new one.
    spheres: Vec<Spheres>,
}

impl Runs {
    /// Adds a run, unless it is the last that was added.
    pub(crate) fn push<const N: usize, const K: usize, E: Projective<N, K>>(
        &mut self,
        run: Run,
        elements: &[E],
    ) {
        if self.runs.last() == Some(&run) {
            return;
        }
        self.runs.push(run);
        let elements = &elements[run.elements()];
        for lanes in elements.chunks(LANES) {
            let mut spheres = Spheres {
                radius: [0.0; LANES],
                weight: [0.0; LANES],
            };
            for (lane, element) in lanes.iter().enumerate() {
                spheres.radius[lane] = element.sphere().unwrap_or(0.0);
                spheres.weight[lane] = element.weight();
            }
            self.spheres.push(spheres);
        }
    }

    pub(crate) fn each(&self) -> impl Iterator<Item = Run> {
        self.runs.iter().copied()
    }

    /// Adds the forces of the elements at the vertices of block number `block` to `out`, and returns the energy of
    /// those whose first vertex is there. None, and nothing added, where some `‖z‖²` is zero, subnormal or
    /// not finite.
    #[inline(always)]
    pub(crate) fn sum<const N: usize, const K: usize, E: Projective<N, K>>(
        &self,
        block: usize,
        elements: &[E],
        x: &[Vec3],
        out: &mut [Vec3],
    ) -> Option<Real> {
        if self.runs.is_empty() {
            return Some(0.0);
        }
        let start = block * CHUNK;
        let (mut positions, mut sums) = ([[0.0; BUFFER_LEN]; 3], [[0.0; BUFFER_LEN]; 3]);
        deinterleave(&x[start..start + out.len()], &mut positions);
        let (mut energies, mut not_counted) = ([0.0; LANES], [0.0; LANES]);
        let mut squares = Squares::NONE;
        let mut spheres = self.spheres.iter();
        for run in &self.runs {
            let first = &elements[run.first as usize];
            let (vertices, len) = (first.vertices(), run.len as usize);
            let slots = vertices.map(|vertex| {
                if of(vertex) == block {
                    slot(vertex, start)
                } else {
                    copy_run(&x[vertex as usize..], len, &mut positions);
                    CHUNK
                }
            });
            let energies = if of(vertices[0]) == block {
                &mut energies
            } else {
                &mut not_counted
            };
            for (at, spheres) in (0..len).step_by(LANES).zip(&mut spheres) {
                let operator = first.operator()[0];
                let slots = slots.map(|slot| slot + at);
                let mut z = differences(&positions, slots, operator);
                project(&mut z, spheres, &mut squares, energies);
                for i in 0..N {
                    for (sums, forces) in sums.iter_mut().zip(&z) {
                        let sums = &mut sums[slots[i]..][..LANES];
                        for lane in 0..LANES {
                            sums[lane] += forces[lane] * operator[i];
                        }
                    }
                }
            }
        }
        if !squares.are_normal() {
            return None;
        }
        add_interleaved(&sums, out);
        Some(0.5 * energies.iter().sum::<Real>())
    }
}

/// Copies the positions of a block into buffers.
#[inline(always)]
fn deinterleave(x: &[Vec3], buffers: &mut Buffers) {
    let (pairs, last) = x.as_chunks::<2>();
    for (i, [even, odd]) in pairs.iter().enumerate().take(CHUNK / 2) {
        for c in 0..3 {
            buffers[c][i] = even[c];
            buffers[c][CHUNK / 2 + i] = odd[c];
        }
    }
    if let [last] = last {
        for c in 0..3 {
            buffers[c][pairs.len()] = last[c];
        }
    }
}

/// Adds sums in buffers to those of a block.
#[inline(always)]
fn add_interleaved(buffers: &Buffers, out: &mut [Vec3]) {
    let (pairs, last) = out.as_chunks_mut::<2>();
    if let [last] = last {
        for c in 0..3 {
            last[c] += buffers[c][pairs.len()];
        }
    }
    for (i, [even, odd]) in pairs.iter_mut().enumerate().take(CHUNK / 2) {
        for c in 0..3 {
            even[c] += buffers[c][i];
            odd[c] += buffers[c][CHUNK / 2 + i];
        }
    }
}

/// Copies the positions of `len` vertices, every second of `x`, to their slots after those of a block.
#[inline(always)]
fn copy_run(x: &[Vec3], len: usize, buffers: &mut Buffers) {
    for (i, x) in x.iter().step_by(2).take(len).enumerate() {
        for c in 0..3 {
            buffers[c][CHUNK + i] = x[c];
        }
    }
}

/// `z = S x` of elements side by side.
#[inline(always)]
fn differences<const N: usize>(
    x: &Buffers,
    slots: [usize; N],
    operator: [Real; N],
) -> [[Real; LANES]; 3] {
    let mut z = [[0.0; LANES]; 3];
    for i in 0..N {
        for (z, x) in z.iter_mut().zip(x) {
            let x = &x[slots[i]..][..LANES];
            for lane in 0..LANES {
                let term = x[lane] * operator[i];
                z[lane] = if i == 0 { term } else { z[lane] + term };
            }
        }
    }
    z
}

/// From `z` (m) to the force `w (z − p) = w (1 − r/‖z‖) z` (N); adds up the energies `½ w ‖z − p‖²` (J).
#[inline(always)]
fn project(
    z: &mut [[Real; LANES]; 3],
    spheres: &Spheres,
    squares: &mut Squares,
    energies: &mut [Real; LANES],
) {
    for lane in 0..LANES {
        let squared = z[0][lane] * z[0][lane] + z[1][lane] * z[1][lane] + z[2][lane] * z[2][lane];
        // What is after the last element has no force.
        let squared = if spheres.weight[lane] == 0.0 {
            1.0
        } else {
            squared
        };
        squares.include(lane, squared);
        let length = squared.sqrt();
        let stretch = length - spheres.radius[lane];
        let force = spheres.weight[lane] * stretch;
        energies[lane] += force * stretch;
        let factor = force / length;
        for z in &mut *z {
            z[lane] *= factor;
        }
    }
}

/// The least and the largest `‖z‖²` of a block.
struct Squares {
    least: [Real; LANES],
    largest: [Real; LANES],
}

impl Squares {
    const NONE: Self = Self {
        least: [1.0; LANES],
        largest: [1.0; LANES],
    };

    #[inline(always)]
    fn include(&mut self, lane: usize, squared: Real) {
        let (least, largest) = (self.least[lane], self.largest[lane]);
        self.least[lane] = if squared < least { squared } else { least };
        self.largest[lane] = if squared > largest { squared } else { largest };
    }

    /// Whether all of them are normal numbers, so that roots and divisions are exact to rounding.
    fn are_normal(&self) -> bool {
        let is_normal = |squared: &Real| (Real::MIN_POSITIVE..Real::INFINITY).contains(squared);
        self.least.iter().chain(&self.largest).all(is_normal)
    }
}
