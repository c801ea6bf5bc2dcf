//! The claims of the chapter, by topic.

mod allocation;
mod conservation;
mod contact;
#[path = "../../../cloth-core/tests/support/counting_allocator.rs"]
mod counting_allocator;
mod damping;
mod linear;
mod materials;
mod newton;
mod order;
mod oscillator;
mod progress;
mod refusals;
mod robustness;
mod second_order;
mod special;
mod stability;
mod statics;

use cloth_core::cloth::{Cloth, ClothModel, Membrane};
use cloth_core::energy::{Attachment, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::Particles;
use cloth_core::step::Stepper;
use cloth_massspring::{
    Accept, Bdf2, ExplicitConfig, ExplicitEuler, ImplicitConfig, ImplicitEuler, ImplicitMidpoint,
    StabilityCheck, SymplecticEuler,
};

/// As many digits as rounding allows, and minima only.
fn sharp() -> ImplicitConfig {
    ImplicitConfig {
        tolerance: 0.0,
        accept: Accept::Minimum,
        max_iterations: 300,
        ..ImplicitConfig::default()
    }
}

fn unwatched() -> ExplicitConfig {
    ExplicitConfig {
        stability: StabilityCheck::Off,
        ..ExplicitConfig::default()
    }
}

/// A solver of one kind.
macro_rules! solver {
    ($kind:ident, $particles:expr, $energies:expr, $config:expr) => {
        $kind::builder($particles)
            .energy($energies)
            .config($config)
            .build()
            .unwrap()
    };
}
pub(crate) use solver;

/// Every integrator for the same springs, the explicit ones unwatched: forward, symplectic, implicit and linearised
/// implicit Euler, midpoint, BDF2.
fn all(particles: &Particles, springs: &[Spring]) -> [Box<dyn Stepper>; 6] {
    let springs = || springs.to_vec();
    let linearized = ImplicitConfig::linearized();
    [
        Box::new(solver!(ExplicitEuler, particles, springs(), unwatched())),
        Box::new(solver!(SymplecticEuler, particles, springs(), unwatched())),
        Box::new(solver!(ImplicitEuler, particles, springs(), sharp())),
        Box::new(solver!(ImplicitEuler, particles, springs(), linearized)),
        Box::new(solver!(ImplicitMidpoint, particles, springs(), sharp())),
        Box::new(solver!(Bdf2, particles, springs(), sharp())),
    ]
}

/// A mass of 1 kg on a spring of rest length 0 and stiffness `omega²`.
fn oscillator(omega: Real) -> (Particles, Vec<Attachment>) {
    let spring = Attachment {
        vertex: 0,
        target: Vec3::zeros(),
        stiffness: omega * omega,
    };
    (Particles::new(vec![1.0]).unwrap(), vec![spring])
}

/// `count` masses of 1 kg and springs of length 1 m between them, hanging down from a prescribed vertex 0 at the
/// origin.
fn chain(count: usize, stiffness: Real) -> (Particles, Vec<Spring>, Vec<Vec3>) {
    let positions: Vec<Vec3> = (0..=count)
        .map(|i| Vec3::new(0.0, 0.0, -(i as Real)))
        .collect();
    let ends: Vec<[u32; 2]> = (0..count as u32).map(|i| [i, i + 1]).collect();
    let mut particles = Particles::new(vec![1.0; count + 1]).unwrap();
    particles.prescribe(0).unwrap();
    (
        particles,
        Spring::along(&positions, &ends, stiffness),
        positions,
    )
}

/// The scene `hang`: 1 m × 1 m, two corners held.
fn hang(n: usize) -> (TriMesh, ClothModel) {
    let mesh = grid(n, n, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e4),
        bending_rigidity: 1e-5,
    };
    let mut model = cloth.on(&mesh).unwrap();
    model.particles.prescribe(n * n - n).unwrap();
    model.particles.prescribe(n * n - 1).unwrap();
    (mesh, model)
}

/// Deterministic numbers in (−1, 1).
fn noise(index: usize) -> Vec3 {
    Vec3::from_fn(|axis, _| {
        let t = (3 * index + axis) as Real * 0.754_877_666 + 0.17;
        2.0 * t.fract() - 1.0
    })
}

const DOWN: Vec3 = Vec3::new(0.0, 0.0, -9.81);

fn largest_difference(a: &[Vec3], b: &[Vec3]) -> Real {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).amax())
        .fold(0.0, Real::max)
}
