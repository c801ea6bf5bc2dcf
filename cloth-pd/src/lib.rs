//! Projective dynamics: implicit Euler by alternating local projections and one global solve with a constant matrix.
//!
//! # Example
//! A sheet of 0.2 kg/m² held at two corners. These are *prescribed* (pinned): such a vertex moves with the velocity
//! that it is given, whatever the forces on it.
//! ```
//! use cloth_pd::cloth_core::{cloth::{Cloth, Membrane}, mesh::generate::{Diagonals, grid}};
//! use cloth_pd::{PdSolver, State, StepInput, Stepper, Vec3};
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
//!
//! Meshes, materials and measures are in [`cloth_core`], re-exported here.
//!
//! # Idea
//! Implicit Euler is `x[1] = x[0] + Δt v[1]` with `v[1] = v[0] + Δt M⁻¹ (f_ext − ∇E(x[1]))`. The second put into the
//! first gives `M (x[1] − x̃)/Δt² = −∇E(x[1])` with `x̃ = x[0] + Δt v[0] + Δt² M⁻¹ f_ext`, the condition `∇G = 0` of a
//! minimisation (f_ext, the weight and `StepInput::load`, is constant in the step):
//!
//! `G(x) = ‖x − x̃‖²_M/(2Δt²) + E(x)`, `‖y‖²_M = yᵀ M y`.
//!
//! Newton's method needs a new matrix in every iteration for that, because the Hessian of a spring turns with the
//! spring. Projective dynamics writes the energy of an element as the squared distance from `z = S x` to a set of
//! zero-energy configurations instead (S is the element's constant linear map, for a spring the difference of its ends;
//! in Bouaziz's `½ w ‖AᵢSᵢx − Bᵢpᵢ‖²` our S is `AᵢSᵢ` and our p is `Bᵢpᵢ`),
//!
//! `E(x) = min over p in the set of ½ w ‖S x − p‖²`,
//!
//! and all that is not linear sits in p. So a step is a minimisation over x *and* all p, alternately (block coordinate
//! descent; for springs Liu et al. 2013, in general Bouaziz et al. 2014). The *local* step holds x: each element alone
//! projects z to its nearest p, a spring to the vector of its rest length in its present direction. The *global* step
//! holds all p: what is left is quadratic in x, and its minimum solves
//!
//! `A x = M x̃/Δt² + Σ w Sᵀ p`,  `A = M/Δt² + Σ w SᵀS`.
//!
//! No position occurs in A. It depends on the mesh, the weights, the masses, the prescribed vertices and Δt
//! (`change.rs` has what makes its factor stale). S multiplies a vertex by one number, whatever the axis, so A acts on
//! x, y and z alike and has a row per vertex and not three; it is factorised once, and an iteration costs the
//! projections and one solve with the factor.
//!
//! The weight w is the stiffness of the material and no parameter of the method: k (N/m) where z is a length; rest area
//! times the membrane modulus Y (N/m) for a triangle and volume times 2μ (Pa) for a tetrahedron, so J, as F has no
//! dimension; the bending rigidity D (N m) over an area, so N/m, for a hinge. It says what the step converges to, the
//! same minimum that Newton's method finds; the number of iterations only says how near.
//!
//! A solid sheet of thickness t and Young's modulus E_s has Y = E_s t and D = E_s t³/(12 (1 − ν²))
//! ([`cloth_core::cloth`] has woven cloth). Poisson's ratio ν is fixed. The triangle stores ½ Y ‖F − U Vᵀ‖² per area:
//! Lamé parameters μ = Y/2 and λ = 0, so modulus Y and ν = 0. Equal springs on the alternating grid of spacing l have
//! 1/3. For a strain ε a spring of length L along the unit vector n stores `½ k (L nᵀε n)²`, and a cell of area l² has
//! one along either axis and one diagonal, of which half go either way; so per area
//! `½ k (ε₁₁² + ε₂₂² + ½ (ε₁₁ + ε₂₂)² + 2 ε₁₂²)`. That is a sheet with C₁₁ = 3k/2, C₁₂ = k/2 and a shear modulus k/2,
//! which is (C₁₁ − C₁₂)/2, so isotropic, with ν = C₁₂/C₁₁ = 1/3 and Y = C₁₁ (1 − ν²) = 4k/3. For a wanted Y take k =
//! 3Y/4, whatever l, and half of it on the boundary, as [`Membrane::Modulus`](cloth_core::cloth::Membrane::Modulus)
//! does.
//!
//! | element | z = S x | its nearest p | w |
//! |---|---|---|---|
//! | spring ([`Spring`]) | x₀ − x₁ | L z/‖z‖ | k |
//! | its limit ([`StrainLimitSpring`](cloth_core::energy::StrainLimitSpring)) | x₀ − x₁ | clamp(‖z‖) z/‖z‖ | k |
//! | triangle, as rigid as possible ([`ArapTriangle`](cloth_core::energy::ArapTriangle)) | F = Σ xᵢ bᵢᵀ, 3 × 2 | U Vᵀ of F = U Σ Vᵀ | area · Y |
//! | tetrahedron, as rigid as possible ([`ArapTetrahedron`](cloth_core::energy::ArapTetrahedron)) | F, 3 × 3 | U Vᵀ, a rotation: σ₃ < 0 where det F < 0 | volume · 2μ |
//! | triangle limit ([`StrainLimitTriangle`](cloth_core::energy::StrainLimitTriangle)) | F | U clamp(Σ) Vᵀ | area · Y |
//! | isometric bending, flat at rest ([`CurvatureHinge`](cloth_core::energy::CurvatureHinge)) | Σ qᵢ xᵢ | 0: A alone solves it | D/(A₀ + A₁) |
//! | hinge, curved at rest ([`CurvedHinge`](cloth_core::energy::CurvedHinge)) | Σ qᵢ xᵢ | r z/‖z‖ | D/(A₀ + A₁) |
//! | stitch ([`Stitch`](cloth_core::energy::Stitch)), its rest length falls to 0 | Σ qᵢ xᵢ | L(t) z/‖z‖ | k |
//! | attachment ([`Attachment`](cloth_core::energy::Attachment)), soft pin ([`SoftPin`](cloth_core::energy::SoftPin)) | x | its target | k |
//!
//! p is unique and continuous in z where z ≠ 0 (spring and its limit, stitch, curved hinge), where F has rank 2
//! (triangle and its limit), where σ₂ + σ₃ > 0 (tetrahedron), and everywhere for a set of one point and for a strain
//! limit without a lower end (0), whose set is convex. Elsewhere p jumps, and any of the nearest will do: E itself is
//! continuous, and the bound from above, `G(x⁺) ≤ Q(x⁺)` of `objective.rs`, holds for each of them. `local.rs` has why
//! U clamp(Σ) Vᵀ is nearest, the singular values in closed form, their signs, and the eigenvalues of I − ∂p/∂z. The bᵢ
//! (1/m) are the gradients of hat functions on the triangle at rest, X₀ X₁ X₂ in its plane: b₁ᵀ and b₂ᵀ are the rows of
//! `[X₁ − X₀, X₂ − X₀]⁻¹` (2 × 2), and b₀ = −b₁ − b₂.
//!
//! With the edge x₀ x₁, the tips x₂ and x₃, and the angles at rest α₀, α₁ of the first triangle and α₂, α₃ of the other
//! at x₀ and x₁, a hinge has `q = (cot α₁ + cot α₃, cot α₀ + cot α₂, −(cot α₀ + cot α₁), −(cot α₂ + cot α₃))`, so that
//! ‖Σ qᵢ xᵢ‖ = 2 e sin(θ/2) of its edge of length e and its fold θ without stretch (`local.rs` derives q and w). On
//! equilateral triangles a cylinder of curvature κ stores ½ D κ² per area, and on the alternating grid along its lines;
//! 1½ times that along its diagonals. As q is constant and p = 0, the energy is quadratic, and its Hessian w qᵀq
//! constant. A stretched fold feels the stretch too. A hinge curved at rest compares lengths only, so a fold by its
//! rest angle to the wrong side costs nothing either.
//!
//! Both steps minimise, so `G` falls in every iteration with the whole matrix, from any start, without a line search:
//! the frozen p bound the energy from above and touch it at x (majorise and minimise; `objective.rs` has by how much,
//! and what breaks the bound). For the same reason the gradient needs no derivative of the projection, no singular
//! value decomposition is differentiated: p is a minimum of ½ w ‖S x − p‖², so its change with x adds nothing to first
//! order (the envelope theorem), and
//!
//! `∇E = Σ w Sᵀ(S x − p)`,  `∇²E = Σ w Sᵀ(I − ∂p/∂z) S`.
//!
//! A has I in the place of I − ∂p/∂z. With A x subtracted on both sides the global step is `A (x⁺ − x) = −∇G(x)`:
//! Newton's method with A for the Hessian and steps of length 1 (Liu et al. 2017). A is never below the Hessian, as
//! ∂p/∂z has no negative eigenvalue (proof in `local.rs`).
//!
//! # What the constant matrix loses, and how it is won back
//! *The hanging sheet* of this page: 1 m × 1 m, 0.2 kg/m², springs of 10⁴ N/m, held at two corners and let go
//! horizontally, in steps of 1/60 s.
//!
//! A is as stiff across a spring as along it, but across a spring near its rest length there is only k (1 − L/‖z‖).
//! Near the minimum an iteration turns the error e into `e⁺ = (I − A⁻¹ ∇²G) e`. Take a wave on the alternating grid, of
//! wave number ξ, long beside the spacing l. Along whatever axis it moves, A has `m/Δt² + κ` for it, `κ = 2 k (ξ l)²` a
//! vertex. *In the plane* it stretches springs: in the place of κ ∇²G has `C₁₁ (ξ l)² = ¾ κ` if it is longitudinal and
//! `½ k (ξ l)² = ¼ κ` in shear. So an iteration leaves at most a quarter of its error, or three quarters, and a digit
//! takes two iterations, or eight. (Of triangles, with `κ = Y (ξ l)²`, ∇²G has all of κ, or half.) *Across the plane*
//! it turns springs without stretching them, as falling and folding do: ∇²G has little more than `m/Δt²`. Of an error
//! of that kind an iteration leaves the fraction `1 − (m/Δt²)/(m/Δt² + κ) = κ/(m/Δt² + κ)`. With `m = m_A l²` for a
//! mass m_A per area `κ Δt²/m = 2 k ξ² Δt²/m_A`, so a decimal digit of e takes about `ln 10 (1 + 2 k ξ² Δt²/m_A)`
//! iterations, and one of `G − G*`, which is quadratic in e, half as many.
//!
//! - *Of one wave* the fraction does not depend on l: for the hanging sheet 0.9991 at a wavelength 2π/ξ of 1 m, 0.9995
//!   at 0.74 m.
//! - *Shorter waves are slower*, 0.99999 at 0.1 m, and a finer mesh has shorter ones.
//! - *But the longer ones are larger.* In the sixteenth step of the hanging sheet (springs alone, 64 a side, from x̃)
//!   99 % of ‖e‖²_M after 30 plain iterations lies in the hat functions of a grid of 12 cells.
//!
//! So few iterations leave two errors: folds are missing ([limits](#limits)), and the sheet falls too slowly. *Why:*
//! with p held the cloth is a net whose springs resist turning as they resist stretch. A smooth displacement d under a
//! force f per area has `m_A d/Δt² − 2 k ∇²d = f` there, so a pull is felt over a length of √(2k/m_A) Δt, 5.3 m for the
//! hanging sheet. At x̃ the pins stretch their springs, and so the first global steps lift the whole sheet. For what
//! only turns springs a mass m is then m + κ Δt²: j iterations take back 1 − 0.9991ʲ of such an error of wavelength
//! 1 m, ten of them 1 %. So the stiffer the cloth, the more it looks locked. (Locking of the mesh is another matter, as
//! the minimum has it too: [`cloth_core::dof`].) Three accelerations use the same matrix:
//!
//! - **Chebyshev** (Wang 2015): extrapolation from the iterate before the last, with weights that follow from a number
//!   ρ, in theory the plain iteration's spectral radius (`chebyshev.rs`). The 0.9995 of the [table](#iterations) is
//!   chosen below it: waves shorter than 0.74 m are slower, but small. If `G` would rise, the plain iterate is taken.
//! - **Quasi-Newton** (Liu et al. 2017): `A⁻¹` is the initial inverse Hessian of `G`, the last few differences of
//!   iterates and gradients (the *pairs* s, y) improve it (L-BFGS), a line search asks for a fall of `G` (Armijo's
//!   condition). If a direction fails, a plain iteration is taken; with bending left out of A, or in air, the last
//!   length that was tried along it, even if `G` rose (`quasi_newton.rs`). (Not offered: Anderson acceleration, Peng et
//!   al. 2018, which combines the last iterates likewise.)
//! - **A coarse grid**, an additive two-level preconditioner of Schwarz type (Nicolaides 1987, Dryja and Widlund 1987;
//!   for cloth on many levels Wu et al. 2022; in projective dynamics, with a subspace in the place of the grid, Lan et
//!   al. 2024). The large slow motions are smooth: a few hundred unknowns on a lattice of trilinear hat functions
//!   describe them, for which a Newton step is cheap. P is the prolongation, Pᵀ the restriction, and `PᵀHP` the
//!   Galerkin coarse operator. H is the Hessian where the iteration starts, of the elements that A has; of each
//!   I − ∂p/∂z the absolute eigenvalues are taken, at most 1 (`local.rs`). The initial inverse Hessian becomes
//!   `A⁻¹ + P V Pᵀ`, V a cycle of [`Multigrid`](cloth_core::method::multigrid::Multigrid) for `PᵀHP`. A reduces what
//!   stretches springs, the grid the smooth part of what turns them. Rough folds neither reduces; they are left to the
//!   pairs. Smooth stretching both reduce, so it is corrected up to twice: pairs and line search mend that.
//!
//! As the matrix only preconditions there, the bending of thin cloth is left out of it: where quadratic hinges add less
//! than a fiftieth to every diagonal entry they are left to the iteration, because a hinge ties four vertices and the
//! factor has less than half as many numbers without (at 128 vertices a side 0.5 million and not 1.3). The plain and
//! the Chebyshev iteration have the whole matrix.
//!
//! The hanging sheet, with 128 vertices a side, falls 0.4989 m (centre of mass) in half a second and is stretched by
//! 2.46 % at most, as converged Newton has it. In 10 iterations a step:
//!
//! | | fall (m) | stretch (%) |
//! |---|---|---|
//! | plain, from x̃ | 0.151 | 4.64 |
//! | quasi-Newton | 0.440 | 2.59 |
//! | quasi-Newton with a coarse grid of 12 cells | 0.4988 | 2.41 |
//!
//! Truncation looks like damping (the fall) and, without the grid, like softness (the stretch) at once. Once the smooth
//! part of the error is gone the grid helps no more: the last digits take as many iterations as without it, or more.
//! The largest stretch is that of one mesh: a spring of length l at a point pin carries a force F whatever l, so its
//! strain F/(k l) doubles where l is halved.
//!
//! # Equations
//! The step as a list is at [`PdSolver`], as loops over arrays in `examples/first_program.rs`. The code iterates on the
//! displacement `q = x − x[0]` (not the qᵢ of a hinge), with `u = x̃ − x[0] = Δt v[0] + Δt² M⁻¹ f_ext`:
//! `g = M (q − u)/Δt² + Σ w Sᵀ(S x − p)`, `A d = g`, `q ← q − d`, and `v[1] = q/Δt` at the end. Inertia subtracts
//! displacements and not positions, so free fall loses no digits, and where a long step rounds `M/Δt²` away, held cloth
//! ends at rest. A prescribed vertex has q = u from the start, so its increment d is 0: its row and column are left out
//! (in the code those of the identity, so that a release keeps the pattern), and what it does to its neighbours is in
//! g. `Σ w SᵀS` is positive semi-definite for weights ≥ 0; M makes A positive definite.
//!
//! | equation | where |
//! |---|---|
//! | S, w, p | [`Projective`](cloth_core::element::Projective) of each element |
//! | the local step of one family (all elements of one `.energy()` call) | [`LocalStep`], `local.rs` |
//! | on threads, in batches, over structure-of-arrays buffers | `vertex_blocks.rs`, `batch.rs`, `deinterleaved.rs` |
//! | the same where p is constant: a matrix | `quadratic.rs` |
//! | `G`, `∇G` | `objective.rs` |
//! | A = M/Δt² + Σ w SᵀS, and what quasi-Newton leaves out of it | `matrix.rs` |
//! | its factor, and what changes it | `global.rs`, [`WoodburyUpdate`] |
//! | the global step, A d = g (in `quasi_newton.rs`, `hessian.rs` d is the direction, −A⁻¹g) | [`PanelFactor::solve`] |
//! | Chebyshev weights (Wang 2015, algorithm 1) | `chebyshev.rs` |
//! | L-BFGS (Liu et al. 2017, algorithm 2), line search | `quasi_newton.rs`, [`LimitedMemory`](cloth_core::method::limited_memory::LimitedMemory) |
//! | `H + Σ k J Jᵀ` with active contacts, H of all elements; `A + Σ k J Jᵀ` | `hessian.rs`; `contact.rs` |
//! | `P V Pᵀ`; H of the elements that A has | `lattice.rs`, `coarse.rs`; `local.rs` |
//! | u = `(v + a * dt) * dt` (in `begin`) and, with it, x̃ | `objective.rs` |
//! | the loop, the velocities | [`PdSolver`], `solver.rs` |
//!
//! `examples/first_program.rs` is the plain iteration from x̃, for x itself, as loops over arrays with a dense matrix;
//! 30 steps end within 10⁻¹² m of those of [`PdSolver`]. In the crate the formula of one element stands in `batch.rs`,
//! at `ProjectionBatch::find_one_by_one` (z, p, gradient `w (z − p)`, energy `½ w ‖z − p‖²`), and the other files of
//! the local step compute the same for many elements at once, to 10⁻¹⁴ of the largest force (`tests/chapter/local.rs`).
//!
//! # Iterations
//! The sixteenth step of the hanging sheet, from x̃, until `(G − G*)/(G(x̃) − G*)`, the relative error of `G`, is below
//! a bound (`cargo run --release -p cloth-bench -- study projective`; all of that up to `--` is meant by `cloth-bench`
//! below):
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
//! Without a coarse grid, too, the number of iterations does not grow with the resolution, contrary to what is often
//! said: the long waves, which have most of ‖e‖²_M, are the same on each mesh, with the same factor. It does depend on
//! the stiffness: to 10⁻⁴ at 32 a side plain iterations take 698 at 10² N/m, 2625 at 10⁴, and more than 3000 at 10⁵. It
//! does not grow in proportion to k, as that of one wave does, because the count is that of the slowest wave which
//! still holds error. From 10⁻² to 10⁻⁴, so for one digit of e, the table has 2283 to 2604 plain iterations; a wave of
//! 1 m takes 2530 by [the formula](#what-the-constant-matrix-loses-and-how-it-is-won-back). At 10² N/m it takes 28, and
//! one of 0.19 m 702, near the 698 counted.
//!
//! # Cost
//! Memory decides the time of an iteration. At 128 vertices a side, with the bending left out of the matrix, it moves
//! about 9 MB for the solve (`panel.rs`), 2 MB for springs, 3 MB for bending (`quadratic.rs`), 3 MB for the rest of the
//! objective and, with two pairs, 5 MB for L-BFGS (`cargo bench -p benches --bench projective` has the times). The
//! factor is Cholesky's, ordered by minimum degree or nested dissection, whichever takes less work; `global.rs` has its
//! fill, what factorising costs in solves, and where memory ends. A large factor is cut into subtrees of its
//! elimination tree, which threads can solve side by side. All loops are compiled for wide registers too
//! ([`wide`](cloth_core::method::parallel::wide)), and give the same bits without.
//!
//! # Pin and drag
//! To drag, call [`PdSolver::prescribe`]: changing your `Particles` does nothing, the solver has a copy. Before every
//! step set the velocity of the vertex to `(goal − x)/Δt`: a prescribed vertex goes on with the one that it has.
//! [`Pins::set_velocities`](cloth_core::Pins::set_velocities) does so for paths. Softly: [`attach`](PdSolver::attach)
//! once, then [`move_attachment`](PdSolver::move_attachment). A load f holds an attached vertex f/k away from its
//! target: with k a hundred times the stiffness of its springs, by a hundredth of what they are stretched. The work of
//! prescribed vertices in a step is in [`StepReport::pin_work`](cloth_core::step::StepReport::pin_work) (J), if one
//! moves; [`StepInput::pin_forces`](cloth_core::StepInput::pin_forces) asks for the forces there.
//!
//! Cloth that changes between two steps ([`PdSolver::prescribe`], [`release`](PdSolver::release),
//! [`attach`](PdSolver::attach), [`remove`](PdSolver::remove)) keeps the factor and corrects every solve by the
//! identity of Woodbury, of rank r: 1 for a vertex that is grabbed and for an attachment, 2 for one that is released, a
//! row of S each for an element that is removed. That takes r/3 solves and some r³ ns to set up, and slows down every
//! solve, until as much has been spent as a factorisation costs, which is then made (`global.rs` has from which r on at
//! once). A dragged pin or attachment changes no matrix; a pin or an element that comes or goes takes a coarse grid
//! anew.
//!
//! # Contact
//! What the cloth touches is a potential C(x) ([`ContactPotential`](cloth_core::contact::ContactPotential)) that the
//! quasi-Newton iteration has in `G`: its value and gradient are those of `G + C`. The crate `cloth-collide` has it:
//! `PotentialContacts::builder(&mesh).obstacle(body, μ).friction(μ).build()?` once, then `.contacts(&mut contacts)` on
//! every `StepInput`. `obstacle` takes the friction on a body, `friction` that of cloth on cloth, and self-collision is
//! on unless `.self_collision(false)`. The normal part is a sum of a ψ(d) over the primitives that are near each other:
//! d (m) is their distance and a the area that they stand for. With the thickness h and the stiffness κ_c of contact
//! (the builder's `.thickness(h)` and `.stiffness(κ_c)`, 1 mm and 10⁶ Pa/m by default), ψ, ψ′ and ψ″ continuous at h/2,
//! ```text
//! ψ = ½ κ_c (h − d)²                from h down to h/2; nothing beyond h
//! ψ = ¼ κ_c h² (½ − ln(2d/h))       below h/2: a barrier, infinite at d = 0
//! ```
//! Under a pressure P = −ψ′(d) the gap is d = h − P/κ_c up to P = κ_c h/2 (500 Pa by default) and κ_c h²/(4P) beyond
//! that, never 0: the weight of 0.2 kg/m² takes 2 µm of the default h. Two edges have h/2 in the place of h, and their
//! full distance d: they push only where vertices do not keep the cloth farther apart, so pairs are far fewer.
//!
//! Friction is in C with the normal forces λ and planes of the start of the step (lagged, Li et al. 2020): μ λ f(‖u‖)
//! of the displacement u in the plane, where f′ rises linearly to 1 at ‖u‖ = ε, a hundredth of the thickness, and stays
//! there. So Coulomb's cone holds for the λ of the start, not for that of the end. In a step with contact quasi-Newton
//! iterations without pairs take the place of plain and Chebyshev ones: these go on without a look at `G`, or
//! extrapolate a displacement that contact has bounded. `contact.rs` has the order of an iteration, friction, and
//! another way (Ly et al. 2020).
//!
//! - **Another matrix** (`hessian.rs`). A is as stiff across a spring as along it, which is how cloth moves on what it
//!   touches: so few iterations with A, pairs or not, leave forces out of balance. With active contacts L-BFGS is
//!   around a multigrid cycle for `H + Σ k J Jᵀ`. H is the Hessian of inertia and all elements at the iterate, with
//!   absolute eigenvalues, J the derivative of a distance by the vertices and k ≥ 0 the second derivative of its energy
//!   ([`ContactRow`](cloth_core::contact::ContactRow)), among them the volume of a closed surface
//!   ([`ClosedVolume`](cloth_core::enclosure::ClosedVolume)); nearly closed pairs get a second-order correction. Where
//!   contact has cut five steps short, conjugate gradients around the cycle solve for the direction.
//! - **A vertex may have a displacement bound of its own.** All follow the direction up to the first contact; where
//!   that is next to nothing, a single contact would stop the whole sheet. Displacements are then truncated vertex by
//!   vertex (as by Wu et al. 2020 and Chen et al. 2025, but by continuous collision detection: `contact.rs`;
//!   [`limit_each`](cloth_core::contact::ContactPotential::limit_each)), as on the way to the start (`solver/start.rs`).
//! - **A trust radius bounds each direction**, since it does not account for contacts that are not active yet
//!   (`in_contact.rs`). Without it a handkerchief on the corner of a table gained energy that nothing gave it.
//!   A step begins in the folds that the last one has made ([`StartGuess::Extrapolated`]).
//! - **A step goes on until it is near enough**, as it does without contact: until forces balance (`‖∇G‖` at 10⁻⁵ of
//!   `‖M (x − x̃)/Δt²‖`), until the Newton decrement meets the tolerance ([`PdConfig::velocity_tolerance`] has the
//!   table), or up to [`PdConfig::most_iterations`]. If the step ends above `G` at the start all the same, it is
//!   taken again from there. The ends that turn a towel twice each (`cloth-bench run cloth-bench/scenes/twist.toml`,
//!   `energy_given`) give it 0.03 J with implicit Euler and here, with ten iterations a step more than 0.2 J.
//!
//! So every accepted iterate, and the straight path from one to the next, is free of intersections. A sheet with 64
//! vertices a side that falls onto a ball (`cloth-bench/scenes/ball.toml`) is stretched by 2 to 3 % at most after 20
//! steps, 1.9 % with implicit Euler, and no energy appears.
//!
//! # Strain limits
//! [`StrainLimitSpring`](cloth_core::energy::StrainLimitSpring) and
//! [`StrainLimitTriangle`](cloth_core::energy::StrainLimitTriangle) are elements like others: their set is the shell
//! between the least and the largest length (or singular value), and the projection clamps. They are soft limits, a
//! load f stretches a spring by f/k beyond its limit, and their weight enters A even while they are inactive, so high
//! weights slow the plain iteration down. Hard limits are a projection after the step, of any method, as
//! `WithStrainLimit` of the crate `cloth-pbd` does it.
//!
//! # Errors and bad input
//! - **Building** is refused with a [`BuildError`]: `OutOfRange` (no iterations, a spectral radius outside [0, 1), a
//!   weight that is negative or not finite, rest positions of the coarse grid that do not match), `NoSuchVertex`,
//!   `RepeatedVertex`, `UnsupportedElements`, or `MatrixTooLarge` (more entries than 32 bits count, or no memory to
//!   factorise in). `energy` never fails; its error is kept for `build`.
//! - **A step** is refused with a [`StepError`]: `InvalidTimeStep` if Δt is not positive and finite, `NonFiniteInput`
//!   or `NonFinite` if an input or the result is not finite (the vertex is named), `NotPositiveDefinite` if A is not to
//!   working precision, `Contact` if contact cannot be resolved. The state is then what it was before the step.
//! - **A change** between two steps is refused with a [`ChangeError`], and nothing has changed.
//! - **A state of the wrong length** is a bug of the caller and panics.
//! - **Degenerate elements are no error.** A spring whose ends coincide projects to a direction that its vertex numbers
//!   give, so a cloth collapsed to a point unfolds; a triangle collapsed to a line or a point has singular vectors
//!   chosen for it. A triangle without rest area has no weight, and is left out.
//! - **Of an element vertices, weight, and that its numbers are numbers are checked.** A hinge made by hand whose A₀ + A₁
//!   is 0 has no finite weight, and one area of 0 no finite coefficients: both are refused. A spring made by hand with L < 0 is taken: its p is the farthest point of a sphere and not the nearest,
//!   so it has the forces of ½ k (‖z‖ − L)², and the bound of `objective.rs` does not hold.
//! - **Cloth that no pin holds is no error**, nor is a part of it: it falls, with its momentum kept (`components.rs`).
//! - **No convergence is no error.** A step is [`Converged`](cloth_core::step::Outcome::Converged)
//!   - by default (neither `iterations` nor `tolerance` given) where the Newton decrement meets
//!     [`PdConfig::velocity_tolerance`], which has how near that is, and where the cloth flies freely;
//!   - with a [`PdConfig::tolerance`] where the residual, which is then in the report, meets it;
//!   - without one, where forces in contact balance to 10⁻⁵ (10⁻⁸ with a given number of iterations);
//!   - where nothing can move.
//!
//!   Else it is [`BudgetSpent`](cloth_core::step::Outcome::BudgetSpent): after a given number of iterations, after a
//!   failed line search in contact, and at `most_iterations`, which counts as
//!   [`unfinished`](cloth_core::step::StepReport::unfinished).
//!
//! # Threads
//! With the feature `parallel` (default) the vertices are cut into blocks of consecutive numbers. Each block adds to
//! its own vertices only (owner computes), so no colouring is needed; an element on a border is computed twice
//! (`vertex_blocks.rs`). A family of fewer than 32 768 elements stays on one thread. The solve runs over independent
//! subtrees of the elimination tree. Blocks and subtrees depend on the mesh alone, so results have the same bits on any
//! number of threads (`threads_do_not_change_a_bit` in `tests/chapter/step.rs` for each acceleration,
//! `cloth-bench/tests/contract/thread_parity.rs` in contact), and without the feature. Passes over vertices (inertia,
//! bending, pairs, restriction, prolongation, inner products) go in chunks of 2048, whose sums are added in a fixed
//! order; from 8192 vertices on threads share them, and the coarse cycle runs beside the solve. Factorisation, the
//! coarse matrix, Woodbury's correction and the loop of Chebyshev's method are serial.
//!
//! # Add an element
//! One struct and two traits of [`cloth_core::element`]: `Element<N>` names the vertices, `Projective<N, K>` gives S, w
//! and the projection, which must be the nearest point in the Euclidean norm, or `∇E = w Sᵀ(S x − p)` is wrong; for an
//! element with `Energy` too, [`projection_error`](cloth_core::check::projection_error) tells; for any other,
//! [`LocalStep`] gives E and ∇E, to be compared by differences, with `PROJECTION_IS_CONSTANT` off (set, it adds
//! nothing). Test that, and that `G` falls in every plain iteration (as in `tests/chapter/minimum.rs`). S and w must be
//! constant. Write `projected_hessian` too, unless the projection is constant: its default, the identity, makes the
//! coarse grid as stiff as A, and nothing is won by it. `PROJECTION_IS_CONSTANT` and `sphere` (the radius, if the set
//! is a sphere about 0) are for speed; a radius that changes must not be given, as the solver keeps it. Matrix,
//! threads, accelerations and removal follow. [`PdBuilder::energy`] has an example.
//!
//! An element that is no squared distance to a set under a constant linear map is refused when compiling, such as an
//! area, a product of edges. (The set of all F with σ₁σ₂ = 1 nearly keeps areas: Bouaziz et al. 2014, section 5.)
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
//! - There is no Rayleigh or strain-rate damping, only that of implicit Euler: in a step the energy of an oscillation
//!   ẍ = −ω² x is divided by `1 + (ω Δt)²` (`objective.rs` derives it, and has what the others would do to A). Of a
//!   period, 2π/(ω Δt) steps, that leaves about exp(−2π ω Δt); at ω Δt = 0.1 46 % is lost. A swing of 1 s loses half in
//!   1.06 s at Δt = 1/60 s, in 4.2 s at 1/240. *For less* take shorter steps. BDF2 and the midpoint rule are
//!   minimisations with the same matrix but for the time in it (`cloth-massspring` has both); they are not offered.
//!   What iterations cut short lose ([below](#when-not-to-use-this-method)) would come on top.
//!   *For more* scale the velocities between steps, or hand over the air, `StepInput::air`. Quasi-Newton iterations
//!   have `½ Δt (v − v[0])ᵀ D (v − v[0])` in G, D its drag ([`cloth_core::air`]). Plain and Chebyshev iterations
//!   without contact have its force at the start of the step, which a bound keeps from reversing the flow past a free
//!   triangle. The bound does not know what is held: cloth that is held may feel less than the pressure.
//! - The plain iteration converges linearly, slowly for stiff cloth. A relative error of 10⁻² in `G` is soon reached
//!   and says little: truncated there, the hanging sheet floats. Check the fall beside the stretch first.
//! - A fixed number of iterations is an approximation of implicit Euler whose error is not watched. Ten, with a coarse
//!   grid of 12 cells, follow the first half second of the hanging sheet closely. Over five seconds its swinging dies
//!   away sooner than it should ([below](#when-not-to-use-this-method)), and a light, stiff sheet (0.3 m, 0.1 kg/m²,
//!   4.8·10⁴ N/m, 1/120 s) falls by half of what it should. So the default goes on, from ten to 300 iterations, until
//!   its Newton decrement `√(∇Gᵀ B ∇G)`, B the inverse Hessian that it has, is a twentieth of `‖x − x̃‖_M/Δt`, the
//!   change of velocity by elastic and contact forces ([`PdConfig::velocity_tolerance`]).
//!
//!   *Why.* Folds are missing. Take three vertices in a row, the outer two pushed together: the middle one has to move
//!   sideways, which stretches nothing. The matrix resists that as if it stretched both springs, so an iteration moves
//!   it by a small fraction of the way, and until it is there the springs are compressed. A coarse grid helps only
//!   where a fold is as wide as its cells: one of half the resolution of the cloth does no better, one as fine as the
//!   cloth is Newton's method, for which three iterations are enough.
//!
//!   *One instant misleads.* In the first row of the table below rounding alone (another order of adding up the
//!   springs) moves the last step's largest stretch between −28 and −0.2 %, the mean kinetic energy between −44 and
//!   −52 %: compare means.
//! - In a step from `x[0]`, and in a quasi-Newton step from `x[0] + Δt v[0]`, `G(x[1]) ≤ G(x[0])` where no pin or body
//!   moves: one that ends above is taken again, which the hanging sheet never needs. Without load, air and contact, and
//!   with W the sum of the elastic energy and that of gravity, this says
//!   `W(x[1]) + ½ ‖v[1] − v[0]‖²_M ≤ W(x[0]) + ½ ‖v[0]‖²_M`. So a tangle (cloth so crumpled that iterations do not get
//!   far) cannot store more than the whole energy before. Where E is convex and the step ends at the exact minimum of
//!   `G`, `½ ‖v[1]‖²_M` may be added on the left: no energy is gained. Plain and Chebyshev iterations from there, and
//!   all from x̃, have no such safeguard; ended early they can feed a tangle. With the default a cloth of 10³ N/m,
//!   damped, hangs in the end from any start (in a point, on a line, mirrored, random, blown up), forces balanced.
//! - The coarse grid needs rest positions, and is good for cloth that bends smoothly at its scale. It changes how fast
//!   the iteration converges, never to what; and not always for the better: at 10⁵ N/m, from x̃, an error of 10⁻² takes
//!   32 iterations with it and 7 without any acceleration.
//! - Where it converges to is a stationary point of `G`, the solution of implicit Euler, with the numerical damping of
//!   that. Where `G` has several (compressed cloth), which of them depends on the path.
//! - Linear momentum of a free cloth is conserved in every iteration, to rounding, with each acceleration: what nothing
//!   holds starts with the right momentum, and every direction keeps it. The start at `x[0]` gains it with the first
//!   full step. Angular momentum is not: implicit Euler does not conserve it (`components.rs` has both).
//! - Only energies of the form above (`local.rs` has how to tell): springs, stitches, hinges that are flat at rest (of
//!   vertices or, as [`MidpointHinge`](cloth_core::energy::MidpointHinge), of the midpoints of edges) or curved,
//!   as-rigid-as-possible triangles and tetrahedra, strain limits, attachments. (A strain limit of a spring with the
//!   range [0, L] resists tension only.) Not offered: energies whose stiffness varies, and others such as StVK,
//!   orthotropic or hyperelastic ones. For these A only preconditions: it has to be symmetric and positive definite,
//!   then −A⁻¹∇G leads down, and a line search makes `G` fall (Liu et al. 2017, whose w is fitted to the stress and is
//!   in A only). Without one `A ≥ ∇²G` would have to hold.
//! - Isotropic materials only. (Springs made by hand may each have a k.)
//! - Elements may differ in stiffness by eight powers of ten (a test).
//! - Another Δt costs a factorisation, which the report counts; other masses or new elements need another solver.
//! - A matrix in which elimination cancels all but a few digits of a pivot is
//!   [`NotPositiveDefinite`](cloth_core::step::StepError::NotPositiveDefinite). The last pivot of a free cloth, N
//!   vertices of mass m, n springs each, is about N m/Δt² beside a diagonal entry n k: that is from k Δt²/m of some
//!   10¹² N/n on.
//! - For vertices of one mass m with n springs each `cond A ≤ 1 + 2 n k Δt²/m` (Gershgorin): with n = 8 and m = m_A l²
//!   9·10⁵ for the hanging sheet at 64 a side, 4·10⁶ at 128. The rounding of a solve, 10⁻¹⁶ times as much, limits a
//!   direction, not the end, as g is computed anew from x. Rounding of g limits the tolerance that can be met: at 9 a
//!   side and 10³ N/m it leaves some 10⁻¹¹ of ‖∇G(x̃)‖ (`tests/chapter/acceleration.rs`).
//! - The residual compares with `‖∇G(x̃)‖`, in contact with `‖∇C(x)‖` if that is larger. Where that is rounding alone,
//!   as for a cloth in free fall, no tolerance is met and all iterations are spent, without harm.
//!
//! # Which settings
//! | for | take |
//! |---|---|
//! | cloth at steps of a frame | the default, with a [coarse grid](PdBuilder::coarse_grid) of 12 cells |
//! | the same time for each step | [`PdConfig::iterations`]: 10; 18 and 16 cells for seconds of motion |
//! | cloth crumpled at the scale of the cells | the default without a grid |
//! | a reference | [`PdConfig::tolerance`] of 10⁻⁶ and [`PdConfig::most_iterations`] of thousands |
//! | the method as published | [`PdConfig::plain`] |
//!
//! It is for many steps with one mesh and one step size on a processor: no step size is too large, and an iteration
//! costs two passes over a small factor.
//!
//! # What differs from the papers
//! | paper | there | here |
//! |---|---|---|
//! | Bouaziz 2014 | bending at a vertex: the cotangent Laplacian keeps its length at rest | at an edge: hinges |
//! | | contact: projections to half-spaces, with weights in the matrix | a potential, outside of A |
//! | | pins: attachments of high weight | no rows in A; attachments as well |
//! | | from x̃, a given number of iterations | from `x[0] + Δt v[0]`, until the decrement is small |
//! | Liu 2013, 2017 | `G` times h² = Δt²: `(M + h² L) x = M x̃ + h² J d`, L = Σ w SᵀS, J d = Σ w Sᵀ p | `G` |
//! | Wang 2015 | a Jacobi sweep for a solve; extrapolates after 10 iterations | the solve; after 3; a safeguard |
//! | Liu 2017 | w fitted to the stress of the material | w is the stiffness; besides, a coarse grid |
//! | Li 2020 (IPC) | −(d − h)² ln(d/h), κ_c adapted; f′ = 2y − y², y = ‖u‖/ε < 1 | ψ above, κ_c given; f′ = y |
//! | | one length of a step for all vertices | a bound for each vertex |
//!
//! # When not to use this method
//! Where seconds of motion have to look right, take implicit Euler (`cloth-massspring`), with a tolerance of 10⁻² if
//! nothing touches. Five seconds of the sheet: means over the last 100 of 300 steps, kinetic energy and stretch beside
//! those of implicit Euler to 10⁻³, `elastic` at the last step; median milliseconds a step on one thread of a 2-core
//! AMD EPYC (Zen 3), commit 257771a6:
//!
//! | n | | iterations | kinetic energy | largest stretch | elastic | ms |
//! |---|---|---|---|---|---|---|
//! | 64 | 10 iterations | 10 | −43 % | −8 % | × 10 | 4.1 |
//! | | the default, 12 cells | 19 | −17 % | −4 % | × 4.0 | 6.4 |
//! | | `velocity_tolerance: 0.03` | 39 | −3 % | −0.1 % | × 1.1 | 12 |
//! | | implicit Euler to 10⁻² | 15 | −0.2 % | +0.7 % | × 1.0 | 14 |
//! | | implicit Euler to 10⁻³, its default | 28 | | | | 21 |
//! | 128 | 10 iterations | 10 | −49 % | −8 % | × 20 | 19 |
//! | | the default, 12 cells | 17 | −12 % | +0.9 % | × 4.8 | 28 |
//! | | `velocity_tolerance: 0.03` | 42 | −4 % | −0.8 % | × 1.0 | 66 |
//! | | implicit Euler to 10⁻² | 14 | −0.1 % | +0.1 % | × 0.95 | 54 |
//! | | implicit Euler to 10⁻³, its default | 30 | | | | 93 |
//!
//! (`cloth-bench run hang --n 64 --steps 300 --threads 1 --json`, with `--method pd` or `implicit-euler` and `--set
//! iterations=10`, `velocity_tolerance=0.03` or `tolerance=0.01`.) The default is twice as fast as implicit Euler to
//! 10⁻² and keeps most of the swing, but its elastic energy is four to five times too large, as what should fold is
//! compressed. With a tolerance by which it is within 5 % it takes 0.9 and 1.2 times as long.
//!
//! In contact these times do not hold; `cloth-bench study decision` has a table with contact. To the last digits
//! Newton's method (`cloth-massspring`) gets in a dozen iterations. Other cases:
//! - **Other energies**, such as neo-Hookean: ADMM (Narain et al. 2016, Overby et al. 2017) keeps local steps and a
//!   constant matrix, with a multiplier an element, but no longer lowers `G` in every iteration; or Newton's method.
//! - **A factor that does not fit** into the memory, or a GPU, on which triangular solves wait: in its place sweeps of
//!   Gauss–Seidel over coloured vertices (Fratarcangeli et al. 2016), Jacobi's method (Wang 2015), conjugate gradients.
//! - **Stiffness or mesh that changes in every step**: position-based methods (`cloth-xpbd`) factorise nothing.
//! - **Hard constraints**: w has to be finite, and a high one slows the iteration down. XPBD has zero compliance.
//!
//! # Files in reading order
//! 1. `examples/first_program.rs`: the naive method. `examples/hanging.rs`: iterations against the minimum of `G`
//!    (`cargo run --release -p cloth-pd --example hanging`; the other likewise).
//! 2. `solver.rs`: the step; `solver/end.rs`: when it is done; `config.rs`: its settings; `objective.rs`: `G` and its
//!    gradient.
//! 3. `local.rs`: a family of elements; `batch.rs`: the formula of one. For speed: `vertex_blocks.rs`,
//!    `deinterleaved.rs`, `quadratic.rs`.
//! 4. `matrix.rs`: A; `global.rs`: its factor; `panel.rs`: the factor in panels, and the solve with it
//!    (`panel/parts.rs`: cut for threads); `woodbury.rs`: the solve after a change of a few rows; `change.rs`: pins,
//!    attachments and elements that come and go.
//! 5. `chebyshev.rs`, `quasi_newton.rs`, `coarse.rs` with `lattice.rs`: the accelerations.
//! 6. `contact.rs`, `hessian.rs`, `quasi_newton/in_contact.rs`; `components.rs`: momentum of what nothing holds; `pin_work.rs`.
//!
//! `tests/chapter` tests the claims of this page; its `main.rs` has a table of them. A step, and its rate of
//! convergence, that can be followed by hand is `one_spring_ends_at_implicit_euler_in_closed_form` in its `minimum.rs`.
//!
//! # References
//! - M. Bergou, M. Wardetzky, D. Harmon, D. Zorin, E. Grinspun, "A quadratic bending model for inextensible surfaces",
//!   SGP 2006, <https://doi.org/10.2312/SGP/SGP06/227-230>: the quadratic hinge.
//! - S. Bouaziz, S. Martin, T. Liu, L. Kavan, M. Pauly, "Projective dynamics: fusing constraint projections for fast
//!   simulation", ACM Trans. Graph. 33(4), 154, 2014, <https://doi.org/10.1145/2601097.2601116>.
//! - T. Liu et al., "Fast simulation of mass-spring systems", ACM TOG 32(6), 2013,
//!   <https://doi.org/10.1145/2508363.2508406>.
//! - H. Wang, "A Chebyshev semi-iterative approach for accelerating projective and position-based dynamics", ACM Trans.
//!   Graph. 34(6), 246, 2015, <https://doi.org/10.1145/2816795.2818063>.
//! - T. Liu, S. Bouaziz, L. Kavan, "Quasi-Newton methods for real-time simulation of hyperelastic materials", ACM
//!   Trans. Graph. 36(3), 23, 2017, <https://doi.org/10.1145/2990496>.
//! - M. Ly, J. Jouve, L. Boissieux, F. Bertails-Descoubes, "Projective dynamics with dry frictional contact", ACM
//!   Trans. Graph. 39(4), 57, 2020, <https://doi.org/10.1145/3386569.3392396>: another way to contact.
//! - R. A. Nicolaides, "Deflation of conjugate gradients", SIAM J. Numer. Anal. 24(2), 1987,
//!   <https://doi.org/10.1137/0724027>; M. Dryja, O. B. Widlund, "An additive variant of the Schwarz alternating method
//!   for the case of many subregions", report 339, New York University, 1987: coarse spaces.
//! - B. Wu, Z. Wang, H. Wang, "A GPU-based multilevel additive Schwarz preconditioner for cloth and deformable body
//!   simulation", ACM Trans. Graph. 41(4), 63, 2022, <https://doi.org/10.1145/3528223.3530085>; L. Lan et al.,
//!   "Efficient GPU cloth simulation with non-distance barriers and subspace reuse", ACM Trans. Graph. 43(6), 2024,
//!   <https://arxiv.org/abs/2403.19272>.
//! - Y. Peng et al., "Anderson acceleration", ACM Trans. Graph. 37(4), 42, 2018,
//!   <https://doi.org/10.1145/3197517.3201290>.
//! - R. Narain, M. Overby, G. E. Brown, "ADMM ⊇ projective dynamics", SCA 2016, <https://doi.org/10.2312/sca.20161219>;
//!   M. Overby et al., IEEE TVCG 23(10), 2017, <https://doi.org/10.1109/TVCG.2017.2730875>: hyperelastic energies.
//! - M. Fratarcangeli, V. Tibaldo, F. Pellacini, "Vivace", ACM Trans. Graph. 35(6), 2016,
//!   <https://doi.org/10.1145/2980179.2982437>: Gauss–Seidel on a GPU.
//! - M. Li et al., "Incremental potential contact", ACM Trans. Graph. 39(4), 49, 2020,
//!   <https://doi.org/10.1145/3386569.3392425>: lagged friction.
//! - L. Wu et al., "A safe and fast repulsion method", ACM Trans. Graph. 40(1), 2020,
//!   <https://doi.org/10.1145/3430025>; A. H. Chen et al., "Offset geometric contact", 44(4), 2025,
//!   <https://doi.org/10.1145/3731205>: bounds per vertex.
//! - J. Nocedal, S. J. Wright, *Numerical optimization*, 2006, chapter 7: truncated Newton methods. W. W. Hager,
//!   "Updating the inverse of a matrix", SIAM Review 31, 1989, <https://doi.org/10.1137/1031049>.
#![forbid(unsafe_code)]

mod batch;
mod change;
mod chebyshev;
mod coarse;
mod components;
mod config;
mod contact;
mod deinterleaved;
mod global;
mod hessian;
mod lattice;
mod local;
mod matrix;
mod objective;
mod panel;
mod pin_work;
mod quadratic;
mod quasi_newton;
mod solver;
mod vertex_blocks;
mod woodbury;

pub use change::{AttachmentId, ChangeError};
pub use config::{Acceleration, PdConfig, StartGuess};
pub use local::LocalStep;
pub use panel::PanelFactor;
pub use solver::{PdBuilder, PdSolver};
pub use woodbury::WoodburyUpdate;

pub use cloth_core;
#[doc(no_inline)]
pub use cloth_core::{
    energy::Spring,
    math::Vec3,
    particles::{Particles, State},
    step::{BuildError, StepError, StepInput, StepReport, Stepper},
};
