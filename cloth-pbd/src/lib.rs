//! Position-based dynamics: let everything fly, then push the positions back to where they may be.
//!
//! # Idea
//! A stiff spring makes a stiff differential equation. PBD does not integrate it. It lets each vertex fly as if it were
//! alone, then goes through the constraints one after another and moves the few vertices of each, along the constraint's gradient and
//! the lighter ones further, until it is satisfied or, for a soft one, partly so. The next constraint sees what
//! the one before it wrote (Gauss–Seidel). What the positions did in the end is the velocity.
//! No force is ever computed, no system solved, and no spring overshoots: it is never moved beyond its rest length.
//!
//! # Equations
//! Per substep of size h = Δt/substeps, with `wᵢ = 1/mᵢ` and s the stiffness of a projection (PBD-1, PBD-2):
//!
//! ```text
//! v ← v + h (g + w f),  x̃ ← x + h v                                S1 (24)
//! x ← x̃; n times, for each row C:  xᵢ ← xᵢ − s wᵢ ∂C/∂xᵢ C/w̃,      S1 (25); S1 (23) for a spring and s = 1
//!                                  w̃ = Σ wᵢ ‖∂C/∂xᵢ‖²
//! v ← v + (x − x̃)/h                                                S1 (26)
//! ```
//!
//! S1 prints (26) with the predicted position, and says that the original paper has `(x_new − x)/Δt`. With
//! x the position before the flight the latter is the same number; there is one update, not two.
//!
//! Where does the material come in? One constraint alone has `(1 − s)ⁿ` of its violation left after n visits. Implicit Euler leaves
//! `1/(1 + k h² w̃)`. So n visits with s act as the stiffness `((1 − s)^(−n) − 1)/(h² w̃)`, and the other way round a material of stiffness k
//! asks for `s = 1 − (1 + k h² w̃)^(−1/n)`: [`StiffnessRule::Material`], the default. That is how the same k (N/m) that the
//! other methods take reaches PBD.
//!
//! | equation | where |
//! |---|---|
//! | S1 (24), (26) | [`Motion::predict`](cloth_core::position_based::Motion::predict), [`update_velocities`](cloth_core::position_based::Motion::update_velocities) |
//! | the sweep of S1 (25) | [`Families::sweep`](cloth_core::position_based::Families::sweep), coloured or in the order given: [`Sweep`](cloth_core::position_based::Sweep) |
//! | C, ∂C/∂x, k (CORE-9) | [`Constraint::rows`](cloth_core::element::Constraint::rows) of each element |
//! | `((1 − s)^(−n) − 1)/(h² w̃)` | [`effective_stiffness`] |
//! | `1 − (1 + k h² w̃)^(−1/n)` | [`projection_stiffness`] |
//! | the loop around them | [`PbdSolver`] |
//!
//! # Example
//! ```
//! use cloth_core::{energy::Spring, math::Vec3, particles::{Particles, State}};
//! use cloth_core::step::{StepInput, Stepper};
//! use cloth_pbd::{PbdConfig, PbdSolver};
//!
//! let mut particles = Particles::new(vec![0.1, 0.1])?;
//! particles.prescribe(0)?;
//! let spring = Spring { vertices: [0, 1], rest_length: 1.0, stiffness: 50.0 };
//! let mut solver = PbdSolver::builder(&particles)
//!     .energy(vec![spring])
//!     .config(PbdConfig { iterations: 5, ..PbdConfig::default() })
//!     .build()?;
//!
//! let gravity = Vec3::new(0.0, -9.81, 0.0);
//! let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::new(0.0, -1.0, 0.0)]);
//! for _ in 0..2000 {
//!     solver.step(&mut state, StepInput::new(0.01).gravity(gravity))?;
//! }
//! // One spring alone hangs where it should: m g/k below its rest length.
//! let sag = -state.positions[1].y - 1.0;
//! assert!((sag - 0.1 * 9.81 / 50.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limits
//! - **The material is met by one constraint alone.** [`StiffnessRule::Material`] is exact for it. Constraints that share vertices
//!   spoil each other's corrections, and then the rule gives cloth *softer* than its k, the more so the larger `k h² w̃` and the longer the chain:
//!   two springs in a row of k = 100 N/m, 10 g a vertex, h = 1/60 s, sag 1.9 times too far; twenty of 10⁴ N/m 80 to 250 times (3 times at 1 kg a vertex). More iterations do not cure it:
//!   each then corrects less, and the whole tends to a limit.
//! - **With [`StiffnessRule::Fixed`] the stiffness depends on the iterations**: it grows with each of them and with each smaller step, without
//!   bound, and no number of iterations is the right one.
//! - A finer mesh needs more iterations: for a straight chain of N rigid links one sweep leaves `cos²(π/2N)` of the error.
//!   At rest a rigid chain of N links of equal mass, swept once per substep from its support, sags by
//!   `g h² N(N − 1)/2`.
//! - The result depends on the order of the constraints, hence on [`Sweep`](cloth_core::position_based::Sweep). Coloured sweeps give the same bits on
//!   any number of threads, sequential ones others.
//! - It is not the minimiser of implicit Euler, at any number of iterations: the iteration with a fixed s > 0 tends to C = 0, whatever k.
//! - Linear momentum is conserved to round-off in free flight. Angular momentum is not: each correction has no moment about the positions that it meets, but
//!   the lever arms turn during the step. What is lost is of order h, as in implicit Euler. Energy is lost too, of order h.
//! - A row whose gradient vanishes is left alone. The two ends of a spring that coincide are driven apart in a direction that depends on
//!   their numbers only.
//! - Stiffnesses are taken to be zero, positive or infinite; a negative one is not looked for.
//!
//! # References
//! - M. Müller, B. Heidelberger, M. Hennix, J. Ratcliff, "Position based dynamics", J. Vis. Commun. Image
//!   Represent. 18(2), 2007, <https://doi.org/10.1016/j.jvcir.2007.01.005>. Its `1 − (1 − k)^(1/n)` makes s independent of n; the rule here adds h and w̃.
//! - T. Jakobsen, "Advanced character physics", Game Developers Conference 2001: the distance projection.
//! - J. Bender, M. Müller, M. A. Otaduy, M. Teschner, M. Macklin, "A survey on position-based simulation methods in computer graphics",
//!   Comput. Graph. Forum 33(6), 2014, <https://doi.org/10.1111/cgf.12346>.

#![forbid(unsafe_code)]

mod config;

mod stiffness;

mod solver;

mod hierarchy;

mod strain_limit;

pub use config::PbdConfig;
pub use hierarchy::{Hierarchy, HierarchyConfig, HierarchyError, Link};
pub use solver::{PbdBuilder, PbdSolver};
pub use stiffness::{StiffnessRule, effective_stiffness, projection_stiffness};
pub use strain_limit::{LimitReport, Limited, StrainLimiter, StrainLimiterBuilder, StretchRange};
