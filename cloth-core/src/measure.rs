//! Measures that belong to no method: energies, momenta, strain, and the function that implicit Euler minimises.
//!
//! # The balance of energy
//!
//! With the kinetic energy K and the potential energy U (elastic, of gravity, stored in contact) a step has
//! `K' + U' = K + U + W − D`. W is the work of prescribed vertices, of the air ([`work`](crate::air::Air::work)) and of
//! bodies ([`ContactSource::work`](crate::contact::ContactSource::work)). D is what friction and damping take, and the
//! error of the method:
//!
//! - Implicit Euler, times `Δx = Δt v'`, is `K' − K + D₀ = −∂U(x')·Δx` with `D₀ = ½‖v' − v‖²_M`. Where U is convex the
//!   right side is at most `U − U'`, so at least D₀ is lost. Where cloth buckles it is not, and energy may be gained.
//! - Symplectic Euler lets the energy of an oscillation ω go to and fro by a fraction of the order of ωΔt, without a
//!   drift in stable steps. The midpoint rule keeps K + U where U is quadratic.
//! - An iteration that is cut short adds what it leaves, and rounding up to [`rounding_energy`].

use crate::energy::Spring;
use crate::math::{Real, Vec3, gather};
use crate::method::chunked::map_reduce;
use crate::method::family::Energies;
use crate::particles::{Particles, State};
use crate::step::StepInput;

/// One entry per vertex, or the caller has mixed up two cloths.
fn check_length(particles: &Particles, entries: &[Vec3]) {
    assert_eq!(entries.len(), particles.len(), "one entry per vertex");
}

/// `½ Σ m ‖v‖²` (J).
///
/// # Panics
/// If there is not one entry per vertex.
#[must_use]
pub fn kinetic_energy(particles: &Particles, velocities: &[Vec3]) -> Real {
    check_length(particles, velocities);
    let twice: Real = particles
        .mass()
        .iter()
        .zip(velocities)
        .map(|(m, v)| m * v.norm_squared())
        .sum();
    0.5 * twice
}

/// The kinetic energy (J) that rounding may make of a mass (kg) in a step of `dt` (s), with coordinates up to `size`
/// (m): positions moved by 10⁻¹⁰ of them.
#[must_use]
pub fn rounding_energy(mass: Real, size: Real, dt: Real) -> Real {
    0.5 * mass * (1e-10 * size / dt).powi(2)
}

/// `−Σ m g·x` (J), zero at the origin.
///
/// # Panics
/// If there is not one entry per vertex.
#[must_use]
pub fn gravitational_energy(particles: &Particles, positions: &[Vec3], gravity: Vec3) -> Real {
    check_length(particles, positions);
    -particles
        .mass()
        .iter()
        .zip(positions)
        .map(|(m, x)| m * gravity.dot(x))
        .sum::<Real>()
}

/// `Σ m v` (kg m/s).
///
/// # Panics
/// If there is not one entry per vertex.
#[must_use]
pub fn linear_momentum(particles: &Particles, velocities: &[Vec3]) -> Vec3 {
    check_length(particles, velocities);
    particles
        .mass()
        .iter()
        .zip(velocities)
        .map(|(&m, v)| v * m)
        .sum()
}

/// `Σ m x × v` (kg m²/s), about the origin.
///
/// # Panics
/// If there is not one entry per vertex.
#[must_use]
pub fn angular_momentum(particles: &Particles, state: &State) -> Vec3 {
    check_length(particles, &state.positions);
    check_length(particles, &state.velocities);
    let moving = state.positions.iter().zip(&state.velocities);
    particles
        .mass()
        .iter()
        .zip(moving)
        .map(|(&m, (x, v))| x.cross(v) * m)
        .sum()
}

/// Mean position weighted by mass (m); NaN if there is no vertex.
///
/// # Panics
/// If there is not one entry per vertex.
#[must_use]
pub fn center_of_mass(particles: &Particles, positions: &[Vec3]) -> Vec3 {
    check_length(particles, positions);
    let moment: Vec3 = particles
        .mass()
        .iter()
        .zip(positions)
        .map(|(&m, x)| x * m)
        .sum();
    moment / particles.mass().iter().sum::<Real>()
}

/// Strain `(l − L)/L` (dimensionless) of springs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Strain {
    /// Largest: the most stretched spring; 0 if there is none.
    pub max: Real,
    /// Smallest: the most compressed spring; 0 if there is none.
    pub min: Real,
    /// Root of the mean square.
    pub rms: Real,
}

impl Strain {
    /// Strain of all springs that have a rest length.
    #[must_use]
    pub fn of(springs: &[Spring], positions: &[Vec3]) -> Self {
        let mut strain = Self::default();
        let mut count = 0;
        for spring in springs.iter().filter(|s| s.rest_length > 0.0) {
            let [a, b] = gather(positions, spring.vertices);
            let e = (a - b).norm() / spring.rest_length - 1.0;
            if count == 0 {
                (strain.max, strain.min) = (e, e);
            }
            strain.max = strain.max.max(e);
            strain.min = strain.min.min(e);
            strain.rms += e * e;
            count += 1;
        }
        if count > 0 {
            strain.rms = (strain.rms / Real::from(count)).sqrt();
        }
        strain
    }
}

/// The inertial prediction `x̃ = x + Δt v + Δt² a`, where every vertex would go without elasticity; a
/// prescribed vertex goes to `x + Δt v`.
///
/// # Panics
/// If the lengths differ.
pub fn predict(particles: &Particles, state: &State, input: &StepInput<'_>, out: &mut [Vec3]) {
    check_length(particles, &state.positions);
    check_length(particles, &state.velocities);
    check_length(particles, out);
    let dt = input.dt;
    let moving = state.positions.iter().zip(&state.velocities);
    for (vertex, (out, (x, v))) in out.iter_mut().zip(moving).enumerate() {
        let a = input.external_acceleration(vertex, particles.inverse_mass()[vertex]);
        *out = x + (v + a * dt) * dt;
    }
}

/// `G(x) = ‖x − x̃‖²_M / (2Δt²) + E(x)`: what implicit Euler minimises in one step, over the
/// vertices that are not prescribed.
#[derive(Clone, Copy, Debug)]
pub struct IncrementalPotential<'a> {
    /// Masses and prescribed vertices.
    pub particles: &'a Particles,
    /// E.
    pub energies: &'a Energies,
    /// x̃ (m), see [`predict`].
    pub predicted: &'a [Vec3],
    /// Δt (s).
    pub dt: Real,
}

impl IncrementalPotential<'_> {
    /// `G(x)` (J).
    ///
    /// # Panics
    /// If `x` or the prediction does not have one entry per vertex.
    #[must_use]
    pub fn value(&self, x: &[Vec3]) -> Real {
        self.inertia(x) + self.energies.value(x)
    }

    /// `‖x − x̃‖²_M / (2Δt²)` (J).
    fn inertia(&self, x: &[Vec3]) -> Real {
        check_length(self.particles, x);
        check_length(self.particles, self.predicted);
        let mut twice = 0.0;
        for (vertex, (x, goal)) in x.iter().zip(self.predicted).enumerate() {
            if !self.particles.is_prescribed(vertex) {
                twice += self.particles.mass()[vertex] * (x - goal).norm_squared();
            }
        }
        0.5 * twice / (self.dt * self.dt)
    }

    /// Writes `∂G/∂x` (N) to `out`: `M (x − x̃)/Δt² + ∂E/∂x`, zero at prescribed vertices. Returns `G(x)` (J), as
    /// [`IncrementalPotential::value`] but for rounding.
    pub fn gradient_into(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        out.fill(Vec3::zeros());
        let elastic = self.energies.add_gradient(x, out);
        let scale = 1.0 / (self.dt * self.dt);
        let (mass, inverse_mass) = (self.particles.mass(), self.particles.inverse_mass());
        let predicted = self.predicted;
        let [twice] = map_reduce(
            out,
            #[inline(always)]
            |start, out: &mut [Vec3]| {
                let mut twice = 0.0;
                for (vertex, out) in (start..).zip(out) {
                    if inverse_mass[vertex] == 0.0 {
                        *out = Vec3::zeros();
                    } else {
                        let away = x[vertex] - predicted[vertex];
                        let pull = away * (mass[vertex] * scale);
                        twice += pull.dot(&away);
                        *out += pull;
                    }
                }
                [twice]
            },
        );
        elastic + 0.5 * twice
    }

    /// Norm of `M (x − x̃)/Δt²`, the forces that it takes to end at x, in the metric of `M⁻¹` (N/√kg). At a minimum of
    /// `G` these are the elastic ones.
    ///
    /// Where E is convex the Hessian of G is at least `M/Δt²`. So `‖∇G(x)‖ ≤ δ ‖M (x − x̃)/Δt²‖` says that x is no
    /// farther from the minimum than δ times its distance from x̃, both in the metric of M, and that G is above its
    /// minimum by at most `δ²` times `‖x − x̃‖²_M/(2Δt²)`.
    ///
    /// # Panics
    /// If `x` or the prediction does not have one entry per vertex.
    #[must_use]
    pub fn inertial_norm(&self, x: &[Vec3]) -> Real {
        (2.0 * self.inertia(x)).sqrt() / self.dt
    }

    /// Norm of a gradient of `G` in the metric of `M⁻¹` (N/√kg), over the vertices that are not prescribed.
    #[must_use]
    pub fn gradient_norm(&self, gradient: &[Vec3]) -> Real {
        let square = |(w, g): (&Real, &Vec3)| w * g.norm_squared();
        let sum: Real = self
            .particles
            .inverse_mass()
            .iter()
            .zip(gradient)
            .map(square)
            .sum();
        sum.sqrt()
    }
}
