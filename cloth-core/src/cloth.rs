//! One description of a cloth in SI units, from which every method gets its constants.
//!
//! A [`Cloth`] says what the cloth is: mass, modulus, rigidity. [`Discretization`] says which elements stand for it. A
//! [`ClothModel`] is the cloth discretized on a mesh, a list of families of [`Elements`] for the builder of any solver:
//!
//! ```
//! use cloth_core::cloth::{BendingElements, Discretization, Cloth, Membrane, MembraneElements};
//! use cloth_core::mesh::generate::{Diagonals, grid};
//!
//! let mesh = grid(9, 9, 1.0, 1.0, Diagonals::Alternating)?;
//! let cotton = Cloth {
//!     areal_density: 0.2,                   // kg/m²
//!     membrane: Membrane::Modulus(1000.0),  // N/m
//!     bending_rigidity: 1e-5,               // N·m
//! };
//! let springs = cotton.on(&mesh)?;
//! let triangles = cotton.discretized_with(
//!     &Discretization {
//!         membrane: MembraneElements::Stvk { poisson_ratio: 1.0 / 3.0 },
//!         bending: BendingElements::Dihedral,
//!         ..Discretization::default()
//!     },
//!     &mesh,
//! )?;
//! // The same cloth: stretched by a thousandth, both store the same energy up to the order of the strain.
//! let stretched: Vec<_> = mesh.positions().iter().map(|p| p * 1.001).collect();
//! let [a, b] = [springs.energies()?.value(&stretched), triangles.energies()?.value(&stretched)];
//! assert!((a / b - 1.0).abs() < 2e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`Solid`] does the same for tetrahedra, on the vertices of the same mesh: [`ClothModel::of_pieces`].
//!
//! # Where the numbers come from
//!
//! A solid sheet of thickness t and Young's modulus E has `Y = E t` (N/m) and `D = E t³/(12 (1 − ν²))` (N·m); woven
//! cloth bends far more easily than that, as its threads slide, so all three numbers are measured:
//!
//! - ρ: the mass of a piece over its area.
//! - Y: a strip is pulled along its length. Force per width over strain, taken as the slope between two small loads,
//!   5 and 100 N/m for instance: cloth is soft until its threads are straight, and stiffens.
//! - D: a strip is pushed over the edge of a table until the line from the edge to its end falls by 41.5°. Half of the
//!   length that hangs over is the bending length c (m), and `D = ρ g c³` (Peirce 1930), g gravity (m/s²).
//!
//! Strips are cut along the warp and along the weft. A [`Cloth`] is isotropic and takes the mean of both; that
//! woven cloth shears far more easily than an isotropic sheet it does not know. Orders of magnitude:
//!
//! | fabric | ρ (kg/m²) | Y (N/m) | D (N·m) |
//! |---|---|---|---|
//! | light silk | 0.06 | 10³ to 10⁴ | 10⁻⁶ |
//! | shirting, wool suiting | 0.1 to 0.2 | 10³ to 10⁴ | 5·10⁻⁶ to 10⁻⁵ |
//! | denim | 0.4 | 10⁴ | 5·10⁻⁵ |
//!
//! F. T. Peirce, "The 'handle' of cloth as a measurable quantity", J. Textile Institute 21, 1930, T377–T416,
//! <https://doi.org/10.1080/19447023008661529>.

mod coarse_membrane;
mod directions;
mod discretization;
mod elements;
mod locking_remedies;
mod midpoints;
mod pieces;
mod solid;

pub use coarse_membrane::CoarseMembrane;
pub use directions::DirectionalModulus;
pub use discretization::{BendingElements, Discretization, MembraneElements};
pub use elements::{ConstraintVisitor, Elements, EnergyVisitor, ProjectiveVisitor};
pub use locking_remedies::{SpringEdges, SpringLaw};
pub use midpoints::MidpointCloth;
pub use pieces::Piece;
pub use solid::{Solid, SolidPiece};

use crate::energy::{CurvatureHinge, Seam, SoftPin, Spring, Stitch};
use crate::error::{OutOfRange, not_negative};
use crate::math::Real;
use crate::mesh::{MeshError, TriMesh};
use crate::method::family::Energies;
use crate::particles::{ParticleError, Particles};
use crate::step::BuildError;
use crate::topology::EdgeTable;
use std::fmt;

/// How the cloth resists being stretched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Membrane {
    /// The same spring stiffness k (N/m) on every edge. What modulus that makes depends on the pattern of the mesh, and
    /// a little on its size: the boundary, which stands for half a cell, has the whole k too. On the alternating grid
    /// of modulus `4k/3` the two boundaries along the pull, n cells apart, add k/n, which is 3/(4n) of it. As many
    /// cells apart, the two boundaries across the pull resist the narrowing, and where the strain is uniform they add
    /// k/(9n): 5/(6n) in all. [`Membrane::Modulus`] has no such part.
    SpringStiffness(Real),
    /// Membrane modulus Y (N/m): Young's modulus times thickness.
    ///
    /// Every edge gets `k = 3 Y A/Σ n L²`, with A the area of the mesh and n half the number of triangles at an edge (1
    /// inside, ½ on the boundary); boundary edges get half of it. Then the springs, averaged over all directions, make
    /// an isotropic sheet of modulus Y and Poisson's ratio 1/3. For equilateral triangles (`Y = 2k/√3`) and the
    /// alternating grid (`Y = 4k/3`) it is exact in every direction.
    ///
    /// Where cells are longer one way than the other it is right in the mean only: with cells four times as high as
    /// wide the sheet is 2.7 times as stiff along them, and a tenth as stiff across. [`Piece::directional_moduli`]
    /// tells. No choice of springs, one for every edge, is isotropic there: beyond a ratio of √3 the diagonals alone
    /// are too stiff along the cells. And it holds for vertices that move as the mean strain says. On an irregular mesh
    /// they give way: [`irregular`](crate::mesh::generate::irregular) meshes of any size are softer by a quarter (0.72
    /// to 0.74 of Y evenly stretched, 0.76 pulled one way). Triangles ([`MembraneElements::Stvk`],
    /// [`MembraneElements::Arap`]) are right on every mesh.
    Modulus(Real),
}

/// A cloth, stated once: the same numbers mean the same cloth in every method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cloth {
    /// Mass per area (kg/m²).
    pub areal_density: Real,
    /// Resistance to stretching.
    pub membrane: Membrane,
    /// Bending rigidity D (N·m). With 0 nothing is built for bending.
    pub bending_rigidity: Real,
}

/// A cloth discretized on a mesh: masses and elements, ready for any solver.
#[derive(Clone, Debug, PartialEq)]
pub struct ClothModel {
    /// Masses; pin vertices here before building a solver.
    pub particles: Particles,
    /// Structural springs, one per edge; none if other elements resist stretching.
    pub springs: Vec<Spring>,
    /// Quadratic hinges, one per inner edge; none if the rigidity is 0 or other elements resist bending.
    pub hinges: Vec<CurvatureHinge>,
    /// Elements of every other kind, and springs that are not structural.
    pub others: Vec<Elements>,
}

impl Cloth {
    /// Masses and elements of this cloth on a mesh at rest: springs on the edges and quadratic hinges.
    ///
    /// # Errors
    /// [`ClothError`] if a number is out of range or an edge of the mesh is not manifold.
    pub fn on(&self, mesh: &TriMesh) -> Result<ClothModel, ClothError> {
        self.discretized_with(&Discretization::default(), mesh)
    }

    /// The same with a choice of elements.
    ///
    /// # Errors
    /// [`ClothError`] if a number is out of range, an edge of the mesh is not manifold, or the choice does not fit the
    /// cloth or the mesh.
    pub fn discretized_with(
        &self,
        discretization: &Discretization,
        mesh: &TriMesh,
    ) -> Result<ClothModel, ClothError> {
        let particles = Particles::from_areal_density(mesh, self.areal_density)?;
        let edges = EdgeTable::build(mesh)?;
        let elements = discretization.elements(self, mesh, &edges)?;
        Ok(ClothModel {
            particles,
            springs: elements.springs,
            hinges: elements.hinges,
            others: elements.others,
        })
    }
}

impl Membrane {
    fn check(self) -> Result<(), ClothError> {
        let (name, value) = match self {
            Self::SpringStiffness(k) => ("spring stiffness (N/m)", k),
            Self::Modulus(y) => ("membrane modulus (N/m)", y),
        };
        not_negative(name, value)?;
        Ok(())
    }

    /// One spring per edge.
    fn springs(self, mesh: &TriMesh, edges: &EdgeTable) -> Vec<Spring> {
        let (Self::SpringStiffness(value) | Self::Modulus(value)) = self;
        let mut springs = Spring::along(mesh.positions(), edges.ends(), value);
        if let Self::Modulus(modulus) = self {
            let stiffness = modulus / modulus_per_stiffness(mesh, edges);
            for (edge, spring) in springs.iter_mut().enumerate() {
                spring.stiffness = edge_weight(edges, edge) * stiffness;
            }
        }
        springs
    }

    /// Y (N/m); of springs, that of their mean over all directions.
    fn modulus(self, mesh: &TriMesh, edges: &EdgeTable) -> Real {
        match self {
            Self::SpringStiffness(k) => k * modulus_per_stiffness(mesh, edges),
            Self::Modulus(y) => y,
        }
    }
}

/// `Σ n L²/(3A)`, Y/k of equal springs in the mean over all directions.
fn modulus_per_stiffness(mesh: &TriMesh, edges: &EdgeTable) -> Real {
    let x = mesh.positions();
    let square = |(edge, &[a, b]): (usize, &[u32; 2])| {
        edge_weight(edges, edge) * (x[a as usize] - x[b as usize]).norm_squared()
    };
    let squares: Real = edges.ends().iter().enumerate().map(square).sum();
    squares / (3.0 * mesh.area())
}

/// Half the number of triangles at an edge.
fn edge_weight(edges: &EdgeTable, edge: usize) -> Real {
    if edges.is_boundary(edge) { 0.5 } else { 1.0 }
}

impl ClothModel {
    /// All elements, family by family; families without elements are left out.
    #[must_use]
    pub fn families(&self) -> Vec<Elements> {
        let own = [
            Elements::Springs(self.springs.clone()),
            Elements::Quadratic(self.hinges.clone()),
        ];
        own.into_iter()
            .chain(self.others.iter().cloned())
            .filter(|family| !family.is_empty())
            .collect()
    }

    /// Adds *fastenings*, elements that hold the cloth to something and do not come from its mesh: [`Elements::Links`],
    /// [`Elements::SlackLinks`], [`Elements::SoftPins`] and stitches; empty families are dropped. Whether their vertices
    /// exist is checked where the energies or a solver are built. Elements of another kind are added too, but are none
    /// of the [`ClothModel::fastenings`].
    pub fn fasten(&mut self, fastenings: impl IntoIterator<Item = Elements>) {
        for fastening in fastenings {
            if !fastening.is_empty() {
                Elements::merge(&mut self.others, fastening);
            }
        }
    }

    /// The elements that do not come from the mesh.
    pub fn fastenings(&self) -> impl Iterator<Item = &Elements> + '_ {
        self.others.iter().filter(|family| {
            matches!(
                family,
                Elements::Links(_)
                    | Elements::SlackLinks(_)
                    | Elements::SoftPins(_)
                    | Elements::Stitches(_)
                    | Elements::EdgeStitches(_)
            )
        })
    }

    /// Sews the cloth, besides what is sewn already.
    pub fn sew(&mut self, seam: Seam) {
        self.fasten([
            Elements::Stitches(seam.pairs),
            Elements::EdgeStitches(seam.onto_edges),
        ]);
    }

    /// All springs, those of links and of bending among them.
    pub fn all_springs(&self) -> impl Iterator<Item = &Spring> + '_ {
        let others = self.others.iter().flat_map(|family| match family {
            Elements::Springs(springs) | Elements::Links(springs) => &springs[..],
            _ => &[],
        });
        self.springs.iter().chain(others)
    }

    /// The stitches of all seams from vertex to vertex.
    pub fn stitches(&self) -> impl Iterator<Item = &Stitch> + '_ {
        self.others.iter().flat_map(|family| match family {
            Elements::Stitches(stitches) => &stitches[..],
            _ => &[],
        })
    }

    /// The stitches of all seams from a vertex to a point of an edge.
    pub fn edge_stitches(&self) -> impl Iterator<Item = &Stitch<3>> + '_ {
        self.others.iter().flat_map(|family| match family {
            Elements::EdgeStitches(stitches) => &stitches[..],
            _ => &[],
        })
    }

    /// The soft pins.
    pub fn soft_pins(&self) -> impl Iterator<Item = &SoftPin> + '_ {
        self.others.iter().flat_map(|family| match family {
            Elements::SoftPins(pins) => &pins[..],
            _ => &[],
        })
    }

    /// All seams as one.
    #[must_use]
    pub fn seam(&self) -> Seam {
        Seam {
            pairs: self.stitches().copied().collect(),
            onto_edges: self.edge_stitches().copied().collect(),
        }
    }

    /// The elastic energy, of stitches at the time that they have been set to.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`] or [`BuildError::RepeatedVertex`] if an element was changed to name a vertex that
    /// does not exist, or one twice; [`BuildError::InvalidElement`] for a number of one.
    pub fn energies(&self) -> Result<Energies, BuildError> {
        Energies::new(self.particles.len()).with_elements(self.families())
    }
}

/// The range of a fraction.
const FRACTION: &str = "at least 0 and at most 1";

/// Why a cloth could not be discretized on a mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ClothError {
    /// The mesh does not serve.
    Mesh(MeshError),
    /// The density does not serve.
    Particles(ParticleError),
    /// A number of the description is negative or not finite.
    OutOfRange(OutOfRange),
    /// Poisson's ratio (dimensionless) is not above −1 and below 1.
    PoissonRatio(Real),
    /// Shear springs were asked for beside a membrane that is not made of springs of a given stiffness.
    ShearWithoutStiffness,
    /// Shear springs were asked for on a mesh where no two triangles form a rectangle.
    NoRectangles,
    /// Another law of springs, or springs on some edges only, were asked for where the membrane is not made of springs
    /// on edges alone.
    LockingRemedyWithoutSprings,
    /// A [`CoarseMembrane`] was asked for where the membrane is not made of linear springs on all edges alone.
    CoarseMembraneWithoutSprings,
    /// The mesh has no such coarse level.
    NoSuchLevel {
        /// The one asked for, from 1.
        level: u32,
        /// How many there are, as far as they were asked for.
        most: u32,
    },
    /// The range of lengths without resistance does not hold 1 (dimensionless).
    SlackRange([Real; 2]),
    /// A piece names a triangle that the mesh does not have.
    NoSuchTriangle(u32),
    /// Two pieces name the same triangle.
    InTwoPieces(u32),
    /// A [`CoarseMembrane`] was asked for a piece that is not the whole mesh.
    CoarseMembraneOfPiece,
    /// Edges cannot be left out as asked for.
    DofFraction {
        /// The fraction of all coordinates that was to be free.
        fraction: Real,
        /// The largest there can be.
        most: Real,
    },
}

impl fmt::Display for ClothError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(error) => error.fmt(f),
            Self::Particles(error) => error.fmt(f),
            Self::OutOfRange(error) => write!(f, "the {error}"),
            Self::PoissonRatio(value) => write!(
                f,
                "Poisson's ratio is {value}, but it has to be above -1 and below 1"
            ),
            Self::ShearWithoutStiffness => f.write_str(
                "shear springs stand beside springs of a given stiffness, not beside triangles or springs made from a \
                 modulus",
            ),
            Self::NoRectangles => f.write_str(
                "no two triangles of the mesh form a rectangle that shear springs could cross",
            ),
            Self::LockingRemedyWithoutSprings => f.write_str(
                "slack, weaker springs under compression and springs on some edges only are for a membrane of springs \
                 on edges, not beside shear springs, and of triangles ARAP ones alone have slack",
            ),
            Self::CoarseMembraneWithoutSprings => f.write_str(
                "a coarse level of links is for a membrane of linear springs on all edges, not one of triangles, and \
                 not beside shear springs or another remedy against locking",
            ),
            Self::NoSuchLevel { level, most } => write!(
                f,
                "coarse level {level} is asked for, but the mesh has levels from 1 to {most}"
            ),
            Self::SlackRange([shortest, longest]) => write!(
                f,
                "springs are slack from {shortest} to {longest} of their length, but the range has to hold 1 and begin \
                 at 0 or above"
            ),
            Self::NoSuchTriangle(triangle) => {
                write!(f, "a piece has triangle {triangle}, which the mesh does not have")
            }
            Self::InTwoPieces(triangle) => {
                write!(f, "triangle {triangle} is named twice, but it can be in one piece only")
            }
            Self::CoarseMembraneOfPiece => f.write_str(
                "a coarse level of links is for a whole mesh, not for one piece of several",
            ),
            Self::DofFraction { fraction, most } => write!(
                f,
                "a fraction of {fraction} of the coordinates is to be free, but it has to lie between 0 and {most}: \
                 every triangle keeps two edges"
            ),
        }
    }
}

impl std::error::Error for ClothError {}

impl From<OutOfRange> for ClothError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl From<MeshError> for ClothError {
    fn from(error: MeshError) -> Self {
        Self::Mesh(error)
    }
}

impl From<ParticleError> for ClothError {
    fn from(error: ParticleError) -> Self {
        Self::Particles(error)
    }
}
