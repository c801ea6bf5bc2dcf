//! The diagonal fold: a square held along one diagonal, whose two corners hang down.
//!
//! With s the distance from the clamp, h that of the corner, and u = h − s, a flap is `2u` wide and carries `ρ u²`
//! beyond s. Held at θ(0) = 0, bent by its own weight and not stretched, its angle below the horizontal follows
//!
//! `d/ds (2 u D θ′) = −ρ g u² cos θ`,
//!
//! a heavy elastica of linear width. Integrated from the corner, where the moment vanishes, with the angle there found
//! by bisection.

use super::sheet::{Kind, Rest, Sheet, square};
use crate::bisection::bisected;
use crate::studies::prelude::*;

/// Acceleration of free fall (m/s²).
pub const GRAVITY: Real = 9.81;
/// Areal density (kg/m²).
pub const DENSITY: Real = 0.2;

/// Which diagonal is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// From the lower left to the upper right: along the diagonals of a one-way grid.
    Along,
    /// From the upper left to the lower right: across them.
    Across,
}

impl Axis {
    /// Unit vectors along the axis and away from it.
    pub fn directions(self) -> [Vec3; 2] {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let [rising, falling] = [Vec3::new(half, half, 0.0), Vec3::new(half, -half, 0.0)];
        match self {
            Self::Along => [rising, falling],
            Self::Across => [falling, rising],
        }
    }
}

const CENTRE: Vec3 = Vec3::new(0.5, 0.5, 0.0);

/// The exact shape of a flap.
#[derive(Clone, Debug)]
pub struct Fold {
    /// Distance (m) of the clamp from the diagonal.
    pub(super) clamp: Real,
    axis: Axis,
    /// `(x, drop)` (m) of points at equal distances along the flap, from the clamp to the corner.
    pub curve: Vec<[Real; 2]>,
    /// Bending energy (J) of both flaps.
    pub bending_energy: Real,
}

const STEPS: usize = 2000;

impl Fold {
    /// The fold of a sheet of rigidity `rigidity` (N·m), held up to `clamp` (m) from its diagonal.
    pub fn exact(axis: Axis, clamp: Real, rigidity: Real) -> Self {
        let length = std::f64::consts::FRAC_1_SQRT_2 - clamp;
        // The angle at the clamp grows with that at the corner.
        let is_below = |angle| integrate(length, rigidity, angle, |_, _, _| ()) <= 0.0;
        let [low, _] = bisected([0.0, std::f64::consts::FRAC_PI_2], 60, is_below);
        let mut slopes = Vec::with_capacity(STEPS + 1);
        let mut bending_energy = 0.0;
        let ds = length / STEPS as Real;
        integrate(length, rigidity, low, |u, angle, bend| {
            slopes.push(angle);
            // Two flaps, 2 u wide; the trapezoidal rule, whose end at the corner is zero.
            let weight = if u > length - 0.5 * ds { 0.5 } else { 1.0 };
            bending_energy += weight * ds * 2.0 * rigidity * u * bend * bend;
        });
        slopes.reverse();
        let mut curve = vec![[0.0, 0.0]];
        for pair in slopes.windows(2) {
            let [x, drop] = curve[curve.len() - 1];
            let angle = 0.5 * (pair[0] + pair[1]);
            curve.push([x + ds * angle.cos(), drop + ds * angle.sin()]);
        }
        Self {
            clamp,
            axis,
            curve,
            bending_energy,
        }
    }

    /// Where a point (m) of the flat sheet lies on the folded one.
    pub fn place(&self, p: &Vec3) -> Vec3 {
        let [along, away] = self.axis.directions();
        let d = p - CENTRE;
        let s = d.dot(&away);
        let beyond = (s.abs() - self.clamp).max(0.0);
        let length = std::f64::consts::FRAC_1_SQRT_2 - self.clamp;
        let place = beyond / length * STEPS as Real;
        let first = (place as usize).min(STEPS - 1);
        let part = place - first as Real;
        let [x, drop] = [0, 1].map(|k| {
            let [a, b] = [self.curve[first][k], self.curve[first + 1][k]];
            a + (b - a) * part
        });
        let reach = s.abs().min(self.clamp) + x;
        CENTRE + along * d.dot(&along) + away * reach.copysign(s) - Vec3::z() * drop
    }

    /// Whether a point (m) of the flat sheet is held.
    pub(super) fn is_held(&self, p: &Vec3) -> bool {
        (p - CENTRE).dot(&self.axis.directions()[1]).abs() < self.clamp
    }

    /// Angle (°) below the horizontal at which the corners are seen from the clamp; of the exact shape.
    pub(super) fn exact_angle(&self) -> Real {
        let [x, drop] = self.curve[STEPS];
        drop.atan2(x).to_degrees()
    }

    /// The same of a sheet whose vertices are at `vertices` (m): the mean of both corners.
    pub(super) fn angle(&self, sheet: &Sheet, vertices: &[Vec3]) -> Result<Real, BenchError> {
        let [one, other] = self.angles(sheet, vertices)?;
        Ok(0.5 * (one + other))
    }

    /// The same (°) of each corner, the side of [`Axis::directions`] first.
    pub(super) fn angles(&self, sheet: &Sheet, vertices: &[Vec3]) -> Result<[Real; 2], BenchError> {
        let away = self.axis.directions()[1];
        let corner = |side: Real| {
            let reach = |p: &Vec3| side * (p - CENTRE).dot(&away);
            let rest = sheet.mesh.positions().iter().zip(vertices);
            let (_, x) = rest.max_by(|(p, _), (q, _)| reach(p).total_cmp(&reach(q)))?;
            let d = x - CENTRE;
            let angle = (-d.z).atan2(side * d.dot(&away) - self.clamp);
            Some(angle.to_degrees())
        };
        let both = corner(1.0).zip(corner(-1.0));
        both.map(|(one, other)| [one, other])
            .ok_or_else(|| BenchError::Failed("a mesh without vertices".into()))
    }

    /// The curvature (1/m) by energy: `E = ½ D κ² A` with the area of the flaps.
    pub fn mean_curvature(&self, rigidity: Real) -> Real {
        let length = std::f64::consts::FRAC_1_SQRT_2 - self.clamp;
        (self.bending_energy / (rigidity * length * length)).sqrt()
    }
}

/// A sheet at rest, folded.
#[derive(Debug)]
pub(super) struct Folded {
    pub(super) sheet: Sheet,
    pub(super) rest: Rest,
    /// What the fold of an inextensible sheet looks like, with the rigidity that the hinges of the mesh have about this
    /// axis.
    pub(super) exact: Fold,
    /// That rigidity over D (dimensionless).
    pub(super) factor: Real,
    /// Radius (m) of a bend that costs as much as the exact one.
    pub(super) radius: Real,
    /// Bending energy over that of the exact fold (dimensionless).
    pub(super) bending: Real,
    /// Membrane energy over the same.
    pub(super) membrane: Real,
    /// [`Fold::angle`] (°).
    pub(super) angle: Real,
}

/// What there is to tell of a [`Folded`], as columns.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Shown {
    #[serde(rename = "rigidity over D")]
    pub(super) factor: Real,
    #[serde(rename = "fold angle")]
    angle: Real,
    exact_angle: Real,
    #[serde(rename = "bending reached")]
    pub(super) bending: Real,
    #[serde(rename = "membrane over bending")]
    membrane: Real,
    iterations: u32,
    last_move: Real,
}

/// The same, with what it is compared by.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Figures {
    /// [`Sheet::edge_length`] (m).
    pub(super) edge_length: Real,
    /// As in [`Folded`].
    pub(super) radius: Real,
    pub(super) shown: Shown,
}

impl Folded {
    pub(super) fn figures(&self) -> Result<Figures, BenchError> {
        let shown = Shown {
            factor: self.factor,
            angle: self.angle,
            exact_angle: self.exact.exact_angle(),
            bending: self.bending,
            membrane: self.membrane,
            iterations: self.rest.iterations,
            last_move: self.rest.last_move,
        };
        Ok(Figures {
            edge_length: self.sheet.edge_length()?,
            radius: self.radius,
            shown,
        })
    }
}

/// The clamp (m) of a mesh of `cells` cells a side: near 0.06 m, in the middle between two rows of a grid.
fn clamp(cells: usize) -> Real {
    let row = std::f64::consts::FRAC_1_SQRT_2 / cells as Real;
    row * ((0.06 / row).floor() + 0.5)
}

/// Prepares a sheet for the fold, held and placed on the exact one, and the factor of its rigidity.
pub(super) fn prepared(
    axis: Axis,
    pattern: &str,
    cells: usize,
    kind: Kind,
    [modulus, rigidity]: [Real; 2],
) -> Result<(Sheet, Fold, Real), BenchError> {
    let nominal = Fold::exact(axis, clamp(cells), rigidity);
    let mut sheet = Sheet::new(square(pattern, cells)?, kind, modulus, rigidity)?;
    sheet.hold(|p| nominal.is_held(p))?;
    let placed = sheet.bending_energy(&sheet.placed(|p| nominal.place(p)))?;
    let factor = placed / nominal.bending_energy;
    Ok((
        sheet,
        Fold::exact(axis, nominal.clamp, factor * rigidity),
        factor,
    ))
}

/// Folds a sheet of `cells` cells a side, of modulus and rigidity `[modulus, rigidity]` (N/m, N·m), starting from the
/// exact fold.
pub(super) fn fold(
    axis: Axis,
    pattern: &str,
    cells: usize,
    kind: Kind,
    stiffness: [Real; 2],
) -> Result<Folded, BenchError> {
    let (sheet, exact, _) = prepared(axis, pattern, cells, kind, stiffness)?;
    let start = sheet.placed(|p| exact.place(p));
    fold_from(start, axis, pattern, cells, kind, stiffness)
}

/// The same, starting with the points at `start` (m).
pub(super) fn fold_from(
    start: Vec<Vec3>,
    axis: Axis,
    pattern: &str,
    cells: usize,
    kind: Kind,
    stiffness: [Real; 2],
) -> Result<Folded, BenchError> {
    let (sheet, exact, factor) = prepared(axis, pattern, cells, kind, stiffness)?;
    let rest = sheet.rest(start, Vec3::z() * -GRAVITY)?;
    Ok(Folded {
        bending: sheet.bending_energy(&rest.points)? / exact.bending_energy,
        membrane: sheet.membrane_energy(&rest.points)? / exact.bending_energy,
        angle: exact.angle(&sheet, &sheet.vertices(&rest.points))?,
        radius: 1.0 / exact.mean_curvature(factor * stiffness[1]),
        sheet,
        rest,
        exact,
        factor,
    })
}

/// Integrates from the corner, at angle `at_corner`, to the clamp (Runge–Kutta, fourth order) and returns the angle
/// there. `visit` is given u (m), θ and θ′ (1/m).
fn integrate(
    length: Real,
    rigidity: Real,
    at_corner: Real,
    mut visit: impl FnMut(Real, Real, Real),
) -> Real {
    let load = DENSITY * GRAVITY / (2.0 * rigidity);
    // With m = u θ′: dm/du = load u² cos θ and dθ/du = −m/u.
    let bend = |u: Real, m: Real| if u > 0.0 { m / u } else { 0.0 };
    let rate = |u: Real, [angle, m]: [Real; 2]| [-bend(u, m), load * u * u * angle.cos()];
    let step = length / STEPS as Real;
    let mut y = [at_corner, 0.0];
    visit(0.0, y[0], 0.0);
    for index in 0..STEPS {
        let u = step * index as Real;
        let moved = |y: [Real; 2], k: [Real; 2], h: Real| [y[0] + h * k[0], y[1] + h * k[1]];
        let k1 = rate(u, y);
        let k2 = rate(u + 0.5 * step, moved(y, k1, 0.5 * step));
        let k3 = rate(u + 0.5 * step, moved(y, k2, 0.5 * step));
        let k4 = rate(u + step, moved(y, k3, step));
        for i in 0..2 {
            y[i] += step / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        visit(u + step, y[0], bend(u + step, y[1]));
    }
    y[0]
}
