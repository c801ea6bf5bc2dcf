//! The builder of the solver.

use super::XpbdSolver;
use crate::config::XpbdConfig;
use crate::refinement::Refinement;
use crate::update::XpbdUpdate;
use cloth_core::cloth::Elements;
use cloth_core::element::Constraint;
use cloth_core::error::{not_negative, positive};
use cloth_core::method::position_based::{FamilyPlans, Motion, check_counts};
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;

/// Collects particles, elements and settings of a [`XpbdSolver`].
///
/// # Elements
/// Every implementor of [`Constraint`]. The elements of `cloth_core::energy`, with `A = ½ ‖(x₁ − x₀) × (x₂ − x₀)‖`, V
/// the volume of a tetrahedron, and e_a a unit vector along x, y or z:
///
/// | element | C | k | ∂C/∂xᵢ | where ∂C has no value |
/// |---|---|---|---|---|
/// | `Spring` | `l − L`, `l = ‖x₀ − x₁‖` | k (N/m) | n and −n, `n = (x₀ − x₁)/l` | l = 0: any n, by the vertex numbers |
/// | `Attachment`, `SoftPin` | three: `x − p` | k (N/m) | e_a | |
/// | [`Joint`](crate::links::Joint) | three: `x₀ − x₁` | k (N/m) | e_a and −e_a | |
/// | closed `Stitch` | three: `z = Σ qᵢ xᵢ` | k (N/m) | qᵢ e_a | |
/// | `CurvatureHinge`, `MidpointHinge` | three: `z = Σ qᵢ xᵢ` | D/(A₀ + A₁), 3D/(A₀ + A₁) (N/m) | qᵢ e_a | |
/// | `CurvedHinge` | `‖z‖ − r` | D/(A₀ + A₁) (N/m) | `qᵢ z/‖z‖` | z = 0: any direction, by the numbers |
/// | `DihedralHinge` | `θ − θ₀` | D e²/(A₀ + A₁) (J) | below | a triangle without area: C = ∂C = 0; near that ∂C grows as 1/height |
/// | `StvkTriangle` | three strains, below | below (J) | below | |
/// | `ArapTriangle` | two: `σ − 1` | A₀ Y (J) | `u (v·bᵢ)` | σ = 0: any u at right angles to the other |
/// | `ArapTetrahedron` | three: `σ − 1` | 2 μ V₀ (J) | `u (v·bᵢ)` | the same |
/// | `AreaTriangle` | `A − A₀` | K/A₀ (N/m³) | `½ n × oᵢ`, below | A = 0: any n across the line |
/// | `VolumeTetrahedron` | `V − V₀` | K/V₀ (N/m⁵) | `(x₂ − x₀) × (x₃ − x₀)/6` for x₁, likewise for x₂ and x₃ with 1, 2, 3 turned; minus their sum for x₀ | |
/// | `StrainLimitSpring`, `StrainLimitTriangle` | `l`, `σ` minus the nearest allowed | k (N/m), A₀ Y (J) | as without limits; inside 0 | |
///
/// **k.** A bare k is what the element is given; the others follow from the material: Y the modulus of the membrane and
/// D the bending rigidity (N m); μ the shear modulus of a solid (Pa); K the modulus of area (N/m) or volume (Pa). A₀
/// and A₁ are the areas of the triangles, V₀ the volume, and e the length of the edge, all at rest. The unit of k is J
/// over that of C squared.
///
/// **No 0/0.** No element divides by C, or by anything that vanishes at rest: C = 0 is a point like any other. The
/// lengths that do vanish, in a *present* shape, are those of the last column. Where a direction is missing one is
/// chosen that is a limit of nearby ones, so that what has collapsed opens again. A row whose gradients are all zero
/// has w̃ = 0 and moves nothing: a triangle shrunk to a point, a dihedral hinge with a triangle without area. Nor does
/// one between prescribed vertices; if it is soft, its λ becomes −C/α̃, h² times the force on them. Degenerate shapes
/// *at rest* are [below](#rest-shapes).
///
/// **k of a spring from Y** (N/m), on the alternating grid of squares of side a. In a sheet under the plane strain ε a
/// spring of length L along the unit vector n is strained by nᵀεn, and stores `½ k L² (nᵀεn)²`. To a square belong one
/// spring of length a along each axis and, in the mean, half a diagonal of length √2 a in each of the two directions.
/// So `k L²` is k a² in each of four directions 45° apart, and over these the mean of `(nᵀεn)²` is that over all
/// directions, `((tr ε)² + 2 ε:ε)/8`. The energy per area is `½ · 4k` times that, `¼ k ((tr ε)² + 2 ε:ε)`. Plane stress
/// has `½ Y/(1 − ν²) ((1 − ν) ε:ε + ν (tr ε)²)`, which is the same for ν = 1/3 and Y = 4k/3. So k = ¾ Y, half of it on
/// the boundary, where a spring belongs to one square and not two, and the shear modulus is `Y/(2 (1 + ν))` = ⅜ Y.
/// [`Membrane::Modulus`](cloth_core::cloth::Membrane::Modulus) has k for every mesh.
///
/// **Area.** oᵢ is the edge opposite to vertex i, run through in the order x₀, x₁, x₂: `o₀ = x₂ − x₁`, `o₁ = x₀ − x₂`,
/// `o₂ = x₁ − x₀`, which sum to zero. `n = (x₁ − x₀) × (x₂ − x₀)/(2A)` is the unit normal. So `n × oᵢ` is at right
/// angles to that edge and points from it to vertex i: A grows where the vertex moves away from the edge.
///
/// **St. Venant–Kirchhoff.** `F = Σ xᵢ bᵢᵀ` (3 × 2) maps rest to present, with constant bᵢ (1/m) that sum to zero: in a
/// rest frame with `x₁ − x₀ = (a, 0)` and `x₂ − x₀ = (c, d)`, `b₁ = (1/a, −c/(a d))` and `b₂ = (0, 1/d)`. With f and g
/// the columns of F, the Green strain in the eigenbasis of the plane-stress matrix is
///
/// ```text
/// C₁ = (f·f + g·g − 2)/(2√2)    ∂C₁/∂xᵢ = (bᵢ₁ f + bᵢ₂ g)/√2    k = A₀ Y/(1 − ν)
/// C₂ = (f·f − g·g)/(2√2)        ∂C₂/∂xᵢ = (bᵢ₁ f − bᵢ₂ g)/√2    k = A₀ Y/(1 + ν)
/// C₃ = f·g/√2                   ∂C₃/∂xᵢ = (bᵢ₁ g + bᵢ₂ f)/√2    k = A₀ Y/(1 + ν)
/// ```
///
/// polynomials, with a gradient at rest and under compression, where C₁ < 0. (The one row `C = √(2E)` has `∂C = ∂E/C`,
/// which is 0/0 at rest.) The gradients shrink with f and g: pressed below 1/√3 of its length a triangle resists less
/// and less. σ, u and v above are singular values and vectors of F. There is no neo-Hookean triangle.
///
/// **Another quadratic energy**, `E = ½ Cᵀ K C` with a constant symmetric matrix K (the inverse of the compliance
/// matrix α of Macklin et al. 2016, section 4), is rows too. With `K = S diag(k) Sᵀ`, S orthogonal, they are SᵀC, with
/// Sᵀ ∂C and the eigenvalues k. The rows of one element are solved together, so this rotation changes no update:
/// `J M⁻¹ Jᵀ + α̃` turns with it. The strains above are (G₁₁, G₂₂, √2 G₁₂) of the Green strain G, turned like that. An
/// orthotropic sheet, with 1 and 2 along warp and weft, has there `K = A₀ [c₁₁, c₁₂, 0; c₁₂, c₂₂, 0; 0, 0, 2 μ]`, μ the
/// shear modulus (N/m): the third row stays, and two eigenvectors of a 2 × 2 matrix make the others. No element here
/// does that.
///
/// **Quadratic hinge.** With θ₀ and θ₁ the rest angles of the first triangle at x₀ and x₁, θ₂ and θ₃ those of the
/// second, `q = (cot θ₁ + cot θ₃, cot θ₀ + cot θ₂, −cot θ₀ − cot θ₁, −cot θ₂ − cot θ₃)`: constants, so no present shape
/// is special. Only a rest triangle without area has no cotangents.
///
/// **k of a hinge from D**, on equilateral triangles of side a and area A = √3 a²/4, where cot 60° = 1/√3 makes
/// `q = (2, 2, −2, −2)/√3`. On a surface of curvatures κ∥ along the edge and κ⊥ across, the ends of the edge are
/// `κ∥ a²/8` from the tangent plane at its middle, and the tips, √3 a/2 away, `3 κ⊥ a²/8`. So
/// `‖z‖ = |κ∥ − 3κ⊥| a²/(2√3)`. A cylinder of curvature κ, curved in a direction at the angle φ to the edge, has
/// κ∥ = κ cos² φ and κ⊥ = κ sin² φ. Then `(κ∥ − 3κ⊥)² = κ² (2 cos 2φ − 1)²`, in the mean over three edges 60° apart
/// 3κ² for every φ, and ‖z‖² is κ² a⁴/4 = 4κ²A²/3. A hinge of `k = D/(2A)` stores `½ k ‖z‖² = D κ² A/3`; its share of
/// the sheet is 2A/3, as two triangles have three edges in the mean: ½ D κ² per area. [Other
/// meshes](cloth_core::energy#what-a-bending-rigidity-means-on-a-mesh) store more or less. The dihedral angle has the
/// same energy near flat: a tip at the distance d from its edge, of length e, has `|q| = e/d`, and rises by d θ where
/// its triangle turns by θ. So `‖z‖ = e θ`, and `D/(A₀ + A₁) ‖z‖²` is `D e²/(A₀ + A₁) θ²`.
///
/// **Dihedral hinge** (with [`HingeLaw::Angle`](cloth_core::energy::HingeLaw)). With `e = x₁ − x₀`,
/// `n₂ = e × (x₂ − x₀)`, `n₃ = (x₃ − x₀) × e` and `tᵢ = (xᵢ − x₀)·e/‖e‖²`,
///
/// ```text
/// θ = atan2((n₂ × n₃)·e/‖e‖, n₂·n₃)         ∂θ/∂xᵢ = −‖e‖ nᵢ/‖nᵢ‖²   for the tips, i = 2, 3
/// ∂θ/∂x₁ = −t₂ ∂θ/∂x₂ − t₃ ∂θ/∂x₃            ∂θ/∂x₀ = −(1 − t₂) ∂θ/∂x₂ − (1 − t₃) ∂θ/∂x₃
/// ```
///
/// Why: let the corners 0, 1, 2 of a triangle move by u₀, u₁, u₂ along its normal. The point of the edge nearest to the
/// tip moves by (1 − t₂) u₀ + t₂ u₁, so the tip rises by u₂ − (1 − t₂) u₀ − t₂ u₁ above the edge. Over its height,
/// ‖n₂‖/‖e‖, that is the angle by which the triangle turns, and θ falls by it. (The second derivatives are with
/// [`DihedralHinge`](cloth_core::energy::DihedralHinge).) Flat, θ = 0, is regular. (`arccos(n₂·n₃)` of unit normals, as
/// in Müller et al. 2007, has there the slope `−1/√(1 − (n₂·n₃)²)`, which is infinite.) `θ − θ₀` is wrapped into [−π,
/// π]: where `|θ − θ₀|` passes π, folded up or opposite to the rest angle, C jumps from π to −π and the moment turns
/// round, while ½ k C² stays continuous.
///
/// # Rest shapes
/// The triangles of a [`TriMesh`](cloth_core::mesh::TriMesh) have an area, and elements made on one are sound. Of those
/// made by hand (`new`) the builder checks that their numbers are numbers. With a rest triangle or tetrahedron without
/// area or volume
///
/// - a `CurvatureHinge` has infinite q or NaN, and is refused with
///   [`BuildError::InvalidElement`](cloth_core::step::BuildError::InvalidElement);
/// - a `StvkTriangle` does nothing: its k is A₀ times a modulus, 0;
/// - an `AreaTriangle` and a `VolumeTetrahedron` have k = K/0 = ∞, hard rows that keep it so;
/// - a `DihedralHinge` beside it takes θ₀ = 0.
///
/// A spring of rest length 0 is sound: it draws its ends together.
///
/// # Add an element
/// One struct and two traits of [`cloth_core::element`]: `Element<N>` names the vertices, `Constraint<N>` gives the
/// rows. The solver takes it as it takes ours; damping, forces, colours, threads and the direct solver follow. A soft
/// pin along a line, as an example: `C` is the two coordinates across it.
///
/// ```
/// use cloth_xpbd::cloth_core::check::gradient_error;
/// use cloth_xpbd::cloth_core::element::{Constraint, Element, Row};
/// use cloth_xpbd::{Particles, State, StepInput, Stepper, Vec3, XpbdSolver};
///
/// /// Pulls a vertex to the z axis: `C = (x, y)` (m).
/// #[derive(Clone, Copy, Debug)]
/// struct Rail { vertex: u32, stiffness: f64 }
///
/// impl Element<1> for Rail {
///     fn vertices(&self) -> [u32; 1] {
///         [self.vertex]
///     }
/// }
///
/// impl Constraint<1> for Rail {
///     type Rows = [Row<1>; 2];
///
///     fn rows(&self, [x]: &[Vec3; 1]) -> [Row<1>; 2] {
///         [(x.x, Vec3::x()), (x.y, Vec3::y())]
///             .map(|(value, gradient)| Row { value, gradient: [gradient], stiffness: self.stiffness })
///     }
/// }
///
/// let rail = Rail { vertex: 0, stiffness: 50.0 };
/// // First of all: gradients against finite differences.
/// assert!(gradient_error(&rail, &[Vec3::new(0.3, -0.2, 1.0)], 1.0) < 1e-9);
/// // One constraint alone ends where implicit Euler does: C̃/(1 + k h² w̃).
/// let particles = Particles::new(vec![0.5])?;
/// let mut solver = XpbdSolver::builder(&particles)
///     .energy(vec![rail])
///     .config(cloth_xpbd::XpbdConfig { substeps: 1, ..Default::default() })
///     .build()?;
/// let mut state = State::at_rest(vec![Vec3::new(0.3, 0.0, 0.0)]);
/// solver.step(&mut state, StepInput::new(0.1))?;
/// assert!((state.positions[0].x - 0.3 / (1.0 + 50.0 * 0.1 * 0.1 / 0.5)).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// k must depend neither on x nor on the time of `set_time`: the update takes it as a constant. An element whose one
/// row has a unit gradient, or whose rows are linear coordinates, may say so (`row_form`) and is swept faster; the
/// direct solver asks for `geometric_stiffness`, which has a default.
///
/// **An inequality** is free on one side, as a wall that keeps a vertex at φ = x ≥ 0. There its rows have neither value
/// nor gradient, so no visit could take back the λ of an earlier one. Therefore it shows φ twice.
/// [`dead_zone_rows`](cloth_core::element::Constraint::dead_zone_rows) gives
/// `Some([DeadZoneRow { value, gradient, range, stiffness }])`, with φ and ∂φ not cut off, and in `range` the φ at
/// which nothing acts, here `[0.0, f64::INFINITY]`. `rows` gives the [`row`](cloth_core::element::DeadZoneRow::row) of
/// that, `C = φ − clamp(φ)`. The solver keeps the sign of λ, and does not damp the row.
/// [`StrainLimitSpring`](cloth_core::energy::StrainLimitSpring) is an example.
#[derive(Debug)]
pub struct XpbdBuilder {
    motion: Motion,
    families: FamilyPlans<XpbdUpdate>,
    config: XpbdConfig,
}

impl XpbdBuilder {
    pub(super) fn new(particles: &Particles) -> Self {
        Self {
            motion: Motion::new(particles),
            families: FamilyPlans::default(),
            config: XpbdConfig::default(),
        }
    }

    /// Adds a family of constraints. A sweep visits the families in the order in which they were added.
    #[must_use]
    pub fn energy<const N: usize, E: Constraint<N>>(mut self, elements: Vec<E>) -> Self {
        if E::IS_IN_ELEMENTS {
            return self.elements(vec![E::into_elements(elements)]);
        }
        self.families.add(elements);
        self
    }

    /// Adds all elements of a cloth, as [`ClothModel::families`](cloth_core::ClothModel::families) has them.
    #[must_use]
    pub fn elements(mut self, families: Vec<Elements>) -> Self {
        self.families.add_elements(families);
        self
    }

    /// Replaces the settings.
    #[must_use]
    pub fn config(mut self, config: XpbdConfig) -> Self {
        self.config = config;
        self
    }

    /// The solver.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`]; [`BuildError::UnsupportedElements`] for elements that are no constraints;
    /// [`BuildError::NoSuchVertex`] or [`BuildError::RepeatedVertex`] if an element names a vertex that the particles
    /// do not have, or one twice; [`BuildError::InvalidElement`] for a number of one.
    pub fn build(self) -> Result<XpbdSolver, BuildError> {
        let (motion, config) = (self.motion, self.config);
        check_counts(config.iterations, config.substeps)?;
        not_negative("the damping", config.damping)?;
        if let Some(gain) = config.energy_gain {
            positive("the energy gain", gain)?;
        }
        let vertex_count = motion.vertex_count();
        let families = self
            .families
            .build(vertex_count, config.sweep, config.acceleration)?;
        Ok(XpbdSolver {
            offsets: Vec::new(),
            prescribed_offsets: Vec::new(),
            motion,
            families,
            refinement: config.energy_gain.map(Refinement::new),
            config,
            last: None,
            prepared: None,
        })
    }
}
