//! Position-based dynamics: let everything fly, then push the positions back to where they may be.
//!
//! # Idea
//! A stiff spring makes a stiff differential equation. PBD does not integrate it. It lets each vertex fly as if it were
//! alone, then goes through the constraints one after another and moves the few vertices of each, along the constraint's gradient and
//! the lighter ones further, until it is satisfied or, for a soft one, partly so. The next constraint sees what
//! the one before it wrote (Gauss–Seidel). What the positions did in the end is the velocity.
//! No force is ever computed, no system solved, and no spring overshoots: unless over-relaxed (ω > 1), a visit never moves it beyond its rest length.
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
//! **Constraints** (PBD-1, CORE-9). Whatever shows its rows `C(x)`, `∂C/∂x`, `k`: distance, bending (flat, curved, by angle), area, volume, soft pin, and
//! the strains of a triangle. A hard pin is a prescribed vertex, `w = 0`.
//!
//! **Sweeps** (PBD-2). One constraint after another, in the order given or colour by colour and then in parallel; or all at once (Jacobi), each with a share of its
//! correction. ω < 1 relaxes, ω > 1 goes beyond. What one sweep leaves of the slowest error of a straight chain of N rigid links, held at one end:
//!
//! | sweep | factor | sweeps per decade, N = 20 |
//! |---|---|---|
//! | Jacobi, averaged (share ½) | `cos²(π/4N)` | 1493 |
//! | Jacobi, in full | `cos(π/2N)` | 746 |
//! | Gauss–Seidel | `cos²(π/2N)` | 373 |
//! | Chebyshev on Jacobi | `cos(π/2N)/(1 + sin(π/2N))` | 29.3 |
//! | Gauss–Seidel with `ω = 2/(1 + sin(π/2N))` | `ω − 1` | 14.6 |
//!
//! **Chebyshev** (PBD-3) extrapolates over sweeps: `x⁺ = ω (S(x) − x⁻) + x⁻` with ω from 1 by `2/(2 − ρ²)`, `4/(4 − ρ²ω)`, …; ρ is the factor of a sweep, given or estimated.
//! **A hierarchy** (PBD-3) corrects on coarser levels first, by links that resist stretching only.
//!
//! **Strain limiting** (PBD-4) is for the end of a step of any method: projections onto ranges of lengths, areas or principal stretches, and velocities after them that
//! keep linear and angular momentum.
//!
//! | equation | where |
//! |---|---|
//! | S1 (24), (26) | [`Motion::predict`](cloth_core::position_based::Motion::predict), [`update_velocities`](cloth_core::position_based::Motion::update_velocities) |
//! | the sweep of S1 (25), PBD-2 | [`Families::sweep`](cloth_core::position_based::Families::sweep), in the order of [`Sweep`](cloth_core::position_based::Sweep) |
//! | ω, ρ, PBD-3 | [`Acceleration`](cloth_core::position_based::Acceleration), [`Chebyshev`](cloth_core::position_based::Chebyshev) |
//! | C, ∂C/∂x, k (CORE-9; S1 (21), (22)) | [`Constraint::rows`](cloth_core::element::Constraint::rows) of each element of [`energy`](cloth_core::energy) |
//! | `((1 − s)^(−n) − 1)/(h² w̃)` | [`effective_stiffness`] |
//! | `1 − (1 + k h² w̃)^(−1/n)` | [`projection_stiffness`] |
//! | work of prescribed vertices, `−Σ ∂C/∂xᵢ·vᵢ ΣΔλ/h` | [`Motion::count_pin_work`](cloth_core::position_based::Motion::count_pin_work) |
//! | the loop around them | [`PbdSolver`] |
//! | coarse levels: `Δx = Σ wₚ Δxₚ`, PBD-3 | [`Hierarchy`], [`PbdSolver::with_hierarchy`] |
//! | `σ_min ≤ σ ≤ σ_max`, PBD-4 | [`StrainLimiter`], [`WithStrainLimit`] |
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
//! - The result depends on the kind of sweep and the order of the constraints. Parallel sweeps give the same bits on any number of threads.
//! - Averaged Jacobi is slow: on a cloth six constraints meet at a vertex, and each makes a sixth of its correction. Without averaging it diverges there. It is
//!   meant to be extrapolated.
//! - Chebyshev pays with many sweeps (below ten it has hardly begun), and makes a material of finite k stiffer than the same number of plain sweeps:
//!   [`StiffnessRule::Material`] counts plain ones. An accelerated Gauss–Seidel sweep goes there and back, twice the work. Where extrapolation makes corrections
//!   grow, it is given up until the next substep.
//! - The hierarchy, too, makes cloth stiff whatever its k: see [`Hierarchy`].
//! - It is not the minimiser of implicit Euler, at any number of iterations: the iteration with a fixed s > 0 tends to C = 0, whatever k.
//! - Linear momentum is conserved to round-off in free flight. Angular momentum is not: each correction has no moment about the positions that it meets, but
//!   the lever arms turn during the step. What is lost is of order h, as in implicit Euler. Energy is lost too, of order h.
//! - Its forces are not those of the material. A row pushes with `ΣΔλ/h²`, summed over its visits in a substep, and so do prescribed vertices that move: their work is that of these forces. The
//!   elastic energy of the stretch that sweeps leave, in the stiffness of the material, may be thousands of times what they gave; it is never given back as motion.
//! - A row whose gradient vanishes is left alone: a tetrahedron on a line, a triangle in a point. The two ends of a spring that coincide, and a triangle
//!   flattened to a line, are driven apart in a direction that depends on their numbers only.
//! - Stiffnesses are taken to be zero, positive or infinite; a negative one is not looked for.
//!
//! # How many substeps, how many iterations
//! With rigid projections ([`StiffnessRule::Fixed`] of 1) a straight chain of N links of length l and equal masses, swept once per substep from its support, hangs with a mean strain of
//! `ε = g h² (N − 1)/(2 l)`; so a wanted ε takes `Δt √(g (N − 1)/(2 l ε))` substeps. n iterations of one substep divide the sag by nearly n, n substeps by n². "As many iterations as the mesh is wide", a popular rule, leaves
//! `cos^(2N)(π/2N) ≈ e^(−π²/4N)` of the slowest error: 90 % for N = 24. A soft material needs another method: see the limits.
//!
//! # What acceleration saves
//! A sheet of 128 × 128 vertices, rigid springs, hangs at rest by its upper edge or its two upper corners, h = 1/60 s. Gravity takes every vertex down by g h²; how many sweeps until a
//! hundredth of that is left, and how long they take on one thread of a 2-core AMD EPYC (the smallest of some repetitions:
//! `cargo run --release -p cloth-bench -- study acceleration --tables`). "≥": extrapolated at the rate of the second half of the sweeps made, 4 000 or 16 000; where that could be checked, by an edge, it was one sweep in 22 239 off.
//!
//! | | sweeps, edge | ms | sweeps, corners | ms |
//! |---|---|---|---|---|
//! | coloured Gauss–Seidel | ≥ 22 238 | 4840 | ≥ 180 884 | 39 800 |
//! | SOR on it, ω best for a chain of 127 links | 799 | 171 | ≥ 47 869 | 11 300 |
//! | Chebyshev on it, there and back, ρ estimated | 605 | 317 | 1572 | 875 |
//! | the same, ρ = 1 − 2.5/128², nearly the cos²(π/2N) of a chain of N = 127 links | 303 | 163 | 3510 | 1800 |
//! | averaged Jacobi | ≥ 313 267 | 55 800 | ≥ 2 388 586 | 425 000 |
//! | Chebyshev on it, ρ estimated | 2488 | 539 | 5095 | 1080 |
//! | hierarchy, one correction | 1 | 5 | ≥ 180 787 | 40 900 |
//! | hierarchy, every 10 sweeps | 1 | 5 | ≥ 74 979 | 34 200 |
//!
//! ω or ρ that were right for an edge are wrong for corners; an estimate adapts. The hierarchy is at its best where the cloth hangs taut from long supports. A sheet that hangs flat by two corners stays flat by compression,
//! about which its links know nothing. And what one correction leaves (0.2 to 0.5 % by the edge; on another size it can be more than 1 %) goes away as slowly as ever: on 64 × 64 vertices it takes 15 further sweeps to 1 %.
//!
//! # References
//! - M. Müller, B. Heidelberger, M. Hennix, J. Ratcliff, "Position based dynamics", J. Vis. Commun. Image
//!   Represent. 18(2), 2007, <https://doi.org/10.1016/j.jvcir.2007.01.005>. Its `s = 1 − (1 − k)^(1/n)` leaves `1 − k` of a violation after n visits, whatever n; the rule here adds h and w̃.
//! - T. Jakobsen, "Advanced character physics", Game Developers Conference 2001: the distance projection.
//! - J. Bender, M. Müller, M. A. Otaduy, M. Teschner, M. Macklin, "A survey on position-based simulation methods in computer graphics",
//!   Comput. Graph. Forum 33(6), 2014, <https://doi.org/10.1111/cgf.12346>.
//! - H. Wang, "A Chebyshev semi-iterative approach for accelerating projective and position-based dynamics", ACM Trans. Graph. 34(6), 2015,
//!   <https://doi.org/10.1145/2816795.2818063>.
//! - M. Müller, "Hierarchical position based dynamics", VRIPHYS 2008, <https://doi.org/10.2312/PE/vriphys/vriphys08/001-010>. Here links are as long as the way over the cloth,
//!   and do not let each other become shorter.
//! - H. Wang, J. O'Brien, R. Ramamoorthi, "Multi-resolution isotropic strain limiting", ACM Trans. Graph. 29(6), 2010,
//!   <https://doi.org/10.1145/1882261.1866182>; X. Provot, "Deformation constraints in a mass-spring model to describe rigid cloth behavior", Graphics Interface 1995.

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
pub use strain_limit::{
    LimitReport, StrainLimiter, StrainLimiterBuilder, StretchRange, WithStrainLimit,
};
