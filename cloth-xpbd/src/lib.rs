//! Extended position-based dynamics (XPBD): PBD with compliance and an accumulated Lagrange multiplier per constraint.
//!
//! # Example
//! ```
//! use cloth_xpbd::{Particles, Spring, State, StepInput, Stepper, Vec3, XpbdSolver};
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
//! A sheet of cloth, with as many substeps as a strain of 10 % takes; everything else that meshes and materials need is
//! in [`cloth_core`], re-exported here:
//!
//! ```
//! use cloth_xpbd::cloth_core::{Cloth, Diagonals, Membrane, grid, measure::Strain};
//! use cloth_xpbd::{State, StepInput, Stepper, SubstepRule, Vec3, XpbdConfig, XpbdSolver};
//!
//! let mesh = grid(17, 17, 1.0, 1.0, Diagonals::Alternating)?;
//! let cloth = Cloth { areal_density: 0.2, membrane: Membrane::SpringStiffness(1e4), bending_rigidity: 1e-5 };
//! let mut model = cloth.on(&mesh)?;
//! model.particles.prescribe(0)?; // two corners
//! model.particles.prescribe(16)?;
//! let gravity = Vec3::new(0.0, 0.0, -9.81);
//! let rule = SubstepRule { strain: 0.1, gravity, fall: 1.0, driven: 0.0, tension: 0.0, iterations: 1 };
//! let substeps = rule.substeps(&model.particles, &model.springs, 1.0 / 60.0);
//! let mut solver = XpbdSolver::builder(&model.particles)
//!     .energy(model.springs.clone())
//!     .energy(model.hinges)
//!     .config(XpbdConfig { substeps, ..XpbdConfig::default() })
//!     .build()?;
//! let mut state = State::at_rest(mesh.positions().to_vec());
//! for _ in 0..30 {
//!     solver.step(&mut state, StepInput::new(1.0 / 60.0).gravity(gravity))?;
//!     assert!(Strain::of(&model.springs, &state.positions).max < 0.1);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Idea
//! PBD moves a constraint towards zero in every visit; how stiff that makes the cloth depends on how often it visits.
//! XPBD gives each constraint a multiplier λ, in which its corrections add up. A constraint whose λ has reached the
//! force of its material at the present stretch moves nothing any more, however often it is visited. So k is a property
//! of the material, and `k = ∞` is allowed: a hard constraint.
//!
//! **PBD in formulas.** With a stiffness factor k′ from 0 to 1 a visit of PBD leaves C (1 − k′), and n visits leave one
//! constraint at `C̃ (1 − k′)ⁿ`, C̃ its value before. A material of stiffness k would leave `C̃/(1 + k h² w̃)`, with h
//! the step and, for a spring, w̃ = 1/m₀ + 1/m₁ ([below](#from-backward-euler-to-the-update)). So PBD acts like
//! `k = ((1 − k′)⁻ⁿ − 1)/(h² w̃)`: exponential in n, and in proportion to 1/h² and to the masses.
//! `k′ = 1 − (1 − k₀)^(1/n)` (Müller et al. 2007) makes it `k₀/((1 − k₀) h² w̃)`: n is gone, h and the masses are not.
//! In XPBD none of the three is in k. Too few sweeps still leave cloth too soft, by the residual r of
//! [`XpbdSolver::compliance_residual`], which more sweeps take away.
//!
//! # From backward Euler to the update
//! **The step.** Backward Euler for `M v̇ = f_ext − ∇E(x)` is `x = x̃ − h² M⁻¹ ∇E(x)`, with the inertial prediction
//! `x̃ = x⁰ + h v⁰ + h² M⁻¹ f_ext` of all external forces, the weight among them. It is where the gradient of
//! `G(x) = ½ ‖x − x̃‖²_M/h² + E(x)` vanishes, with `‖y‖²_M = yᵀ M y`.
//!
//! **The energy.** An element has one or a few constraint functions C(x), its *rows*, with `E = ½ Σ k C²`, so
//! `∇E = Σ k C ∂C/∂x`: every row pushes along its own gradient with the generalised force `−k C`. Call h² times that
//! force λ, and J the matrix of all gradients. Then backward Euler becomes two equations in x and λ (Macklin et al.
//! 2016, equations 8 and 9),
//!
//! ```text
//! M (x − x̃) − Jᵀ λ = 0        (a)  λ is what has moved x away from x̃
//! C(x) + α̃ λ = 0              (b)  α̃ = α/h² = 1/(k h²), the compliance scaled by the step
//! ```
//!
//! Nothing in them is divided by α̃: with α = 0, (b) is the hard constraint C = 0, and λ its Lagrange multiplier.
//!
//! **Newton's method** on both, at some (x, λ), asks for Δx and Δλ. Linearised, (b) is `C + J Δx + α̃ (λ + Δλ) = 0`. Of
//! (a) XPBD makes something simpler by two approximations: the change of J with x, the geometric stiffness `−Σ λ ∂²C`,
//! is dropped, and (a) is taken to hold already (its residual, their g, is zero). It does at x = x̃ and λ = 0; after
//! the first visit it holds only with the gradients that the visits had. What remains is `Δx = M⁻¹ Jᵀ Δλ`, the rule by
//! which every correction moves x; put into (b) it gives their equation 16,
//!
//! ```text
//! (J M⁻¹ Jᵀ + α̃) Δλ = −(C + α̃ λ)
//! ```
//!
//! **Gauss–Seidel** solves this system row by row, with C and its gradient evaluated anew at every visit (equation 18):
//!
//! ```text
//! Δλ = −(C + α̃ λ)/(w̃ + α̃),   w̃ = Σ wᵢ ‖∂C/∂xᵢ‖²,   wᵢ = 1/mᵢ
//! λ ← λ + Δλ,   xᵢ ← xᵢ + wᵢ ∂C/∂xᵢ Δλ
//! ```
//!
//! **One spring** shows what λ is for. With C̃ its stretch at x̃, the first visit makes `λ = −C̃/(w̃ + α̃)` and leaves
//! `C = C̃ α̃/(w̃ + α̃) = C̃/(1 + k h² w̃)`: backward Euler's answer. Now `C + α̃λ = 0`, so a second visit does
//! nothing. With α = 0, k = ∞, the update is `Δλ = −C/w̃`: a hard row is projected in full, as by PBD. An update
//! without λ would shrink C again, to `C̃/(1 + k h² w̃)ⁿ` in n visits, and k would depend on n, as in PBD.
//!
//! **What λ accumulates** is the sum of its row's Δλ in this substep, h² times a generalised force. The impulse that
//! the row has given is λ/h, so λ/h² is its mean force in the sense of impulse over time. Of a converged undamped row
//! it is −k C at the *end* of the substep, by (b): backward Euler takes the force of the end for all of h. The forces
//! on the vertices are `Jᵀλ/h²` (N). λ is set to zero at the start of each *substep*, because (a) has to hold there: at
//! x = x̃ no row has moved anything. Set to zero in each *iteration*, it gives the update without λ, above. *Never* set
//! to zero, it turns a spring into a dashpot of kh (N s/m): to bear a weight takes `Δλ = −m g h²` in every substep, so
//! λ grows without end, and with it the stretch −α̃λ that (b) asks for, by m g/k a substep. (To start from an old λ,
//! begin at x̃ + M⁻¹Jᵀλ, where (a) holds with this J, or keep g, as [the direct solver](#direct-solve).)
//!
//! **What is lost.** Dropping the geometric stiffness alone changes the path of the iteration, not its limit. The limit
//! moves because the residual of (a) is dropped: each `JᵀΔλ` is added with the gradients of its own visit, so (a) holds
//! with those, not with the J of the end. Converged sweeps end near the minimum of G; with linear rows, at it
//! ([limits](#limits)).
//!
//! **Beside projective dynamics**, which lowers the same G in x with one constant matrix for all elements: XPBD
//! eliminates x by `x = x̃ + M⁻¹ Jᵀ λ` and relaxes the *dual* system above row by row. Its sweeps carry a correction
//! slowly along a chain, but a hard row is no slower than a stiff one. One solve with that matrix reaches through the
//! chain, but no k may be ∞ in it. [Sweeps by vertices](XpbdConfig#how-fast-sweeps-converge) are a third way.
//!
//! # The step
//! ```text
//! for each of s substeps of h = Δt/s:
//!     where w > 0:  v ← v + h (g + w f)                f: load without weight, of f_ext = M g + f; w = 0 keeps v
//!     x̃ ← x + h v,  x ← x̃,  λ ← 0                      prediction
//!     n times, for each row: Δλ, λ and x as above      one sweep
//!     v ← v + (x − x̃)/h
//! ```
//!
//! It is Algorithm 1 of Macklin et al. 2016 in substeps (Macklin et al. 2019); `v + (x − x̃)/h` is their `(x − x⁰)/h`,
//! rounded better. The rows are visited family by family: a *family* is what one call of
//! [`energy`](XpbdBuilder::energy) adds, elements of one type. Air ([`StepInput::air`]) is projected after each sweep
//! and before contact, as a constraint of stiffness (drag in kg/s)/h. `examples/first_program.rs` is this box as plain
//! loops over arrays, and compares itself with [`XpbdSolver`]: after 30 steps the two are less than 3e-13 m apart.
//!
//! A prescribed (pinned, kinematic) vertex, w = 0, moves with its velocity in the state, whatever pulls at it; the work
//! that this takes is [`StepReport::pin_work`]. Without `energy_gain` nothing is carried from step to step but the
//! state: a fresh solver continues a run with the same bits, with the contacts of before (which remember their order).
//!
//! To drag a vertex, prescribe it before building, and before each step set its velocity to `(target − position)/Δt`
//! ([`Pins`](cloth_core::pin::Pins) does for paths). The solver keeps a copy: to grab or release one, build a new one
//! and go on with the state. A soft pin is an [`Attachment`](cloth_core::energy::Attachment).
//!
//! The rows of one element are solved together, block Gauss–Seidel: `(J M⁻¹ Jᵀ + α̃) Δλ = −(C + α̃λ)` with its few
//! rows, so the three strains of a triangle need no repetition to agree. Rows without a common coordinate, those of a
//! quadratic hinge for instance, and the rows of an inequality are solved one by one. Of two redundant hard rows of an
//! element the later one is left out; those of different elements [are with
//! `XpbdConfig`](XpbdConfig#redundant-and-contradictory-hard-rows).
//!
//! The row of an inequality, a limit or a contact, accumulates too. For an upper limit C ≤ 0, which only pulls, λ is
//! projected onto its bound, `λ ← min(0, λ + Δλ)`, and x moves by what λ has changed
//! ([`DeadZoneRow`](cloth_core::element::DeadZoneRow) has both limits). To set λ to zero where the limit is met would
//! leave x where λ has moved it: the next visit would correct once more, and k depend on n.
//!
//! | equation | function |
//! |---|---|
//! | inertial prediction; velocities from positions | [`Motion::predict`], [`Motion::update_velocities`] |
//! | C, ∂C/∂x, k | [`Constraint::rows`] of each element; [listed](XpbdBuilder#elements) |
//! | `C + α̃λ` and α̃, damping | `update.rs`: `XpbdUpdate::equation` |
//! | Δλ and `wᵢ ∂C/∂xᵢ Δλ` of one element | `row_by_row_correction`, and its forms for special rows, in `cloth-core/src/method/position_based/correction.rs` |
//! | the loop over rows | [`Families::sweep`], in the order of [`Sweep`] |
//! | colours of each family (from 2¹⁹ vertices on block by block of 2¹⁴) | `cloth-core/src/method/coloring.rs` |
//! | extrapolated sweeps, λ together with x | [`Chebyshev`] |
//! | the loop over substeps and sweeps | [`XpbdSolver`]: `solver.rs` |
//! | `max abs(C + α̃λ)` | [`XpbdSolver::compliance_residual`] |
//! | λ; `Jᵀλ/h²` | [`XpbdSolver::multipliers_into`]; [`XpbdSolver::each_force`], [`XpbdSolver::vertex_forces_into`] |
//! | how many substeps | [`SubstepRule`] |
//! | rigid links, ball joints, limits of angles | [`mod@links`] |
//! | (a) and (b) as one system, geometric stiffness | `direct`, with the feature of that name |
//!
//! [`Motion::predict`]: cloth_core::method::position_based::Motion::predict
//! [`Motion::update_velocities`]: cloth_core::method::position_based::Motion::update_velocities
//! [`Constraint::rows`]: cloth_core::element::Constraint::rows
//! [`Families::sweep`]: cloth_core::method::position_based::Families::sweep
//!
//! # Units
//! | element | C | k | α = 1/k | λ |
//! |---|---|---|---|---|
//! | [`Spring`] | `‖x₀ − x₁‖ − L` (m) | N/m | m/N | kg m |
//! | [`CurvatureHinge`](cloth_core::energy::CurvatureHinge) | `Σ qᵢ xᵢ` (m) | N/m | m/N | kg m |
//! | [`StvkTriangle`](cloth_core::energy::StvkTriangle) | strain (1) | J | 1/J | kg m² |
//! | any | unit u | J/u² | u²/J | kg m²/u |
//!
//! The page of [`XpbdBuilder`](XpbdBuilder#elements) has C and ∂C of every element, also of triangles, hinges, areas
//! and volumes, and what is done where ∂C has no value (0/0).
//!
//! `α̃ = α/h²` and `w̃` have the same unit, u²/(kg m²); their ratio `k h² w̃` says how stiff a row is *for this step*:
//! much above 1 it acts as a hard constraint, much below 1 one visit hardly matters. Elements take k, not α, and derive
//! it from the material: Y (N/m), Young's modulus times thickness, and D (N m), the bending rigidity. Infinite k is a
//! hard row (zero compliance), zero k no row. Negative k is not checked: a visit turns C̃ to `−C̃/(|k| h² w̃ − 1)`, or
//! does nothing where `|k| h² w̃ ≤ 1`.
//!
//! **k from Y.** Springs have k = ¾ Y inside the *alternating grid* ([squares](cloth_core::Diagonals::Alternating) with
//! diagonals of alternating direction), and half of that on its boundary. They make an isotropic sheet of ν = 1/3 and a
//! shear modulus of ⅜ Y ([derivation](XpbdBuilder#elements)).
//!
//! **k from D.** A quadratic hinge is three rows, `C = Σ qᵢ xᵢ` along x, y and z, k = 3c/(A₀ + A₁) (Bergou et al.
//! 2006); `CurvatureHinge::new` takes c, `CurvatureHinge::across` D, and c = D/3: equilateral triangles, bent to a
//! cylinder of radius R in any direction, then store ½ D/R² per area. The derivation, a link to what other meshes do,
//! and the three k of a StVK triangle are [with `XpbdBuilder`](XpbdBuilder#elements).
//!
//! **In numbers**: [shirting](cloth_core::cloth#where-the-numbers-come-from) of ρ = 0.2 kg/m², Y = 1000 N/m and D =
//! 10⁻⁵ N m, on the alternating grid of a = 1 cm, whose vertices weigh m = ρ a² = 2·10⁻⁵ kg in the mean (4/3 of that
//! with eight neighbours, 2/3 with four), at h = 1/1200 s, which makes α̃ = 1.44·10⁶ s⁻² times α:
//!
//! | element | k | α = 1/k | w̃, each vertex of mass m | k h² w̃ |
//! |---|---|---|---|---|
//! | spring | ¾ Y = 750 N/m | 1.3·10⁻³ m/N | 2/m = 10⁵ /kg | 52 |
//! | quadratic hinge about an edge of the grid, q = (2, 0, −1, −1) | D/(A₀ + A₁) = D/a² = 0.1 N/m | 10 m/N | Σ qᵢ²/m = 6/m = 3·10⁵ /kg | 0.02 |
//! | StVK triangle, ν = 1/3: area | A₀ Y/(1 − ν) = 0.075 J | 13 /J | 2/(a² m) = 10⁹ /(kg m²) | 52 |
//! | and its two shears | A₀ Y/(1 + ν) = 0.0375 J | 27 /J | the same | 26 |
//!
//! So for this step springs are nearly hard, and one visit of a hinge hardly matters. One visit of a spring alone
//! leaves 1/53 of its stretch, of a hinge 98 %.
//!
//! On a finer mesh of the same cloth a spring has the same k, a hinge k ~ 1/A and a triangle k ~ A, so the *converged*
//! cloth stays the same. Swept once a substep it does not: a finer mesh takes [more substeps](SubstepRule).
//!
//! # Damping
//! [`XpbdConfig::damping`] = β (s) adds `−β k Ċ` to the force `−k C` of every row: XPBD's constraint damping (Macklin
//! et al. 2016, equation 26), in proportion to the stiffness as the β K of Rayleigh's damping. `Ċ = (C − C⁰)/h`, C⁰ the
//! value at the start of the substep, with the positions and the rest data of that time. So Ċ is relative to a target
//! that moves: a vertex that goes along with its moving soft pin is not damped. One row takes the implicit Euler step
//! of a damped oscillator,
//!
//! ```text
//! C = (C̃ + w̃ h β k C⁰)/(1 + w̃ k h (h + β))
//! ```
//!
//! whose damping ratio is βω/2, with `ω² = k w̃`, besides what implicit Euler damps.
//!
//! The paper writes `∂C/∂x·(x − x⁰)` for `C − C⁰`, which is not zero for a spring that turns by a finite angle, and
//! damps the rotation; the difference of the values is zero for every rigid motion. Damping costs nothing in a sweep:
//! `update.rs` has the change of variable that makes it so, and the paper's own letters.
//!
//! Without it, backward Euler's own damping remains. Of one mode of frequency ω, with C and its rate v, let
//! `z = ωC + i v`, so that |z|² goes with the energy. The step `C₁ = C₀ + h v₁`, `v₁ = v₀ − h ω² C₁` is
//! `z₁ (1 + i h ω) = z₀`: a substep divides the energy by `1 + (hω)²`, a damping ratio of hω/2 if that is small. A mode
//! of 5 Hz keeps 78 % of its energy in one step of 1/60 s, 98.6 % in twenty of 1/1200 s. The loss in a given time goes
//! with `ln(1 + (hω)²)/h`, which is largest at hω = 1.98: below that, smaller substeps damp less.
//!
//! # Forces
//! `Jᵀλ/h²` (N): [`XpbdSolver::each_force`] row by row, [`XpbdSolver::vertex_forces_into`] summed at the vertices (at a
//! prescribed one the load on its support, at rest the weight; [`StepInput::pin_forces`] asks for the mean of a step);
//! [`XpbdSolver::multipliers_into`]: λ.
//!
//! # How many substeps, how many iterations
//! The closed forms of a straight chain of N rigid links of length l tell what a setting leaves on top of the elastic
//! strain. A sheet with N rows of edges, hung by one side, carries its weight as such a chain does.
//!
//! - **One sweep per substep** of `h = Δt/s`, from the support: after link i is met the next link pulls its lower end
//!   away, by `wᵢ |λᵢ₊₁|`, with `|λᵢ₊₁| = g h² (mass below i)`. The chain sags by `g h² Σ (mass below i)/mᵢ`: for equal
//!   masses `g h² N(N − 1)/2`, a mean strain of `ε = g h² (N − 1)/(2 l)`; a tip of mass m_t adds
//!   `g h² (N − 1)(m_t/m − 1)`, which for a heavy one is nearly all. So a wanted ε takes
//!
//!   ```text
//!   s = Δt √( g (N − 1) (1 + 2 (m_t/m − 1)/N) / (2 l ε) )   substeps
//!   ```
//!
//!   that is 8.7 for 1 %, 24 links of 1/24 m, equal masses, 1/60 s, 9.81 m/s², and 87 with a tip 1200 times as heavy.
//! - **n iterations** of one substep share λ about equally and divide the sag by n or a little more (1.04 n for n = N =
//!   24), to about `g Δt² N(N − 1)/(2n)`, as long as n is well below N². (n substeps divide it by n², as each needs
//!   only a λ that goes with h².) From then on each keeps [`cos²(π/(2N))`](XpbdConfig#how-fast-sweeps-converge) of the
//!   error, a factor of 100 in `ln 100/(−2 ln cos(π/(2N)))` sweeps: 1,074 for these 24 links.
//! - **"As many iterations as the mesh is wide"**, a popular rule: N sweeps leave `cos^(2N)(π/(2N)) ≈ e^(−π²/(4N))` of
//!   the slowest error, here 90 %, and at rest a mean strain of 3.1 %: measured 3.0 %, and 2.3 % on a sheet of as many
//!   rows; as many substeps leave 0.13 % and 0.10 %.
//!
//! Sheets differ: held by an edge they are strained by 0.8 of the prediction, by two corners by 3 times as much or more
//! ([table](SubstepRule#against-the-closed-form)), since the whole weight goes through a few edges, as with a heavy
//! tip. All that is at rest. Cloth that swings is also brought to a stop, by its supports or by what it hits.
//! Take [`SubstepRule`]: it has both parts for any cloth, and a third for a tension that lasts, as in a balloon. What
//! it leaves is about the strain that it is given: 0.3 to 1.4 times that in what its coefficients were measured on.
//!
//! So spend sweeps on substeps, unless the constraints are few, or the step has to be that of implicit Euler: on 24 ×
//! 24 vertices 20 sweeps leave a strain of up to 17 % as substeps, 158 % as iterations (`--example hanging_sheet`).
//!
//! # Which settings
//! | scene | take |
//! |---|---|
//! | any cloth | one sweep a substep, and the substeps of [`SubstepRule`] for a strain of 10 %, with contact 7 % |
//! | cloth that a hand or a corner may catch | [`energy_gain`](#steps-that-gain-energy) of 0.01 besides |
//! | a rope, a chain | [`Sweep::Sequential`], links in order from the support |
//! | a heavy end, or few hard constraints to round-off | the [direct solver](#direct-solve) |
//! | many sweeps in one substep | [`Chebyshev`] |
//! | motion that should die out | [`XpbdConfig::damping`] |
//!
//! # Steps that gain energy
//! No rule knows before a run where cloth will be stopped on a corner or pulled taut by a hand. Too few substeps leave
//! strain there, with more energy in it than the motion had. With [`XpbdConfig::energy_gain`] = τ a step compares what
//! kinetic and elastic energy have gained with the work of gravity, loads, air, prescribed vertices and contact. Where
//! the excess, summed over the steps less losses, would grow beyond τ times the largest energy so far, the step is
//! repeated with more substeps ([`StepReport::refinements`]; the rules are in `refinement.rs`). Take τ = 0.01, on top
//! of [`SubstepRule`]. An example is a sheet of 33 × 33 vertices of 10⁴ N/m that falls about two corners, by twenty
//! substeps: with this τ its energy exceeds what it was given by at most 0.8 % of the work of gravity, without τ by
//! more than twelve times that work. A step without excess costs two evaluations of the energy.
//!
//! # Order of the constraints, colours and threads
//! A sweep visits the families in the order in which they were added, and the elements of a family in the order of
//! [`Sweep`]. Gauss–Seidel carries a correction along the order of the visits through a whole chain in one sweep, and
//! against it by one element a sweep. So iterates [depend on the order](SubstepRule#against-the-closed-form). Where
//! rows are linear, or none turns, as in a straight chain, converged sweeps do not. Where rows turn they do, since each
//! correction keeps the gradients of its own visit: two orders end apart, by no more than the sum of what each misses
//! the implicit Euler step by ([limits](#limits)).
//!
//! [`Sweep::Colored`], the default, colours the elements greedily, so that no two of a colour share a vertex. Elements
//! of a colour then do not see each other's writes: they can be visited in parallel, without locks, and give the same
//! bits as in turn, on any number of threads ([other machines](XpbdSolver#rounding)). A second thread takes part in
//! colours of at least 4096 elements (feature `parallel`, on the current rayon pool); a processor gains on one thread
//! too, since it need not wait for the element before. Elements of N vertices, at most d of which meet at one, take at
//! most N (d − 1) + 1 colours: each has at most N (d − 1) neighbours, and takes the first colour that none of them has.
//! [`Sweep::Sequential`] keeps the order given and one thread. [`Sweep::Jacobi`] solves all elements at the same
//! positions and scales the corrections down; without extrapolation it is [slow](XpbdConfig#how-fast-sweeps-converge).
//!
//! [`XpbdConfig::acceleration`] extrapolates λ and x over the sweeps of a substep ([`Chebyshev`]), for those who need
//! many ([why it is faster](XpbdConfig#relaxation-and-extrapolation)). An iteration of Gauss–Seidel is then two sweeps,
//! forward and back. A chain of 20 rigid links takes less than a fifth of the sweeps to 1e-7 m with ρ given, less than
//! a third with ρ estimated (`tests/all/sweeps.rs`). The family visited last is met best, since none after it undoes
//! it: add the one that must hold best last, with Chebyshev first, where the way back ends. Air and contact come last.
//!
//! # Contact
//! A [`ContactSource`](cloth_core::contact::ContactSource), as the crate `cloth-collide` has it, is handed over with
//! [`StepInput::contacts`]. Its [`ContactConstraints`](cloth_core::contact::ContactConstraints) find at x̃ what can
//! touch in the substep (`begin_substep`), are swept last in each iteration, test the paths before the velocities are
//! found (`end_substep`), and may change those afterwards (`change_velocities`). A contact is a row
//! `C = n̂·Σ c_k x_k − d₀ ≥ 0`: the sum is the vector between the two nearest points, with barycentric weights c_k that
//! are negative on one side, and n̂ its direction at the start. The row comes from the energy per area ψ(d) (J/m²) of
//! `cloth_collide::potential`, d the distance, with the range r (m) and the stiffness κ (Pa/m):
//!
//! ```text
//! ψ = ½ κ (r − d)²                 from d = r/2 to r; nothing beyond
//! ψ = ½ κ t² − κ t² ln(d/t)        below t = r/2, a barrier
//! ```
//!
//! - **r** is the distance at which two layers of cloth meet, the thickness that the builder is given; between two
//!   edges it is half of that. Where vertices hold the layers nearly r apart, the edges are as far apart and do not
//!   push. They push only where no vertex is near, and far fewer pairs are in range.
//! - **A**, the area at rest that a contact stands for, makes A ψ its energy: of a vertex a third of the triangles
//!   around it, and half of that before other cloth, whose vertices press too; of two edges the smaller of theirs, each
//!   a third of the triangles beside it.
//! - **κ** is a number of the scene. A pressure p leaves a gap of r − p/κ, as long as p < κ r/2: at the default of 10⁶
//!   Pa/m cloth of 0.2 kg/m² that lies on a body gives way by 2 µm of 1 mm. With σ the mass per area `κ h²/σ` is the
//!   `k h² w̃` of a vertex before a body, 3.5 for that cloth at h = 1/1200 s; much above 1 it acts as a hard row.
//!
//! A row has one k, so ψ′ is replaced by its tangent at the distance d of the start: compliance 1/(A ψ″), and
//! `d₀ = d − ψ′/ψ″`, where that line is zero. From t on this gives d₀ = r and ψ″ = κ, the spring itself; below,
//! `d₀ = 2d` and `ψ″ = κ t²/d²`: what is too near meets a stiffer row, which in one substep takes it to 2d at most, not
//! to r. (Below r/20 the force is that at r/20, and `d₀ = d + r/20`.) In a visit, with `w̃ = Σ w_k c_k²`,
//!
//! ```text
//! Δλ = max(−λ, −(C + α̃λ)/(w̃ + α̃)),   λ_f ← λ_f − u/w̃, cut to ‖λ_f‖ ≤ μ λ
//! ```
//!
//! The first changes nothing where C + α̃λ = 0 with λ > 0, or C ≥ 0 with λ = 0: no pull, and no push where C > 0. The
//! second is friction, a hard row across n̂ (after Müller et al. 2020, section 3.5, with one μ for sticking and
//! sliding): u is the displacement of `Σ c_k x_k` at right angles to n̂ from where the contact sticks, at first from
//! where it was when contact began. From substep to substep u is kept while λ > 0, cut to r/100: what is beyond has
//! slipped, and is not taken back. The length is fixed, and not the `μ λ w̃` that the cone can take back in a substep.
//! That is some μ g h² at rest, 2 µm at 1/1200 s and μ = 0.3: cloth that sticks would creep by what unconverged sweeps
//! leave beyond it.
//!
//! **How exact is friction?** No contact leaves its cone, however few the sweeps: μ λ has the λ of this very visit, so
//! cloth that lands has friction at once. The rest of Coulomb's law, u = 0 within the cone and `λ_f = −μ λ u/‖u‖` on
//! it, is what a fixed point of this update says, and holds where the sweeps converge. With one sweep forces at rest
//! still balance the weight, since every substep repeats the one before, but stretched cloth presses at other places.
//! On a slope 20 substeps meet pressure and friction to 0.1 % of the weight; a disk that sags into a tilted ring, and
//! rests there by implicit Euler, slides 19 mm with them, less than 0.3 mm with those of [`SubstepRule`]
//! (`cloth-bench/tests/all/forces.rs`).
//!
//! **After the sweeps** (`end_substep`) every pair is tested over its whole path. A pair is safe if it keeps a tenth of
//! its distance there (of r, if that is less). While some are not safe,
//!
//! 1. up to 3 times, they are made hard (without compliance), and 5 more sweeps follow;
//! 2. up to 3 times, their vertices go half as far from the start of the substep;
//! 3. up to 6 times, their vertices stay where the substep began;
//! 4. the *last resort* begins: in up to 40 rounds pairs that would meet are pushed apart one by one; vertices of pairs
//!    that still meet become an *impact zone*, which moves as one rigid body for the substep (Provot 1997, Bridson et
//!    al. 2002); what meets even so stays where it began.
//!
//! [`truncated_count`](cloth_core::contact::ContactSource::truncated_count) counts the displacements that were cut
//! short. They lose momentum that no force has taken: where they are many, take more substeps. A step ends free of
//! crossings, or is refused with a [`StepError::Contact`]:
//! [`Infeasible`](cloth_core::contact::ContactError::Infeasible) where prescribed vertices or bodies leave a vertex no
//! path, [`IntersectingStart`](cloth_core::contact::ContactError::IntersectingStart) where something crossed before.
//!
//! **Restitution.** With `PotentialBuilder::restitution(e)`, e from 0 to 1, `change_velocities` gives every pair that
//! approached with a speed v_a along n̂ and has touched the separation velocity e v_a, by the impulse
//! `(e v_a − v_s)/w̃` along n̂, v_s its separation velocity before that (Müller et al. 2020, section 3.6). An approach
//! of less than a thousandth of the thickness in a substep is rest. Without e contact gives back what ψ stored.
//!
//! **Bodies**, all of `PotentialBuilder`, each with its own μ: `obstacle` is a rigid one of a signed distance, still or
//! moving; `animated` a mesh whose vertices follow given shapes; `free` gives an obstacle a mass and an inertia, so
//! that the cloth pushes it (not with restitution). Each is where the substep ends, and friction acts against its
//! velocity.
//!
//! **Cloth with itself.** A pair is a vertex and a triangle, or two edges, that share no vertex and are not sewn
//! together; nothing keeps apart what does or is. Two primitives of one connected piece that are nearer than r at rest
//! push only from their distance at rest on. So r may be longer than an edge, and the cloth still does not push itself
//! apart at rest. But where r is not much shorter than an edge, a vertex feels several triangles of the other side, and
//! the pressure is higher than κ says: 1.3 times with r a tenth of an edge, 4.6 times with r as long as an edge.
//!
//! **In code**, from `cloth_collide::potential`, with the thickness in m and the μ of cloth on cloth:
//! `let mut contacts = PotentialContacts::builder(&mesh).thickness(2e-3).friction(0.3).build()?;`, then
//! `solver.step(&mut state, StepInput::new(dt).gravity(g).contacts(&mut contacts))?`. Self-contact is on by default. A
//! volume to be kept ([`ClosedVolume`](cloth_core::enclosure::ClosedVolume)) is one more row, the volume of a closed
//! piece less that wanted, with its gradient as at the start of the substep, swept before the contacts. Unconverged
//! sweeps leave energy in contact too: ask [`SubstepRule`] for a strain of 7 % ([table](SubstepRule#with-contact)).
//!
//! # Direct solve
//! With the feature `direct`, `direct::DirectXpbd` solves all rows of a step as one linear system, and repeats that to
//! convergence, with the residual of (a) kept: its limit *is* the implicit Euler step. Use it for light chains with
//! heavy ends, where sweeps stall, for hard constraints that have to be met to round-off, and as the reference for
//! sweeps. Tables of that module say which of its four linear systems suits what, and what a step costs in sweeps.
//!
//! # Strain limits
//! [`StrainLimitSpring`](cloth_core::energy::StrainLimitSpring) and
//! [`StrainLimitTriangle`](cloth_core::energy::StrainLimitTriangle) are inequality constraints: C is the length or
//! singular value less the nearest allowed one. With finite k a limit yields by f/k under a generalised force f: of a
//! spring f is in N and C a length, of a triangle f is in J and C has no unit. With `k = ∞` it is hard. It is met as
//! far as the sweeps have converged: add its family last. `cloth-pbd` has a projection after the step.
//!
//! # Errors and bad input
//! - **Masses** are checked by [`Particles::new`]: they and their inverses have to be positive and finite. A
//!   stiffness that is no number and rest data that are not finite are refused by the builder, a negative stiffness is
//!   not. What k < 0 does is with the [units](#units).
//! - **Building** is refused with a [`BuildError`] that names the setting and its range (no iterations or substeps,
//!   negative or non-finite damping, relaxation outside (0, 2), …), or the element and the vertex that is missing or
//!   named twice.
//! - **A step** is refused with a [`StepError`] if Δt is not positive and finite, or if gravity, loads, positions or
//!   velocities are not finite (the first such vertex is named), and if its *result* is not finite; with contact also by [`StepError::Contact`], above. In all cases the state is what
//!   it was before the step, and the solver can be used again.
//! - **The direct solver** may besides return [`BuildError::MatrixTooLarge`], [`StepError::NotPositiveDefinite`] and
//!   [`StepError::LineSearchStalled`]. **A state or load of the wrong length** is a bug of the caller and panics.
//! - **Degenerate shapes.** A *present* shape is never an error: what each element does there is [with
//!   `XpbdBuilder`](XpbdBuilder#elements). Neither is a *rest* shape when building, but a rest triangle without area
//!   gives a quadratic hinge no finite coefficients, and the first step is refused ([more](XpbdBuilder#rest-shapes)).
//!   No triangle of a mesh is one.
//! - **No convergence test.** A step makes its sweeps and reports [`Outcome::BudgetSpent`](cloth_core::step::Outcome).
//!   How far `C + α̃λ` is from zero, and how to read that, is with [`XpbdSolver::compliance_residual`].
//!
//! # Add an element
//! One struct and two traits of [`cloth_core::element`]: `Element<N>` names the vertices, `Constraint<N>` gives the
//! rows. The solver takes it as it takes ours; damping, forces, colours, threads and the direct solver follow. [With
//! `XpbdBuilder`](XpbdBuilder#add-an-element) are an example of an equality, and what an inequality needs.
//!
//! # What a sweep costs
//! The sweeps of a step take substeps × iterations × Σ elements × the time of one: 5 to 6 ns for a spring, 8 to 13 for
//! a quadratic hinge. With [`XpbdSolver`](XpbdSolver#what-a-step-costs) are the table, the operations and bytes of a
//! visit, the rest of a step, and the 0.6 kB of memory that the solver takes for a vertex of a sheet.
//!
//! # Limits
//! - **It is not the minimiser of implicit Euler**, even when the sweeps have converged. They make `C + α̃λ` zero, with
//!   gradients of the places where each correction was made; implicit Euler wants them at the end. A correction of δ
//!   turns a link of length l by some δ/l, and so misses by some δ²/l. As δ goes with h², that is h⁴ in x, and in G,
//!   which is quadratic about its minimum, a fraction (δ/l)² of `G(x̃) − G*`, G* the minimum. So the gap shrinks with
//!   h, not with n: the fraction at last as h⁴, by 4⁴ = 256 from one line of the table to the next (not yet in these).
//!   On a swinging chain of ten links (0.1 m, 0.1 kg) converged sweeps leave these fractions
//!   (`cloth-bench study xpbd-floor`); the direct solver leaves no more than rounding does:
//!
//!   | Δt (s) | k = 200 N/m | k = 10⁴ N/m |
//!   |---|---|---|
//!   | 1/60 | 9.9e-4 | 1.4e-4 |
//!   | 1/240 | 2.7e-5 | 7.0e-6 |
//!   | 1/960 | 1.4e-7 | 1.4e-7 |
//!
//! - For the same reason forces read from λ miss the balance at rest by order h² where links turn from x̃ to x, as
//!   those of a rope between two pins do; in a straight chain they are exact (`direct.rs`, *What one sees of it*).
//! - Gauss–Seidel needs more sweeps on a finer mesh; truncated early, a stiff cloth is softer than its k.
//!   [Rates](XpbdConfig#how-fast-sweeps-converge) by stiffness, mesh and mass ratio.
//! - **Stability**: for linear equality rows each visit of Gauss–Seidel, with a relaxation between 0 and 2, lowers
//!   `½ λᵀ(J M⁻¹ Jᵀ + α̃)λ + λᵀC(x̃)`, and converged sweeps take backward Euler's step, which gains no energy at any h.
//!   Fewer are stable if they go [forward and back](XpbdConfig#what-few-sweeps-do-to-the-motion). One way, or where
//!   rows turn, [energy can be gained](#steps-that-gain-energy). Tested (`chapter/robustness.rs`): a sheet let go from
//!   any tangle, at any stiffness, stays finite with Δt up to 1 s; one of 10⁴ N/m hangs once its kinetic energy is
//!   taken out at each peak. [`Sweep::PlainJacobi`] diverges in cloth unless it is relaxed.
//! - **Order**: the step is backward Euler's, of order 1 in h. BDF2 would make it 2, by the same sweeps with 2h/3 for h
//!   in α̃ and `x̃ = (4x⁰ − x⁻¹)/3 + (2h/3) (4v⁰ − v⁻¹)/3 + (4h²/9) M⁻¹ f_ext`, x⁻¹ and v⁻¹ of the substep before. It
//!   is not offered: a step would depend on more than the state, and begin anew at every impact, and one sweep leaves
//!   more strain than the order gains.
//! - **Momentum**: `Σ mᵢ Δxᵢ = Δλ Σ ∂C/∂xᵢ` is zero for every C that is invariant under translation. So linear momentum
//!   is kept to round-off in free flight, however few the sweeps. Prescribed vertices, attachments, air and obstacles
//!   change it, as do displacements that contact cuts short. If C is invariant under rotation too, `Σ xᵢ × ∂C/∂xᵢ` is
//!   zero: a correction has no moment about the positions at its visit. But they turn in the substep, and so angular
//!   momentum L is lost, to order h, as in implicit Euler. A free rigid link r of length l, predicted at r̃, ends at
//!   `r = l r̃/‖r̃‖` with the rate (r − r⁰)/h. L was in proportion to r⁰ × r̃/h and is to `r × (r − r⁰)/h = r⁰ × r/h`:
//!   it is multiplied by `l/‖r̃‖`. That is `1/√(1 + (ωh)²)` in a first substep, with a velocity across r⁰. Later r̃ is
//!   2 r⁰ less the r of the substep before, and l/‖r̃‖ is `1/√(5 − 4 cos φ)`, φ the turn in that one, about ωh: in unit
//!   time ω² h of L is lost, and twice that of the kinetic energy: at one turn a second and 1/1200 s, 6.6 % a second.
//! - **Rounding**: positions of 1 m leave a correction ten digits at h = 1/1200 s and five at 1 µs in double precision,
//!   in single two at 0.8 ms ([law](XpbdSolver#rounding)).
//! - Damping does not act on hard rows, which have no rate, on limits, whose damper would push, nor on rigid motion.
//! - **Jitter**: too few sweeps stretch cloth; a single one may [shake](XpbdConfig#what-few-sweeps-do-to-the-motion) a
//!   vertex between hard struts. At rest each substep repeats the one before (`chapter/guide.rs`). Ringing after a stop
//!   is strain energy of too few sweeps: take more substeps or damping.
//! - **Locking** comes from the mesh; converged sweeps have it as any method has. By Euler's formula a sheet of V
//!   vertices and e edges that cannot stretch (one piece, no holes) has 3V − e = B + 3 motions, the six rigid ones
//!   among them, B the edges of its boundary. A free surface takes about V numbers, one height a vertex: far more. A
//!   flat sheet folds along straight lines of edges across it; most other bends stretch springs. Remedies:
//!   [`SpringLaw`](cloth_core::cloth::SpringLaw), `cloth_core::dof`.
//!
//! # When not to use this method
//! Half a second of a falling sheet of 64 × 64 vertices, held by two corners (1 m, 0.2 kg/m², 10⁴ N/m, Δt 1/60 s; one
//! thread of a 2-core AMD EPYC Zen 3, commit 257771a6, medians of `cloth-bench run hang --n 64 --steps 30 --threads 1
//! --method M`, with `--set substeps=published` and `substeps=177` for XPBD). Compare times within this table only: the
//! [tables of a sweep and a substep](XpbdSolver#what-a-step-costs) and those of `direct` are from other commits or
//! machines.
//!
//! | method | ms per step | largest stretch at the end |
//! |---|---|---|
//! | XPBD, the default of 20 substeps | 5.6 | 197 % |
//! | XPBD, 177 substeps by [`SubstepRule`] | 48 | 1.8 % |
//! | projective dynamics, the default | 5.5 | 1.2 % |
//! | implicit Euler, to 10⁻³ | 31 | 1.2 % |
//!
//! - **Fine and stiff cloth**: the substeps for a wanted strain grow with the number of vertices a side or a little
//!   faster, so the cost grows with its cube or more. At 64 a side others are cheaper for the same strain.
//! - **A wanted error**: no number of iterations brings it to the implicit Euler step. Take implicit Euler.
//! - **Motion with little numerical damping**: take BDF2, or the implicit midpoint rule where the step resolves the
//!   springs (`cloth-massspring`); substeps only lower the damping here.
//! - **Mass ratios far from 1** along chains: the direct solver.
//! - **Energies that are not `½ k C²`** with constant k in a few rows, as cubic shells. (Stable neo-Hookean solids can
//!   be written as two rows: Macklin and Müller 2021.) Elements are isotropic ([others](XpbdBuilder#elements)).
//!
//! It is at its best with few constraints, hard ones beside soft ones, limits, and where some strain may be seen.
//!
//! # Files in reading order
//! 1. `examples/first_program.rs`: the same step in plain loops.
//! 2. `solver.rs`: the loop, its cost; `solver/builder.rs`: elements; `config.rs`: settings, the rate of convergence.
//! 3. `update.rs`: Δλ and damping. In `cloth-core/src/method`: `coloring.rs`; in its `position_based`: `correction.rs`
//!    (one element), `families.rs` (the sweep), `motion.rs` (prediction, velocities, contact), `chebyshev.rs`.
//! 4. `substeps.rs`, `refinement.rs`, `forces.rs`, `links.rs` with `examples/rigid_links.rs`.
//! 5. `direct.rs`, which names the files of its folder; `single.rs` and its folder.
//!
//! `tests/all/chapter.rs` and its folder test what this page claims; its head lists the closed forms.
//!
//! # Differences from the papers
//! - [Damping](#damping) takes C − C⁰; rows of an element are solved together; [`Chebyshev`] takes symmetric sweeps.
//! - Limits and contact accumulate a λ of one sign, contact with a compliance; friction has one μ, paths are tested.
//!   Contact is looked for in every substep; "Small steps" looks for it once a frame and keeps what it has found.
//!
//! # References
//! - M. Macklin, M. Müller, N. Chentanez, "XPBD: position-based simulation of compliant constrained dynamics", Motion
//!   in Games 2016, <https://doi.org/10.1145/2994258.2994272>: the derivation, the sweep, and damping in equation 26.
//! - M. Macklin et al., "Small steps in physics simulation", Symposium on Computer Animation 2019,
//!   <https://doi.org/10.1145/3309486.3340247>: substeps instead of iterations.
//! - M. Macklin, M. Müller, "A constraint-based formulation of stable neo-Hookean materials", Motion, Interaction and
//!   Games 2021, <https://doi.org/10.1145/3487983.3488289>.
//! - M. Bergou et al., "A quadratic bending model for inextensible surfaces", SGP 2006: the quadratic hinge.
//! - M. Servin, C. Lacoursière, N. Melin, "Interactive simulation of elastic deformable materials", SIGRAD 2006: the
//!   compliant system (a), (b).
//! - M. Tournier, M. Nesme, B. Gilles, F. Faure, "Stable constrained dynamics", ACM Transactions on Graphics 34 (4),
//!   2015, <https://doi.org/10.1145/2766969>: geometric stiffness.
//! - M. Müller et al., "Position based dynamics", J. Vis. Commun. Image Represent. 18(2), 2007,
//!   <https://doi.org/10.1016/j.jvcir.2007.01.005>: the method that it extends.
//! - M. Müller, M. Macklin, N. Chentanez, S. Jeschke, T.-Y. Kim, "Detailed rigid body simulation with extended position
//!   based dynamics", Computer Graphics Forum 39(8), 2020, <https://doi.org/10.1111/cgf.14105>: friction, restitution.
//! - D. M. Young, "Iterative solution of large linear systems", Academic Press 1971: rates of sweeps.
//! - X. Provot, "Collision and self-collision handling in cloth model dedicated to design garments", 1997; R. Bridson
//!   et al., "Robust treatment of collisions …", SIGGRAPH 2002, <https://doi.org/10.1145/566654.566623>: impact zones.
//!
//! XPBD is reported to be covered by US patent 11,270,041: whether that concerns you is for you to check.

#![forbid(unsafe_code)]

mod config;
mod forces;
pub mod links;
mod refinement;
mod solver;
mod substeps;
mod update;

#[cfg(feature = "direct")]
pub mod direct;

#[cfg(feature = "single")]
pub mod single;

pub use config::XpbdConfig;
pub use forces::RowForce;
pub use solver::{XpbdBuilder, XpbdSolver};
pub use substeps::SubstepRule;

pub use cloth_core;
#[doc(no_inline)]
pub use cloth_core::{
    energy::Spring,
    math::Vec3,
    method::position_based::{Acceleration, Chebyshev, Radius, Sweep},
    particles::{Particles, State},
    step::{BuildError, StepError, StepInput, StepReport, Stepper},
};
