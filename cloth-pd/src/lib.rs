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
//! # What the constant matrix loses, and how it is won back
//! A is as stiff across a spring as along it, but a spring resists only along. Motions that turn springs without stretching them, as falling and folding
//! do, keep a share `κ/(m/Δt² + κ)` of their error in every iteration, κ their stiffness in `Σ w GᵀG`; of stiff cloth that is nearly all. Cut short, such a cloth hangs in the air. Three remedies stand on the same matrix:
//!
//! - **Chebyshev** (Wang 2015): extrapolation from the iterate before the last, with weights that follow from the largest share ρ. We keep `G` in view: where it would not fall, the
//!   plain iterate is taken and the weights begin anew.
//! - **Quasi-Newton** (Liu et al. 2017): `A⁻¹` is the first guess at the inverse Hessian of `G`, the last few differences of iterates and gradients improve it (L-BFGS), a line search
//!   with Armijo's condition makes sure of the descent. If a direction fails, a plain iteration is taken, which needs no search.
//! - **A coarse grid** under the quasi-Newton iteration: the slow motions are smooth, so a few hundred unknowns on a lattice of hat functions P describe them, and there Newton's method costs next to
//!   nothing. The first guess becomes `A⁻¹ + P V Pᵀ`, V a cycle of [`Multigrid`](cloth_core::multigrid::Multigrid) for `PᵀHP` with the Hessian H (its negative eigenvalues set to zero) at the start of the step's iteration: an additive two-level preconditioner. The matrix is for what is rough, the grid for what is smooth.
//!
//! As the matrix is only a first guess there, it does without the bending of thin cloth: where quadratic hinges add less than a fiftieth to every diagonal entry they are left to the iteration, because a hinge ties four vertices and the factor has less than
//! half as many numbers without (at 128 vertices a side 0.5 million and not 1.3). The plain and the Chebyshev iteration have the whole matrix.
//!
//! A sheet of 1 m × 1 m, 0.2 kg/m², springs of 10⁴ N/m, 128 vertices a side, held at two corners and let go horizontally, falls 0.4989 m (centre of mass) in half a second at Δt = 1/60 s and is stretched by 2.46 % at most, as
//! converged Newton has it. In 10 iterations a step:
//!
//! | | fall (m) | stretch (%) |
//! |---|---|---|
//! | plain, from x̃ | 0.151 | 4.64 |
//! | quasi-Newton | 0.440 | 2.59 |
//! | quasi-Newton with a coarse grid of 12 cells | 0.4986 | 2.40 |
//!
//! When the smooth part is done the grid has done its work: the last digits take as many iterations with it as without, or more.
//!
//! # Contact
//! What the cloth touches is a potential C(x) ([`ContactPotential`](cloth_core::contact::ContactPotential)) that the quasi-Newton iteration has in `G`: its value and gradient are those of `G + C`.
//! Plain iterations become quasi-Newton iterations without pairs there, and Chebyshev's are left out, as extrapolation knows no bounds. Three things are particular.
//!
//! - **The matrix knows who touches.** A is stiff where springs are and soft for smooth motions of the whole sheet (0.2 N/m a vertex against 250 N/m of a contact, with 64 vertices a side),
//!   so a direction that comes from A alone goes through what it touches, is cut off there, and the sheet creeps. The first guess therefore
//!   is `(A + Σ k J Jᵀ)⁻¹` with the contacts of the iterate: conjugate gradients around the factor of A, of which three to six are enough, without a matrix of its own. From the
//!   fourteenth step of the sheet below on, `G` has fallen by 0.28 J after 30 iterations with contact in the guess, by 0.11 J without.
//! - **Each vertex has its own bound.** A way may be cut short because of one contact, and under one length for all vertices that contact holds the whole sheet in
//!   the air. Ways end, vertex by vertex, where something is in the way ([`limit_each`](cloth_core::contact::ContactPotential::limit_each)); where that leads up, one length for all is taken after all. The start `x[0] + Δt v[0]` is cut in the same way.
//! - **An impact takes more iterations**, because what comes into contact was not seen before: [`PdConfig::contact_iterations`] instead of [`PdConfig::iterations`] in a step in which anything pushes, and eight
//!   pairs instead of two. If the end is above `G` at the start of the step all the same, it is taken again from there.
//!
//! So every place that is accepted, and every straight way between two of them, is free of crossings. A sheet with 64 vertices a side (0.2 kg/m², 10⁴ N/m) that falls 5 cm onto a ball of 0.1 m is stretched by
//! 2.3 % at most after 20 steps of 1/60 s, 1.6 % with converged implicit Euler, and no energy appears. Which way the sheet buckles is chance: a hundredth more bending rigidity changes the fall of implicit Euler's by 0.6 % and its
//! stretch to 2.5 %, the fall of projective dynamics by 1.5 %, which differs from implicit Euler's by 2 % (`cloth-bench run` with a scene file: `generator = "grid:64x64:alternating"`, an obstacle `shape = "sphere"`, `radius = 0.1`).
//!
//! # Equations
//! ```text
//! h ← Δt v + Δt² M⁻¹ f_ext,   x̃ = x[0] + h                         S1 (33)
//! q ← 0, Δt v or h; K times:                                       x = x[0] + q
//!     p ← project(G x), every element for itself                   S1 (28)–(31)
//!     g ← M (q − h)/Δt² + Σ w Gᵀ(G x − p)                          ∇G
//!     solve (M/Δt² + Σ w GᵀG) d = g,   q ← q − d                   S1 (32), (34)
//!     (or what an acceleration makes of d)
//! x[1] ← x[0] + q,   v[1] ← q/Δt                                   S1 (35)
//! ```
//!
//! (34) is printed for the increment Δx; with `H = Σ w GᵀG` it is the same equation. Neither positions nor predictions are subtracted, so free fall loses no digits, and a step so long
//! that `M/Δt²` is rounded away ends where the held cloth is at rest. Rows and columns of prescribed vertices drop out.
//!
//! S1 calls the matrix symmetric but not necessarily semi-definite; `Σ w GᵀG` is semi-definite for weights ≥ 0, and M makes A positive definite.
//!
//! | equation | where |
//! |---|---|
//! | G, w, p (CORE-10; S1 (27)–(31)) | [`Projective`](cloth_core::element::Projective) of each element |
//! | `Σ w Gᵀ(G x − p)`, the local step | [`LocalStep`], `pulls.rs`, as streams `planes.rs`, on threads `pieces.rs`; where p is constant, `quadratic.rs` |
//! | `G`, `∇G` | `objective.rs` |
//! | A, S1 (30), (32) | `matrix.rs` |
//! | what quasi-Newton leaves out of it | `matrix.rs` |
//! | its factor, and what changes it | `global.rs`, [`LowRank`](cloth_core::linear::LowRank) |
//! | the solve of S1 (34) | [`PanelFactor::solve`](cloth_core::linear::PanelFactor::solve) |
//! | Chebyshev weights (Wang 2015, algorithm 1) | `chebyshev.rs` |
//! | two-loop recursion (Liu et al. 2017, algorithm 2), line search | `quasi_newton.rs` |
//! | `A + Σ k J Jᵀ` with the contacts | `contact.rs` |
//! | `P V Pᵀ`; H | `lattice.rs`, `coarse.rs`; `local.rs` |
//! | S1 (33), (35) and the loop | [`PdSolver`] |
//!
//! # Iterations
//! The sixteenth step of that sheet, from x̃, until `(G − G*)/(G(x̃) − G*)` is below an error (`cloth-bench study projective`):
//!
//! | vertices a side | | to 10⁻² | to 10⁻⁴ | to 10⁻⁶ |
//! |---|---|---|---|---|
//! | 32 | plain | 21 | 2625 | > 3000 |
//! | | Chebyshev, ρ = 0.9995 | 11 | 107 | 1328 |
//! | | quasi-Newton | 10 | 148 | 1366 |
//! | | with a coarse grid | 3 | 105 | 824 |
//! | 64 | plain | 11 | 2416 | > 3000 |
//! | | Chebyshev | 9 | 104 | 629 |
//! | | quasi-Newton | 6 | 121 | 838 |
//! | | with a coarse grid | 2 | 40 | 513 |
//! | 128 | plain | 11 | 2294 | > 3000 |
//! | | Chebyshev | 9 | 102 | 584 |
//! | | quasi-Newton | 6 | 148 | 633 |
//! | | with a coarse grid | 3 | 35 | 494 |
//!
//! So the convergence of the iterations without a coarse grid does not become slower with the resolution, as is said of the method. It does depend on the stiffness: to 10⁻⁴ at 32 a side, 698 plain iterations at 10² N/m
//! and more than 3000 at 10³ and at 10⁵.
//!
//! Cloth that changes between two steps ([`PdSolver::prescribe`], [`release`](PdSolver::release), [`attach`](PdSolver::attach), [`remove`](PdSolver::remove)) keeps the factor and corrects every solve for the k rows that differ,
//! by the identity of Woodbury. To set that up takes k/3 solves, which cost as much as a factorisation at k = 36 to 51 for 32 to 512 vertices a side; and as it slows down every solve, it is given up for a factorisation when as much has been
//! spent on it. A dragged pin or attachment changes no matrix.
//!
//! # Cost
//! A solve reads the factor twice: with bending 1.29 million numbers at 128 vertices a side, so 20.6 MB, and no solve is faster than the memory gives them. `cloth-bench study projective` has the time of a solve beside that of reading the factor, and beside the linear-algebra library, by size. The local step reads 24 bytes a spring and reads or
//! writes 72 a vertex; `cargo bench -p cloth-bench --bench projective -- "local step"` has its time beside that of a stream of as many bytes: 2.0 to 2.6 times as long with 128 vertices a side,
//! where all is in a cache, 1.0 to 1.3 with 256 and 1.3 to 1.9 with 512. Where the vertices are numbered along rows, as on a grid, the ends of
//! neighbouring springs are neighbours too, and both are read and added to as streams, without an index: x, y and z apart, even vertices apart from odd ones, eight springs side by side. What is left is the square root and the division of each
//! spring (0.7 ns of 1.7 on one thread), the sums, and taking x, y and z apart and together again. Cloth in another order takes the ends one by one.
//!
//! With quadratic bending and n vertices, f numbers in the factor, e springs and b entries in the matrix of the bending energy, an iteration moves `16 f` bytes for the solve, `24 e + 72 n` for the springs, `12 b + 64 n`
//! for the bending, about `200 n` for the rest of the objective, and `96 n` for each pair that is remembered. At 128 a side, with the bending left out of the matrix, that is about 9 MB, 2 MB, 4 MB, 3 MB and, with two pairs, 3 MB. A large factor is cut into subtrees of its elimination tree, which threads can share; the cut does not depend on how many there are. All loops are compiled for wide registers too ([`wide`](cloth_core::parallel::wide)), and give the same bits without.
//!
//! The coarse matrix is summed once a step, element by element: `Pᵀ H P` is never a matrix of the whole cloth first, which would take 0.65 ms of a step of 3.5 ms at 64 a side, and takes 0.36 so.
//! What does not make an iteration faster (AMD EPYC, Zen 4, one thread): the factor in single precision, by which the iteration converges as well; a number has to be widened before it is used, and a solve takes 83 µs instead of 63 at 64 a side,
//! 480 instead of 360 at 128, 3.3 ms instead of 3.0 at 256. Several sums side by side in the products with the bending matrix and with P: additions do not wait for each other as it is. The coarse matrix is needed afresh in every step: kept for two, the kinetic energy
//! of the swing (below) is −74 % instead of −45; taken several times in a step, no better than once.
//!
//! # Example
//! A sheet of 0.2 kg/m² held at two corners:
//! ```
//! use cloth_core::cloth::{Cloth, Membrane};
//! use cloth_core::math::Vec3;
//! use cloth_core::mesh::generate::{Diagonals, grid};
//! use cloth_core::{particles::State, step::{StepInput, Stepper}};
//! use cloth_pd::PdSolver;
//!
//! let mesh = grid(17, 17, 1.0, 1.0, Diagonals::Alternating)?;
//! let membrane = Membrane::SpringStiffness(1e4);
//! let mut model = Cloth { areal_density: 0.2, membrane, bending_rigidity: 1e-5 }.on(&mesh)?;
//! model.particles.prescribe(272)?;
//! model.particles.prescribe(288)?;
//! let mut solver = PdSolver::builder(&model.particles)
//!     .energy(model.springs)
//!     .energy(model.hinges)
//!     .coarse_grid(mesh.positions(), 12)
//!     .build()?;
//!
//! let mut state = State::at_rest(mesh.positions().to_vec());
//! let mut factorizations = 0;
//! for _ in 0..30 {
//!     let input = StepInput::new(1.0 / 60.0).gravity(Vec3::new(0.0, 0.0, -9.81));
//!     factorizations += solver.step(&mut state, input)?.factorizations;
//! }
//! assert_eq!(factorizations, 1);
//! let fall = -state.positions.iter().map(|x| x.z).sum::<f64>() / 289.0;
//! assert!((fall - 0.5).abs() < 0.05, "{fall} m");
//!
//! // Let one corner go: a change of one row, for which nothing is factorised.
//! solver.release(272)?;
//! let input = StepInput::new(1.0 / 60.0).gravity(Vec3::new(0.0, 0.0, -9.81));
//! assert_eq!(solver.step(&mut state, input)?.factorizations, 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! An element that is no squared distance to a set under a constant linear map is refused when compiling. An area is a product of edges, so no such map gives it:
//! ```compile_fail,E0277
//! use cloth_core::{energy::AreaTriangle, math::Vec3, particles::Particles};
//!
//! let particles = Particles::new(vec![1.0; 3]).unwrap();
//! let area = AreaTriangle::new([0, 1, 2], &[Vec3::zeros(), Vec3::x(), Vec3::y()], 1e4);
//! cloth_pd::PdSolver::builder(&particles).energy(vec![area]);
//! // error: `AreaTriangle` is not a squared distance to a set, so projective dynamics cannot take it
//! ```
//!
//! # Limits
//! - The plain iteration converges linearly, and the more slowly the stiffer the cloth. An error of 10⁻² in `G` is soon reached and says little: plain, cut short there, the sheet above hangs in the air. Look at the
//!   fall beside the stretch before choosing a number of iterations.
//! - A fixed number of iterations is an approximation of implicit Euler whose error is not watched. The default (here and below [`PdConfig::default`] with a coarse grid of 12 cells, as `cloth-bench` takes it; the builder lays none by itself) follows the first half second of the hanging sheet closely; over five seconds its swinging dies away sooner than it should. Means over the
//!   last 100 of 300 steps, relative to converged implicit Euler, at 64 a side (`cloth-bench study projective`, which has the same for 32):
//!
//!   | cells, iterations, pairs | kinetic energy (%) | largest stretch (%) | the same at the last step (%) |
//!   |---|---|---|---|
//!   | 8, 6, 5 | −86 | −17 | −32 |
//!   | 12, 10, 2 (default) | −44 | +1 | −22 |
//!   | 16, 18, 2 | −17 | −4 | +1 |
//!
//!   At 32 a side the default has a mean stretch of +8 % and a kinetic energy of −51 %. Rounding alone moves the kinetic energy: with sums in another order, or with the factor in single precision, it is −44 to −52 % for the default at 64 a side
//!   and −12 to −17 % for 16 cells and 18 iterations. For seconds of motion that have to be right take 16 cells, 18 iterations and 2 pairs; a step then takes about 1.7 times as long.
//!
//!   The motion is not chaotic: implicit Euler from a start disturbed by 10⁻³ m ends with the same largest stretch to 1 % (32 a side). One instant still misleads, because a motion with too little energy is at another point of its swing: some settings
//!   happen to be right at the last step and 36 % off on average, and rounding alone moves the last step by a tenth and more: with 10 cells and the springs added up in another order it had −28, −0.5 and −0.2 %. What is missing are folds. A fold moves vertices across the cloth, and others a little along it so that no spring is stretched. The matrix charges the motion across as if springs were stretched, and the hats of a
//!   grid cannot follow the motion along: a grid of half the resolution of the cloth does no better, one as fine as the cloth is Newton's method, for which three iterations are enough. So folds go on with the velocity that they have, and what should have bent is
//!   compressed (11 times the elastic energy with the default, at 64 a side).
//!
//!   None of these helps, at 32 or 64 a side: a start extrapolated with the last change of velocity; pairs kept from the step before, as they are (the steps then need line searches) or with their changes of gradient taken anew; hats that are
//!   quadratic or cubic splines; stiffness summed up over whole cells; blocks of the Hessian's diagonal as a third part of the first guess, on the vertices and on finer grids, which moves vertices out of the cloth so far that the springs, which then
//!   stretch, take the energy away. A valley of `G` along which the cloth bends is narrow and curved.
//! - It is the same with a chain of 20 links, swinging: with 6 iterations its centre of mass is right to 0.1 % after half a second, but has fallen 3 % too little after five; with 8 iterations it is right to 0.2 % then.
//! - No energy appears in a step from `x[0]`, nor in a quasi-Newton step from `x[0] + Δt v[0]`: one that ends above `G(x[0])` is taken again, which the hanging sheet never needs. Plain and Chebyshev iterations from there, and all from x̃, have no such guard; ended early they can feed a
//!   tangle. With the default a cloth of 10³ N/m, damped, hangs in the end from any start (in a point, on a line, mirrored, random, blown up), forces balanced.
//! - The coarse grid needs rest positions, and is good for cloth that bends smoothly at its scale. It changes how fast the iteration converges, never to what; and not always for the better: at 10⁵ N/m, from x̃, the
//!   first 10⁻² takes 32 iterations with it and 7 without any acceleration.
//! - Where it converges to is a stationary point of `G`, the solution of implicit Euler, with the numerical damping of that. Where `G` has several (compressed cloth), which of them depends on the path.
//! - Linear momentum of a free cloth is conserved in every iteration, to rounding, with each acceleration: what nothing holds starts with the right momentum, and every direction keeps it. The start at `x[0]` gains it with the first full step. Angular momentum is not: implicit Euler does not conserve it, and an iteration cut short less so.
//! - Only energies of the form above. Springs, hinges flat or curved at rest, as-rigid-as-possible triangles, strain limits and attachments have it; an energy with a varying stiffness does not.
//! - Another Δt costs a factorisation, which the report counts; other masses or new elements need another solver.
//! - A matrix that has lost all but a few digits of a pivot (a cloth that nothing holds, with `k Δt²/m` above some 10¹²) is reported as
//!   [`NotPositiveDefinite`](cloth_core::step::StepError::NotPositiveDefinite), and not used.
//! - The residual compares with `‖∇G(x̃)‖`. Where that is rounding alone, as for a cloth in free fall, no tolerance is met and all iterations are spent, without harm.
//!
//! # When to use it
//! For many steps with one mesh and one step size on a processor: an iteration costs two passes over a small factor, none can make matters worse, and no step size is too large. With the default
//! a step of the sheet above takes, at 64 a side, about a seventh of the time of converged implicit Euler around
//! multigrid, for a fall within 0.1 % and a stretch within 3 % after half a second;
//! what to take for longer motion is said above. Where the motion has to be right to the last digits, Newton's method gets there in a dozen iterations. Where the material is replaced
//! altogether between steps, the position-based methods have no matrix to factorise. Quadratic energies (bending of a flat sheet, attachments) are solved exactly by one iteration.
//!
//! # When not to use it
//! Where seconds of motion have to look right, take a step of implicit Euler that is cut short: three Newton
//! iterations with the clamped Hessian, each of at most five conjugate gradients around a multigrid cycle, from
//! `x[0] + Δt v[0]`. Five seconds of the sheet, relative to converged implicit Euler; means over the last 100 of 300 steps,
//! `elastic` at the last, processor time of a run on one thread, setting up included, in milliseconds a step (AMD EPYC,
//! Zen 4; other programs ran beside it, so that only ratios count):
//!
//! | n | | kinetic energy | largest stretch, mean | at the end | elastic | ms |
//! |---|---|---|---|---|---|---|
//! | 64 | default | −44 % | +1 % | −22 % | × 10 | 3.7 |
//! | | 18 iterations, 16 cells | −17 % | −4 % | +1 % | × 3.9 | 5.9 |
//! | | three Newton iterations of 5 | −3.4 % | +0.6 % | −3.3 % | × 0.94 | 10 |
//! | 128 | default | −43 % | −2 % | −14 % | × 15 | 25 |
//! | | 18 iterations, 16 cells | −8 % | −1.2 % | +10 % | × 4.9 | 42 |
//! | | three Newton iterations of 5 | −3.0 % | +1.3 % | −11 % | × 0.83 | 72 |
//!
//! (`cloth-bench run hang --n 64 --steps 300 --json --method pd --set iterations=18 --set coarse=16`, and `--method
//! implicit-euler --set linear=newton-multigrid --set iterations=3 --set linear_iterations=5 --set start=inertial`;
//! `cloth-bench study projective` has the means for 64.) At both sizes projective dynamics is 1.6 times as fast or more than any
//! setting of implicit Euler that was tried and keeps most of the swing. Its error does not
//! become small, though: for 1.7 times the time of its best setting the energy is right and the folds
//! are bent rather than compressed.
//!
//! Not every way to cut a step short is good. The quasi-Newton iteration of `implicit-euler` loses 90 % of the kinetic
//! energy with five iterations a step at 64 a side, 72 % with ten, and 0.2 % with twenty. A start with an extrapolated
//! velocity suits iterations that converge: cut short, it loses 20 % with three Newton iterations of five, and five
//! quasi-Newton iterations blow up.
//!
//! # References
//! - S. Bouaziz, S. Martin, T. Liu, L. Kavan, M. Pauly, "Projective dynamics: fusing constraint projections for fast simulation",
//!   ACM Trans. Graph. 33(4), 154, 2014, <https://doi.org/10.1145/2601097.2601116>.
//! - T. Liu, A. W. Bargteil, J. F. O'Brien, L. Kavan, "Fast simulation of mass-spring systems", ACM Trans. Graph. 32(6), 214, 2013,
//!   <https://doi.org/10.1145/2508363.2508406>.
//! - H. Wang, "A Chebyshev semi-iterative approach for accelerating projective and position-based dynamics", ACM Trans. Graph. 34(6), 246, 2015,
//!   <https://doi.org/10.1145/2816795.2818063>.
//! - T. Liu, S. Bouaziz, L. Kavan, "Quasi-Newton methods for real-time simulation of hyperelastic materials", ACM Trans. Graph. 36(3), 23, 2017,
//!   <https://doi.org/10.1145/2990496>.
//! - J. H. Bramble, J. E. Pasciak, J. Xu, "Parallel multilevel preconditioners", Math. Comp. 55, 1990, <https://doi.org/10.1090/S0025-5718-1990-1023042-6>: sums of corrections on several grids.
//! - L. Wu, B. Wu, Y. Yang, H. Wang, "A safe and fast repulsion method for GPU-based cloth self collisions", ACM Trans. Graph. 40(1), 2020, <https://doi.org/10.1145/3430025>: bounds of their own for vertices.
//! - A. H. Chen, J. Hsu, Z. Liu, M. Macklin, Y. Yang, C. Yuksel, "Offset geometric contact", ACM Trans. Graph. 44(4), 2025, <https://doi.org/10.1145/3731205>: the same, in a solver.
//! - W. W. Hager, "Updating the inverse of a matrix", SIAM Review 31, 1989, <https://doi.org/10.1137/1031049>.
#![forbid(unsafe_code)]

mod change;
mod chebyshev;
mod coarse;
mod config;
mod contact;
mod free_pieces;
mod global;
mod lattice;
mod local;
mod matrix;
mod objective;
mod pieces;
mod pin_work;
mod planes;
mod pulls;
mod quadratic;
mod quasi_newton;
mod solver;

pub use change::{AttachmentId, ChangeError};
pub use config::{Acceleration, PdConfig, Start};
pub use local::LocalStep;
pub use solver::{PdBuilder, PdSolver};
