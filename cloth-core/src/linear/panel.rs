//! A Cholesky factor laid out for solving with three right-hand sides at once, again and again.
//!
//! Where a matrix acts on x, y and z alike, one solve carries all three. Projective dynamics does so in every
//! iteration with the same factor, and then its layout decides how long an iteration takes: the solve reads every
//! number of the factor twice and does little with it.

use super::cholesky::FactorView;
use crate::math::{Real, Vec3};
use crate::wide::wide;

/// Columns of a panel, at most: its right-hand sides then fit into the registers of any 64-bit processor.
const WIDEST: usize = 4;

/// x, y, z and one lane of padding, so that compilers use whole vector registers.
type Lanes = [Real; 4];

/// `L` of a factorisation `P A Pᵀ = L Lᵀ`, as panels.
///
/// A *panel* is up to four neighbouring columns with the same rows below them. It keeps its triangle, the diagonal inverted, then its rows
/// from top to bottom; the forward pass reads the numbers from first to last, the backward pass from last to first, and
/// both use an entry of the right-hand side four times when they have it.
#[derive(Clone, Debug)]
pub struct PanelFactor {
    /// Place in the caller's vectors of each row, in the order of the factor.
    places: Vec<u32>,
    panels: Vec<Panel>,
    /// Row lists; panels of one supernode share theirs.
    rows: Vec<u32>,
    values: Vec<Real>,
    work: Vec<Lanes>,
}

#[derive(Clone, Copy, Debug)]
struct Panel {
    first_column: u32,
    width: u32,
    /// Its part of the row lists.
    rows: [u32; 2],
    /// Its start in the numbers.
    values: usize,
}

impl PanelFactor {
    /// Copies a factor. Row `r` of the matrix belongs to entry `places[r]` of the vectors that [`PanelFactor::solve`] is given.
    ///
    /// # Panics
    /// If there is not one place per row of the matrix.
    #[must_use]
    pub fn new(factor: FactorView<'_>, places: &[u32]) -> Self {
        let order = factor.order();
        assert_eq!(places.len(), order.len(), "one place per row");
        let mut this = Self {
            places: order.iter().map(|&row| places[row as usize]).collect(),
            panels: Vec::new(),
            rows: Vec::new(),
            values: Vec::new(),
            work: vec![[0.0; 4]; order.len()],
        };
        let mut value_count = 0;
        for index in 0..factor.supernode_count() {
            let (start, pattern, block) = factor.supernode(index);
            let columns = block.ncols();
            let list = this.rows.len();
            this.rows.extend(start as u32..(start + columns) as u32);
            this.rows.extend_from_slice(pattern);
            for column in (0..columns).step_by(WIDEST) {
                let width = WIDEST.min(columns - column);
                let below = list + column + width..this.rows.len();
                this.panels.push(Panel {
                    first_column: (start + column) as u32,
                    width: width as u32,
                    rows: [below.start as u32, below.end as u32],
                    values: value_count,
                });
                value_count += (width + below.len()) * width;
            }
        }
        this.values = vec![0.0; value_count];
        this.refill(factor);
        this
    }

    /// Copies the numbers of a later factorisation of a matrix with the same pattern, without allocating.
    ///
    /// # Panics
    /// If the pattern is not the one that this was made from.
    pub fn refill(&mut self, factor: FactorView<'_>) {
        assert_eq!(
            self.places.len(),
            factor.order().len(),
            "rows of the factor"
        );
        let mut values = self.values.iter_mut();
        let mut push = |value: Real| *values.next().expect("the same pattern") = value;
        for index in 0..factor.supernode_count() {
            let (_, _, block) = factor.supernode(index);
            for first in (0..block.ncols()).step_by(WIDEST) {
                let columns = first..block.ncols().min(first + WIDEST);
                for row in first..block.nrows() {
                    for column in columns.clone() {
                        push(match row {
                            _ if row < column => 0.0,
                            _ if row == column => 1.0 / block[(row, column)],
                            _ => block[(row, column)],
                        });
                    }
                }
            }
        }
        assert!(values.next().is_none(), "the same pattern");
    }

    /// Solves `A x = b` for x, y and z alike. Entries that are no row's place are neither read nor written.
    ///
    /// # Panics
    /// If `b` or `x` has no entry at the place of a row.
    pub fn solve(&mut self, b: &[Vec3], x: &mut [Vec3]) {
        for (work, &place) in self.work.iter_mut().zip(&self.places) {
            let b = &b[place as usize];
            *work = [b.x, b.y, b.z, 0.0];
        }
        let (rows, values, work) = (&self.rows[..], &self.values[..], &mut self.work[..]);
        let panels = &self.panels[..];
        wide(
            #[inline(always)]
            || {
                for panel in panels {
                    match panel.width {
                        1 => panel.forward::<1>(rows, values, work),
                        2 => panel.forward::<2>(rows, values, work),
                        3 => panel.forward::<3>(rows, values, work),
                        _ => panel.forward::<4>(rows, values, work),
                    }
                }
                for panel in panels.iter().rev() {
                    match panel.width {
                        1 => panel.backward::<1>(rows, values, work),
                        2 => panel.backward::<2>(rows, values, work),
                        3 => panel.backward::<3>(rows, values, work),
                        _ => panel.backward::<4>(rows, values, work),
                    }
                }
            },
        );
        for (work, &place) in self.work.iter().zip(&self.places) {
            x[place as usize] = Vec3::new(work[0], work[1], work[2]);
        }
    }
}

impl Panel {
    /// The rows below the triangle, and the numbers row by row: first of the triangle, then of those rows.
    #[inline(always)]
    fn parts<'a, const W: usize>(
        &self,
        rows: &'a [u32],
        values: &'a [Real],
    ) -> (&'a [u32], &'a [[Real; W]], &'a [[Real; W]]) {
        let rows = &rows[self.rows[0] as usize..self.rows[1] as usize];
        let values = &values[self.values..self.values + (W + rows.len()) * W];
        let (triangle, below) = values.as_chunks::<W>().0.split_at(W);
        (rows, triangle, below)
    }

    /// Its part of `L y = b`: solves for its own entries, subtracts them from those below.
    #[inline(always)]
    fn forward<const W: usize>(&self, rows: &[u32], values: &[Real], work: &mut [Lanes]) {
        let (rows, triangle, below) = self.parts::<W>(rows, values);
        let own = &mut work[self.first_column as usize..][..W];
        let mut y = [[0.0; 4]; W];
        for i in 0..W {
            y[i] = own[i];
            for j in 0..i {
                y[i] = minus(y[i], triangle[i][j], y[j]);
            }
            y[i] = y[i].map(|lane| lane * triangle[i][i]);
            own[i] = y[i];
        }
        for (&row, l) in rows.iter().zip(below) {
            let entry = &mut work[row as usize];
            for j in 0..W {
                *entry = minus(*entry, l[j], y[j]);
            }
        }
    }

    /// Its part of `Lᵀ x = y`: subtracts the entries below from its own, solves for these.
    ///
    /// The rows are walked from the last to the first, so that the whole pass reads the factor as one descending
    /// stream; from the first to the last it would be many short ascending ones, which takes twice as long where the
    /// factor does not fit into the cache.
    #[inline(always)]
    fn backward<const W: usize>(&self, rows: &[u32], values: &[Real], work: &mut [Lanes]) {
        let (rows, triangle, below) = self.parts::<W>(rows, values);
        let first = self.first_column as usize;
        let mut x = [[0.0; 4]; W];
        x.copy_from_slice(&work[first..first + W]);
        for (&row, l) in rows.iter().zip(below).rev() {
            let entry = work[row as usize];
            for j in 0..W {
                x[j] = minus(x[j], l[j], entry);
            }
        }
        for i in (0..W).rev() {
            for j in i + 1..W {
                x[i] = minus(x[i], triangle[j][i], x[j]);
            }
            x[i] = x[i].map(|lane| lane * triangle[i][i]);
        }
        work[first..first + W].copy_from_slice(&x);
    }
}

/// `a − l b`, lane by lane.
#[inline(always)]
fn minus(a: Lanes, l: Real, b: Lanes) -> Lanes {
    std::array::from_fn(|lane| a[lane] - l * b[lane])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::{Cholesky, UpperPattern};

    /// `M + 20 L` of a grid of `n` × `n` vertices with one diagonal a cell; the masses differ.
    fn grid_matrix(n: usize, mass: Real) -> Cholesky {
        let vertex_count = n * n;
        let mut column_offsets = vec![0];
        let mut rows: Vec<u32> = Vec::new();
        let mut values = Vec::new();
        let mut diagonal: Vec<Real> = (0..vertex_count)
            .map(|v| mass * (1.0 + (v % 7) as Real))
            .collect();
        let neighbours = |v: usize| {
            let (c, r) = (v % n, v / n);
            [
                (c > 0 && r > 0).then(|| v - n - 1),
                (r > 0).then(|| v - n),
                (c > 0).then(|| v - 1),
            ]
        };
        for v in 0..vertex_count {
            for w in neighbours(v).into_iter().flatten() {
                diagonal[v] += 20.0;
                diagonal[w] += 20.0;
            }
        }
        for v in 0..vertex_count {
            for w in neighbours(v).into_iter().flatten() {
                rows.push(w as u32);
                values.push(-20.0);
            }
            rows.push(v as u32);
            values.push(diagonal[v]);
            column_offsets.push(rows.len() as u32);
        }
        let mut cholesky = Cholesky::analyze(UpperPattern {
            column_offsets,
            rows,
        })
        .unwrap();
        cholesky.values_mut().copy_from_slice(&values);
        cholesky.factorize().unwrap();
        cholesky
    }

    fn right_hand_side(n: usize) -> Vec<Vec3> {
        let wave = |v: usize, axis: usize| ((v * (axis + 3)) as Real * 0.37).cos();
        (0..n)
            .map(|v| Vec3::from_fn(|axis, _| wave(v, axis)))
            .collect()
    }

    /// faer's own solve.
    fn reference(cholesky: &mut Cholesky, b: &[Vec3]) -> Vec<Vec3> {
        let n = b.len();
        let mut columns = vec![0.0; 3 * n];
        for (v, b) in b.iter().enumerate() {
            (0..3).for_each(|axis| columns[axis * n + v] = b[axis]);
        }
        cholesky.solve_in_place(&mut columns);
        (0..n)
            .map(|v| Vec3::from_fn(|axis, _| columns[axis * n + v]))
            .collect()
    }

    fn relative_difference(a: &[Vec3], b: &[Vec3]) -> Real {
        let largest =
            |it: &mut dyn Iterator<Item = Vec3>| it.map(|d| d.amax()).fold(0.0, Real::max);
        largest(&mut a.iter().zip(b).map(|(a, b)| a - b))
            / largest(&mut b.iter().copied()).max(1e-300)
    }

    #[test]
    fn panels_solve_as_faer_does() {
        for n in [0, 1, 2, 3, 5, 17, 40] {
            let mut cholesky = grid_matrix(n, 0.3);
            let b = right_hand_side(n * n);
            let places: Vec<u32> = (0..(n * n) as u32).collect();
            let mut x = vec![Vec3::zeros(); n * n];
            PanelFactor::new(cholesky.factor(), &places).solve(&b, &mut x);
            let error = relative_difference(&x, &reference(&mut cholesky, &b));
            assert!(error < 1e-13, "{n} a side: {error:e}");
        }
    }

    #[test]
    fn refilled_panels_are_those_of_a_new_copy() {
        let places: Vec<u32> = (0..81).collect();
        let b = right_hand_side(81);
        let mut panels = PanelFactor::new(grid_matrix(9, 0.3).factor(), &places);
        let other = grid_matrix(9, 4.0);
        panels.refill(other.factor());
        let (mut x, mut expected) = (b.clone(), b.clone());
        panels.solve(&b, &mut x);
        PanelFactor::new(other.factor(), &places).solve(&b, &mut expected);
        assert_eq!(x, expected);
    }

    #[test]
    fn entries_without_a_row_are_left_alone() {
        let mut cholesky = grid_matrix(4, 1.0);
        let places: Vec<u32> = (0..16).map(|row| 31 - 2 * row).collect();
        let b = right_hand_side(16);
        let mut spread = vec![Vec3::repeat(Real::NAN); 32];
        (0..16).for_each(|row| spread[places[row] as usize] = b[row]);
        let mut x = vec![Vec3::repeat(-7.0); 32];
        PanelFactor::new(cholesky.factor(), &places).solve(&spread, &mut x);
        let solution: Vec<Vec3> = places.iter().map(|&place| x[place as usize]).collect();
        assert!(relative_difference(&solution, &reference(&mut cholesky, &b)) < 1e-13);
        assert!((0..16).all(|i| x[2 * i] == Vec3::repeat(-7.0)));
    }
}
