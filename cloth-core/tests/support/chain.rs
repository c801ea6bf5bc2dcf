//! A chain of N equal masses hanging from a prescribed vertex, for the tests of several crates.

use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Observer, StepInput, Stepper};

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);

/// Vertices 0 (prescribed) to N, downwards along −z.
pub(crate) struct Chain {
    pub(crate) particles: Particles,
    pub(crate) springs: Vec<Spring>,
    link_length: Real,
}

impl Chain {
    /// `links` links of 1 m, N/m `stiffness` each, with 1 kg at the lower end of each.
    pub(crate) fn new(links: u32, stiffness: Real) -> Self {
        Self::of(links, 1.0, 1.0, stiffness)
    }

    /// The same with a mass (kg) and a link length (m) of one's own.
    pub(crate) fn of(links: u32, mass: Real, link_length: Real, stiffness: Real) -> Self {
        let mut particles = Particles::new(vec![mass; links as usize + 1]).unwrap();
        particles.prescribe(0).unwrap();
        let spring = |i| Spring {
            vertices: [i, i + 1],
            rest_length: link_length,
            stiffness,
        };
        Self {
            particles,
            springs: (0..links).map(spring).collect(),
            link_length,
        }
    }

    /// Straight down, every link at its rest length.
    pub(crate) fn at_rest(&self) -> State {
        let down = |i| Vec3::new(0.0, 0.0, -(i as Real) * self.link_length);
        State::at_rest((0..self.particles.len()).map(down).collect())
    }

    /// How far (m) the lowest vertex is below its place in [`Chain::at_rest`].
    fn sag(&self, state: &State) -> Real {
        -state.positions.last().unwrap().z - self.springs.len() as Real * self.link_length
    }

    /// The sag (m) after `steps` steps of `dt` (s), when everything has come to rest.
    pub(crate) fn sag_at_rest(&self, solver: &mut dyn Stepper, dt: Real, steps: u32) -> Real {
        let mut state = self.at_rest();
        for _ in 0..steps {
            solver
                .step(&mut state, StepInput::new(dt).gravity(GRAVITY))
                .unwrap();
        }
        let speed = state.velocities.iter().map(Vec3::norm);
        let speed = speed.fold(0.0, Real::max);
        assert!(speed < 1e-9, "still moving at {speed:e} m/s");
        self.sag(&state)
    }

    /// What one step without gravity leaves of link stretches of some millimetres: the largest (m) after each
    /// iteration.
    pub(crate) fn stretch_after_each_iteration(&self, solver: &mut dyn Stepper) -> Vec<Real> {
        let mut state = self.at_rest();
        for (i, x) in state.positions.iter_mut().enumerate().skip(1) {
            x.z += 0.01 * ((i * i) as Real).sin();
        }
        let mut watch = Stretch {
            springs: &self.springs,
            largest: Vec::new(),
        };
        let input = StepInput::new(1.0).observer(&mut watch);
        solver.step(&mut state, input).unwrap();
        watch.largest
    }
}

struct Stretch<'a> {
    springs: &'a [Spring],
    largest: Vec<Real>,
}

impl Observer for Stretch<'_> {
    fn iteration(&mut self, _: u32, x: &[Vec3]) {
        let stretch = |s: &Spring| {
            let [a, b] = s.vertices.map(|v| x[v as usize]);
            ((a - b).norm() - s.rest_length).abs()
        };
        let largest = self.springs.iter().map(stretch).fold(0.0, Real::max);
        self.largest.push(largest);
    }
}
