//! A banner that hangs by two chains of rigid links, with an arm of two links and a heavy hand at its lower
//! corner: hard constraints, joints and cloth in one scene, swept and solved directly.
//!
//! `cargo run --release -p cloth-xpbd --features direct --example rigid_links`

use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::energy::{CurvatureHinge, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::direct::{DirectConfig, DirectXpbd};
use cloth_xpbd::links::{DistanceLimit, Joint, rigid_links};
use cloth_xpbd::{XpbdConfig, XpbdSolver};
use std::error::Error;

const SIDE: usize = 9;
const LINKS: usize = 5;
const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);

struct Scene {
    particles: Particles,
    positions: Vec<Vec3>,
    springs: Vec<Spring>,
    hinges: Vec<CurvatureHinge>,
    links: Vec<Spring>,
    joints: Vec<Joint>,
    elbow: DistanceLimit,
    pins: [usize; 2],
}

fn scene() -> Result<Scene, Box<dyn Error>> {
    let mesh = grid(SIDE, SIDE, 0.8, 0.8, Diagonals::Alternating)?;
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e3),
        bending_rigidity: 1e-5,
    };
    let model = cloth.on(&mesh)?;
    let mut mass = model.particles.mass().to_vec();
    // Row 0 of the grid is the upper edge.
    let upright = |p: &Vec3| Vec3::new(p.x, 0.02 * (7.0 * p.y).sin(), -p.y);
    let mut positions: Vec<Vec3> = mesh.positions().iter().map(upright).collect();
    let (mut ends, mut joints, mut pins) = (Vec::new(), Vec::new(), [0; 2]);
    // From each corner a line of links, tied to it by a ball joint.
    let mut chain = |corner: usize, links: usize, step: Vec3, last: Real| {
        let first = positions.len();
        for i in 0..=links {
            positions.push(positions[corner] + step * i as Real);
            mass.push(if i == links { last } else { 0.02 });
        }
        ends.extend((first..first + links).map(|i| [i as u32, i as u32 + 1]));
        joints.push(Joint {
            vertices: [corner as u32, first as u32],
            stiffness: Real::INFINITY,
        });
        first + links
    };
    for (pin, corner) in pins.iter_mut().zip([0, SIDE - 1]) {
        *pin = chain(corner, LINKS, Vec3::new(0.0, 0.0, 0.06), 0.02);
    }
    let hand = chain(SIDE * SIDE - 1, 2, Vec3::new(0.25, 0.0, 0.0), 0.5) as u32;
    // The elbow stays open by 60° at least: links of equal length, so the hand keeps their length from the shoulder.
    let elbow = DistanceLimit {
        vertices: [hand - 2, hand],
        shortest: 0.25,
        longest: 0.5,
        stiffness: Real::INFINITY,
    };
    let links = rigid_links(&positions, &ends);
    let mut particles = Particles::new(mass)?;
    for pin in pins {
        particles.prescribe(pin)?;
    }
    Ok(Scene {
        particles,
        positions,
        springs: model.springs,
        hinges: model.hinges,
        links,
        joints,
        elbow,
        pins,
    })
}

impl Scene {
    /// Largest error of a link and largest gap of a joint (m).
    fn errors(&self, x: &[Vec3]) -> (Real, Real) {
        let between = |v: [u32; 2]| (x[v[0] as usize] - x[v[1] as usize]).norm();
        let links = self.links.iter();
        let links = links.map(|l| (between(l.vertices) - l.rest_length).abs());
        let joints = self.joints.iter().map(|j| between(j.vertices));
        (links.fold(0.0, Real::max), joints.fold(0.0, Real::max))
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let scene = scene()?;
    let mut sweeps = XpbdSolver::builder(&scene.particles)
        .energy(scene.springs.clone())
        .energy(scene.hinges.clone())
        .energy(scene.links.clone())
        .energy(scene.joints.clone())
        .energy(vec![scene.elbow])
        .config(XpbdConfig {
            damping: 1e-3,
            ..XpbdConfig::default()
        })
        .build()?;
    let mut direct = DirectXpbd::builder(&scene.particles)
        .energy(scene.springs.clone())
        .energy(scene.hinges.clone())
        .energy(scene.links.clone())
        .energy(scene.joints.clone())
        .energy(vec![scene.elbow])
        .config(DirectConfig {
            damping: 1e-3,
            max_iterations: 30,
            tolerance: 1e-8,
            ..DirectConfig::default()
        })
        .build()?;
    let free = |v: &usize| !scene.pins.contains(v);
    let weight: Real = (0..scene.particles.len())
        .filter(free)
        .map(|v| 9.81 * scene.particles.mass()[v])
        .sum();
    println!("weight of all that can move: {weight:.4} N");
    println!("              time (s)   link error (m)   joint gap (m)   force on the pins (N)");
    let mut forces = vec![Vec3::zeros(); scene.particles.len()];
    let pulled = |forces: &[Vec3]| -scene.pins.iter().map(|&pin| forces[pin].z).sum::<Real>();
    let [mut swept, mut solved] = [(); 2].map(|()| State::at_rest(scene.positions.clone()));
    let mut worst = [0.0; 2];
    for step in 1..=240 {
        let input = || StepInput::new(1.0 / 60.0).gravity(GRAVITY);
        sweeps.step(&mut swept, input())?;
        direct.step(&mut solved, input())?;
        let errors = [&swept, &solved].map(|state| scene.errors(&state.positions));
        for (worst, (link, joint)) in worst.iter_mut().zip(errors) {
            *worst = link.max(joint).max(*worst);
        }
        if step % 80 == 0 {
            for (name, (link, joint)) in ["20 sweeps", "direct"].into_iter().zip(errors) {
                if name == "direct" {
                    direct.vertex_forces_into(&mut forces);
                } else {
                    sweeps.vertex_forces_into(&mut forces);
                }
                let (time, force) = (swept.time, pulled(&forces));
                println!("{name:>10}  {time:9.3}  {link:15.1e}  {joint:14.1e}  {force:22.4}");
            }
        }
    }
    println!(
        "largest error of a link or joint in 4 s: {:.1e} m by sweeps, {:.1e} m directly",
        worst[0], worst[1]
    );
    assert!(worst[0] < 0.05 && worst[1] < 1e-7);
    Ok(())
}
