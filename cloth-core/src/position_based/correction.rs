//! What one element moves its vertices by.

use super::rule::{RowAt, Rule};
use crate::element::{Constraint, Row, RowArray};
use crate::math::{Real, Vec3};

/// Moves the vertices of one element, at `x` (m), by `share` (dimensionless) of its correction.
#[inline(always)]
pub(super) fn project<const N: usize, E: Constraint<N>, R: Rule>(
    rule: &R,
    element: &E,
    inverse_mass: &[Real],
    share: Real,
    memory: &mut [R::Memory],
    x: &mut [Vec3; N],
) {
    let w = element.vertices().map(|v| inverse_mass[v as usize]);
    let moved = correction(rule, &element.rows(x), &w, share, memory);
    for i in 0..N {
        x[i] += moved[i];
    }
}

/// What one element moves its vertices by (m): `share` of what its rows ask for. All gradients are those at the start.
#[inline(always)]
pub(super) fn correction<const N: usize, A: RowArray<N>, R: Rule>(
    rule: &R,
    rows: &A,
    w: &[Real; N],
    share: Real,
    memory: &mut [R::Memory],
) -> [Vec3; N] {
    let moved = if R::ROWS_TOGETHER && A::LEN > 1 {
        together(rule, rows, w, share, memory)
    } else {
        in_turn(rule, rows.as_ref(), w, share, memory)
    };
    moved.map(|moved| moved * share)
}

/// Row after row. The value of a later row is updated to first order for what the earlier ones moved, which is exact for linear rows.
#[inline(always)]
fn in_turn<const N: usize, R: Rule>(
    rule: &R,
    rows: &[Row<N>],
    w: &[Real; N],
    share: Real,
    memory: &mut [R::Memory],
) -> [Vec3; N] {
    let mut moved = [Vec3::zeros(); N];
    for (row, memory) in rows.iter().zip(memory) {
        let mut value = row.value;
        if rows.len() > 1 {
            for i in 0..N {
                value += row.gradient[i].dot(&moved[i]);
            }
        }
        let seen = row_at(row, w, value);
        let Some(equation) = rule.equation(seen, memory) else {
            continue;
        };
        let change = -equation.residual / (seen.weight + equation.softness);
        rule.remember(share * change, memory);
        for i in 0..N {
            moved[i] += row.gradient[i] * (w[i] * change);
        }
    }
    moved
}

/// A pivot below this part of its diagonal is rounding: the row says nothing that the rows before it did not say.
const REDUNDANT: Real = 1e-12;

/// Solves `(J M⁻¹ Jᵀ + softness) Δλ = −residual` for the rows of one element by `L D Lᵀ`. A row without an equation is left out.
#[inline(always)]
fn together<const N: usize, A: RowArray<N>, R: Rule>(
    rule: &R,
    rows: &A,
    w: &[Real; N],
    share: Real,
    memory: &mut [R::Memory],
) -> [Vec3; N] {
    // L below the diagonal, D on it; a pivot of 0 leaves its row out.
    let (mut lower, mut change) = (A::per_row(A::per_row(0.0)), A::per_row(0.0));
    let (lower, change, rows) = (lower.as_mut(), change.as_mut(), rows.as_ref());
    for r in 0..rows.len() {
        let seen = row_at(&rows[r], w, rows[r].value);
        let Some(equation) = rule.equation(seen, &mut memory[r]) else {
            continue;
        };
        let whole = seen.weight + equation.softness;
        let (mut pivot, mut value) = (whole, -equation.residual);
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
        if pivot > REDUNDANT * whole {
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
        rule.remember(share * change[r], &mut memory[r]);
        for i in 0..N {
            moved[i] += rows[r].gradient[i] * (w[i] * change[r]);
        }
    }
    moved
}

/// What a method sees of a row with the value `value`.
#[inline(always)]
pub(super) fn row_at<const N: usize>(row: &Row<N>, w: &[Real; N], value: Real) -> RowAt {
    let mut weight = 0.0;
    for i in 0..N {
        weight += w[i] * row.gradient[i].norm_squared();
    }
    RowAt {
        value,
        weight,
        stiffness: row.stiffness,
    }
}
