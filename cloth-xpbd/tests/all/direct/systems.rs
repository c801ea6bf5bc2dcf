//! What the four linear systems cost: numbers in the factor, iterations of a step, Krylov iterations in them.

use crate::direct::SYSTEMS;
use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::energy::Spring;
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::direct::{DirectConfig, DirectXpbd, System};

/// Numbers stored in the factor, iterations, and solves with it or Krylov iterations, of the first step.
fn cost(mut solver: DirectXpbd, mut state: State) -> (usize, u32, u32) {
    let input = StepInput::new(1.0 / 60.0).gravity(Vec3::z() * -9.81);
    let report = solver.step(&mut state, input).unwrap();
    assert!(report.linear_solves >= report.iterations);
    match solver.factor_len() {
        0 => assert!(report.linear_iterations > 10 * report.linear_solves),
        _ => assert_eq!(report.linear_iterations, report.linear_solves),
    }
    (
        solver.factor_len(),
        report.iterations,
        report.linear_iterations,
    )
}

fn config(system: System) -> DirectConfig {
    DirectConfig {
        system,
        tolerance: 1e-6,
        ..DirectConfig::default()
    }
}

/// A hundred rigid links of 10 g a vertex and 1 m in all, with a tip of `ratio` times that, hanging, or turning
/// about its end at `spin` (rad/s).
fn chain(system: System, spin: f64, ratio: f64) -> (usize, u32, u32) {
    let mut mass = vec![0.01; 101];
    mass[100] *= ratio;
    let mut particles = Particles::new(mass).unwrap();
    particles.prescribe(0).unwrap();
    let positions: Vec<Vec3> = (0..101).map(|i| Vec3::z() * -0.01 * f64::from(i)).collect();
    let ends: Vec<[u32; 2]> = (0..100).map(|i| [i, i + 1]).collect();
    let links = Spring::along(&positions, &ends, f64::INFINITY);
    let builder = DirectXpbd::builder(&particles).energy(links);
    let mut state = State::at_rest(positions);
    let solver = builder.config(config(system)).build().unwrap();
    for (x, v) in state.positions.iter().zip(&mut state.velocities) {
        v.x = -spin * x.z;
    }
    cost(solver, state)
}

/// A sheet of 17 × 17 vertices and 1 m, held by two corners.
fn sheet(system: System) -> (usize, u32, u32) {
    let mesh = grid(17, 17, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e4),
        bending_rigidity: 1e-5,
    };
    let mut model = cloth.on(&mesh).unwrap();
    model.particles.prescribe(0).unwrap();
    model.particles.prescribe(16).unwrap();
    let builder = DirectXpbd::builder(&model.particles).energy(model.springs.clone());
    let builder = builder.energy(model.hinges.clone());
    let solver = builder.config(config(system)).build().unwrap();
    cost(solver, State::at_rest(mesh.positions().to_vec()))
}

/// Factor, iterations and solves: hanging chain with a heavy tip, turning chain with and without it, sheet.
const TABLE: [[(usize, u32, u32); 4]; 4] = [
    [(7429, 2, 7), (7429, 9, 45), (7429, 6, 16), (94_973, 5, 15)],
    [(0, 2, 421), (0, 9, 10_145), (0, 6, 3178), (0, 5, 7093)],
    [
        (1642, 2, 7),
        (1642, 14, 53),
        (1642, 49, 99),
        (684_155, 10, 30),
    ],
    [(0, 2, 204), (0, 14, 1752), (0, 49, 4900), (0, 10, 6714)],
];

#[test]
fn costs_of_the_four_systems_are_those_of_the_table() {
    for (system, expected) in SYSTEMS.into_iter().zip(TABLE) {
        let found = [
            chain(system, 0.0, 1000.0),
            chain(system, 3.0, 1000.0),
            chain(system, 3.0, 1.0),
            sheet(system),
        ];
        println!("{system:?} {found:?}");
        for (found, expected) in found.into_iter().zip(expected) {
            assert_eq!(found.0, expected.0, "{system:?}");
            assert_eq!(found.1, expected.1, "{system:?}");
            // Krylov iterations depend on the last digits.
            assert!(
                found.2.abs_diff(expected.2) <= expected.2 / 50,
                "{system:?}: {found:?}"
            );
        }
    }
}
