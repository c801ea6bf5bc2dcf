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
/// | element | C | ∂C/∂xᵢ | where ∂C has no value |
/// |---|---|---|---|
/// | `Spring` | `l − L`, `l = ‖x₀ − x₁‖` | n and −n, `n = (x₀ − x₁)/l` | l = 0: any n, by the vertex numbers |
/// | `Attachment`, `SoftPin` | three: `x − p` | e_a | |
/// | [`Joint`](crate::links::Joint) | three: `x₀ − x₁` | e_a and −e_a | |
/// | closed `Stitch` | three: `z = Σ qᵢ xᵢ` | qᵢ e_a | |
/// | `CurvatureHinge`, `MidpointHinge` | three: `z = Σ qᵢ xᵢ` | qᵢ e_a | |
/// | `CurvedHinge` | `‖z‖ − r` | `qᵢ z/‖z‖` | z = 0: any direction, by the numbers |
/// | `DihedralHinge` | `θ − θ₀` | below | a wing without area: C and ∂C are zero |
/// | `StvkTriangle` | three strains, below | below | |
/// | `ArapTriangle` | two: `σ − 1` | `u (v·bᵢ)` | σ = 0: any u at right angles to the other |
/// | `ArapTetrahedron` | three: `σ − 1` | `u (v·bᵢ)` | the same |
/// | `AreaTriangle` | `A − A₀` | `½ n × oᵢ`, below | A = 0: any n across the line |
/// | `VolumeTetrahedron` | `V − V₀` | `(x₂ − x₀) × (x₃ − x₀)/6` for x₁, likewise for x₂ and x₃ with 1, 2, 3 turned; minus their sum for x₀ | |
/// | `StrainLimitSpring`, `StrainLimitTriangle` | `l`, `σ` minus the nearest allowed | as without limits; inside 0 | |
///
/// **No 0/0.** No element divides by C, or by anything that vanishes at rest: C = 0 is a point like any other. The
/// lengths that do vanish are those of the last column. Where a direction is missing one is chosen that is a limit of
/// nearby ones, so that what has collapsed opens again. A row whose gradients are all zero has w̃ = 0 and moves
/// nothing: a triangle shrunk to a point, a hinge without a wing. Nor does one between prescribed vertices; if it is
/// soft, its λ becomes −C/α̃, h² times the force on them.
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
/// **Quadratic hinge.** With θ₀ and θ₁ the rest angles of the first triangle at x₀ and x₁, θ₂ and θ₃ those of the
/// second, `q = (cot θ₁ + cot θ₃, cot θ₀ + cot θ₂, −cot θ₀ − cot θ₁, −cot θ₂ − cot θ₃)`: constant, so nothing vanishes.
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
/// π].
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
    /// do not have, or one twice.
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
