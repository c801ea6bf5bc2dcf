//! The cloths of the tests.

use cloth_core::cloth::{Cloth, ClothModel, Membrane};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{IncrementalPotential, predict};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::State;
use cloth_core::step::StepInput;
use cloth_pd::{Acceleration, PdConfig, PdSolver};

pub(crate) const DT: Real = 1.0 / 60.0;
pub(crate) const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);

/// A step of [`DT`] under gravity.
pub(crate) fn falling<'a>() -> StepInput<'a> {
    StepInput::new(DT).gravity(GRAVITY)
}

/// A square sheet of 1 m and 0.2 kg/m², `n` vertices a side, with springs of stiffness `k` (N/m) and a little bending;
/// free, at rest.
pub(crate) fn sheet(n: usize, k: Real) -> (ClothModel, State) {
    sheets(
        &grid(n, n, 1.0, 1.0, Diagonals::Alternating).unwrap(),
        k,
        1e-3,
    )
}

/// The same of a mesh, with a bending rigidity (N·m).
pub(crate) fn sheets(mesh: &TriMesh, k: Real, rigidity: Real) -> (ClothModel, State) {
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(k),
        bending_rigidity: rigidity,
    };
    let state = State::at_rest(mesh.positions().to_vec());
    (cloth.on(mesh).unwrap(), state)
}

/// [`sheet`], held at two corners.
pub(crate) fn hanging(n: usize, k: Real) -> (ClothModel, State) {
    let (mut model, state) = sheet(n, k);
    model.particles.prescribe(n * (n - 1)).unwrap();
    model.particles.prescribe(n * n - 1).unwrap();
    (model, state)
}

pub(crate) fn solver(model: &ClothModel, config: PdConfig) -> PdSolver {
    PdSolver::builder(&model.particles)
        .energy(model.springs.clone())
        .energy(model.hinges.clone())
        .config(config)
        .build()
        .unwrap()
}

pub(crate) fn iterations(iterations: u32) -> PdConfig {
    PdConfig {
        iterations: Some(iterations),
        ..PdConfig::plain()
    }
}

pub(crate) fn to_tolerance(tolerance: Real) -> PdConfig {
    PdConfig {
        iterations: Some(100_000),
        tolerance: Some(tolerance),
        ..PdConfig::plain()
    }
}

/// The same settings with every acceleration.
pub(crate) fn accelerated(config: PdConfig) -> [PdConfig; 6] {
    let radius = |spectral_radius| Acceleration::Chebyshev { spectral_radius };
    let history = |history| Acceleration::QuasiNewton { history };
    [
        Acceleration::None,
        radius(None),
        radius(Some(0.95)),
        radius(Some(0.9999)),
        history(0),
        history(5),
    ]
    .map(|acceleration| PdConfig {
        acceleration,
        ..config
    })
}

/// A solver with a coarse grid of 10 cells over the rest positions `rest` (m).
pub(crate) fn coarse_solver(model: &ClothModel, rest: &[Vec3], config: PdConfig) -> PdSolver {
    PdSolver::builder(&model.particles)
        .energy(model.springs.clone())
        .energy(model.hinges.clone())
        .coarse_grid(rest, 10)
        .config(config)
        .build()
        .unwrap()
}

/// Numbers between −1 and 1 that repeat from run to run.
pub(crate) fn noise(count: usize) -> Vec<Vec3> {
    let mut bits = 0x9E37_79B9_7F4A_7C15_u64;
    let mut next = || {
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        (bits >> 11) as Real / (1_u64 << 52) as Real - 1.0
    };
    (0..count).map(|_| Vec3::from_fn(|_, _| next())).collect()
}

/// Moves every free vertex by up to `size` (m) in each direction.
pub(crate) fn shake(model: &ClothModel, state: &mut State, size: Real) {
    for (vertex, shift) in noise(state.positions.len()).into_iter().enumerate() {
        if !model.particles.is_prescribed(vertex) {
            state.positions[vertex] += shift * size;
        }
    }
}

/// `G` (J) at `x` and the norm of its gradient relative to that at x̃, for a step that starts at `before`; from the
/// energies, without the solver.
pub(crate) fn potential(
    model: &ClothModel,
    before: &State,
    input: &StepInput<'_>,
    x: &[Vec3],
) -> (Real, Real) {
    let mut predicted = before.positions.clone();
    predict(&model.particles, before, input, &mut predicted);
    let potential = IncrementalPotential {
        particles: &model.particles,
        energies: &model.energies().unwrap(),
        predicted: &predicted,
        dt: input.dt,
    };
    let mut gradient = x.to_vec();
    potential.gradient_into(&predicted, &mut gradient);
    let reference = potential.gradient_norm(&gradient);
    potential.gradient_into(x, &mut gradient);
    (
        potential.value(x),
        potential.gradient_norm(&gradient) / reference,
    )
}

/// Largest distance (m) between two sets of positions, or difference (m/s) of velocities.
pub(crate) fn distance(a: &[Vec3], b: &[Vec3]) -> Real {
    assert_eq!(a.len(), b.len());
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, Real::max)
}
