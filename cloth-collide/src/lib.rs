//! Contact of cloth with obstacles and with itself: distances, the time of the first contact on a path, and forces.
//!
//! # The idea
//!
//! **Obstacles** are functions: the signed distance φ(x) of a point from a surface. A vertex is kept out by one
//! inequality, φ(x) ≥ h, whatever the shape and however it moves. [`obstacle`] has the shapes, the search for the first
//! contact on a path, and the law of pressure. (φ is this distance on all
//! pages; ψ is the energy of contact.)
//!
//! **Cloth against cloth** is about pairs: a vertex and a triangle, or two edges. A step takes them through five
//! stages:
//!
//! 1. *Broad phase:* of n² pairs it leaves the few whose boxes overlap, and of those the ones that no plane separates
//!    ([`ClothCandidates`]).
//! 2. *Detection:* which of these can touch in the step, and their nearest points.
//! 3. *Potential, or constraint:* what presses them apart within the solve.
//! 4. *Filter:* how far the displacement that the solve has found is safe.
//! 5. *Last resort:* what becomes of a displacement that is not.
//!
#![doc = include_str!("../doc/stages.svg")]
//!
//! **Measuring** is no stage of a step, but tells afterwards what became of it. [`SeparationProbe`] counts the pairs of
//! triangles that meet apart from the vertices and edges that they share, decided exactly, and gives the smallest
//! distance. Two triangles that do not meet are as far apart as the least of 6 vertex–triangle and 9 edge–edge
//! distances, d(A, B) = min ( min |v − T|, min |e − f| ). For the line between two nearest points is at right angles to
//! each face or edge that one of them is inside of. So where one is inside a face, both can slide along at the same
//! distance, until the one is on the border of its face or the other at a vertex.
//!
//! # Between two moments
//!
//! A vertex at 10 m/s moves 17 cm in a sixtieth of a second, 170 times a thickness of 1 mm. It is on one side at one
//! moment and on the other at the next, and the two moments alone do not show that it passed. So the motion
//! in between is tested: all vertices move linearly, and the question is the first time at which a vertex and a
//! triangle, or two edges, are at distance 0 (or d). When two triangles first touch, one of these 15 distances is 0, as
//! above. Vertices and triangles alone are not enough: two edges can cross with all four of their ends in the clear.
//!
#![doc = include_str!("../doc/crossing-edges.svg")]
//!
//! Both are one question: when does a moving polygon, of the differences of a vertex to the corners of a triangle or of
//! the ends of two edges, contain the origin? [`ContinuousTest`] steps through time from one plane that has the polygon
//! on one side to the next, and misses no contact. The textbook method is the other one round (Provot 1997): it looks
//! for the times at which the four vertices are in one plane, and then for contact there. With three of the differences
//! x_k = a_k + t b_k and |x y z| = x · (y × z) these are the roots of |x₀ x₁ x₂|, a cubic c₀ + c₁ t + c₂ t² + c₃ t³ of
//!
//! c₀ = |a₀ a₁ a₂|, c₁ = |b₀ a₁ a₂| + |a₀ b₁ a₂| + |a₀ a₁ b₂|,
//! c₂ = |a₀ b₁ b₂| + |b₀ a₁ b₂| + |b₀ b₁ a₂|, c₃ = |b₀ b₁ b₂|.
//!
//! At each of up to three roots in [0, 1] the nearest points tell a contact from a miss: w_b, w_c ≥ 0 and w_b + w_c ≤ 1
//! in a triangle, s and t of two edges from 0 to 1 (the [table](#equation--function)). It is short and fast. But a
//! graze is a double root, which rounding splits or loses, and a tolerance that finds it reports passes as contacts
//! (Wang et al. 2021); and what stays in one plane makes the cubic vanish. `cloth-bench ccd` counts the errors of each.
//!
//! # Contact in the solve
//!
//! [`PotentialContacts`](potential::PotentialContacts) joins all of this behind the one hook of all methods; the
//! chapter is [`potential`]. A vertex that is nearer than the thickness h to a body or to other cloth is pressed away
//! by a potential Σ A ψ(d), whose forces are equal and opposite. Edges push from h/2 on, and neighbours in the mesh
//! from no farther than their distance at rest. A method takes the potential as an energy or as constraints: both rest
//! at h − ρ g/κ on a body if ρ g ≤ κ h/2, and no number is tuned for one of them. Since a potential cannot tell the
//! sides of a sheet apart, every displacement is tested over the whole of its path. An iteration that minimises and
//! finds no safe path stays where it is. A substep that projects has to end somewhere: after harder sweeps and
//! shortened paths it has the [last resort](potential#for-methods-that-project-positions), and reports it. So a step is
//! either free of crossings or refused: [`PotentialContacts`](potential::PotentialContacts) has what exactly is
//! guaranteed.
//!
//! The naive loops are three examples, each compared with the crate: `examples/first_program.rs`, the vertices before a
//! floor and a ball; `examples/naive_pairs.rs`, all pairs of two sheets; `examples/naive_sweep.rs`, sweeps over
//! constraints with friction. How the loops of the crate follow from them stands in
//! [`potential`](potential#from-the-naive-loop-to-this-one).
//!
//! # Errors and bad input
//!
//! Positions that are not finite and settings out of their range are [`CollideError`]s with the vertex or the number;
//! shapes with impossible sizes [`ObstacleError`](obstacle::ObstacleError)s; descriptions of contact that do not fit
//! the mesh a [`BuildError`](cloth_core::step::BuildError) that names the setting and its range. In a step,
//! [`ContactError`](cloth_core::contact::ContactError) says what it cannot work with (the number of vertices, the step
//! size, a mass, a position that is not finite) and what it cannot keep: a start that crosses already
//! (`IntersectingStart`, see [`untangle`]), a state of another time than moving bodies (`WrongTime`), or two bodies
//! that leave the cloth no place (`Infeasible`, with the vertex and a body, unless pinched cloth may pass). The caller
//! keeps the state that it had. Outside of steps, slices of another length than the mesh has vertices, and triangles
//! of vertices without a position, panic where `# Panics` says so; coordinates and settings panic nowhere. A triangle
//! that has lost its area in motion is a segment or a point for the distances, the continuous test and the exact one,
//! and is kept apart like any other.
//!
//! # Threads
//!
//! From 8192 vertices on, with the feature `parallel` of `cloth-core`, three things run on several threads: the
//! detection of pairs of primitives between patches, the constraints that are made of them, and the continuous tests of
//! these; all else runs on the thread that calls. A thread fills and sorts the lists of its own pairs of patches, and
//! sums and sweeps go through these lists one after the other. So results are the same bits whatever the number of
//! threads, and the same on every run (`cloth-bench/tests/contract/thread_parity.rs`).
//!
//! # Memory
//!
//! Buffers are kept from step to step. Once they are as large as a scene needs, a search for candidates, the distance
//! from a body and a substep of the constraints allocate nothing (`tests/all/no_allocation.rs`,
//! `tests/all/contact_memory.rs`). The last resort builds its search when it first runs.
//!
//! # Meshes
//!
//! The cloth, and the surface of a body, is any [`TriMesh`](cloth_core::mesh::TriMesh): open or closed, with edges of
//! three triangles, with vertices at which two pieces touch alone, with windings of both kinds, through itself at rest.
//! Only a [`ClosedMesh`](obstacle::ClosedMesh), which has an inside, has to be closed and manifold, its triangles
//! counter-clockwise seen from outside, and must not pass through itself; what is wrong with it is an
//! [`ObstacleError`](obstacle::ObstacleError).
//!
//! # Add an obstacle shape
//!
//! 1. A file in `obstacle/` with a type that implements [`SignedDistance`](obstacle::SignedDistance): the distance and
//!    the outward normal at a point in the frame of the shape, whether φ is convex, and a box around it. No second
//!    derivative: Hessians have ψ″ ∂φ ∂φᵀ alone. A constructor that returns [`ObstacleError`](obstacle::ObstacleError)
//!    for sizes that make no shape. `sphere.rs` is short enough to copy.
//! 2. Its line in the table of [`obstacle`]. Motion, moving frames and the continuous test are
//!    [`Obstacle`](obstacle::Obstacle)'s, friction and work [`potential`]'s; they need nothing.
//! 3. `tests/all/obstacle_shapes.rs`: add it to the shapes there; gradient against differences, distance against points
//!    of the surface, and Lipschitz constant are then tested. If φ is not a true distance, say so by
//!    [`lipschitz`](obstacle::SignedDistance::lipschitz).
//! 4. Triangles of its surface ([`PotentialBuilder::surface`](potential::PotentialBuilder::surface)), if edges of the
//!    cloth are not to cut it where it is smaller than a triangle.
//!
//! Another [`BroadPhase`] works in [`ClothCandidates`]; for [`potential`] add it to [`BroadPhaseKind`] too. There is
//! one law, [`PenaltyLaw`](obstacle::PenaltyLaw), and another one has to replace it: its energy, slope and curvature,
//! with an energy that is infinite at 0 and a curvature that is nowhere negative, and constant from h/2 to h. The
//! constraints rely on the last: beyond 0.75 h they take the tangent of the law there (`tangent`).
//!
//! # When not to use it
//!
//! - Cloth that can touch nothing: leave contact out, and no code of this crate runs. With it, a sheet in free fall
//!   still pays for the bounds on its motion (`cargo bench --bench steps -- "in flight"`).
//! - A floor alone, far from any fold: an element with a penalty on the vertices
//!   ([`PenaltyLaw`](obstacle::PenaltyLaw)) is enough, and differentiable.
//! - Bouncing with methods that minimise: [restitution](potential::PotentialBuilder::restitution) is for those that
//!   project positions.
//! - Layers in their tens at rest: forces travel through a stack one layer an iteration, and methods cut short at a
//!   fixed number of iterations leave them out of balance.
//! - A start that crosses: [`untangle`] first.
//!
//! # Equation → function
//!
//! [`obstacle`], [`potential`] and [`untangle`] have tables of their own. Of two edges, u and v are their vectors, n =
//! u × v, and d goes from the first end of the second to that of the first; of a triangle, u and e are two edges, n = u
//! × e, and d goes from a corner to the point.
//!
//! | What | Where |
//! |---|---|
//! | w_c = n · (u × d) / n², w_b = u · (d − w_c e) / u²: nearest point of a triangle | [`point_triangle`] |
//! | s = n · (v × d) / n², t = v · (d + s u) / v²: nearest points of two edges | [`edge_edge`] |
//! | n(t) · x_k(t) > d \|n(t)\|: time of impact, never late | [`ContinuousTest`] |
//! | signs of pqab, pqbc, pqca: a segment meets a triangle, exactly | [`segment_meets_triangle`] |
//! | an edge of one meets the other: two triangles meet, exactly | [`triangles_meet`] |
//! | boxes of all that moves overlap, and no plane is between them: vertex–triangle and edge–edge candidates | [`ClothCandidates`] |
//! | overlapping boxes, from a tree, from hashed cells, from cells along a curve | [`Hierarchy`], [`SpatialHash`], [`MortonGrid`] |
//! | number of meeting pairs, min d over everything that shares no vertex | [`SeparationProbe`] |
//!
//! # Examples
//!
//! A ribbon, bent until its end has gone through its beginning.
//!
//! ```
//! use cloth_collide::SeparationProbe;
//! use cloth_core::math::Vec3;
//! use cloth_core::mesh::generate::{Diagonals, grid};
//!
//! let ribbon = grid(41, 3, 2.0, 0.1, Diagonals::Alternating)?; // 2 m by 10 cm
//! let mut probe = SeparationProbe::new(&ribbon);
//! // Bent to an arc of a circle of constant length 2 m, whose centre line turns by `angle`.
//! let mut bent = |angle: f64| {
//!     let radius = 2.0 / angle;
//!     let bend = |x: &Vec3| Vec3::new(radius * (x.x / radius).sin(), x.y, radius * (x.x / radius).cos());
//!     probe.measure(&ribbon.positions().iter().map(bend).collect::<Vec<_>>())
//! };
//!
//! let open = bent(3.0)?;
//! assert_eq!(open.intersecting_pairs, 0);
//! // Nothing is closer than neighbours are: the cells are 5 cm squares.
//! assert!((open.min_distance.unwrap() - 0.05 / 2f64.sqrt()).abs() < 1e-3);
//!
//! let nearly_closed = bent(6.27)?;
//! assert!(nearly_closed.min_distance.unwrap() < 0.005);
//!
//! let closed = bent(6.5)?;
//! assert!(closed.intersecting_pairs > 0);
//! assert_eq!(closed.min_distance, Some(0.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limits
//!
//! - Shapes with a signed distance are rigid, and keep the velocities that they were built with, unless the cloth
//!   pushes them. What deforms, moves on any other path, or has no inside has triangles alone: the table in
//!   [`potential`](potential#bodies).
//! - The uniform cells of two of the broad phases suit triangles of similar size, the tree suits all.
//! - [`SeparationProbe`] looks at the positions of one moment. A cloth that has passed through another between two
//!   moments, and is out on the far side, shows no trace.
//! - Distances are right to rounding: about 1e-15 of the size of the triangles. What else limits a method stands with
//!   it.
//!
//! # Files, in reading order
//!
//! | File | What it holds |
//! |---|---|
//! | `examples/` | the naive loops, each beside the real one |
//! | `closest/`, `pair.rs` | nearest points of a point and a triangle, and of two edges; their distance with both derivatives, and whether they stay apart on their path |
//! | `ccd.rs`, `ccd/query.rs` | the conservative continuous test, and what it is asked |
//! | `ccd/difference.rs` | a vertex and a triangle, or two edges, as one moving polygon |
//! | `ccd/direction.rs`, `ccd/reach.rs` | directions that may separate it from the origin; for how long they do, with the proof about rounding |
//! | `ccd/advance.rs`, `ccd/advance/`, `ccd/number.rs` | the walk through time, in `f64` and in double-double numbers |
//! | `intersect.rs`, `intersect/apart.rs` | the exact test, and the quick one before it |
//! | `bounds.rs`, `convert.rs` | boxes, ours and parry's |
//! | `obstacle.rs`, `obstacle/` | a chapter of its own: `half_space`, `sphere`, `capsule`, `cuboid`, `closed_mesh`, `sampled`, `surface_only`, `shifted`, `animated`; `motion`, `placed`, `rigid_body`; `penalty`; `sweep`; `error` |
//! | `potential.rs`, `potential/` | a chapter of its own: `mollifier`, `pair`, `friction`; `near`, `obstacle_contact`, `near_pairs`, `culled`, `patches`, `culled_substeps`, `filter`; `pair_constraint`, `constraints`, `bodies`, `tangent`, `rebound`; `surfaces`, `free`, `stops`; `last_resort`, `zones`; `source`, `forces`, `report`, `sewn`, `excluded`, `pinched`, `builder` |
//! | `untangle.rs`, `untangle/` | a chapter of its own: `crossing`, `contour`, `components`, `smooth`; `back`, `during` |
//! | `broad_phase.rs`, `broad_phase/hierarchy.rs` | what a broad phase is; the tree of boxes |
//! | `broad_phase/cells.rs`, `spatial_hash.rs`, `morton_grid.rs` | a grid of cells, and two ways to sort boxes into it |
//! | `broad_phase/candidates.rs`, `order.rs` | from pairs of triangles to pairs of primitives that no plane separates, in order |
//! | `broad_phase/triangle_pairs.rs` | pairs of triangles with overlapping boxes |
//! | `separation.rs`, `separation/` | the measurement: of a cloth, and of cloth in `bodies` and from a `surface` |
//! | `incidence.rs` | which triangle represents which vertex and edge |
//! | `error.rs` | what can be wrong with positions and settings |
//!
//! # References
//!
//! - C. Ericson, *Real-Time Collision Detection*, Morgan Kaufmann 2005. DOI 10.1201/b14581. Sections 5.1.5 and 5.1.9.
//! - P. Guigue and O. Devillers, Fast and robust triangle–triangle overlap test using orientation predicates,
//!   *Journal of Graphics Tools* 8(1), 2003. DOI 10.1080/10867651.2003.10487580
//! - J. R. Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates,
//!   *Discrete & Computational Geometry* 18, 1997. DOI 10.1007/PL00009321
//! - B. Mirtich, *Impulse-based dynamic simulation of rigid body systems*, PhD thesis, University of California,
//!   Berkeley 1996: conservative advancement.
//! - M. Li, D. M. Kaufman and C. Jiang, Codimensional incremental potential contact, *ACM Transactions on Graphics*
//!   40(4), 2021. DOI 10.1145/3450626.3459767: additive conservative advancement.
//! - B. Wang, Z. Ferguson, T. Schneider, X. Jiang, M. Attene and D. Panozzo, A large-scale benchmark and an
//!   inclusion-based algorithm for continuous collision detection, *ACM Transactions on Graphics* 40(5), 2021. DOI
//!   10.1145/3460775
//! - X. Provot, Collision and self-collision handling in cloth model dedicated to design garments, *Computer Animation
//!   and Simulation* 1997. DOI 10.1007/978-3-7091-6874-5_13: the coplanarity cubic.
//! - M. Joldes, J.-M. Muller and V. Popescu, Tight and rigorous error bounds for basic building blocks of double-word
//!   arithmetic, *ACM Transactions on Mathematical Software* 44(2), 2017. DOI 10.1145/3121432
//! - S. Curtis, R. Tamstorf and D. Manocha, Fast collision detection for deformable models using
//!   representative-triangles, I3D 2008. DOI 10.1145/1342250.1342260
//! - M. Teschner, B. Heidelberger, M. Müller, D. Pomeranets and M. Gross, Optimized spatial hashing for collision
//!   detection of deformable objects, VMV 2003.
#![forbid(unsafe_code)]

// Two pieces: where they are nearest, when they meet, whether they cross.
mod closest;

mod ccd;

mod intersect;

mod bounds;
mod convert;

// Contact: with bodies, in the solve, undone.
pub mod obstacle;
pub mod potential;
pub mod untangle;

// All pieces of a cloth: candidates, and the measurement.
mod broad_phase;
mod incidence;
mod pair;

mod separation;

mod error;

#[cfg(test)]
#[path = "../tests/support/random.rs"]
mod random;
#[cfg(test)]
#[path = "../tests/support/shapes.rs"]
mod shapes;

pub use cloth_core;

pub use bounds::Bounds;
pub use broad_phase::{
    BroadPhase, BroadPhaseKind, ClothCandidates, Hierarchy, MortonGrid, SpatialHash,
};
pub use ccd::{ContinuousTest, Impact, Query, QueryKind, Stop};
pub use closest::{EdgeEdge, PointTriangle, edge_edge, point_triangle};
pub use error::CollideError;
pub use intersect::{segment_meets_triangle, triangles_meet};
pub use separation::{BodyProbe, Separation, SeparationProbe, distance_from_surface};
