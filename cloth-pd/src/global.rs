//! The global step: one matrix for x, y and z alike, the same in every iteration, factorised once per step size.
//!
//! A change of a few rows (a vertex grabbed or released, an element removed, an attachment added) is corrected in every
//! solve, by [`WoodburyUpdate`], as long as that is cheaper than factorising again. How long a change will
//! stay is not known (the ski-rental problem): once the corrections have cost as much as a factorisation, the matrix is
//! factorised. That never costs more than twice the better choice, by these estimates and but for the last step: until
//! then the corrections are the better choice; after it F for them and F for the factorisation are paid, where F is the
//! least that either choice costs.
//!
//! *Fill.* On the alternating grid with 128 vertices a side, 16 384 rows:
//!
//! | | lower half of A, numbers a row | factor, numbers | a row | both copies of it |
//! |---|---|---|---|---|
//! | springs | 4 | 0.5 million | 33 | 9 MB |
//! | springs and quadratic hinges | 6 | 1.29 million | 79 | 21 MB |
//!
//! In nested dissection of a mesh of n vertices the numbers grow as n log n, the multiplications of a factorisation as
//! n^(3/2) (A. George, SIAM J. Numer. Anal. 10, 1973, <https://doi.org/10.1137/0710032>). *Why:* some s = √n vertices
//! separate a mesh into halves. Numbered last, they keep the halves apart in the factor, and fill in among themselves:
//! some s²/2 numbers, s³/6 multiplications. A half is cut likewise, and what borders it (separators of earlier cuts, a
//! few times its own √(n/2)) changes the constants only. At depth j there are 2ʲ parts of n/2ʲ vertices, which
//! have 2ʲ (n/2ʲ) = n numbers, but for a constant: log₂ n depths have n log₂ n. Of multiplications they have
//! 2ʲ (n/2ʲ)^(3/2) = n^(3/2)/2^(j/2), whose sum over j is at most n^(3/2)/(1 − 1/√2). By that law 10 000 vertices
//! have 0.3 million numbers, or 0.75 million with hinges.
//!
//! *Factor against solve.* A solve does 12 operations a number (a product and a sum, forward and backward, for x, y and
//! z) on 16 bytes that it reads. A factorisation does a product and a sum for each pair of numbers in a column, on one
//! thread. It is taken for (3 + 0.13 c)/0.85 solves, c the mean of numbers a row: 9 with springs (c = 33) and 16 with
//! hinges (c = 79) at 128 a side. Then a change of rank r above 24, or 45, is factorised at once: r/3 solves and r³ ns
//! would cost more. The three constants are measured ([`cost`]): ns a number and ns a product of a factorisation, ns a
//! number of a solve. The last is that of a large sheet. By the times in `panel.rs` (springs alone, one thread) it is
//! 0.9 at 256 vertices a side, but 0.5 at 128 and 0.4 at 64: there a correction is overrated, and the matrix factorised
//! too early.
//!
//! A factorisation does products in proportion to Σ cⱼ² over the columns j, a solve to Σ cⱼ. The estimate has n c² in
//! the place of the first, with the mean c, which is less (Cauchy–Schwarz): the few long columns of the separators have
//! most products. By the law above a factorisation costs Σ cⱼ²/Σ cⱼ solves, in the limit √n/log n, while the estimate
//! grows as c, so as log n. It underestimates the factorisation of large sheets, which is then made too early as well.
//!
//! *Memory.* The factor is kept twice, as the library makes it and in the order of [`PanelFactor`]: 16 bytes a number.
//! By the law above a sheet of 1024 vertices a side has 47 numbers a row, or 112: 0.8 or 1.9 GB. Its indices are 32
//! bits, so 2³² numbers are the limit where memory is not. Nothing else grows faster than n.

use crate::local::Projections;
use crate::matrix::{SMALLEST_PIVOT, assemble, fill, smallest_pivot, upper_pattern};
use crate::panel::PanelFactor;
use crate::woodbury::WoodburyUpdate;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::linear::{Cholesky, CholeskyError};
use cloth_core::particles::Particles;
use sprs::CsMat;
use std::fmt;

/// `A = M/Δt² + Σ w SᵀS` over the vertices that are not prescribed, and its factor. The row of a prescribed
/// vertex is that of the identity.
pub(crate) struct GlobalSystem {
    /// Lumped mass (kg) of each vertex; none where it is prescribed.
    mass: Vec<Option<Real>>,
    /// Lower half of `Σ w SᵀS` (N/m) over all vertices, row by row, the diagonal last in each.
    stiffness: CsMat<Real>,
    /// Families that are missing in it.
    is_left_out: Vec<bool>,
    cholesky: Cholesky,
    /// The factor in the layout that the iterations read; none before the first step.
    panels: Option<PanelFactor>,
    /// The step size (s) that the factor is for.
    factored_for: Option<Real>,
    /// `mass` when the factor was made.
    factored_mass: Vec<Option<Real>>,
    /// What has been added to the stiffness since.
    terms: Vec<Term>,
    /// Between the factor and what has changed since.
    update: WoodburyUpdate,
    /// Whether something has changed that `update` does not know.
    is_changed: bool,
    /// Work (ns) spent on corrections since the factor was made.
    correction_cost: Real,
}

/// `weight · u uᵀ` (N/m), u given by its entries: a row of an element's operator.
#[derive(Clone, Debug)]
pub(crate) struct Term {
    pub(crate) column: Vec<(u32, Real)>,
    pub(crate) weight: Real,
}

/// Estimates of work (ns), from measurements on one core: per number of the factor, once for a solve with three
/// right-hand sides; per number of the factor and per multiplication for a factorisation; per row and rank for a
/// correction. They decide how a system is solved, not its solution.
mod cost {
    pub(super) const SOLVE: f64 = 0.85;
    pub(super) const FACTOR_ENTRY: f64 = 3.0;
    pub(super) const FACTOR_PRODUCT: f64 = 0.13;
    pub(super) const CORRECT: f64 = 1.2;
}

impl fmt::Debug for GlobalSystem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GlobalSystem")
            .field("rows", &self.mass.len())
            .field("nonzeros", &self.stiffness.nnz())
            .field("factored_for", &self.factored_for)
            .finish()
    }
}

impl GlobalSystem {
    /// Assembles `Σ w SᵀS` and analyses the pattern. `is_left_out` has the families that the matrix goes without.
    pub(crate) fn new(
        particles: &Particles,
        families: &[Box<dyn Projections>],
        is_left_out: Vec<bool>,
    ) -> Result<Self, CholeskyError> {
        let kept = families.iter().zip(&is_left_out);
        let kept = kept.filter_map(|(family, out)| (!out).then_some(family));
        let stiffness = assemble(particles.len(), kept);
        let cholesky = Cholesky::analyze(upper_pattern(&stiffness)?)?;
        let mass = |vertex: usize| {
            let is_free = !particles.is_prescribed(vertex);
            is_free.then(|| particles.mass()[vertex])
        };
        let mass: Vec<Option<Real>> = (0..particles.len()).map(mass).collect();
        Ok(Self {
            factored_mass: mass.clone(),
            mass,
            is_left_out,
            stiffness,
            cholesky,
            panels: None,
            factored_for: None,
            terms: Vec::new(),
            update: WoodburyUpdate::default(),
            is_changed: false,
            correction_cost: 0.0,
        })
    }

    /// Gives a vertex its mass (kg), or prescribes it with `None`.
    pub(crate) fn set_mass(&mut self, vertex: usize, mass: Option<Real>) {
        self.mass[vertex] = mass;
        self.is_changed = true;
    }

    /// Whether no family is left out.
    pub(crate) fn is_whole(&self) -> bool {
        !self.is_left_out.contains(&true)
    }

    /// Whether a family is in the matrix.
    pub(crate) fn includes(&self, family: usize) -> bool {
        !self.is_left_out[family]
    }

    /// Takes an element of a family away, given what it leaves of `Σ w SᵀS`.
    pub(crate) fn remove(&mut self, family: usize, terms: Vec<Term>) {
        if self.includes(family) {
            terms.into_iter().for_each(|term| self.add(term));
        }
    }

    /// Adds a term to `Σ w SᵀS`. Its entries have to be in the pattern: on the diagonal, or of an element that is or
    /// was there.
    pub(crate) fn add(&mut self, term: Term) {
        for &(i, u) in &term.column {
            for &(j, v) in term.column.iter().filter(|(j, _)| *j <= i) {
                let entry = self.stiffness.get_mut(i as usize, j as usize);
                *entry.expect("an entry of the pattern") += term.weight * u * v;
            }
        }
        self.terms.push(term);
        self.is_changed = true;
    }

    /// Makes the factor, or the factor and its correction, that of step size `dt` (s); returns the number of
    /// factorisations that took.
    pub(crate) fn prepare(&mut self, dt: Real) -> Result<u32, CholeskyError> {
        if self.is_empty() {
            return Ok(0);
        }
        if self.factored_for == Some(dt) {
            let limit = self.factorization_cost();
            if !self.is_changed && self.correction_cost <= limit
                || self.is_changed && self.update(dt, limit)
            {
                return Ok(0);
            }
        }
        self.factored_for = None;
        fill(&self.stiffness, &self.mass, dt, self.cholesky.values_mut());
        self.cholesky.factorize()?;
        let factor = self.cholesky.factor();
        if smallest_pivot(factor, &self.stiffness, &self.mass, dt) < SMALLEST_PIVOT {
            return Err(CholeskyError::NotPositiveDefinite);
        }
        match &mut self.panels {
            Some(panels) => panels.refill(factor),
            None => {
                self.panels = Some(PanelFactor::new(factor));
            }
        }
        self.factored_for = Some(dt);
        self.factored_mass.copy_from_slice(&self.mass);
        self.terms.clear();
        self.update.clear();
        (self.is_changed, self.correction_cost) = (false, 0.0);
        Ok(1)
    }

    /// Estimated work (ns) of a factorisation.
    fn factorization_cost(&self) -> Real {
        let entries = self.cholesky.factor_len() as Real;
        // The mean number of rows stands for all columns: too little where a few long ones have most products.
        let rows = entries / self.mass.len() as Real;
        entries * (cost::FACTOR_ENTRY + cost::FACTOR_PRODUCT * rows)
    }

    /// Makes the correction for all that has changed since the factor was made. Returns `false` where factorising is
    /// better.
    fn update(&mut self, dt: Real, limit: Real) -> bool {
        let changed = |vertex: &usize| self.factored_mass[*vertex] != self.mass[*vertex];
        let changed: Vec<usize> = (0..self.mass.len()).filter(changed).collect();
        let released = |vertex: &usize| self.factored_mass[*vertex].is_none();
        let rank =
            changed.len() + changed.iter().filter(|v| released(v)).count() + self.terms.len();
        let rank = rank as Real;
        let solve = cost::SOLVE * self.cholesky.factor_len() as Real;
        let setup = (rank / 3.0).ceil() * solve + rank * rank * rank;
        if self.correction_cost + setup > limit {
            return false;
        }
        self.update.clear();
        // Elements, over the vertices that the factor knows as free.
        for term in &self.terms {
            let known = |entry: &&(u32, Real)| self.factored_mass[entry.0 as usize].is_some();
            let column = self.update.push(term.column.iter().filter(known).copied());
            self.update.set_inverse(column, column, 1.0 / term.weight);
        }
        // A released vertex has the row of the identity in the factor, and needs its own: its diagonal entry
        // a = Σ w SᵀS + m/Δt² and, beside that, r. That is U C Uᵀ with U = [e, r] and C = [[a − 1, 1], [1, 0]], whose
        // inverse is [[0, 1], [1, 1 − a]].
        let mut is_known: Vec<bool> = self.factored_mass.iter().map(Option::is_some).collect();
        for &vertex in changed.iter().filter(|v| released(v)) {
            let Some(mass) = self.mass[vertex] else {
                continue;
            };
            let mut row = self.row(vertex);
            row.retain(|entry| is_known[entry.0 as usize]);
            let diagonal = self.stiffness.get(vertex, vertex).copied().unwrap_or(0.0);
            let own = self.update.push([(vertex as u32, 1.0)]);
            let row = self.update.push(row);
            self.update.set_inverse(own, row, 1.0);
            self.update
                .set_inverse(row, row, 1.0 - (diagonal + mass / dt / dt));
            is_known[vertex] = true;
        }
        // A grabbed vertex ends where its pin says, so its increment d is 0: a constraint.
        for &vertex in changed.iter().filter(|&&v| self.mass[v].is_none()) {
            self.update.push([(vertex as u32, 1.0)]);
        }
        let Some(panels) = &mut self.panels else {
            return false;
        };
        let dimension = self.mass.len();
        let is_prepared = self.update.prepare(dimension, |b, x| panels.solve(b, x));
        self.is_changed = !is_prepared;
        self.correction_cost += setup;
        is_prepared
    }

    /// The entries of a row of `Σ w SᵀS` beside the diagonal.
    fn row(&self, vertex: usize) -> Vec<(u32, Real)> {
        let mut row = Vec::new();
        for (&value, (i, j)) in &self.stiffness {
            if i != j && (i == vertex || j == vertex) {
                row.push((if i == vertex { j } else { i } as u32, value));
            }
        }
        row
    }

    /// Lower half of `Σ w SᵀS` (N/m) over all vertices.
    pub(crate) fn stiffness(&self) -> &CsMat<Real> {
        &self.stiffness
    }

    /// Whether no vertex can move.
    pub(crate) fn is_empty(&self) -> bool {
        self.mass.iter().all(Option::is_none)
    }

    /// Solves `A d = b` (N to m). `b` has to be zero at prescribed vertices; so is `d`.
    ///
    /// # Panics
    /// If nothing has been prepared.
    pub(crate) fn solve(&mut self, b: &[Vec3], d: &mut [Vec3]) {
        let panels = self.panels.as_mut().expect("prepared");
        panels.solve(b, d);
        let rank = self.update.rank();
        if rank > 0 {
            self.update.correct(d);
            self.correction_cost += cost::CORRECT * (rank * d.len()) as Real;
            for (d, mass) in d.iter_mut().zip(&self.mass) {
                if mass.is_none() {
                    *d = Vec3::zeros(); // but for rounding it is
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local::Family;
    use cloth_core::element::{Element, Projective};
    use cloth_core::energy::{Attachment, Spring};

    /// Two rows on three vertices, as an energy of a triangle would have.
    #[derive(Clone, Copy, Debug)]
    struct Corner([u32; 3], [[Real; 3]; 2]);

    impl Element<3> for Corner {
        fn vertices(&self) -> [u32; 3] {
            self.0
        }
    }

    impl Projective<3, 2> for Corner {
        fn operator(&self) -> [[Real; 3]; 2] {
            self.1
        }
        fn weight(&self) -> Real {
            2.5
        }
        fn project(&self, z: [Vec3; 2]) -> [Vec3; 2] {
            z
        }
    }

    type Families = Vec<Box<dyn Projections>>;

    fn family<const N: usize, const K: usize, E: Projective<N, K>>(
        elements: &[E],
        particles: &Particles,
    ) -> Box<dyn Projections> {
        Box::new(Family::new(elements.to_vec(), particles).unwrap())
    }

    /// `w SᵀS` of all elements, entry by entry.
    fn add_dense<const N: usize, const K: usize, E: Projective<N, K>>(
        elements: &[E],
        dense: &mut [[Real; 6]; 6],
    ) {
        for element in elements {
            let mut rows = [[0.0; 6]; K];
            for (row, coefficients) in rows.iter_mut().zip(element.operator()) {
                for (vertex, g) in element.vertices().into_iter().zip(coefficients) {
                    row[vertex as usize] = g;
                }
            }
            for (i, j) in (0..36).map(|at| (at / 6, at % 6)) {
                let product: Real = rows.iter().map(|row| row[i] * row[j]).sum();
                dense[i][j] += element.weight() * product;
            }
        }
    }

    #[test]
    fn the_matrix_is_m_over_dt_squared_plus_w_st_s_over_free_vertices() {
        let mut particles = Particles::new(vec![0.1, 0.2, 0.3, 0.4, 0.5, 0.6]).unwrap();
        particles.prescribe(2).unwrap();
        let spring = |vertices, stiffness| Spring {
            vertices,
            rest_length: 1.0,
            stiffness,
        };
        let springs = [
            spring([1, 0], 3.0),
            spring([0, 1], 4.0),
            spring([2, 5], 5.0),
            spring([5, 3], 0.7),
        ];
        let corners = [
            Corner([4, 2, 0], [[1.0, -3.0, 2.0], [0.5, 0.25, -0.75]]),
            Corner([3, 4, 1], [[0.0, 1.0, -1.0], [2.0, -1.0, -1.0]]),
        ];
        let attachments = [Attachment {
            vertex: 3,
            target: Vec3::zeros(),
            stiffness: 9.0,
        }];
        let families: Families = vec![
            family(&springs, &particles),
            family(&corners, &particles),
            family(&attachments, &particles),
        ];
        let mut dense = [[0.0; 6]; 6];
        add_dense(&springs, &mut dense);
        add_dense(&corners, &mut dense);
        add_dense(&attachments, &mut dense);

        let mut global = GlobalSystem::new(&particles, &families, vec![false; 3]).unwrap();
        for dt in [0.1, 0.3] {
            assert_eq!(global.prepare(dt), Ok(1));
            let mut matrix = dense;
            for (i, mass) in particles.mass().iter().enumerate() {
                matrix[i][i] += mass / (dt * dt);
            }
            for i in 0..6 {
                (matrix[i][2], matrix[2][i]) = (0.0, 0.0);
            }
            matrix[2][2] = 1.0;
            let mut values = global.cholesky.values_mut().iter();
            for (_, (row, column)) in &global.stiffness {
                let error = values.next().unwrap() - matrix[row][column];
                assert!(error.abs() < 1e-13, "{row} {column}: {error:e}");
            }
            // What is stored is all there is: A x = b at the x that the solve gives.
            let mut b: Vec<Vec3> = (0..6).map(|v| Vec3::new(1.0, v as Real, -0.5)).collect();
            b[2] = Vec3::zeros();
            let mut x = vec![Vec3::zeros(); 6];
            global.solve(&b, &mut x);
            assert_eq!(x[2], Vec3::zeros());
            for i in [0, 1, 3, 4, 5] {
                let product: Vec3 = (0..6).map(|j| x[j] * matrix[i][j]).sum();
                assert!((product - b[i]).norm() < 1e-13, "{i}");
            }
        }
    }
}
