//! The linear solve of an iteration, by any of the four ways, and what is done where rows depend on one another.

use super::config::{DirectConfig, System};
use super::kkt::{Kkt, Pair};
use super::saddle::{SaddleFactor, SaddleMinres};
use super::schur::{SchurFactor, SchurGradients};
use cloth_core::linear::CholeskyError;
use cloth_core::math::{Real, Vec3};

#[derive(Debug)]
enum Backend {
    Saddle(SaddleFactor),
    Minres(SaddleMinres),
    Schur(SchurFactor),
    Gradients(SchurGradients),
}

/// A solver of [`Kkt`] systems.
#[derive(Debug)]
pub(super) struct Solver {
    backend: Backend,
    krylov: (Real, u32),
    /// Number of the shift added to every α̂ in the matrix that is factorised.
    shift: usize,
    correction: Pair,
    residual: Pair,
    /// Since the start of the step.
    pub(super) factorizations: u32,
    /// Solves with a factor, or products of a Krylov method.
    pub(super) solves: u32,
}

/// Shifts, tried in turn until the matrix can be factorised. Rows that say the same, all of them hard, make the unshifted one singular.
const SHIFTS: [Real; 4] = [1e-10, 1e-8, 1e-6, 1e-4];
/// Most corrections with one factor.
const CORRECTIONS: u32 = 4;
/// A correction goes on while it leaves less than this part of the residual before.
const USEFUL: Real = 0.3;
/// More than this part of the right-hand side left after all corrections is a contradiction.
const CONTRADICTION: Real = 1e-6;
/// Relative residual at which rounding rules.
const ROUNDING: Real = 1e-15;

impl Solver {
    pub(super) fn new(kkt: &Kkt, config: &DirectConfig) -> Result<Self, CholeskyError> {
        let backend = match config.system {
            System::SaddleLdlt => Backend::Saddle(SaddleFactor::analyze(kkt)?),
            System::SaddleMinres => Backend::Minres(SaddleMinres::new(kkt)),
            System::SchurCholesky => Backend::Schur(SchurFactor::analyze(kkt)?),
            System::SchurConjugateGradients => Backend::Gradients(SchurGradients::new(kkt)),
        };
        let pair = || Pair::zeros(kkt.vertex_scale.len(), kkt.row_count());
        Ok(Self {
            backend,
            krylov: (config.krylov_tolerance, config.max_krylov),
            shift: 0,
            correction: pair(),
            residual: pair(),
            factorizations: 0,
            solves: 0,
        })
    }

    /// Numbers stored in the factor; 0 for a Krylov method.
    pub(super) fn factor_len(&self) -> usize {
        match &self.backend {
            Backend::Saddle(factor) => factor.factor_len(),
            Backend::Schur(factor) => factor.factor_len(),
            Backend::Minres(_) | Backend::Gradients(_) => 0,
        }
    }

    /// The shift of the present factor; 0 for a Krylov method.
    pub(super) fn shift(&self) -> Real {
        match &self.backend {
            Backend::Saddle(_) | Backend::Schur(_) if self.factorizations > 0 => SHIFTS[self.shift],
            _ => 0.0,
        }
    }

    /// Takes in the present numbers.
    pub(super) fn prepare(&mut self, kkt: &Kkt) -> Result<(), CholeskyError> {
        self.factorize_from(0, kkt)
    }

    /// Factorises with the first shift, from number `first` on, that lets it.
    fn factorize_from(&mut self, first: usize, kkt: &Kkt) -> Result<(), CholeskyError> {
        let mut last = Ok(());
        for (index, &shift) in SHIFTS.iter().enumerate().skip(first) {
            last = match &mut self.backend {
                Backend::Saddle(factor) => factor.factorize(kkt, shift),
                Backend::Schur(factor) => factor.factorize(kkt, shift),
                Backend::Minres(_) | Backend::Gradients(_) => return Ok(()),
            };
            self.shift = index;
            self.factorizations += 1;
            if last.is_ok() {
                break;
            }
        }
        last
    }

    /// Solves `A out = right`. With a factor the shift is taken out again by corrections: each multiplies the error of a combination of rows of stiffness σ (between 0 and 1) by
    /// `shift/(σ + shift)`. What is left after them no multiplier can do: rows that contradict one another to first order. Whether there are any is returned; the
    /// answer then holds their contradiction divided by the shift, and [`Solver::undetermined`] finds it.
    pub(super) fn solve(&mut self, kkt: &Kkt, right: &Pair, out: &mut Pair) -> bool {
        let (tolerance, most) = self.krylov;
        let end = match &mut self.backend {
            Backend::Minres(minres) => minres.solve(kkt, right, out, tolerance, most),
            Backend::Gradients(gradients) => gradients.solve(kkt, right, out, tolerance, most),
            Backend::Saddle(_) | Backend::Schur(_) => {
                return self.solve_with_factor(kkt, right, out);
            }
        };
        self.solves += end.iterations;
        false
    }

    /// Writes to `out.l` the part of the multipliers `l` that no equation determines: `shift (S + shift)⁻¹ l` is the projection on the null space of S, if
    /// everything else in S is large against the shift.
    pub(super) fn undetermined(&mut self, kkt: &Kkt, l: &[Real], out: &mut Pair) {
        let shift = self.shift();
        self.residual.x.fill(Vec3::zeros());
        for (residual, l) in self.residual.l.iter_mut().zip(l) {
            *residual = shift * l;
        }
        self.solves += 1;
        self.backend.solve_once(kkt, &self.residual, out);
    }

    /// Whether the corrections left more than a small part of the right-hand side.
    fn solve_with_factor(&mut self, kkt: &Kkt, right: &Pair, out: &mut Pair) -> bool {
        let Self {
            backend,
            residual,
            correction,
            solves,
            ..
        } = self;
        *solves += 1;
        backend.solve_once(kkt, right, out);
        let whole = right.norm();
        let mut before = whole;
        for _ in 0..=CORRECTIONS {
            kkt.residual(right, out, residual);
            let left = residual.norm();
            if left >= USEFUL * before || left <= ROUNDING * whole || left.is_nan() {
                before = left;
                break;
            }
            before = left;
            *solves += 1;
            backend.solve_once(kkt, residual, correction);
            out.add(correction);
        }
        before > CONTRADICTION * whole
    }
}

impl Backend {
    /// One solve with the factor; nothing for a Krylov method.
    fn solve_once(&mut self, kkt: &Kkt, right: &Pair, out: &mut Pair) {
        match self {
            Self::Saddle(factor) => factor.solve(right, out),
            Self::Schur(factor) => factor.solve(kkt, right, out),
            Self::Minres(_) | Self::Gradients(_) => {}
        }
    }
}
