//! Cloth as a mass-spring system: explicit and implicit time integration.
//!
//! # Example
//! ```
//! use cloth_massspring::cloth_core::{cloth::{Cloth, Membrane}, mesh::generate::{Diagonals, grid}};
//! use cloth_massspring::{ImplicitEuler, State, StepInput, Stepper, Vec3};
//!
//! let mesh = grid(10, 10, 1.0, 1.0, Diagonals::Alternating)?;
//! let cloth = Cloth {
//!     areal_density: 0.2,                          // kg/m²
//!     membrane: Membrane::SpringStiffness(1e4),    // N/m
//!     bending_rigidity: 1e-5,                      // N·m
//! };
//! let mut model = cloth.on(&mesh)?;
//! model.particles.prescribe(90)?;                  // two corners
//! model.particles.prescribe(99)?;
//!
//! let mut solver = ImplicitEuler::builder(&model.particles)
//!     .elements(model.families())
//!     .build()?;
//! let mut state = State::at_rest(mesh.positions().to_vec());
//! for _ in 0..30 {
//!     let input = StepInput::new(1.0 / 60.0).gravity(Vec3::new(0.0, 0.0, -9.81));
//!     solver.step(&mut state, input)?;
//! }
//! assert!(state.positions[4].z < -0.5);            // the free edge has swung down
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! Meshes, materials and measures are in [`cloth_core`], re-exported here. A fabric is three numbers: the areal density
//! ρ (kg/m², a weighed piece over its area), the modulus Y (N/m, from a tensile test: force per width over strain) and
//! the bending rigidity D (N·m, moment per width over curvature). Springs of equal k on this mesh are a sheet of
//! `Y = 4k/3` and Poisson's ratio 1/3, whatever the edge length: refining the mesh keeps k
//! ([below](#springs-triangles-and-hinges-as-a-sheet)). Here boundary edges, which stand for half a cell, have the
//! whole k. So a sheet of n cells a side is stiffer, under a uniform strain by 5/(6n), here 9 %: 3/(4n) along the
//! pulled boundaries, 1/(12n) along the others, which resist the narrowing.
//! [`Membrane::Modulus`](cloth_core::cloth::Membrane::Modulus) takes Y, and halves k there. For another Poisson's ratio
//! [`Discretization`](cloth_core::cloth::Discretization) takes triangles. `cloth-bench study independence` shows what
//! mesh and step change.
//!
//! # The idea
//! A mass on every vertex, a spring on every edge, and Newton's second law: `M x″ = f(x) + M g`, `f = −∂E/∂x`. What
//! remains to choose is where in time the forces are evaluated. That choice decides everything.
//!
//! At the *start* of the step they are known, and the step costs one pass over the springs:
//! ```text
//! v[1] = v[0] + Δt (M⁻¹ f(x[0]) + g)
//! x[1] = x[0] + Δt v[1]        symplectic Euler;  with v[0] here: forward Euler
//! ```
//! But a force that is right at the start can carry a vertex past the equilibrium of its spring, and farther from it
//! than before, until it is evaluated again. The next force is then larger, and so on: *overshoot*. A step of
//! symplectic Euler must be shorter than `2/ω`, with ω the fastest oscillation of the cloth, which grows with stiffness
//! and with fineness; for forward Euler, undamped, no step is short enough.
//!
//! At the *end* of the step, the forces are those at positions not yet known:
//! ```text
//! x[1] = x̃ + Δt² M⁻¹ f(x[1]),    x̃ = x[0] + Δt v[0] + Δt² g
//! ```
//! These equations say that `x[1]` is a stationary point of
//! ```text
//! G(x) = ‖x − x̃‖²_M / (2Δt²) + E(x),    ‖y‖²_M = Σ mᵢ ‖yᵢ‖²
//! ```
//! (`∇G = M(x − x̃)/Δt² − f(x)`: set it to zero and multiply by Δt² M⁻¹), and minimising has a measure of progress that
//! solving equations lacks: G falls in every iteration whatever Δt, but for rounding, as a line search shortens steps.
//!
//! The same minimisation, with another predicted position and another time in place of `x̃` and Δt, gives two
//! integrators of *second* order: the implicit midpoint rule (half a step of implicit Euler, whose change is then added
//! once more) and BDF2 (the derivatives at the end from a parabola through three points in time). A *stage* is one such
//! minimisation, with its base and its τ:
//! ```text
//!                     base x_b, v_b                          τ        then
//! implicit Euler      x[0], v[0]                             Δt
//! implicit midpoint   x[0], v[0]                             Δt/2     x[1] = 2x − x[0],  v[1] = 2v − v[0]
//! BDF2                (4x[0] − x[−1])/3, (4v[0] − v[−1])/3   2Δt/3
//!
//! x minimises ‖x − x̂‖²_M/(2s²) + E(x),   x̂ = x_b + τ v_b/(1 + ατ) + s² g,   s² = τ²/(1 + ατ),   v = (x − x_b)/τ
//! ```
//! Gravity and load are constant in a step and stand in x̂, so E is elastic only. Forces without a potential get one
//! for the duration of a step:
//! - Drag α ([`Damping`]) is linear in `v = (x − x_b)/τ`, so it changes x̂ and s, and nothing else. Friction has the
//!   normal force of the start of the step.
//! - Damping that grows with the stiffness adds `β/(2τ) (x − x_b)ᵀ K (x − x_b)` with `K = Σ k ∂C ∂Cᵀ` held half-way
//!   between x_b and `x_b + τ v_b`, where uniform motion leads (`implicit/damper.rs`).
//! - Wind and the resistance of the air ([`StepInput::air`], apart from α; [`cloth_core::air`] has the force) are
//!   linearised at the velocity v₀ before the step: `F − D (v − v₀)` at a vertex, D (3 × 3, kg/s; elsewhere D is the
//!   rigidity) positive semi-definite. F stands in x̂, and `(x − a)ᵀ D (x − a)/(2τ)` with `a = x_b + τ v₀` is added
//!   (`implicit/air_drag.rs`). Explicit (sub)steps multiply the change of velocity by `(I + Δt D/m)⁻¹`, which is the
//!   same force with v at their end; α and β they take with v at their start.
//!
//! The minimisation can be cut short: one Newton step from `x[0]` without a line search is the implicit step of Baraff
//! and Witkin, `(M/Δt² + H) Δx = M v[0]/Δt + M g + f`. With `Δx = Δt (v[0] + Δv)` and `∂f/∂x = −H` that is their (6)
//! times M, `(M − Δt² ∂f/∂x) Δv = Δt (M g + f + Δt ∂f/∂x v[0])`, with ∂f/∂v = 0: damping and drag come in otherwise.
//!
//! **The Hessian of a spring** decides how hard that is. With its unit vector `n = (x₀ − x₁)/l` and its length l,
//! `∂l/∂x₀ = n` and `∂n/∂x₀ = (I − n nᵀ)/l`. So `E = ½ k (l − L)²` has
//! ```text
//! ∂E/∂x₀ = k (l − L) n,    ∂²E/∂x₀² = k n nᵀ + k (l − L) (I − n nᵀ)/l
//! ```
//! At x₁ the gradient is the negative of that; the Hessian has the same block, B, there, and −B between the ends. So
//! three of its six eigenvalues are 0 (both ends move alike), and three are twice those of B (they move oppositely).
//! Those of B are k along the spring and, in both directions across, tension over length, `k (1 − L/l)`. Under
//! compression this is negative and the straight spring a saddle of E: displacing it sideways lowers the energy
//! (buckling). `M/Δt² + H` may then be indefinite (one spring between two free masses m: where `m/Δt² < 2k(L/l − 1)`),
//! and a Newton step may lead uphill. The cures set negative eigenvalues of each element to zero or to their absolute
//! values ([`Convexity`](cloth_core::element::Convexity); [`HessianPolicy`]). They change the matrix and never the
//! gradient: a converged step is a stationary point of the same G by any of them. They decide the number of iterations,
//! which of several minima is found, and the result of a linearised step, which solves once.
//!
//! Formulas of the other elements stand in [`cloth_core::energy`], a file each. Their Hessians differ in this respect:
//!
//! | element | the Hessian is indefinite |
//! |---|---|
//! | [`StvkTriangle`](cloth_core::energy::StvkTriangle), `½ A Γ:ℂ:Γ` | under compression; see below |
//! | [`CurvatureHinge`](cloth_core::energy::CurvatureHinge), isometric bending, `½ k_h ‖q x‖²` | never: constant |
//! | [`DihedralHinge`](cloth_core::energy::DihedralHinge), `½ k_θ (θ − θ₀)²` | where `θ ≠ θ₀`, by `k_θ (θ − θ₀) ∂²θ` |
//!
//! The mass-spring model of textbooks (Provot 1995) has three kinds of springs on a square grid: structural ones along
//! its lines, shear springs along both diagonals and flexion springs to the vertex after the next. Here edges are the
//! first and one diagonal of each cell, and hinges bend. [`Spring::across`] joins the tips of every hinge: at a
//! diagonal that is the cell's other diagonal, a shear spring; at other edges, on the alternating grid, a flexion
//! spring. Both count in the ℂ below. Flexion springs do not resist a small bend of flat cloth: a fold θ brings the
//! ends of one from L to `L cos(θ/2)`, so C is about −Lθ²/8 and `½ k C²` about `k L² θ⁴/128`, and no D corresponds to
//! k. With a rest length below L, θ and −θ cost the same: bent at rest, it snaps through. Its integrator is often
//! Störmer–Verlet or leapfrog: [`SymplecticEuler`] with v at the half step. Runge–Kutta and IMEX schemes are not here.
//!
//! # Springs, triangles and hinges as a sheet
//! **Springs.** In a small uniform strain ε (2 × 2) a spring of length L along the unit vector n is stretched by
//! `L n·εn`, so the energy per area is `w = Σ k L² (n·εn)²/(2A) = ½ ε:ℂ:ε` with `ℂᵢⱼₗₘ = Σ k L² nᵢnⱼnₗnₘ/A` (N/m). As ℂ
//! stays the same when indices change places, `ℂ₁₁₂₂ = ℂ₁₂₁₂` (Cauchy's relation): of the isotropic sheets, with
//! `ν Y/(1 − ν²)` and `Y/(2 (1 + ν))` there, only those of ν = 1/3 are left. A cell of the alternating grid has one
//! spring of length l along each axis and half of one of length √2 l along either diagonal:
//! ```text
//! w = ½ k (ε₁₁² + ε₂₂² + ¼ (ε₁₁ + ε₂₂ + 2ε₁₂)² + ¼ (ε₁₁ + ε₂₂ − 2ε₁₂)²)
//!   = ¾ k (ε₁₁² + ε₂₂² + ⅔ ε₁₁ε₂₂ + 4/3 ε₁₂²) = Y/(2 (1 − ν²)) (ε₁₁² + ε₂₂² + 2ν ε₁₁ε₂₂ + 2 (1 − ν) ε₁₂²)
//! ```
//! That is `2ν = ⅔` and `Y/(1 − ν²) = 3k/2`. Equal springs, with half of k on the boundary:
//!
//! | pattern | modulus Y |
//! |---|---|
//! | equilateral | `2k/√3` in every direction |
//! | alternating diagonals | `4k/3` in every direction |
//! | diagonals one way | k along the axes, 2k along the diagonals, 2k/5 across them |
//!
//! No l stands there: refined, a network tends to such a sheet, anisotropic if the pattern is. An equilateral triangle
//! with half of each side's spring (the neighbour has the other half) stores in a small strain what a linear triangle
//! of ν = 1/3 stores.
//!
//! *One k on any mesh.* In the mean over all directions `nᵢnⱼnₗnₘ` is `(δᵢⱼδₗₘ + δᵢₗδⱼₘ + δᵢₘδⱼₗ)/8`, so springs of χk,
//! `χ = 1` inside and ½ on the boundary, have `ℂ₁₁₁₁ = 3 Σ χ k L²/(8A)`. The sheet of ν = 1/3 has `Y/(1 − ν²) = 9Y/8`
//! there: `Membrane::Modulus` takes `k = 3 Y A/Σ χ L²`. It is exact in all directions where `Σ χ L² e^(2iφ)` and
//! `Σ χ L² e^(4iφ)` are 0, φ that of the edge, as in the first two patterns. Van Gelder (1998) gives each edge its own
//! k, which is not done here.
//!
//! *Provot's grid*, k on its lines and k_d on both diagonals of each cell, has per area
//! `w = ½ k (ε₁₁² + ε₂₂²) + ½ k_d ((ε₁₁ + ε₂₂)² + 4ε₁₂²)`: along the lines `ν = k_d/(k + k_d)`,
//! `Y = k (k + 2k_d)/(k + k_d)`, and the shear modulus k_d. It is isotropic, `ℂ₁₁₁₁ − ℂ₁₁₂₂ = 2ℂ₁₂₁₂`, for k_d = k/2
//! only: the sheet of the alternating grid. Soft shear takes ν along the lines to 0: the two cannot be chosen apart.
//! (Flexion springs k_f add 4k_f to k.)
//!
//! **Triangles** have `F = [x₁ − x₀, x₂ − x₀] R` (3 × 2, dimensionless) with `R = [X₁ − X₀, X₂ − X₀]⁻¹` of the rest
//! shape in its plane (1/m), Green's strain `Γ = ½ (FᵀF − I)` and, with the rest area A, `E = ½ A S:Γ`. The stress is
//! `S = Y/(1 − ν²) ((1 − ν) Γ + ν tr Γ I)` (N/m: Y is Young's modulus times thickness, which stands nowhere else). So
//! `dE = A S:dΓ = A (F S):dF`, and by `dF = [dx₁ − dx₀, dx₂ − dx₀] R` the forces are `[f₁, f₂] = −A F S Rᵀ` and
//! `f₀ = −f₁ − f₂` (N).
//!
//! Stretched by λ in one direction, with ν = 0, a StVK triangle has the energy `(λ² − 1)²/8` per area and modulus: its
//! curvature `(3λ² − 1)/2` is negative below `λ = 1/√3`, and its force `λ (λ² − 1)/2` fades from there to zero when it
//! is pressed flat. There it holds a finite energy, so it can be turned inside out, as springs can.
//!
//! **Hinges.** An edge of length e, and the two triangles at it:
//!
#![doc = include_str!("../doc/hinge.svg")]
//!
//! *The row q.* Deflect the corners by u, normal to the plane. Across the edge the slope of the first triangle is
//! `(u₂ − u_foot)/h`; e times it is `(cot θ₀ + cot θ₁) u₂ − cot θ₁ u₀ − cot θ₀ u₁`, as `e/h = cot θ₀ + cot θ₁` and the
//! foot of h divides e as the cotangents. The sum with that of the other triangle is `−q·u`: hence the q of
//! [`CurvatureHinge`](cloth_core::energy::CurvatureHinge).
//!
//! *Its length and energy.* With positions for u the part of the first triangle in `q x` is `−e/h` times the vector
//! from its foot to its tip. While the triangle is not stretched that is `h d₂`, so `q x = −e (d₂ + d₃)`: 0 in a flat
//! hinge, and `‖q x‖ = 2e sin(θ/2)`, about eθ, in one folded by θ. The hinge stands for a third of its triangles,
//! `Ā = (A₀ + A₁)/3`, with the curvature `eθ/Ā`: `½ k_b (eθ/Ā)² Ā`, so `E = ½ k_h ‖q x‖²` with `k_h = k_b/Ā`.
//!
//! *Which k_b.* An equilateral lattice bent to a cylinder of curvature κ has `q·u = κ e² (cos 2φ − ½)/√3` at an edge
//! that is φ away from the direction of κ. The squares of the three brackets at a vertex sum to 9/4, which makes
//! `½ · 3k_b · κ²` per area (`Ā = e²/√12`, area `√3 e²/2` a vertex): `k_b = D/3`. With all vertices on the cylinder the
//! alternating grid has D along its lines and 3/2 D along its diagonals. In equilibrium it has 5/6 D and 4/3 D, and a
//! strip along its lines that is free to curve across, as in a bending test, 4/5 D ([`cloth_core::energy`]).
//!
//! *By the angle* the same energy of small folds is `½ k_θ (θ − θ₀)²`, `k_θ = D e²/(A₀ + A₁)`; θ is positive where the
//! edge is a ridge seen from the front, and flat is a point like others. The moment `k_h e² sin θ` of the first is
//! largest at a right angle and 0 at a full fold, θ = π; that of the angle grows up to `|θ − θ₀| = π`, and changes sign
//! there.
//!
//! # From equation to function
//! | equation | says | where |
//! |---|---|---|
//! | `E = ½ k (‖x₀ − x₁‖ − L)²` | energy and force of springs | [`cloth_core::energy::Spring`] |
//! | `x[1] = x[0] + Δt v[1]` or `v[0]` | explicit steps | [`SymplecticEuler`], [`ExplicitEuler`] |
//! | `Δt < 2/ω_max` | stability | [`stable_time_step`] |
//! | `min G(x)` | a minimisation | [`ImplicitEuler`], [`G`](cloth_core::measure::IncrementalPotential) |
//! | `x_b`, `x̂`, s, start | predicted positions | `Implicit::predict` and `advance` in `implicit.rs` |
//! | `G`, `∇G`, `M/s² + H`, `(M/s² + H) p` | with damping and contact | `Stage` in `implicit/stage.rs` |
//! | `p = −B⁻¹∇G`, B from pairs `(sᵢ, yᵢ)` around a multigrid cycle | quasi-Newton (L-BFGS) | [`Solve::QuasiNewton`] |
//! | `(M/s² + H) p = −∇G`, nearly | truncated Newton, in hard contact | [`cloth_core::method::contact_hessian`] |
//! | the same to the end | Newton's method, kept positive definite | [`Solve::Newton`], [`HessianPolicy`], [`Accept`] |
//! | its linear systems | with a table of solvers | [`ImplicitConfig::linear`], [`cloth_core::method::linear`] |
//! | τ = Δt/2; 2Δt/3 | midpoint rule; BDF2, and when it starts again | [`ImplicitMidpoint`]; [`Bdf2`] |
//! | one Newton step | linearised implicit Euler | [`Solve::Linearized`], [`ImplicitConfig::linearized`] |
//! | `−α M v − β K v` | drag, stiffness-proportional damping | [`Damping`] |
//!
//! `examples/first_program.rs` is implicit Euler as plain loops over arrays, by Newton's method with a dense matrix,
//! and 10⁻⁹ m from [`ImplicitEuler`] at most (a test). Its `objective`, `derivatives`, `solve` and `step` are here
//! `Stage::gradient_into`, `Stage::hessian_into`, `NewtonSystem` and `newton::iterate` with `line_search::search`; the
//! clamped tension in `derivatives` is `Convexity::Clamp`. The hot loops are `Family::add_gradient` and its neighbours
//! in `cloth-core/src/method/family.rs`, in chunks of vertices, around the formula of an element.
//!
//! # The minimisation
//! Newton's method needs few iterations, each (with the feature `cholesky`) a factorisation of 3V unknowns: most of its
//! time, `V^1.5` at best ([`ImplicitConfig::linear`]). The default factorises nothing: its iterations are more and much
//! cheaper: 22, 30 and 38 at 32, 64 and 128 vertices a side on the *hanging sheet* (1 m, 0.2 kg/m², springs of 10⁴ N/m,
//! held at two corners, let go horizontally, Δt = 1/60 s; `cloth-bench/doc/results.md`). Its direction is `p = −B⁻¹∇G`.
//! B comes from a positive definite Hessian, of which one V-cycle of [multigrid](cloth_core::method::multigrid),
//! `B₀⁻¹`, is nearly the inverse, and from the last five pairs `sᵢ = Δx`, `yᵢ = Δ∇G` (L-BFGS; sᵢ with an index is no
//! time):
//! ```text
//! r = −∇G;       newest pair first:  aᵢ = sᵢ·r/(sᵢ·yᵢ),   r ← r − aᵢ yᵢ
//! p = B₀⁻¹ r;    oldest pair first:  p ← p + (aᵢ − yᵢ·p/(sᵢ·yᵢ)) sᵢ
//! ```
//! (`limited_memory.rs` takes all inner products in one pass over the pairs, after Byrd et al. 1994.) One step:
//! 1. `x_b`, `x̂` and the start of the iteration ([`StartGuess`]). Contact detection begins. The displacement to the
//!    start, less what a piece that flies has in common, is truncated where it meets something, and the truncation
//!    fades with distance ([`FadingTruncation`](cloth_core::contact::FadingTruncation)).
//! 2. Connected components that nothing holds are shifted to where their momentum takes them. With contacts in the
//!    input all are shifted by one vector, and only if no vertex is held, the cloth touches nothing but itself, the
//!    path of the shift is free of crossings, and G falls.
//! 3. Repeat:
//!    1. Done if `‖∇G‖ ≤ ε ‖M(x − x̂)/s²‖`, both in the norm of M⁻¹, or if rounding allows no more. ε is `tolerance`;
//!       with active contacts 0.3 of it; without contact at least 10⁻⁵, from where Newton's method goes on to less.
//!    2. In iterations 1 to 4, 12, 20, 28, … recompute the Hessian.
//!    3. `p = −B⁻¹∇G`. If `∇G·p ≥ 0`, drop the pairs, recompute the Hessian and repeat.
//!    4. Done if the Newton decrement `√(−∇G·p)` is at most ε times `‖x − x̂‖_M/s`, or times `10⁻³ √(2ΔG)` if that is
//!       more, ΔG the fall of G so far: beside much energy released, as from cloth crushed to a point, little counts.
//!    5. The longest step: t = 1; in contact less (`Minimizer::iterate` in `implicit/minimizer.rs`).
//!    6. `x ← x + t p` with the first t that `G(x + t p) ≤ G(x) + 10⁻⁴ t ∇G·p` (Armijo) accepts, each the minimum of a
//!       parabola, between a tenth and a half of the one before, 50 at most. Where rounding hides the change of G (a
//!       rise below `10⁻¹⁰ |G|`) the slope decides: `∇G(x + t p)·p ≤ 0.8 |∇G(x)·p|`. If none is accepted:
//!       - a gradient of at most 100 times the rounding error is the end;
//!       - else the pairs are dropped, the Hessian is recomputed, and the iteration repeated; if it fails again,
//!         Newton's method takes over (in contact the step ends as it is), and where that fails, the step is refused.
//!    7. From iteration 4 on, keep the pair `sᵢ = t p`, `yᵢ = Δ∇G` if `sᵢ·yᵢ > 0`, which Armijo does not ensure.
//! 4. The shift of 2 again, with contacts whether G falls or not: linear momentum is kept at any tolerance.
//! 5. `v = (x − x_b)/τ`.
//!
//! With B positive definite `∇G·p < 0`, so a short enough t passes. Pairs outlive a new Hessian from iteration 12 on.
//! Without them a full step multiplies a small error by `I − B₀⁻¹(M/s² + H)`. k and Δt are in both, so the rate is made
//! by what differs: the cycle is not quite the inverse, B₀ has absolute values and lumped blocks (see below), and
//! springs have turned since the Hessian was computed. (`implicit/line_search.rs`: a proof, for a clamped Hessian.)
//!
//! The levels: about a quarter of the vertices make the next coarser one, spread such that no two are strongly coupled,
//! nor both to a third while they are nearly as close as neighbours ([`multigrid`](cloth_core::method::multigrid)). The
//! prolongation P is exact for linear functions of the rest positions; each coarse matrix is Pᵀ times the finer one
//! times P (Galerkin). One forward sweep of Gauss–Seidel over blocks of 3 × 3 comes before the coarse correction and
//! one backward sweep after it, so that the cycle is symmetric; a level of at most 48 vertices is solved by a dense
//! Cholesky factorisation. All is in single precision. Five things make it work:
//! - *Absolute values* take the place of negative eigenvalues, the k (1 − L/l) of compressed springs
//!   ([`Convexity::Abs`]). So the matrix is positive definite, and every direction
//!   leads down. Alone it would converge linearly: across a spring between two free masses m it has `1 + c` for
//!   `1 − c`, `c = 2k s² (L/l − 1)/m`, which multiplies the error by `2c/(1 + c)`. (Zeros,
//!   [`Convexity::Clamp`](cloth_core::element::Convexity::Clamp), have 1 there, and the factor c.) That is slow near
//!   `c = 1`, where a compressed sheet has not buckled yet; beyond, the straight spring is a saddle point, and the
//!   error has to grow: by less than 2 an iteration with absolute values, by c with zeros, which moves thin cloth too
//!   far. (c is `2s²/(ml)` times the force in the spring: stiffness counts only through the force, Δt by its square.)
//!   The pairs bring the true curvature back where it is positive; those of negative curvature are not kept. Dihedral
//!   hinges give their Gauss–Newton matrix, which needs no eigenvalues.
//! - *Lumped*: blocks of the two vertices opposite an edge are added to the diagonal, which leaves the pattern of the
//!   edges ([`lumped_assembly`](cloth_core::method::family::Energies::lumped_assembly)).
//! - *Predicted forces.* A stiff spring that should turn is moved along its tangent by an iteration, and so becomes too
//!   long. The next Hessian would have that false stretch as tension, in the factor `k |l − L|/l` of `I − n nᵀ`. So the
//!   first four iterations take the extension that the iteration before has expected: that of C linearised at its start
//!   x′, `C̃ = C(x′) + ∂C(x′)·(x − x′)` (in the first, `C(x[0])`). Their factor is `k |C̃|/L`, over L and not l, as l
//!   has the false stretch in it ([`mixed_hessian`](cloth_core::element::Energy::mixed_hessian)).
//! - *An extrapolated start*, by half of the last change of velocity ([`StartGuess::Extrapolated`]).
//! - *A fallback.* Newton's method takes over where more than 1000 further iterations would be needed at the rate of
//!   the last 200, and where the line search finds nothing lower
//!   ([`newton_fallbacks`](cloth_core::step::StepReport::newton_fallbacks) counts both). It also makes the end where a
//!   tolerance below 10⁻⁵ or a minimum ([`Accept::Minimum`]) is asked for. What needs the fallback are very stiff
//!   springs on thin cloth (10⁶ N/m and more below 10⁻⁵ N·m); the example `materials` prints a table. Springs with
//!   [slack](cloth_core::cloth::SpringLaw::DeadZone) take Newton's directions from the 33rd iteration on.
//!
//! # Pin and drag
//! `particles.prescribe(i)?` before the solver is built; before each step set `state.velocities[i]` to
//! `(target − state.positions[i])/Δt`, or let [`Pins`](cloth_core::pin::Pins) do it. A solver copies the masses when it
//! is built: to grab or release another vertex, build a new one and go on with the state. (A new [`Bdf2`] begins with
//! one step of implicit Euler.) Pins leave the unknowns; their gradient is zero, so they count in no norm.
//!
//! The cloth pulls at a pin with `−∂E/∂x` where the integrator takes its forces: `x[1]` of implicit Euler and BDF2, the
//! middle of midpoint, the start of explicit substeps. [`StepInput::pin_forces`](cloth_core::StepInput::pin_forces)
//! asks for it, with stiffness damping and without contact; [`ImplicitEuler`](ImplicitEuler#force-at-a-pin) has it by
//! hand, and what the holding hand bears besides. A linearised step reports none: the force that moved its cloth is
//! another one. `pin_work` (J) in the report is the work of moving pins against these forces; BDF2 has it only in steps
//! in which it starts again.
//!
//! # Contact
//! From `cloth-collide`: `let mut contacts = PotentialContacts::builder(&mesh).obstacle(body, friction).build()?;`,
//! then `solver.step(&mut state, StepInput::new(dt).contacts(&mut contacts))?`, with the same contacts in every step.
//!
//! What the cloth touches, itself included, is one more energy in `G`, with a gradient and a positive semi-definite
//! second derivative ([`ContactPotential`](cloth_core::contact::ContactPotential)), and a bound on every step: no
//! iterate is accepted that has gone through anything. So a step ends with all forces and inertia in balance. The
//! energy is the sum of a ψ(d) over vertices before bodies, vertices before triangles of cloth, and pairs of edges,
//! with the distance d (m) and the area a that each stands for: a third of the triangles at a vertex, half of that
//! before cloth, the smaller third of two edges. With the thickness h (m; for edges half of it) and the stiffness κ_c
//! (Pa/m; κ is a curvature) of contact
//! ```text
//! ψ = ½ κ_c (h − d)²                       from h/2 to h, pressure κ_c (h − d)
//! ψ = ¼ κ_c h² (½ − ln(2d/h))              below h/2, pressure κ_c h²/(4d): infinite at d = 0
//! ```
//! with ψ, ψ′ and ψ″ continuous at h/2. Choose h as the cloth is thick, but at most a tenth of an edge, and κ_c such
//! that pressures that last stay below `κ_c h/2`. What is pressed deeper has the stiffness `κ_c (h/2d)²`: that, a
//! larger κ_c and a long step cost iterations, and let nothing through. `PotentialBuilder` has the defaults, 1 mm and
//! 10⁶ Pa/m. Friction has the energy `μ λ f(u)` of the displacement u along the surface: `f = u²/(2ε)` up to ε = h/100,
//! and `u − ε/2` beyond, where its force is μ λ. λ is the normal force at the start of the step, so 0 in the step in
//! which cloth lands; with the λ at x friction would be no gradient of an energy. Two results in closed form: a sheet
//! of ρ (kg/m²) rests `h − ρ g/κ_c` above a floor, and in n steps it slides by `a Δt² n(n + 1)/2` down a slope on which
//! its acceleration is a (tests `sheet_rests_where_its_weight_says` and `sheet_on_a_slope_slides_or_sticks` of
//! `cloth-bench/tests/contract/potential.rs`). The quasi-Newton method of [`ImplicitEuler`] and [`Bdf2`] does this:
//! - λ is computed once a step. Near pairs are searched for along each direction: the list holds all vertices, edges
//!   and triangles within h anywhere on the path; the rest adds nothing, so a new list changes no value of G.
//! - The Hessian of contact is recomputed with that of the elements, as `a ψ″ ∂d ∂dᵀ`; what is pressed has λ/d for a ψ″
//!   (primal–dual: `multipliers.rs` of `cloth-collide`). The rest, `a ψ′ ∂²d`, may have negative eigenvalues, and is
//!   left out. So a contact is a term of rank one in the matrix of the multigrid cycle, which comes and goes without a
//!   new pattern; around the whole cycle if it is ten times as stiff as the cloth, or couples all vertices of a part.
//! - Where contact cuts steps short, directions come from conjugate gradients around the cycle, with a second-order
//!   correction of nearly closed pairs ([`ContactHessian`](cloth_core::method::contact_hessian::ContactHessian)); where
//!   hardly any of a direction is free, each vertex follows it as far as it alone can (`implicit/minimizer.rs`).
//!
//! Newton's method does not take over from a step with contact; one that has not converged within
//! [`ImplicitConfig::max_iterations`] ends there, free of crossings. The matrix of [`Solve::Newton`] has the pattern of
//! the elements and no place for pairs that come and go: it refuses contact. In a linearised step that meets something,
//! the cloth is linearised and contact is not. Where it is stopped and has to buckle, which a linear model lacks, it is
//! linearised again ([`Solve::Linearized`]). The midpoint rule takes contact at its end ([`ImplicitMidpoint`]).
//!
//! In explicit methods contact acts at the end of every substep, as constraints with the compliance of the potential
//! ([`ContactConstraints`](cloth_core::contact::ContactConstraints)): as stiff as it may be, it does not shorten the
//! stable step, and what the constraints move becomes velocity. Friction, among them, pulls the point of contact back
//! to where it stuck, with at most μ times the normal force of the same substep. Nothing goes through
//! ([`SymplecticEuler`]).
//!
//! A hard [strain limit](#strain-limits) moves the cloth after its step, and contact then truncates what would cross
//! ([`keep_free`](cloth_core::contact::ContactSource::keep_free)), velocities too. So nothing goes through, but
//! contact, friction and springs are not in balance at the end, and where it truncates the limit counts as not met
//! (`BudgetSpent`). Moved cloth is a new state to the solver: BDF2 starts again, the midpoint rule forgets lasting
//! contact.
//!
//! # What a step does to one oscillation
//! With `z = Δt ω` (tests hold amplitudes and angles to 10⁻¹¹ or less, `z⁴/4` to 2 % at z = 0.05). Written as
//! `u = x − i v/ω` an oscillation is `u′ = iω u`: forward Euler has `u[1] = (1 + iz) u[0]`, implicit Euler
//! `(1 − iz) u[1] = u[0]`, midpoint `(1 − iz/2) u[1] = (1 + iz/2) u[0]`, BDF2 `(3 − 2iz) u[1] = 4u[0] − u[−1]`, and the
//! table modulus and angle of these factors. Symplectic Euler mixes x and v and has a matrix (`stability.rs`) in their
//! place. It moves on the ellipse `x² + (v/ω)² − z x v/ω`, tilted by an amount of order z: hence its order 1.
//!
//! | method | order | amplitude per step | angle per step | stable |
//! |---|---|---|---|---|
//! | [`ExplicitEuler`] | 1 | `√(1 + z²)` | `atan z` | never (damped: `explicit.rs`) |
//! | [`SymplecticEuler`] | 1 | 1 for `z < 2`, else `(z²/2 − 1) + √((z²/2 − 1)² − 1)` | `2 asin(z/2)` | `z < 2` |
//! | [`ImplicitEuler`], also linearised | 1 | `1/√(1 + z²)` | `atan z` | always |
//! | [`ImplicitMidpoint`] | 2 | 1 | `2 atan(z/2)` | always |
//! | [`Bdf2`] | 2 | modulus of `λ = 1/(2 − √(1 + 2iz))`, `1 − z⁴/4` for small z | its argument | always ([why](Bdf2)) |
//!
//! For small z the angles are z and `−z³/3` (forward, implicit Euler, BDF2), `z³/24` (symplectic), `−z³/12` (midpoint).
//! In a period, `2π/z` steps, implicit Euler loses about `1 − exp(−2πz)` of the energy (47 % at z = 0.1), BDF2 about
//! `πz³` (0.3 %), the midpoint rule nothing. The row of BDF2 holds for linear forces, and else while most of the motion
//! has z below 0.57; beyond, unless gravity or load is large beside it, up to every other step is one of implicit Euler
//! ([`Bdf2`]). The mesh has an error of its own, of second order in its edges: waves are too slow (`stability.rs`).
//!
//! The orders are measured, too: on a chain of five links that swings for 0.4 s the error (root mean square over the
//! mass, of a chain of 1 m) goes with Δt as follows
//! (`cargo test --release -p cloth-massspring --features cholesky --test chapter swinging_chain -- --nocapture`).
//!
//! | method | error at Δt = 2 ms | 1 ms | 0.5 ms | order |
//! |---|---|---|---|---|
//! | forward Euler | 3.2 mm | 1.5 mm | 0.76 mm | 1.01 |
//! | symplectic Euler | 1.6 mm | 0.79 mm | 0.40 mm | 1.00 |
//! | implicit Euler, linearised or not | 2.9 mm | 1.5 mm | 0.75 mm | 0.99 |
//! | implicit midpoint | 9.8 µm | 2.4 µm | 0.61 µm | 2.00 |
//! | BDF2 | 36 µm | 9.1 µm | 2.3 µm | 2.00 |
//!
//! # Errors and bad input
//! - **Meshes, materials, masses** are checked by `cloth-core` when they are made: a triangle without area, a wrong
//!   index, a vertex of no triangle, a mass that is not positive.
//! - **Elements made by hand**: vertices that are not there, a stiffness that is no number and rest data that are not
//!   finite are refused when they are given to a builder; a rest length of 0 makes the force linear. A negative k
//!   pushes away from C = 0. In explicit methods that grows, and no check looks for it; implicit ones have a minimum
//!   to find while `M/s² + H` is positive definite. Beyond, no [`HessianPolicy`] helps, as `k ∂C ∂Cᵀ` stays: the step is refused ([`StepError::NotPositiveDefinite`]), spends its iterations or ends at no minimum.
//! - **Building** is refused with a [`BuildError`]: a setting outside its range, settings that exclude each other
//!   ([`Accept::Minimum`] without a factorisation), an element that names a vertex that does not exist, or one twice
//!   (already by `energy`), a matrix too large for its indices.
//! - **A step** is refused with a [`StepError`] if Δt is not positive and finite, if an input or the result is not
//!   finite (the vertex is named), if an explicit step exceeds the stability limit or gains energy
//!   ([`StabilityCheck`]), if the midpoint rule gains it in contact, if no descent is possible, if a matrix is not
//!   positive definite that has to be ([`StepError::NotPositiveDefinite`]), if contact cannot be resolved, or not felt
//!   ([`StepError::ContactNotFelt`], [`Solve::Newton`]). The state is then what it was before the step.
//! - **A state of the wrong length** is a bug of the caller and panics.
//! - **Odd cloth is no error**: springs whose ends coincide get some direction and unfold, a vertex without elements
//!   falls freely, cloth that is prescribed everywhere only moves its pins (`tests/chapter/special.rs`); inverted
//!   elements are positions like others.
//! - **No convergence is no error.** A step has [`Converged`](cloth_core::step::Outcome::Converged) where, as its
//!   Newton decrement estimates, the change of velocity is right to [`ImplicitConfig::tolerance`]. Else it reports
//!   [`Outcome::BudgetSpent`](cloth_core::step::Outcome) and the residual that is left, and the state has advanced:
//!   after [`ImplicitConfig::max_iterations`]; where in contact G falls no more, or hardly in 100 iterations; where the
//!   cloth has been linearised eight times; and where Newton's method has taken over and its matrix does not fit into
//!   the memory, or an iterative solver finds it indefinite (if asked for from the start, these two are errors).
//! - **No method adapts Δt.** After an error the state is as before the step: halve Δt or, with symplectic Euler, take
//!   as many substeps as the `stable_dt` of [`StepError::Unstable`] asks for, and step again. To repeat a step that was
//!   `BudgetSpent`, keep a copy of the state; what moves by itself, such as a body that the cloth pushes, has moved on.
//!
//! # Threads
//! With the feature `parallel` these run on rayon's threads, from 8192 vertices on: energies, gradients and matrices,
//! the multigrid cycle, the vectors of L-BFGS, and dot products by [`dot`](cloth_core::method::vectors::dot). No
//! colouring of elements: each chunk of 2048 vertices visits all elements that touch it, and adds to its own vertices
//! only; an element on the border of two is computed twice. The smoother is Gauss–Seidel within a block of 8192 rows,
//! Jacobi between blocks. A dot product adds up each chunk, and then the chunks in pairs, along a tree given by the
//! number of vertices. Stopping tests, products with an assembled matrix, linear solvers but for multigrid, and damping
//! are serial. So results have the same bits on any number of threads, and without the feature
//! (`cloth-bench/tests/contract/thread_parity.rs`).
//!
//! # Add an element
//! One struct and the traits of [`cloth_core::element`]: `Element<N>` names the vertices, and either `Constraint<N>`
//! gives rows C (functions of the positions, 0 at rest) with `E = ½ Σ k C²`, from which energy, gradient and
//! `Σ k ∂C ∂Cᵀ` follow, or `Energy<N>` gives them directly. Where C is not linear write `curvature`, `Σ k C ∂²C`, too,
//! or every Hessian is Gauss–Newton's, and [`Accept::Minimum`] proves nothing;
//! [`hessian_error`](cloth_core::check::hessian_error) tests it. For `Clamp` and `Abs` your function has to return a
//! positive semi-definite matrix: nobody else takes eigenvalues. Only elements of one vertex count as holding the
//! cloth: the energy of every other must not change when all its vertices are shifted alike, or the shift of momentum
//! is wrong.
//!
//! An example of the first is in [`cloth_core::element`], of the second in [`ImplicitBuilder::energy`]. Only blocks on
//! and below the diagonal of a Hessian are read: it has to be symmetric. Test a new element by
//! [`gradient_error`](cloth_core::check::gradient_error) and `hessian_error` away from rest, by `smallest_eigenvalue`
//! with `Clamp` and `Abs` and, as in `cloth-core/tests/support/element_checks.rs`: no force at rest, the same energy
//! after a shift and a turn, forces and moments that add up to zero. The first two take central differences, of E and
//! of the gradient, over `ε^⅓` of a length that you give, which are off by some 4·10⁻¹¹. Bounds of 10⁻⁷ and 10⁻⁶ allow
//! for finer details and forces that cancel ([`cloth_core::check`]); a wrong sign or factor is far beyond.
//!
//! No trait takes a force that depends on velocity: only α, β and the air are taken implicitly. Give it as
//! [`StepInput::load`], at the v before the step. A drag c then makes `(1 − c Δt/m) v` of v, stable for `Δt < 2m/c`
//! (but for BDF2).
//!
//! # Limits
//! - Second order holds for steps that resolve the motion. Where stiff springs oscillate faster than the step, BDF2
//!   lets them die out within a few steps; the midpoint rule keeps them ringing, and as the energy of springs is not
//!   quadratic it grows until the run is nonsense: stable for one oscillation is not stable for cloth.
//! - The linearised step has no line search: its energy need not stay bounded where springs turn far in a step, and what
//!   turns is slowed. A strip slides off a pole at a fifth of the way in steps of 1/60 s (`sliding.rs`, in `cloth-bench`).
//! - The default, with the feature `cholesky`, converges from cloth that is random, flattened, collapsed into a point
//!   or turned inside out, with stiffnesses and masses that differ by 10⁸ and 10⁶, at steps from 1 ms to 1 s: ten runs
//!   of ten in each of 108 cases. But it can take hundreds of iterations where stiff springs unfold.
//! - Implicit Euler is *heavily damped*: an oscillation of period 10 Δt loses 15 % of its amplitude in every step, slow
//!   ones as much as by a stiffness damping of β = Δt ([`Damping`]). Cloth that swings and wrinkles less with it than
//!   it should, and does not topple or slide off, is the price of the large step, not a property of the cloth. It keeps
//!   linear momentum, not angular momentum.
//! - Symplectic Euler keeps both momenta, and its energy stays within a band; at `z` near 2 the band is wide. The
//!   hanging sheet of 64 × 64 vertices needs at least 369 substeps for a frame of 1/60 s that implicit Euler takes in
//!   one; the corner vertices set that limit (`stability.rs`). With 12 033 springs and 11 781 hinges, at about 5 ns
//!   each (`cloth-core/src/method/parallel.rs`), that is 44 ms. `cloth-bench` takes substeps half as long: 88 ms so, 96
//!   measured where the default takes 15 ([below](#when-not-to-use-this-method)). The stable step shrinks with the
//!   edges: a second costs `V^1.5`, by the default V times iterations that grow slowly.
//! - A compressed sheet has many minima, one for each buckling mode, and saddle points between them. Which minimum is
//!   found depends on the start; by default a saddle point will do, and it may buckle some steps late ([`Accept`]).
//!   Exactly flat cloth under forces in its plane feels none out of it, and neither Newton's method nor L-BFGS leaves
//!   the plane: by default it never buckles. Displace the start a little, or ask for [`Accept::Minimum`].
//! - Springs with slack (a range of lengths without force) change their stiffness from nothing to all at the end of it;
//!   the quasi-Newton method then often finds nothing lower, and Newton's method takes over (example `materials`).
//! - *Locking*: rigid springs on all E edges of cloth without holes leave 3V − E = 3 + b motions, b the number of
//!   boundary edges (by V − E + F = 1 and 3F = 2E − b), 6 of the motions rigid, however many vertices are inside. Stiff
//!   cloth then folds only along lines of edges. The module `dof` of `cloth-core` (feature `cholesky`) measures it and
//!   has the remedies, such as springs on fewer edges or softer under compression.
//! - Isotropic materials only: warp, weft and shear have no moduli of their own. (Springs made by hand may each have a
//!   k; ℂ above says what sheet they are.)
//!
//! # Which settings
//! | for | take |
//! |---|---|
//! | cloth at steps of a frame | the default |
//! | a reference, a rest shape | [`ImplicitConfig::reference`]; one step of 10⁶ s or more, `tolerance: 0` |
//! | seconds of motion in half of the iterations, nothing touched | `tolerance: 1e-2` ([why](ImplicitConfig::tolerance)) |
//! | the least cost of a step, slow or taut cloth | [`ImplicitConfig::linearized`] |
//! | cloth that stiffens or must not stretch beyond a bound | [below](#strain-limits) |
//! | little numerical damping at large steps | [`Bdf2`], best above 11 steps a period; at another Δt, implicit Euler |
//! | motion resolved by the step, energy or angular momentum kept | [`ImplicitMidpoint`], [`SymplecticEuler`] |
//! | soft or coarse cloth, `Δt < 2/ω_max` anyway | [`SymplecticEuler`] |
//!
//! The tolerance is relative to the change of velocity that all forces but gravity and load make in a step. At very
//! long steps that is about `g Δt`, and a small fraction of it is more than cloth moves: for equilibrium ask for 0.
//! Elsewhere halve Δt and the tolerance one at a time, and refine what changes the result more
//! (`cloth-bench study work-precision`).
//!
//! # Strain limits
//! Soft ones are elements: [`StrainLimitSpring`](cloth_core::energy::StrainLimitSpring) and
//! [`StrainLimitTriangle`](cloth_core::energy::StrainLimitTriangle) resist only what lies beyond their range, beside
//! softer springs: a load f stretches one by f/k beyond its end. Hard ones are projections after the step of any
//! method, `WithStrainLimit` of `cloth-pbd`. Provot (1995) shortens springs beyond 10 % to that, one after another:
//! both ends alike, or one if the other is held. `StrainLimiter` there makes passes over the elements, colour by
//! colour, and moves what is beyond its range to the end of it, each vertex by its share of the inverse mass, until
//! none is by more than 10⁻⁴, or for 100 passes. Then `v ← v + Δx/Δt`, with the angular momentum restored. Each
//! correction strains the neighbours (Gauss–Seidel): the result depends on the order, and nothing guarantees an end.
//! Between two pins too far apart nothing is in range, and the outcome is `BudgetSpent`.
//!
//! # Costs
//! With springs and quadratic hinges the default takes about 1.3 kB a vertex without contact, explicit methods 0.8, and
//! Newton's method the Cholesky factor besides, V log V numbers at best. An iteration of the default reads the elements
//! once (once more for each shortened step), the finest level twice (the residual is taken in the forward sweep) and
//! the pairs once; 7 of 30 recompute the Hessian. One of Newton's method has an assembly, a factorisation or more, and
//! a solve. An explicit substep reads the elements once; the estimate of its limit is some products with the Hessian,
//! every 256 substeps, with contacts in every step. To measure: `cloth-bench study newton` (parts), `convergence`
//! (steps), `scale` (memory); `cargo bench -p benches --bench elements`.
//!
//! # When not to use this method
//! It is at its best where the solution has to be right: references, statics, measured materials. Elsewhere:
//! - **Interactive rates.** Half a second of the hanging sheet of 64 × 64 vertices (one thread of a 2-core AMD EPYC Zen
//!   4, commit 63d79ae, `cloth-bench/doc/results.md`) takes 15 ms a step by converged implicit Euler and 3.0 by
//!   projective dynamics, for the same fall and stretch. Between them is `tolerance: 1e-2`. For springs
//!   projective dynamics is "Fast simulation of mass-spring systems" (Liu et al. 2013): as
//!   `½ k (l − L)² = min ½ k ‖x₀ − x₁ − d‖²` over ‖d‖ = L, the d are unknowns beside x; the local step is `d = L n`,
//!   the global step solves a constant matrix, and neither raises G.
//! - **Inextensible cloth.** Rigid links are constraints: take XPBD with zero compliance.
//! - **Beside XPBD and IPC.** XPBD stops after its sweeps, whether they have converged or not. IPC (Li et al. 2020,
//!   <https://doi.org/10.1145/3386569.3392425>) minimises such a G, with a barrier for contact, by Newton's method with
//!   a factorisation in every iteration. The default does without.
//!
//! # Files in reading order
//! 1. `examples/first_program.rs`: the naive method. `examples/three_integrators.rs`, `examples/materials.rs`.
//! 2. `explicit.rs`: forward and symplectic Euler (`explicit/builder.rs`; `explicit/monitor.rs`: energy balance);
//!    `damping.rs`: forces against the motion; `stability.rs`: the largest stable step.
//! 3. `implicit.rs`: a step as a minimisation (`implicit/builder.rs`); `config.rs`: its settings; `implicit/stage.rs`:
//!    `G` and ∇G.
//! 4. `implicit/newton.rs` with `system.rs` (the matrix, kept positive definite) and `line_search.rs` (convergence).
//! 5. `implicit/minimizer.rs` and `quasi_newton.rs`, around
//!    [`LimitedMemory`](cloth_core::method::limited_memory::LimitedMemory): the default; `minimizer/extrapolation.rs`,
//!    `second_order.rs`: longer steps in contact; `progress.rs`: when Newton's method takes over.
//! 6. `implicit/bdf2.rs`, `at_end.rs` (contact of the midpoint rule), `damper.rs`, `air_drag.rs`, `linearized.rs`,
//!    `minimizer/linearized_step.rs`, `drift.rs`.
//!
//! A new integrator: see `implicit.rs`. Most claims of this page are tests in `tests/chapter`
//! (`cargo test --release -p cloth-massspring --features cholesky --test chapter`), those on contact in
//! `cloth-bench/tests/contract`; times and tables are `cloth-bench`'s.
//!
//! # Features
//! `parallel` (default): [rayon's threads](#threads). `cholesky`: the sparse factorisation, for Newton's method by it
//! and for [`Accept::Minimum`]; without, Newton's method takes multigrid.
//!
//! # References
//! - Implicit steps for cloth: D. Baraff, A. Witkin, "Large steps in cloth simulation", SIGGRAPH 1998,
//!   <https://doi.org/10.1145/280814.280821>. As a minimisation: S. Martin, B. Thomaszewski, E. Grinspun, M. Gross,
//!   "Example-based elastic materials", ACM TOG 30(4), 2011, <https://doi.org/10.1145/2010324.1964967>.
//! - Why a compressed spring makes the matrix indefinite: K.-J. Choi, H.-S. Ko, "Stable but responsive cloth", SIGGRAPH
//!   2002, <https://doi.org/10.1145/566570.566624>. Absolute values: H. Chen et al., "Stabler neo-Hookean simulation",
//!   SIGGRAPH 2024, <https://arxiv.org/abs/2406.05928>.
//! - The model of textbooks: X. Provot, "Deformation constraints in a mass-spring model to describe rigid cloth
//!   behavior", Graphics Interface '95. Which k a sheet asks for: A. Van Gelder, "Approximate simulation of elastic
//!   membranes by triangulated spring meshes", J. Graphics Tools 3(2), 1998,
//!   <https://doi.org/10.1080/10867651.1998.10487490>.
//! - Isometric bending: M. Bergou, M. Wardetzky, D. Harmon, D. Zorin, E. Grinspun, "A quadratic bending model for
//!   inextensible surfaces", SGP 2006, <https://doi.org/10.2312/SGP/SGP06/227-230>. By the angle: E. Grinspun, A.
//!   Hirani, M. Desbrun, P. Schröder, "Discrete shells", SCA 2003, <https://doi.org/10.2312/SCA03/062-067>.
//! - BDF: C. F. Curtiss, J. O. Hirschfelder, "Integration of stiff equations", PNAS 38(3), 1952,
//!   <https://doi.org/10.1073/pnas.38.3.235>. What symplectic Euler and the midpoint rule keep: E. Hairer, C. Lubich,
//!   G. Wanner, *Geometric Numerical Integration*, 2nd ed., Springer 2006, <https://doi.org/10.1007/3-540-30666-8>.
//! - Line search and modified Newton methods: J. Nocedal, S. J. Wright, *Numerical Optimization*, 2nd ed., Springer
//!   2006, <https://doi.org/10.1007/978-0-387-40065-5>, chapter 3. L-BFGS: J. Nocedal, "Updating quasi-Newton matrices
//!   with limited storage", Math. Comp. 35, 1980, <https://doi.org/10.1090/S0025-5718-1980-0572855-7>; R. H. Byrd, J.
//!   Nocedal, R. B. Schnabel, Math. Prog. 63, 1994, <https://doi.org/10.1007/BF01582063>.
//! - Multigrid: the [references](cloth_core::method::multigrid#references) of `cloth-core`.

#![forbid(unsafe_code)]

mod config;
mod damping;
mod explicit;
mod implicit;
mod stability;

pub use config::{
    Accept, ExplicitConfig, HessianPolicy, ImplicitConfig, Solve, StabilityCheck, StartGuess,
};
pub use damping::Damping;
pub use explicit::{ExplicitBuilder, ExplicitEuler, SymplecticEuler};
pub use implicit::{Bdf2, ImplicitBuilder, ImplicitEuler, ImplicitMidpoint};
pub use stability::stable_time_step;

pub use cloth_core;
#[doc(no_inline)]
pub use cloth_core::{
    element::Convexity,
    energy::Spring,
    math::Vec3,
    method::linear::{LinearMethod, StoppingCriteria},
    particles::{Particles, State},
    step::{BuildError, StepError, StepInput, StepReport, Stepper},
};
