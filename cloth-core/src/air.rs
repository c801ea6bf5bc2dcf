//! Air that flows past a cloth, as a load on its vertices.
//!
//! A triangle of area A (m²) past which air of density ρ (kg/m³) flows with the relative velocity u = w − v (w the
//! wind, v the mean velocity of the corners) is pushed along the flow by the drag and across it by the lift (M.
//! Keckeisen, S. Kimmerle, B. Thomaszewski, M. Wacker, *Modelling effects of wind fields in cloth animations*, Journal
//! of WSCG 12, 2004). With û = u/|u| and the normal n on the side to which the air flows, cos θ = n·û ≥ 0:
//!
//! F = ½ ρ A |u|² cos θ (C_D û + C_L (n − cos θ û)).
//!
//! So a plate across the flow feels ½ ρ C_D A |u|², one along the flow nothing, and one at an angle the drag ½ ρ C_D A
//! |u|² cos θ and the lift ½ ρ C_L A |u|² cos θ sin θ. Each corner takes a third; both sides of the cloth count alike.
//! All of these grow with the square of the speed.
//!
//! # Limits
//! - The air does not know of the cloth: no wake, no shelter of one fold by another, no friction along the surface, no
//!   mass of air that moves along.
//! - The force is that at the start of a step. Its impulse is therefore bounded where a light cloth meets much air in a
//!   long step: never more than what leaves the triangle with the smallest speed relative to the air. So no wind makes
//!   a step unstable, and where the bound does not act the force is the formula's.

use crate::error::{OutOfRange, finite, not_negative, positive, within};
use crate::math::{Real, Vec3, gather};
use crate::mesh::TriMesh;
use crate::particles::State;

/// What the air is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirConfig {
    /// Density ρ (kg/m³).
    pub density: Real,
    /// Drag coefficient C_D (dimensionless).
    pub drag: Real,
    /// Lift coefficient C_L (dimensionless).
    pub lift: Real,
    /// Velocity of the wind w (m/s).
    pub wind: Vec3,
}

/// Still air at sea level around a cloth that drags like a flat plate and has no lift.
impl Default for AirConfig {
    fn default() -> Self {
        Self {
            density: 1.2,
            drag: 1.2,
            lift: 0.0,
            wind: Vec3::zeros(),
        }
    }
}

/// The air around one cloth.
///
/// ```
/// use cloth_core::air::{Air, AirConfig};
/// use cloth_core::math::Vec3;
/// use cloth_core::mesh::generate::{Diagonals, grid};
/// use cloth_core::particles::State;
///
/// let mesh = grid(3, 3, 2.0, 1.0, Diagonals::OneWay)?; // 2 m², seen from above
/// let wind = Vec3::new(0.0, 0.0, 5.0); // m/s, from below
/// let mut air = Air::new(AirConfig { wind, ..AirConfig::default() }, 0.2, &mesh)?;
/// let state = State::at_rest(mesh.positions().to_vec());
/// let force: Vec3 = air.load(&state, 1e-3).iter().sum();
/// assert!((force.z - 0.5 * 1.2 * 1.2 * 2.0 * 25.0).abs() < 1e-12); // N
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Air {
    config: AirConfig,
    triangles: Vec<[u32; 3]>,
    /// Mass of each triangle (kg), for the bound of its impulse.
    masses: Vec<Real>,
    load: Vec<Vec3>,
}

impl Air {
    /// Air around a cloth of `areal_density` (kg/m²) with the rest shape `mesh`.
    ///
    /// # Errors
    /// [`OutOfRange`] for a number that is not finite, a density or a coefficient below zero, a lift without drag (an
    /// explicit force across the flow only adds energy), or an areal density that is not positive.
    pub fn new(config: AirConfig, areal_density: Real, mesh: &TriMesh) -> Result<Self, OutOfRange> {
        for (name, value) in [
            ("the density of the air", config.density),
            ("the drag", config.drag),
            ("the lift", config.lift),
        ] {
            not_negative(name, value)?;
        }
        let is_right = config.lift == 0.0 || config.drag > 0.0;
        within(is_right, "the lift", config.lift, "zero without drag")?;
        for value in &config.wind {
            finite("the wind", *value)?;
        }
        positive("the areal density", areal_density)?;
        Ok(Self {
            config,
            triangles: mesh.triangles().to_vec(),
            masses: mesh.areas().map(|area| area * areal_density).collect(),
            load: vec![Vec3::zeros(); mesh.vertex_count()],
        })
    }

    /// The largest pressure (Pa) of the wind on cloth at rest, across it.
    #[must_use]
    pub fn largest_pressure(&self) -> Real {
        let AirConfig {
            density,
            drag,
            lift,
            wind,
        } = &self.config;
        0.5 * density * (drag + lift) * wind.norm_squared()
    }

    /// Force of the air (N) on each vertex, for a step of `dt` (s) from `state`: what
    /// [`StepInput::load`](crate::step::StepInput::load) takes.
    ///
    /// # Panics
    /// If the state has fewer vertices than the mesh.
    pub fn load(&mut self, state: &State, dt: Real) -> &[Vec3] {
        self.load.fill(Vec3::zeros());
        for (&corners, &mass) in self.triangles.iter().zip(&self.masses) {
            let [a, b, c] = gather(&state.positions, corners);
            let [v0, v1, v2] = gather(&state.velocities, corners);
            let flow = self.config.wind - (v0 + v1 + v2) / 3.0;
            let third = force(&self.config, (b - a).cross(&(c - a)), flow, mass / dt) / 3.0;
            for vertex in corners {
                self.load[vertex as usize] += third;
            }
        }
        &self.load
    }
}

/// Force (N) on a triangle with the normal `area2` of twice its area (m²) in a `flow` (m/s), bounded by `rate` = m/Δt
/// (kg/s).
fn force(config: &AirConfig, area2: Vec3, flow: Vec3, rate: Real) -> Vec3 {
    let speed = flow.norm();
    // A |u|cos θ; the sign turns the normal to the side to which the air flows.
    let through = 0.5 * area2.dot(&flow);
    let Some(normal) = area2.try_normalize(0.0).filter(|_| through != 0.0) else {
        return Vec3::zeros(); // no area, no wind, or wind along the surface
    };
    let normal = normal * through.signum();
    let across = normal * speed - flow * (normal.dot(&flow) / speed);
    let force =
        (flow * config.drag + across * config.lift) * (0.5 * config.density * through.abs());
    // The speed relative to the air is smallest after the impulse with F Δt/m = û·F/|F| |u|.
    let most = rate * force.dot(&flow) / force.norm_squared();
    if most < 1.0 { force * most } else { force }
}
