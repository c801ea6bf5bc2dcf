//! Every kind of constraint under PBD: the law of one constraint where a row is linear in what can move, and
//! convergence to `C = 0` where it is not.

use crate::chain::Chain;

use cloth_core::element::{Constraint, Element, Row, RowArray};
use cloth_core::energy::{
    ArapTriangle, AreaTriangle, Attachment, CurvatureHinge, CurvedHinge, DihedralHinge, HingeLaw,
    Spring, StvkTriangle, VolumeTetrahedron,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{center_of_mass, linear_momentum};
use cloth_core::method::position_based::Sweep;
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

/// The gradients of the table, with the directions of the normals and of the edge; which side is up.
#[test]
fn the_gradients_are_those_of_the_chapter() {
    let hinge = |rest_angle| DihedralHinge {
        vertices: [0, 1, 2, 3],
        rest_angle,
        stiffness: 1.0,
        law: HingeLaw::Angle,
    };
    let folded = |angle: Real| {
        let tip = Vec3::new(0.3, -0.7 * angle.cos(), 0.7 * angle.sin());
        [Vec3::zeros(), Vec3::x(), Vec3::new(0.4, 0.8, 0.0), tip]
    };
    for angle in [-3.0, -1.0, 0.0, 1e-3, 1.0, 3.0] {
        let x = folded(angle);
        let row = hinge(0.0).rows(&x)[0];
        assert!((row.value + angle).abs() < 1e-14, "{angle}: {}", row.value);
        let e = x[1] - x[0];
        let normals = [e.cross(&(x[2] - x[0])), (x[3] - x[0]).cross(&e)];
        let [g2, g3] = normals.map(|n| -n * (e.norm() / n.norm_squared()));
        let t = |i: usize| (x[i] - x[0]).dot(&e) / e.norm_squared();
        let g1 = -g2 * t(2) - g3 * t(3);
        for (found, law) in row.gradient.iter().zip([-g1 - g2 - g3, g1, g2, g3]) {
            assert!((found - law).norm() < 1e-14, "{angle}");
        }
    }
    // More than half a turn from the rest angle: the other way.
    let far = hinge(0.4).rows(&folded(3.0))[0].value;
    assert!((far - (2.0 * std::f64::consts::PI - 3.4)).abs() < 1e-14);
    // A triangle without area: no row.
    let mut flat = folded(0.3);
    flat[2].y = 0.0;
    assert!(
        hinge(0.0).rows(&flat)[0]
            .gradient
            .iter()
            .all(|g| *g == Vec3::zeros())
    );

    let row = AreaTriangle::new([0, 1, 2], &TRIANGLE, 1.0).rows(&TRIANGLE)[0];
    let [a, b, c] = TRIANGLE;
    let n = (b - a).cross(&(c - a)).normalize();
    for (found, edge) in row.gradient.iter().zip([c - b, a - c, b - a]) {
        assert!((found - n.cross(&edge) * 0.5).norm() < 1e-15);
    }
}

/// Of slivers the correction is small, not the gradient.
#[test]
fn a_hinge_with_a_sliver_moves_by_about_its_height() {
    for height in [1e-2, 1e-4, 1e-6] {
        let mut start = REST.to_vec();
        start[2] = (REST[0] + REST[1]) * 0.5 + Vec3::z() * height;
        let mut state = State::at_rest(start.clone());
        let hinge = DihedralHinge {
            vertices: [0, 1, 2, 3],
            rest_angle: 0.4,
            stiffness: 1.0,
            law: HingeLaw::Angle,
        };
        let rigid = StiffnessRule::Fixed(1.0);
        step(hinge, &masses(), &mut state, 1, rigid, 0.01);
        for (x, from) in state.positions.iter().zip(&start) {
            assert!((x - from).norm() < 3.0 * height, "{height}");
        }
    }
}

#[test]
fn averaged_jacobi_keeps_the_momentum_of_unequal_vertices() {
    let ends = [[0, 1], [0, 2], [0, 3], [1, 2]];
    let builder = PbdSolver::builder(&masses()).energy(Spring::along(&REST, &ends, 1e4));
    let config = PbdConfig {
        sweep: Sweep::Jacobi,
        ..PbdConfig::default()
    };
    let mut solver = builder.config(config).build().unwrap();
    let mut state = State::at_rest(REST.map(|x| x * 1.5).to_vec());
    solver.step(&mut state, StepInput::new(0.01)).unwrap();
    let size: Real = state.velocities.iter().map(|v| v.norm()).sum();
    let momentum = linear_momentum(&masses(), &state.velocities).norm();
    assert!(size > 1.0 && momentum < 1e-13 * size, "{momentum:e} {size}");
}

/// `C = min(φ, 0)`, `φ = r − ‖x − p‖`: no further from the pin than the cloth reaches.
#[derive(Clone, Copy, Debug)]
struct LongRange {
    vertices: [u32; 2],
    reach: Real,
}

impl Element<2> for LongRange {
    fn vertices(&self) -> [u32; 2] {
        self.vertices
    }
}

impl Constraint<2> for LongRange {
    type Rows = [Row<2>; 1];

    fn rows(&self, [x, pin]: &[Vec3; 2]) -> [Row<2>; 1] {
        let (d, length) = (x - pin, (x - pin).norm());
        let n = if length > self.reach {
            d / -length
        } else {
            Vec3::zeros()
        };
        [Row {
            value: (self.reach - length).min(0.0),
            gradient: [n, -n],
            stiffness: Real::INFINITY,
        }]
    }
}

/// Hangs where it should after one sweep, where links alone sag by half a metre.
#[test]
fn a_long_range_attachment_added_last_holds_after_one_sweep() {
    let chain = Chain::new(20, 1.0);
    let sag = |attached: bool| {
        let config = PbdConfig {
            iterations: 1,
            sweep: Sweep::Sequential,
            stiffness: StiffnessRule::Fixed(1.0),
            ..PbdConfig::default()
        };
        let rest = chain.at_rest().positions;
        let reach = |i: u32| (rest[i as usize] - rest[0]).norm();
        let attach = |i| LongRange {
            vertices: [i, 0],
            reach: reach(i),
        };
        let mut builder = PbdSolver::builder(&chain.particles).energy(chain.springs.clone());
        if attached {
            builder = builder.energy((1..=20).map(attach).collect());
        }
        let mut solver = builder.config(config).build().unwrap();
        chain.sag_at_rest(&mut solver, 1.0 / 60.0, 2000)
    };
    assert!(sag(false) > 0.5);
    assert!(sag(true).abs() < 1e-12, "{}", sag(true));
}
