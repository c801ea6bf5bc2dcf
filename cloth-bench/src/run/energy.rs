//! The energy of a run beside all that was put into it.
//!
//! The cloth is its free vertices and all its elements. It and the rigid bodies that it pushes hold
//!
//! ```text
//! K + E + B                      kinetic and elastic energy, and that of a contact with a potential
//! ```
//!
//! and were given
//!
//! ```text
//! K₀ + E₀ + (U₀ − U) + W         what they held at the start, what gravity has released (U = −Σ m g·x), and work
//! ```
//!
//! where W is the work of all that moves by itself, summed over the steps:
//!
//! | of | W |
//! |---|---|
//! | prescribed vertices | ½ (∂E/∂x before + after)·Δx, exact for a quadratic energy and a straight way; or what a method has added up over its substeps: explicit ones with ∂E/∂x, XPBD with its multipliers, PBD with the sum of what its visits have moved each row by, projective dynamics with its constant matrix and the projections of its last iterate: the forces that they have used |
//! | the air | F·Δx in every (sub)step, with the force F in it ([`cloth_core::air`]) |
//! | gas inside, and forces of the scene | F·Δx, with the load F of the step |
//! | all of these with BDF2 | ½ (F before + after)·Δx, or F·v Δt, v at its end, where F acts, if that is more |
//! | vertices that are held from some time on, or released | the kinetic energy and that of gravity which they take along or bring |
//! | untangling | what is held beyond what was given, after steps that began with crossing pairs and the first without |
//! | seams that close, points of soft pins that move | the same, after steps in which one does |
//! | obstacles, and prescribed vertices by contact | [`ContactSource::work`](cloth_core::contact::ContactSource::work), without what the bodies that the cloth pushes do on it: that stays between the two |
//! | obstacles and prescribed vertices that stop those bodies | their impulse times the velocity of the body |
//!
//! Nothing holds more than it was given. What a method holds beyond it is the *excess*, energy from nowhere, whatever
//! has made it: the method, or contact that moves the cloth without regard to what holds it together. Losses can hide
//! it: it is above zero only where it outweighs them.
//!
//! # Tolerances
//! - Below the rounding of the sums and of one step the excess is 0.
//! - Up to 1 % of the most that was given it is reported, but no reason to warn. The energies are those of positions
//!   and velocities as they stand after a step, and a method of first order may hold another one: symplectic Euler
//!   keeps `K + E + U − ½ h v·∂(E + U)/∂x`, with (sub)steps h, so that the sum without the last term goes up and down
//!   about what it keeps. At its default substeps the scenes `hang`, `chain` and `cantilever` show 0.4 % of it at most.
//! - The run has failed where motion shows what was never given: K larger by more than all that was given at any time
//!   before, after two steps in succession. (The force with which a pin that is jerked pulls is known to sweeps and
//!   local–global iterations one step late.) The elastic energy is left out of this. Sweeps that end early leave
//!   stretch, at their published settings too, which in the stiffness of the material may be thousands of times what
//!   was given; they correct it later without giving it back. Twisted cloth shows it too: pins give what the
//!   multipliers say, and the elastic energy of the stretch that sweeps leave may be several times that.
//!
//! # Limits
//! What a prescribed vertex does by the coarse links of PBD's hierarchy is not in W.

use crate::error::BenchError;
use crate::scene::Scene;
use cloth_collide::potential::PotentialContacts;
use cloth_core::air::Air;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure;
use cloth_core::method::family::Energies;
use cloth_core::particles::{Particles, State};
use cloth_core::step::StepReport;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The first step after which a cloth moved with more energy than it had ever been given.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnergyGain {
    /// The step, counted from 1.
    pub step: u32,
    /// Kinetic energy after it (J).
    pub kinetic: Real,
    /// What the cloth had been given until then, less what it has spent on the way, as on gravity (J).
    pub given: Real,
}

impl fmt::Display for EnergyGain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            step,
            kinetic,
            given,
        } = self;
        write!(
            f,
            "energy from nowhere: after step {step} the cloth moves with {kinetic:.3e} J, though its start, gravity, pins, bodies and air had given it {given:.3e} J by then"
        )
    }
}

/// Excess over what was given, from which on it is worth a warning. At least that fraction of what lifts the cloth by
/// an edge ([`Summary::energy_scale`](super::Summary::energy_scale)) is needed too: a sheet that hangs taut was given
/// next to nothing.
pub(super) const WORTH_A_WARNING: Real = 0.01;
/// Error of a sum relative to what is added.
const ROUNDING: Real = 1e-10;

/// What moves with the bodies that the cloth pushes (J): their kinetic energy, and that of gravity.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BodyEnergy {
    kinetic: Real,
    gravitational: Real,
}

impl BodyEnergy {
    /// As they move after the last step.
    pub(super) fn of(scene: &Scene, contacts: Option<&PotentialContacts>) -> Self {
        let mut sum = Self {
            kinetic: contacts.map_or(0.0, PotentialContacts::free_kinetic_energy),
            gravitational: 0.0,
        };
        let bodies = scene.touch.iter().flat_map(|touch| touch.free_bodies());
        let motions = contacts.iter().flat_map(|contacts| contacts.free_motions());
        for ((_, body), (_, motion)) in bodies.zip(motions) {
            sum.gravitational -= body.mass() * scene.gravity.dot(&motion.pose.position);
        }
        sum
    }
}

/// Mass of the cloth times gravity times the mean edge of its triangles (J).
pub(super) fn scale(scene: &Scene) -> Real {
    let mass: Real = scene.model.particles.mass().iter().sum();
    let Some(mesh) = &scene.mesh else {
        return 0.0;
    };
    let (mut sum, mut count): (Real, Real) = (0.0, 0.0);
    for &[a, b, c] in mesh.triangles() {
        for [a, b] in [[a, b], [b, c], [c, a]] {
            sum += (mesh.positions()[a as usize] - mesh.positions()[b as usize]).norm();
            count += 1.0;
        }
    }
    mass * scene.gravity.norm() * sum / count.max(1.0)
}

/// The account of one run.
#[derive(Debug)]
pub(super) struct EnergyBalance {
    particles: Particles,
    gravity: Vec3,
    energies: Energies,
    /// Steps that are over, of one part or several.
    pub(super) steps: u32,
    /// `K₀ + E₀ + U₀` (J).
    start: Real,
    /// What has been entered so far; put back to before a step that is taken back.
    pub(super) entries: Entries,
    bodies: BodyEnergy,
    /// Positions (m) where the step begins.
    before: Vec<Vec3>,
    /// `∂E/∂x` (N) there and at its end, where prescribed vertices move.
    gradients: [Vec<Vec3>; 2],
}

/// What changes from step to step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Entries {
    /// W (J).
    work: Real,
    /// The most that was given until any step (J).
    pub(super) most_given: Real,
    /// What the cloth holds after the last step, and what it has been given until then (J).
    pub(super) now: [Real; 2],
    /// The largest excess so far (J), 0 if it was never more than rounding.
    pub(super) excess: Real,
    /// When the cloth first moved with energy that it was never given, if it did.
    pub(super) gain: Option<EnergyGain>,
    /// The same of the last step alone.
    suspicion: Option<EnergyGain>,
}

impl EnergyBalance {
    /// Of a cloth in this state, whose contact stores so much (J), and bodies.
    pub(super) fn new(
        scene: &Scene,
        state: &State,
        stored: Real,
        bodies: BodyEnergy,
    ) -> Result<Self, BenchError> {
        let mut energies = scene.elastic()?;
        energies.set_time(state.time);
        let zeros = vec![Vec3::zeros(); state.positions.len()];
        let mut balance = Self {
            particles: scene.model.particles.clone(),
            gravity: scene.gravity,
            energies,
            steps: 0,
            start: 0.0,
            entries: Entries::default(),
            bodies,
            before: zeros.clone(),
            gradients: [zeros.clone(), zeros],
        };
        balance.entries.most_given = balance.held(state) + stored;
        balance.start = balance.entries.most_given + balance.gravitational(state);
        Ok(balance)
    }

    /// Goes on with the cloth of another scene in the place of the one in `before` the change. Vertices that are held
    /// from now on take their energy along, those that are released bring theirs; what torn elements held is lost.
    pub(super) fn change(
        &mut self,
        scene: &Scene,
        before: &State,
        state: &State,
    ) -> Result<(), BenchError> {
        let moving = |balance: &Self, state| balance.kinetic(state) + balance.gravitational(state);
        let had = moving(self, before);
        self.particles.clone_from(&scene.model.particles);
        self.entries.work += moving(self, state) - had;
        self.energies = scene.elastic()?;
        self.energies.set_time(state.time);
        Ok(())
    }

    /// Notes where a step begins. Moving pins have their velocities by then.
    pub(super) fn begin_step(&mut self, state: &State) {
        self.before.copy_from_slice(&state.positions);
        if self.pins_move(state) {
            self.differentiate(0, state);
        }
    }

    /// Enters the work of a step that ended in `state`, with a load (N) and the air, the work of pins and of both (J)
    /// if the method knows it, and that of bodies (J).
    pub(super) fn add_work(
        &mut self,
        state: &State,
        (load, air): (Option<&[Vec3]>, Option<&Air>),
        report: &StepReport,
        bodies: Real,
    ) {
        self.energies.set_time(state.time);
        self.entries.work += bodies;
        if let Some(pins) = report.pin_work {
            self.entries.work += pins;
        } else if self.pins_move(state) {
            self.differentiate(1, state);
            let [begin, end] = &self.gradients;
            let force = |v: usize| 0.5 * (begin[v] + end[v]);
            self.entries.work += self.work_of(state, true, force);
        }
        self.entries.work += report.load_work.unwrap_or_else(|| {
            let w = self.particles.inverse_mass();
            load.map_or(0.0, |load| self.work_of(state, false, |v| load[v]))
                + air.map_or(0.0, |air| air.work(&state.positions, w))
        });
    }

    /// Enters what bodies hold after a step. Their work on the cloth stays between the two.
    pub(super) fn add_bodies(&mut self, scene: &Scene, contacts: &PotentialContacts) {
        let [on_cloth, on_bodies] = contacts.free_work();
        self.entries.work += on_bodies - on_cloth;
        self.bodies = BodyEnergy::of(scene, Some(contacts));
    }

    /// Takes what the cloth holds in `state` beyond what it was given, contact with its `stored` energy (J), for given:
    /// what untangles moves the cloth by itself, and so does a seam that closes or a soft pin that
    /// moves.
    pub(super) fn accept(&mut self, state: &State, stored: Real) {
        let excess = self.held(state) + stored - self.given_until(state);
        self.entries.work += excess.max(0.0);
    }

    /// Balances the account after a step of `dt` (s); contact has stored `stored` (J).
    pub(super) fn end_step(&mut self, state: &State, dt: Real, stored: Real) {
        let fallen = self.gravitational(state);
        let kinetic = self.kinetic(state) + self.bodies.kinetic;
        let (held, given) = (self.held(state) + stored, self.given_until(state));
        self.entries.now = [held, given];
        self.entries.most_given = self.entries.most_given.max(given);
        let size = state.positions.iter().map(Vec3::amax).fold(0.0, Real::max);
        let mass: Real = self.particles.mass().iter().sum();
        let jitter = measure::rounding_energy(mass, size, dt);
        let sums = ROUNDING * (self.start.abs() + fallen.abs() + self.entries.work.abs() + held);
        if held - given > jitter + sums {
            self.entries.excess = self.entries.excess.max(held - given);
        }
        if self.entries.gain.is_none() {
            let most = self.entries.most_given.max(jitter + sums);
            let gains = kinetic > jitter + sums && kinetic - given > most;
            let now = gains.then_some(EnergyGain {
                step: self.steps + 1,
                kinetic,
                given,
            });
            let before = std::mem::replace(&mut self.entries.suspicion, now);
            self.entries.gain = now.and(before);
        }
    }

    fn pins_move(&self, state: &State) -> bool {
        let w = self.particles.inverse_mass();
        let mut pins = w.iter().zip(&state.velocities).filter(|(w, _)| **w == 0.0);
        pins.any(|(_, v)| *v != Vec3::zeros())
    }

    fn differentiate(&mut self, place: usize, state: &State) {
        let gradient = &mut self.gradients[place];
        gradient.fill(Vec3::zeros());
        self.energies.add_gradient(&state.positions, gradient);
    }

    /// Σ F·Δx (J) over the prescribed vertices, or over the others.
    fn work_of(&self, state: &State, prescribed: bool, force: impl Fn(usize) -> Vec3) -> Real {
        let particles = &self.particles;
        let moved = |v: usize| state.positions[v] - self.before[v];
        (0..particles.len())
            .filter(|&v| particles.is_prescribed(v) == prescribed)
            .map(|v| force(v).dot(&moved(v)))
            .sum()
    }

    /// What it was given until it has come to `state` (J).
    fn given_until(&self, state: &State) -> Real {
        self.start - self.gravitational(state) + self.entries.work
    }

    /// Kinetic and elastic energy (J), of bodies too.
    fn held(&self, state: &State) -> Real {
        self.kinetic(state) + self.bodies.kinetic + self.energies.value(&state.positions)
    }

    /// `½ Σ m ‖v‖²` of the free vertices (J).
    fn kinetic(&self, state: &State) -> Real {
        self.sum_of_free(|v| 0.5 * state.velocities[v].norm_squared())
    }

    /// `−Σ m g·x` of the free vertices and the bodies (J).
    fn gravitational(&self, state: &State) -> Real {
        self.bodies.gravitational + self.sum_of_free(|v| -self.gravity.dot(&state.positions[v]))
    }

    /// The sum of `term` (J/kg) times the mass, over the free vertices.
    fn sum_of_free(&self, term: impl Fn(usize) -> Real) -> Real {
        let particles = &self.particles;
        let free = (0..particles.len()).filter(|&v| !particles.is_prescribed(v));
        free.map(|v| particles.mass()[v] * term(v)).sum()
    }
}
