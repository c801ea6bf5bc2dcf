//! Position-based dynamics (PBD): predict positions without inner forces, then project them onto the constraints.
//!
//! # Example
//! ```
//! use cloth_pbd::{Particles, PbdConfig, PbdSolver, Spring, State, StepInput, Stepper, Vec3};
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
//! Meshes, materials and measures are in [`cloth_core`], re-exported here. A sheet: `Cloth { … }.on(&grid(…)?)?` gives
//! a model, and `PbdSolver::builder(&model.particles)` with `.elements(model.families())` takes it.
//!
//! # Idea
//! A stiff spring makes a stiff differential equation. PBD does not integrate it. It predicts where each vertex goes by
//! its velocity and the external forces alone, then visits the constraints one after another, and moves the few
//! vertices of each along its gradient, light ones further, until it is satisfied or, for a soft one, partly so. The
//! next constraint sees the positions that the one before it wrote (Gauss–Seidel). The velocity follows from the
//! positions at the end. No force is computed, no system solved, and no spring overshoots: unless over-relaxed (by a
//! [`relaxation`](cloth_core::method::position_based::Acceleration) above 1), a visit never moves it beyond its rest
//! length.
//!
//! # From a constraint to the projection
//! **One constraint.** Of all corrections that bring C to zero, to first order, take the smallest in the metric of the
//! masses: minimise `½ Σ mᵢ ‖Δxᵢ‖²` subject to `C + Σ ∂C/∂xᵢ·Δxᵢ = 0`. With a multiplier Δλ that is
//! `mᵢ Δxᵢ = ∂C/∂xᵢ Δλ`, and put into the constraint (Müller et al. 2007, section 3.3),
//!
//! ```text
//! Δλ = −C/w̃,   Δxᵢ = wᵢ ∂C/∂xᵢ Δλ,   w̃ = Σ wᵢ ‖∂C/∂xᵢ‖²,   wᵢ = 1/mᵢ
//! ```
//!
//! with w̃ the generalised inverse mass of the constraint. What is left of C is of second order in Δx, and zero where C
//! is linear along the correction. The inverse masses are not a choice: with them `Σ mᵢ Δxᵢ = Δλ Σ ∂C/∂xᵢ`. Where
//! translations `xᵢ + ε a` leave C as it is, its derivative by ε, `a·Σ ∂C/∂xᵢ`, is zero for every a, and so is the sum:
//! a projection of free vertices keeps the linear momentum. One that holds to a place (a soft pin, a plane) or has a
//! prescribed vertex does not. Under rotations `xᵢ + ε a × xᵢ` the derivative is `a·Σ xᵢ × ∂C/∂xᵢ`; so where they leave
//! C as it is, the moment `Σ xᵢ × mᵢ Δxᵢ = Δλ Σ xᵢ × ∂C/∂xᵢ` is zero. A vertex with w = 0 does not move.
//!
//! **All constraints.** Each scalar C with its gradient is a *row*; an element has one or more. Backward Euler's step
//! is the minimum of `½ ‖x − x̃‖²_M/h² + E(x)`, x̃ the predicted positions and `‖y‖²_M = yᵀ M y`, since its stationary
//! point has `M (x − x̃)/h² = −∂E/∂x`. For infinitely stiff E that is the point nearest to x̃, in the metric of M, at
//! which all constraints hold. A sweep of projections from x̃ is one Gauss–Seidel iteration towards it (exactly so
//! where the constraints are linear): *PBD is the hard limit of backward Euler, solved approximately*. In that limit k
//! has no place. With J = ∂C/∂x the system is `J M⁻¹ Jᵀ λ = −C(x̃)`, and a visit relaxes one row of it. For curved
//! constraints J changes as the sweeps move x, so they end on C = 0, but not exactly at the nearest point. Soft
//! constraints add `1/(k h²)` to the diagonal.
//!
//! **Why k needs a λ.** The equation of a soft constraint is `C + w̃ Δλ + (λ + Δλ)/(k h²) = 0`, so a visit makes
//! `Δλ = −(C + λ/(k h²))/(w̃ + 1/(k h²))`, λ the sum of its Δλ in this substep. The term with λ says how much of its
//! force the spring exerts already; with it Δλ is zero where the spring is in balance, at C ≠ 0. A method that keeps λ
//! is XPBD. A visit of PBD knows C alone, and acts as if it were the first. So sweeps rest at C = 0 only, whatever k,
//! and a soft constraint has to know beforehand how often it will be visited. This crate adds up a λ too, but only to
//! report the work of prescribed vertices: no visit reads it. It starts at zero in each substep, since it belongs to
//! one x̃.
//!
//! **Soft constraints** make the fraction s of the correction in a visit, and so leave `(1 − s)ⁿ` of C after n visits
//! of one constraint alone. With `E = ½ k C²` and `λ = −k h² C`, backward Euler is `M (x − x̃) = λ ∂C/∂x`; for one
//! linear row `C = C̃ + w̃ λ`, C̃ that at x̃, so `(w̃ + 1/(k h²)) λ = −C̃`, and `C = C̃/(1 + k h² w̃)` is left. Set
//! equal, with n sweeps in a substep of h,
//!
//! ```text
//! k = ((1 − s)^(−n) − 1)/(h² w̃)        what n visits with s act as
//! s = 1 − (1 + k h² w̃)^(−1/n)          what a material of stiffness k asks for
//! ```
//!
//! (Both without relaxation or extrapolation.) With a fixed s ([`StiffnessRule::Fixed`]) the cloth is stiffer
//! exponentially in n, and as 1/h². The second line is [`StiffnessRule::Material`], the default: that is how the same k
//! (N/m) that the other methods take reaches PBD. (Springs get theirs from a membrane modulus Y (N/m), Young's modulus
//! times thickness, by [`Membrane::Modulus`](cloth_core::cloth::Membrane::Modulus). In names, `stiffness` of an element
//! is k, that of [`PbdConfig`] the rule for s, and that of [`HierarchyConfig`] the s of the links of its coarse
//! levels.) The rule is exact for one constraint alone whose C is linear along its correction, as a spring's is, and
//! for nothing else; see the [limits](#limits).
//!
//! # The step
//! ```text
//! for each substep of h = Δt/substeps:
//!     v ← v + h (g + w f) where w > 0,  x̃ ← x + h v            prediction; f: load (N) without the weight
//!     x ← x̃
//!     n times, for each row:  xᵢ ← xᵢ − s wᵢ ∂C/∂xᵢ C/w̃        one sweep; then air, then the contact constraints
//!     v ← v + (x − x̃)/h                                        velocities from positions
//! ```
//!
//! It is the loop of Müller et al. 2007, section 3.1, without its damping; `v + (x − x̃)/h` is their `(x − x⁰)/h`,
//! rounded better. Air ([`StepInput::air`]) is projected after each sweep, as a constraint of stiffness (drag in
//! kg/s)/h. `examples/first_program.rs` is this box as plain loops over arrays, and compares itself with [`PbdSolver`]:
//! after 30 steps the two are less than 1e-13 m apart, by rounding.
//!
//! A prescribed vertex, w = 0, moves with its velocity in the state, whatever pulls at it; the work that this takes is
//! [`StepReport::pin_work`] (but see the [limits](#limits)). Nothing is carried from step to step but the state: a
//! fresh solver continues a run with the same bits. The s of a row is kept, but depends on w̃ and h alone, since k is
//! constant: [`set_time`](cloth_core::element::Element::set_time) may change rest lengths and angles, and must not
//! change k.
//!
//! **Stable?** Projecting onto a linear row with 0 ≤ s ≤ 1 takes x nearer, in `‖·‖_M`, to every point that meets it. So
//! a step of one substep without forces from x⁰ with C(x⁰) = 0 gains no kinetic energy:
//! `h ‖v⁺‖ = ‖x⁺ − x⁰‖ ≤ ‖x̃ − x⁰‖`. This is for linear rows and pins at rest, without extrapolation, a hierarchy or
//! Jacobi sweeps that are not averaged. Where x⁰ violates rows, what the sweeps take back becomes velocity.
//!
//! **How much is lost?** The prediction is a step of symplectic Euler, a row alone one of implicit Euler: both of first
//! order. A spring alone that oscillates along its axis divides its energy by 1 + k h² w̃ in a substep, as with
//! implicit Euler (with a fixed s by (1 − s)^(−n)). A rigid link about a prescribed end that has turned by an angle a
//! in one substep turns in the next by b with `tan b = sin a/(2 − cos a)`, b ≈ a − a³: velocities from positions point
//! along the chord, and the projection removes what the prediction along it adds to the radius. So a link with the
//! angular velocity Ω loses the fraction 2 (h Ω)² of its kinetic energy in a substep: order h in a given time.
//!
//! **Constraints** are whatever shows rows `C(x)`, `∂C/∂x`, `k` with `E = ½ Σ k C²`: distance, bending (flat, curved,
//! by angle), area, volume, soft pin, the strains of a triangle. A hard pin is a prescribed vertex, `w = 0`.
//!
//! | constraint | C | its gradient | k | element |
//! |---|---|---|---|---|
//! | distance | ‖x₀ − x₁‖ − L | ±(x₀ − x₁)/‖x₀ − x₁‖ | N/m | [`Spring`] |
//! | bending by angle | θ − θ₀ | gᵢ = −‖e‖ nᵢ/‖nᵢ‖² at the tips i = 2, 3, with the edge e = x₁ − x₀ and the normals n₂ = e × (x₂ − x₀), n₃ = (x₃ − x₀) × e; −t₂ g₂ − t₃ g₃ at x₁, tᵢ = (xᵢ − x₀)·e/‖e‖²; at x₀ what makes the sum zero | N·m | [`DihedralHinge`](cloth_core::energy::DihedralHinge) |
//! | isometric bending | the three coordinates of z = Σ qᵢ xᵢ, qᵢ numbers of the shape at rest (below) | qᵢ along each axis | N/m | [`CurvatureHinge`](cloth_core::energy::CurvatureHinge) |
//! | area | A − A₀ | ½ n̂ × the opposite edge, n̂ the unit normal; the edge from the next vertex to the one after it | N/m³ | [`AreaTriangle`](cloth_core::energy::AreaTriangle) |
//! | strains of a triangle | (G₁₁ + G₂₂)/√2, (G₁₁ − G₂₂)/√2, √2 G₁₂ (dimensionless) of the Green strain G = ½(FᵀF − I), F = Σ xᵢ bᵢᵀ (3 × 2) from rest to present, bᵢ (1/m) constant | F Sᵣ bᵢ/√2 with S₁ = I, S₂ = diag(1, −1), S₃ what swaps the two axes | J | [`StvkTriangle`](cloth_core::energy::StvkTriangle) |
//!
//! *Angle.* θ is zero where the hinge is flat, and negative where the tips rise to the side of the normals: it knows up
//! from down. θ − θ₀ is taken between −π and π, so a hinge more than half a turn from its rest angle unfolds the other
//! way. Flat is no special case, since no arc cosine is differentiated. Where the gradient comes from: let the corners
//! of the triangle 0, 1, 2 move by u₀, u₁, u₂ along its normal. The point of the edge nearest to the tip moves by (1 −
//! t₂) u₀ + t₂ u₁, so the tip rises by u₂ − (1 − t₂) u₀ − t₂ u₁ above the edge. Over its height ‖n₂‖/‖e‖ this is the
//! angle by which the triangle turns about the edge, and θ falls by it: `g₂ = −(‖e‖/‖n₂‖) n₂/‖n₂‖` at the tip, −t₂ g₂
//! and −(1 − t₂) g₂ at the ends of the edge. Motion within its plane does not turn it; the other triangle adds its own.
//! In a triangle of small height the gradient grows as its inverse, and the correction falls with it; a hinge with a
//! triangle without area is left alone.
//!
//! *Which bending?* Isometric bending has `q = (c₁ + c₃, c₀ + c₂, −(c₀ + c₁), −(c₂ + c₃))` (dimensionless, sum 0), c₀
//! and c₁ the cotangents at rest of the angles of triangle 0, 1, 2 at x₀ and x₁, c₂ and c₃ those of triangle 0, 1, 3; z
//! (m) is zero where the hinge is flat and unstretched. Of the first triangle z has
//! `c₁ (x₀ − x₂) + c₀ (x₁ − x₂) = (‖e‖/H) (p − x₂)`, p the foot of its height H on the edge: a vector from the tip
//! towards the edge, and as long as the edge. The two are opposite where the hinge is flat, and add up to 2 ‖e‖
//! sin(θ/2) where it is folded ([derivation](cloth_core::energy::CurvatureHinge)). z is linear in x, has a constant w̃
//! and is cheap ([costs](#costs)); take it for cloth that is flat at rest and hardly stretches. By angle where a fold
//! has a rest angle, or is sharp. A spring between the tips ([`Spring::across`]) is no substitute: its length is
//! stationary where the hinge is flat, so it does not resist a small bend. (Not offered: the arc cosine of Müller et
//! al. 2007, appendix A, which does not know up from down and has a gradient of 0/0 where flat; the distance from a
//! centroid of Kelager et al. 2010, without a side.)
//!
//! | equation | function |
//! |---|---|
//! | inertial prediction; velocities from positions | [`Motion::predict`], [`Motion::update_velocities`] |
//! | C, ∂C/∂x, k | [`Constraint::rows`] of each element of [`energy`](cloth_core::energy) |
//! | `Δλ = −s C/w̃`: the formula of a row | `stiffness.rs`: `Projection::equation`, as `residual` = s C and `scaled_compliance` = 0 in `(w̃ + scaled_compliance) Δλ = −residual` |
//! | `w̃`; that equation solved for `Δλ`; `wᵢ ∂C/∂xᵢ Δλ` of one element | `weight`; `change_over`; `row_by_row_correction` and its other forms in `cloth-core/src/method/position_based/correction.rs` |
//! | the loop over rows | [`Families::sweep`], in the order of [`Sweep`] |
//! | relaxation ω; extrapolation by ρ | [`Acceleration`], [`Chebyshev`] |
//! | `((1 − s)^(−n) − 1)/(h² w̃)` | [`effective_stiffness`] |
//! | `1 − (1 + k h² w̃)^(−1/n)` | [`projection_stiffness`] |
//! | work of prescribed vertices, `−Σ ∂C/∂xᵢ·vᵢ ΣΔλ/h`, and `Σ ∂C/∂xᵢ ΣΔλ/h²`, their forces | [`Motion::count_pin_work`] |
//! | the loop around them | [`PbdSolver`]: `solver.rs` |
//! | coarse levels: `Δxᵢ = Σⱼ Pᵢⱼ Δxⱼ` | [`Hierarchy`], [`PbdSolver::with_hierarchy`] |
//! | `σ_min ≤ σ ≤ σ_max` | [`StrainLimiter`], [`WithStrainLimit`] |
//!
//! [`Motion::predict`]: cloth_core::method::position_based::Motion::predict
//! [`Motion::update_velocities`]: cloth_core::method::position_based::Motion::update_velocities
//! [`Motion::count_pin_work`]: cloth_core::method::position_based::Motion::count_pin_work
//! [`Constraint::rows`]: cloth_core::element::Constraint::rows
//! [`Families::sweep`]: cloth_core::method::position_based::Families::sweep
//!
//! # Order of the constraints, colours and threads
//! A family is what one call of [`energy`](PbdBuilder::energy) adds: elements of one type. A sweep visits the families
//! in the order in which they were added, and the elements of a family in the order of [`Sweep`]. The result depends on
//! both; the constraint visited last is met best. A rigid chain at rest, swept once in a substep from its support, sags
//! by `g h² N(N − 1)/2` ([limits](#limits)). Swept from its free end, it ends with link 1 unstretched and each other
//! link i too long by `g h² (N + 2 − i)`: in all `g h² (N − 1)(N + 2)/2`, 10 % more for N = 20. With Chebyshev a
//! Gauss–Seidel sweep is *symmetric*, forward and then back: the family added *first* is visited last, and positions
//! are extrapolated after it. [`Sweep::Colored`], the default, colours the elements greedily, so that no two of a
//! colour share a vertex: they can be visited in parallel, without locks, and give the same bits on any number of
//! threads (feature `parallel`; a second thread takes part in colours of at least 4096 elements).
//!
//! *How many colours?* Where at most d elements of N vertices meet at a vertex, at least d, and at most N (d − 1) + 1:
//! an element finds no more than d − 1 others at each of its vertices. A sheet of squares with diagonals of alternating
//! direction has d = 8 and 8 colours for its springs, d = 16 and 18 for its hinges.
//!
//! [`Sweep::Sequential`] keeps the order given and one thread. Jacobi sweeps solve all elements at the same positions.
//! *In full* ([`Sweep::PlainJacobi`]) each element makes all of its correction; *averaged* ([`Sweep::Jacobi`]) it
//! divides it by the largest number of elements, of all families, at one of its free vertices. All its vertices share
//! that number: if each vertex divided what it receives by its own count, the two ends of a spring would be scaled
//! differently, and momentum would be lost. Which relaxation is stable:
//! [`PbdConfig`](PbdConfig#how-fast-sweeps-converge).
//!
//! What one sweep leaves of the slowest error of a straight chain of N rigid links, held at one end:
//!
//! | sweep | factor | sweeps for a factor of ten, N = 20 |
//! |---|---|---|
//! | Jacobi, averaged (fraction ½) | `cos²(π/4N)` | 1493 |
//! | Jacobi, in full | `cos(π/2N)` | 746 |
//! | Gauss–Seidel | `cos²(π/2N)` | 373 |
//! | Chebyshev on Jacobi, in full | `cos(π/2N)/(1 + sin(π/2N))` | 29.3 |
//! | Gauss–Seidel with `ω = 2/(1 + sin(π/2N))` | `ω − 1` | 14.6 |
//!
//! A Jacobi sweep takes the error of each link to the mean of its two neighbours, mirrored at the support and zero
//! beyond the free end. So its eigenvectors are `cos((i − 1)β)`, i = 1 … N, with `cos(Nβ) = 0`, the eigenvalues
//! `cos β`, the slowest with `β = π/2N`. For a tridiagonal matrix the eigenvalues of Gauss–Seidel are their squares
//! (Young 1954), from one end to the other as well as by two colours: colours change the answer of unconverged sweeps,
//! not this rate. For large N a factor of ten takes ln 10 (2N/π)² = 0.93 N² Gauss–Seidel sweeps, 1.47 N with Chebyshev
//! on Jacobi, 0.73 N with the best ω. A test holds Gauss–Seidel against this law. For sheets nothing is proved, but
//! [measured](#acceleration), coloured; in the order given it was not measured for PBD on sheets (the study there has
//! it for XPBD). One elimination would solve such a system exactly: not offered here, see `cloth-xpbd`.
//!
//! # How many substeps, how many iterations
//! With rigid projections ([`StiffnessRule::Fixed`] of 1) a straight chain of N links of length l and equal masses,
//! swept once per substep from its support, hangs with a mean strain of `ε = g h² (N − 1)/(2 l)`; so a wanted ε takes
//! `Δt √(g (N − 1)/(2 l ε))` substeps at rest. A chain that falls at a speed v and is stopped by its support is
//! strained by up to v h/l more until it rests; swept in two colours, every other link first, single links by up to 2 v
//! h/l more.
//!
//! n ≤ N iterations of one substep divide the sag by n or a little more, n substeps by n² (for XPBD: Macklin et al.
//! 2019, "Small steps"). At rest the sweeps of a substep have to lift the chain by what it has fallen, g h². Visits are
//! linear in the C of the links, so a sweep lifts twice as far where all are stretched twice as much, and n sweeps, as
//! long as they change the stretch but little, n times as far as one. So n sweeps need an n-th of the stretch, and n
//! substeps of one sweep an n²-th, as each falls n² times less far. Rounding alone bounds h: velocities err by 2⁻⁵²
//! ‖x‖/h, 2e-11 m/s at 1 m and 10 µs. "As many iterations as the mesh is wide", a popular rule, leaves
//! `cos^(2N)(π/2N) ≈ e^(−π²/4N)` of the slowest error: 90 % for N = 24.
//!
//! # Acceleration
//! **Chebyshev** extrapolates over sweeps: `x⁺ = γ (S(x) − x⁻) + x⁻` with γ = 1 for the first sweeps, then
//! `2/(2 − ρ²)`, then `4/(4 − ρ²γ)` again and again; ρ is the spectral radius of a sweep, given or estimated. **A
//! hierarchy** makes *coarse corrections*: on coarser levels first, by links that pull where they are too long, and
//! push only where the correction itself has made them shorter. What they save: a sheet of 128 × 128 vertices, rigid
//! springs, hangs at rest by its upper edge or its two upper corners, h = 1/60 s. Gravity takes every vertex down by
//! `g h²`; sweeps until a hundredth of that is left, and their time on one thread of a 2-core AMD EPYC, commit a367cc83
//! (the smallest of some repetitions: `cargo run --release -p cloth-bench -- study acceleration --tables`). "≥":
//! extrapolated from 4 000 or 16 000 sweeps at the rate of their second half.
//!
//! | | sweeps, edge | ms | sweeps, corners | ms |
//! |---|---|---|---|---|
//! | coloured Gauss–Seidel | ≥ 22 238 | 4840 | ≥ 180 884 | 39 800 |
//! | SOR on it, ω best for a chain of 127 links | 799 | 171 | ≥ 47 869 | 11 300 |
//! | Chebyshev on it, symmetric, ρ estimated | 605 | 317 | 1572 | 875 |
//! | the same, ρ = 1 − 2.5/128², nearly the cos²(π/2N) of a chain of N = 127 links | 303 | 163 | 3510 | 1800 |
//! | hierarchy, one coarse correction | 1 | 5 | ≥ 180 787 | 40 900 |
//! | hierarchy, every 10 sweeps | 1 | 5 | ≥ 74 979 | 34 200 |
//!
//! ω and ρ stand for how slowly the slowest error decays. By an edge that is the error of a column, a chain. By two
//! corners the weight of all columns goes through the few links there, as that of a heavy end: the error decays eight
//! times more slowly, and what is right for a chain does too little. An estimate adapts.
//!
//! The hierarchy is at its best where the cloth hangs taut from long supports. It helps little where a sheet hangs flat
//! by two corners: between them the cloth is compressed, and a coarse correction does not lengthen links that are short
//! when it begins. By an edge one coarse correction leaves 0.2 to 0.5 % of the fall, on some sizes more than 1 %. That
//! rest decays as slowly as without a hierarchy: on 64 × 64 vertices it takes 15 further sweeps to 1 %.
//!
//! # Which settings
//! | scene | take |
//! |---|---|
//! | hard constraints | few iterations, many substeps: the sag falls with the square of these |
//! | a rope, a chain | [`Sweep::Sequential`], links in order from the support |
//! | a fine sheet, tens of sweeps and more | Chebyshev on the coloured sweep, ρ estimated |
//! | a sheet that hangs taut from a long support | a [`Hierarchy`], one coarse correction a substep |
//! | cloth that hangs from few anchors, few sweeps | [long-range attachments](#long-range-attachments) |
//! | a chain of N hard links, a sheet by an edge with N in a column, tens of sweeps and more | over-relaxation, [`Acceleration::relaxation`] of 2/(1 + sin(π/2N)); with few supports it saves [far less](#acceleration) |
//! | Poisson's ratio, or a modulus alike in all directions on any mesh | the strains of a triangle in place of springs: `MembraneElements::Stvk` in [`Cloth::discretized_with`](cloth_core::Cloth::discretized_with). Softer than its modulus, as [all materials](#limits); its w̃ is not constant, so each visit computes three powers `(1 + k h² w̃)^(−1/n)` |
//! | a bound on stretch, after this or another method | [`WithStrainLimit`] |
//! | a soft material | substeps until `k h² w̃ ≪ 1`, or [another method](#when-not-to-use-this-method) |
//! | the order of the elements must not count | Jacobi, averaged, with Chebyshev |
//!
//! # Costs
//! A step costs substeps × iterations × Σ elements × their cost, and beside it a few passes over the vertices in a
//! substep; a triangulated sheet has about three springs and three hinges a vertex. On one thread a spring takes 4.5 ns
//! a sweep (the first row above: 48 641 springs). In springs, area takes 10 to 15, bending by angle 20 to 30 (128 × 128
//! vertices, falling, commit 98e36abd, on busy 2-core machines, so that only ratios count; on yours:
//! `cargo run --release -p cloth-pbd --example cost_of_a_sweep`). Isometric bending took 2 to 3 there. The visit of
//! `cloth-xpbd`, nearly the same code, took 1.5 to 2.1 in a bench that keeps the smallest times. So with three of each
//! a vertex it is 60 to 75 % of a sweep. The rule costs nothing where w̃ is constant. Where it is not, as for area and
//! angle, [`StiffnessRule::Material`] computes a power in each visit, [`StiffnessRule::Fixed`] none. All numbers are in
//! double precision, and nothing is allocated after the first step. Of a spring its root and its division count most:
//! the form with the gradient divided in between takes [twice as long](cloth_core::element::RowForm::Unit).
//!
//! Chebyshev takes more than twice the time of a plain sweep, a coarse correction that of 11 sweeps
//! ([table](#acceleration)). A long-range attachment is one more row.
//!
//! *Contact and self-contact* cost `begin_substep` and `end_substep` in each substep, and a sweep over what can touch
//! in each sweep: `cloth-bench run cloth-bench/scenes/ball.toml --method pbd` prints `contact_ms_median`.
//!
//! # Strain limiting
//! For the end of a step of *any* method: [`WithStrainLimit`] follows each step by projections onto ranges of lengths,
//! areas or principal stretches, and updates the velocities so that linear and angular momentum are conserved where no
//! vertex is prescribed and contact does not cut a displacement short. Passes grow with the square of the vertices a
//! side ([`StrainLimiter`] has numbers).
//!
//! # Pin and drag
//! `particles.prescribe(i)?` before the solver is built; before each step set `state.velocities[i]` to
//! `(target − state.positions[i])/Δt`, or let [`Pins`](cloth_core::pin::Pins) do it. A solver copies the masses when it
//! is built: to grab or release another vertex, build a new one and go on with the state.
//!
//! # Contact
//! From `cloth-collide`: `let mut contacts = PotentialContacts::builder(&mesh).obstacle(body, friction).build()?;`,
//! then `solver.step(&mut state, StepInput::new(dt).contacts(&mut contacts))?`, with the same contacts in every step.
//! They include those of the cloth with itself, unless `self_collision(false)`. The solver knows only
//! [`ContactConstraints`](cloth_core::contact::ContactConstraints), and runs no code for contact without them.
//!
//! In each substep `begin_substep` finds what can touch on the way to x̃. `sweep`, last in each sweep, visits the
//! contact constraints `C = n̂·Σ c_k x_k − d₀ ≥ 0` (normal n̂, nearest points by their weights c_k, negative on one
//! side) with a compliance α and a λ that they, unlike the cloth's rows, keep for the substep, and friction, on
//! positions too, within μ λ (μ dimensionless). Contact comes last, so it is met best, and the rows of the cloth are
//! disturbed; a prescribed vertex does not yield to it. What pushes the cloth out becomes velocity.
//!
//! *Where d₀ and α come from.* `cloth-collide` gives contact an energy A ψ(d) of the distance d, with a range r, the
//! thickness (1 mm unless set, half of it between two edges), a stiffness κ (10⁶ Pa/m unless set), and A the area at
//! rest that the contact stands for. That is a third of the triangles around a vertex, before other cloth half of that;
//! of two edges the smaller of theirs, a third of the triangles beside each.
//!
//! ```text
//! ψ = ½ κ (r − d)²                 from d = r/2 to r; nothing beyond
//! ψ = ½ κ t² − κ t² ln(d/t)        below t = r/2, a barrier
//! ```
//!
//! The force of a row is linear in C, so ψ′ is replaced by its tangent at the d of the start of the substep:
//! `α = 1/(A ψ″)`, and `d₀ = d − ψ′/ψ″`, where the tangent is zero. Above r/2 `d₀ = r` and `α = 1/(A κ)`; below
//! `d₀ = 2d`, and the row is stiffer, `ψ″ = κ t²/d²`; below 0.05 r the force stays that at 0.05 r. A visit is XPBD's,
//! `Δλ = max(−λ, −(C + α̃λ)/(w̃ + α̃))` with `α̃ = α/h²`.
//!
//! *After the sweeps* `end_substep` tests all paths. While pairs come nearer than a tenth of their distance, they are
//! made hard (α = 0) for 5 more sweeps, up to 3 times; then their vertices go half as far, up to 3 times, or stay where
//! the substep began, up to 6 times. As a last resort pairs are pushed apart one by one, or move together as one rigid
//! body. Then `change_velocities`, where a coefficient of restitution e is set, gives each pair that approached with a
//! speed v_a along n̂ and touched the separation velocity e v_a, by an impulse `(e v_a − v_s)/w̃`, v_s that before.
//!
//! *Is Coulomb's cone exact?* A visit first updates λ of its constraint, then its friction `λ_f ← Π(λ_f − u/w̃)`,
//! `w̃ = Σ c_k² w_k`: u is how far the point is from where it stuck, in the tangent plane, and Π cuts to the disk
//! `‖λ_f‖ ≤ μ λ`, round and not a polygon. So however few the sweeps, no contact leaves its cone. The rest of the law,
//! no slip or `λ_f = −μ λ u/‖u‖`, is what a fixed point of this update says, and holds where the sweeps converge. What
//! comes after them, paths cut short and restitution, is outside it.
//!
//! *Prescribed and inside a body?* It stays there: a body and a prescribed vertex are no pair. Prescribed parts of the
//! cloth that cross each other, or leave free cloth no path, end the step with [`StepError::Contact`].
//!
//! [The strain that sweeps leave](#limits) is elastic energy, which contact can release. A sheet of 64 × 64 vertices
//! and 0.2 kg that falls 5 cm onto a ball gets 0.6 J from gravity with implicit Euler; with the default of 20
//! iterations it gains some 1500 J (`cloth-bench/doc/results.md`).
//!
//! # Errors and bad input
//! - **Building** is refused with a [`BuildError`]: a setting out of its range, an element that names a vertex twice or
//!   one that is missing, elements that are no constraints, a stiffness that is no number. Its sign is
//!   [not checked](#limits) here, but [`Cloth::on`](cloth_core::Cloth::on) refuses one that is negative or not finite, [`Particles::new`] a mass that is
//!   not positive and finite.
//! - **A mesh** is refused by [`TriMesh::new`](cloth_core::TriMesh::new) with a [`MeshError`](cloth_core::MeshError),
//!   an edge of three or more triangles by whatever asks for edges, as [`Cloth::on`](cloth_core::Cloth::on) and
//!   [`Hierarchy::build`]. Elements made by hand need no mesh: a vertex in none of them flies freely, a rest length may
//!   be zero, and an edge may have hinges for every two of its triangles. A triangle turned over is at rest, since
//!   neither lengths nor areas have a sign.
//! - **A step** is refused with a [`StepError`] if Δt is not positive and finite (`InvalidTimeStep`), or if gravity,
//!   loads, positions or velocities are not finite (`NonFiniteInput`, with the first such vertex), and if its *result*
//!   is not finite (`NonFinite`). In all cases the state is what it was before the step, and the solver can be used
//!   again.
//! - **A state or load of the wrong length** is a bug of the caller and panics.
//! - **Degenerate elements are no error.** A row with w̃ = 0 is left alone: all its vertices prescribed, a tetrahedron
//!   on a line, a triangle in a point. The two ends of a spring that coincide, and an
//!   [`AreaTriangle`](cloth_core::energy::AreaTriangle) flattened to a line, are driven apart in a direction that
//!   depends on their numbers only.
//! - **No convergence test.** A step makes its sweeps and reports [`Outcome::BudgetSpent`](cloth_core::step::Outcome).
//!   To see how a scene converges, pass an [`Observer`](cloth_core::step::Observer) with [`StepInput::observer`]: it
//!   gets the positions after every sweep, numbered from 1.
//!
//! # Add an element
//! One struct and two traits of [`cloth_core::element`]: `Element<N>` names the vertices, `Constraint<N>` gives the
//! rows. The solver takes it as it takes ours; colours, threads and acceleration follow. For an inequality φ(x) ≥ 0
//! give the value min(φ, 0), and a zero gradient where φ > 0. (XPBD needs
//! [`dead_zone_rows`](cloth_core::element::Constraint::dead_zone_rows) too, to take a multiplier back.) N is fixed when
//! the element is compiled: a constraint on all vertices, as the volume of a balloon, is none; that one is
//! [`ClosedVolume`](cloth_core::enclosure::ClosedVolume), and comes in by the hook of contact.
//!
//! ```
//! use cloth_pbd::cloth_core::check::gradient_error;
//! use cloth_pbd::cloth_core::element::{Constraint, Element, Row};
//! use cloth_pbd::{Particles, PbdSolver, State, StepInput, Stepper, Vec3};
//!
//! /// Keeps a vertex on a plane through the origin: `C = n·x` (m).
//! #[derive(Clone, Copy, Debug)]
//! struct OnPlane { vertex: u32, normal: Vec3, stiffness: f64 }
//!
//! impl Element<1> for OnPlane {
//!     fn vertices(&self) -> [u32; 1] {
//!         [self.vertex]
//!     }
//! }
//!
//! impl Constraint<1> for OnPlane {
//!     type Rows = [Row<1>; 1];
//!
//!     fn rows(&self, [x]: &[Vec3; 1]) -> [Row<1>; 1] {
//!         [Row { value: self.normal.dot(x), gradient: [self.normal], stiffness: self.stiffness }]
//!     }
//! }
//!
//! let plane = OnPlane { vertex: 0, normal: Vec3::y(), stiffness: f64::INFINITY };
//! // First of all: `k C ∂C` against differences of `½ k C²`. For k = ∞ both are infinite and nothing is tested, so
//! // of a soft copy. 1.0 (m) is the size of the element; a coordinate moves by 6e-6 of it, `f64::EPSILON.cbrt()`.
//! let soft = OnPlane { stiffness: 50.0, ..plane };
//! assert!(gradient_error(&soft, &[Vec3::new(0.3, -0.2, 1.0)], 1.0) < 1e-9);
//! let particles = Particles::new(vec![0.5])?;
//! let mut solver = PbdSolver::builder(&particles).energy(vec![plane]).build()?;
//! let mut state = State::at_rest(vec![Vec3::new(0.3, 0.2, 0.0)]);
//! solver.step(&mut state, StepInput::new(0.1))?;
//! assert_eq!(state.positions[0], Vec3::new(0.3, 0.0, 0.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Then as in `tests/all/constraints.rs`: one element against `(1 − s)ⁿ`; all vertices free, rigid, against C = 0 and
//! the momentum; shapes without a gradient.
//!
//! # Long-range attachments
//! A curve over the cloth from a vertex x to an anchor p is at least as long as the straight line between them, and
//! where no triangle is stretched, no longer than at rest. So `‖x − p‖ ≤ R`, with R the length at rest of any curve
//! over the cloth from x to p; the shortest, the geodesic, says most (Kim et al. 2012). A longer R lets the cloth
//! stretch by as much before the bound acts. A shorter one is wrong: with the straight distance, cloth that is folded
//! or rolled at rest could not open. How far R is above the geodesic of a flat sheet, over many triangles in the worst
//! direction, however fine the mesh:
//!
//! | shortest way | too long by |
//! |---|---|
//! | across triangles, [`Geodesics`](cloth_core::method::multigrid::Geodesics) | 0; more behind a hole or an obtuse triangle |
//! | along edges, alternating diagonals | √(4 − 2√2) − 1 = 8.2 % |
//! | along edges, equilateral | 2/√3 − 1 = 15.5 % |
//! | along edges, one-way diagonals | √2 − 1 = 41 % |
//!
//! The element is a [`StrainLimitSpring`](cloth_core::energy::StrainLimitSpring) from x to a prescribed p, with
//! shortest length 0, longest R and infinite stiffness, which [`StiffnessRule::Material`] projects in full. It moves x
//! alone. So, added last, it holds after every Gauss–Seidel sweep, however few there are, unless
//!
//! - air or contact, which come after it, move x;
//! - the relaxation is not 1;
//! - Chebyshev extrapolates, and visits it in the middle of a symmetric sweep.
//!
//! (In a Jacobi sweep nothing is last.) It bounds the stretch away from p and no other. p may move: R belongs to the
//! rest shape, ‖x − p‖ to now. Several anchors of x are several rows, of which the one visited last holds exactly. Two
//! can both hold as long as the distance of their anchors is not above the sum of their R. All rows of one p share a
//! vertex, so each has a [colour](#order-of-the-constraints-colours-and-threads) of its own. For thousands of them
//! write an element of x alone, N = 1, that has p as numbers (a moving one by `set_time`): no two share a vertex then,
//! and one colour is enough.
//!
//! # Limits
//! - **The material is met by one constraint alone.** Constraints that share vertices spoil each other's corrections,
//!   and then the rule gives cloth *softer* than its k, the more so the larger `k h² w̃` and the longer the chain: two
//!   springs in a row of k = 100 N/m, 10 g a vertex, h = 1/60 s, sag 1.9 times too far; twenty of 10⁴ N/m 84 times with
//!   20 iterations, 252 with one (2.9 and 3.5 at 1 kg a vertex). By hand: N springs and equal masses m, swept once a
//!   substep from the support, sag `1 + (k h²/m)(N − 1)/(N + 1)` times too far, 1.926 for the two. More iterations do
//!   not cure it: each then corrects less, and the whole tends to a limit. For n fixed and h → 0, `s ≈ k h² w̃/n`, and
//!   n visits move by `−h² w k C ∂C`: the explicit force at x̃. The method then converges to the material with order 1,
//!   where `k h² w̃ ≪ 1` for every row; there symplectic Euler is cheaper.
//! - **With [`StiffnessRule::Fixed`] the stiffness depends on the iterations**: it grows with each of them and with
//!   each smaller step, without bound, and no number of iterations is the right one.
//! - A finer mesh needs more iterations: for a straight chain of N rigid links one sweep leaves `cos²(π/2N)` of the
//!   error, and about `1 − m/((N − 1) M)` where a mass M ≫ N m hangs at the end of links with masses m
//!   ([why](PbdConfig#how-fast-sweeps-converge)). At rest a rigid chain of N links of equal mass, swept once per
//!   substep from its support, sags by `g h² N(N − 1)/2`.
//! - Averaged Jacobi is slow: with springs alone six or eight constraints meet at a vertex, with hinges more, and each
//!   makes a sixth, an eighth or less of its correction. Without averaging it diverges there. It is meant to be
//!   extrapolated.
//! - Chebyshev pays with many sweeps (below ten it has hardly begun), and makes a material of finite k stiffer than the
//!   same number of plain sweeps: [`StiffnessRule::Material`] counts plain ones. A
//!   [symmetric](#order-of-the-constraints-colours-and-threads) sweep is twice the work. Where extrapolation makes
//!   corrections grow, it is disabled until the next substep.
//! - The hierarchy, too, makes cloth stiff whatever its k: see [`Hierarchy`].
//! - **Redundant and contradictory hard rows.** Redundant ones agree: sweeps converge to positions that meet all, and a
//!   row that others have met moves nothing. Where no point meets all rows each visit meets its own and undoes others.
//!   Gauss–Seidel sweeps then end in a cycle: after each the row visited last is met, and positions lie between what
//!   the rows ask for. Averaged Jacobi has a limit, a compromise.
//! - It is not the minimiser of implicit Euler, at any number of iterations: the iteration with a fixed s > 0 tends to
//!   C = 0, whatever k.
//! - Linear momentum is conserved to round-off in free flight. Angular momentum is not: each correction has no moment
//!   about the positions at its visit, but the lever arms turn during the step. The loss is of order h, as in implicit
//!   Euler. Kinetic energy is lost too, of order h. Pins, soft pins and contact with obstacles change both momenta; a
//!   [`Hierarchy`] and extrapolation keep the linear one.
//! - Its forces are not those of the material. A row pushes with `ΣΔλ/h²`, summed over its visits in a substep, and so
//!   do prescribed vertices that move: `pin_work` is the work of these forces. With a [`Hierarchy`] or
//!   [`WithStrainLimit`] it is not all of the work, as it has none of what their corrections pull at a prescribed
//!   vertex. The elastic energy `½ Σ k C²` of the stretch that sweeps leave is not conserved by anything here, and may
//!   be thousands of times the work that was done. PBD does not turn it into motion; contact, a strain limit, or
//!   another method that continues the run may.
//! - There is no damping but the [method's own](#the-step). That of Müller et al. 2007, section 3.5, moves each
//!   velocity by a fraction of its distance from the rigid motion with the same momenta, `v_c + (I⁻¹L) × (xᵢ − x_c)`:
//!   v_c and x_c of the centre of mass, L the angular momentum and I the inertia about it. It treats the whole cloth as
//!   one stiff body: waves and folds of any length die out alike, and the fraction counts steps, not seconds. So it is
//!   not offered; scale velocities between steps for more. No speed is clamped either.
//! - Isotropic materials only: no moduli of their own along warp and weft. (Springs made by hand may each have a k.)
//! - Stiffnesses are taken to be zero, positive or infinite; NaN is refused, a sign not. A negative one pushes away from
//!   C = 0; where `k h² w̃ ≤ −1` there is no s, and the step ends with [`StepError::NonFinite`].
//!
//! # When not to use this method
//! Half a second of a falling sheet of 64 × 64 vertices, held by two corners (1 m, 0.2 kg/m², 10⁴ N/m, Δt 1/60 s; one
//! thread of a 2-core AMD EPYC Zen 3, commit 257771a6, medians of `cloth-bench run hang --n 64 --steps 30 --threads 1
//! --method M`, with `--set substeps=1` for PBD and `substeps=published` for XPBD):
//!
//! | method | ms per step | fall of the centre of mass | largest stretch |
//! |---|---|---|---|
//! | PBD, the default of 20 iterations | 4.9 | 1.155 m | 1515 % |
//! | XPBD, 20 substeps | 5.6 | 0.589 m | 197 % |
//! | projective dynamics, the default | 5.5 | 0.498 m | 1.2 % |
//! | implicit Euler, to 10⁻³ | 31 | 0.499 m | 1.2 % |
//!
//! - **Cloth with a material**, whose k, membrane modulus Y or bending rigidity D should mean something: take XPBD,
//!   which costs the same a sweep, or projective dynamics.
//! - **Forces, tensions, energies** that are to be read out, or on which contact depends: take XPBD or implicit Euler.
//!   A sheet on a floor, or a stack of them, presses with its weight here too. But a strip that hangs over a cylinder
//!   presses on it by 0.235 more than its tension at rest says, as a mean over six lengths; and one that is half around
//!   it (μ = 0.3) still sticks where the ratio of the pulls at its ends is 1.5 times that at which it should slip
//!   (`cloth-bench/tests/all/studies/contact/cylinder.rs`).
//! - **Fine meshes** without a hierarchy or extrapolation: sweeps grow with the square of the vertices a side.
//! - **A wanted error**: take implicit Euler.
//!
//! It is at its best where the constraints are hard, few, or their strain does not matter: ropes, strain limits after
//! another method, interactive toys, first programs.
//!
//! # Files in reading order
//! 1. `examples/first_program.rs`: the naive method. `examples/springs_in_a_row.rs`: what its k is worth.
//!    `examples/cost_of_a_sweep.rs`: what an element costs. `examples/fingerprint_pbd.rs`: the same bits everywhere.
//! 2. `cloth-core/src/element.rs`: what a row is. `solver.rs`: the loop; `config.rs`: its settings.
//! 3. `stiffness.rs`: the formula of a row. In `cloth-core/src/method/position_based`: `correction.rs` (one element),
//!    `families.rs` (the sweep), `motion.rs` (prediction, velocities, contact), `chebyshev.rs`.
//! 4. `hierarchy.rs`, with `tether.rs` (the row of a coarse link) and `level.rs`.
//! 5. `strain_limit.rs`, with `limit.rs` (one element), `components.rs` (angular momentum), `with_strain_limit.rs`.
//!
//! Most claims of this page are tests in `tests/all/chapter.rs`; those on the hierarchy, strain limits, input and
//! prescribed vertices are in the files beside it. Times and tables are `cloth-bench`'s.
//!
//! # Differences from the papers
//! - Müller et al. 2007: s from k, h and w̃ ([soft constraints](#from-a-constraint-to-the-projection)) in place of
//!   `1 − (1 − k)^(1/n)`; bending by a signed angle; friction on positions, not velocities, and all paths tested at the
//!   end; no damping. Their k′ is our s, their scaling factor s our −Δλ; their k in [0, 1] has no counterpart.
//! - Müller 2008: lengths, weights and links that push back: see [`Hierarchy`].
//! - Wang 2015: Gauss–Seidel made symmetric, ρ estimated in the substep, no extrapolation where corrections grow.
//! - Wang et al. 2010: one level; the [`StrainLimiter`] restores angular momentum.
//!
//! # References
//! - M. Müller, B. Heidelberger, M. Hennix, J. Ratcliff, "Position based dynamics", J. Vis. Commun. Image Represent.
//!   18(2), 2007, <https://doi.org/10.1016/j.jvcir.2007.01.005>. Its `s = 1 − (1 − k)^(1/n)` leaves `1 − k` of a
//!   violation after n visits, whatever n; the rule here adds h and w̃.
//! - M. Macklin, M. Müller, N. Chentanez, "XPBD: position-based simulation of compliant constrained dynamics", Motion
//!   in Games 2016, <https://doi.org/10.1145/2994258.2994272>: the multipliers that soft rows need.
//! - E. Grinspun, A. Hirani, M. Desbrun, P. Schröder, "Discrete shells", SCA 2003,
//!   <https://doi.org/10.2312/SCA03/062-067>: bending by angle. M. Bergou, M. Wardetzky, D. Harmon, D. Zorin, E.
//!   Grinspun, "A quadratic bending model for inextensible surfaces", SGP 2006,
//!   <https://doi.org/10.2312/SGP/SGP06/227-230>: isometric bending.
//! - M. Kelager, S. Niebe, K. Erleben, "A triangle bending constraint model for position-based dynamics", VRIPHYS 2010,
//!   <https://doi.org/10.2312/PE/vriphys/vriphys10/031-037>.
//! - T. Jakobsen, "Advanced character physics", Game Developers Conference 2001: the distance projection.
//! - J. Bender, M. Müller, M. A. Otaduy, M. Teschner, M. Macklin, "A survey on position-based simulation methods in
//!   computer graphics", Comput. Graph. Forum 33(6), 2014, <https://doi.org/10.1111/cgf.12346>.
//! - H. Wang, "A Chebyshev semi-iterative approach for accelerating projective and position-based dynamics", ACM Trans.
//!   Graph. 34(6), 2015, <https://doi.org/10.1145/2816795.2818063>.
//! - D. Young, "Iterative methods for solving partial difference equations of elliptic type", Trans. Amer. Math. Soc.
//!   76(1), 1954, <https://doi.org/10.1090/S0002-9947-1954-0059635-7>: Gauss–Seidel against Jacobi, the best ω.
//! - M. Müller, "Hierarchical position based dynamics", VRIPHYS 2008,
//!   <https://doi.org/10.2312/PE/vriphys/vriphys08/001-010>. Here links are as long as the geodesic over the cloth, and
//!   do not let each other become shorter.
//! - T.-Y. Kim, N. Chentanez, M. Müller, "Long range attachments: a method to simulate inextensible clothing in
//!   computer games", SCA 2012, <https://doi.org/10.2312/SCA/SCA12/305-310>.
//! - H. Wang, J. O'Brien, R. Ramamoorthi, "Multi-resolution isotropic strain limiting", ACM Trans. Graph. 29(6), 2010,
//!   <https://doi.org/10.1145/1882261.1866182>; X. Provot, "Deformation constraints in a mass-spring model to describe
//!   rigid cloth behavior", Graphics Interface 1995.

#![forbid(unsafe_code)]

mod solver;

mod config;

mod stiffness;

mod hierarchy;

mod strain_limit;

pub use config::PbdConfig;
pub use hierarchy::{Hierarchy, HierarchyConfig, HierarchyError, Link};
pub use solver::{PbdBuilder, PbdSolver};
pub use stiffness::{StiffnessRule, effective_stiffness, projection_stiffness};
pub use strain_limit::{
    LimitReport, StrainLimiter, StrainLimiterBuilder, StretchRange, WithStrainLimit,
};

pub use cloth_core;
#[doc(no_inline)]
pub use cloth_core::{
    energy::Spring,
    math::Vec3,
    method::position_based::{Acceleration, Chebyshev, Radius, Sweep},
    particles::{Particles, State},
    step::{BuildError, StepError, StepInput, StepReport, Stepper},
};
