//! A strip of cloth clamped at one end, made so that the theory of a beam holds for it, and its equilibria.
//!
//! The strip runs along x. Its vertices stand in rows across it, `length/rows` apart, every second row shifted by half
//! a spacing: triangles of height h along the strip and base b across it. For an isosceles triangulation the quadratic
//! model with coefficient k costs, with `r = b²/(4h²)` and a curvature tensor κ, per area
//!
//! `½·3k [(κ_xx − r κ_yy)² + ½(1 + r)² κ_yy² + (1 + r)²/(2r) κ_xy²]`,
//!
//! derived hinge by hinge; equilateral triangles are the case `r = 1/3`. All vertices being alike,
//! there is no internal relaxation. What follows:
//!
//! - A cylinder about y folds only the edges across the strip, which are the generators: every other hinge stays flat
//!   and no triangle stretches. A rim of edges without hinges costs nothing, as no edge of the long sides lies across.
//!   The strip is then exactly a chain of rigid rows with the cylindrical rigidity `D = 3k`.
//! - A narrow strip is free to curve across, `κ_yy = r κ_xx/(r² + ½(1 + r)²)`, and its rigidity falls to
//!   `D/(1 + 2r²/(1 + r)²)`: by a ninth for equilateral triangles (`ν = −1/3`, `1 − ν² = 8/9`), by 0.15 % for triangles
//!   three times as high as wide.
//! - The rigidity against twist is `D (1 + r)²/(2r)`, 8/3 D for equilateral triangles.
//!
//! The first cell is held, and the clamp of the theory is its middle: the direction of a cell belongs to its middle, so
//! the first row that can turn does so one whole cell later. The length is measured from there.

use super::models::Model;
use super::prelude::*;
use cloth_core::energy::StvkTriangle;
use cloth_core::mesh::{TriMesh, generate};
use cloth_core::method::family::Energies;
use cloth_core::topology::{EdgeTable, HingeTable};
use cloth_massspring::{Accept, ImplicitConfig, ImplicitEuler};

/// A strip of length 1 m from the clamp to the last row, of areal density 1 kg/m² and rigidity D = 1 N·m, flat in the
/// plane z = 0.
#[derive(Clone, Debug)]
pub(crate) struct Strip {
    pub(crate) mesh: TriMesh,
    /// Masses; the first two rows are held.
    pub(crate) particles: Particles,
    pub(crate) families: Vec<Elements>,
    /// Vertices of a row.
    across: usize,
}

/// Where a strip is at rest, and how well.
#[derive(Clone, Debug)]
pub(crate) struct Equilibrium {
    pub(crate) positions: Vec<Vec3>,
    /// `‖∇E − Mg‖/‖Mg‖` over the free vertices (dimensionless).
    pub(crate) residual: Real,
    /// What rounding of the positions alone makes of it: how much it changes when every coordinate moves by half a unit
    /// in the last place.
    pub(crate) rounding: Real,
    /// How far (m) the middle of the last row moved in the last step; the distance that is left is shorter.
    pub(crate) last_move: Real,
    /// Newton iterations.
    pub(crate) iterations: u32,
}

/// Shape of a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shape {
    /// Free cells along the strip; the held one comes before them.
    pub(crate) cells: usize,
    /// Vertices across.
    pub(crate) across: usize,
    /// Height of a triangle along the strip over its base across it, h/b.
    pub(crate) elongation: Real,
}

/// Larger strips are a slip of the pen.
const MOST_VERTICES: usize = 1_000_000;

impl Shape {
    /// `r = b²/(4h²)`.
    fn r(self) -> Real {
        0.25 / (self.elongation * self.elongation)
    }

    /// Bending rigidity per width of a narrow strip over D.
    pub(crate) fn free_rigidity(self) -> Real {
        let r = self.r();
        1.0 / (1.0 + 2.0 * (r / (1.0 + r)).powi(2))
    }

    /// Rigidity against twist per width over D.
    pub(crate) fn twist_rigidity(self) -> Real {
        let r = self.r();
        (1.0 + r).powi(2) / (2.0 * r)
    }

    /// Refuses what is too large or too thin to compute with.
    pub(crate) fn check(self) -> Result<(), BenchError> {
        let vertices = (self.cells + 2) * self.across;
        if vertices > MOST_VERTICES {
            return Err(BenchError::Usage(format!(
                "the strip has {vertices} vertices, more than {MOST_VERTICES}"
            )));
        }
        if !(0.1..=20.0).contains(&self.elongation) {
            return Err(BenchError::Usage(format!(
                "elongation is {}, but it has to lie between 0.1 and 20",
                self.elongation
            )));
        }
        Ok(())
    }

    /// h (m): half a cell is held before the clamp of the theory ends, the rest is 1 m long.
    pub(crate) fn spacing(self) -> Real {
        1.0 / (self.cells as Real + 0.5)
    }

    /// Width of a row (m).
    pub(crate) fn width(self) -> Real {
        (self.across - 1) as Real * self.spacing() / self.elongation
    }
}

impl Strip {
    /// The strip with a bending model and a membrane of modulus `modulus` (N/m) and Poisson's ratio 0.
    pub(crate) fn new(shape: Shape, model: Model, modulus: Real) -> Result<Self, BenchError> {
        let (rows, h) = (shape.cells + 2, shape.spacing());
        let b = h / shape.elongation;
        let flat = generate::equilateral(shape.across, rows, 1.0)?;
        // Rows of the lattice lie along x and are √¾ apart; here they lie across. The clamp is at x = 0.
        let place = |p: &Vec3| {
            let row = (p.y / 0.75_f64.sqrt()).round();
            Vec3::new((row - 0.5) * h, -p.x * b, 0.0)
        };
        let positions: Vec<Vec3> = flat.positions().iter().map(place).collect();
        let mesh = TriMesh::new(positions, flat.triangles().to_vec())?;
        let mut particles = Particles::from_areal_density(&mesh, 1.0)?;
        for vertex in 0..2 * shape.across {
            particles.prescribe(vertex)?;
        }
        let edges = EdgeTable::build(&mesh)?;
        let hinges = HingeTable::build(&mesh, &edges);
        let k = model.coefficient(1.0);
        let families = vec![
            Elements::Stvk(StvkTriangle::on(&mesh, modulus, 0.0)),
            model.elements(mesh.positions(), hinges.hinges(), k),
        ];
        Ok(Self {
            mesh,
            particles,
            families,
            across: shape.across,
        })
    }

    /// The sum of its energies.
    pub(crate) fn energies(&self) -> Result<Energies, BenchError> {
        Energies::new(self.particles.len())
            .with_elements(self.families.clone())
            .map_err(BenchError::failed)
    }

    /// Middle of the last row (m).
    pub(crate) fn tip(&self, positions: &[Vec3]) -> Vec3 {
        let last = &positions[positions.len() - self.across..];
        last.iter().sum::<Vec3>() / self.across as Real
    }

    /// Its rest under gravity (m/s²), found from `start` by steps of implicit Euler that are long against the fall and
    /// each start without velocity, until the forces balance as well as rounding lets them, or to 1e-9 of the weight,
    /// and a further step moves the tip by less than 1e-8 of the length.
    pub(crate) fn rest(
        &self,
        start: &[Vec3],
        gravity: Vec3,
        accept: Accept,
    ) -> Result<Equilibrium, BenchError> {
        const MOST_STEPS: u32 = 60;
        const BALANCE: Real = 1e-9;
        const MOVE: Real = 1e-8;
        let config = ImplicitConfig {
            max_iterations: 1000,
            tolerance: 0.0,
            accept,
            ..Default::default()
        };
        let families = self.families.clone();
        let mut newton = ImplicitEuler::builder(&self.particles)
            .elements(families)
            .config(config)
            .build()?;
        let energies = self.energies()?;
        let dt = 30.0 / gravity.norm().sqrt();
        let mut found = Equilibrium {
            positions: start.to_vec(),
            residual: Real::INFINITY,
            rounding: 0.0,
            last_move: Real::INFINITY,
            iterations: 0,
        };
        for _ in 0..MOST_STEPS {
            let tip = self.tip(&found.positions);
            let mut state = State::at_rest(found.positions);
            let report = newton.step(&mut state, StepInput::new(dt).gravity(gravity))?;
            found.iterations += report.iterations;
            found.last_move = (self.tip(&state.positions) - tip).norm();
            found.positions = state.positions;
            self.weigh(&energies, gravity, &mut found);
            if found.residual <= BALANCE.max(4.0 * found.rounding) && found.last_move < MOVE {
                return Ok(found);
            }
        }
        Err(BenchError::Failed(format!(
            "the strip does not come to rest: forces of {:.1e} of the weight are left, and the tip still moves by {:.1e} m",
            found.residual, found.last_move
        )))
    }

    /// Measures how well forces balance.
    fn weigh(&self, energies: &Energies, gravity: Vec3, at: &mut Equilibrium) {
        let x = &at.positions;
        let free = || (0..x.len()).filter(|&v| !self.particles.is_prescribed(v));
        let weight_of = |v: usize| gravity * self.particles.mass()[v];
        let forces = |x: &[Vec3]| {
            let mut force = vec![Vec3::zeros(); x.len()];
            energies.add_gradient(x, &mut force);
            force
        };
        let sum = |of: &dyn Fn(usize) -> Vec3| {
            let squares: Real = free().map(|v| of(v).norm_squared()).sum();
            squares.sqrt()
        };
        let unit = 0.5 * Real::EPSILON * x.iter().map(Vec3::amax).fold(0.0, Real::max);
        // Signs that look random, the same in every run.
        let sign = |v: usize, axis: usize| ((3 * v + axis) as Real * 0.754_877_666).fract() - 0.5;
        let shaken: Vec<Vec3> = (0..x.len())
            .map(|v| x[v] + Vec3::from_fn(|axis, _| unit.copysign(sign(v, axis))))
            .collect();
        let (force, other) = (forces(x), forces(&shaken));
        let weight = sum(&weight_of);
        at.residual = sum(&|v| force[v] - weight_of(v)) / weight;
        at.rounding = sum(&|v| force[v] - other[v]) / weight;
    }
}
