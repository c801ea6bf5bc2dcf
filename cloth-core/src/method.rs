//! For authors of methods: what solvers are built from. A simulation needs none of it.
//!
//! In reading order: sums of elements and what they are stored in ([`family`], [`block_matrix`]); orders to visit them
//! in ([`coloring`], [`ordering`]); loops over vectors, on several threads with the same bits ([`vectors`],
//! [`chunked`], [`parallel`]); linear solvers ([`linear`], [`multigrid`], and with contacts [`contact_hessian`]); the
//! sweeps of PBD and XPBD ([`position_based`]); what quasi-Newton methods remember ([`limited_memory`]), and how far a
//! direction is followed ([`line_search`]), also where it may touch something ([`trust`]).
//!
//! # The smallest method
//!
//! A method is a [`Stepper`](crate::step::Stepper). This one is symplectic Euler, `v ← v + Δt (M⁻¹f − M⁻¹∂E/∂x)` and
//! then `x ← x + Δt v`. What every method does is numbered.
//!
//! ```
//! use cloth_core::math::is_finite;
//! use cloth_core::method::family::Energies;
//! use cloth_core::step::Outcome;
//! use cloth_core::{Cloth, Diagonals, Membrane, Particles, State, Vec3, grid};
//! use cloth_core::{StepError, StepInput, StepReport, Stepper};
//!
//! struct Symplectic { particles: Particles, energies: Energies, gradient: Vec<Vec3>, end: State }
//!
//! impl Stepper for Symplectic {
//!     fn name(&self) -> &'static str {
//!         "smallest"
//!     }
//!
//!     fn step(&mut self, state: &mut State, input: StepInput<'_>) -> Result<StepReport, StepError> {
//!         input.check(state, self.particles.len())?;               // 1. data that make no sense
//!         if input.contacts.is_some() {                            // 2. what the method does not do
//!             return Err(StepError::ContactNotFelt { remedy: "take a method that feels contact" });
//!         }
//!         self.energies.set_time(state.time);                      // 3. rest data that change with time
//!         self.gradient.fill(Vec3::zeros());
//!         self.energies.add_gradient(&state.positions, &mut self.gradient);
//!         self.end.clone_from(state);                              // 4. the caller's state stays until the end
//!         for (v, &w) in self.particles.inverse_mass().iter().enumerate() {
//!             // 5. w = 0 is a prescribed vertex, which keeps the velocity that the caller gave it.
//!             let acceleration = input.external_acceleration(v, w) - self.gradient[v] * w;
//!             self.end.velocities[v] += acceleration * input.dt;
//!             self.end.positions[v] += self.end.velocities[v] * input.dt;
//!         }
//!         if let Some(vertex) = self.end.positions.iter().position(|x| !is_finite(x)) {
//!             return Err(StepError::NonFinite { vertex, step: state.steps + 1 });
//!         }
//!         (self.end.time, self.end.steps) = (state.time + input.dt, state.steps + 1);
//!         std::mem::swap(state, &mut self.end);
//!         Ok(StepReport::new(Outcome::Converged, 1))               // 6. what it took
//!     }
//! }
//!
//! let mesh = grid(5, 5, 1.0, 1.0, Diagonals::Alternating)?;
//! let cloth = Cloth { areal_density: 0.2, membrane: Membrane::Modulus(10.0), bending_rigidity: 1e-5 };
//! let model = cloth.on(&mesh)?;
//! let (energies, particles) = (model.energies()?, model.particles.clone());
//! let mut state = State::at_rest(mesh.positions().to_vec());
//! let (gradient, end) = (vec![Vec3::zeros(); particles.len()], state.clone());
//! let mut method = Symplectic { particles, energies, gradient, end };
//! for _ in 0..100 {
//!     method.step(&mut state, StepInput::new(1e-3).gravity(Vec3::new(0.0, 0.0, -10.0)))?;
//! }
//! // Free fall by Δt² g Σ n = ½ g t (t + Δt), with no strain.
//! assert!((state.positions[0].z + 0.5 * 10.0 * 0.1 * 0.101).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! An explicit method is stable only for steps shorter than 2 over its highest frequency (`cloth-massspring`). A method
//! with contact, pins and a builder of its own is `cloth-bench/examples/own-method`.

pub mod family;

pub mod block_matrix;

pub mod coloring;
pub mod ordering;

pub mod chunked;
pub mod parallel;
pub mod vectors;

pub mod linear;
pub mod multigrid;

pub mod contact_hessian;
pub mod in_contact;

pub mod position_based;

pub mod limited_memory;
pub mod line_search;
pub mod pieces;
pub mod trust;
