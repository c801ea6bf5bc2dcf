//! A sheet with a membrane of some kind, held where a scene wants it, and its rest.

use super::count::mesh_of;
use crate::studies::prelude::*;
use cloth_core::cloth::{
    Cloth, CoarseMembrane, Discretization, Elements, Membrane, MembraneElements, SpringEdges,
    SpringLaw,
};
use cloth_core::element::Element;
use cloth_core::mesh::TriMesh;
use cloth_core::method::family::Energies;
use cloth_core::particles::Particles;
use cloth_core::topology::{EdgeTable, Midpoints};
use cloth_massspring::{ImplicitConfig, ImplicitEuler};

/// What carries the membrane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Springs on the edges.
    Springs,
    /// Triangles of StVK.
    Stvk,
    /// Triangles that are as rigid as possible.
    Arap,
    /// Springs with this share of k under compression.
    Compression(Real),
    /// Springs that are slack up to this strain.
    DeadZone(Real),
    /// Springs on so few edges that this share of the coordinates is free.
    DofFraction(Real),
    /// Springs on the sides of cells, none on their diagonals.
    Quads,
    /// Springs a hundred times softer, and limits at this strain as stiff as the springs would be.
    Limited(Real),
    /// Links of this coarse level, and springs a hundred times softer on the edges.
    Level(u32),
    /// Springs on the triangles of edge midpoints.
    Midpoints,
}

/// The kinds of the study, with their names.
pub(super) const KINDS: [(&str, Kind); 10] = [
    ("springs", Kind::Springs),
    ("StVK", Kind::Stvk),
    ("ARAP", Kind::Arap),
    ("k/100 under compression", Kind::Compression(0.01)),
    ("slack ±0.5 %", Kind::DeadZone(0.005)),
    ("a fifth free", Kind::DofFraction(0.2)),
    ("quads", Kind::Quads),
    ("soft, limited at 1 %", Kind::Limited(0.01)),
    ("coarse level 2, k/100 on edges", Kind::Level(2)),
    ("midpoints", Kind::Midpoints),
];

/// A cloth on a mesh or on its midpoints; `points` are its degrees of freedom.
#[derive(Debug)]
pub struct Sheet {
    pub(super) mesh: TriMesh,
    midpoints: Option<Midpoints>,
    pub(super) particles: Particles,
    membrane: Vec<Elements>,
    bending: Vec<Elements>,
    /// Positions at rest (m) of all points.
    pub(super) points: Vec<Vec3>,
}

/// Where a sheet comes to rest.
#[derive(Clone, Debug)]
pub(super) struct Rest {
    /// Positions (m) of all points.
    pub(super) points: Vec<Vec3>,
    /// Iterations of all steps.
    pub(super) iterations: u32,
    /// How far (m) a point moved at most in the last step.
    pub(super) last_move: Real,
}

impl Sheet {
    /// A sheet of density 0.2 kg/m², modulus `modulus` (N/m) and rigidity `rigidity` (N·m).
    pub fn new(
        mesh: TriMesh,
        kind: Kind,
        modulus: Real,
        rigidity: Real,
    ) -> Result<Self, BenchError> {
        let cloth = |modulus: Real, rigidity: Real| Cloth {
            areal_density: 0.2,
            membrane: Membrane::Modulus(modulus),
            bending_rigidity: rigidity,
        };
        let stiff = cloth(modulus, rigidity);
        if kind == Kind::Midpoints {
            let cut = stiff
                .on_midpoints(MembraneElements::Springs, &mesh)
                .map_err(BenchError::usage)?;
            let (bending, membrane) = parted(cut.model.families());
            return Ok(Self {
                points: cut.midpoints.mesh().positions().to_vec(),
                midpoints: Some(cut.midpoints),
                particles: cut.model.particles,
                membrane,
                bending,
                mesh,
            });
        }
        let plain = Discretization::default();
        let law = |law| Discretization { law, ..plain };
        let edges = |edges| Discretization { edges, ..plain };
        let discretization = match kind {
            Kind::Springs | Kind::Midpoints => plain,
            Kind::Stvk => Discretization {
                membrane: MembraneElements::Stvk {
                    poisson_ratio: 1.0 / 3.0,
                },
                ..plain
            },
            Kind::Arap => Discretization {
                membrane: MembraneElements::Arap,
                ..plain
            },
            Kind::Compression(share) => law(SpringLaw::Compression(share)),
            Kind::DeadZone(strain) => law(SpringLaw::DeadZone([1.0 - strain, 1.0 + strain])),
            Kind::Limited(strain) => law(SpringLaw::DeadZone([1.0 - strain, 1.0 + strain])),
            Kind::DofFraction(share) => edges(SpringEdges::DofFraction(share)),
            Kind::Quads => edges(SpringEdges::Quads),
            Kind::Level(level) => Discretization {
                coarse_membrane: Some(CoarseMembrane {
                    level,
                    fine_fraction: 0.01,
                }),
                ..plain
            },
        };
        let cut = |cloth: Cloth, discretization: &Discretization| {
            cloth
                .discretized_with(discretization, &mesh)
                .map_err(BenchError::usage)
        };
        let model = cut(stiff, &discretization)?;
        let (bending, mut membrane) = parted(model.families());
        if let Kind::Limited(_) = kind {
            membrane.extend(cut(cloth(0.01 * modulus, 0.0), &plain)?.families());
        }
        Ok(Self {
            points: mesh.positions().to_vec(),
            midpoints: None,
            particles: model.particles,
            membrane,
            bending,
            mesh,
        })
    }

    /// Holds the points that lie at rest where `is_held` says, and drops the elements between them: what a scene does
    /// to those is none of the sheet's doing.
    pub(super) fn hold(&mut self, is_held: impl Fn(&Vec3) -> bool) -> Result<(), BenchError> {
        for (point, x) in self.points.iter().enumerate() {
            if is_held(x) {
                self.particles.prescribe(point)?;
            }
        }
        let particles = &self.particles;
        for family in self.membrane.iter_mut().chain(&mut self.bending) {
            match family {
                Elements::Springs(elements) => keep_free(elements, particles),
                Elements::Limited(elements) => keep_free(elements, particles),
                Elements::Stvk(elements) => keep_free(elements, particles),
                Elements::Arap(elements) => keep_free(elements, particles),
                Elements::Quadratic(elements) => keep_free(elements, particles),
                Elements::Midpoint(elements) => keep_free(elements, particles),
                _ => {}
            }
        }
        Ok(())
    }

    /// The points (m) when the sheet is moved by `place`, which maps positions at rest (m).
    pub fn placed(&self, place: impl Fn(&Vec3) -> Vec3) -> Vec<Vec3> {
        self.points.iter().map(place).collect()
    }

    /// Positions (m) of the vertices.
    pub(super) fn vertices(&self, points: &[Vec3]) -> Vec<Vec3> {
        match &self.midpoints {
            Some(midpoints) => midpoints.vertices(points),
            None => points.to_vec(),
        }
    }

    /// Energy (J) of the hinges.
    pub fn bending_energy(&self, points: &[Vec3]) -> Result<Real, BenchError> {
        Ok(self.sum_of(&self.bending)?.value(points))
    }

    /// Energy (J) of the membrane.
    pub fn membrane_energy(&self, points: &[Vec3]) -> Result<Real, BenchError> {
        Ok(self.sum_of(&self.membrane)?.value(points))
    }

    fn sum_of(&self, families: &[Elements]) -> Result<Energies, BenchError> {
        Energies::new(self.particles.len())
            .with_elements(families.to_vec())
            .map_err(BenchError::failed)
    }

    /// The pairs of points whose distance is a condition, as if all springs were taut.
    pub(super) fn conditions(&self) -> Result<Vec<[u32; 2]>, BenchError> {
        if let Some(Elements::Springs(springs)) = self.membrane.last() {
            return Ok(springs.iter().map(|s| s.vertices).collect());
        }
        if let Some(Elements::Limited(springs)) = self.membrane.last() {
            return Ok(springs.iter().map(|s| s.vertices).collect());
        }
        // The three strains of a triangle are the lengths of its sides.
        let edges = EdgeTable::build(&self.mesh)?;
        Ok(edges.ends().to_vec())
    }

    /// The edge length l (m) that stands for the mesh in estimates of locking: an edge on a curved surface is short by
    /// a part that goes with the square of its length L, and stores as much as `k L²` times the square of that, so
    /// `l⁴ = Σ L² L⁴/Σ L²`.
    pub(super) fn edge_length(&self) -> Result<Real, BenchError> {
        let edges = EdgeTable::build(&self.mesh)?;
        let x = self.mesh.positions();
        let (mut sixths, mut squares) = (0.0, 0.0);
        for &[a, b] in edges.ends() {
            let squared = (x[a as usize] - x[b as usize]).norm_squared();
            squares += squared;
            sixths += squared.powi(3);
        }
        Ok((sixths / squares).powf(0.25))
    }

    /// All elements.
    pub(super) fn families(&self) -> Vec<Elements> {
        self.membrane.iter().chain(&self.bending).cloned().collect()
    }

    /// Rest under gravity (m/s²), from `start`: long steps of implicit Euler that each begin without velocity, until
    /// one moves no point by 1e-6 m.
    pub(super) fn rest(&self, start: Vec<Vec3>, gravity: Vec3) -> Result<Rest, BenchError> {
        const MOST_STEPS: u32 = 30;
        const DT: Real = 2.0;
        // Under gravity the first gradient is that of the free fall of a whole step, and no measure of what is left.
        let tolerance = if gravity == Vec3::zeros() {
            1e-7
        } else {
            1e-13
        };
        let config = ImplicitConfig {
            max_iterations: 300,
            tolerance,
            ..Default::default()
        };
        let mut solver = ImplicitEuler::builder(&self.particles)
            .elements(self.families())
            .config(config)
            .build()?;
        let mut found = Rest {
            points: start,
            iterations: 0,
            last_move: Real::INFINITY,
        };
        for _ in 0..MOST_STEPS {
            let mut state = State::at_rest(found.points.clone());
            let report = solver.step(&mut state, StepInput::new(DT).gravity(gravity))?;
            let moved = state.positions.iter().zip(&found.points);
            found.last_move = moved.map(|(a, b)| (a - b).norm()).fold(0.0, Real::max);
            found.iterations += report.iterations;
            found.points = state.positions;
            if found.last_move < 1e-6 {
                break;
            }
        }
        Ok(found)
    }
}

/// Drops the elements whose points are all held.
fn keep_free<const N: usize, E: Element<N>>(elements: &mut Vec<E>, particles: &Particles) {
    elements.retain(|element| {
        let points = element.vertices();
        !points.iter().all(|&p| particles.is_prescribed(p as usize))
    });
}

/// Bending and membrane apart.
fn parted(families: Vec<Elements>) -> (Vec<Elements>, Vec<Elements>) {
    families
        .into_iter()
        .partition(|family| matches!(family, Elements::Quadratic(_) | Elements::Midpoint(_)))
}

/// A mesh of the unit square with `cells` cells a side. The lattice of equilateral triangles is stretched by a few per
/// cent in y to fill the square, and its zigzag sides are half a triangle deep.
pub fn square(pattern: &str, cells: usize) -> Result<TriMesh, BenchError> {
    if pattern != "equilateral" {
        return mesh_of(pattern, cells);
    }
    let rows = (cells as Real / 0.75_f64.sqrt()).round() as usize;
    let lattice = cloth_core::mesh::generate::equilateral(cells + 1, rows + 1, 1.0)?;
    let [wide, high] = [cells as Real + 0.5, rows as Real * 0.75_f64.sqrt()];
    let place = |p: &Vec3| Vec3::new(p.x / wide, p.y / high, 0.0);
    let positions = lattice.positions().iter().map(place).collect();
    TriMesh::new(positions, lattice.triangles().to_vec()).map_err(BenchError::failed)
}
