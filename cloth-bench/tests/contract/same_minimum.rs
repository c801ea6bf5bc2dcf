//! Projective dynamics and Newton's method, both converged, take the same step of implicit Euler.

use cloth_core::element::{Energy, Projective};
use cloth_core::energy::{
    ArapTriangle, Attachment, CurvatureHinge, CurvedHinge, Spring, StrainLimitSpring,
    StrainLimitTriangle,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Outcome, StepInput, Stepper};
use cloth_core::topology::{EdgeTable, HingeTable};
use cloth_massspring::{ImplicitConfig, ImplicitEuler};
use cloth_pd::{Acceleration, PdConfig, PdSolver};

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);

/// A sheet bent into a bowl, held at two corners, and moving. (Where a rest shape is flat, hinges of a curved one have
/// two sides to fall to, and the minimum is not unique.)
fn sheet() -> (TriMesh, Particles, State) {
    let flat = grid(9, 9, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let bowl = |x: &Vec3| Vec3::new(x.x, x.y, 0.4 * x.x * x.x + 0.3 * x.y * x.y);
    let positions = flat.positions().iter().map(bowl).collect();
    let mesh = TriMesh::new(positions, flat.triangles().to_vec()).unwrap();
    let mut particles = Particles::from_areal_density(&mesh, 0.2).unwrap();
    particles.prescribe(72).unwrap();
    particles.prescribe(80).unwrap();
    let mut state = State::at_rest(mesh.positions().to_vec());
    for (x, v) in mesh.positions().iter().zip(&mut state.velocities) {
        *v = Vec3::new(0.3 * x.y, -0.5, 0.2 * (2.0 * x.x).cos());
    }
    (state.velocities[72], state.velocities[80]) = (Vec3::zeros(), Vec3::new(0.1, 0.0, 0.2));
    (mesh, particles, state)
}

/// Largest distance (m) after three steps of both.
fn apart<const N: usize, const K: usize, E: Energy<N> + Projective<N, K>>(
    elements: &[E],
    springs: &[Spring],
) -> Real {
    let (mesh, particles, start) = sheet();
    let mut newton = ImplicitEuler::builder(&particles)
        .energy(elements.to_vec())
        .energy(springs.to_vec())
        .config(ImplicitConfig::reference())
        .build()
        .unwrap();
    let mut worst: Real = 0.0;
    for acceleration in [
        Acceleration::QuasiNewton { history: 10 },
        Acceleration::Chebyshev {
            spectral_radius: None,
        },
    ] {
        let config = PdConfig {
            iterations: Some(200_000),
            tolerance: Some(1e-12),
            acceleration,
            ..PdConfig::default()
        };
        let mut projective = PdSolver::builder(&particles)
            .energy(elements.to_vec())
            .energy(springs.to_vec())
            .coarse_grid(mesh.positions(), 4)
            .config(config)
            .build()
            .unwrap();
        let mut state = start.clone();
        for _ in 0..3 {
            let mut expected = state.clone();
            let input = || StepInput::new(1.0 / 60.0).gravity(GRAVITY);
            newton.step(&mut expected, input()).unwrap();
            let report = projective.step(&mut state, input()).unwrap();
            assert_eq!(report.outcome, Outcome::Converged, "{report:?}");
            for (a, b) in state.positions.iter().zip(&expected.positions) {
                worst = worst.max((a - b).norm());
            }
        }
    }
    worst
}

#[test]
fn converged_projective_dynamics_is_converged_newton() {
    let (mesh, _, _) = sheet();
    let edges = EdgeTable::build(&mesh).unwrap();
    let hinges = HingeTable::build(&mesh, &edges);
    let springs = Spring::along(mesh.positions(), edges.ends(), 100.0);
    let ties: Vec<Attachment> = (0..20)
        .map(|i| Attachment {
            vertex: 4 * i,
            target: mesh.positions()[4 * i as usize] * 1.05, // pulled apart: springs pushed together have many minima
            stiffness: 20.0,
        })
        .collect();
    let along = |limits| StrainLimitSpring::along(mesh.positions(), edges.ends(), limits, 500.0);
    let soft = Spring::along(mesh.positions(), edges.ends(), 20.0);
    let cases = [
        ("springs", apart(&springs, &[])),
        (
            "quadratic bending",
            apart(&CurvatureHinge::across(&mesh, &hinges, 0.01), &springs),
        ),
        (
            "curved bending",
            apart(&CurvedHinge::across(&mesh, &hinges, 0.01), &springs),
        ),
        (
            "arap triangles",
            apart(&ArapTriangle::on(&mesh, 100.0), &[]),
        ),
        ("attachments", apart(&ties, &springs)),
        ("limited springs", apart(&along([0.99, 1.01]), &soft)),
        (
            "limited triangles",
            apart(&StrainLimitTriangle::on(&mesh, [0.99, 1.01], 500.0), &soft),
        ),
    ];
    for (name, distance) in cases {
        assert!(distance < 1e-9, "{name}: {distance:e} m");
    }
}
