//! A strip held edge-on that falls over sideways under its own weight.
//!
//! The beam of L. Prandtl and A. G. M. Michell (1899): with the bending rigidity `EI` sideways, the rigidity `GJ`
//! against twist and the moment `M = q u²/2` at a distance u from the free end, the twist φ obeys
//! `GJ φ″ + M²/EI φ = 0`, `φ′(0) = 0`, `φ(L) = 0`. The solution is `√u J₋₁⸝₆(q u³/(6√(EI GJ)))`, and the clamp is where
//! it first vanishes: `q L³/√(EI GJ) = 6 j = 12.8538`, j the first zero of the Bessel function. With `Γ = q L³/EI` that
//! is `Γ_c = 12.8538 √(GJ/EI)`, and for an isotropic sheet `GJ/EI = 2/(1 + ν)`.
//!
//! What is measured is no motion but a sign. In the plane the strip is in equilibrium at any Γ; it is stable as long as
//! the Hessian for displacements out of the plane has no negative eigenvalue, and Sylvester's law tells their number
//! from one factorisation. The load between is halved until it is known to 10⁻⁴.
//!
//! A strip of finite width is not the beam of the theory. The rim lacks hinges, so the strip is softer in proportion to
//! the size of a cell over the width; the clamp keeps it from curving across and from warping, so it is stiffer in
//! proportion to the width over the length. Error of `Γ_c` for equilateral triangles:
//!
//! | length/width | 5 vertices across | 9 | 17 | 33 | extrapolated from 9 and 17 |
//! |---|---|---|---|---|---|
//! | 8 | −0.5 % | 3.1 % | 5.0 % | 6.0 % | 6.9 % |
//! | 16 | −4.6 % | −0.7 % | 1.3 % | 2.3 % | 3.3 % |
//! | 32 | | −2.5 % | −0.4 % | | 1.6 % |
//! | 64 | | −3.3 % | −1.3 % | | 0.8 % |
//!
//! Both errors halve, one along the rows of the table and one along the columns. So four strips, with the cells and the
//! width as asked for and with both twice as large, give the number of the infinitely fine and narrow one, and that is
//! what the law compares.

use super::models::{Model, ModelSetting};
use super::prelude::*;
use super::strip::{Shape, Strip};
use crate::bisection::bisected;
use cloth_core::element::Convexity;
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::family::{Assembly, Energies};
use cloth_core::method::linear::{Inertia, UpperPattern};
use cloth_massspring::Accept;

law! {
    LATERAL_BUCKLING = "lateral-buckling" within 0.005,
    "Γ at which a strip held edge-on falls over sideways under its own weight (dimensionless): 12.8538 √(2/(1 + ν)), ν = −1/3 for equilateral triangles; extrapolated from four strips";
    lateral_buckling(LateralBucklingSettings {
        across: u32 = 9 in AtLeast(5.0),
            "vertices across the finer strips, an odd number; the coarser ones have half as many cells";
        slenderness: Real = 16 in Above(0.0),
            "length over width of the narrower strips; the wider ones have half of it";
        elongation: Real = 0.8660254037844386 in Above(0.0),
            "height of the triangles along the strip over their base across it; √¾ makes them equilateral";
    } and ModelSetting)
}

/// `6 j`, with j the first zero of the Bessel function of order −1/6, from its power series.
pub fn prandtl() -> Real {
    let bessel = |x: Real| {
        let (mut term, mut sum) = (1.0, 1.0);
        for k in 1..40 {
            let k = Real::from(k);
            term *= -0.25 * x * x / (k * (k - 1.0 / 6.0));
            sum += term;
        }
        sum
    };
    6.0 * bisected([1.0, 3.0], 60, |x| bessel(x) > 0.0)[0]
}

/// A strip in the plane z = 0, with gravity along −y.
struct EdgeOn {
    strip: Strip,
    energies: Energies,
    assembly: Assembly,
    matrix: BlockMatrix,
}

impl EdgeOn {
    fn new(shape: Shape, model: Model) -> Result<Self, BenchError> {
        // In its plane the strip has to be stiff against what it is sideways, or it bends before it buckles.
        const STIFFER: Real = 1e4;
        let strip = Strip::new(shape, model, 12.0 * STIFFER / shape.width().powi(2))?;
        let energies = strip.energies()?;
        let assembly = energies.assembly();
        Ok(Self {
            matrix: BlockMatrix::zeros(assembly.pattern().clone()),
            strip,
            energies,
            assembly,
        })
    }

    /// How many ways there are down from the equilibrium in the plane, `gravity` (m/s²) being its load.
    fn ways_down(&mut self, gravity: Real) -> Result<usize, BenchError> {
        let load = Vec3::y() * -gravity;
        let start = self.strip.mesh.positions();
        let rest = self.strip.rest(start, load, Accept::Stationary)?;
        // To rounding: not every model keeps the plane to the last bit.
        if rest.positions.iter().any(|x| x.z.abs() > 1e-12) {
            return Err(BenchError::Failed("the strip left its plane".into()));
        }
        self.matrix.clear();
        let (x, matrix) = (&rest.positions, &mut self.matrix);
        self.energies
            .add_hessian(&self.assembly, x, 1.0, Convexity::Exact, matrix);
        let mut sideways = self.sideways()?;
        let dimension = self.strip.particles.free_count();
        let stable = sideways.count_above(0.0).ok_or_else(|| {
            BenchError::Failed("the Hessian is singular to the last bit at a tried load".into())
        })?;
        Ok(dimension - stable)
    }

    /// The Hessian for displacements of the free vertices along z. A plane state couples them with no others.
    fn sideways(&self) -> Result<Inertia, BenchError> {
        let particles = &self.strip.particles;
        let pattern = self.matrix.pattern();
        let mut number = vec![None; particles.len()];
        let mut upper = UpperPattern {
            column_offsets: vec![0],
            rows: Vec::new(),
        };
        let mut values = Vec::new();
        let free = (0..particles.len()).filter(|&v| !particles.is_prescribed(v));
        for (index, vertex) in free.enumerate() {
            number[vertex] = Some(index as u32);
            for slot in pattern.row(vertex) {
                if let Some(row) = number[pattern.columns()[slot] as usize] {
                    upper.rows.push(row);
                    values.push(self.matrix.blocks()[slot][(2, 2)]);
                }
            }
            upper.column_offsets.push(upper.rows.len() as u32);
        }
        Inertia::new(upper, values).map_err(BenchError::failed)
    }
}

/// Where the strip first has a way down, to `ACCURACY` of it, looked for around a load that is expected.
fn onset(strip: &mut EdgeOn, expected: Real) -> Result<Real, BenchError> {
    const ACCURACY: Real = 1e-4;
    let [mut low, mut high] = [0.8 * expected, 1.2 * expected];
    if strip.ways_down(low)? > 0 || strip.ways_down(high)? == 0 {
        return Err(BenchError::Failed(format!(
            "the strip does not lose its stability between {low:.3} and {high:.3}"
        )));
    }
    while high - low > ACCURACY * expected {
        let middle = 0.5 * (low + high);
        if strip.ways_down(middle)? == 0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(0.5 * (low + high))
}

/// The strip of whole cells nearest to a width.
fn shape(across: usize, slenderness: Real, elongation: Real) -> Result<Shape, BenchError> {
    let cells = (slenderness * (across - 1) as Real / elongation - 0.5).round();
    let shape = Shape {
        cells: cells.max(2.0) as usize,
        across,
        elongation,
    };
    shape.check()?;
    Ok(shape)
}

/// `12.8538 √(GJ/EI)`.
fn closed_form(shape: Shape) -> Real {
    prandtl() * (shape.twist_rigidity() / shape.free_rigidity()).sqrt()
}

/// Γ at which a strip buckles. Γ is measured in the rigidity of a strip that is free to curve across; D = 1 is that of
/// the sheet.
fn critical(model: Model, shape: Shape) -> Result<Real, BenchError> {
    let rigidity = shape.free_rigidity();
    let near = closed_form(shape) * rigidity;
    Ok(onset(&mut EdgeOn::new(shape, model)?, near)? / rigidity)
}

fn lateral_buckling(
    own: &LateralBucklingSettings,
    model: &ModelSetting,
) -> Result<Evaluation, BenchError> {
    let model = *model.model;
    let across = *own.across;
    within_reach(1.5e6 * Real::from(across).powi(3))?;
    let across = across as usize;
    if across.is_multiple_of(2) {
        return Err(BenchError::Usage(format!(
            "across is {across}, but it has to be odd: half of the cells make the coarser strip"
        )));
    }
    let (slenderness, elongation) = (*own.slenderness, *own.elongation);
    let finest = shape(across, slenderness, elongation)?;
    let at = |across, slenderness| critical(model, shape(across, slenderness, elongation)?);
    // To cells of no size, at either width; then to no width.
    let fine_cells = |slenderness: Real| {
        let [fine, coarse] = [
            at(across, slenderness)?,
            at(across.div_ceil(2), slenderness)?,
        ];
        Ok::<_, BenchError>([2.0 * fine - coarse, fine])
    };
    let [narrow, finest_measured] = fine_cells(slenderness)?;
    let [wide, _] = fine_cells(0.5 * slenderness)?;
    Ok(Evaluation::new(closed_form(finest), 2.0 * narrow - wide)
        .detail("finest_strip", finest_measured)
        .detail(
            "finest_strip_vertices",
            (finest.across * (finest.cells + 2)) as Real,
        )
        .detail("without_cells", narrow)
        .detail("bending_rigidity", finest.free_rigidity())
        .detail("twist_rigidity", finest.twist_rigidity()))
}
