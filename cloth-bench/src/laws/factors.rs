//! What a bending model with a given coefficient amounts to on each pattern of triangles.
//!
//! The closed-form factors are those of vertices that stand *on* a surface of constant curvature. Cloth at rest
//! need not stand so: where a pattern has vertices of two kinds, as the alternating grid has with four and with eight
//! neighbours, the two can settle at different heights. Every hinge of that grid bends around a vertex with four
//! neighbours, or across a diagonal between two with eight, so one offset relieves them all. The energy per area over
//! `½ k` falls from `3 κ_xx² + 3 κ_yy² + 12 κ_xy²` by `½ (κ_xx + κ_yy)²`: on a cylinder along the grid from 3 to 2.5,
//! on a sphere from 1.5 to 1. That is the stiffness that alternating cloth shows in equilibrium; a narrow strip, free
//! to curve across as well, shows 2.4. Where all vertices are alike nothing settles.

use super::elements::{Direction, Pattern, patch};
use super::models::{Model, ModelSetting};
use super::prelude::*;
use cloth_core::method::family::Energies;
use cloth_core::topology::{EdgeTable, HingeTable};

crate::settings! {
    struct BendingFactorSettings {
        surface: Surface = "cylinder", "cylinder, sphere or saddle";
        settled: bool = "no",
            "yes: vertices of different kinds may stand at different heights; no: all stand on the surface";
    }
}

pub(super) const BENDING_FACTOR: Law = Law {
    name: "bending-factor",
    about: "bending energy per area for coefficient k: over ½ k κ² on a cylinder and a saddle, over ½ k (2κ)² on a sphere",
    parameters: &[
        ModelSetting::PARAMETERS,
        Direction::PARAMETERS,
        BendingFactorSettings::PARAMETERS,
    ],
    tolerance: 1e-9,
    evaluate: bending_factor,
};

crate::choices! {
    /// A surface of constant curvature 1 in one direction and 0, 1 or −1 across it.
    #[derive(PartialEq, Eq)]
    pub(crate) enum Surface { Cylinder = "cylinder", Sphere = "sphere", Saddle = "saddle" }
}

/// What is bent how.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) model: Model,
    pub(crate) pattern: Pattern,
    pub(crate) surface: Surface,
    /// Direction of the first curvature (rad).
    pub(crate) angle: Real,
    /// Whether vertices of two kinds may stand at two heights.
    pub(crate) settled: bool,
}

/// Curvature tensor `(κ_xx, κ_yy, κ_xy)` of a surface with curvature 1 in the direction of `angle`.
fn curvature(surface: Surface, angle: Real) -> [Real; 3] {
    let across = match surface {
        Surface::Cylinder => 0.0,
        Surface::Sphere => 1.0,
        Surface::Saddle => -1.0,
    };
    let (sin, cos) = angle.sin_cos();
    [
        cos * cos + across * sin * sin,
        sin * sin + across * cos * cos,
        (1.0 - across) * sin * cos,
    ]
}

/// Energy per area over `½ k`, by hand: `Σ 3/(A₀ + A₁) (q z)²` over the hinges of one period, with `z = ½ x·κx`.
fn energy_by_hand(pattern: Pattern, settled: bool, [xx, yy, xy]: [Real; 3]) -> Real {
    let square = |x: Real| x * x;
    match pattern {
        // Each of three directions t with normal n gives ⅓ (κ_tt − 3 κ_nn)².
        Pattern::Equilateral => [0.0_f64, 60.0, 120.0]
            .iter()
            .map(|degrees| {
                let (s, c) = degrees.to_radians().sin_cos();
                let along = xx * c * c + yy * s * s + 2.0 * xy * s * c;
                square(along - 3.0 * (xx + yy - along)) / 3.0
            })
            .sum(),
        Pattern::OneWay => 12.0 * square(xy) + 3.0 * square(xx + xy) + 3.0 * square(yy + xy),
        // In a unit cell two hinges of each direction bend by κ + u and two diagonals by 2u, with u four times the
        // offset: least at u = −(κ_xx + κ_yy)/6.
        Pattern::Alternating => {
            let relief = if settled { 0.5 * square(xx + yy) } else { 0.0 };
            12.0 * square(xy) + 3.0 * square(xx) + 3.0 * square(yy) - relief
        }
    }
}

/// The factor by hand.
pub(crate) fn by_hand(case: &Case) -> Real {
    let kappa = curvature(case.surface, case.angle);
    case.model.factor() * energy_by_hand(case.pattern, case.settled, kappa) / scale(case.surface)
}

/// A sphere is compared by its mean curvature, κ1 + κ2 = 2.
fn scale(surface: Surface) -> Real {
    if surface == Surface::Sphere { 4.0 } else { 1.0 }
}

/// The factor by hand and the measured one.
pub(crate) fn factor(case: Case) -> Result<[Real; 2], BenchError> {
    const CURVATURE: Real = 1e-6; // m⁻¹: models of the angle differ from the quadratic one by the square of the slope
    let kappa = curvature(case.surface, case.angle);
    let (mesh, low, size) = patch(case.pattern)?;
    // Every second vertex of the square grids; in lines, where all are alike.
    let sign = |p: &Vec3| {
        let cell = (p.x.round() + p.y.round()) as i64;
        if cell % 2 == 0 { 1.0 } else { -1.0 }
    };
    let place = |p: &Vec3, offset: Real| {
        let twice = kappa[0] * p.x * p.x + kappa[1] * p.y * p.y + 2.0 * kappa[2] * p.x * p.y;
        Vec3::new(p.x, p.y, CURVATURE * (0.5 * twice + offset * sign(p)))
    };
    let edges = EdgeTable::build(&mesh)?;
    let hinges = HingeTable::build(&mesh, &edges);
    let inside: Vec<[u32; 4]> = hinges
        .hinges()
        .iter()
        .copied()
        .filter(|hinge| {
            let [a, b] = [hinge[0], hinge[1]].map(|v| mesh.positions()[v as usize]);
            let middle = (a + b) * 0.5;
            (0..2).all(|axis| middle[axis] >= low[axis] && middle[axis] < low[axis] + size[axis])
        })
        .collect();
    let hinges = case.model.elements(mesh.positions(), &inside, 1.0);
    let bending = Energies::new(mesh.vertex_count()).with_elements(vec![hinges])?;
    let unit = 0.5 * CURVATURE * CURVATURE * scale(case.surface) * size[0] * size[1];
    let energy = |offset: Real| {
        let x: Vec<Vec3> = mesh.positions().iter().map(|p| place(p, offset)).collect();
        bending.value(&x) / unit
    };
    // Small folds make a parabola of the offset: three points tell its minimum.
    let [below, middle, above] = [-0.5, 0.0, 0.5].map(energy);
    let (slope, bend) = (above - below, 4.0 * (above + below - 2.0 * middle));
    let relief = if case.settled && case.pattern == Pattern::Alternating {
        0.5 * slope * slope / bend
    } else {
        0.0
    };
    Ok([by_hand(&case), middle - relief])
}

fn bending_factor(settings: &Settings) -> Result<Evaluation, BenchError> {
    let own = BendingFactorSettings::read(settings)?;
    let lattice = Direction::read(settings)?;
    let [expected, measured] = factor(Case {
        model: *ModelSetting::read(settings)?.model,
        pattern: *lattice.pattern,
        surface: *own.surface,
        angle: lattice.angle_deg.to_radians(),
        settled: *own.settled,
    })?;
    Ok(Evaluation::new(expected, measured))
}
