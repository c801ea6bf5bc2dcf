//! Every kind of constraint under PBD: the law of one constraint where a row is linear in what can move, and
//! convergence to `C = 0` where it is not.

use cloth_core::element::{Constraint, RowArray};
use cloth_core::energy::{
    ArapTriangle, AreaTriangle, Attachment, CurvatureHinge, CurvedHinge, DihedralHinge, HingeLaw,
    Spring, StvkTriangle, VolumeTetrahedron,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{center_of_mass, linear_momentum};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_pbd::{PbdConfig, PbdSolver, StiffnessRule};

const REST: [Vec3; 4] = [
    Vec3::new(0.1, 0.2, 0.3),
    Vec3::new(1.3, 0.1, -0.2),
    Vec3::new(0.5, 0.9, 0.1),
    Vec3::new(0.6, -0.7, 0.4),
];

const TRIANGLE: [Vec3; 3] = [REST[0], REST[1], REST[2]];

fn masses() -> Particles {
    Particles::new(vec![0.3, 0.1, 0.4, 0.2]).unwrap()
}

fn step<const N: usize, E: Constraint<N>>(
    element: E,
    particles: &Particles,
    state: &mut State,
    iterations: u32,
    stiffness: StiffnessRule,
    h: Real,
) {
    let config = PbdConfig {
        iterations,
        stiffness,
        ..PbdConfig::default()
    };
    let builder = PbdSolver::builder(particles).energy(vec![element]);
    let mut solver = builder.config(config).build().unwrap();
    solver.step(state, StepInput::new(h)).unwrap();
}

fn value<const N: usize, E: Constraint<N>>(element: &E, state: &State) -> Real {
    let x = std::array::from_fn(|i| state.positions[i]);
    element.rows(&x).as_ref()[0].value
}

/// All vertices held but the last, which starts `off` (m) its place; then `C' = (1 − s)ⁿ C̃`, and
/// `C̃/(1 + k h² w̃)` for the material.
fn follows_the_law<const N: usize, E: Constraint<N>>(element: E, off: Vec3) {
    let mut particles = masses();
    (0..4)
        .filter(|&v| v != N - 1)
        .for_each(|v| particles.prescribe(v).unwrap());
    let mut start = State::at_rest(REST.to_vec());
    start.positions[N - 1] += off;
    let x = std::array::from_fn(|i| start.positions[i]);
    let rows = element.rows(&x);
    let row = rows.as_ref()[0];
    let weight = particles.inverse_mass()[N - 1] * row.gradient[N - 1].norm_squared();
    for n in [1, 3, 10] {
        for s in [0.05, 0.5, 0.9] {
            let mut state = start.clone();
            let rule = StiffnessRule::Fixed(s);
            step(element, &particles, &mut state, n, rule, 0.01);
            let error = value(&element, &state) - row.value * (1.0 - s).powi(n as i32);
            assert!(error.abs() < 1e-14, "{element:?} {n} {s}: {error:e}");
        }
        for h in [0.01, 0.2] {
            let mut state = start.clone();
            step(
                element,
                &particles,
                &mut state,
                n,
                StiffnessRule::Material,
                h,
            );
            let law = row.value / (1.0 + row.stiffness * h * h * weight);
            let error = (value(&element, &state) / law - 1.0).abs();
            assert!(error < 1e-10, "{element:?} {n} {h}: {error:e}");
        }
    }
}

#[test]
fn one_constraint_has_the_stiffness_of_the_law() {
    // Along the edge; in the plane, across the opposite edge; anywhere.
    let along = REST[1] - REST[0];
    let spring = Spring {
        vertices: [0, 1],
        rest_length: along.norm(),
        stiffness: 30.0,
    };
    follows_the_law(spring, along * 0.3);
    let in_plane = (REST[2] - REST[0]) * 0.4 + along * 0.1;
    follows_the_law(AreaTriangle::new([0, 1, 2], &TRIANGLE, 30.0), in_plane);
    let volume = VolumeTetrahedron::new([0, 1, 2, 3], &REST, 30.0);
    follows_the_law(volume, Vec3::new(0.3, -0.1, 0.2));
    follows_the_law(
        CurvatureHinge::new([0, 1, 2, 3], &REST, 2.0),
        Vec3::new(0.3, -0.1, 0.2),
    );
}

/// Every vertex free and pulled out of place: with s = 1 all rows go to zero, and neither momentum nor the
/// centre of mass notices.
fn is_met<const N: usize, E: Constraint<N>>(element: E) {
    let particles = masses();
    let mut state = State::at_rest(REST.to_vec());
    for (v, x) in state.positions.iter_mut().enumerate() {
        let t = v as Real;
        *x += Vec3::new((9.0 * t).sin(), (4.0 * t).cos(), (7.0 * t).sin()) * 0.15;
    }
    let before = center_of_mass(&particles, &state.positions);
    let rows = <E::Rows as RowArray<N>>::LEN as u32;
    let rigid = StiffnessRule::Fixed(1.0);
    step(element, &particles, &mut state, 60 * rows, rigid, 0.01);
    let x = std::array::from_fn(|i| state.positions[i]);
    for row in element.rows(&x).as_ref() {
        assert!(row.value.abs() < 1e-14, "{element:?}: {:e}", row.value);
    }
    let momentum = linear_momentum(&particles, &state.velocities).norm();
    assert!(momentum < 1e-13, "{element:?}: {momentum:e}");
    let moved = (center_of_mass(&particles, &state.positions) - before).norm();
    assert!(moved < 1e-14, "{element:?}: {moved:e}");
}

#[test]
fn every_kind_of_constraint_is_met_and_keeps_the_momentum() {
    is_met(Spring {
        vertices: [0, 1],
        rest_length: 0.7,
        stiffness: 1.0,
    });
    is_met(AreaTriangle::new([0, 1, 2], &TRIANGLE, 1.0));
    is_met(VolumeTetrahedron::new([0, 1, 2, 3], &REST, 1.0));
    is_met(CurvatureHinge::new([0, 1, 2, 3], &REST, 1.0));
    is_met(CurvedHinge::new([0, 1, 2, 3], &REST, 1.0));
    is_met(DihedralHinge {
        vertices: [0, 1, 2, 3],
        rest_angle: 0.4,
        stiffness: 1.0,
        law: HingeLaw::Angle,
    });
    is_met(ArapTriangle::new([0, 1, 2], &TRIANGLE, 1.0));
    is_met(StvkTriangle::new([0, 1, 2], &TRIANGLE, 1.0, 0.3));
}

#[test]
fn a_soft_pin_is_met() {
    let target = Vec3::new(3.0, 2.0, 1.0);
    let pin = Attachment {
        vertex: 2,
        target,
        stiffness: 1.0,
    };
    let mut state = State::at_rest(REST.to_vec());
    step(
        pin,
        &masses(),
        &mut state,
        1,
        StiffnessRule::Fixed(1.0),
        0.01,
    );
    assert!((state.positions[2] - target).norm() < 1e-15);
}

/// Zero area and zero volume: flattened shapes open again, shapes without a gradient stay as they are, and
/// nothing is ever not a number.
#[test]
fn degenerate_shapes_recover_or_stay() {
    let rigid = StiffnessRule::Fixed(1.0);
    let line = [0.0, 1.0, 3.0, 4.0]
        .map(|t| Vec3::new(t, 0.5 * t, 0.0))
        .to_vec();
    let flat = REST.map(|x| Vec3::new(x.x, x.y, 0.0)).to_vec();
    let point = vec![REST[0]; 4];
    let area = AreaTriangle::new([0, 1, 2], &TRIANGLE, 1.0);
    let volume = VolumeTetrahedron::new([0, 1, 2, 3], &REST, 1.0);
    for (start, opens, fills) in [
        (&line, true, false),
        (&flat, true, true),
        (&point, false, false),
    ] {
        let mut state = State::at_rest(start.clone());
        step(area, &masses(), &mut state, 50, rigid, 0.01);
        assert_eq!(state.first_non_finite(), None);
        let left = value(&area, &state).abs();
        assert_eq!(left < 1e-14, opens, "{left:e}");
        assert!(opens || state.positions == *start);
        let mut state = State::at_rest(start.clone());
        step(volume, &masses(), &mut state, 50, rigid, 0.01);
        assert_eq!(state.first_non_finite(), None);
        let left = value(&volume, &state).abs();
        assert_eq!(left < 1e-14, fills, "{left:e}");
        assert!(fills || state.positions == *start);
    }
    // Inside out.
    let mirrored = REST.map(|x| Vec3::new(x.x, x.y, -x.z)).to_vec();
    let mut state = State::at_rest(mirrored);
    step(volume, &masses(), &mut state, 50, rigid, 0.01);
    assert!(value(&volume, &state).abs() < 1e-14);
}
