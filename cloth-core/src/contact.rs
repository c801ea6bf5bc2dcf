//! The one hook for contact: what a method asks of obstacles and of the cloth itself, without knowing of either.
//!
//! Contact is part of the solve, in one of two views. A method that minimises takes it into what it minimises:
//! [`ContactSource::potential`] gives an energy with derivatives, and says how far a step is safe. A method that moves
//! positions feels it as unilateral constraints in every substep: [`ContactSource::constraints`]; one without sweeps of
//! its own lets [`Projection`] do all of that at the end of its (sub)step. A method without a source in its
//! [`StepInput`](crate::step::StepInput) runs no code for contact. The crate `cloth-collide` has the source.

mod borrowed;
mod global_rows;
mod truncation;

pub use global_rows::{GlobalRow, GlobalRows};
pub use truncation::FadingTruncation;

use crate::math::{Real, Vec3, is_finite};
use std::fmt;

/// A step that a method takes, seen from outside: where the cloth was, and what can be moved.
#[derive(Clone, Copy, Debug)]
pub struct ContactStep<'a> {
    /// Positions (m) at the start of the step, one per vertex.
    pub from: &'a [Vec3],
    /// Inverse masses (1/kg), one per vertex; 0 for a prescribed one.
    pub inverse_mass: &'a [Real],
    /// Step size Δt (s).
    pub dt: Real,
}

impl ContactStep<'_> {
    /// Whether a source for `vertex_count` vertices can work with this step and its end.
    ///
    /// # Errors
    /// If a list has another length, a number is not finite, an inverse mass is negative, or the step size is not
    /// positive.
    pub fn check(
        &self,
        vertex_count: usize,
        positions: &[Vec3],
        velocities: &[Vec3],
    ) -> Result<(), ContactError> {
        let lists = [self.from, positions, velocities];
        let lengths = lists.into_iter().map(<[Vec3]>::len);
        same_length(vertex_count, lengths.chain([self.inverse_mass.len()]))?;
        if !(self.dt > 0.0 && self.dt.is_finite()) {
            return Err(ContactError::InvalidStep { dt: self.dt });
        }
        for vertex in 0..vertex_count {
            if lists.iter().any(|list| !is_finite(&list[vertex])) {
                return Err(ContactError::NonFinite { vertex });
            }
            let inverse_mass = self.inverse_mass[vertex];
            if !(inverse_mass >= 0.0 && inverse_mass.is_finite()) {
                return Err(ContactError::InvalidMass {
                    vertex,
                    inverse_mass,
                });
            }
        }
        Ok(())
    }
}

/// Whether lists have one entry per vertex.
///
/// # Errors
/// [`ContactError::VertexCount`].
pub fn same_length(
    vertex_count: usize,
    lengths: impl IntoIterator<Item = usize>,
) -> Result<(), ContactError> {
    match lengths.into_iter().find(|&found| found != vertex_count) {
        Some(found) => Err(ContactError::VertexCount {
            expected: vertex_count,
            found,
        }),
        None => Ok(()),
    }
}

/// Whatever the cloth can touch, in the two views that methods have of it. A method takes one of them, and keeps to it
/// within a step. A source that is lent, `&mut` one, is a source too.
pub trait ContactSource {
    /// Contact as an energy, for a method that takes it into its own solve.
    fn potential(&mut self) -> &mut dyn ContactPotential;

    /// Contact as constraints, for a method that projects positions.
    fn constraints(&mut self) -> &mut dyn ContactConstraints;

    /// Changes `x` (m), to which something else has moved the cloth after a step that ended at `from` (m), so that the
    /// straight paths there are free of crossings. No time passes: bodies stay, and nothing but what would cross is
    /// moved. `inverse_mass` (1/kg) is as in [`ContactStep`].
    ///
    /// # Errors
    /// [`ContactError::Infeasible`], [`ContactError::NonFinite`].
    fn keep_free(
        &mut self,
        from: &[Vec3],
        inverse_mass: &[Real],
        x: &mut [Vec3],
    ) -> Result<(), ContactError>;

    /// Work (J) that moving bodies, and prescribed vertices by contact, did on the cloth in the last step; 0 for a
    /// source without any.
    fn work(&self) -> Real {
        0.0
    }

    /// Energy (J) that contact has stored at the end of the last step, or at the start of one that has begun, and may
    /// give back; 0 for a source without a potential.
    fn potential_energy(&self) -> Real {
        0.0
    }

    /// Takes back the step that has ended last, of either view, for a method that does not take it after all: the next one
    /// begins where that has begun, with bodies as they were there. A source in which nothing moves leaves it out.
    fn take_back(&mut self) {}

    /// Whether there is anything to touch. If not, a step is one without contact.
    fn can_touch(&self) -> bool {
        true
    }

    /// Whether a step of `dt` (s) can begin at `time` (s), that of the state: a source with bodies that move by
    /// themselves has them where the last step has ended, and a state that was put back in time without them, or on,
    /// would meet them elsewhere. [`StepInput::check`](crate::step::StepInput::check) asks before each step.
    ///
    /// # Errors
    /// [`ContactError::WrongTime`].
    fn check_time(&self, time: Real, dt: Real) -> Result<(), ContactError> {
        let _ = (time, dt);
        Ok(())
    }

    /// How often the last step has truncated the displacement of a vertex: it is safe then, but has not gone as far as
    /// contact would let it, and has lost momentum. A vertex may be counted anew in each round of each substep, so the
    /// sum can be more than there are vertices. 0 for a source that does not do that.
    fn truncated_count(&self) -> usize {
        0
    }
}

/// Contact as an energy that a method feels while it solves: a term of the function it minimises.
///
/// A step goes like this: [`ContactPotential::begin`]; then for every path that is about to be taken
/// [`ContactPotential::limit`] or [`ContactPotential::limit_each`], and no further than they say;
/// [`ContactPotential::add_gradient`] at places on the last path; [`ContactPotential::end`]. So every place that is
/// accepted, and every straight path between two of them, is free of crossings.
pub trait ContactPotential: fmt::Debug + Send + Sync {
    /// Begins a step. `start` (m) is where the method would begin to iterate, with prescribed vertices where they will
    /// end; the displacements of free ones from `step.from` are truncated as far as has to be, or led around what
    /// moves.
    ///
    /// # Errors
    /// If the start of the step is not in order, `start` is too far ([`ContactError::TooFar`]), or prescribed vertices
    /// or obstacles have no free path.
    fn begin(&mut self, step: &ContactStep<'_>, start: &mut [Vec3]) -> Result<(), ContactError>;

    /// The fraction of the straight path from `from` to `to` (m) that is safe (dimensionless, 0..=1), and gets ready
    /// for places up to there, until the next call. Below 1 it need not mean a contact: of a long path only the
    /// beginning is tested.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`].
    fn limit(&mut self, from: &[Vec3], to: &[Vec3]) -> Result<Real, ContactError>;

    /// The same for each vertex by itself, so that one contact does not stop what is far from it: truncates the
    /// displacements of vertices, which go on straight paths from `from` to `to` (m) until all paths together are safe,
    /// and gets ready for places on them. `fractions` becomes what is left of each path (dimensionless, 0..=1).
    ///
    /// # Errors
    /// [`ContactError::NonFinite`].
    fn limit_each(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        fractions: &mut [Real],
    ) -> Result<(), ContactError>;

    /// Adds the gradient (N) of the energy at `x` (m), a place on the last path, to `out`, and returns the energy (J);
    /// infinite where something touches.
    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real;

    /// Appends to `out` the terms of the second derivative at `x` (m), a place on the last path, without those that
    /// would make it indefinite.
    fn linearize(&self, x: &[Vec3], out: &mut Vec<ContactRow>);

    /// The same of terms that couple more vertices than a [`ContactRow`] has: appends them to `out`. Most sources have
    /// none, and leave it out; a method that cannot use them has to refuse a source that has some.
    fn linearize_globally(&self, x: &[Vec3], out: &mut GlobalRows) {
        let _ = (x, out);
    }

    /// Appends to `out`, for each term of [`linearize`](Self::linearize) at `x` and in their order, by how much (m) its
    /// distance at `to` differs from what the term says, `d(to) − d(x) − J·(to − x)`; d is negative where `to` is on
    /// the other side. A source that knows only the first of them, or none, appends no more.
    fn linearization_errors(&self, x: &[Vec3], to: &[Vec3], out: &mut Vec<Real>) {
        let _ = (x, to, out);
    }

    /// Takes notice of a direction (m) from `x` (m), where the terms were taken last, that nearly solves a system with
    /// them: of which forces contacts have in that solution. The terms that are taken next may be as stiff as a
    /// primal–dual method has them, with these forces as multipliers (Nocedal and Wright 2006, section 19.3). Most
    /// sources have no use for it.
    fn update_multipliers(&mut self, x: &[Vec3], direction: &[Vec3]) {
        let _ = (x, direction);
    }

    /// Whether there are bodies that the forces at the end of a step push: a step that ends too early sends them
    /// elsewhere.
    fn has_free_bodies(&self) -> bool {
        false
    }

    /// Ends the step, which the method has ended at `x` (m) with velocities `v` (m/s): obstacles move on. A source may
    /// take from `v` what is no motion: that by which it has led out what started inside of a body.
    fn end(&mut self, x: &[Vec3], v: &mut [Vec3]);
}

/// Contact as unilateral constraints that a method feels in every sweep of every substep.
///
/// A step goes like this: [`ContactConstraints::begin_step`]; for each substep [`ContactConstraints::begin_substep`]
/// after the prediction, [`ContactConstraints::sweep`] last in each sweep, [`ContactConstraints::end_substep`] before
/// the velocities follow from the positions and [`ContactConstraints::change_velocities`] after it;
/// [`ContactConstraints::end_step`]. A step that ends with an error before that has not been taken, and the next
/// `begin_step` resets everything but the state of friction, and the order in which pairs are visited.
pub trait ContactConstraints {
    /// Begins a step.
    ///
    /// # Errors
    /// If the start of the step is not in order.
    fn begin_step(&mut self, step: &ContactStep<'_>) -> Result<(), ContactError>;

    /// Begins a substep of `step.dt`, in which vertices would fly from `step.from` to `predicted` (m): finds what can
    /// touch.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`], [`ContactError::TooFar`].
    fn begin_substep(
        &mut self,
        step: &ContactStep<'_>,
        predicted: &[Vec3],
    ) -> Result<(), ContactError>;

    /// Projects the positions `x` (m) onto one constraint after another. Prescribed vertices stay.
    fn sweep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]);

    /// Makes sure that the straight paths from `step.from` to `x` (m) are free of crossings, and changes `x` where they
    /// are not.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`], [`ContactError::Infeasible`].
    fn end_substep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) -> Result<(), ContactError>;

    /// Changes the velocities (m/s) that follow from the positions, where those have been moved by what is not to
    /// become a velocity.
    fn change_velocities(&mut self, velocities: &mut [Vec3]);

    /// Energy (J) that the cloth, at `x` (m) now, was given since [`ContactConstraints::begin_step`] by bodies, by
    /// prescribed vertices through contact, and out of what contact had stored; 0 for a source that knows of none.
    fn given(&mut self, x: &[Vec3]) -> Real {
        let _ = x;
        0.0
    }

    /// Ends the step, which has come to `x` (m).
    fn end_step(&mut self, x: &[Vec3]);
}

/// Contact constraints at the end of the (sub)steps of a method that has no sweeps of its own for them to be part of.
#[derive(Clone, Debug, Default)]
pub struct Projection {
    /// Where the method has moved the cloth as if it were alone (m).
    free: Vec<Vec3>,
}

impl Projection {
    /// One substep between [`ContactConstraints::begin_step`] and [`ContactConstraints::end_step`]: projects `x` (m),
    /// which the method has found with the velocities `v` (m/s) there, by `sweeps` sweeps, and lets the velocities
    /// follow, `v ← v + Δx/Δt`.
    ///
    /// # Errors
    /// Those of the constraints; `x` and `v` are of no use then.
    pub fn substep(
        &mut self,
        contacts: &mut dyn ContactConstraints,
        step: &ContactStep<'_>,
        sweeps: u32,
        x: &mut [Vec3],
        v: &mut [Vec3],
    ) -> Result<(), ContactError> {
        same_length(x.len(), [v.len()])?;
        if let Some(vertex) = v.iter().position(|v| !is_finite(v)) {
            return Err(ContactError::NonFinite { vertex });
        }
        self.free.clear();
        self.free.extend_from_slice(x);
        contacts.begin_substep(step, x)?;
        for _ in 0..sweeps {
            contacts.sweep(step, x);
        }
        contacts.end_substep(step, x)?;
        for (v, (x, free)) in v.iter_mut().zip(x.iter().zip(&self.free)) {
            *v += (x - free) / step.dt;
        }
        contacts.change_velocities(v);
        Ok(())
    }

    /// A whole step of one substep.
    ///
    /// # Errors
    /// As [`Projection::substep`].
    pub fn step(
        &mut self,
        contacts: &mut dyn ContactConstraints,
        step: &ContactStep<'_>,
        sweeps: u32,
        x: &mut [Vec3],
        v: &mut [Vec3],
    ) -> Result<(), ContactError> {
        contacts.begin_step(step)?;
        self.substep(contacts, step, sweeps, x, v)?;
        contacts.end_step(x);
        Ok(())
    }
}

/// One term of the second derivative of a contact energy: `k J Jᵀ`, with J the derivative of a distance by up to four
/// vertices, `J_i = w_i n`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactRow {
    /// The vertices.
    pub vertices: [u32; 4],
    /// w (dimensionless): zero for a vertex that does not take part.
    pub weights: [Real; 4],
    /// n (unit length).
    pub normal: Vec3,
    /// k (N/m), not negative.
    pub stiffness: Real,
}

impl ContactRow {
    /// Whether it lies between vertices alone, whose weights then add up to 0; to ±1 where a body takes part, from
    /// which a force comes.
    #[must_use]
    pub fn is_internal(&self) -> bool {
        self.weights.iter().sum::<Real>().abs() < 0.5
    }

    /// `k J (J·p)`, for displacements `p` (m) of all vertices: adds it to `out` (N).
    pub fn add_product(&self, p: &[Vec3], out: &mut [Vec3]) {
        let ends = || self.vertices.iter().zip(self.weights);
        let along: Real = ends()
            .map(|(v, w)| w * self.normal.dot(&p[*v as usize]))
            .sum();
        let force = self.normal * (self.stiffness * along);
        ends().for_each(|(v, w)| out[*v as usize] += force * w);
    }
}

/// Why contact could not be resolved.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ContactError {
    /// The source was made for another cloth.
    VertexCount {
        /// Number of vertices it was made for.
        expected: usize,
        /// Number of positions it got.
        found: usize,
    },
    /// A position or velocity is not finite.
    NonFinite {
        /// The first such vertex.
        vertex: usize,
    },
    /// The step size is not a positive finite number.
    InvalidStep {
        /// Δt (s).
        dt: Real,
    },
    /// An inverse mass is neither zero nor a positive finite number.
    InvalidMass {
        /// The first such vertex.
        vertex: usize,
        /// 1/kg.
        inverse_mass: Real,
    },
    /// The step starts with triangles that cross each other, so nothing can be guaranteed.
    IntersectingStart {
        /// Number of pairs of triangles that do.
        pairs: usize,
        /// Corners of the first of them, a triangle of the cloth.
        triangle: [u32; 3],
        /// The body that it crosses: obstacles first, then animated surfaces; `None` for the cloth itself.
        body: Option<usize>,
    },
    /// A vertex would go so far that its coordinates no longer tell distances of contact apart: it is far too fast.
    TooFar {
        /// The vertex.
        vertex: usize,
        /// Its largest coordinate there (m), without the sign.
        coordinate: Real,
        /// The most that it may be (m).
        most: Real,
    },
    /// The step does not begin where the last one has left the bodies that move.
    WrongTime {
        /// At which time the step begins (s).
        time: Real,
        /// At which it would have to (s).
        expected: Real,
    },
    /// Prescribed vertices or obstacles leave no path that is free.
    Infeasible {
        /// A vertex that has none.
        vertex: u32,
        /// Whether it is prescribed (a pin, for instance), so that it cannot give way.
        is_prescribed: bool,
        /// A body in its way, or in that of what is in its way: obstacles first, then animated surfaces; `None` if it
        /// is the cloth alone, or not known.
        body: Option<usize>,
    },
}

impl fmt::Display for ContactError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::VertexCount { expected, found } => write!(
                f,
                "contact was set up for {expected} vertices, but the cloth has {found}"
            ),
            Self::NonFinite { vertex } => {
                write!(
                    f,
                    "contact was asked about vertex {vertex}, which is not finite"
                )
            }
            Self::InvalidStep { dt } => {
                write!(
                    f,
                    "contact was asked about a step of {dt} s; a step is a positive finite time"
                )
            }
            Self::InvalidMass {
                vertex,
                inverse_mass,
            } => write!(
                f,
                "contact was told an inverse mass of {inverse_mass} 1/kg for vertex {vertex}; it is 0 or a positive \
                 finite number"
            ),
            Self::IntersectingStart {
                pairs,
                triangle: [a, b, c],
                body,
            } => {
                let other = body.map_or("the cloth itself".into(), |n| format!("body {n}"));
                write!(
                    f,
                    "{pairs} pairs of triangles pass through each other at the start of the step, the first of them \
                     one with vertices {a}, {b} and {c} of the cloth and one of {other}; untangle them first"
                )
            }
            Self::TooFar {
                vertex,
                coordinate,
                most,
            } => write!(
                f,
                "vertex {vertex} would go to a coordinate of {coordinate:.3e} m, but beyond {most:.3e} m rounding is \
                 more than a hundredth of the thickness of contact: it is too fast"
            ),
            Self::WrongTime { time, expected } => write!(
                f,
                "the step begins at {time} s, but moving bodies are where they are at {expected} s: contacts belong \
                 to the state that they have come with: restore a clone of both, build them anew at its time, or \
                 tell them `continue_at` where bodies are to stay"
            ),
            Self::Infeasible {
                vertex,
                is_prescribed,
                body,
            } => {
                let prescribed = if *is_prescribed { "prescribed " } else { "" };
                let before = body.map_or(String::new(), |n| format!(" before body {n}"));
                write!(
                    f,
                    "prescribed vertices or obstacles leave no free path to {prescribed}vertex {vertex}{before}"
                )
            }
        }
    }
}

impl std::error::Error for ContactError {}
