//! Contact as a potential: an energy per area of the distance to the nearest primitive, which every method can take
//! into its own solve.
//!
//! # The idea
//!
//! Cloth that touches something is pressed against it, and the pressure depends on how near it is: p = −ψ′(d), with an
//! energy ψ (J/m²) that begins at the thickness h and whose stiffness κ (Pa/m) is a number of the scene, the same for
//! every method, resolution and step. Each contact counts with the area A that it stands for, so
//!
//! E(x) = Σ A ψ(d(x)),
//!
//! over all pairs (vertex, triangle), (edge, edge) and (vertex, obstacle) that are nearer than h. Here d is the
//! distance itself, not its square: unsigned between primitives of cloth, the signed φ before an obstacle. A vertex
//! stands for a third of the rest area of the triangles around it, before other cloth for half of that, since the
//! vertices of both sides press; an edge for a third of the area beside it, and two edges for the smaller of theirs. ψ
//! is quadratic down to h/2 and a barrier from there on ([`PenaltyLaw`]). So h is the activation distance (the d̂ of Li
//! et al. 2020), not a minimal one: under a pressure p of at most κ h/2 the gap is h − p/κ, and only 0 is never
//! reached. Codimensional IPC (Li et al. 2021) keeps at least an offset ξ besides, which is not here. Edges have ψ with
//! h/2 in place of h (their barrier begins at h/4), so they push only below h/2: not at all where the vertices keep the
//! cloth farther apart than that. This leaves far fewer pairs: with edges from h on, five layers of 17 × 17 vertices at
//! rest take implicit Euler three times as long.
//!
//! IPC's −(d − d̂)² ln(d/d̂) (Li et al. 2020) has no spring part: its stiffness at rest depends on the load, and κ is
//! adapted. Here κ is a number of the scene, and the gap under a known weight is known.
//!
//! Two parts of one sheet count like two sheets, as long as they share no vertex: also neighbours, such as the two
//! corners that face each other across an edge. For two primitives of one connected component ψ begins at the distance
//! that they have at rest, where that is less than h (of edges h/2). So a flat sheet at rest is not pressed by itself,
//! even if h is longer than its edges.
//!
//! What shares a vertex is at distance 0 always, so it has no ψ and no test. No crossing is missed for that. Two
//! triangles with one common vertex meet elsewhere only if the side opposite to it of one meets the other; two with a
//! common side only if they lie flat on each other, so that a corner of one is in the other or two sides cross. When
//! that begins, a vertex and a triangle, or two edges, that share no vertex are at distance 0, and those are tested.
//! What is missed is force: only bending and the pairs around it resist the angle at the common vertex or side.
//!
//! Before a body with a concave edge a vertex can have two nearest points, one on either side of the edge, and the
//! gradient of ψ(φ) jumps where one takes over from the other. That is just where cloth comes to rest, and no iteration
//! on E would end. So for a [`ClosedMesh`](crate::obstacle::ClosedMesh) E is Σ ψ(d) over the triangles of the surface
//! within h, less the same over its edges, plus the same over its vertices ([`SignedDistance::each_part`]). Where the
//! surface is flat or convex all but one of the terms cancel, and ψ(φ) is left: above an edge, 2 ψ(φ) of the triangles
//! beside it less ψ(φ) of the edge itself. In a concave edge both sides press, each with its own ψ, and the gradient is
//! continuous (`obstacle/closed_mesh/concave_edges.rs`). Shapes with a formula, which are convex, and a
//! [`SampledDistance`](crate::obstacle::SampledDistance), whose φ is smooth, have ψ(φ) itself. Methods that project
//! take φ of every shape, and go from side to side within a sweep.
//!
//! A method adds E to what it minimises, with its gradient, and the Gauss–Newton part of its second derivative, A ψ″ ∂d
//! ∂dᵀ, for two edges times the [`Mollifier`] m. Without A ψ′ ∂²d, even Newton's iteration converges no faster than
//! linearly where contact points slide or the normal turns; [`PairContact`] has it, and compares keeping, projecting
//! and dropping it. Before a method moves the cloth it asks how far the path is safe
//! ([`ContinuousTest`](crate::ContinuousTest)). So what it accepts is free of crossings, and nothing is left to be
//! repaired afterwards. The answer is the safe fraction of the path, a number from 0 (none of it) to 1 (all of it): one
//! for all vertices (`limit`), or one for each (`limit_each`). What is safe keeps a fifth of each distance, or of h
//! where that is less (a tenth in substeps of constraints). Where the longest path, apart from the motion that all
//! vertices share, is longer than 10 h, all paths are tested only up to the fraction at which it has 10 h, and the
//! answer is at most that fraction. So an answer below 1 need not mean that there is a contact.
//!
//! Projective dynamics takes the energy as well. A view as squared distances ½ w ‖S x − p‖² to sets would be in its
//! constant matrix, but w would have to be ψ″, which differs from pair to pair by orders of magnitude and grows as 1/d²
//! in the barrier, and the pairs come and go.
//!
//! The pairs are not an active set. E is one function, the sum over all pairs, to which those beyond their range add
//! nothing; the list of pairs holds at least those within range anywhere on the path. So a new detection changes which
//! terms are evaluated and not their sum, and a line search meets one continuously differentiable energy. The set of
//! terms of friction is fixed for the step.
//!
//! With the gradient g and the direction p, a path that is cut as a whole (`limit`) to a fraction t is still one of
//! descent: its slope is t g·p < 0. One that is cut vertex by vertex (`limit_each`) to fractions t_v has the slope Σ
//! t_v g_v·p_v. It may be positive, where mostly those vertices are cut that would have lowered the energy. So a method
//! takes such a path only if its slope is negative and a line search along it finds a lower energy. Otherwise it cuts
//! the whole path to one t. Unless t is 0, a line search then finds a lower energy, as far as rounding lets it tell; if
//! not, the iteration ends where it is. The safe fraction of a path is 0 only where a fifth of the distance is lost in
//! the rounding of positions, or a vertex is inside a body. Both calls end by themselves (`filter`).
//!
//! So the energy falls in each iteration. Whether it comes near enough to its minimum in a given number of them is the
//! method's to say: no number of detections is guaranteed. Those that minimise measure the Newton decrement against the
//! change of velocity in the step, and end at their most iterations with a state that is free of crossings all the
//! same, and with [`Outcome::BudgetSpent`](cloth_core::step::Outcome::BudgetSpent) and the decrement that is left
//! ([`residual`](cloth_core::step::StepReport::residual)) in the report.
//!
//! A step calls `begin`, in each iteration `add_gradient`, `linearize` and `limit` or `limit_each`, and `end`. Who
//! solves with the terms of `linearize` hands the solution to `update_multipliers`; then the next ones know how hard
//! cloth is going to be pressed (`multipliers`), which saves most iterations where it is taut.
//!
//! - `begin` checks that nothing crosses at the start, unless that is where the last step has ended, and moves the
//!   bodies that the cloth pushes. It finds the pairs, freezes friction, and moves the start of the iteration as far
//!   towards the method's own start as the path is safe. The minimum that the iteration finds depends on its start only
//!   if there are several.
//! - `end` stores the tangential displacement of sticking contacts, and adds up work, forces and the energy that is
//!   stored.
//!
//! A method that minimises sees bodies where the step ends, and yet misses none that goes through the cloth on the way.
//! Where pins or bodies move, or cloth begins inside a body, `begin` takes the whole step as one substep of the
//! constraints (below), and these see bodies on their path: the cloth goes from the start of the step to the method's
//! own start, 10 sweeps press it out of the way, and all pairs and all vertices before bodies are tested over the whole
//! path, with the last resort if need be. So the cloth is on the same side of each body as before when the iteration
//! begins. All iterates are reached from there by tested paths, before bodies that stand still where the step ends. In
//! that substep a body moves rigidly for its signed distance, and the vertices of its
//! [surface](PotentialBuilder::surface) go straight: with the angular velocity ω (1/s) one at a distance r from the
//! axis is up to r (1 − cos(ω Δt/2)) inside of its arc.
//!
//! Friction has the normal forces λ and the directions of the start of the step (`friction`): a cloth that lands has
//! none in the step in which it does. Its energy is μ λ f(u) of the tangential displacement u, with f = u²/(2ε) below
//! ε = h/100 and u − ε/2 from there on, so that f′, the fraction of μ λ, is continuous. (Li et al. take a cubic, whose
//! f″ is continuous too.) u is counted from where the contact began to stick: a step begins with the u at which the
//! last one ended, cut to ε if it was longer.
//!
//! # Words
//!
//! | word | what it means here |
//! |---|---|
//! | body | anything solid that the cloth meets |
//! | obstacle | a body with a signed distance; a *surface* is the triangles of a body |
//! | law | ψ with its derivatives ([`PenaltyLaw`]) |
//! | range | the distance at which a pair begins to push: where ψ begins, or d₀ of a constraint |
//! | row | one term k J Jᵀ of a Hessian, J = c_k n on up to four vertices ([`ContactRow`](cloth_core::contact::ContactRow)) |
//! | excess gap | the distance less the range |
//! | to choose pairs | to list those that can be in range on a path: what is evaluated on it |
//! | to cut, shorten or truncate a path | to let a vertex go only a fraction of it; it *stays* if that is 0 |
//! | to give way | to move by the inverse mass under a push |
//! | `harden` | to set the compliance of a constraint to 0 |
//! | `reach` | in code: of detection, h and a margin; of patches, the path until the next search; of friction, ε |
//! | ledger | the impulses on vertices and bodies that a step has added up, where forces are recorded |
//!
//! # From the naive loop to this one
//!
//! The naive loop visits all pairs of a vertex and a triangle, and of two edges, that share no vertex, and adds up
//! [`PairContact`] (`examples/naive_pairs.rs`, which compares energy, forces and Hessian). For V vertices, T triangles
//! and N edges these are about V T + N²/2 distances: 1.1·10⁸ for a sheet of 64 × 64 cells. The crate adds up the same
//! terms of fewer pairs:
//!
//! 1. Patches of triangles that are near each other are found by a broad phase, and stay known while no patch has gone
//!    farther than that search allowed for (`patches`).
//! 2. Between two near patches all pairs are found whose excess gap is below a margin, and sorted by it. (The range is
//!    h, of edges h/2, or the distance at rest where that is less.) How far the patches have moved against each other
//!    since then is bounded. While that bound is below the margin, the list is complete, and only the pairs at its
//!    beginning, with an excess gap below the bound, are evaluated.
//! 3. Of the rest, a plane with a known normal decides for most that they are out of range (`near_pairs`,
//!    `pair_constraint`).
//! 4. What is left has its distance computed, and is a term of the sum.
//!
//! Each stage may keep a pair too many, and must not lose one. `tests/unit/potential_near_pairs.rs` compares the list
//! with all pairs on random paths, `tests/all/candidates.rs` the broad phases with brute force, and
//! `tests/all/guarantee` steps loose triangles that are kicked at random, none of which may meet at six moments of each
//! path. That samples motions of the constraints; the proof is in `ccd/reach.rs`.
//!
//! # What is kept, and what is not
//!
//! - *Momentum.* The weights of a pair add up to zero to rounding, so its forces do, of pressure and of friction,
//!   whether taken as energy or as constraint; a prescribed vertex or a body takes its part.
//! - *Angular momentum.* E does not change when everything turns, so the moments of pressure add up to zero too
//!   (`forces_and_moments_add_up_to_nothing`). A constraint pushes along the normal n of the start of the substep,
//!   which is off the line between its two points once these have slid. Friction f acts at two points a distance d
//!   apart, a couple of size d ‖f‖ ≤ h μ λ.
//! - *Energy.* Pressure gives back what it has stored, less what the integrator damps. A sheet of ρ (kg/m²) that hits a
//!   body flat oscillates with ω² = κ/ρ, and implicit Euler leaves 1/(1 + ω² Δt²) of its energy in a step. At κ = 10⁶
//!   Pa/m, 0.2 kg/m² and 1/60 s that is less than a thousandth, so the sheet does not bounce. With a
//!   [restitution](PotentialBuilder::restitution) e an impact at the speed u takes (1 − e²) u²/(2 K), K = Σ c_k²/m_k
//!   (`rebound`). Friction only takes, but for what it gives back of a displacement below ε.
//! - *In the last resort,* pushes keep momentum, and take kinetic energy unless the pair has turned (`last_resort`).
//!   Impact zones keep momentum and angular momentum as well, except a zone with a prescribed vertex or one of a body's
//!   surface, which moves as these do, and one that is moved out of a body. A vertex that stays keeps none.
//!
//! # For methods that project positions
//!
//! XPBD, PBD and explicit methods get the same potential as constraints in each of their substeps: n·Σ c_k x_k ≥ d₀
//! with d₀ = d − ψ′/ψ″, which is h down to h/2, the compliance 1/(A ψ″), a multiplier λ ≥ 0 (kg m; λ/Δt² is the force),
//! and friction within μ λ that remembers where it began to stick. Below 0.05 h the force stays that at 0.05 h. Here λ
//! is that of the sweep, not of the substep before. The constraints of what can touch, by bounds on the relative motion
//! of patches of the cloth, are found at the beginning of a substep. They come last in each sweep. At the end every
//! pair is tested:
//!
//! - Pairs that have come too near get up to three rounds of five sweeps without compliance.
//! - After that their vertices go half as far, in up to three rounds, and stay where they were in up to six more.
//! - What is not safe even then, or has a path too long to be tested, is left to the last resort (`last_resort`: pairs
//!   pushed apart one by one, impact zones, vertices that stay).
//!
//! # Three views, and which method takes which
//!
//! - *An energy.* The method evaluates Σ A ψ(d), its gradient and its Hessian, Σ A ψ″ J Jᵀ, at each iterate, and asks
//!   before each displacement how far it is safe. Friction is bounded by the μ λ of the start of the step. This is what
//!   implicit Euler, BDF2, the linearly implicit method, the implicit midpoint rule (with the positions at the end of
//!   the step) and projective dynamics take.
//! - *Constraints.* In each substep a pair has one tangent of ψ′, as a range d₀ and a compliance. Displacements are
//!   made first, and tested at the end of the substep. Friction is bounded by the μ λ of the sweep. XPBD and PBD visit
//!   the constraints last in each sweep, the direct solver of XPBD and explicit methods at the end of each substep.
//! - *A displacement that is kept free of crossings.* There is no force and no time in it: it is tested, repaired and
//!   shortened as at the end of a substep ([`keep_free`](cloth_core::contact::ContactSource::keep_free)). This is for
//!   what moves the cloth between steps: strain limits, and a [`StepUntangler`](crate::untangle::StepUntangler).
//!
//! The first two have the same state of rest, down to a distance of 0.05 h: the tangent there is that at the distance
//! of rest, so its force is −ψ′ itself. In motion they differ in which distance and which λ a force belongs to.
//!
//! # Laws that contact obeys
//!
//! Closed forms, with the weight ρ g per area. Tests compare methods of both kinds with them
//! (`cloth-bench/tests/contract/potential.rs`, `cloth-bench/tests/all/studies/contact`, `cloth-bench/src/laws`):
//!
//! - *Pressure.* −ψ′(d) = p, so d = h − p/κ for p up to κ h/2, and κ h²/(4 p) above. A sheet that rests on a floor has
//!   p = ρ g, on any mesh and with any step, and stores ½ p²/κ per area in the first case.
//! - *Stack.* The k-th gap from above carries k ρ g, and the floor under N sheets N ρ g.
//! - *Incline.* On a slope of the angle α, p = ρ g cos α. For tan α < μ a sheet sticks; the energy of friction lets it
//!   give way by ε tan α/μ once, and no farther. For tan α > μ it slides, with a = g (sin α − μ cos α): with implicit
//!   Euler, from rest, by a Δt² n (n + 1)/2 in n steps.
//! - *Strip over a cylinder* of radius R, without friction, its ends H below its top. At the angle φ from the top the
//!   tension carries what hangs lower, T = ρ g (H − R + R cos φ) per width. So the pressure, T/R + ρ g cos φ, is
//!   ρ g (H/R − 1 + 2 cos φ).
//! - *Capstan.* Where a strip turns by δ at a vertex, with the tensions T₁ < T₂ on its two sides, the normal force is
//!   (T₁ + T₂) sin δ/2, and friction has to hold (T₂ − T₁) cos δ/2. It slips above T₂/T₁ = (1 + μ tan δ/2)/(1 − μ tan
//!   δ/2), and over several such vertices above the product of that. For δ → 0 this is e^{μθ}, θ the sum of all δ. With
//!   μ = 0.3 and half a turn in 15 vertices of π/16 and two of π/32 it is 2.574, beside e^{μπ} = 2.566.
//! - *Bounce.* With restitution e a sheet that falls from the height H rises to e²ⁿ H after n bounces.
//!
//! On a cylinder contact is right only as far as the tension is. PBD at its default makes cloth softer than its
//! material; there the strip presses more, and does not slip.
//!
//! # What can be read out
//!
//! - *Forces*, pressure and friction apart, on every vertex and every body, with torques:
//!   [`PotentialContacts::forces`], once [`PotentialContacts::record_forces`] is on. [`ContactForces`] says what is in
//!   them.
//! - *Work* of moving bodies and prescribed vertices on the cloth, and the *energy* that contact has stored:
//!   [`work`](cloth_core::contact::ContactSource::work),
//!   [`potential_energy`](cloth_core::contact::ContactSource::potential_energy).
//! - *What a step took* of a method that projects: [`ConstraintReport`].
//!
//! # Bodies
//!
//! A body that knows its signed distance keeps the vertices of the cloth out by it: their pressure is exact, whatever
//! the triangles of both. It does not see what is between the vertices. So a body can also have a surface of triangles
//! ([`PotentialBuilder::surface`]), whose vertices are appended to those of the cloth as prescribed ones: pairs (edge,
//! edge) and (vertex of the body, triangle of the cloth) are treated as in the cloth itself, and push below h/2: not at
//! all where the signed distance keeps the cloth farther away. A body that changes its shape, open or closed, has its
//! triangles alone ([`PotentialBuilder::animated`]), and so has a rigid one without an inside
//! ([`SurfaceOnly`](crate::obstacle::SurfaceOnly)): they keep the cloth on the side where it is, and press each of its
//! vertices with A ψ(d) for every triangle of the body within h. Above the middle of a triangle that is the pressure of
//! a signed distance; above an edge it is twice as much, since the triangles on both sides of it count. Cloth that is
//! inside of such a body stays there.
//!
//! | scene | what to build |
//! |---|---|
//! | floor, wall, smooth body whose radii are larger than the triangles of the cloth | [`obstacle`](PotentialBuilder::obstacle) alone |
//! | corners and sharp edges, or a body smaller than a triangle | with its [`surface`](PotentialBuilder::surface) |
//! | a rigid mesh of many triangles | a [`SampledDistance`](crate::obstacle::SampledDistance), off by a quarter of its spacing at edges, with the surface |
//! | a rigid mesh that is open, or goes through itself | [`SurfaceOnly`](crate::obstacle::SurfaceOnly), with the surface |
//! | a body that deforms | [`animated`](PotentialBuilder::animated) |
//! | one whose shapes are not known in advance | the same, and [`set_shape`](PotentialContacts::set_shape) before each step |
//! | a sheet that cannot reach itself | [`self_collision(false)`](PotentialBuilder::self_collision) |
//! | pieces sewn together, or layers that may pass | [`sew`](PotentialBuilder::sew), [`exclude`](PotentialBuilder::exclude) |
//!
//! Whether a choice was too coarse is measured after a step: [`BodyProbe`](crate::BodyProbe) counts triangles of the
//! cloth in a body, [`SeparationProbe`](crate::SeparationProbe) those in the cloth. They look for triangles that meet
//! at one moment, by the exact test. The detection, the constraints and the continuous test that keep the cloth apart
//! have no part in that. What is shared are the lists of neighbours and of pairs that do not count, the distance of two
//! primitives, and the check of the start of a step, which is the same test. What a step reports
//! ([`ConstraintReport`]) tells too.
//!
//! Pairs of bodies, and of a body with prescribed cloth, are left out: a body that nothing pushes may pass through
//! itself and others, and prescribed cloth may be inside of one. A triangle with a prescribed corner that crosses a
//! body at the start of a step passes through it, as nothing could part the two: a flag in its pole. Once the corner is
//! out, and nothing crosses there, contact is what it was ([`PotentialContacts::prescribed_inside`]). Prescribed parts
//! of the cloth that cross each other are an error.
//!
//! # Which step for which speed
//!
//! Every step is safe, whatever its length Δt. What one that is too long costs differs. Let u (m/s) be the speed at
//! which two things meet, relative to the mean motion of the cloth, and l (m) the mean edge:
//!
//! | method | what bounds the step | what tells |
//! |---|---|---|
//! | those that minimise | no stability. A path is followed by 10 h an iteration, so it takes u Δt/(10 h) of them at least: 17 for 10 m/s, 1/60 s and 1 mm. Friction is that of the step before. | `Outcome::BudgetSpent` and the residual |
//! | XPBD, PBD, by substeps | u Δt < l. Normals and nearest points are those of the start of the substep. What slides farther is over other triangles, whose pairs are only tested, and repaired at the end. From 30 l on nothing but the last resort is left. | `violated`, `shortened` and `zones` of [`ConstraintReport`] |
//! | explicit, by substeps | its own stable step, which is of the order of l over the speed of sound in the cloth. κ does not shorten it: contact is a constraint with a compliance, so implicit. | the same |
//! | with bodies that the cloth pushes | Δt < 2/Ω by [`RigidBody::highest_frequency`](crate::obstacle::RigidBody::highest_frequency); a method that minimises, a push of less than h | [`PotentialContacts::largest_push`] |
//! | with restitution | an impact of what lies is g Δt² > h/1000 (`rebound`) | – |
//!
//! For accuracy at rest ρ g/κ < h/2 (see [`stiffness`](PotentialBuilder::stiffness)), at any step.
//!
//! # Add it to a method
//!
//! In the order that [`ContactPotential`](cloth_core::contact::ContactPotential) says, for one that minimises, or
//! [`ContactConstraints`](cloth_core::contact::ContactConstraints), for one that projects;
//! [`Projection::step`](cloth_core::contact::Projection::step) is all of that after a free step. [`PotentialContacts`]
//! has a short example, `cloth-bench/examples/own-method` a whole one, and `cloth-bench/doc/results.md` says how each
//! method of the workspace takes it. After an error the positions are of no use: the caller keeps the state that it
//! had.
//!
//! # Equation → code
//!
//! | equation | code |
//! |---|---|
//! | ψ, ψ′, ψ″ | [`PenaltyLaw`] |
//! | d, ∂d, ∂²d | [`Gap`] |
//! | m(‖u × v‖²) for two edges u, v (Li et al. 2020, equation 24) | [`Mollifier`] |
//! | A ψ(d), A m ψ(d) as elements, with both derivatives | [`PairContact`] |
//! | u, in the plane across n (Li et al. 2020, section 5.4) | `FrictionContact::displacement`, in `friction` |
//! | μ λ, n and weights, frozen at the start of the step | `Contacts::freeze_friction`, in `source` |
//! | μ λ f(‖u‖) and its force μ λ f′(‖u‖) u/‖u‖ | `FrictionContact::add_gradient`, in `friction` |
//! | its Hessian, along u/‖u‖ and n × u/‖u‖ | `FrictionContact::rows`, in `friction` |
//! | ‖f‖ ≤ μ λ of a constraint, in each sweep | `ConstraintState::project`, in `tangent` |
//! | Σ w ψ(d) of a vertex before a body, and its derivatives | `ObstacleContact`, in `obstacle_contact` |
//! | which pairs can be near on a path | `near_pairs`, `culled` |
//! | surfaces of bodies, with vertices that are numbered after those of the cloth | `surfaces` |
//! | P ← P + m g Δt + ∫f dt of bodies that the cloth pushes | `free` |
//! | n·K λ n = (min(d, φ₀) − φ)/τ, λ ≥ 0, friction ≤ μ λ, where such a body meets what does not give way | `stops` |
//! | C = n·Σ c_k x_k − d₀, α = 1/(A ψ″), λ ≥ 0 | `pair_constraint`, `constraints`, `bodies`, `tangent` |
//! | what can touch in a substep or on a path | `patches`; whether anything can, `culled_substeps` |
//! | the fraction of its path on which a pair is safe | `safe_fraction_of_pair`, in `filter` |
//! | the same for a vertex before a body | `safe_fraction_at_obstacle`, in `filter` |
//! | the least of these, for all vertices (`limit`) | `NearPairs::safe_fraction`, in `filter` |
//! | a fraction for each vertex (`limit_each`) | `NearPairs::shorten`, in `filter` |
//! | min(1, 10 h over the longest path) | `Contacts::tested_fraction`, in `source` |
//! | a constraint keeps a tenth of its distance on its path | `PairConstraint::is_safe`, in `pair_constraint` |
//! | Σ A ψ, Σ A ∂ψ, Σ A ψ″ ∂d ∂dᵀ | [`PotentialContacts`] |
//! | λ/d in the place of A ψ″ of a pair that is pressed (primal–dual) | `multipliers` |
//!
//! # Cost
//!
//! Bounds on the motion cost time in proportion to the vertices in each substep or path, and to the vertices times the
//! bodies. The distance of a body is asked for only where its bound does not tell; pairs of patches are searched when
//! one has gone a mean edge or more, and the primitives of two patches, at most 32 triangles each, when the motion
//! bound of their last search is used up. Gradient, rank-one Hessian terms and sweeps are in proportion to the pairs
//! nearer than h or nearly so, and so is a safe path: one continuous test each, of at most
//! [`MOST_STEPS`](crate::ContinuousTest::MOST_STEPS) steps, where a bound does not tell. A round of the last resort
//! searches the whole cloth. What a step takes without contact and with it stands in `cloth-bench/doc/results.md`.
//!
//! # Pinched cloth
//!
//! Cloth between two bodies that close on it has no feasible path, none that keeps the guarantee. That is an error,
//! [`ContactError::Infeasible`](cloth_core::contact::ContactError::Infeasible), and ends the step where it began; or,
//! with [`PotentialBuilder::pinched_cloth_passes`], the vertices that have no feasible path pass through one of the
//! bodies, with their neighbours: through that of the highest number among those that block it. Cloth that crosses a
//! body at the start passes through it in the same way while a [`StepUntangler`](crate::untangle::StepUntangler) pulls
//! it out. Everything else is kept apart as before. Once no triangle of the cloth crosses that body any more and none
//! of these vertices is inside, contact with it is what it was. [`PotentialContacts::pinched`] counts them. Which of
//! the bodies the cloth should obey no law says; where that matters, number them, or end the motion of the body before
//! it closes on the cloth.
//!
//! # Bodies that the cloth pushes
//!
//! A body with a mass and an inertia ([`PotentialBuilder::free`]) moves on in each (sub)step as its momentum says, and
//! takes up the impulses of contact at the end: momentum is kept, except where the last resort moves the cloth without
//! an impulse on the body. Prescribed vertices and other bodies do not give way, so they stop it before the step,
//! inelastically and with friction (`stops`): at h/2 from prescribed cloth, with the coefficient of cloth on the body,
//! and at h from bodies, with the geometric mean of both coefficients. So cloth between two bodies carries the upper one
//! up to a pressure of κ h/2, and what is heavier stands on the lower body: for a weight of pressure p, κ should be 3
//! p/h or more. Where cloth between it and something else has no safe path even so, the body halts for the step, and
//! loses its momentum. Steps have to resolve the frequency of the body on the contact,
//! [`RigidBody::highest_frequency`](crate::obstacle::RigidBody::highest_frequency). Between steps
//! [`PotentialContacts::hold_body`] stops such a body or releases it, from rest, and
//! [`PotentialContacts::set_velocities`] changes the motion of an obstacle that the cloth does not push.
//!
//! # Limits
//!
//! - A sheet that falls on a ball of its own size buckles on impact in many ways at once, and the minimum of such a
//!   step takes five to ten times the iterations of one without contact.
//! - A vertex above an edge of an animated surface is pressed by both triangles there, and is nearer to the thickness
//!   for it.
//! - A body that the cloth pushes is moved before the cloth, and pushed after it. For methods that minimise, a step in
//!   which that push would have changed its displacement by more than the thickness is too long: cloth a cell away from
//!   prescribed vertices is pressed flat, and throws the body off. [`PotentialContacts::largest_push`] tells, and
//!   [`PotentialContacts::take_back`] lets a caller take the step again as shorter ones, as the runs of `cloth-bench`
//!   do. XPBD's substeps are short enough.
//! - There is no restitution for methods that minimise: what bounces is elastic.
//! - A contact is as stiff as A ψ″ = κ A (h/2d)² below h/2. The condition of what a method that minimises
//!   solves grows with that over m/Δt² of a vertex, so cloth that is pressed to d ≪ h, or a large κ, costs iterations:
//!   in the scene `tent` of `cloth-bench` 19 a step of implicit Euler and 25 of projective dynamics, in the mean.
//! - What is near a vertex without being below it counts too: as the thickness h comes near the length of edges, two
//!   sheets press harder than κ says. On a grid by less than 1 % where h is a thousandth of a cell, 1.3 times at a
//!   tenth, 1.9 times at three tenths, 4.6 times where h is as large as a cell
//!   (`cloth_presses_cloth_as_it_presses_a_body`, of the tests). Forces are in balance all the same; only the gap is
//!   nearer to h than h − p/κ.
//!
//! # References
//!
//! - M. Li, Z. Ferguson, T. Schneider, T. Langlois, D. Zorin, D. Panozzo, C. Jiang and D. M. Kaufman, Incremental
//!   potential contact, *ACM Transactions on Graphics* 39(4), 2020. DOI 10.1145/3386569.3392425: the barrier, the
//!   mollifier, lagged friction (section 5.4), the step that stays in the safe set.
//! - A. H. Chen, J. Hsu, Z. Liu, M. Macklin, Y. Yang and C. Yuksel, Offset geometric contact, *ACM Transactions on
//!   Graphics* 44(4), 2025. DOI 10.1145/3731205: the two-stage law (section 3.3).
//! - M. Macklin, M. Müller and N. Chentanez, XPBD: position-based simulation of compliant constrained dynamics, *Motion
//!   in Games* 2016. DOI 10.1145/2994258.2994272: constraints with a compliance.
//! - M. Müller, M. Macklin, N. Chentanez, S. Jeschke and T.-Y. Kim, Detailed rigid body simulation with extended
//!   position based dynamics, *Computer Graphics Forum* 39(8), 2020. DOI 10.1111/cgf.14105: restitution (section 3.6).
//! - E. Guendelman, R. Bridson and R. Fedkiw, Nonconvex rigid bodies with stacking, *ACM Transactions on Graphics*
//!   22(3), 2003. DOI 10.1145/882262.882358: impulses of single points, one after another.
//! - R. Bridson, R. Fedkiw and J. Anderson, Robust treatment of collisions, contact and friction for cloth animation,
//!   *ACM Transactions on Graphics* 21(3), 2002. DOI 10.1145/566654.566623: repulsions, impulses and impact zones.
//! - M. Li, D. M. Kaufman and C. Jiang, Codimensional incremental potential contact, *ACM Transactions on Graphics*
//!   40(4), 2021. DOI 10.1145/3450626.3459767: the offset ξ.

mod between_steps;
mod bodies;
mod builder;
mod clock;
mod constraints;
mod culled;
mod culled_substeps;
pub(crate) mod excluded;
mod filter;
mod forces;
mod free;
mod friction;
mod groups;
mod handed;
mod last_resort;
mod led_out;
mod mollifier;
mod multipliers;
mod near;
mod near_pairs;
mod obstacle_contact;
mod pair;
mod pair_constraint;
mod patches;
mod pinched;
mod rebound;
mod report;
pub(crate) mod sewn;
mod shared;
mod source;
mod stops;
mod surfaces;
mod tangent;
mod zones;

pub use crate::pair::{Gap, Pair};
pub use builder::PotentialBuilder;
pub use forces::{BodyForce, ContactForces};
pub use mollifier::Mollifier;
pub use pair::PairContact;
pub use report::ConstraintReport;
pub use surfaces::PotentialContacts;

#[cfg(doc)]
use crate::obstacle::{PenaltyLaw, SignedDistance};
