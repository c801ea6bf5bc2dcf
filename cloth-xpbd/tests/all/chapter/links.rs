//! Rigid links, joints and cloth in one scene.

use crate::chapter::{GRAVITY, iterations};
use cloth_core::check;
use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::element::Constraint;
use cloth_core::energy::{CurvatureHinge, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{angular_momentum, center_of_mass, linear_momentum};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::links::{DistanceLimit, Joint, rigid_links};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

const SIDE: usize = 5;
const LINKS: u32 = 4;

/// A cloth of 5 × 5 vertices, a chain of four rigid links at each of two corners, with heavy ends, tied to the
/// cloth by ball joints.
struct Scene {
    particles: Particles,
    springs: Vec<Spring>,
    hinges: Vec<CurvatureHinge>,
    links: Vec<Spring>,
    joints: Vec<Joint>,
    positions: Vec<Vec3>,
}

fn scene() -> Scene {
    let mesh = grid(SIDE, SIDE, 0.4, 0.4, Diagonals::Alternating).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(500.0),
        bending_rigidity: 1e-5,
    };
    let model = cloth.on(&mesh).unwrap();
    let mut mass = model.particles.mass().to_vec();
    let mut positions = mesh.positions().to_vec();
    let (mut ends, mut joints) = (Vec::new(), Vec::new());
    for corner in [0, SIDE - 1] {
        let first = positions.len() as u32;
        joints.push(Joint {
            vertices: [corner as u32, first],
            stiffness: Real::INFINITY,
        });
        for i in 0..=LINKS {
            positions.push(mesh.positions()[corner] + Vec3::new(0.0, -0.05 * Real::from(i), 0.0));
            mass.push(if i == LINKS { 0.5 } else { 0.01 });
        }
        ends.extend((first..first + LINKS).map(|i| [i, i + 1]));
    }
    Scene {
        particles: Particles::new(mass).unwrap(),
        springs: model.springs,
        hinges: model.hinges,
        links: rigid_links(&positions, &ends),
        joints,
        positions,
    }
}

impl Scene {
    fn solver(&self, config: XpbdConfig) -> XpbdSolver {
        XpbdSolver::builder(&self.particles)
            .energy(self.springs.clone())
            .energy(self.hinges.clone())
            .energy(self.links.clone())
            .energy(self.joints.clone())
            .config(config)
            .build()
            .unwrap()
    }

    /// Largest error of a link (m), and largest gap of a joint (m).
    fn errors(&self, x: &[Vec3]) -> (Real, Real) {
        let between = |v: [u32; 2]| (x[v[0] as usize] - x[v[1] as usize]).norm();
        let links = self.links.iter();
        let links = links.map(|l| (between(l.vertices) - l.rest_length).abs());
        let joints = self.joints.iter().map(|j| between(j.vertices));
        (links.fold(0.0, Real::max), joints.fold(0.0, Real::max))
    }
}

#[test]
fn links_and_joints_are_met_to_round_off_and_free_flight_keeps_momentum() {
    let scene = scene();
    let mut solver = scene.solver(iterations(6000));
    let mut state = State::at_rest(scene.positions.clone());
    for (v, velocity) in state.velocities.iter_mut().enumerate() {
        let x = scene.positions[v];
        *velocity =
            Vec3::new(0.1, 0.2, 0.3) + Vec3::new(3.0, -2.0, 4.0).cross(&x) + x * (x.x * 2.0);
    }
    let before = linear_momentum(&scene.particles, &state.velocities);
    let center = center_of_mass(&scene.particles, &state.positions);
    let turning = angular_momentum(&scene.particles, &state);
    let (h, steps) = (1.0 / 240.0, 20);
    for _ in 0..steps {
        solver.step(&mut state, StepInput::new(h)).unwrap();
        let (link, joint) = scene.errors(&state.positions);
        assert!(link < 1e-15 && joint < 1e-14, "{link:e} {joint:e}");
    }
    let after = linear_momentum(&scene.particles, &state.velocities);
    assert!((after - before).norm() < 1e-12);
    let mass: Real = scene.particles.mass().iter().sum();
    let moved = center_of_mass(&scene.particles, &state.positions) - center;
    assert!((moved - before * (h * Real::from(steps) / mass)).norm() < 1e-13);
    // Of first order in h.
    let lost = (angular_momentum(&scene.particles, &state) - turning).norm() / turning.norm();
    assert!(lost < 0.05, "{lost}");
}

/// A free link of 1 m that turns at ω: `1/√(1 + (ωh)²)` in the first substep, with velocities across it, and in a later
/// one `1/√(5 − 4 cos φ)`, φ the angle by which it turned in the one before.
#[test]
fn a_free_link_loses_the_angular_momentum_of_the_law() {
    let particles = Particles::new(vec![0.3, 0.7]).unwrap();
    let link = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: Real::INFINITY,
    };
    let builder = XpbdSolver::builder(&particles).energy(vec![link]);
    let mut solver = builder.config(iterations(1)).build().unwrap();
    let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x()]);
    let (h, turning): (Real, Real) = (0.05, 3.0);
    // Its centre of mass rests.
    state.velocities[0].y = -0.7 * turning;
    state.velocities[1].y = 0.3 * turning;
    let mut law = 1.0 / (1.0 + (turning * h).powi(2)).sqrt();
    for step in 0..20 {
        let link = |state: &State| state.positions[1] - state.positions[0];
        let (before, from) = (angular_momentum(&particles, &state), link(&state));
        solver.step(&mut state, StepInput::new(h)).unwrap();
        let kept = angular_momentum(&particles, &state).norm() / before.norm();
        assert!((kept / law - 1.0).abs() < 1e-12, "{step}: {kept} {law}");
        law = 1.0 / (5.0 - 4.0 * from.dot(&link(&state))).sqrt();
    }
}

#[test]
fn a_cloth_that_hangs_by_chains_pulls_at_their_pins_with_all_the_weight() {
    let mut scene = scene();
    let ends = [
        SIDE * SIDE + LINKS as usize,
        SIDE * SIDE + 2 * LINKS as usize + 1,
    ];
    for end in ends {
        scene.particles.prescribe(end).unwrap();
    }
    // The chains lead upwards.
    for x in &mut scene.positions {
        *x = Vec3::new(x.x, 0.0, -x.y);
    }
    let config = XpbdConfig {
        substeps: 40,
        damping: 0.01,
        ..iterations(10)
    };
    let mut solver = scene.solver(config);
    let mut state = State::at_rest(scene.positions.clone());
    for _ in 0..1200 {
        let input = StepInput::new(1.0 / 60.0).gravity(GRAVITY);
        solver.step(&mut state, input).unwrap();
    }
    let mut forces = vec![Vec3::zeros(); scene.particles.len()];
    solver.vertex_forces_into(&mut forces);
    let free = (0..scene.particles.len()).filter(|v| !ends.contains(v));
    let weight: Real = free.map(|v| 9.81 * scene.particles.mass()[v]).sum();
    let supports = forces[ends[0]] + forces[ends[1]];
    let error = (supports + Vec3::new(0.0, 0.0, weight)).norm() / weight;
    assert!(error < 1e-4, "{error:e}");
    let (link, joint) = scene.errors(&state.positions);
    assert!(link < 1e-6 && joint < 1e-6, "{link:e} {joint:e} m");
}

/// An arm of two links, bent, the lower one thrown upwards; the angle at the elbow stays at least 60°.
#[test]
fn a_limit_stops_an_elbow_and_does_nothing_before() {
    let particles = {
        let mut particles = Particles::new(vec![0.1; 3]).unwrap();
        particles.prescribe(0).unwrap();
        particles
    };
    let positions = [
        Vec3::zeros(),
        Vec3::new(0.0, 0.0, -1.0),
        Vec3::new(1.0, 0.0, -1.0),
    ];
    let run = |limit: Option<DistanceLimit>| {
        let builder = XpbdSolver::builder(&particles)
            .energy(rigid_links(&positions, &[[0, 1], [1, 2]]))
            .energy(limit.into_iter().collect());
        let mut solver = builder.config(iterations(200)).build().unwrap();
        let mut state = State::at_rest(positions.to_vec());
        state.velocities[2].z = 12.0;
        let mut nearest = Vec::new();
        for _ in 0..150 {
            solver.step(&mut state, StepInput::new(2e-3)).unwrap();
            nearest.push((state.positions[2] - state.positions[0]).norm());
        }
        nearest
    };
    let limit = DistanceLimit {
        vertices: [0, 2],
        shortest: 1.0,
        longest: 5.0,
        stiffness: Real::INFINITY,
    };
    let (free, limited) = (run(None), run(Some(limit)));
    let first = free.iter().position(|&l| l < 1.0).unwrap();
    assert!(free.iter().copied().fold(2.0, Real::min) < 0.9);
    assert_eq!(free[..first], limited[..first]);
    let nearest = limited.iter().copied().fold(2.0, Real::min);
    assert!(nearest > 1.0 - 1e-12, "{nearest}");
    assert!(limited[first..first + 5].iter().all(|&l| l < 1.01));
}

#[test]
fn the_derivatives_of_joints_and_limits_are_right() {
    let x = [Vec3::new(0.1, 0.3, -0.2), Vec3::new(0.7, -0.4, 0.5)];
    let joint = Joint {
        vertices: [0, 1],
        stiffness: 7.0,
    };
    assert!(check::gradient_error(&joint, &x, 1.0) < 1e-8);
    assert!(check::hessian_error(&joint, &x, 1.0) < 1e-8);
    let length = (x[0] - x[1]).norm();
    for (shortest, longest) in [(0.0, 0.8 * length), (1.3 * length, 9.0)] {
        let limit = DistanceLimit {
            vertices: [0, 1],
            shortest,
            longest,
            stiffness: 7.0,
        };
        assert!(check::gradient_error(&limit, &x, 1.0) < 1e-8);
        assert!(check::hessian_error(&limit, &x, 1.0) < 1e-8);
    }
    let idle = DistanceLimit {
        vertices: [0, 1],
        shortest: 0.5 * length,
        longest: 2.0 * length,
        stiffness: Real::INFINITY,
    };
    let [row] = idle.rows(&x);
    assert_eq!((row.value, row.gradient), (0.0, [Vec3::zeros(); 2]));
}
