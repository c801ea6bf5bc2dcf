//! The correction of one element: `Δxᵢ = wᵢ ∂C/∂xᵢ Δλ` over its rows, in the forms that make the loop fast.
//!
//! The plain form is [`row_by_row_correction`]. [`coupled_correction`] solves the rows of an element together,
//! [`dead_zone_correction`] reduces the multiplier of an inactive row to zero, and the others are the plain formula for
//! rows of a special shape.

use super::constraint_update::{ConstraintUpdate, RowEquation, RowState};
use crate::element::{Constraint, DeadZoneRow, Row, RowArray, RowForm, UnitRow, VectorRow};
use crate::math::{Real, Vec3};

/// Moves the vertices of one element, at `x` (m), by the `fraction` (dimensionless) of its correction.
#[inline(always)]
pub(super) fn project<const N: usize, E: Constraint<N>, U: ConstraintUpdate>(
    update: &U,
    element: &E,
    w: &[Real; N],
    fraction: Real,
    memory: &mut [U::Memory],
    x: &mut [Vec3; N],
) {
    let moved = correction(update, element, w, fraction, memory, x);
    for i in 0..N {
        x[i] += moved[i];
    }
}

/// The correction (m) of one element at `x` (m), times `fraction`. All gradients are those at `x`.
#[inline(always)]
pub(super) fn correction<const N: usize, E: Constraint<N>, U: ConstraintUpdate>(
    update: &U,
    element: &E,
    w: &[Real; N],
    fraction: Real,
    memory: &mut [U::Memory],
    x: &[Vec3; N],
) -> [Vec3; N] {
    let form = element.row_form(x);
    if let RowForm::Vector(row) = form {
        vector_row_correction(update, &row, w, fraction, memory, x)
    } else if let RowForm::Unit(row) = form {
        unit_row_correction(update, &row, w, fraction, memory)
    } else if let Some(rows) = element.dead_zone_rows(x) {
        dead_zone_correction(update, rows.as_ref(), w, fraction, memory)
    } else if U::ROWS_TOGETHER && E::Rows::LEN > 1 {
        coupled_correction(update, &element.rows(x), w, fraction, memory)
    } else {
        row_by_row_correction(update, &element.rows(x), w, fraction, memory)
    }
}

/// No Δλ changes a row whose `w̃ + scaled_compliance` is not above this.
const SMALLEST: Real = 1e-300;

/// `Δλ` of a row over `length`; 0 where no Δλ changes the row.
#[inline(always)]
fn change_over(length: Real, equation: RowEquation, weight: Real) -> Real {
    let denominator = (weight + equation.scaled_compliance) * length;
    if denominator > SMALLEST {
        -equation.residual / denominator
    } else {
        0.0
    }
}

/// One row whose gradients are unit vectors, given as direction times length: `Δλ/l = −residual/((w̃ + α̃) l)`
/// does for the division of the gradient by l and for that of Δλ.
#[inline(always)]
fn unit_row_correction<const N: usize, U: ConstraintUpdate>(
    update: &U,
    row: &UnitRow<N>,
    w: &[Real; N],
    fraction: Real,
    memory: &mut [U::Memory],
) -> [Vec3; N] {
    let seen = RowState {
        value: row.value,
        stiffness: row.stiffness,
        weight: sum(w),
    };
    let equation = update.equation(seen, &mut memory[0]);
    let change = fraction * change_over(row.length, equation, seen.weight);
    update.accumulate(change * row.length, &mut memory[0]);
    let mut moved = row.direction;
    for i in 0..N {
        moved[i] *= w[i] * change;
    }
    moved
}

/// Three rows at right angles to each other, with the same weight.
#[inline(always)]
fn vector_row_correction<const N: usize, U: ConstraintUpdate>(
    update: &U,
    row: &VectorRow<N>,
    w: &[Real; N],
    fraction: Real,
    memory: &mut [U::Memory],
    x: &[Vec3; N],
) -> [Vec3; N] {
    let value = row.value(x);
    let (mut weights, mut scaled) = (*w, *w);
    for i in 0..N {
        scaled[i] *= row.coefficients[i];
        weights[i] = scaled[i] * row.coefficients[i];
    }
    let weight = sum(&weights);
    let mut equation = |axis: usize| {
        let seen = RowState {
            value: value[axis],
            stiffness: row.stiffness,
            weight,
        };
        update.equation(seen, &mut memory[axis])
    };
    let (first, second, third) = (equation(0), equation(1), equation(2));
    // One quotient for the three, and it does not wait for the positions.
    let unit = RowEquation {
        residual: 1.0,
        ..first
    };
    let factor = fraction * change_over(1.0, unit, weight);
    let change = Vec3::new(first.residual, second.residual, third.residual) * factor;
    for axis in 0..3 {
        update.accumulate(change[axis], &mut memory[axis]);
    }
    let mut moved = [Vec3::zeros(); N];
    for i in 0..N {
        moved[i] = change * scaled[i];
    }
    moved
}

/// Row after row. The value of a later row is updated to first order for the corrections of the earlier ones,
/// which is exact for linear rows.
#[inline(always)]
fn row_by_row_correction<const N: usize, A: RowArray<N>, U: ConstraintUpdate>(
    update: &U,
    rows: &A,
    w: &[Real; N],
    fraction: Real,
    memory: &mut [U::Memory],
) -> [Vec3; N] {
    let mut moved = [Vec3::zeros(); N];
    for (r, row) in rows.as_ref().iter().enumerate() {
        let mut value = row.value;
        if r > 0 {
            for i in 0..N {
                value += row.gradient[i].dot(&moved[i]);
            }
        }
        let seen = row_state(row, w, value);
        let equation = update.equation(seen, &mut memory[r]);
        let change = change_over(1.0, equation, seen.weight);
        update.accumulate(fraction * change, &mut memory[r]);
        for i in 0..N {
            moved[i] += row.gradient[i] * (w[i] * change);
        }
    }
    moved.map(|moved| moved * fraction)
}

/// Row after row, as [`row_by_row_correction`], each with its accumulated multiplier: that of a row that
/// turns out to be inactive becomes zero.
///
/// Never over-relaxed, because the multiplier must not change its sign.
#[inline(always)]
fn dead_zone_correction<const N: usize, U: ConstraintUpdate>(
    update: &U,
    rows: &[DeadZoneRow<N>],
    w: &[Real; N],
    fraction: Real,
    memory: &mut [U::Memory],
) -> [Vec3; N] {
    let fraction = fraction.min(1.0);
    let mut moved = [Vec3::zeros(); N];
    for (row, memory) in rows.iter().zip(memory) {
        let mut row = *row;
        for i in 0..N {
            row.value += row.gradient[i].dot(&moved[i]);
        }
        let seen = dead_zone_row_state::<N, U>(&row, w, memory);
        let equation = update.equation(seen, memory);
        let change = change_over(1.0, equation, seen.weight);
        update.accumulate(fraction * change, memory);
        for i in 0..N {
            moved[i] += row.gradient[i] * (w[i] * change);
        }
    }
    moved.map(|moved| moved * fraction)
}

/// The state of a row with a dead zone.
#[inline(always)]
pub(super) fn dead_zone_row_state<const N: usize, U: ConstraintUpdate>(
    row: &DeadZoneRow<N>,
    w: &[Real; N],
    memory: &U::Memory,
) -> RowState {
    let weight = weight(&row.gradient, w);
    let multiplier = U::multiplier(memory);
    let value = row.acting_value(weight, multiplier);
    RowState {
        // An inactive row takes its multiplier back.
        value: value.unwrap_or(weight * multiplier),
        stiffness: row.stiffness,
        weight,
    }
}

/// A pivot below this fraction of its diagonal is rounding: the row is redundant.
const REDUNDANT: Real = 1e-12;

/// Solves `(J M⁻¹ Jᵀ + scaled_compliance) Δλ = −residual` for the rows of one element by `L D Lᵀ`. A row that
/// no Δλ changes is left out.
#[inline(always)]
fn coupled_correction<const N: usize, A: RowArray<N>, U: ConstraintUpdate>(
    update: &U,
    rows: &A,
    w: &[Real; N],
    fraction: Real,
    memory: &mut [U::Memory],
) -> [Vec3; N] {
    // L below the diagonal, D on it; a pivot of 0 leaves its row out.
    let (mut lower, mut change) = (A::per_row(A::per_row(0.0)), A::per_row(0.0));
    let (lower, change, rows) = (lower.as_mut(), change.as_mut(), rows.as_ref());
    for r in 0..rows.len() {
        let seen = row_state(&rows[r], w, rows[r].value);
        let equation = update.equation(seen, &mut memory[r]);
        let denominator = seen.weight + equation.scaled_compliance;
        if denominator <= SMALLEST {
            continue;
        }
        let (mut pivot, mut value) = (denominator, -equation.residual);
        let mut scaled = A::per_row(0.0); // L D
        let scaled = scaled.as_mut();
        for s in 0..r {
            let before = lower[s].as_ref()[s];
            if before == 0.0 {
                continue;
            }
            for i in 0..N {
                scaled[s] += w[i] * rows[r].gradient[i].dot(&rows[s].gradient[i]);
            }
            for t in 0..s {
                scaled[s] -= scaled[t] * lower[s].as_ref()[t];
            }
            let l = scaled[s] / before;
            pivot -= l * scaled[s];
            value -= l * change[s];
            lower[r].as_mut()[s] = l;
        }
        if pivot > REDUNDANT * denominator {
            lower[r].as_mut()[r] = pivot;
            change[r] = value;
        } else {
            lower[r].as_mut().fill(0.0);
        }
    }
    let mut moved = [Vec3::zeros(); N];
    for r in (0..rows.len()).rev() {
        let pivot = lower[r].as_ref()[r];
        if pivot == 0.0 {
            continue;
        }
        change[r] /= pivot;
        for q in r + 1..rows.len() {
            change[r] -= lower[q].as_ref()[r] * change[q];
        }
        update.accumulate(fraction * change[r], &mut memory[r]);
        for i in 0..N {
            moved[i] += rows[r].gradient[i] * (w[i] * change[r]);
        }
    }
    moved.map(|moved| moved * fraction)
}

/// The state of a row with the value `value`.
#[inline(always)]
pub(super) fn row_state<const N: usize>(row: &Row<N>, w: &[Real; N], value: Real) -> RowState {
    RowState {
        value,
        stiffness: row.stiffness,
        weight: weight(&row.gradient, w),
    }
}

/// `w̃ = Σ wᵢ ‖∂C/∂xᵢ‖²` (unit of C² per kg m²).
#[inline(always)]
fn weight<const N: usize>(gradient: &[Vec3; N], w: &[Real; N]) -> Real {
    let mut weights = *w;
    for i in 0..N {
        weights[i] *= gradient[i].norm_squared();
    }
    sum(&weights)
}

/// The sum of at least one number.
#[inline(always)]
fn sum<const N: usize>(numbers: &[Real; N]) -> Real {
    let mut sum = numbers[0];
    for &number in &numbers[1..] {
        sum += number;
    }
    sum
}
