//! The cloth, and what it costs to deform it: the common ground of all method crates.
//!
//! # An example
//!
//! ```
//! use cloth_core::{Cloth, Diagonals, Membrane, Vec3, grid, measure};
//!
//! let mesh = grid(9, 9, 1.0, 1.0, Diagonals::Alternating)?;
//! let cotton = Cloth {
//!     areal_density: 0.2,                   // kg/m²
//!     membrane: Membrane::Modulus(1000.0),  // N/m
//!     bending_rigidity: 1e-5,               // N·m
//! };
//! let mut model = cotton.on(&mesh)?;
//! model.particles.prescribe(0)?;            // hold a corner
//! let energies = model.energies()?;
//!
//! // Pulled by one per cent in all directions, the sheet stores Y s²/(1 − ν) per area with ν = 1/3.
//! let stretched: Vec<Vec3> = mesh.positions().iter().map(|p| p * 1.01).collect();
//! let expected = 1000.0 * 0.01_f64.powi(2) / (1.0 - 1.0 / 3.0);
//! assert!((energies.value(&stretched) / expected - 1.0).abs() < 1e-12);
//! # let strain = measure::Strain::of(&model.springs, &stretched);
//! # assert!((strain.rms - 0.01).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A simulation needs this and a method: `use cloth_core::{…}` and `use cloth_xpbd::{XpbdSolver, …}`, or another crate.
//! What it takes from here stands at the root of this crate; [`method`] is for those who write methods. The same
//! energies as plain loops over arrays are in `examples/first_program.rs`.
//!
//! # The idea
//!
//! A cloth is a set of vertices with masses and a sum of small elastic energies, each on a few vertices: a spring on
//! two, a hinge on four. Methods differ in what they do with an energy. One needs its gradient, another its Hessian, a
//! third the constraint behind it, a fourth the nearest undeformed shape. So an element is written once, as a small
//! struct, and each of these *views* of it is a trait that it implements ([`element`]). A method that asks for a view
//! that the element does not have does not compile.
//!
//! With positions `x` (m), velocities `v` (m/s), lumped masses `M` (kg), forces from outside `f` (N: weight, air) and
//! the elastic energy `E(x)` (J), every method advances
//!
//! `M v̇ = f − ∂E/∂x`, `ẋ = v`
//!
//! from `xₙ`, `vₙ` by a step `Δt` (s) to `xₙ₊₁`, `vₙ₊₁`. Implicit Euler takes for `xₙ₊₁` a minimum of the incremental
//! potential (J)
//!
//! `G(x) = ‖x − x̃‖²_M/(2Δt²) + E(x)`, with `x̃ = xₙ + Δt vₙ + Δt² M⁻¹f` and `‖u‖²_M = uᵀM u = Σ mᵢ ‖uᵢ‖²`.
//!
//! There `∂G/∂x` is zero, `M (xₙ₊₁ − xₙ − Δt vₙ)/Δt² = f − ∂E/∂x(xₙ₊₁)`. With `vₙ₊₁ = (xₙ₊₁ − xₙ)/Δt` this is
//! implicit Euler, `M (vₙ₊₁ − vₙ)/Δt = f − ∂E/∂x(xₙ₊₁)`. Such a minimum is the reference that all methods are held
//! against ([`measure::IncrementalPotential`]). Where E is not convex there may be several. The reference is damped: a
//! small oscillation of angular frequency ω (1/s) shrinks by `1/√(1 + ω²Δt²)` in every step, a stiff one most.
//!
//! # Equation → code
//!
//! | equation | code |
//! |---|---|
//! | `E = ½ k (‖x₀ − x₁‖ − L)²` and its derivatives | [`energy::Spring`] |
//! | `E = ½ K ‖q x‖²` | [`energy::CurvatureHinge`] |
//! | `E = ½ K (‖q x‖ − r)²`, curved at rest | [`energy::CurvedHinge`] |
//! | `E = ½ K (θ − θ₀)²`, with `K = D e²/(A₀ + A₁)` | [`energy::DihedralHinge`] |
//! | `E = K (1 − cos(θ − θ₀))` as a cubic polynomial | [`energy::CubicShell`] |
//! | `E = ½ K ‖q m‖²`, m the midpoints of edges | [`energy::MidpointHinge`] |
//! | `E = ½ A G:H:G`, Green strain `G = ½(FᵀF − I)` | [`energy::StvkTriangle`] |
//! | `E = ½ A k ‖F − R‖²`, `E = μ V ‖F − R‖²` | [`energy::ArapTriangle`], [`energy::ArapTetrahedron`] |
//! | `E = ½ k (l − clamp(l))²`, slack in a range of lengths | [`energy::StrainLimitSpring`] |
//! | `E = ½ A k Σ (σ − clamp(σ))²`, slack in a range of stretches | [`energy::StrainLimitTriangle`] |
//! | `μ ‖F − R‖² + ½ λ (J − 1)²` per volume of a solid | [`cloth::Solid`], on a [`mesh::TetMesh`] |
//! | `E = ½ k (A − A₀)²`, `E = ½ k (V − V₀)²` | [`energy::AreaTriangle`], [`energy::VolumeTetrahedron`] |
//! | `E = ½ k ‖x − p‖²`, p fixed or moving | [`energy::Attachment`], [`energy::SoftPin`] |
//! | `E = ½ k (‖Σ qᵢ xᵢ‖ − L(t))²`, L falling to 0 | [`energy::Stitch`] |
//! | `x̃`, `G`, `∇G` | [`measure::predict`], [`measure::IncrementalPotential`] |
//! | `M` | [`particles::Particles`] |
//! | drag and lift of the air | [`air::Air`] |
//! | gas, or a volume, inside a closed mesh | [`enclosure::Pressure`], [`enclosure::ClosedVolume`] |
//! | `E = ½ Σ k C²`, with a *row* for each scalar C | [`element::Constraint`] |
//! | `E = ½ w ‖S x − p‖²` | [`element::Projective`] |
//! | `3V − E = 3χ + E_b` | [`topology::Topology`]; the rank: `dof::EdgeRank` |
//!
//! # Limits
//!
//! - A mesh of stiff edges *locks*: it folds only along lines of edges. `dof` has how much, by mesh and remedy.
//! - No element damps: there is no material damping (Rayleigh) here. What damps is the integrator, as above, and what a
//!   method adds to it: `cloth-massspring` and `cloth-xpbd` have settings for that.
//! - Double precision throughout; the scalar is chosen in [`math`] and nowhere else.
//! - Cloth is isotropic: one modulus, one rigidity, no warp and weft. Of shear, only [`cloth::Discretization`] has a
//!   stiffness of its own, for rectangular cells. The stretch and shear conditions of Baraff and Witkin are not among
//!   the elements.
//! - A [`cloth::Cloth`] is discretized with springs, whose modulus depends on the pattern of the mesh
//!   ([`cloth::Membrane`]), and with quadratic hinges, which are flat at rest, unless [`cloth::Discretization`] chooses
//!   other elements of [`energy`]. Hinges have a Poisson's ratio of their own, which the pattern of the mesh decides:
//!   −1/3 on equilateral triangles.
//!
//! # When not to use it
//!
//! For a solid whose law is another than that of [`cloth::Solid`], for a sheet whose warp and weft differ, and for an
//! element outside of its range:
//!
//! | element | take it for | not where | figure |
//! |---|---|---|---|
//! | [`energy::Spring`] | most cloth: cheapest, every method takes it | ν or the shear modulus matters | ν = 1/3 and ⅜ Y, whatever the cloth |
//! | [`energy::StvkTriangle`] | any ν, any mesh | cloth is pressed hard, or pulled far | below 1/√3 of its length the force falls; at 1.2 times it is 1.32 times `Y (s − 1)` |
//! | [`energy::ArapTriangle`] | triangles for projective dynamics | ν matters, or stiff cloth has to fold | ν = 0; of a fold that a mesh hinders it reaches 0.33, StVK 0.51 ([locking](#limits)) |
//! | [`energy::StrainLimitSpring`], [`energy::StrainLimitTriangle`] | cloth that yields, then holds | a hard limit is wanted | a load f stretches a spring by f/k beyond it |
//! | [`energy::CurvatureHinge`] | cloth that is flat at rest: constant Hessian | the rest shape is curved, or the membrane soft | 10 % of stretch in all directions cost 21 % more energy in the same fold |
//! | [`energy::CurvedHinge`] | a curved rest shape in projective dynamics | a fold must not snap through | θ₀ and −θ₀ are both at rest; at rest `cos²(θ₀/2)` of the stiffness, half at 90° |
//! | [`energy::DihedralHinge`] | a curved rest shape, sharp folds | in projective dynamics; where triangles degenerate | the gradient grows as 1 over the height; by Bridson's law a full fold (θ = π) has 0.64 of the moment |
//! | [`energy::CubicShell`] | a curved rest shape, with a polynomial | in PBD, XPBD, PD; a soft membrane | at rest it pulls outwards: `dE/ds = −3K` at θ₀ = 90° |
//! | [`energy::MidpointHinge`] | stiff cloth without locking | a surface without gaps is wanted | three times as many coordinates, and gaps |
//! | springs across hinges, [`energy::Spring::across`] | comparisons with older methods | a rigidity is given | half the fold costs 1/16 |
//!
//! # Errors
//!
//! What depends on data returns an error that names the vertex, face, line or number: [`MeshError`],
//! [`ParticleError`](particles::ParticleError), [`ClothError`](cloth::ClothError), [`BuildError`], [`StepError`], and
//! those of single modules. Lists of the wrong length are mistakes of a program and panic.
//!
//! Numbers are checked where a mesh, masses, a cloth, air or an [`enclosure`] is made ([`TriMesh::new`],
//! [`Particles::new`], [`Cloth::on`], [`air::Air::new`]). The constructors of elements in [`energy`] take stiffnesses
//! and rest shapes as they are, negative and infinite ones too; only strain limits panic, if they are negative or out
//! of order. The builder of a solver checks its settings, that every vertex exists, and the numbers of elements
//! ([`Element::check`](element::Element::check)).
//!
//! # Features
//!
//! `parallel` (default): sweeps, energies, the assembly of matrices, and multigrid on rayon's threads, with the same
//! bits as without; a multigrid cycle with contacts between vertices smooths on one thread. `cholesky`: the
//! factorisations of [`method::linear`], and `dof`, over faer.
//!
//! # The files, in reading order

pub mod error;
pub mod math;
pub mod random;

pub mod mesh;
pub mod topology;

pub mod particles;
pub mod pin;

pub mod element;
pub mod energy;

pub mod cloth;

#[cfg(feature = "cholesky")]
pub mod dof;

pub mod contact;
pub mod step;

pub mod air;
pub mod enclosure;

pub mod measure;

pub mod check;

pub mod method;

pub use cloth::{Cloth, ClothModel, Membrane};
pub use contact::ContactSource;
pub use math::{Real, Vec3};
pub use mesh::generate::{Diagonals, grid};
pub use mesh::{MeshError, TriMesh};
pub use particles::{Particles, State};
pub use pin::Pins;
pub use step::{BuildError, StepError, StepInput, StepReport, Stepper};
