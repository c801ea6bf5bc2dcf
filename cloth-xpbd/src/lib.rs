//! Extended position-based dynamics: the same pushing of positions, with a multiplier that remembers the material.
//!
//! # Idea
//! PBD moves a constraint towards zero in every visit; how stiff that makes the cloth depends on how often it
//! visits. XPBD gives each constraint a multiplier λ, its force in the making. A constraint that has already
//! pushed as hard as its stiffness allows at the present stretch pushes no further, however often it is visited.
//! So k is a property of the material again, and `k = ∞` is allowed: it is a rigid link.
//!
//! # Equations
//! With `E = ½ Φᵀ C⁻¹ Φ`, S1 (38), Φ all constraint values and C the diagonal matrix of the compliances 1/k, the force is `f = −Jᵀ C⁻¹ Φ`, S1 (40).
//! S1 (41) prints `λ = C⁻¹Φ`, which does not go with (44); we take `λ = −C⁻¹Φ`, so that `f = Jᵀ λ`, and (44) stands as printed.
//! Eliminating the velocity from (42)–(44) leaves one equation per row, in which Gauss–Seidel makes each row's own right.
//! Written with `α̃ = 1/(k h²)`, and from here on λ for `h²` times the multiplier above (kg m for a spring; `λ/h²` is the force in N):
//!
//! ```text
//! v ← v + h (g + w f),  x̃ ← x + h v,  λ ← 0                        S1 (24)
//! x ← x̃; n times, for each row C:                                  S1 (36)
//!     Δλ = −(C + α̃ λ)/(w̃ + α̃),   w̃ = Σ wᵢ ‖∂C/∂xᵢ‖²
//!     λ ← λ + Δλ,   xᵢ ← xᵢ + wᵢ ∂C/∂xᵢ Δλ
//! v ← v + (x − x̃)/h                                                S1 (26)
//! ```
//!
//! λ is set to zero once per substep. Setting it to zero in each iteration is a known mistake: one constraint alone then
//! ends at `C̃/(1 + k h² w̃)ⁿ` instead of implicit Euler's `C̃/(1 + k h² w̃)`, and k depends on n again.
//!
//! The rows of one element are solved together, `(J M⁻¹ Jᵀ + α̃) Δλ = −(C + α̃λ)` with the few rows of the element: the three
//! strains of a triangle do not have to find each other by repetition. Rows without a coordinate in common, those of a quadratic hinge for instance, are solved one by one, which is the same. Where two hard
//! rows of an element say the same, the later one is left out. Nothing is ever divided by α̃, so that α = 0 is exactly hard.
//!
//! A row that is free within a range, a limit or a contact, remembers what it has done too: it is solved for the λ with `C + α̃λ = 0` and takes back what is too much
//! ([`DeadZoneRow`](cloth_core::element::DeadZoneRow)). If it forgot λ whenever it is free, its k would depend on n.
//!
//! ## Damping
//! [`XpbdConfig::damping`] = β (s) adds `−β k Ċ` to the force `−k C` of every row, with `Ċ = (C − C⁰)/h` and C⁰ the value at the start of the substep: XPBD's constraint damping
//! (Macklin et al. 2016, equation 26) in Rayleigh's form. One row then takes the implicit Euler step of a damped oscillator,
//!
//! ```text
//! C = (C̃ + w̃ h β k C⁰)/(1 + w̃ k h (h + β))
//! ```
//!
//! The paper writes `∂C/∂x·(x − x⁰)` for `C − C⁰`. For a spring that turns by a finite angle that is not zero, and damps the turning; the difference of the values is zero for every rigid
//! motion. By a change of variable, `ν = λ − k h β C⁰`, the sweep is the undamped one with `α̃ = 1/(k h (h + β))` and another start of the multiplier, so damping costs nothing in
//! it.
//!
//! ## Forces
//! `f = Jᵀλ/h²` (XPBD-4): [`XpbdSolver::each_force`] row by row, [`XpbdSolver::vertex_forces_into`] summed at the vertices, [`XpbdSolver::multipliers_into`] as λ. At a
//! pin it is what the support has to bear, at rest the weight.
//!
//! ## Directly
//! With the feature `direct`, `direct::DirectXpbd` solves all rows of a step as one linear system, and repeats that to convergence: for light chains with heavy ends, where sweeps
//! stall, and as the reference that sweeps are held against. With one solve a step and geometric stiffness it is stable constrained dynamics (XPBD-3). Without the feature the crate does not
//! depend on a factorisation library.
//!
//! ## In single precision
//! With the feature `single`, `single::SingleXpbd` sweeps over springs and quadratic hinges in single precision, four springs at a time.
//!
//! | equation | where |
//! |---|---|
//! | S1 (24), (26) | [`Motion::predict`](cloth_core::position_based::Motion::predict), [`update_velocities`](cloth_core::position_based::Motion::update_velocities) |
//! | C, ∂C/∂x, k (CORE-9; S1 (37)) | [`Constraint::rows`](cloth_core::element::Constraint::rows) of each element |
//! | Δλ, from S1 (38)–(44); damping | `compliance.rs` |
//! | the sweep of S1 (36) | [`Families::sweep`](cloth_core::position_based::Families::sweep), in the order of [`Sweep`](cloth_core::position_based::Sweep) |
//! | extrapolated sweeps, λ together with x (XPBD-4) | [`Chebyshev`](cloth_core::position_based::Chebyshev) |
//! | `max abs(C + α̃λ)` | [`XpbdSolver::compliance_residual`] |
//! | λ; `Jᵀλ/h²` | [`XpbdSolver::multipliers_into`]; [`XpbdSolver::each_force`], [`XpbdSolver::vertex_forces_into`] |
//! | the loop around them | [`XpbdSolver`] |
//! | how many substeps | [`SubstepRule`] |
//! | rigid links, ball joints, limits of angles (XPBD-5) | [`mod@links`] |
//! | S1 (44) as one system (XPBD-2), geometric stiffness (XPBD-3) | `direct`, with the feature of that name |
//!
//! # How many substeps, how many iterations
//! The closed forms of a straight chain of N rigid links of length l tell what a setting leaves on top of the elastic strain. A sheet of N rows of edges, hung by one side, is such a chain as
//! far as its weight goes.
//!
//! - **One sweep per substep** of `h = Δt/s`, from the support: the lower end of link i is left behind by what the next link pulls, `wᵢ λᵢ₊₁` with `λᵢ₊₁ = g h² (mass below i)`. The chain sags by
//!   `g h² Σ (mass below i)/mᵢ`: for equal masses `g h² N(N − 1)/2`, a mean strain of `ε = g h² (N − 1)/(2 l)`; a tip of mass M adds `g h² (N − 1)(M/m − 1)`, which for a heavy one is
//!   nearly all. So a wanted ε takes
//!
//!   ```text
//!   s = Δt √( g (N − 1) (1 + 2 (M/m − 1)/N) / (2 l ε) )   substeps
//!   ```
//!
//!   that is 8.7 for 1 %, 24 links of 1/24 m, equal masses, 1/60 s and 9.81 m/s², and 87 with a tip of 1200 times the mass.
//! - **n iterations** of one substep divide the sag by nearly n, not by n² as n substeps do: about `g Δt² N(N − 1)/(2n)` as long as n is well below N². From then on each keeps `cos²(π/2N)` of the error,
//!   a factor of 100 in `ln 100/(−2 ln cos(π/2N))` sweeps: 1,074 for these 24 links.
//! - **"As many iterations as the mesh is wide"** is a popular rule. N sweeps leave `cos^(2N)(π/2N) ≈ e^(−π²/4N)` of the slowest error, here 90 %. At rest they leave a sag of about `g Δt² (N − 1)/2`, a mean strain of 3.1 %, for the 24 links: measured 3.0 %, and 2.3 % on
//!   a sheet of as many rows. The same sweeps as substeps leave 0.25 % and 0.10 %.
//!
//! What the prediction is worth, measured (`cloth-bench study sag --tables`; 24 edges of 1/24 m, rigid springs, one sweep per substep, at rest), in multiples of the predicted mean strain:
//!
//! | hung by | sweep | mean strain | largest strain |
//! |---|---|---|---|
//! | chain, its end | from the support | 1.00 | 2.0 |
//! | chain, its end | coloured | 1.04 | 3.8 |
//! | sheet, an edge | coloured | 0.79 | 4.3 |
//! | sheet, two corners, predicted 0.3 % or less | coloured | 3.0 to 3.2 | 11 or 35, by the diagonals at the corners |
//! | sheet, two corners, predicted 0.9 % | coloured | 13 | 100 |
//!
//! By two corners the weight of the whole sheet goes through a few edges, as with a heavy tip. Ask there for a third of the mean strain that you want, and never for more than 0.3 %: beyond,
//! the edges at the corners give way. For the strain of the worst edge ask for a quarter of it (an edge), or for a tenth to a fortieth (corners).
//!
//! [`SubstepRule`] turns that into a number for any cloth, from its edges, masses, held vertices and fall: what swings is jerked too, and a jerk of speed v strains by some 2 v h/l, since no
//! wave goes further than an edge or so in a substep. Its largest strains, measured (1 m, 10⁴ N/m, falling from the horizontal with steps of 1/60 s, 10 % wanted):
//!
//! | sheet | held by | substeps | largest strain |
//! |---|---|---|---|
//! | 17 × 17 | two corners | 33 | 4.6 % |
//! | 33 × 33 | two corners | 75 | 7.5 % |
//! | 33 × 33, irregular | two corners | 148 | 5.5 % |
//! | 33 × 33 | an edge | 50 | 8.5 % |
//! | 64 × 64 | two corners | 177 | 9.2 % |
//!
//! Twenty substeps leave 54 % at 33 × 33 and 272 % at 64 × 64 by two corners.
//!
//! So spend sweeps on substeps, unless the constraints are few, or the step has to be that of implicit Euler.
//!
//! # What a sweep costs
//! ns per element and sweep, on one thread of a 2-core AMD EPYC (Zen 3) with AVX2, plain release build (`cargo bench -p cloth-bench --bench sweeps`, the smallest sample of each):
//!
//! | vertices a side | springs | quadratic hinges | springs, single precision | springs, the loop of a first program |
//! |---|---|---|---|---|
//! | 64 | 5.2 | 7.9 | 2.5 | 13.4 |
//! | 128 | 5.2 | 8.0 | 2.5 | 13.5 |
//! | 256 | 5.5 | 10.4 | 2.5 | 13.6 |
//! | 512 | 5.4 | 10.4 | | 13.4 |
//! | 1000 | 6.1 | 12.9 | | 13.6 |
//!
//! The first program visits springs in the order of their vertices, each waiting for the one before it. A spring moves some 170 bytes, 2.3 ns at the 75 GB/s of the third-level cache.
//! An irregular sheet of 66 000 vertices takes 5.6. Vertices numbered at random take 7.5 there and 29 on 1000 × 1000; sorted along a curve
//! ([`Order::morton`](cloth_core::ordering::Order::morton)) they take 5.9 and 7.0.
//!
//! A second thread takes part in colours of at least 4096 elements: at 128 a side springs then take 4.1 instead of 5.2, from 181 a side (33 000 vertices) on half the time of one thread, and smaller sheets stay on one.
//!
//! # Example
//! ```
//! use cloth_core::{energy::Spring, math::Vec3, particles::{Particles, State}};
//! use cloth_core::step::{StepInput, Stepper};
//! use cloth_xpbd::XpbdSolver;
//!
//! // A pendulum: a rigid link, and a bob of 0.1 kg released from the side.
//! let mut particles = Particles::new(vec![0.1, 0.1])?;
//! particles.prescribe(0)?;
//! let link = Spring { vertices: [0, 1], rest_length: 1.0, stiffness: f64::INFINITY };
//! let mut solver = XpbdSolver::builder(&particles).energy(vec![link]).build()?;
//!
//! let gravity = Vec3::new(0.0, -9.81, 0.0);
//! let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::new(1.0, 0.0, 0.0)]);
//! let mut multipliers = Vec::new();
//! for _ in 0..100 {
//!     solver.step(&mut state, StepInput::new(0.01).gravity(gravity))?;
//!     assert!((state.positions[1].norm() - 1.0).abs() < 1e-14);
//! }
//! // The rod pulls with m (v²/l + g cos φ).
//! let h = 0.01 / 20.0;
//! solver.multipliers_into(0, &mut multipliers);
//! let tension = -multipliers[0] / (h * h);
//! let expected = 0.1 * (state.velocities[1].norm_squared() - 9.81 * state.positions[1].y);
//! assert!((tension - expected).abs() < 0.01 * expected);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Contact
//! A source that offers contact as constraints ([`ContactConstraints`](cloth_core::contact::ContactConstraints)) is felt in every substep: rows with compliance and λ ≥ 0, last in each sweep, with
//! friction. Any other source acts once, after the step. A sheet of 64 × 64 vertices (1 m, k = 10⁴ N/m) that falls by 5 cm onto a ball of 0.1 m holds this strain energy after 20 and after 60 steps
//! of 1/60 s, and is stretched by this much at most:
//!
//! | substeps | J at 20 | J at 60 | most |
//! |---|---|---|---|
//! | 20 | 18 | 3.5 | 41 % |
//! | 40 | 2.0 | 0.47 | 25 % |
//! | 80 | 0.65 | 0.090 | 14 % |
//! | 160 | 0.16 | 0.035 | 7 % |
//!
//! Gravity releases 0.7 J until then. What is too much is what the sweeps leave, as without contact. The number that [`SubstepRule`] gives for a strain, and what the cloth
//! held at most beyond all that it was given in 60 steps:
//!
//! | strain asked for | substeps | J too much |
//! |---|---|---|
//! | 10 % | 100 | 0.47 |
//! | 7 % | 141 | 0.09 |
//! | 5 % | 196 | 0.05 |
//!
//! So where cloth can touch something, ask for 7 %.
//!
//! # Limits
//! - **It is not the minimiser of implicit Euler**, even when the sweeps have converged. They make `C + α̃λ` zero, with the gradients of the
//!   places where each correction was made; implicit Euler wants them at the end. The gap shrinks with h, in the end as h⁴, and not with n. On a swinging chain of ten links (0.1 m, 0.1 kg) converged sweeps leave
//!   these parts of `G(x̃) − G*` (`cloth-bench study xpbd-floor`), the direct solver rounding:
//!
//!   | Δt (s) | k = 200 N/m | k = 10⁴ N/m |
//!   |---|---|---|
//!   | 1/60 | 9.9e-4 | 1.4e-4 |
//!   | 1/240 | 2.7e-5 | 7.0e-6 |
//!   | 1/960 | 1.4e-7 | 1.4e-7 |
//!
//! - For the same reason forces read from λ miss the balance at rest by an amount of order h² where links turn from x̃ to x within a substep, as those of a rope between two pins do; in a straight chain
//!   they are exact.
//! - Gauss–Seidel needs more sweeps on a finer mesh: a straight chain of N rigid links keeps `cos²(π/2N)` of its error per sweep. At rest,
//!   swept once per substep from its support, with equal masses, it sags by `g h² N(N − 1)/2`. Cut short, a stiff cloth is softer than its k.
//! - Iterates depend on the order of the constraints. Coloured sweeps give the same bits on any number of threads, sequential ones others.
//! - Linear momentum is conserved to round-off in free flight; angular momentum and energy are lost, to order h, as in implicit Euler.
//! - Without damping set, nothing damps but the step size; smaller substeps damp less. Damping does not act on hard rows, which do not move, nor on rigid motion.
//! - A hard row that nothing can move (all its vertices prescribed, or a vanishing gradient) and a row without stiffness are left alone.
//!   Stiffnesses are taken to be zero, positive or infinite; a negative one is not looked for.
//!
//! XPBD is reported to be covered by US patent 11,270,041. Whether that concerns you is for you to check.
//!
//! # References
//! - M. Macklin, M. Müller, N. Chentanez, "XPBD: position-based simulation of compliant constrained dynamics",
//!   Motion in Games 2016, <https://doi.org/10.1145/2994258.2994272>: the sweep, and damping in equation 26.
//! - M. Macklin, K. Storey, M. Lu, P. Terdiman, N. Chentanez, S. Jeschke, M. Müller, "Small steps in physics simulation",
//!   Symposium on Computer Animation 2019, <https://doi.org/10.1145/3309486.3340247>: substeps instead of iterations.
//! - M. Tournier, M. Nesme, B. Gilles, F. Faure, "Stable constrained dynamics", ACM Transactions on Graphics 34 (4), 2015, <https://doi.org/10.1145/2766969>:
//!   geometric stiffness.
//! - M. Servin, C. Lacoursière, N. Melin, "Interactive simulation of elastic deformable materials", SIGRAD 2006: the compliant system S1 (44).

#![forbid(unsafe_code)]

mod config;

mod compliance;

mod solver;

mod substeps;

mod forces;

pub mod links;

#[cfg(feature = "direct")]
pub mod direct;

#[cfg(feature = "single")]
pub mod single;

pub use config::XpbdConfig;
pub use forces::RowForce;
pub use solver::{XpbdBuilder, XpbdSolver};
pub use substeps::SubstepRule;
