//! The cone: a quarter of a ring bent to half a cone, its straight sides clamped where the cone has them.
//!
//! The ring has its centre in a corner of the unit square and radii 0.3 m and 1 m; the cone has the half angle β = 30°,
//! so a quarter turn of the flat ring (r, φ) becomes half a turn `ψ = φ/sin β` at the distance r from the tip. No
//! length changes, the curvature is `1/(r tan β)`, and the bending energy is `½ D cot²β (π/2) ln(1/0.3)`. A circular
//! cone is in equilibrium between such clamps, so this is what an inextensible sheet would cost. Its curvature changes
//! from place to place, and no lattice has straight lines along all its generators: a mesh with rigid edges cannot
//! follow it.

use super::sheet::{Kind, Sheet, square};
use crate::studies::prelude::*;
use cloth_core::mesh::generate::without_triangles;

const INNER: Real = 0.3;
const SIN: Real = 0.5;

/// What a sheet on the cone stores at rest.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct OnCone {
    /// Energy of membrane and hinges over that of the hinges alone with every point on the cone (dimensionless): 1 for
    /// a sheet that follows it.
    #[serde(rename = "energy over developable")]
    pub(super) energy: Real,
    /// The membrane's part of it.
    #[serde(rename = "membrane over developable")]
    pub(super) membrane: Real,
    /// The membrane's part as long as every point lies on the cone, before anything has settled.
    #[serde(rename = "the same, vertices on the cone")]
    pub(super) placed: Real,
    iterations: u32,
    last_move: Real,
}

fn place(p: &Vec3) -> Vec3 {
    let r = p.norm();
    let turn = p.y.atan2(p.x) / SIN;
    let cos = (1.0 - SIN * SIN).sqrt();
    Vec3::new(r * SIN * turn.cos(), r * SIN * turn.sin(), -r * cos)
}

/// The radius (m) that stands for the whole ring in the estimate: membranes cost as κ⁴ and hinges as κ², so
/// `R² = ∫κ²/∫κ⁴`.
pub(super) fn radius() -> Real {
    let tan_squared = SIN * SIN / (1.0 - SIN * SIN);
    let squares = (1.0 / INNER).ln(); // ∫ r⁻² r dr
    let fourths = 0.5 * (1.0 / (INNER * INNER) - 1.0);
    (tan_squared * squares / fourths).sqrt()
}

/// Bends a sheet of `cells` cells a metre to the cone; `modulus` (N/m), `rigidity` (N·m). Gives
/// [`Sheet::edge_length`] (m) too.
pub(super) fn bend(
    pattern: &str,
    cells: usize,
    kind: Kind,
    modulus: Real,
    rigidity: Real,
) -> Result<(Real, OnCone), BenchError> {
    let ring = without_triangles(&square(pattern, cells)?, |_, [a, b, c]| {
        !(INNER..=1.0).contains(&((a + b + c) / 3.0).norm())
    })?;
    let mut sheet = Sheet::new(ring, kind, modulus, rigidity)?;
    // Two rows of vertices, place and direction of the side.
    let clamp = 1.3 / cells as Real;
    sheet.hold(|p| p.x < clamp || p.y < clamp)?;
    let exact = sheet.placed(place);
    let bending = sheet.bending_energy(&exact)?;
    let placed = sheet.membrane_energy(&exact)? / bending;
    let rest = sheet.rest(exact, Vec3::zeros())?;
    let membrane = sheet.membrane_energy(&rest.points)? / bending;
    let on_cone = OnCone {
        energy: membrane + sheet.bending_energy(&rest.points)? / bending,
        membrane,
        placed,
        iterations: rest.iterations,
        last_move: rest.last_move,
    };
    Ok((sheet.edge_length()?, on_cone))
}
