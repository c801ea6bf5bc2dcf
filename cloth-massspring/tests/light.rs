//! Implicit steps without the feature that factorises: they minimise the same function.

use cloth_core::cloth::{Cloth, ClothModel, Membrane};
use cloth_core::math::Vec3;
use cloth_core::measure::{center_of_mass, predict};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, irregular};
use cloth_core::method::linear::{LinearMethod, StoppingCriteria};
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

/// Whatever way a sheet buckles in, every step converges without a factorisation to fall back on.
#[test]
fn every_step_converges_without_a_factorisation() {
    let (mesh, model) = sheet();
    let mut solver = solver(&model, ImplicitConfig::default());
    let mut state = State::at_rest(mesh.positions().to_vec());
    for _ in 0..30 {
        let input = StepInput::new(1.0 / 60.0).gravity(DOWN);
        let report = solver.step(&mut state, input).unwrap();
        assert_eq!(
            (report.outcome, report.newton_fallbacks),
            (Outcome::Converged, 0)
        );
    }
}

/// Where all springs are stretched there is one minimum, and the change of velocity is as near to that of it as the
/// tolerance says.
#[test]
fn the_tolerance_bounds_the_error() {
    let (mesh, model) = sheet();
    let stretched = State::at_rest(mesh.positions().iter().map(|x| x * 1.2).collect());
    let input = || StepInput::new(1e-3).gravity(DOWN);
    let at = |tolerance| {
        let config = ImplicitConfig {
            tolerance,
            ..ImplicitConfig::default()
        };
        let mut state = stretched.clone();
        let report = solver(&model, config).step(&mut state, input()).unwrap();
        assert_eq!(report.outcome, Outcome::Converged);
        state.positions
    };
    let distance = |a: &[Vec3], b: &[Vec3]| -> f64 {
        let displacements = a.iter().zip(b).zip(model.particles.mass());
        displacements
            .map(|((a, b), m)| m * (a - b).norm_squared())
            .sum::<f64>()
            .sqrt()
    };
    let mut predicted = mesh.positions().to_vec();
    predict(&model.particles, &stretched, &input(), &mut predicted);
    let exact = at(1e-9);
    let way = distance(&exact, &predicted);
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-6] {
        let error = distance(&at(tolerance), &exact) / way;
        println!("{tolerance:e}: {error:e}");
        assert!(error < tolerance, "{tolerance:e}: {error:e}");
    }
}

fn solver(model: &ClothModel, config: ImplicitConfig) -> ImplicitEuler {
    let builder = ImplicitEuler::builder(&model.particles).config(config);
    let builder = builder.energy(model.springs.clone());
    let builder = builder.energy(model.hinges.clone());
    builder.build().unwrap()
}

/// Springs of 10¹⁰ N/m in steps of 0.1 s: where Newton's method by multigrid fails as a fallback, too, the step ends
/// unconverged, and the cloth goes on falling.
#[test]
fn a_fallback_that_fails_is_no_error() {
    let mesh = grid(6, 6, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e10),
        bending_rigidity: 1e-5,
    };
    let mut model = cloth.on(&mesh).unwrap();
    for corner in [6 * 5, 6 * 6 - 1] {
        model.particles.prescribe(corner).unwrap();
    }
    let config = ImplicitConfig {
        tolerance: 1e-6,
        linear: LinearMethod::Multigrid(StoppingCriteria::default()),
        ..ImplicitConfig::default()
    };
    let mut solver = solver(&model, config);
    let mut state = State::at_rest(mesh.positions().to_vec());
    let (mut before, mut failures) = (0.0, 0);
    for _ in 0..4 {
        let input = StepInput::new(0.1).gravity(DOWN);
        let report = solver.step(&mut state, input).unwrap();
        let is_spent = report.outcome == Outcome::BudgetSpent;
        failures += u32::from(is_spent && report.newton_fallbacks > 0);
        let fall = -center_of_mass(&model.particles, &state.positions).z;
        assert!(fall > before, "{fall} m after {before} m");
        before = fall;
    }
    assert!(failures > 0, "no step has ended unconverged");
}

/// Newton's method by multigrid, and the quasi-Newton method, end in the same minimum where there is one only: all
/// springs stretched.
#[test]
fn newton_by_multigrid_finds_the_same_minimum() {
    let (mesh, model) = sheet();
    let stretched: Vec<Vec3> = mesh.positions().iter().map(|x| x * 1.2).collect();
    let end = |solve| {
        let config = ImplicitConfig {
            solve,
            tolerance: 1e-9,
            linear: LinearMethod::Multigrid(StoppingCriteria::default()),
            ..ImplicitConfig::default()
        };
        let mut solver = solver(&model, config);
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
