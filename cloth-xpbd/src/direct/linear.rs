//! The linear solve of an iteration by any of the four backends, with regularisation and refinement for
//! dependent rows.

use super::config::{DirectConfig, System};
use super::kkt::{Kkt, KktVector};
use super::saddle::{SaddleFactor, SaddleMinres};
use super::schur::{SchurCg, SchurFactor};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::linear::CholeskyError;

#[derive(Debug)]
enum Backend {
    Saddle(SaddleFactor),
    Minres(SaddleMinres),
    Schur(SchurFactor),
    SchurCg(SchurCg),
}

/// A solver of [`Kkt`] systems.
#[derive(Debug)]
pub(super) struct Solver {
    backend: Backend,
    krylov: (Real, u32),
    /// Number of the shift added to every α̂ in the matrix that is factorised.
    shift: usize,
    correction: KktVector,
    residual: KktVector,
    /// Since the start of the step.
    pub(super) factorizations: u32,
    pub(super) solves: u32,
    /// Of a Krylov method; one in each solve with a factor.
    pub(super) iterations: u32,
}

/// Shifts, tried in turn until the matrix can be factorised. Redundant hard rows make the unshifted one singular.
const SHIFTS: [Real; 4] = [1e-10, 1e-8, 1e-6, 1e-4];
/// Most steps of iterative refinement with one factor.
const MAX_CORRECTIONS: u32 = 4;
/// Refinement goes on while a step leaves less than this fraction of the residual before.
const MIN_REDUCTION: Real = 0.3;
/// A larger fraction of the right-hand side left after refinement means contradictory rows.
const CONTRADICTION: Real = 1e-6;
/// Relative residual at the level of rounding.
const ROUNDING: Real = 1e-15;

impl Solver {
    pub(super) fn new(kkt: &Kkt, config: &DirectConfig) -> Result<Self, CholeskyError> {
        let backend = match config.system {
            System::SaddleLdlt => Backend::Saddle(SaddleFactor::analyze(kkt)?),
            System::SaddleMinres => Backend::Minres(SaddleMinres::new(kkt)),
            System::SchurCholesky => Backend::Schur(SchurFactor::analyze(kkt)?),
            System::SchurConjugateGradients => Backend::SchurCg(SchurCg::new(kkt)),
        };
        let pair = || KktVector::zeros(kkt.vertex_scale.len(), kkt.row_count());
        Ok(Self {
            backend,
            krylov: (config.krylov_tolerance, config.max_krylov),
            shift: 0,
            correction: pair(),
            residual: pair(),
            factorizations: 0,
            solves: 0,
            iterations: 0,
        })
    }

    /// Numbers stored in the factor; 0 for a Krylov method.
    pub(super) fn factor_len(&self) -> usize {
        match &self.backend {
            Backend::Saddle(factor) => factor.factor_len(),
            Backend::Schur(factor) => factor.factor_len(),
            Backend::Minres(_) | Backend::SchurCg(_) => 0,
        }
    }

    /// The shift of the present factor; 0 for a Krylov method.
    pub(super) fn shift(&self) -> Real {
        match &self.backend {
            Backend::Saddle(_) | Backend::Schur(_) if self.factorizations > 0 => SHIFTS[self.shift],
            _ => 0.0,
        }
    }

    /// Takes the present numbers and factorises.
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
                Backend::Minres(_) | Backend::SchurCg(_) => return Ok(()),
            };
            self.shift = index;
            self.factorizations += 1;
            if last.is_ok() {
                break;
            }
        }
        last
    }

    /// Solves `A out = right`. With a factor, iterative refinement removes the shift: each step multiplies the
    /// error along an eigenvector of S (σ its eigenvalue) by `shift/(σ + shift)`. Along null vectors, σ = 0, nothing is
    /// removed: there rows contradict one another to first order. Returns whether any do; the answer then holds
    /// their contradiction divided by the shift, which [`Solver::undetermined`] computes.
    pub(super) fn solve(&mut self, kkt: &Kkt, right: &KktVector, out: &mut KktVector) -> bool {
        let (tolerance, most) = self.krylov;
        let end = match &mut self.backend {
            Backend::Minres(minres) => minres.solve(kkt, right, out, tolerance, most),
            Backend::SchurCg(cg) => cg.solve(kkt, right, out, tolerance, most),
            Backend::Saddle(_) | Backend::Schur(_) => {
                return self.solve_with_factor(kkt, right, out);
            }
        };
        self.solves += 1;
        self.iterations += end.iterations;
        false
    }

    /// Writes to `out.l` the part of the multipliers `l` that no equation determines: `shift (S + shift)⁻¹ l`, the
    /// projection on the null space of S where its other eigenvalues are large against the shift.
    pub(super) fn undetermined(&mut self, kkt: &Kkt, l: &[Real], out: &mut KktVector) {
        let shift = self.shift();
        self.residual.x.fill(Vec3::zeros());
        for (residual, l) in self.residual.l.iter_mut().zip(l) {
            *residual = shift * l;
        }
        self.solves += 1;
        self.iterations += 1;
        self.backend.solve_once(kkt, &self.residual, out);
    }

    /// Solve and refinement; whether they left more than a small fraction of the right-hand side.
    fn solve_with_factor(&mut self, kkt: &Kkt, right: &KktVector, out: &mut KktVector) -> bool {
        let Self {
            backend,
            residual,
            correction,
            ..
        } = self;
        let mut solves = 1;
        backend.solve_once(kkt, right, out);
        let whole = right.norm();
        let mut before = whole;
        for _ in 0..=MAX_CORRECTIONS {
            kkt.residual(right, out, residual);
            let left = residual.norm();
            if left >= MIN_REDUCTION * before || left <= ROUNDING * whole || left.is_nan() {
                before = left;
                break;
            }
            before = left;
            solves += 1;
            backend.solve_once(kkt, residual, correction);
            out.add(correction);
        }
        self.solves += solves;
        self.iterations += solves;
        before > CONTRADICTION * whole
    }
}

impl Backend {
    /// One solve with the factor; nothing for a Krylov method.
    fn solve_once(&mut self, kkt: &Kkt, right: &KktVector, out: &mut KktVector) {
        match self {
            Self::Saddle(factor) => factor.solve(right, out),
            Self::Schur(factor) => factor.solve(kkt, right, out),
            Self::Minres(_) | Self::SchurCg(_) => {}
        }
    }
}
