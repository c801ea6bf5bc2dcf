//! Springs in packs of four: one SIMD lane each.

use super::positions::PADDING;
use super::{Family, SMALLEST, is_prescribed, scaled_compliance};
use crate::update::XpbdUpdate;
use cloth_core::element::Element;
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3, length_and_direction};
use cloth_core::method::coloring::{Colored, greedy_colors};
use cloth_core::step::BuildError;
use wide::f32x4;

/// Four springs of one colour: first ends, then second ends, in the same order.
#[derive(Clone, Copy, Debug)]
struct Pack {
    vertices: [u32; 8],
    /// L (m).
    rest_length: f32x4,
}

impl Element<8> for Pack {
    #[inline]
    fn vertices(&self) -> [u32; 8] {
        self.vertices
    }
}

/// Multipliers and compliances of a pack.
#[derive(Clone, Copy, Debug, Default)]
struct Multipliers {
    /// λ (kg m).
    lambda: f32x4,
    /// α̃ (1/kg).
    scaled_compliance: f32x4,
}

/// All springs of a family in packs.
#[derive(Debug)]
pub(super) struct Springs {
    packs: Colored<8, Pack>,
    memory: Vec<Multipliers>,
    /// k (N/m) of each pack in visiting order.
    stiffness: Vec<[Real; 4]>,
}

impl Springs {
    /// For `vertex_count` vertices; the padding comes after them.
    pub(super) fn new(springs: &[Spring], vertex_count: usize) -> Result<Self, BuildError> {
        let packs = packs(springs, vertex_count);
        let colored = Colored::new(
            &packs.iter().map(|(pack, _)| *pack).collect::<Vec<_>>(),
            vertex_count + PADDING,
        );
        let order = colored.input_index().iter();
        let stiffness = order.map(|&i| packs[i as usize].1).collect();
        Ok(Self {
            memory: vec![Multipliers::default(); packs.len()],
            packs: colored,
            stiffness,
        })
    }
}

/// The springs, colour by colour, in packs with their stiffnesses. Padding has no stiffness and prescribed ends.
fn packs(springs: &[Spring], vertex_count: usize) -> Vec<(Pack, [Real; 4])> {
    let stencils: Vec<[u32; 2]> = springs.iter().map(Element::vertices).collect();
    let colors = greedy_colors(&stencils, vertex_count);
    let mut order: Vec<usize> = (0..springs.len()).collect();
    order.sort_by_key(|&i| colors[i]);
    let mut packs = Vec::with_capacity(springs.len().div_ceil(4));
    for color in order.chunk_by(|&i, &j| colors[i] == colors[j]) {
        for four in color.chunks(4) {
            let spring = |place: usize| {
                four.get(place).map_or_else(
                    || {
                        let first = (vertex_count + 2 * (place - 1)) as u32;
                        Spring {
                            vertices: [first, first + 1],
                            rest_length: 1.0,
                            stiffness: 0.0,
                        }
                    },
                    |&i| springs[i],
                )
            };
            let four: [Spring; 4] = std::array::from_fn(spring);
            let pack = Pack {
                vertices: std::array::from_fn(|i| four[i % 4].vertices[i / 4]),
                rest_length: f32x4::new(four.map(|spring| spring.rest_length as f32)),
            };
            packs.push((pack, four.map(|spring| spring.stiffness)));
        }
    }
    packs
}

impl Family for Springs {
    fn prepare(&mut self, update: XpbdUpdate, _: &Vec3) {
        for (memory, stiffness) in self.memory.iter_mut().zip(&self.stiffness) {
            memory.scaled_compliance = f32x4::new(stiffness.map(|k| scaled_compliance(update, k)));
        }
    }

    fn reset(&mut self) {
        for memory in &mut self.memory {
            memory.lambda = f32x4::splat(0.0);
        }
    }

    fn sweep(&mut self, x: &mut [f32x4]) {
        self.packs.sweep(&mut self.memory, x, project);
    }

    fn each_pin_impulse(&self, x: &[f32x4], see: &mut dyn FnMut(usize, Vec3)) {
        for (pack, memory) in self.packs.elements().iter().zip(&self.memory) {
            let lambdas = memory.lambda.to_array();
            for (i, lambda) in lambdas.into_iter().enumerate() {
                let ends = [pack.vertices[i], pack.vertices[i + 4]];
                let [a, b] = ends.map(|end| &x[end as usize]);
                // Padding has no λ, nor has a hard spring between prescribed ends.
                let held = [a, b].map(is_prescribed);
                if lambda == 0.0 || held == [false, false] {
                    continue;
                }
                let d = (*a - *b).to_array();
                let d = Vec3::from_fn(|axis, _| Real::from(d[axis]));
                let direction = length_and_direction(d, ends).1;
                for (end, sign) in ends.into_iter().zip([1.0, -1.0]) {
                    if is_prescribed(&x[end as usize]) {
                        see(end as usize, direction * (sign * Real::from(lambda)));
                    }
                }
            }
        }
    }
}

/// Below this (m²) the square of a length has lost digits.
const SHORTEST_SQUARED: f32 = 1e-30;

/// `Δλ = −(C + α̃λ)/(w₀ + w₁ + α̃)` for each of the four, with `C = l − L`, and what it moves.
///
/// The lanes are four visits of the naive loop in `examples/first_program.rs`. The direction `d/l` is never formed:
/// `change` is `Δλ/l`, one division for both, so λ grows by `change l` and the ends move by `±w change d`.
#[inline(always)]
fn project(pack: &Pack, memory: &mut Multipliers, x: &mut [f32x4; 8]) {
    // x, y, z and w of the four first ends, and of the four second ends.
    let [ax, ay, az, aw] = f32x4::transpose([x[0], x[1], x[2], x[3]]);
    let [bx, by, bz, bw] = f32x4::transpose([x[4], x[5], x[6], x[7]]);
    let mut d = [ax - bx, ay - by, az - bz];
    let squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    let mut divisor = squared.sqrt();
    let mut length = divisor;
    if squared.simd_lt(f32x4::splat(SHORTEST_SQUARED)).any() {
        (length, divisor, d) = degenerate(&pack.vertices, d);
    }
    let value = length - pack.rest_length;
    let denominator = (aw + bw + memory.scaled_compliance) * divisor;
    let smallest = f32x4::splat(SMALLEST);
    let change =
        -(value + memory.scaled_compliance * memory.lambda) / denominator.fast_max(smallest);
    let change = change & !denominator.simd_le(smallest); // NaN stays NaN
    memory.lambda += change * divisor;
    let (a, b) = (aw * change, bw * change);
    let first = [ax + a * d[0], ay + a * d[1], az + a * d[2], aw];
    let second = [bx - b * d[0], by - b * d[1], bz - b * d[2], bw];
    let [x0, x1, x2, x3] = f32x4::transpose(first);
    let [x4, x5, x6, x7] = f32x4::transpose(second);
    *x = [x0, x1, x2, x3, x4, x5, x6, x7];
}

/// Lengths and divisors again, with a substitute direction where a spring has no length: see
/// [`length_and_direction`].
#[cold]
#[inline(never)]
fn degenerate(vertices: &[u32; 8], d: [f32x4; 3]) -> (f32x4, f32x4, [f32x4; 3]) {
    let mut coordinates = d.map(|d| d.to_array());
    let (mut lengths, mut divisors) = ([0.0; 4], [0.0; 4]);
    for i in 0..4 {
        let difference = Vec3::from_fn(|axis, _| Real::from(coordinates[axis][i]));
        let (length, direction) = length_and_direction(difference, [vertices[i], vertices[i + 4]]);
        lengths[i] = length as f32;
        divisors[i] = lengths[i];
        if difference.norm_squared() < Real::from(SHORTEST_SQUARED) {
            divisors[i] = 1.0;
            for axis in 0..3 {
                coordinates[axis][i] = direction[axis] as f32;
            }
        }
    }
    let d = coordinates.map(f32x4::new);
    (f32x4::new(lengths), f32x4::new(divisors), d)
}
