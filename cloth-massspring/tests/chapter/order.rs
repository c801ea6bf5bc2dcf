//! Order of accuracy on a swinging chain and a swinging sheet, against a converged trajectory.

use crate::{DOWN, sharp, solver, unwatched};
use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::element::Convexity;
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_massspring::{
    Bdf2, Damping, ExplicitConfig, ExplicitEuler, HessianPolicy, ImplicitConfig, ImplicitEuler,
    ImplicitMidpoint, SymplecticEuler,
};

/// What swings, and how long (s).
struct Swing {
    particles: Particles,
    springs: Vec<Spring>,
    start: State,
    time: Real,
}

/// Five links of 0.2 m, 0.1 kg and 100 N/m, let go at an angle of 45°.
fn chain() -> Swing {
    let mut particles = Particles::new(vec![0.1; 6]).unwrap();
    particles.prescribe(0).unwrap();
    let along = Vec3::new(1.0, 0.0, -1.0).normalize() * 0.2;
    let positions: Vec<Vec3> = (0..6).map(|i| along * Real::from(i)).collect();
    let ends: Vec<[u32; 2]> = (0..5).map(|i| [i, i + 1]).collect();
    Swing {
        springs: Spring::along(&positions, &ends, 100.0),
        particles,
        start: State::at_rest(positions),
        time: 0.4,
    }
}

/// Six by six vertices of 0.2 kg/m² on 30 N/m, let go horizontal, held along one side.
fn sheet() -> Swing {
    let mesh = grid(6, 6, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(30.0),
        bending_rigidity: 0.0,
    };
    let mut model = cloth.on(&mesh).unwrap();
    for vertex in 0..mesh.vertex_count() {
        if mesh.positions()[vertex].y == mesh.positions()[0].y {
            model.particles.prescribe(vertex).unwrap();
        }
    }
    Swing {
        springs: model.springs,
        particles: model.particles,
        start: State::at_rest(mesh.positions().to_vec()),
        time: 0.2,
    }
}

impl Swing {
    fn end(&self, solver: &mut dyn Stepper, steps: u32) -> Vec<Vec3> {
        let mut state = self.start.clone();
        for _ in 0..steps {
            let input = StepInput::new(self.time / Real::from(steps)).gravity(DOWN);
            solver.step(&mut state, input).unwrap();
        }
        state.positions
    }

    /// `‖a − b‖_M/√Σm` (m).
    fn distance(&self, a: &[Vec3], b: &[Vec3]) -> Real {
        let mass = self.particles.mass();
        let moved = a.iter().zip(b).map(|(a, b)| (a - b).norm_squared());
        let square: Real = mass.iter().zip(moved).map(|(m, d)| m * d).sum();
        (square / mass.iter().sum::<Real>()).sqrt()
    }

    /// Every integrator with this damping, its name, and the order it should have.
    fn solvers(&self, damping: Damping) -> Vec<(Box<dyn Stepper>, Real)> {
        let (p, springs) = (&self.particles, || self.springs.clone());
        let explicit = ExplicitConfig {
            damping,
            ..unwatched()
        };
        let implicit = ImplicitConfig { damping, ..sharp() };
        let linearized = ImplicitConfig {
            damping,
            ..ImplicitConfig::linearized()
        };
        let exact = ImplicitConfig {
            hessian: HessianPolicy::Always(Convexity::Exact),
            ..linearized
        };
        vec![
            (
                Box::new(solver!(ExplicitEuler, p, springs(), explicit)),
                1.0,
            ),
            (
                Box::new(solver!(SymplecticEuler, p, springs(), explicit)),
                1.0,
            ),
            (
                Box::new(solver!(ImplicitEuler, p, springs(), implicit)),
                1.0,
            ),
            (
                Box::new(solver!(ImplicitEuler, p, springs(), linearized)),
                1.0,
            ),
            (
                Box::new(solver!(ImplicitMidpoint, p, springs(), implicit)),
                2.0,
            ),
            (Box::new(solver!(Bdf2, p, springs(), implicit)), 2.0),
            // One linear solve a step is enough for the order, as long as nothing is dropped from it.
            (
                Box::new(solver!(ImplicitMidpoint, p, springs(), exact)),
                2.0,
            ),
            (Box::new(solver!(Bdf2, p, springs(), exact)), 2.0),
        ]
    }

    /// Checks the order that two halvings of the step show.
    fn check(&self, what: &str, damping: Damping, steps: u32) {
        let implicit = ImplicitConfig { damping, ..sharp() };
        let springs = self.springs.clone();
        let mut midpoint = solver!(ImplicitMidpoint, &self.particles, springs, implicit);
        // The error of the reference is 1/256 of that of midpoint at the finest step, or less.
        let reference = self.end(&mut midpoint, 16 * 4 * steps);
        for (mut solver, expected) in self.solvers(damping) {
            let errors = [1, 2, 4]
                .map(|fine| self.distance(&self.end(solver.as_mut(), fine * steps), &reference));
            let orders = [0, 1].map(|i| (errors[i] / errors[i + 1]).log2());
            println!(
                "{what}, {}: errors {:.3e} {:.3e} {:.3e} m, orders {orders:.3?}",
                solver.name(),
                errors[0],
                errors[1],
                errors[2]
            );
            assert!(
                (orders[1] - expected).abs() < 0.03,
                "{what}, {}: {orders:?}",
                solver.name()
            );
        }
    }
}

#[test]
fn a_swinging_chain_shows_the_order_of_each_integrator() {
    chain().check("chain", Damping::default(), 200);
}

#[test]
fn a_swinging_sheet_shows_the_order_of_each_integrator() {
    sheet().check("sheet", Damping::default(), 200);
}

#[test]
fn damping_takes_nothing_from_the_order() {
    let damping = Damping {
        air_drag: 0.5,
        stiffness: 2e-3,
    };
    chain().check("damped chain", damping, 400);
}
