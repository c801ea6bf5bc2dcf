//! Elements whose three rows are the coordinates of one vector: one SIMD register.

use super::positions::PADDING;
use super::{Family, SMALLEST, is_prescribed, scaled_compliance};
use crate::update::XpbdUpdate;
use cloth_core::element::{Constraint, Element, RowForm, VectorRow};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::coloring::Colored;
use cloth_core::step::BuildError;
use wide::f32x4;

/// The rows `C = Σ qᵢ xᵢ − target` of one element.
#[derive(Clone, Copy, Debug)]
struct Rows<const N: usize> {
    vertices: [u32; N],
    /// q.
    coefficients: [f32; N],
    /// `Σ qᵢ`, 0 where it is that but for rounding.
    sum: f32,
}

impl<const N: usize> Element<N> for Rows<N> {
    #[inline]
    fn vertices(&self) -> [u32; N] {
        self.vertices
    }
}

/// Multipliers and compliance of an element.
#[derive(Clone, Copy, Debug, Default)]
struct Multipliers {
    /// λ (kg m² per unit of C) in three lanes; the fourth is unused.
    lambda: f32x4,
    /// `target − (Σ qᵢ) o` (unit of C), with the origin o.
    target: f32x4,
    /// α̃ (unit of C² per kg m²).
    scaled_compliance: f32,
}

/// All elements of a family.
#[derive(Debug)]
pub(super) struct VectorRows<const N: usize> {
    rows: Colored<N, Rows<N>>,
    memory: Vec<Multipliers>,
    /// The same elements in visiting order and double precision.
    exact: Vec<VectorRow<N>>,
}

/// The sum of the coefficients.
fn sum<const N: usize>(row: &VectorRow<N>) -> Real {
    let sum: Real = row.coefficients.iter().sum();
    let size: Real = row.coefficients.iter().map(|q| q.abs()).sum();
    if sum.abs() > 1e-12 * size { sum } else { 0.0 }
}

impl<const N: usize> VectorRows<N> {
    pub(super) fn new<E: Constraint<N>>(
        elements: &[E],
        vertex_count: usize,
    ) -> Result<Self, BuildError> {
        // These do not depend on positions.
        let exact = |element: &E| match element.row_form(&[Vec3::zeros(); N]) {
            RowForm::Vector(row) => Some(row),
            RowForm::Unit(_) | RowForm::General => None,
        };
        if E::CHANGES_WITH_TIME {
            return Err(BuildError::SettingsConflict {
                one: "a sweep in single precision",
                needs: "elements whose rest data do not change with time",
            });
        }
        let exact: Option<Vec<VectorRow<N>>> = elements.iter().map(exact).collect();
        let exact = exact.ok_or(BuildError::SettingsConflict {
            one: "a sweep in single precision",
            needs: "springs, and elements whose rows are one vector row",
        })?;
        let rows = elements.iter().zip(&exact);
        let rows: Vec<Rows<N>> = rows
            .map(|(element, row)| Rows {
                vertices: element.vertices(),
                coefficients: row.coefficients.map(|q| q as f32),
                sum: sum(row) as f32,
            })
            .collect();
        let rows = Colored::new(&rows, vertex_count + PADDING);
        let order = rows.input_index().iter();
        Ok(Self {
            exact: order.map(|&i| exact[i as usize]).collect(),
            memory: vec![Multipliers::default(); elements.len()],
            rows,
        })
    }
}

impl<const N: usize> Family for VectorRows<N> {
    fn prepare(&mut self, update: XpbdUpdate, origin: &Vec3) {
        for (memory, row) in self.memory.iter_mut().zip(&self.exact) {
            let target = row.target - origin * sum(row);
            let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| target[axis] as f32);
            memory.target = f32x4::new([x, y, z, 0.0]);
            memory.scaled_compliance = scaled_compliance(update, row.stiffness);
        }
    }

    fn reset(&mut self) {
        for memory in &mut self.memory {
            memory.lambda = f32x4::splat(0.0);
        }
    }

    fn sweep(&mut self, x: &mut [f32x4]) {
        self.rows.sweep(&mut self.memory, x, project);
    }

    fn each_pin_impulse(&self, x: &[f32x4], see: &mut dyn FnMut(usize, Vec3)) {
        for (row, memory) in self.rows.elements().iter().zip(&self.memory) {
            for (&vertex, &q) in row.vertices.iter().zip(&row.coefficients) {
                if is_prescribed(&x[vertex as usize]) {
                    let lambda = memory.lambda.to_array();
                    let lambda = Vec3::from_fn(|axis, _| Real::from(lambda[axis]));
                    see(vertex as usize, lambda * Real::from(q));
                }
            }
        }
    }
}

/// `Δλ = −(C + α̃λ)/(Σ wᵢ qᵢ² + α̃)` for the three coordinates, and what it moves.
#[inline(always)]
fn project<const N: usize>(rows: &Rows<N>, memory: &mut Multipliers, x: &mut [f32x4; N]) {
    let q = &rows.coefficients;
    // From the first vertex, because differences of neighbours have fewer digits to lose than their places.
    let mut value = x[0] * f32x4::splat(rows.sum) - memory.target;
    for i in 1..N {
        value += (x[i] - x[0]) * f32x4::splat(q[i]);
    }
    let w: [f32; N] = std::array::from_fn(|i| x[i].to_array()[3]);
    let mut denominator = memory.scaled_compliance;
    for i in 0..N {
        denominator += w[i] * (q[i] * q[i]);
    }
    // The inverse mass is not a coordinate.
    let coordinates = f32x4::new([1.0, 1.0, 1.0, 0.0]);
    if denominator <= SMALLEST {
        return;
    }
    let factor = -1.0 / denominator;
    let residual = value + memory.lambda * f32x4::splat(memory.scaled_compliance);
    let change = residual * coordinates * f32x4::splat(factor);
    memory.lambda += change;
    for i in 0..N {
        x[i] += change * f32x4::splat(w[i] * q[i]);
    }
}
