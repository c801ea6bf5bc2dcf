//! The step of XPBD as one linear system, solved directly and repeated to convergence. Behind the feature `direct`.
//!
//! # Example
//! ```
//! use cloth_xpbd::direct::DirectXpbd;
//! use cloth_xpbd::{Particles, Spring, State, StepInput, Stepper, Vec3};
//!
//! // Twenty rigid links of 10 g each, and a ton at their end.
//! let mut mass = vec![0.01; 21];
//! mass[20] = 1000.0;
//! let mut particles = Particles::new(mass)?;
//! particles.prescribe(0)?;
//! let link = |i| Spring { vertices: [i, i + 1], rest_length: 0.05, stiffness: f64::INFINITY };
//! let mut solver = DirectXpbd::builder(&particles).energy((0..20).map(link).collect()).build()?;
//!
//! let mut state = State::at_rest((0..21).map(|i| Vec3::new(0.0, 0.0, -0.05 * i as f64)).collect());
//! let report = solver.step(&mut state, StepInput::new(1.0 / 60.0).gravity(Vec3::new(0.0, 0.0, -9.81)))?;
//! assert!(report.iterations <= 4);
//! assert!((state.positions[20].z + 1.0).abs() < 1e-12);
//! let mut forces = vec![Vec3::zeros(); 21];
//! solver.vertex_forces_into(&mut forces);
//! assert!((forces[0].norm() - 1000.19 * 9.81).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Idea
//! A sweep solves one element at a time, and a correction travels one element per visit. Here all rows are linearised
//! together, and one linear system gives the answer for all of them. A heavy end hardly slows that: by the default
//! system a light chain with one takes 2 iterations where it hangs at rest, and where it turns 9, against 6 with equal
//! masses ([table](#which-system-when)).
//!
//! # Equations
//! Backward Euler with the multipliers kept, λ being h² times the generalised force
//! ([derivation](crate#from-backward-euler-to-the-update); Macklin et al. 2016, equations 8 and 9):
//!
//! ```text
//! M (x − x̃) − J(x)ᵀ λ = 0,   C(x) + α̃ λ = 0
//! ```
//!
//! Newton's method on both, with `H = M − Σ λ ∂²C` made positive definite:
//!
//! ```text
//! [ H  −Jᵀ ] [ Δx ]     [ M (x − x̃) − Jᵀλ ]
//! [ J   α̃  ] [ Δλ ]  = −[ C + α̃ λ          ]
//! ```
//!
//! With `H = M` alone, and once from `x⁰`, this is the compliant system of Servin et al. 2006. The published
//! XPBD drops the first right-hand side and keeps `H = M`; we keep the residual, so that the iteration ends at
//! the implicit Euler step and not near it, and so that elastic energies and hard constraints can stand in one
//! system. Where no gradient turns the two end at the same place.
//!
//! **This residual in sweeps.** The first equation is the *primal* one. A visit adds `M⁻¹ ∂Cᵀ Δλ` to x with its own
//! gradient, so after all visits v the residual `g = M (x − x̃) − J(x)ᵀ λ` is
//!
//! ```text
//! g = Σᵥ (∂C(xᵥ) − ∂C(x))ᵀ Δλᵥ
//! ```
//!
//! It is zero for rows with constant gradients. A link that has turned by φ since its visit leaves `2 sin(φ/2) |Δλ|/h²`
//! (N) at each end. That is why converged sweeps miss the implicit Euler step: motions differ from it, and forces do
//! not balance where links turn ([limits](crate#limits) has both). Newton's method with g kept is
//!
//! ```text
//! (J M⁻¹ Jᵀ + α̃) Δλ = −(C + α̃ λ) + J M⁻¹ g,   Δx = M⁻¹ (Jᵀ Δλ − g)
//! ```
//!
//! and for one row `Δλ = (−(C + α̃λ) + Σ wᵢ ∂C/∂xᵢ·gᵢ)/(w̃ + α̃)`, `Δxᵢ = wᵢ (∂C/∂xᵢ Δλ − gᵢ)`. So a visit needs g at
//! its vertices: a sum over all rows that meet there, with their gradients at the present x. Chen et al. 2024 (before,
//! at Motion in Games 2023) correct the update row by row: B-PXPBD is a small change of XPBD for energies ½ k C²,
//! FP-PXPBD takes general hyperelasticity; with many iterations both converge about as Newton's method does, where XPBD
//! does not. This crate has no such sweep. Substeps shrink the gap with h, and Newton's method on all rows, here,
//! removes it: [`Residuals::momentum`] is what is left of it, `√(gᵀ M⁻¹ g)/h²` (N/√kg). Deul et al. 2018 solve XPBD's
//! own system directly, along the tree of a rod.
//!
//! **What one sees of it.** Nothing stretches: the rows are met, so every spring has the length that its λ asks for,
//! and linear momentum is kept. But links point in slightly other directions, so a path or a hanging shape lies beside
//! the right one. How far:
//!
//! - *In one step.* The [limits](crate#limits) have the fraction ε of `G(x̃) − G*` that converged sweeps leave. G is
//!   nearly a parabola about its minimum, so √ε is the distance left, as a fraction of that from x̃ to the implicit
//!   Euler step (in the norm of G): for the swinging chain of 200 N/m 3.1 % at 1/60 s, 0.5 % at 1/240 s, 0.04 % at
//!   1/960 s. Rows that accelerate a vertex by a take it h² a away from x̃. For a = 2 g that is 5.5 mm at 1/60 s, and
//!   the error some 0.2 mm; at 1/240 s it is 0.34 mm, and the error some 2 µm.
//! - *With smaller steps.* In the first step of a chain that has been set in motion (`tests/all/direct/convergence.rs`,
//!   `where_links_turn_…`) the distance to where this solver ends becomes more than 64 times smaller from 1/60 to 1/240
//!   s, and again to 1/960 s: an error of x of an order above 3 in h. Order 4 is to be expected in the end. With x* the
//!   end of the step, a correction of δ = ‖x̃ − x*‖ turns a link of length l by some δ/l, and its gradient with it, so
//!   the sweeps end some δ²/l from x*. δ goes with h²: the distance with h⁴, √ε = δ/l with h², and ε with h⁴, the 256
//!   of the [limits](crate#limits). The velocity is a change of x over h, so its error in that step is of one order
//!   less than that of x. A run of a time t has t/h steps. If their errors add up, the sum is of an order lower by one
//!   again. That is still above 1, and so smaller, for small h, than backward Euler's own error, which is of order 1.
//! - *At rest.* x̃ lies h² g below x: 2.7 mm at 1/60 s, 7 µm at 1/1200 s. A rope between two pins hangs with the
//!   gradients of places in between. Its forces, read with those of the end, miss the weight of a vertex, 0.49 N, by
//!   less than 3e-3 N or 0.6 % at 5 ms, and by about four times as much at 10 ms (`tests/all/chapter/forces.rs`); this
//!   solver's by less than 1e-10 N at 100 ms (`tests/all/direct/forces.rs`).
//!
//! So with many sweeps and one substep of 1/60 s the error of such a chain is tenths of a millimetre. With the default,
//! 1/1200 s, none of it can be seen; what is seen there is the stretch of sweeps that are too few.
//!
//! An iterate is accepted if a merit function falls (`direct/merit.rs`): `½ ‖x − x̃‖²_M` and, for each row, its elastic
//! energy `½ C²/α̃` near C = 0, linear in |C| beyond. For a hard row only the linear part is left, a penalty.
//!
//! A limit is active, in an iteration, where its position is beyond the range; a hard one, which ends at the
//! end of its range, by the sign of its multiplier ([`DeadZoneRow`](cloth_core::element::DeadZoneRow)): a
//! primal–dual active set.
//!
//! # Which system when
//! The system is solved in one of four ways ([`System`]). *Primal–dual*: as it stands, symmetric after a change
//! of sign, by `L D Lᵀ` or by MINRES. *Dual*: with Δx eliminated, `(J H⁻¹ Jᵀ + α̃) Δλ = …`, by Cholesky or by
//! conjugate gradients. The dual matrix needs an H whose inverse is sparse, so the geometric stiffness is then
//! replaced by a block-diagonal upper bound. GMRES is not offered: on a symmetric matrix it makes the iterates
//! of MINRES, and keeps all directions to do so. *Primal*, with Δλ eliminated, it would be
//! `(H + Jᵀ α̃⁻¹ J) Δx = −h² ∇G`: Newton's method on the positions, if H had λ = −C/α̃ and kept its negative part (here
//! it has the accumulated λ, and drops that part). It is not offered either, as a hard row has no α̃⁻¹.
//!
//! **Definite?** H is positive definite, the negative part of the geometric stiffness being dropped. So the primal–dual
//! matrix, symmetric, with α̃ > 0 has one positive eigenvalue for each coordinate and one negative for each row: it is
//! quasi-definite, and has an `L D Lᵀ` without pivoting in any order ([`QuasidefiniteLdlt`]). The dual one is positive
//! definite. With hard rows, α̃ = 0, both are regular as long as the gradients of those are independent. They are
//! singular where one depends on others, as in a truss with more links than hold it, or a flat sheet of links. The
//! factor is therefore that of the matrix with 10⁻¹⁰ or more added to every α̃/(w̃ + α̃); see [limits](#limits).
//!
//! The cost of one step of 1/60 s to 1e-6 of the size, written `numbers in the factor: iterations, linear solves`, and
//! `iterations, Krylov iterations` where there is no factor (`tests/all/direct/systems.rs`). The scenes: a chain of 100
//! rigid links, 1 m long in all, and 10 g a vertex with a tip of 10 kg, hanging; the same turning at 3 rad/s; turning
//! without the tip; a sheet of 17 × 17 vertices held by two corners (0.2 kg/m², 10⁴ N/m, 10⁻⁵ N m), with springs and
//! hinges:
//!
//! | system | hanging chain | turning, heavy tip | turning, equal masses | sheet |
//! |---|---|---|---|---|
//! | primal–dual, `L D Lᵀ` | 7429: 2, 7 | 7429: 9, 45 | 7429: 6, 16 | 94 973: 5, 15 |
//! | primal–dual, MINRES | 2, 421 | 9, 10 145 | 6, 3178 | 5, 7093 |
//! | dual, Cholesky | 1642: 2, 7 | 1642: 14, 53 | 1642: 49, 99 | 684 155: 10, 30 |
//! | dual, conjugate gradients | 2, 204 | 14, 1752 | 49, 4900 | 10, 6714 |
//!
//! - **Primal–dual by `L D Lᵀ`**, the default, wherever rows turn, and for cloth: a sheet has some 12 rows for the 3
//!   coordinates of a vertex, so the dual factor is larger.
//! - **Dual by Cholesky** for chains near rest, whose rows hardly turn in a step and are fewer than coordinates.
//! - **Krylov methods** where no factor fits into memory: each iteration of the step takes 100 to 1,400 of theirs.
//!
//! # Direct or sweeps
//! What one step to 1e-6 of the size costs, and how many substeps of one sweep [`XpbdSolver`](crate::XpbdSolver) makes
//! in that time. Links of 5 cm and 10 g fall from the horizontal; one thread of a busy Intel Xeon, commit e6a6660,
//! medians.
//! `cloth-bench run chain --n 100 --steps 60 --threads 1 --set stiffness=1e6 --set tip_mass=10 --method xpbd-direct`
//! (equal masses: `tip_mass=0.01`), and the same with `--method xpbd --set substeps=200 --set energy_gain=none`:
//!
//! | scene | direct (ms) | iterations | substeps in that time |
//! |---|---|---|---|
//! | 24 links, equal masses | 0.087 | 4 | 350 |
//! | 24 links, tip 1000 times as heavy | 0.23 | 8 | 920 |
//! | 100 links, equal masses | 0.44 | 5 | 470 |
//! | 100 links, tip 1000 times as heavy | 1.04 | 7 | 1100 |
//!
//! An iteration evaluates the rows, factorises once, and solves two to five times with that factor ([table
//! above](#which-system-when)). In a chain all of that grows with the number of links: a row couples neighbours only,
//! and each link adds the same 74 numbers to the factor.
//!
//! **Cloth.** In a sheet of V vertices eliminating a vertex couples all of its neighbours that are left, so the factor
//! grows faster than V: 329 numbers a vertex with 17 × 17 vertices. Measured (Intel Xeon VM, commit 3158c95, medians):
//! `cargo run --release -p cloth-bench -- run hang --n 9 --steps 20 --method xpbd-direct --threads 1`, and n = 17, 33:
//!
//! | sheet | V | a step (ms) | iterations | an iteration (ms) |
//! |---|---|---|---|---|
//! | 9 × 9 | 81 | 6.3 | 6.9 | 0.9 |
//! | 17 × 17 | 289 | 49 | 12.6 | 3.9 |
//! | 33 × 33 | 1089 | 401 | 19.1 | 21 |
//!
//! The time of an iteration goes with V^1.14 from the first to the second line, with V^1.27 to the third. Iterations
//! grow too, so that of a step goes with V^1.6. A substep of one sweep takes about 55 ns a vertex on that machine
//! ([measured](crate::XpbdSolver#what-a-step-costs)), so the step of 17 × 17 vertices takes as long as some 3000
//! substeps.
//!
//! **Against stiffness** the crossover is not measured: each scene above has one k. An iteration here costs the same
//! for any k, ∞ too, and their number depends on how far rows turn. Sweeps for a factor of e grow as η/2, with
//! `η = 2 k h² w`, up to some `N²/π²` in a chain with free ends ([rates](crate::XpbdConfig#how-fast-sweeps-converge)).
//! So soft chains are cheaper by sweeps, stiff ones here.
//!
//! With the heavy tip 200 substeps strain the 100 links by up to 1.2 % at the end, 2000 by 0.41 %, as 20 000 do. So for
//! a chain the direct solver is the cheaper one where sweeps need a thousand substeps; for cloth it is a reference.
//!
//! # Geometric stiffness
//! `J(x)ᵀλ` turns with the cloth. An iteration without that term, H = M, applies the forces of the step in the
//! directions that the links had before it, as an explicit method does: a light vertex of mass m between links
//! of length l under a tension T swings sideways with up to `ω² = 4T/(m l)`, and beyond `hω = 2` one solve a
//! step is unstable, however stiff the links and however exact the solve. With `−Σ λ ∂²C` in H, made positive
//! semi-definite, it is stable (Tournier et al. 2015). The primal–dual systems take all its blocks, not only the
//! diagonal ones. With `warm_start` the first step has no λ to start from, and solves once more to find one, unmoved.
//!
//! # Contact
//! Contact constraints ([`ContactConstraints`](cloth_core::contact::ContactConstraints)) are no part of the
//! system: they are swept after it in each of [`DirectConfig::substeps`], with compliance and λ ≥ 0, and the
//! next substep starts from what they have moved. So cloth that touches something needs substeps, as with
//! [`XpbdSolver`](crate::XpbdSolver): a twisted band of 17 vertices along
//! (`cloth-bench run twist --n 17 --method xpbd-direct --set substeps=31`, 4 turns) ends stretched by 12 to 17 %
//! with 31 of them, by 2 to 2.5 % with 62, and by 2.0 % with 160.
//!
//! | equation | where |
//! |---|---|
//! | the system, scaled | `direct/kkt.rs` |
//! | `[H Jᵀ; J −α̃]`: `L D Lᵀ`, MINRES | `direct/saddle.rs`, [`QuasidefiniteLdlt`], [`Minres`] |
//! | `(J H⁻¹ Jᵀ + α̃) Δλ = …`: Cholesky, conjugate gradients | `direct/schur.rs`, [`Cholesky`] |
//! | `−Σ λ ∂²C ⪰ 0` | [`Constraint::geometric_stiffness`] |
//! | dependent rows, refinement | `direct/linear.rs` |
//! | merit function, line search | `direct/merit.rs`, `direct/line_search.rs` |
//! | contact | `direct/contact.rs` |
//! | the loop around them | [`DirectXpbd`] |
//!
//! [`QuasidefiniteLdlt`]: cloth_core::method::linear::QuasidefiniteLdlt
//! [`Cholesky`]: cloth_core::method::linear::Cholesky
//! [`Constraint::geometric_stiffness`]: cloth_core::element::Constraint::geometric_stiffness
//!
//! # Limits
//! - For cloth without hard constraints Newton's method on the positions alone is the smaller system; this
//!   solver is for chains, bodies of links, and hard constraints in cloth.
//! - The negative part of the geometric stiffness is dropped, as it has to be for a direction of descent. Where
//!   much of the cloth is compressed the iteration is then not Newton's, and takes tens of iterations or spends
//!   its budget ([`Outcome::BudgetSpent`](cloth_core::step::Outcome::BudgetSpent); [`DirectXpbd::residuals`]
//!   says what is left).
//! - The dual form with its upper bound is slow where links turn far in a step under a high tension, where `h² T/(m l)`
//!   is much above one. Without geometric stiffness its elimination is exact, but the iteration may not converge there.
//! - Dependent hard rows are solved with a small number added to the diagonal ([`DirectXpbd::regularization`]),
//!   which refinement takes out again. If they are compatible they are met; λ is then one of many. If they
//!   contradict one another the step ends between them, and its residual says so. A *flat* sheet of hard edges
//!   is a border case: no λ bends it, its lengths come to some 1e-7 m and the step does not converge. The
//!   Krylov methods have no such protection; the line search may refuse their directions.
//! - With [`DirectConfig::warm_start`] a step depends on the one before it.
//!
//! # References
//! Macklin et al. 2016, Servin et al. 2006 and Tournier et al. 2015 are with [the crate](crate#references).
//! - Y. Chen, Y. Han, J. Chen, S. Ma, R. Fedkiw, J. Teran, "Primal residual reduction with extended position based
//!   dynamics and hyperelasticity", Computers & Graphics 2024, <https://doi.org/10.1016/j.cag.2024.103902>.
//! - C. Deul, T. Kugelstadt, M. Weiler, J. Bender, "Direct position-based solver for stiff rods", Computer Graphics
//!   Forum 37 (6), 2018, <https://doi.org/10.1111/cgf.13326>.

mod config;

mod rows;

mod kkt;

mod minres;
mod saddle;
mod schur;

mod linear;

mod line_search;
mod merit;

mod contact;

mod solver;

mod readout;

mod builder;

pub use builder::DirectBuilder;
pub use config::{DirectConfig, DirectStart, System};
pub use minres::{KrylovReport, Minres};
pub use readout::Residuals;
pub use solver::DirectXpbd;
