//! Projective dynamics: every element says where it would like its vertices, one constant matrix reconciles them.
//!
//! # Idea
//! Implicit Euler minimises `G(x) = ‖x − x̃‖²_M/(2Δt²) + E(x)` in every step. Newton's method needs a new matrix in
//! every iteration for that, because the Hessian of a spring turns with the spring. Write the energy of an element as a squared distance instead,
//! from `z = G x` to a set of shapes that cost nothing,
//!
//! `E(x) = min over p in the set of ½ w ‖G x − p‖²`,
//!
//! and all that is not linear sits in `p`. Two steps take turns. The *local* step holds x: each element alone finds its nearest `p`, a
//! spring for instance the vector of its rest length in its present direction. The *global* step holds all p:
//! what is left is quadratic in x with the matrix
//!
//! `A = M/Δt² + Σ w GᵀG`,
//!
//! in which no position occurs. A depends on the mesh, the weights, the masses, the prescribed vertices and Δt. It acts on x, y and z alike, so it has a row per vertex
//! and not three; it is factorised once, and an iteration costs the projections and one solve with the factor.
//!
//! Each of the two steps minimises, so `G` falls in every iteration, from any start, without a line search (the frozen p bound the energy from
//! above and touch it at x: the method majorises and minimises).
//!
//! # Equations
//! ```text
//! x̃ ← x[0] + Δt v + Δt² M⁻¹ f_ext                                  S1 (33)
//! x ← x[0] or x̃; K times:
//!     p ← project(G x), every element for itself                   S1 (28)–(31)
//!     solve (M/Δt² + Σ w GᵀG) x = M x̃/Δt² + Σ w Gᵀ p               S1 (32), (34)
//! x[1] ← x,   v[1] ← (x[1] − x[0])/Δt                              S1 (35)
//! ```
//!
//! (34) is printed for the increment Δx; with `f = Σ w Gᵀ(p − G x)` and `H = Σ w GᵀG` it is the same equation. We solve it
//! for `d = x − x̃`: `A d = Σ w Gᵀ(p − G x̃)`. The masses drop out of the right-hand side, and what is left is small, so free fall loses no digits; `G x̃` and what is constant in p are added up once a step; and as d is zero at prescribed
//! vertices, their rows and columns drop out too. The right-hand side at x̃ is `−∇G(x̃)`, and the difference of two that follow one another is
//! `∇G` at the iterate between: a tolerance costs no evaluation of its own.
//!
//! S1 calls the matrix symmetric but not necessarily semi-definite; `Σ w GᵀG` is semi-definite for weights ≥ 0, and M makes A positive definite.
//!
//! | equation | where |
//! |---|---|
//! | G, w, p (CORE-10; S1 (27)–(31)) | [`Projective`](cloth_core::element::Projective) of each element |
//! | `Σ w Gᵀ p`, the local step | `local.rs`, on threads `parallel.rs` |
//! | A, S1 (30), (32), and its factor | `global.rs` |
//! | the solve of S1 (34) | [`PanelFactor::solve`](cloth_core::linear::PanelFactor::solve) |
//! | `‖∇G‖`, if there is a tolerance | `residual.rs` |
//! | S1 (33), (35) and the loop | [`PdSolver`] |
//!
//! # Example
//! A sheet of 0.2 kg/m² held at two corners:
//! ```
//! use cloth_core::cloth::{Cloth, Membrane};
//! use cloth_core::math::Vec3;
//! use cloth_core::mesh::generate::{Diagonals, grid};
//! use cloth_core::{particles::State, step::{StepInput, Stepper}};
//! use cloth_pd::{PdConfig, PdSolver};
//!
//! let mesh = grid(9, 9, 1.0, 1.0, Diagonals::Alternating)?;
//! let membrane = Membrane::SpringStiffness(1e4);
//! let mut model = Cloth { areal_density: 0.2, membrane, bending_rigidity: 1e-5 }.on(&mesh)?;
//! model.particles.prescribe(72)?;
//! model.particles.prescribe(80)?;
//! let mut solver = PdSolver::builder(&model.particles)
//!     .energy(model.springs)
//!     .energy(model.hinges)
//!     .config(PdConfig { iterations: 20, ..PdConfig::default() })
//!     .build()?;
//!
//! let mut state = State::at_rest(mesh.positions().to_vec());
//! let mut factorizations = 0;
//! for _ in 0..30 {
//!     let input = StepInput::new(1.0 / 60.0).gravity(Vec3::new(0.0, 0.0, -9.81));
//!     factorizations += solver.step(&mut state, input)?.factorizations;
//! }
//! assert_eq!(factorizations, 1);
//! assert!(state.positions[4].z < -0.3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! An element that is no squared distance to a set is refused when compiling:
//! ```compile_fail,E0277
//! use cloth_core::element::{Constraint, Element, Row};
//! use cloth_core::{math::Vec3, particles::Particles};
//!
//! /// Keeps a vertex above the floor: a constraint, and no projection is given for it.
//! #[derive(Clone, Copy, Debug)]
//! struct Floor(u32);
//! impl Element<1> for Floor {
//!     fn vertices(&self) -> [u32; 1] { [self.0] }
//! }
//! impl Constraint<1> for Floor {
//!     type Rows = [Row<1>; 1];
//!     fn rows(&self, x: &[Vec3; 1]) -> [Row<1>; 1] {
//!         [Row { value: x[0].z.min(0.0), gradient: [Vec3::z()], stiffness: 1e4 }]
//!     }
//! }
//! let particles = Particles::new(vec![1.0]).unwrap();
//! cloth_pd::PdSolver::builder(&particles).energy(vec![Floor(0)]);
//! // error: `Floor` is not a squared distance to a set, so projective dynamics cannot take it
//! ```
//!
//! # Limits
//! - The iteration converges linearly, and the more slowly the stiffer the cloth: A is as stiff across a spring as along it, so a mode that turns springs without
//!   stretching them, as falling and folding do, keeps a share `κ/(m/Δt² + κ)` of its error in every iteration, κ its stiffness in `Σ w GᵀG`. The first ten
//!   iterations remove most of the stretch and little of that.
//! - So, cut short, the cloth does not stretch but hangs in the air. A sheet of 1 m × 1 m, 0.2 kg/m², 32 vertices a side, springs of 10⁴ N/m, held at two corners and
//!   let go horizontally, should fall 0.49 m (centre of mass) in half a second. At Δt = 1/60 s it falls 0.05 m with 1 iteration a step, 0.14 m with 10, 0.37 m with 50, 0.48 m with
//!   200. Look at the fall beside the stretch before choosing a number; it takes fewer with softer springs or smaller steps.
//! - Where it converges to is a stationary point of `G`, the solution of implicit Euler, with the numerical damping of that.
//! - Linear momentum of a free cloth is conserved in every iteration, to rounding. Angular momentum is not: implicit Euler does not conserve it, and an iteration cut
//!   short less so.
//! - Only energies of the form above. A spring, a hinge at rest when flat and an attachment have it; an energy with a varying stiffness does not.
//! - Whatever changes A costs a factorisation: here another Δt, which the report counts. Other pins, masses or elements need another solver.
//! - A holds `M/Δt²` and `k` in one number: of `k Δt²/m` near 1e16 the mass is rounded away. A matrix that cannot be factorised is
//!   reported as [`NotPositiveDefinite`](cloth_core::step::StepError::NotPositiveDefinite).
//! - The residual compares with `‖∇G(x̃)‖`. Where that is rounding alone, as for a cloth in free fall, no tolerance is met and all iterations are spent, without harm.
//!
//! # When to use it
//! For many steps with one mesh and one step size, where stretch is what one sees: an iteration costs two passes over a
//! small factor, no iteration can make matters worse, and no step size is too large. Where the motion has to be right and the
//! springs are stiff, compare it with Newton's method, whose iterations are few and cost a factorisation each. Where constraints come and go (contacts, tearing), the position-based methods
//! have no matrix to factorise.
//! Quadratic energies (bending of a flat sheet, attachments) are solved exactly by one iteration.
//!
//! # References
//! - S. Bouaziz, S. Martin, T. Liu, L. Kavan, M. Pauly, "Projective dynamics: fusing constraint projections for fast simulation",
//!   ACM Trans. Graph. 33(4), 154, 2014, <https://doi.org/10.1145/2601097.2601116>.
//! - T. Liu, A. W. Bargteil, J. F. O'Brien, L. Kavan, "Fast simulation of mass-spring systems", ACM Trans. Graph. 32(6), 214, 2013,
//!   <https://doi.org/10.1145/2508363.2508406>.
#![forbid(unsafe_code)]

mod change;
mod chebyshev;
mod coarse;
mod coarse_family;
mod config;
mod free_pieces;
mod global;
mod lattice;
mod local;
mod objective;
mod pieces;
mod quadratic;
mod quasi_newton;
mod solver;

pub use change::{AttachmentId, ChangeError};
pub use config::{Acceleration, PdConfig, Start};
pub use solver::{PdBuilder, PdSolver};
