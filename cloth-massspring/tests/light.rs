//! Implicit steps without the feature that factorises: they minimise the same function.

use cloth_core::cloth::{Cloth, ClothModel, Membrane};
use cloth_core::math::Vec3;
use cloth_core::measure::predict;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::irregular;
use cloth_core::particles::State;
use cloth_core::step::{Outcome, StepInput, Stepper};
use cloth_massspring::{ImplicitConfig, ImplicitEuler, Solve};

const DOWN: Vec3 = Vec3::new(0.0, 0.0, -9.81);

fn sheet() -> (TriMesh, ClothModel) {
    let mesh = irregular(25, 1.0, 1.0, 3).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e4),
        bending_rigidity: 1e-5,
    };
    let mut model = cloth.on(&mesh).unwrap();
    let last = mesh.vertex_count() - 1;
    for vertex in [0, last] {
        model.particles.prescribe(vertex).unwrap();
    }
    (mesh, model)
}

/// The default ends within its tolerance of the minimum, and the minimum is found to the last digit but two, without a factorisation to fall back on.
#[test]
fn every_step_converges_without_a_factorisation() {
    let (mesh, model) = sheet();
    let solver = |tolerance| {
        let config = ImplicitConfig {
            tolerance,
            ..ImplicitConfig::default()
        };
        let builder = ImplicitEuler::builder(&model.particles).config(config);
        let builder = builder.energy(model.springs.clone()).unwrap();
        builder
            .energy(model.hinges.clone())
            .unwrap()
            .build()
            .unwrap()
    };
    let tolerance = ImplicitConfig::default().tolerance;
    let mut coarse = solver(tolerance);
    let distance = |a: &[Vec3], b: &[Vec3]| -> f64 {
        let ways = a.iter().zip(b).zip(model.particles.mass());
        ways.map(|((a, b), m)| m * (a - b).norm_squared())
            .sum::<f64>()
            .sqrt()
    };
    let mut state = State::at_rest(mesh.positions().to_vec());
    for _ in 0..30 {
        let input = || StepInput::new(1.0 / 60.0).gravity(DOWN);
        let mut predicted = state.positions.clone();
        predict(&model.particles, &state, &input(), &mut predicted);
        let mut exact = state.clone();
        let report = coarse.step(&mut state, input()).unwrap();
        assert_eq!(
            (report.outcome, report.newton_fallbacks),
            (Outcome::Converged, 0)
        );
        let fine = solver(1e-7).step(&mut exact, input()).unwrap();
        assert_eq!(fine.outcome, Outcome::Converged);
        let error = distance(&state.positions, &exact.positions);
        let way = distance(&exact.positions, &predicted);
        assert!(error < 4.0 * tolerance * way, "{}", error / way);
    }
}

/// Newton's method by multigrid, and the quasi-Newton method, end in the same minimum where there is one only: all springs
/// stretched.
#[test]
fn newton_by_multigrid_finds_the_same_minimum() {
    let (mesh, model) = sheet();
    let stretched: Vec<Vec3> = mesh.positions().iter().map(|x| x * 1.2).collect();
    let end = |solve| {
        let config = ImplicitConfig {
            solve,
            tolerance: 1e-9,
            ..ImplicitConfig::default()
        };
        let mut solver = ImplicitEuler::builder(&model.particles)
            .energy(model.springs.clone())
            .and_then(|b| b.energy(model.hinges.clone()))
            .and_then(|b| b.config(config).build())
            .unwrap();
        let mut state = State::at_rest(stretched.clone());
        let report = solver
            .step(&mut state, StepInput::new(1e-3).gravity(DOWN))
            .unwrap();
        assert_eq!(report.outcome, Outcome::Converged);
        state.positions
    };
    let (a, b) = (end(Solve::QuasiNewton), end(Solve::Newton));
    let apart = a
        .iter()
        .zip(&b)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max);
    assert!(apart < 1e-10, "{apart:e} m");
}
