//! Solving with a matrix that differs in a few rows from one that has been factorised: the identity of Woodbury.
//!
//! `(A + U C Uᵀ)⁻¹ b = y − Z (C⁻¹ + UᵀZ)⁻¹ Uᵀ y` with `y = A⁻¹b`, `Z = A⁻¹U`. It takes `C⁻¹`, which may be zero: a
//! column u with `C⁻¹ = 0` is a spring without compliance, the constraint `uᵀx = 0`. M. A. Woodbury, "Inverting
//! modified matrices", 1950; W. W. Hager, "Updating the inverse of a matrix", SIAM Review 31, 1989,
//! <https://doi.org/10.1137/1031049>.
//!
//! *Why.* Let λ solve `(C⁻¹ + UᵀZ) λ = Uᵀy`, and x = y − Z λ. Then `Uᵀx = Uᵀy − UᵀZ λ = C⁻¹ λ` and A x = b − U λ, so
//! `(A + U C Uᵀ) x = b − U λ + U C C⁻¹ λ = b`. Where C⁻¹ = 0 the same two equations read Uᵀx = 0 and A x + U λ = b: the
//! minimum of ½ xᵀAx − bᵀx under that constraint, λ its multipliers. The cost is a column of Z, a solve with A, for
//! each column of U once (three columns take one solve, as it has x, y and z), and then k products with U and Z a
//! solve.
//!
//! *Columns of a change* (`GlobalSystem` makes them): an attachment of stiffness w at vertex i has u = eᵢ and C = w; an
//! element that is removed has the rows of S and C = −w; a vertex that is grabbed has u = eᵢ and C⁻¹ = 0. A vertex that
//! is released has the row of the identity in A and needs a on the diagonal and r beside it: with `U = [eᵢ, r]` and
//! `C = [[a − 1, 1], [1, 0]]`, `U C Uᵀ = (a − 1) eᵢ eᵢᵀ + eᵢ rᵀ + r eᵢᵀ`, and `C⁻¹ = [[0, 1], [1, 1 − a]]`.

use cloth_core::math::{Real, Vec3};

/// A correction of rank k for solutions with three right-hand sides.
#[derive(Clone, Debug, Default)]
pub struct WoodburyUpdate {
    /// Columns of U, one after another: row and value.
    entries: Vec<(u32, Real)>,
    /// End of each column in `entries`.
    ends: Vec<usize>,
    /// `C⁻¹` as triplets.
    inverse: Vec<(u32, u32, Real)>,
    /// Z, row by row, k numbers each.
    solved: Vec<Real>,
    /// `C⁻¹ + UᵀZ` as L and U, row by row, and the order of its rows.
    lower_upper: Vec<Real>,
    order: Vec<u32>,
    small: Vec<Vec3>,
}

impl WoodburyUpdate {
    /// Removes all columns.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.ends.clear();
        self.inverse.clear();
    }

    /// Number of columns k.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.ends.len()
    }

    /// Adds a column of U, rows and values, and returns its number. Its entries in `C⁻¹` are zero.
    pub fn push(&mut self, column: impl IntoIterator<Item = (u32, Real)>) -> u32 {
        self.entries.extend(column);
        self.ends.push(self.entries.len());
        self.ends.len() as u32 - 1
    }

    /// Adds `value` to entry (i, j) of `C⁻¹`, and to (j, i) if that is another.
    ///
    /// # Panics
    /// If there is no such column.
    pub fn set_inverse(&mut self, i: u32, j: u32, value: Real) {
        let count = self.ends.len() as u32;
        assert!(i < count && j < count, "column {i} or {j} of {count}");
        self.inverse.push((i, j, value));
        if i != j {
            self.inverse.push((j, i, value));
        }
    }

    fn column(&self, index: usize) -> &[(u32, Real)] {
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.entries[start..self.ends[index]]
    }

    /// Computes Z with `solve`, which has to replace its second argument by A⁻¹ times the first, both of `dimension`
    /// rows, for x, y and z alike: three columns at a time. Returns whether the corrected matrix can be solved with.
    pub fn prepare(
        &mut self,
        dimension: usize,
        mut solve: impl FnMut(&[Vec3], &mut [Vec3]),
    ) -> bool {
        let k = self.rank();
        self.solved.clear();
        self.solved.resize(dimension * k, 0.0);
        let mut b = vec![Vec3::zeros(); dimension];
        let mut x = b.clone();
        for first in (0..k).step_by(3) {
            b.fill(Vec3::zeros());
            let columns = first..k.min(first + 3);
            for (lane, index) in columns.clone().enumerate() {
                for &(row, value) in self.column(index) {
                    b[row as usize][lane] += value;
                }
            }
            solve(&b, &mut x);
            for (row, x) in x.iter().enumerate() {
                for (lane, index) in columns.clone().enumerate() {
                    self.solved[row * k + index] = x[lane];
                }
            }
        }
        self.lower_upper.clear();
        self.lower_upper.resize(k * k, 0.0);
        for i in 0..k {
            let start = if i == 0 { 0 } else { self.ends[i - 1] };
            for &(row, value) in &self.entries[start..self.ends[i]] {
                let z = &self.solved[row as usize * k..][..k];
                for (sum, z) in self.lower_upper[i * k..][..k].iter_mut().zip(z) {
                    *sum += value * z;
                }
            }
        }
        for &(i, j, value) in &self.inverse {
            self.lower_upper[i as usize * k + j as usize] += value;
        }
        self.small = vec![Vec3::zeros(); k];
        self.eliminate()
    }

    /// Gaussian elimination with partial pivoting. Returns whether every pivot is worth something.
    fn eliminate(&mut self) -> bool {
        let k = self.rank();
        let a = &mut self.lower_upper;
        self.order = (0..k as u32).collect();
        let scale: Vec<Real> = a
            .chunks_exact(k.max(1))
            .map(|row| row.iter().map(|v| v.abs()).fold(0.0, Real::max))
            .collect();
        for column in 0..k {
            let relative = |row: usize, a: &[Real], order: &[u32]| {
                a[row * k + column].abs() / scale[order[row] as usize]
            };
            let best = (column..k).max_by(|&r, &s| {
                relative(r, a, &self.order).total_cmp(&relative(s, a, &self.order))
            });
            let best = best.unwrap_or(column);
            let pivot = relative(best, a, &self.order);
            if pivot.is_nan() || pivot <= SMALLEST_PIVOT {
                return false;
            }
            if best != column {
                self.order.swap(best, column);
                for j in 0..k {
                    a.swap(best * k + j, column * k + j);
                }
            }
            for row in column + 1..k {
                let factor = a[row * k + column] / a[column * k + column];
                a[row * k + column] = factor;
                for j in column + 1..k {
                    a[row * k + j] -= factor * a[column * k + j];
                }
            }
        }
        true
    }

    /// Makes of `x = A⁻¹b` the solution with the corrected matrix, in place.
    ///
    /// # Panics
    /// If `x` is shorter than the dimension that was prepared.
    pub fn correct(&mut self, x: &mut [Vec3]) {
        let k = self.rank();
        if k == 0 {
            return;
        }
        for i in 0..k {
            let column = self.order[i] as usize;
            self.small[i] = self
                .column(column)
                .iter()
                .map(|&(row, value)| x[row as usize] * value)
                .sum();
        }
        let (a, t) = (&self.lower_upper, &mut self.small);
        for i in 0..k {
            for j in 0..i {
                let below = t[j] * a[i * k + j];
                t[i] -= below;
            }
        }
        for i in (0..k).rev() {
            for j in i + 1..k {
                let beyond = t[j] * a[i * k + j];
                t[i] -= beyond;
            }
            t[i] /= a[i * k + i];
        }
        for (z, x) in self.solved.chunks_exact(k).zip(x) {
            for (z, t) in z.iter().zip(t.iter()) {
                *x -= t * *z;
            }
        }
    }
}

/// A pivot below this fraction of the largest entry of its row is rounding.
const SMALLEST_PIVOT: Real = 1e-13;

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    fn noise(i: usize) -> Real {
        2.0 * (i as Real * 0.754_877_666 + 0.17).fract() - 1.0
    }

    #[test]
    fn corrected_solutions_are_those_of_the_changed_matrix() {
        let n = 12;
        let root = DMatrix::from_fn(n, n, |i, j| noise(n * i + j));
        let a = &root * root.transpose() + DMatrix::identity(n, n);
        let columns: [&[(u32, Real)]; 5] = [
            &[(0, 1.0), (3, -1.0)],
            &[(7, 2.0)],
            &[(2, 1.0)],
            &[(1, 0.5), (4, 0.3), (11, -2.0)],
            &[(9, 1.0)],
        ];
        // C = diag(3, −0.1), a coupled pair [[4, 1], [1, 0]], and a constraint.
        let mut low_rank = WoodburyUpdate::default();
        for column in columns {
            low_rank.push(column.iter().copied());
        }
        low_rank.set_inverse(0, 0, 1.0 / 3.0);
        low_rank.set_inverse(1, 1, -10.0);
        low_rank.set_inverse(2, 3, 1.0);
        low_rank.set_inverse(3, 3, -4.0);
        let inverse = a.clone().try_inverse().unwrap();
        let apply = |b: &[Vec3], x: &mut [Vec3]| {
            for i in 0..n {
                x[i] = (0..n).map(|j| b[j] * inverse[(i, j)]).sum();
            }
        };
        assert!(low_rank.prepare(n, apply));
        let b: Vec<Vec3> = (0..n)
            .map(|i| Vec3::from_fn(|axis, _| noise(7 * i + axis)))
            .collect();
        let mut x = b.clone();
        apply(&b, &mut x);
        low_rank.correct(&mut x);

        // The same with the constraint as a very stiff spring does not do for twelve digits; so with a multiplier.
        let mut changed = DMatrix::zeros(n + 1, n + 1);
        changed.view_mut((0, 0), (n, n)).copy_from(&a);
        let mut add = |p: usize, q: usize, c: Real| {
            for &(i, u) in columns[p] {
                for &(j, v) in columns[q] {
                    changed[(i as usize, j as usize)] += c * u * v;
                }
            }
        };
        add(0, 0, 3.0);
        add(1, 1, -0.1);
        add(2, 2, 4.0);
        add(2, 3, 1.0);
        add(3, 2, 1.0);
        changed[(9, n)] = 1.0;
        changed[(n, 9)] = 1.0;
        let expected = changed.lu();
        for axis in 0..3 {
            let rhs = DMatrix::from_fn(n + 1, 1, |i, _| if i < n { b[i][axis] } else { 0.0 });
            let expected = expected.solve(&rhs).unwrap();
            for i in 0..n {
                let error = x[i][axis] - expected[(i, 0)];
                assert!(error.abs() < 1e-12, "{i} {axis}: {error:e}");
            }
        }
        assert!(x[9].amax() < 1e-14);
    }

    #[test]
    fn without_columns_nothing_changes_and_singular_ones_are_noticed() {
        let identity = |b: &[Vec3], x: &mut [Vec3]| x.copy_from_slice(b);
        let mut low_rank = WoodburyUpdate::default();
        assert!(low_rank.prepare(3, identity));
        let mut x = [Vec3::x(), Vec3::y(), Vec3::z()];
        low_rank.correct(&mut x);
        assert_eq!(x, [Vec3::x(), Vec3::y(), Vec3::z()]);
        // I − e eᵀ is singular.
        let column = low_rank.push([(1, 1.0)]);
        low_rank.set_inverse(column, column, -1.0);
        assert!(!low_rank.prepare(3, identity));
        low_rank.clear();
        assert_eq!(low_rank.rank(), 0);
    }
}
