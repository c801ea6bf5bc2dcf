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
//! What it takes from here stands at the root of this crate; [`method`] is for those who write methods.
//!
//! # The idea
//!
//! A cloth is a set of vertices with masses and a sum of small elastic energies, each on a few vertices: a spring on
//! two, a hinge on four. Methods differ in what they do with an energy. One needs its gradient, another its Hessian, a
//! third the constraint behind it, a fourth the nearest undeformed shape. So an element is written once, as a small
//! struct, and shows each method the view it asks for ([`element`]). What an element cannot show does not compile.
//!
//! With state `x`, `v` (m, m/s), lumped masses `M` (kg) and step `Δt` (s), every method advances
//!
//! `M v̇ = −∂E/∂x + f`, `ẋ = v`,
//!
//! and what implicit Euler makes of one step, the minimum of the incremental potential
//! `G(x) = ‖x − x̃‖²_M/(2Δt²) + E(x)` with `x̃ = x + Δt v + Δt² M⁻¹f`, is the reference that all of them are held
//! against ([`measure::IncrementalPotential`]).
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
//! | `E = ½ A G:C:G`, `G = ½(FᵀF − I)` | [`energy::StvkTriangle`] |
//! | `E = ½ A k ‖F − R‖²` | [`energy::ArapTriangle`] |
//! | `E = ½ k (A − A₀)²`, `E = ½ k (V − V₀)²` | [`energy::AreaTriangle`], [`energy::VolumeTetrahedron`] |
//! | `E = ½ k ‖x − p‖²` | [`energy::Attachment`] |
//! | `E = ½ k (‖x₀ − x₁‖ − L(t))²`, L falling to 0 | [`energy::Stitch`] |
//! | `x̃`, `G`, `∇G` | [`measure::predict`], [`measure::IncrementalPotential`] |
//! | `M` | [`particles::Particles`] |
//! | drag and lift of the air | [`air::Air`] |
//! | gas, or a volume, inside a closed mesh | [`enclosure::Pressure`], [`enclosure::ClosedVolume`] |
//! | `E = ½ Σ k C²` from constraint rows | [`element::Constraint`] |
//! | `E = ½ w ‖S x − p‖²` | [`element::Projective`] |
//! | `3V − E = 3χ + E_b` | [`topology::Topology`]; the rank: `dof::EdgeRank` |
//!
//! Each file names the paper that its equations come from.
//!
//! # Limits
//!
//! - Double precision throughout; the scalar is chosen in [`math`] and nowhere else.
//! - Cloth is isotropic: one modulus, one rigidity, no warp and weft. Of shear, only [`cloth::Discretization`] has a
//!   stiffness of its own, for rectangular cells. The stretch and shear conditions of Baraff and Witkin are not among
//!   the elements.
//! - A [`cloth::Cloth`] is cut to springs, whose modulus depends on the pattern of the mesh ([`cloth::Membrane`]), and
//!   to quadratic hinges, which are flat at rest, unless [`cloth::Discretization`] choose other elements of [`energy`].
//!   Hinges have a Poisson's ratio of their own, which the pattern of the mesh decides: −1/3 on equilateral triangles.
//!
//! # Errors
//!
//! What depends on data returns an error that names the vertex, face, line or number: [`MeshError`], [`BuildError`],
//! [`StepError`]. Lists of the wrong length are mistakes of a program and panic.
//!
//! # Features
//!
//! `parallel` (default): sweeps, energies, matrices and multigrid on rayon's threads, with the same bits as without.
//! `cholesky`: the factorisations of [`method::linear`], and `dof`, over faer.
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
