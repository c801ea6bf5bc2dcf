//! From a description to a solver.

use super::Implicit;
use super::at_end::EndContactMemory;
use super::damper::Damper;
use super::energy_guard::EnergyGuard;
use super::minimizer::Minimizer;
use crate::config::ImplicitConfig;
use cloth_core::cloth::Elements;
use cloth_core::element::Energy;
use cloth_core::math::Vec3;
use cloth_core::method::family::Energies;
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;

/// Description of an [`ImplicitEuler`](crate::ImplicitEuler), an [`ImplicitMidpoint`](crate::ImplicitMidpoint) or a
/// [`Bdf2`](crate::Bdf2).
#[derive(Debug)]
pub struct ImplicitBuilder<S> {
    particles: Particles,
    energies: Result<Energies, BuildError>,
    config: ImplicitConfig,
    finish: fn(Implicit) -> S,
}

impl<S> ImplicitBuilder<S> {
    pub(super) fn new(particles: &Particles, finish: fn(Implicit) -> S) -> Self {
        Self {
            energies: Ok(Energies::new(particles.len())),
            particles: particles.clone(),
            config: ImplicitConfig::default(),
            finish,
        }
    }

    /// Adds elements of one kind.
    ///
    /// An element of your own with three vertices: a cord of length L that slides through an eyelet at the middle one.
    /// `C = ‖x₀ − x₁‖ + ‖x₂ − x₁‖ − L`, and with the unit vectors m, n from the eyelet to the ends
    ///
    /// ```text
    /// E = ½ k C²,   ∂E = k C g with g = (m, −m − n, n),   ∂²E = k g gᵀ + k C ∂²C
    /// ∂²C = [P, −P, 0; −P, P + Q, −Q; 0, −Q, Q],   P = (I − m mᵀ)/‖x₀ − x₁‖,   Q = (I − n nᵀ)/‖x₂ − x₁‖
    /// ```
    ///
    /// P and Q are positive semi-definite, and so is ∂²C: the sign of k C is that of all eigenvalues of `k C ∂²C`, and
    /// what a [`Convexity`](cloth_core::element::Convexity) does to them it does to k C. `g gᵀ` is semi-definite as it
    /// is. Where no such form is at hand, the eigenvalues of the `3N × 3N` matrix are to be found.
    ///
    /// ```
    /// use cloth_massspring::Vec3;
    /// use cloth_massspring::cloth_core::check::{gradient_error, hessian_error, smallest_eigenvalue};
    /// use cloth_massspring::cloth_core::element::{Convexity, Element, Energy};
    /// use cloth_massspring::cloth_core::math::{Blocks, Mat3};
    ///
    /// #[derive(Clone, Copy, Debug)]
    /// struct Cord { vertices: [u32; 3], length: f64, stiffness: f64 }    // m, N/m
    ///
    /// /// Length (m) and unit vector from the eyelet to either end.
    /// fn parts(x: &[Vec3; 3]) -> [(f64, Vec3); 2] {
    ///     [x[0] - x[1], x[2] - x[1]].map(|d| (d.norm(), d.normalize()))
    /// }
    ///
    /// impl Cord {
    ///     /// `k C` (N).
    ///     fn tension(&self, x: &[Vec3; 3]) -> f64 {
    ///         let [(a, _), (b, _)] = parts(x);
    ///         self.stiffness * (a + b - self.length)
    ///     }
    /// }
    ///
    /// impl Element<3> for Cord {
    ///     fn vertices(&self) -> [u32; 3] {
    ///         self.vertices
    ///     }
    /// }
    ///
    /// impl Energy<3> for Cord {
    ///     fn value(&self, x: &[Vec3; 3]) -> f64 {
    ///         0.5 * self.tension(x).powi(2) / self.stiffness
    ///     }
    ///
    ///     fn gradient(&self, x: &[Vec3; 3]) -> [Vec3; 3] {
    ///         let [(_, m), (_, n)] = parts(x);
    ///         [m, -m - n, n].map(|g| g * self.tension(x))
    ///     }
    ///
    ///     fn hessian(&self, x: &[Vec3; 3], convexity: Convexity) -> Blocks<3> {
    ///         let [(a, m), (b, n)] = parts(x);
    ///         let tension = convexity.applied_to(self.tension(x));
    ///         let across = |n: Vec3, length: f64| (Mat3::identity() - n * n.transpose()) * (tension / length);
    ///         let (p, q, zero) = (across(m, a), across(n, b), Mat3::zeros());
    ///         let mut sum = [[p, -p, zero], [-p, p + q, -q], [zero, -q, q]];
    ///         let g = [m, -m - n, n];
    ///         for i in 0..3 {
    ///             for j in 0..3 {
    ///                 sum[i][j] += g[i] * g[j].transpose() * self.stiffness;
    ///             }
    ///         }
    ///         sum
    ///     }
    /// }
    ///
    /// let cord = Cord { vertices: [0, 1, 2], length: 2.5, stiffness: 50.0 };
    /// let x = [Vec3::new(1.0, 0.2, 0.1), Vec3::zeros(), Vec3::new(-0.9, 0.3, 0.4)];    // too short: k C < 0
    /// assert!(gradient_error(&cord, &x, 1.0) < 1e-7 && hessian_error(&cord, &x, 1.0) < 1e-6);
    /// assert!(smallest_eigenvalue(&cord, &x, Convexity::Exact) < -1.0);    // N/m
    /// for convexity in [Convexity::Clamp, Convexity::Abs] {
    ///     assert!(smallest_eigenvalue(&cord, &x, convexity) > -1e-9);
    /// }
    /// ```
    ///
    /// The same by its rows, for an element of one vertex: [`cloth_core::element`].
    #[must_use]
    pub fn energy<const N: usize, E: Energy<N>>(mut self, elements: Vec<E>) -> Self {
        self.energies = self.energies.and_then(|sum| sum.with(elements));
        self
    }

    /// Adds all elements of a cloth, as [`ClothModel::families`](cloth_core::ClothModel::families) has them.
    #[must_use]
    pub fn elements(mut self, families: Vec<Elements>) -> Self {
        self.energies = self.energies.and_then(|sum| sum.with_elements(families));
        self
    }

    /// Sets the settings.
    #[must_use]
    pub fn config(mut self, config: ImplicitConfig) -> Self {
        self.config = config;
        self
    }

    /// Builds the solver: looks up the pattern of the matrix, and analyses it for the linear solver if that is what the
    /// step begins with.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`] or [`BuildError::RepeatedVertex`] if an element names a vertex that the particles
    /// do not have, or one twice; [`BuildError::InvalidElement`] for a number of one; [`BuildError::OutOfRange`],
    /// [`BuildError::SettingsConflict`], [`BuildError::MatrixTooLarge`].
    pub fn build(self) -> Result<S, BuildError> {
        self.config.check()?;
        let energies = self.energies?;
        let vertex_count = self.particles.len();
        let beta = self.config.damping.stiffness;
        let damper = (beta > 0.0).then(|| Damper::new(beta, energies.assembly()));
        let minimizer = Minimizer::new(&self.particles, &energies, &self.config)?;
        let zeros = vec![Vec3::zeros(); vertex_count];
        Ok((self.finish)(Implicit {
            minimizer,
            base: zeros.clone(),
            predicted: zeros.clone(),
            before: (zeros, 0.0),
            damper,
            end_contact: EndContactMemory::default(),
            guard: EnergyGuard::default(),
            constant_velocity_positions: Vec::new(),
            particles: self.particles,
            energies,
            config: self.config,
        }))
    }
}
