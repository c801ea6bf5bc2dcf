//! The direct solver.

use crate::counting_allocator;
use crate::sheet;
mod convergence;
mod degenerate;
mod forces;
mod limits;
mod robustness;
mod stable;
mod systems;

use crate::chain::Chain;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::State;
use cloth_xpbd::direct::{DirectConfig, DirectXpbd, System};

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);
pub(crate) const SYSTEMS: [System; 4] = [
    System::SaddleLdlt,
    System::SaddleMinres,
    System::SchurCholesky,
    System::SchurConjugateGradients,
];

fn with(system: System) -> DirectConfig {
    DirectConfig {
        system,
        ..DirectConfig::default()
    }
}

fn solver(chain: &Chain, config: DirectConfig) -> DirectXpbd {
    let builder = DirectXpbd::builder(&chain.particles).energy(chain.springs.clone());
    builder.config(config).build().unwrap()
}

/// A chain of ten links of 0.1 m and 0.1 kg, stretched out sideways; the links turn during a step, and with
/// them the gradients.
fn swinging(stiffness: Real) -> (Chain, State) {
    let chain = Chain::of(10, 0.1, 0.1, stiffness);
    let mut state = chain.at_rest();
    for x in &mut state.positions {
        *x = Vec3::new(-x.z, 0.0, 0.0);
    }
    for (x, v) in state.positions.iter().zip(&mut state.velocities) {
        v.z = -3.0 * x.x * x.x;
    }
    (chain, state)
}

fn largest_distance(a: &[Vec3], b: &[Vec3]) -> Real {
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, Real::max)
}
