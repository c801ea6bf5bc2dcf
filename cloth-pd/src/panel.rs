//! A Cholesky factor laid out for solving with three right-hand sides at once, again and again: a supernodal triangular
//! solve (Ng and Peyton 1993, <https://doi.org/10.1137/0914063>; T. A. Davis, *Direct Methods for Sparse Linear
//! Systems*, SIAM 2006, <https://doi.org/10.1137/1.9780898718881>, chapters 3 and 4), on threads over independent
//! subtrees of the elimination tree.
//!
//! *The solve.* With `A = L Lᵀ` (rows in the order of the factor) `L y = b` goes forward and `Lᵀ x = y` backward:
//! `yⱼ = (bⱼ − Σ over k < j of Lⱼₖ yₖ)/Lⱼⱼ`, `xⱼ = (yⱼ − Σ over i > j of Lᵢⱼ xᵢ)/Lⱼⱼ`. Each number of L below the
//! diagonal is used once in either pass.
//!
//! *Why subtrees are independent.* To eliminate vertex j couples all its neighbours of higher number with each other:
//! that is the fill, and these neighbours are the rows of column j. Let the parent of j be the first of these. The
//! others are coupled with it, so they are rows of its column too, and by that each row of column j is an ancestor of
//! j. So two columns neither of which is an ancestor of the other have no number of L in common: Lᵢⱼ = 0, and the
//! forward pass of disjoint subtrees can go side by side, each with a sum of its own for what it takes from the entries
//! of common ancestors, and so can the backward pass once these are known.
//! *Supernodes* are neighbouring columns with the same rows below them, which a dense separator has.
//!
//! Where a matrix acts on x, y and z alike, one solve carries all three. Projective dynamics does so in every
//! iteration with the same factor, and then its layout decides how long an iteration takes: the solve reads every
//! number of the factor twice and does little with it, a product and a difference for each of x, y and z. So x, y and z
//! of a row share a vector register, the factor is read twice for all three and not twice for each, and the right-hand
//! sides of a panel of up to four columns stay in registers while its rows go by.
//!
//! faer's solve is one for any number of right-hand sides. For each supernode it calls a dense triangular solve and a
//! dense matrix product. Going forward this goes to a scratch matrix, and from there into the rows below, one
//! right-hand side after the other; going backward the rows are first gathered there. With three right-hand sides and
//! supernodes of a few columns there is little arithmetic to a call. Here there is no call and no scratch matrix: a
//! number of the factor is multiplied by three lanes and subtracted from its row at once.
//!
//! So it takes 48 µs for the 280 of faer's solve at 64 vertices a side, 270 for 1220 at 128, and 2.3 ms for 16 at 256
//! (without bending, least of many, one thread of an AMD EPYC, Zen 4, commit 8bb69bfa). The factor in single precision
//! is not faster (a solve takes 1.3 times as long at 64 and 128 vertices a side, 1.1 times at 256), as a number has to
//! be widened before it is used.

mod parts;

use cloth_core::math::{Real, Vec3};
use cloth_core::method::linear::FactorView;
use cloth_core::method::parallel::wide;
use parts::Division;

/// Columns of a panel, at most: its right-hand sides then fit into the registers of any 64-bit processor.
const WIDEST: usize = 4;

/// x, y, z and one lane of padding, so that compilers use whole vector registers.
type Lanes = [Real; 4];

/// `L` of a factorisation `Π A Πᵀ = L Lᵀ`, Π a permutation, as panels.
///
/// A *panel* is up to four neighbouring columns with the same rows below them. It keeps its triangle, the diagonal
/// inverted, then its rows from top to bottom; the forward pass reads the numbers from first to last, the backward pass
/// from last to first, and both use an entry of the right-hand side four times when they have it.
///
/// Large factors are cut into a few parts, each some independent subtrees of the elimination tree, and their separator
/// (the common ancestors). Several threads can share the parts; the cut depends on the factor alone, so the bits of a
/// solution do not depend on the number of threads.
#[derive(Clone, Debug)]
pub struct PanelFactor {
    /// Supernodes in the order in which `panels` has them: part by part, then the separator.
    supernodes: Vec<u32>,
    parts: Vec<Part>,
    separator: Part,
    /// Row lists, of entries of the part's stretch of `work`; panels of one supernode share theirs.
    rows: Vec<u32>,
    values: Vec<Real>,
    work: Vec<Lanes>,
    /// Entry in `work` of each row of the matrix.
    work_indices: Vec<u32>,
}

/// Columns that depend on no others below them, and their stretch of `work`: an entry for each of their rows, then one
/// for each row of the separator that they reach.
#[derive(Clone, Debug)]
struct Part {
    panels: Vec<Panel>,
    /// Row of the matrix of each of its own entries.
    own: Vec<u32>,
    /// Row of the separator, counted there, of each other entry.
    reached: Vec<u32>,
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
    /// Copies a factor.
    #[must_use]
    pub fn new(factor: FactorView<'_>) -> Self {
        let division = Division::of(factor);
        let order = factor.order();
        let mut this = Self {
            supernodes: Vec::new(),
            parts: Vec::new(),
            separator: Part::of(&division.separator, factor),
            rows: Vec::new(),
            values: Vec::new(),
            work: Vec::new(),
            work_indices: vec![0; order.len()],
        };
        // Where a row of the factor is in the part that is being laid out.
        let mut local = vec![0; order.len()];
        let mut is_in_separator = vec![false; order.len()];
        let mut separator_index = vec![0; order.len()];
        for (index, row) in (0..).zip(columns(&division.separator, factor)) {
            (is_in_separator[row], separator_index[row]) = (true, index);
        }
        let mut value_count = 0;
        for members in &division.parts {
            let mut part = Part::of(members, factor);
            let mut reached: Vec<usize> = Vec::new();
            for &index in members {
                let below = factor.supernode(index as usize).1.iter();
                reached.extend(
                    below
                        .map(|&row| row as usize)
                        .filter(|&row| is_in_separator[row]),
                );
            }
            reached.sort_unstable();
            reached.dedup();
            let entries = columns(members, factor).chain(reached.iter().copied());
            (0..)
                .zip(entries)
                .for_each(|(index, row)| local[row] = index);
            part.reached = reached.iter().map(|&row| separator_index[row]).collect();
            this.lay_out(members, factor, &local, &mut part.panels, &mut value_count);
            this.parts.push(part);
        }
        let mut panels = Vec::new();
        this.lay_out(
            &division.separator,
            factor,
            &separator_index,
            &mut panels,
            &mut value_count,
        );
        this.separator.panels = panels;
        let mut start = 0;
        for part in this.parts.iter().chain([&this.separator]) {
            for (index, &row) in (start..).zip(&part.own) {
                this.work_indices[row as usize] = index;
            }
            start += part.entry_count() as u32;
        }
        this.work = vec![[0.0; 4]; start as usize];
        this.values = vec![0.0; value_count];
        this.refill(factor);
        this
    }

    /// Appends the panels and row lists of some supernodes, given the entry of each row in their part of `work`.
    fn lay_out(
        &mut self,
        members: &[u32],
        factor: FactorView<'_>,
        local: &[u32],
        panels: &mut Vec<Panel>,
        value_count: &mut usize,
    ) {
        for &index in members {
            let (start, pattern, block) = factor.supernode(index as usize);
            let columns = block.ncols();
            let list = self.rows.len();
            self.rows.extend_from_slice(&local[start..start + columns]);
            let below = pattern.iter().map(|&row| local[row as usize]);
            self.rows.extend(below);
            for column in (0..columns).step_by(WIDEST) {
                let width = WIDEST.min(columns - column);
                let below = list + column + width..self.rows.len();
                panels.push(Panel {
                    first_column: local[start + column],
                    width: width as u32,
                    rows: [below.start as u32, below.end as u32],
                    values: *value_count,
                });
                *value_count += (width + below.len()) * width;
            }
        }
        self.supernodes.extend_from_slice(members);
    }

    /// Copies the numbers of a later factorisation of a matrix with the same pattern, without allocating.
    ///
    /// # Panics
    /// If the pattern is not the one that this was made from.
    pub fn refill(&mut self, factor: FactorView<'_>) {
        assert_eq!(
            self.work_indices.len(),
            factor.order().len(),
            "rows of the factor"
        );
        let mut values = self.values.iter_mut();
        let mut push = |value: Real| *values.next().expect("the same pattern") = value;
        for &index in &self.supernodes {
            let (_, _, block) = factor.supernode(index as usize);
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

    /// Solves `A x = b` for x, y and z alike.
    ///
    /// # Panics
    /// If `b` or `x` has not one entry per row.
    pub fn solve(&mut self, b: &[Vec3], x: &mut [Vec3]) {
        assert!(
            b.len() == self.work_indices.len() && x.len() == b.len(),
            "one entry per row"
        );
        let (rows, values) = (&self.rows[..], &self.values[..]);
        let (parts, separator) = (&self.parts[..], &self.separator);
        let own_count: usize = parts.iter().map(Part::entry_count).sum();
        let (work, separator_work) = self.work.split_at_mut(own_count);
        parts::for_each(parts, work, &|part, work| {
            part.load(b, work);
            part.forward(rows, values, work);
        });
        separator.load(b, separator_work);
        let mut rest = &work[..];
        for part in parts {
            let (own, others) = rest.split_at(part.entry_count());
            for (&row, spilt) in part.reached.iter().zip(&own[part.own.len()..]) {
                let entry = &mut separator_work[row as usize];
                *entry = std::array::from_fn(|lane| entry[lane] + spilt[lane]);
            }
            rest = others;
        }
        separator.forward(rows, values, separator_work);
        separator.backward(rows, values, separator_work);
        let separator_work = &separator_work[..];
        parts::for_each(parts, work, &|part, work| {
            for (&row, entry) in part.reached.iter().zip(&mut work[part.own.len()..]) {
                *entry = separator_work[row as usize];
            }
            part.backward(rows, values, work);
        });
        for (x, &index) in x.iter_mut().zip(&self.work_indices) {
            let [a, b, c, _] = self.work[index as usize];
            *x = Vec3::new(a, b, c);
        }
    }
}

/// The columns of some supernodes, in their order.
fn columns<'a>(members: &'a [u32], factor: FactorView<'a>) -> impl Iterator<Item = usize> + 'a {
    members.iter().flat_map(move |&index| {
        let (start, _, block) = factor.supernode(index as usize);
        start..start + block.ncols()
    })
}

impl Part {
    /// Some supernodes, without panels yet.
    fn of(members: &[u32], factor: FactorView<'_>) -> Self {
        let order = factor.order();
        Self {
            panels: Vec::new(),
            own: columns(members, factor)
                .map(|column| order[column])
                .collect(),
            reached: Vec::new(),
        }
    }

    /// Entries of its stretch.
    fn entry_count(&self) -> usize {
        self.own.len() + self.reached.len()
    }

    /// Takes its entries of `b`; the others begin at zero.
    fn load(&self, b: &[Vec3], work: &mut [Lanes]) {
        let (own, reached) = work.split_at_mut(self.own.len());
        for (entry, &row) in own.iter_mut().zip(&self.own) {
            let b = &b[row as usize];
            *entry = [b.x, b.y, b.z, 0.0];
        }
        reached.fill([0.0; 4]);
    }

    fn forward(&self, rows: &[u32], values: &[Real], work: &mut [Lanes]) {
        wide(
            #[inline(always)]
            || {
                for panel in &self.panels {
                    match panel.width {
                        1 => panel.forward::<1>(rows, values, work),
                        2 => panel.forward::<2>(rows, values, work),
                        3 => panel.forward::<3>(rows, values, work),
                        _ => panel.forward::<4>(rows, values, work),
                    }
                }
            },
        );
    }

    fn backward(&self, rows: &[u32], values: &[Real], work: &mut [Lanes]) {
        wide(
            #[inline(always)]
            || {
                for panel in self.panels.iter().rev() {
                    match panel.width {
                        1 => panel.backward::<1>(rows, values, work),
                        2 => panel.backward::<2>(rows, values, work),
                        3 => panel.backward::<3>(rows, values, work),
                        _ => panel.backward::<4>(rows, values, work),
                    }
                }
            },
        );
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
            let mut entry = work[row as usize];
            for j in 0..W {
                entry = minus(entry, l[j], y[j]);
            }
            work[row as usize] = entry;
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
    use cloth_core::method::linear::{Cholesky, UpperPattern};

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
        for n in [0, 1, 2, 3, 5, 17, 40, 100] {
            let mut cholesky = grid_matrix(n, 0.3);
            let b = right_hand_side(n * n);
            let mut x = vec![Vec3::zeros(); n * n];
            PanelFactor::new(cholesky.factor()).solve(&b, &mut x);
            let error = relative_difference(&x, &reference(&mut cholesky, &b));
            assert!(error < 1e-13, "{n} a side: {error:e}");
        }
    }

    #[test]
    fn refilled_panels_are_those_of_a_new_copy() {
        let b = right_hand_side(81);
        let mut panels = PanelFactor::new(grid_matrix(9, 0.3).factor());
        let other = grid_matrix(9, 4.0);
        panels.refill(other.factor());
        let (mut x, mut expected) = (b.clone(), b.clone());
        panels.solve(&b, &mut x);
        PanelFactor::new(other.factor()).solve(&b, &mut expected);
        assert_eq!(x, expected);
    }

    #[test]
    #[cfg(feature = "parallel")]
    fn large_factors_are_divided_and_threads_do_not_change_a_bit() {
        let mut panels = PanelFactor::new(grid_matrix(100, 0.3).factor());
        let sizes: Vec<usize> = panels.parts.iter().map(|part| part.panels.len()).collect();
        assert!(
            sizes.len() >= 8 && panels.separator.own.len() < 1000,
            "{sizes:?}"
        );
        let b = right_hand_side(10_000);
        let mut solve = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let mut x = b.clone();
            pool.unwrap().install(|| panels.solve(&b, &mut x));
            x
        };
        let alone = solve(1);
        assert_eq!(solve(2), alone);
        assert_eq!(solve(5), alone);
    }
}
