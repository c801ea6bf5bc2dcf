//! A sheet in states that make no sense, for the tests of both solvers.

use cloth_core::energy::{CurvatureHinge, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::{Particles, State};
use cloth_core::topology::{EdgeTable, HingeTable};

const SIDE: usize = 6;

/// Deterministic numbers in (−1, 1).
fn noise(index: usize) -> Vec3 {
    Vec3::from_fn(|axis, _| {
        let t = (3 * index + axis) as Real * 0.754_877_666 + 0.17;
        2.0 * t.fract() - 1.0
    })
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Start {
    Random,
    Flattened,
    Collapsed,
    Mirrored,
}

pub(crate) const STARTS: [Start; 4] = [
    Start::Random,
    Start::Flattened,
    Start::Collapsed,
    Start::Mirrored,
];

pub(crate) struct Sheet {
    mesh: TriMesh,
    pub(crate) particles: Particles,
    pub(crate) springs: Vec<Spring>,
    pub(crate) hinges: Vec<CurvatureHinge>,
}

/// 1 m × 1 m with two corners held; every second spring is `ratio` times as stiff, and every third vertex
/// `mass` times as heavy.
pub(crate) fn sheet(stiffness: Real, ratio: Real, mass: Real) -> Sheet {
    let mesh = grid(SIDE, SIDE, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let masses = (0..mesh.vertex_count()).map(|v| if v % 3 == 0 { 0.01 * mass } else { 0.01 });
    let mut particles = Particles::new(masses.collect()).unwrap();
    particles.prescribe(0).unwrap();
    particles.prescribe(SIDE - 1).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    let mut springs = Spring::along(mesh.positions(), edges.ends(), stiffness);
    for spring in springs.iter_mut().step_by(2) {
        spring.stiffness *= ratio;
    }
    let hinges = HingeTable::build(&mesh, &edges);
    Sheet {
        hinges: CurvatureHinge::across(&mesh, &hinges, 1e-4),
        mesh,
        particles,
        springs,
    }
}

impl Sheet {
    /// Straight down from the held corners, nothing stretched, at rest.
    pub(crate) fn hanging(&self) -> State {
        let down = |x: &Vec3| Vec3::new(x.x, -x.y, x.z);
        State::at_rest(self.mesh.positions().iter().map(down).collect())
    }

    /// Free vertices moved to a bad place, with a jitter that depends on `run`.
    pub(crate) fn start(&self, kind: Start, run: usize) -> State {
        let mut positions = self.mesh.positions().to_vec();
        for (vertex, x) in positions.iter_mut().enumerate() {
            let jitter = noise(1000 * run + vertex);
            if !self.particles.is_prescribed(vertex) {
                *x = match kind {
                    Start::Random => jitter,
                    // Into the line through the held corners; exactly in a plane it would stay there, folded.
                    Start::Flattened => Vec3::new(x.x + 1e-3 * jitter.x, 0.0, 1e-6 * jitter.z),
                    // Onto one point, exactly; the point differs.
                    Start::Collapsed => noise(run),
                    // Turned inside out through the held corners, and almost flat.
                    Start::Mirrored => Vec3::new(1.0 - x.x, -x.y, 1e-6 * jitter.z),
                };
            }
        }
        State::at_rest(positions)
    }
}
