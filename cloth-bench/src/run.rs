//! One simulation: a scene, a method, a number of steps.

mod crossings;
mod energy;
mod load;
mod parts;
mod pin_loads;
mod solver;
mod start;
mod stretch;
mod summary;
mod timed;
mod untangling;
mod watch;

pub use crossings::crossing_warnings;
pub use energy::EnergyGain;
pub use solver::Solver;
pub use summary::Summary;
pub use watch::{SeparationWatch, Watched};

use crate::error::BenchError;
use crate::method::Method;
use crate::scene::{ChangeKind, Scene};
use crate::settings::Settings;
use cloth_collide::potential::ContactForces;
use cloth_collide::untangle::CrossingPairs;
use cloth_core::air::Air;
use cloth_core::contact::{ContactSource, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure;
use cloth_core::particles::State;
use cloth_core::step::{StepInput, StepReport, Stepper};
use energy::{BodyEnergy, EnergyBalance};
use load::{Push, load, push_of};
use pin_loads::PinLoads;
use std::borrow::Cow;
use std::time::Instant;
use stretch::StretchWatch;
use timed::Timed;
use untangling::Untangling;
use watch::{body_probe, crossed_bodies, min_clearance};

/// Part of a step by which a change may come early: rounding of the time.
const ROUNDING: Real = 1e-6;

/// A time (s) in which nothing moves.
const NO_TIME: Real = 1e-12;

/// A scene on its way: the caller's method takes the steps, and this adds all that is not the method's.
struct Course<'a> {
    scene: Cow<'a, Scene>,
    /// How many changes of the scene have been made, and after how many of them the method was built anew.
    changes: usize,
    rebuilds: u32,
    /// Whether forces of contact are recorded, and what they are on average where a step has several parts.
    forces: bool,
    mean_forces: Option<ContactForces>,
    pin_loads: Option<PinLoads>,
    contacts: Option<Timed>,
    untangling: Untangling,
    air: Option<Air>,
    /// Forces that act by now.
    pushes: Vec<Push>,
    /// Forces (N) of gas, and those of the scene.
    load: Vec<Vec3>,
    /// Time that the last step took (s), without that of its energy balance, and that of contact in it.
    seconds: Real,
    contact_seconds: Real,
}

impl<'a> Course<'a> {
    fn new(scene: &'a Scene) -> Result<Self, BenchError> {
        let contacts = scene.contacts()?.map(Timed::new);
        let air = scene.air.clone();
        Ok(Self {
            scene: Cow::Borrowed(scene),
            changes: 0,
            rebuilds: 0,
            forces: false,
            mean_forces: None,
            pin_loads: None,
            untangling: Untangling::new(scene, contacts.as_ref()),
            contacts,
            air,
            pushes: Vec::new(),
            load: Vec::new(),
            seconds: 0.0,
            contact_seconds: 0.0,
        })
    }

    /// Has the forces of contact recorded, if they are wanted.
    fn record_forces(&mut self, are_wanted: bool) {
        self.forces = are_wanted;
        let contacts = self.contacts.iter_mut();
        contacts.for_each(|timed| timed.source.contacts.record_forces(are_wanted));
    }

    /// The energy (J) that contact and volumes store where the cloth starts, and that of contact alone, which may begin
    /// nearer to something than the thickness. Of a start that is refused, 0.
    fn stored(&mut self, state: &State) -> [Real; 2] {
        let Some(timed) = &mut self.contacts else {
            return [0.0; 2];
        };
        let step = ContactStep {
            from: &state.positions,
            inverse_mass: self.scene.model.particles.inverse_mass(),
            dt: NO_TIME,
        };
        let (mut start, mut unused) = (state.positions.clone(), state.positions.clone());
        let potential = timed.source.potential();
        match potential.begin(&step, &mut start) {
            Ok(()) => {
                let all = potential.add_gradient(&state.positions, &mut unused);
                let contact = timed.source.contacts.potential();
                [all, contact.add_gradient(&state.positions, &mut unused)]
            }
            Err(_) => [0.0; 2],
        }
    }

    /// Makes the changes that are due before a step of `dt` (s).
    fn change(
        &mut self,
        solver: &mut Solver<'_>,
        state: &mut State,
        dt: Real,
        balance: &mut EnergyBalance,
    ) -> Result<(), BenchError> {
        let begins = state.time + ROUNDING * dt;
        let acts = |push: &Push| push.until.is_none_or(|until| begins < until);
        self.pushes.retain(&acts);
        while let Some(change) = self.scene.changes.get(self.changes) {
            if change.time > state.time + ROUNDING * dt {
                break;
            }
            self.pushes
                .extend(push_of(change, &self.scene).filter(&acts));
            let before = state.clone();
            let scene = self.scene.after(change, state)?;
            // Vertices that are held already and go on by another path are no news to the solver.
            let before_it = &self.scene.model.particles;
            let is_known = matches!(&change.kind, ChangeKind::Hold { vertices, .. }
                if vertices.iter().all(|&v| before_it.is_prescribed(v)));
            balance.change(&scene, &before, state)?;
            if !is_known && !solver.takes(change, &scene) {
                solver.build(&scene, dt)?;
                self.rebuilds += 1;
            }
            if let Some(timed) = &mut self.contacts {
                let contacts = &mut timed.source.contacts;
                match change.kind {
                    ChangeKind::Tear { .. } => {
                        if let Some(source) = scene.contacts_from(state.time)? {
                            timed.source = source;
                            timed.source.contacts.record_forces(self.forces);
                            self.untangling.renew(&scene, timed);
                        }
                    }
                    ChangeKind::Sew { .. } => {
                        let seam = scene.model.seam();
                        contacts.sew(&seam.sewn_pairs(), &seam.sewn_onto_edges());
                        self.untangling.renew(&scene, timed);
                    }
                    ChangeKind::Drive { body, velocities } => {
                        let driven = contacts.set_velocities(body, velocities);
                        driven.map_err(BenchError::failed)?;
                    }
                    ChangeKind::LetGo { body } => {
                        contacts.hold_body(body, false);
                    }
                    _ => {}
                }
            }
            self.changes += 1;
            self.scene = Cow::Owned(scene);
        }
        Ok(())
    }

    /// One part of a step.
    fn part(
        &mut self,
        stepper: &mut dyn Stepper,
        state: &mut State,
        dt: Real,
        mut balance: Option<&mut EnergyBalance>,
    ) -> Result<StepReport, BenchError> {
        if let Some(contacts) = &mut self.contacts {
            contacts.reset();
        }
        let started = Instant::now();
        let contacts = self.contacts.as_mut();
        let is_tangled = self.untangling.begin_part(&self.scene, contacts, state)?;
        self.seconds = started.elapsed().as_secs_f64();
        if let Some(pins) = &self.scene.pins {
            pins.set_velocities(state, dt).map_err(BenchError::failed)?;
        }
        if let Some(balance) = &mut balance {
            balance.begin_step(state);
        }
        let started = Instant::now();
        let acting = (&self.scene.gases[..], &self.pushes[..]);
        let load = load(acting, &mut self.load, &state.positions);
        let mut input = StepInput::new(dt).gravity(self.scene.gravity);
        if let Some(load) = load {
            input = input.load(load);
        }
        if let Some(air) = &mut self.air {
            air.load(state, dt);
            input = input.air(air);
        }
        if let Some(pins) = &mut self.pin_loads {
            input = input.pin_forces(&mut pins.part);
        }
        if let Some(contacts) = &mut self.contacts {
            input = input.contacts(contacts);
        }
        let report = stepper.step(state, input);
        let report = report.map_err(|error| self.scene.crossing_error(error))?;
        self.seconds += started.elapsed().as_secs_f64();
        if let Some(pins) = &mut self.pin_loads {
            if !report.tells_pin_forces {
                return Err(BenchError::Usage(format!(
                    "method `{}` does not tell the forces at held vertices",
                    stepper.name()
                )));
            }
            pins.add_weight(&self.scene.model.particles, self.scene.gravity, load);
        }
        if let Some(contacts) = &mut self.contacts {
            contacts.count(is_tangled);
        }
        if let Some(balance) = balance {
            let contacts = self.contacts.as_ref();
            let bodies = contacts.map_or(0.0, ContactSource::work);
            if let Some(timed) = contacts {
                balance.add_bodies(&self.scene, &timed.source.contacts);
            }
            let stored = contacts.map_or(0.0, ContactSource::potential_energy);
            balance.add_work(state, (load, self.air.as_ref()), &report, bodies);
            if is_tangled || self.scene.is_driven(state.time, dt) {
                balance.accept(state, stored);
            }
            balance.end_step(state, dt, stored);
        }
        Ok(report)
    }
}

/// Takes steps of `dt` (s) until no velocity is `still` (m/s) or more, at most `most`; gives the number of steps, `None`
/// if something still moves after the last.
///
/// Small steps hardly damp, so the cloth is brought to rest by *kinetic damping*: whenever the kinetic energy has
/// passed a maximum, all velocities are set to zero. Steps that go from one turning point to the other, as those of a
/// chain of as many links as it has substeps, end without velocities, but far from where they began: then it goes back
/// half of the way. The state of rest is the method's own: there the velocities are zero anyway.
pub fn to_rest(
    scene: &Scene,
    stepper: &mut dyn Stepper,
    state: &mut State,
    dt: Real,
    most: u32,
    still: Real,
) -> Result<Option<u32>, BenchError> {
    let mut course = Course::new(scene)?;
    let mut before = 0.0;
    let mut from = Vec::new();
    // The farthest way in a step at rest, over that with the largest velocity: what turns makes it exact.
    let mut far = 100.0;
    for step in 1..=most {
        state.positions.clone_into(&mut from);
        course.step(stepper, state, dt, None)?;
        if state.velocities.iter().all(|v| v.amax() < still) {
            let mut ways = state.positions.iter().zip(&from).map(|(x, from)| x - from);
            if ways.all(|way| way.amax() < far * still * dt) {
                return Ok(Some(step));
            }
            far = 1.0;
            for (x, from) in state.positions.iter_mut().zip(&from) {
                *x = (*x + from) / 2.0;
            }
        }
        let energy = measure::kinetic_energy(&scene.model.particles, &state.velocities);
        if energy < before {
            state.velocities.fill(Vec3::zeros());
            before = 0.0;
        } else {
            before = energy;
        }
    }
    Ok(None)
}

/// Runs `steps` steps of `dt` (s). `after` is called with every state, the step's number from 1 and its report.
///
/// # Errors
/// [`BenchError::Failed`] with the method's own error. `state` is then the last good one. [`BenchError::Usage`] where
/// the scene changes in a way that the stepper cannot take: see [`run_changing`].
pub fn run(
    scene: &Scene,
    stepper: &mut dyn Stepper,
    state: &mut State,
    dt: Real,
    steps: u32,
    mut after: impl FnMut(u32, &State, &StepReport) -> Result<(), BenchError>,
) -> Result<Summary, BenchError> {
    let mut solver = Solver::lent(stepper);
    let after = |moment: &Moment<'_>| after(moment.step, moment.state, moment.report);
    let (summary, _) = run_changing(scene, &mut solver, state, Plan::new(dt, steps), after)?;
    Ok(summary)
}

/// A step that has been taken.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Its number, from 1.
    pub step: u32,
    /// The scene as it is by then.
    pub scene: &'a Scene,
    /// The state after it.
    pub state: &'a State,
    /// What the method says of it.
    pub report: &'a StepReport,
    /// The forces of contact in it, if the plan wants them and there is something to touch.
    pub forces: Option<&'a ContactForces>,
    /// What held vertices bear in it (N), one per vertex and zero at free ones, if the plan wants that: the pull of the
    /// elements, their own weight and loads of the scene, without air and contact.
    pub pin_loads: Option<&'a [Vec3]>,
    /// What the cloth, and the bodies that it pushes, hold by then (J): kinetic and elastic energy, and that of
    /// contact.
    pub held: Real,
    /// What they have been given until then (J): what they held at the start, what gravity has released, and work.
    pub given: Real,
    /// What crossed before it, of a cloth that starts tangled, until nothing does.
    pub tangled: Option<CrossingPairs>,
}

/// How a run goes.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Step size (s).
    pub dt: Real,
    /// Number of steps.
    pub steps: u32,
    /// Whether the forces of contact are recorded.
    pub forces: bool,
    /// Whether what held vertices bear is recorded.
    pub pin_loads: bool,
}

impl Plan {
    /// So many steps of `dt` (s), without forces.
    pub fn new(dt: Real, steps: u32) -> Self {
        Self {
            dt,
            steps,
            forces: false,
            pin_loads: false,
        }
    }
}

/// The same of a scene whose cloth may change on the way; also gives the scene at the end. After an error `state` is
/// the last good one.
pub fn run_changing(
    scene: &Scene,
    solver: &mut Solver<'_>,
    state: &mut State,
    plan: Plan,
    mut after: impl FnMut(&Moment<'_>) -> Result<(), BenchError>,
) -> Result<(Summary, Scene), BenchError> {
    take_steps(scene, solver, state, plan, &mut after)
}

/// Compiled once, not once for every caller.
fn take_steps(
    scene: &Scene,
    solver: &mut Solver<'_>,
    state: &mut State,
    plan: Plan,
    after: &mut dyn FnMut(&Moment<'_>) -> Result<(), BenchError>,
) -> Result<(Summary, Scene), BenchError> {
    let Plan {
        dt,
        steps,
        forces,
        pin_loads,
    } = plan;
    let outside = scene.refuse_start_inside(state);
    outside.map_err(|error| error.at(&scene.file))?;
    let mut course = Course::new(scene)?;
    course.record_forces(forces);
    course.pin_loads = pin_loads.then(|| PinLoads::new(state.positions.len()));
    let [stored, contact_energy_at_start] = course.stored(state);
    let start_lift = start::lift(scene, contact_energy_at_start);
    let contacts = course.contacts.as_ref().map(|timed| &timed.source.contacts);
    let bodies = BodyEnergy::of(scene, contacts);
    let mut balance = EnergyBalance::new(scene, state, stored, bodies)?;
    let start_height = height(scene, state);
    let mut seconds = Vec::with_capacity(steps as usize);
    let mut contact_seconds = Vec::with_capacity(steps as usize);
    let mut iterations = Vec::with_capacity(steps as usize);
    let mut counted = Summary::default();
    let mut stretch = StretchWatch::default();
    for step in 1..=steps {
        course.change(solver, state, dt, &mut balance)?;
        let report = course.step(solver.stepper(), state, dt, Some(&mut balance))?;
        seconds.push(course.seconds);
        contact_seconds.extend(course.contacts.is_some().then_some(course.contact_seconds));
        iterations.push(report.iterations);
        counted.count(&report);
        stretch.look((&course.scene, course.changes), state, step)?;
        let [held, given] = balance.entries.now;
        after(&Moment {
            step,
            scene: &course.scene,
            state,
            report: &report,
            forces: course.forces(),
            pin_loads: course.pin_loads.as_ref().map(|pins| &pins.mean[..]),
            held,
            given,
            tangled: course.untangling.before(step),
        })?;
    }
    let untangling = std::mem::take(&mut course.untangling);
    let sources = course.contacts.as_ref().map(|timed| &timed.source);
    let contact_energy = sources.map_or(0.0, |all| all.contacts.potential_energy());
    let stored = sources.map_or(0.0, ContactSource::potential_energy);
    let scene = course.scene.into_owned();
    let mut energies = scene.elastic()?;
    energies.set_time(state.time);
    let particles = &scene.model.particles;
    let strain = measure::Strain::of(&scene.gauges()?, &state.positions);
    let elastic_energy = energies.value(&state.positions);
    let height_energy = |x: &[Vec3]| measure::gravitational_energy(particles, x, scene.gravity);
    let gravity_energy = height_energy(&state.positions) - height_energy(&scene.start.positions);
    let separation = separation(&scene, state)?;
    let held_inside = course
        .contacts
        .as_ref()
        .and_then(|c| scene.held_inside(&c.held_inside));
    let mut summary = Summary {
        steps,
        ms_per_step_max: 1e3 * largest(seconds.iter().copied()),
        ms_per_step_median: 1e3 * median(&mut seconds),
        contact_ms_median: 1e3 * median(&mut contact_seconds),
        truncated_steps: course.contacts.as_ref().map_or(0, |c| c.truncated_steps),
        pinched_steps: course.contacts.as_ref().map_or(0, |c| c.pinched_steps),
        most_pinched: course.contacts.as_ref().map_or(0, |c| c.most_pinched),
        held_inside,
        iterations: iterations.iter().map(|&n| u64::from(n)).sum(),
        iterations_per_step: median_count(&mut iterations),
        rebuilds: course.rebuilds,
        max_stretch: strain.max,
        max_stretch_of_all: stretch.strain,
        stretched: stretch.warning(&scene),
        rms_strain: strain.rms,
        kinetic_energy: measure::kinetic_energy(particles, &state.velocities),
        elastic_energy,
        gravity_energy,
        contact_energy,
        potential_energy: elastic_energy + gravity_energy + stored,
        energy_excess: balance.entries.excess,
        energy_given: balance.entries.most_given,
        energy_scale: energy::scale(&scene),
        energy_gain: balance.entries.gain,
        contact_energy_at_start,
        start_lift,
        center_of_mass_drop: start_height - height(&scene, state),
        intersections: separation.map(|s| s.intersecting_pairs),
        obstacle_intersections: crossed_bodies(&scene, &mut body_probe(&scene)?, state)?,
        min_distance: separation.and_then(|s| s.min_distance),
        min_clearance: min_clearance(&scene, state),
        max_seam_gap: scene.max_seam_gap(state),
        open_seam: scene.seam_warning(state, state.time),
        max_volume_change: scene.max_volume_change(state),
        ..counted
    };
    untangling.report(&scene, state, &mut summary);
    Ok((summary, scene))
}

/// So many steps of a method from the start of a scene, and where it ended.
pub fn simulate(
    scene: &Scene,
    method: &Method,
    settings: &Settings,
    dt: Real,
    steps: u32,
) -> Result<(Summary, State), BenchError> {
    from_start(scene, method, settings, dt, steps, |_, _, _| Ok(()))
}

/// A run of a method from the start of a scene, and where it ended; otherwise as [`run`].
pub fn from_start(
    scene: &Scene,
    method: &Method,
    settings: &Settings,
    dt: Real,
    steps: u32,
    mut after: impl FnMut(u32, &State, &StepReport) -> Result<(), BenchError>,
) -> Result<(Summary, State), BenchError> {
    let mut solver = Solver::new(method, settings, scene, dt)?;
    let mut state = scene.start.clone();
    let after = |moment: &Moment<'_>| after(moment.step, moment.state, moment.report);
    let (summary, _) = run_changing(scene, &mut solver, &mut state, Plan::new(dt, steps), after)?;
    Ok((summary, state))
}

fn separation(
    scene: &Scene,
    state: &State,
) -> Result<Option<cloth_collide::Separation>, BenchError> {
    let Some(mut probe) = scene.separation_probe() else {
        return Ok(None);
    };
    Ok(Some(probe.measure(&state.positions)?))
}

/// Height of the centre of mass (m) against gravity; 0 without gravity.
fn height(scene: &Scene, state: &State) -> Real {
    let up = -scene.gravity.try_normalize(0.0).unwrap_or_default();
    measure::center_of_mass(&scene.model.particles, &state.positions).dot(&up)
}

/// The largest of some values; 0 of none.
pub fn largest(values: impl IntoIterator<Item = Real>) -> Real {
    values.into_iter().fold(0.0, Real::max)
}

/// Median of some times; 0 of none.
pub fn median(values: &mut [Real]) -> Real {
    values.sort_by(Real::total_cmp);
    match values.len() {
        0 => 0.0,
        n if n % 2 == 1 => values[n / 2],
        n => 0.5 * (values[n / 2 - 1] + values[n / 2]),
    }
}

fn median_count(values: &mut [u32]) -> u32 {
    values.sort_unstable();
    values.get(values.len() / 2).copied().unwrap_or(0)
}
