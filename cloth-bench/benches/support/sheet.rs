//! The sheet of the benches, and the rule by which its constraints are swept.

use cloth_bench::scene::{self, Scene};
use cloth_bench::settings::Settings;
use cloth_core::element::{Constraint, RowArray};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::position_based::{
    Acceleration, ConstraintUpdate, Families, RowEquation, RowState, Sweep,
};

/// The hanging sheet of `side` × `side` vertices.
///
/// # Panics
/// For sides that the scene refuses.
#[must_use]
pub fn sheet(side: u32) -> Scene {
    scene::build("hang", None, &Settings::default().with("n", side)).expect("a scene")
}

/// A sheet that is not at rest, so that no correction is zero.
#[must_use]
pub fn shaken(rest: &[Vec3]) -> Vec<Vec3> {
    let noise = |i: usize| Vec3::from_fn(|axis, _| (1e3 * (i + 7 * axis) as Real).sin());
    let size = 0.1 / (rest.len() as Real).sqrt();
    let shaken = rest.iter().enumerate();
    shaken.map(|(i, x)| x + noise(i) * size).collect()
}

/// XPBD's rule, with substeps of 1 ms.
#[derive(Clone, Copy, Debug)]
pub struct Compliant;

/// λ and α̃.
#[derive(Clone, Copy, Debug, Default)]
pub struct Multiplier {
    total: Real,
    scaled_compliance: Real,
}

impl ConstraintUpdate for Compliant {
    type Memory = Multiplier;
    const ROWS_TOGETHER: bool = true;

    fn prepare(&self, row: RowState, memory: &mut Multiplier) {
        memory.scaled_compliance = 1e6 / row.stiffness;
    }

    #[inline(always)]
    fn equation(&self, row: RowState, memory: &mut Multiplier) -> RowEquation {
        RowEquation {
            residual: row.value + memory.scaled_compliance * memory.total,
            scaled_compliance: memory.scaled_compliance,
        }
    }

    #[inline(always)]
    fn accumulate(&self, change: Real, memory: &mut Multiplier) {
        memory.total += change;
    }
}

/// One family of constraints, colour by colour.
///
/// # Panics
/// For elements of vertices that are not there.
pub fn coloured<const N: usize, E: Constraint<N>>(
    vertex_count: usize,
    elements: &[E],
) -> Families<Compliant> {
    let mut families = Families::new(vertex_count, Sweep::Colored, Acceleration::default())
        .expect("settings in their ranges");
    families.add(elements).expect("elements of the sheet");
    families
}

/// Bytes that a sweep has to read (elements, multipliers, positions, inverse masses `w`) and to write (multipliers,
/// positions).
pub fn sweep_bytes<const N: usize, E: Constraint<N>>(elements: &[E], w: &[Real]) -> usize {
    let multipliers = elements.len() * E::Rows::LEN * size_of::<Multiplier>();
    size_of_val(elements) + 2 * multipliers + size_of_val(w) + 2 * size_of::<Vec3>() * w.len()
}
