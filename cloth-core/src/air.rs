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
//! # In a step
//! The force depends on the velocity, and is taken where the (sub)step of h (s) ends: to first order it is there
//!
//! F(v₀) − D (v − v₀),   D = Σ ⅓ ½ ρ A (|u·n| (C_D + C_L |cos θ|) I + (C_D |u·n| + C_L |u| sin² θ) n nᵀ)
//!
//! with v₀ at its start and D (kg/s) of each vertex the sum over its triangles ([`Air::linearize`]). D is not the whole
//! derivative. It does not couple n to the directions along the surface. And each corner has ⅓ F of the mean of three
//! velocities, which is 1/9 of ∂F/∂u in each of nine blocks; D lumps the three of a row onto the diagonal. So it damps
//! a common motion of the corners alike, others more. D is positive semidefinite, as all its terms are. With t along
//! the part of u in the surface, and b across n and t, it has, in `½ ρ A |u|` for the whole triangle,
//!
//! n: `2 C_D cos θ + C_L`,  t and b: `C_D cos θ + C_L cos² θ`.
//!
//! The diagonal of −∂F/∂v has `2 C_D cos θ + C_L sin⁴ θ` for n, `C_D cos θ − C_L cos⁴ θ` for t and `C_D cos θ − C_L
//! cos² θ` for b. So along each of the axes D damps a motion no less than the whole derivative would. (Between n and t
//! it may damp less: of drag alone, by up to `½ C_D sin θ`.) What a free triangle makes of it: with its mass m, u
//! becomes u − δ, where `(m/h + D) δ = F`. Without m/h, δ would be
//!
//! n: `u_n (C_D cos θ + C_L sin² θ)/(2 C_D cos θ + C_L)`,  t: `u_t (C_D − C_L cos θ)/(C_D + C_L cos θ)`,
//!
//! less than u in both, and not negative along t where C_L ≤ C_D. With m/h it is less. So
//!
//! - cloth that is held feels all of the pressure, whatever the step: v = v₀ = 0, and nothing of F is lost;
//! - cloth that is free comes nearer to the velocity of the air, and never gets beyond it: the part of u along n, and
//!   the part across it where C_L ≤ C_D, shrink in a step of any length and keep their signs;
//! - cloth that has come to rest in a steady wind is where its elastic forces balance the pressure, whatever the step:
//!   v = v₀ = 0 there, so D does nothing.
//!
//! Implicit methods have the term `½ (v − v₀)ᵀ D (v − v₀) h` in what they minimise, explicit ones divide by `I + h
//! D/m`, and methods with sweeps project every vertex on it, as XPBD does a constraint of the stiffness D/h
//! ([`Air::project`]); the last two in every substep.
//!
//! # Limits
//! - The air does not know of the cloth: no wake, no shelter of one fold by another, no friction along the surface, no
//!   mass of air that moves along.
//! - Where C_L > C_D a step that is long for the mass of the cloth may turn the flow farther than it should, and leave
//!   up to twice the speed along the surface.
//! - A method that knows nothing of D, such as one of the caller's, has the force at the start of a step
//!   ([`Air::load`]). Its impulse is bounded: never more than what leaves the triangle, were it free, with the smallest
//!   speed relative to the air. So no wind makes a step unstable, but where the bound acts, cloth that is held feels
//!   less than the pressure. Plain and Chebyshev iterations of projective dynamics, whose matrix is constant, have it.

mod projection;

use crate::error::{OutOfRange, finite, not_negative, positive, within};
use crate::math::{Mat3, Real, Vec3, gather};
use crate::mesh::TriMesh;
use crate::particles::State;
use projection::Projection;
pub use projection::implicit;

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

impl AirConfig {
    fn check(&self) -> Result<(), OutOfRange> {
        for (name, value) in [
            ("the density of the air", self.density),
            ("the drag", self.drag),
            ("the lift", self.lift),
        ] {
            not_negative(name, value)?;
        }
        let is_right = self.lift == 0.0 || self.drag > 0.0;
        within(is_right, "the lift", self.lift, "zero without drag")?;
        for value in &self.wind {
            finite("the wind", *value)?;
        }
        Ok(())
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
    /// Force on each vertex (N).
    load: Vec<Vec3>,
    /// D of each vertex (kg/s), and where the force was taken: positions (m) and velocities (m/s).
    drag: Vec<Mat3>,
    positions: Vec<Vec3>,
    velocities: Vec<Vec3>,
    /// Work (J) of the substeps that have ended, if the method knows of D.
    work: Option<Real>,
    projection: Projection,
}

impl Air {
    /// Air around a cloth of `areal_density` (kg/m²) with the rest shape `mesh`.
    ///
    /// # Errors
    /// [`OutOfRange`] for a number that is not finite, a density or a coefficient below zero, a lift without drag (an
    /// explicit force across the flow only adds energy), or an areal density that is not positive.
    pub fn new(config: AirConfig, areal_density: Real, mesh: &TriMesh) -> Result<Self, OutOfRange> {
        config.check()?;
        positive("the areal density", areal_density)?;
        Ok(Self {
            config,
            triangles: mesh.triangles().to_vec(),
            masses: mesh.areas().map(|area| area * areal_density).collect(),
            load: vec![Vec3::zeros(); mesh.vertex_count()],
            drag: vec![Mat3::zeros(); mesh.vertex_count()],
            positions: vec![Vec3::zeros(); mesh.vertex_count()],
            velocities: vec![Vec3::zeros(); mesh.vertex_count()],
            work: None,
            projection: Projection::default(),
        })
    }

    /// What the air is like.
    #[must_use]
    pub fn config(&self) -> &AirConfig {
        &self.config
    }

    /// Changes what the air is like, from the next step on: a gust, for instance.
    ///
    /// # Errors
    /// [`OutOfRange`] as in [`Air::new`]; nothing has changed then.
    pub fn set_config(&mut self, config: AirConfig) -> Result<(), OutOfRange> {
        config.check()?;
        self.config = config;
        Ok(())
    }

    /// A bound on the force per area (Pa) of the wind w on cloth at rest, `½ ρ (C_D + C_L) w²`. Without lift cloth
    /// across the wind feels all of it; with `C_L ≤ C_D` the most that any cloth feels is `½ ρ C_D w²`.
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

    /// Begins a step of `dt` (s) from `state`: the force of the air there on each vertex (N), with a bounded impulse.
    ///
    /// # Panics
    /// If the state has fewer vertices than the mesh.
    pub fn load(&mut self, state: &State, dt: Real) -> &[Vec3] {
        self.restart();
        self.begin(&state.positions, &state.velocities);
        for t in 0..self.triangles.len() {
            let (corners, flow) = self.triangle(t);
            let force = flow.force(&self.config);
            // The speed relative to the air is smallest after the impulse with F Δt/m = û·F/|F| |u|.
            let most = self.masses[t] / dt * force.dot(&flow.velocity) / force.norm_squared();
            let third = if most < 1.0 { force * most } else { force } / 3.0;
            corners.iter().for_each(|v| self.load[*v as usize] += third);
        }
        &self.load
    }

    /// Takes back all substeps of the step.
    pub fn restart(&mut self) {
        self.work = None;
    }

    /// Begins a substep at positions `x` (m) and velocities `v` (m/s): the forces there, and D.
    ///
    /// # Panics
    /// If there are fewer vertices than in the mesh.
    pub fn linearize(&mut self, x: &[Vec3], v: &[Vec3]) {
        self.begin(x, v);
        self.drag.fill(Mat3::zeros());
        for t in 0..self.triangles.len() {
            let (corners, flow) = self.triangle(t);
            let force = flow.force(&self.config) / 3.0;
            let drag = flow.drag(&self.config) / 3.0;
            for vertex in corners.map(|v| v as usize) {
                self.load[vertex] += force;
                self.drag[vertex] += drag;
            }
        }
    }

    /// Begins another substep at positions `x` (m) and velocities `v` (m/s), as long as the one that has ended, with
    /// the D of that: its forces at the end go on linearly.
    ///
    /// # Panics
    /// If there are fewer vertices than in the mesh.
    pub fn continue_linearly(&mut self, x: &[Vec3], v: &[Vec3]) {
        self.positions.copy_from_slice(x);
        self.velocities.copy_from_slice(v);
        self.projection.restart();
    }

    /// Force on each vertex (N): at the start of the substep, or in all of it once that has ended.
    #[must_use]
    pub fn forces(&self) -> &[Vec3] {
        &self.load
    }

    /// D of each vertex (kg/s) in the substep.
    #[must_use]
    pub fn drag(&self) -> &[Mat3] {
        &self.drag
    }

    /// Velocities (m/s) v₀ at the start of the substep.
    #[must_use]
    pub fn velocities(&self) -> &[Vec3] {
        &self.velocities
    }

    /// Gets ready for [`project`](Self::project) in a substep of `h` (s), with the inverse masses `w` (1/kg).
    pub fn begin_projection(&mut self, w: &[Real], h: Real) {
        self.projection.begin(&self.drag, w, h);
    }

    /// Projects the positions `x` (m) of the free vertices onto what the drag leaves of their motion: one sweep.
    pub fn project(&mut self, x: &mut [Vec3]) {
        let starts = self.positions.iter().zip(&self.velocities);
        self.projection.sweep(&self.drag, starts, x);
    }

    /// Ends the substep, whose forces act with the velocities `v` (m/s), at `x` (m); `w` are the inverse masses (1/kg).
    pub fn end(&mut self, x: &[Vec3], v: &[Vec3], w: &[Real]) {
        self.add_drag(v);
        self.work = Some(self.work.unwrap_or(0.0) + self.work_of_substep(x, w));
    }

    /// The same of an explicit substep of `h` (s), whose forces do their work with the mean of the velocities before
    /// and after it: that is what the kinetic energy gains by them.
    pub fn end_explicit(&mut self, h: Real, v: &[Vec3], w: &[Real]) {
        self.add_drag(v);
        let free = (0..self.load.len()).filter(|&vertex| w[vertex] > 0.0);
        let works =
            free.map(|vertex| self.load[vertex].dot(&(self.velocities[vertex] + v[vertex])));
        self.work = Some(self.work.unwrap_or(0.0) + 0.5 * h * works.sum::<Real>());
    }

    /// The force that has acted, of the force at the start and the velocities (m/s) at the end.
    fn add_drag(&mut self, v: &[Vec3]) {
        for (vertex, force) in self.load.iter_mut().enumerate() {
            *force -= self.drag[vertex] * (v[vertex] - self.velocities[vertex]);
        }
    }

    /// Work (J) of the air on free vertices in the step that has ended at `x` (m).
    #[must_use]
    pub fn work(&self, x: &[Vec3], w: &[Real]) -> Real {
        self.work.unwrap_or_else(|| self.work_of_substep(x, w))
    }

    fn work_of_substep(&self, x: &[Vec3], w: &[Real]) -> Real {
        let free = (0..self.load.len()).filter(|&v| w[v] > 0.0);
        free.map(|v| self.load[v].dot(&(x[v] - self.positions[v])))
            .sum()
    }

    fn begin(&mut self, x: &[Vec3], v: &[Vec3]) {
        self.positions.copy_from_slice(x);
        self.velocities.copy_from_slice(v);
        self.load.fill(Vec3::zeros());
    }

    /// The corners of a triangle, and the flow past it.
    fn triangle(&self, t: usize) -> ([u32; 3], Flow) {
        let corners = self.triangles[t];
        let [a, b, c] = gather(&self.positions, corners);
        let [v0, v1, v2] = gather(&self.velocities, corners);
        let velocity = self.config.wind - (v0 + v1 + v2) / 3.0;
        (corners, Flow::past((b - a).cross(&(c - a)), velocity))
    }
}

/// The air past a triangle; all but its velocity is zero where it has no area, or no air goes through it.
struct Flow {
    /// u (m/s) and |u|.
    velocity: Vec3,
    speed: Real,
    /// n on the side to which the air flows, and |u·n| (m/s).
    normal: Vec3,
    through: Real,
    /// ½ A (m²).
    half_area: Real,
}

impl Flow {
    /// Past a triangle with the normal `area2` of twice its area (m²).
    fn past(area2: Vec3, velocity: Vec3) -> Self {
        let (size, through) = (area2.norm(), area2.dot(&velocity));
        let is_met = size > 0.0 && through != 0.0;
        let [per_size, half_area] = match is_met {
            true => [through.signum() / size, 0.25 * size],
            false => [0.0; 2],
        };
        Self {
            velocity,
            speed: velocity.norm(),
            normal: area2 * per_size,
            through: through * per_size,
            half_area,
        }
    }

    /// cos θ.
    fn cosine(&self) -> Real {
        match self.through > 0.0 {
            true => self.through / self.speed,
            false => 0.0,
        }
    }

    /// F (N).
    fn force(&self, config: &AirConfig) -> Vec3 {
        let across = self.normal * self.speed - self.velocity * self.cosine();
        let whole = self.velocity * config.drag + across * config.lift;
        whole * (config.density * self.half_area * self.through)
    }

    /// D (kg/s).
    fn drag(&self, config: &AirConfig) -> Mat3 {
        let (drag, cosine) = (config.drag * self.through, self.cosine());
        let each = drag + config.lift * self.through * cosine;
        let extra = drag + config.lift * self.speed * (1.0 - cosine * cosine).max(0.0);
        let n = self.normal;
        let mut matrix = n * (n * extra).transpose();
        (0..3).for_each(|i| matrix[(i, i)] += each);
        matrix * (config.density * self.half_area)
    }
}
