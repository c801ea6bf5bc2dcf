//! Area and volume under XPBD: where its sweeps converge, `C + α̃λ = 0`, and one that is linear in what can
//! move ends where implicit Euler does.

use cloth_core::element::Constraint;
use cloth_core::energy::{AreaTriangle, VolumeTetrahedron};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::linear_momentum;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

const REST: [Vec3; 4] = [
    Vec3::new(0.1, 0.2, 0.3),
    Vec3::new(1.3, 0.1, -0.2),
    Vec3::new(0.5, 0.9, 0.1),
    Vec3::new(0.6, -0.7, 0.4),
];

fn check<const N: usize, E: Constraint<N>>(element: E, off: Vec3, hard: E) {
    let mut particles = Particles::new(vec![0.3, 0.1, 0.4, 0.2]).unwrap();
    let mut start = State::at_rest(REST.to_vec());
    start.positions[N - 1] += off;
    let config = XpbdConfig {
        iterations: 60,
        substeps: 1,
        ..XpbdConfig::default()
    };
    let solve = |particles: &Particles, element: E, h: Real| {
        let builder = XpbdSolver::builder(particles).energy(vec![element]);
        let mut solver = builder.config(config).build().unwrap();
        let mut state = start.clone();
        solver.step(&mut state, StepInput::new(h)).unwrap();
        let residual = solver.compliance_residual(&state.positions);
        assert!(residual < 1e-14, "{element:?}: {residual:e}");
        state
    };
    let value = |state: &State| {
        let x = std::array::from_fn(|i| state.positions[i]);
        element.rows(&x).as_ref()[0]
    };
    for h in [0.01, 0.3] {
        let state = solve(&particles, element, h);
        assert!(linear_momentum(&particles, &state.velocities).norm() < 1e-14);
    }
    assert!(value(&solve(&particles, hard, 0.01)).value.abs() < 1e-14);
    // All held but one vertex.
    (0..4)
        .filter(|&v| v != N - 1)
        .for_each(|v| particles.prescribe(v).unwrap());
    let before = value(&start);
    let weight = particles.inverse_mass()[N - 1] * before.gradient[N - 1].norm_squared();
    for h in [0.01, 0.3] {
        let law = before.value / (1.0 + before.stiffness * h * h * weight);
        let error = (value(&solve(&particles, element, h)).value / law - 1.0).abs();
        assert!(error < 1e-12, "{element:?}: {error:e}");
    }
}

#[test]
fn area_and_volume_end_where_their_compliance_says() {
    let triangle = [REST[0], REST[1], REST[2]];
    let in_plane = (REST[2] - REST[0]) * 0.4;
    let area = |modulus| AreaTriangle::new([0, 1, 2], &triangle, modulus);
    check(area(30.0), in_plane, area(Real::INFINITY));
    let volume = |modulus| VolumeTetrahedron::new([0, 1, 2, 3], &REST, modulus);
    check(
        volume(30.0),
        Vec3::new(0.3, -0.1, 0.2),
        volume(Real::INFINITY),
    );
}
