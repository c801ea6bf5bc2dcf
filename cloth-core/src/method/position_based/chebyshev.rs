//! Chebyshev acceleration of a sequence of sweeps.
//!
//! H. Wang, "A Chebyshev semi-iterative approach for accelerating projective and position-based dynamics", ACM
//! Trans. Graph. 34(6), 2015, <https://doi.org/10.1145/2816795.2818063>; the theory: G. H. Golub, R. S. Varga,
//! Numer. Math. 3, 1961, <https://doi.org/10.1007/BF01386013>; the estimate of the radius: L. A. Hageman, D. M.
//! Young, "Applied iterative methods", 1981.

use crate::math::{Real, Vec3};

/// Extrapolates the sweeps of a substep: `x⁺ = ω (S(x) − x⁻) + x⁻`, where `S(x)` is what a sweep makes of x,
/// and x⁻ the iterate before x.
///
/// With ρ the spectral radius of the sweep, `ω = 1` for the first sweeps, then `2/(2 − ρ²)`, then `4/(4 − ρ²ω)`
/// again and again. If the error goes through a linear S with real eigenvalues in [−ρ, ρ], k such sweeps leave
/// `1/T_k(1/ρ)` of it (T_k the Chebyshev polynomial), which is `ρ/(1 + √(1 − ρ²))` per sweep in the end instead
/// of ρ: with Jacobi in the straight chain of N rigid links `cos(π/2N)/(1 + sin(π/2N))`.
///
/// What it does to the multiplier of a row is the method's [`ConstraintUpdate`](super::ConstraintUpdate):
/// XPBD's λ is a part of the iterate, and extrapolated with x, so that `M(x − x̃) = Σ ∂Cᵀλ` stays as true as
/// the sweeps make it.
///
/// Jacobi sweeps have real eigenvalues, and so has symmetric Gauss–Seidel (both are symmetric in the metric of
/// M). One-way Gauss–Seidel has not: extrapolated, the error of a chain of 30 links swept from its end grows by
/// 10¹¹ before it falls, and that of a sheet swept colour by colour grows without end. That is why accelerated
/// Gauss–Seidel sweeps are symmetric, forward and backward, at twice the work.
///
/// Limits: sweeps over a cloth are not linear, so nothing is proved there. Therefore the size of the
/// corrections, `‖S(x) − x‖` in the metric of M, is watched. Where it exceeds the largest of the plain sweeps,
/// or a hundred times its smallest value so far in the substep, the extrapolation is thrown away, and the rest
/// of the substep goes on with plain sweeps
/// ([`Families::chebyshev_fallbacks`](super::Families::chebyshev_fallbacks) tells).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chebyshev {
    /// The spectral radius ρ of the sweep.
    pub radius: Radius,
    /// Plain sweeps at the start of each substep, at least 1 (2 where the radius is estimated): the first
    /// sweeps are the least linear ones.
    pub delay: u32,
}

/// Where ρ comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Radius {
    /// From the user: at least 0, below 1. Too large is better than too small.
    Given(Real),
    /// From the sweeps of the same substep: at first by how much the correction of the last plain sweep is
    /// smaller than that of the one before. That is too small. After 8, 16, 32, … further sweeps, the ρ' that
    /// explains the corrections since, `T_m(ρ'/ρ)/T_m(1/ρ) = ‖Δx_m‖/‖Δx₀‖`, replaces ρ if it is larger, and the
    /// extrapolation starts anew.
    Estimated,
}

/// ρ is estimated no larger than this.
const LARGEST_RADIUS: Real = 1.0 - 1e-7;

/// Squared growth of the corrections over their smallest at which extrapolation is disabled. They do not fall
/// monotonically.
const REBOUND: Real = 100.0 * 100.0;

/// Squared size of the corrections, relative to the largest of the plain sweeps, below which their growth is
/// rounding.
const ROUNDING: Real = 1e-20;

/// Fewer vertices than this stay on one thread.
#[cfg(feature = "parallel")]
const SMALLEST_PARALLEL_SET: usize = 8192;

/// Vertices per partial sum; independent of the threads, and so are the sums.
const CHUNK: usize = 2048;

/// The recurrence and the iterates that it needs.
#[derive(Clone, Debug)]
pub(super) struct Recurrence {
    settings: Chebyshev,
    /// x⁻ and x (m).
    before: Vec<Vec3>,
    now: Vec<Vec3>,
    partial_sums: Vec<Real>,
    /// Sweeps since the recurrence last started, and ω, ρ.
    sweep: u32,
    plain: u32,
    omega: Real,
    radius: Real,
    /// Squared sizes of corrections: when the recurrence last started, of the last sweep, the smallest of the
    /// substep, the largest of plain sweeps.
    at_start: Real,
    last: Real,
    smallest: Real,
    largest: Real,
    /// Sweeps after which ρ is estimated again.
    cycle: u32,
    disabled: bool,
}

impl Recurrence {
    pub(super) fn new(settings: Chebyshev, vertex_count: usize) -> Self {
        Self {
            settings,
            before: vec![Vec3::zeros(); vertex_count],
            now: vec![Vec3::zeros(); vertex_count],
            partial_sums: vec![0.0; vertex_count.div_ceil(CHUNK)],
            sweep: 0,
            plain: settings.delay,
            omega: 1.0,
            radius: 0.0,
            at_start: 0.0,
            last: 0.0,
            smallest: Real::INFINITY,
            largest: 0.0,
            cycle: 8,
            disabled: false,
        }
    }

    /// At the start of a substep.
    pub(super) fn restart(&mut self) {
        self.sweep = 0;
        self.plain = self.settings.delay;
        self.radius = match self.settings.radius {
            Radius::Given(radius) => radius,
            Radius::Estimated => 0.0,
        };
        self.smallest = Real::INFINITY;
        self.largest = 0.0;
        self.cycle = 8;
        self.disabled = false;
    }

    pub(super) fn is_disabled(&self) -> bool {
        self.disabled
    }

    /// Keeps the iterate from which the next sweep starts.
    pub(super) fn store_iterate(&mut self, x: &[Vec3]) {
        std::mem::swap(&mut self.before, &mut self.now);
        self.now.copy_from_slice(x);
    }

    /// Extrapolates what the sweep made, `x`. Gives ω where it is not 1, for the memory of the rows.
    pub(super) fn extrapolate(&mut self, inverse_mass: &[Real], x: &mut [Vec3]) -> Option<Real> {
        if self.disabled {
            return None;
        }
        let size = self.correction(inverse_mass, x);
        if self.sweep < self.plain {
            self.largest = self.largest.max(size);
        }
        // Written so that NaN counts as growth.
        let calm = size <= self.largest && size <= REBOUND * self.smallest;
        if !(calm || size <= ROUNDING * self.largest) {
            self.disabled = true;
            return None;
        }
        self.smallest = self.smallest.min(size);
        if self.settings.radius == Radius::Estimated {
            self.estimate(size);
        }
        self.last = size;
        self.sweep += 1;
        self.omega = match self.sweep.saturating_sub(self.plain) {
            0 => {
                self.at_start = size;
                return None;
            }
            1 => 2.0 / (2.0 - self.radius * self.radius),
            _ => 4.0 / (4.0 - self.radius * self.radius * self.omega),
        };
        if self.omega == 1.0 {
            return None;
        }
        self.blend(self.omega, x);
        Some(self.omega)
    }

    /// A new ρ where the sweeps so far tell one, from the size of the correction that the next sweep would be
    /// number `self.sweep + 1` for.
    fn estimate(&mut self, size: Real) {
        if self.sweep < self.plain {
            if self.sweep + 1 == self.plain {
                if size < self.last {
                    self.radius = (size / self.last).sqrt().min(LARGEST_RADIUS);
                } else {
                    self.plain += 1; // a correction that did not shrink tells nothing of ρ
                }
            }
            return;
        }
        let m = Real::from(self.sweep + 1 - self.plain);
        if self.sweep + 1 - self.plain < self.cycle || self.radius <= 0.0 {
            return;
        }
        // T_m(y) = cosh(m acosh y). What the corrections are larger than 1/T_m(1/ρ) comes from eigenvalues above ρ.
        let growth = (m * (1.0 / self.radius).acosh()).cosh() * (size / self.at_start).sqrt();
        if growth.is_finite() && growth > 1.0 {
            let radius = self.radius * (growth.acosh() / m).cosh();
            self.radius = radius.min(LARGEST_RADIUS);
            // Anew, from where we are: this sweep is the plain one of the new recurrence.
            self.sweep = 0;
            self.plain = 1;
        }
        self.cycle *= 2;
    }

    /// `Σ m ‖S(x) − x‖²` (kg m²) over the vertices that can move.
    fn correction(&mut self, inverse_mass: &[Real], x: &[Vec3]) -> Real {
        let sums = &mut self.partial_sums;
        #[cfg(feature = "parallel")]
        if x.len() >= SMALLEST_PARALLEL_SET && rayon::current_num_threads() > 1 {
            use rayon::prelude::*;
            sums.par_iter_mut()
                .zip(x.par_chunks(CHUNK))
                .zip(self.now.par_chunks(CHUNK))
                .zip(inverse_mass.par_chunks(CHUNK))
                .for_each(|(((sum, x), now), w)| *sum = squared_distance(x, now, w));
            return self.partial_sums.iter().sum();
        }
        sums.iter_mut()
            .zip(x.chunks(CHUNK))
            .zip(self.now.chunks(CHUNK))
            .zip(inverse_mass.chunks(CHUNK))
            .for_each(|(((sum, x), now), w)| *sum = squared_distance(x, now, w));
        self.partial_sums.iter().sum()
    }

    /// `x ← x⁻ + ω (x − x⁻)`.
    fn blend(&self, omega: Real, x: &mut [Vec3]) {
        let blend = |(x, before): (&mut [Vec3], &[Vec3])| {
            for (x, before) in x.iter_mut().zip(before) {
                *x = before + (*x - before) * omega;
            }
        };
        #[cfg(feature = "parallel")]
        if x.len() >= SMALLEST_PARALLEL_SET && rayon::current_num_threads() > 1 {
            use rayon::prelude::*;
            x.par_chunks_mut(CHUNK)
                .zip(self.before.par_chunks(CHUNK))
                .for_each(blend);
            return;
        }
        blend((x, &self.before));
    }
}

/// `Σ m ‖x − y‖²` (kg m²) over the vertices that can move.
fn squared_distance(x: &[Vec3], y: &[Vec3], inverse_mass: &[Real]) -> Real {
    let terms = x.iter().zip(y).zip(inverse_mass);
    terms
        .filter(|&(_, &w)| w > 0.0)
        .map(|((x, y), w)| (x - y).norm_squared() / w)
        .sum()
}
