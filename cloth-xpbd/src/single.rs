//! XPBD in single precision: sweeps over springs and vector rows with four SIMD lanes. Behind the feature `single`.
//!
//! # Idea
//! A sweep in double precision spends its time on a root, a division, and the moving of numbers of eight bytes.
//! In single precision a position and its inverse mass fit one register, and a root of four springs takes as
//! long as that of one. The price is digits, and so only the sweeps are done this way: positions and velocities
//! stay in double precision, and of a substep's sweeps only the *change* is added to them.
//!
//! ```text
//! v ← v + h f/m,  x̃ ← x + h v                  double; f: gravity and loads
//! y ← x̃ − o, rounded; y₀ ← y                   o: the centre of the cloth
//! n sweeps on y, λ                             single; the same equations as XpbdSolver
//! x ← x̃ + (y − y₀),  v ← v + (x − x̃)/h         double
//! ```
//!
//! The air and contact move x, in double precision, after every sweep; y is rounded anew from it then.
//!
//! Rounding then causes no drift, but noise. The sweeps see positions rounded to 6e-8 of the size s of the cloth. For a
//! spring of length l that is a strain of about `6e-8 s/l`, and in a velocity `6e-8 s/h`; of a correction by g h² two
//! digits are left where `h > √(100 · 6e-8 s/g)`, 0.8 ms for 1 m ([more](crate::XpbdSolver#rounding)). A sheet of 33 ×
//! 33 vertices and 1 m, falling for 20 steps of 20 substeps, differs from that in double precision by 3.2e-6 in the
//! strain of its springs (rms, of 8.8e-3) and by at most 4.3e-5 m in its positions (`cargo test --release -p cloth-xpbd
//! --features single --test all single -- --nocapture`). In return a sweep over springs takes half the time
//! (`cargo bench -p benches --bench sweeps`).
//!
//! Springs go in packs of four of one colour, so that no two share a vertex. A pack is an element of eight
//! vertices, and is coloured and shared by threads like any other. The rows of a
//! [`VectorRow`](cloth_core::element::VectorRow), those of a quadratic hinge or an attachment, are the three
//! coordinates of one register.
//!
//! | what | where |
//! |---|---|
//! | Δλ of four springs | `single/springs.rs` |
//! | Δλ of a vector row | `single/vector_rows.rs` |
//! | from double precision and back | `single/positions.rs` |
//! | the loop around them | [`SingleXpbd`] |
//!
//! # Example
//! ```
//! use cloth_core::cloth::{Cloth, Membrane};
//! use cloth_core::math::Vec3;
//! use cloth_core::mesh::generate::{Diagonals, grid};
//! use cloth_core::particles::State;
//! use cloth_core::step::{StepInput, Stepper};
//! use cloth_xpbd::single::{SingleConfig, SingleXpbd};
//!
//! let mesh = grid(17, 17, 1.0, 1.0, Diagonals::Alternating)?;
//! let cloth = Cloth { areal_density: 0.2, membrane: Membrane::SpringStiffness(1e4), bending_rigidity: 1e-5 };
//! let mut model = cloth.on(&mesh)?;
//! for vertex in 0..17 {
//!     model.particles.prescribe(vertex)?; // held by an edge
//! }
//! let mut solver = SingleXpbd::builder(&model.particles)
//!     .springs(&model.springs)
//!     .vector_rows(&model.hinges)
//!     .config(SingleConfig { substeps: 20, ..Default::default() })
//!     .build()?;
//! let mut state = State::at_rest(mesh.positions().to_vec());
//! let along = Vec3::y() * 9.81; // along the sheet
//! for _ in 0..60 {
//!     solver.step(&mut state, StepInput::new(1.0 / 60.0).gravity(along))?;
//! }
//! let mean = state.positions[16 * 17..].iter().map(|x| x.y).sum::<f64>() / 17.0;
//! assert!((mean - 1.0).abs() < 0.01, "{mean}"); // hardly longer than it was
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limits
//! - Springs and vector rows whose rest data do not change with time; coloured sweeps; no damping, no extrapolation, no
//!   forces read out. For all that there is [`XpbdSolver`](crate::XpbdSolver).
//! - α̃ counts beside w̃ down to 6e-8 w̃. Below, `k h² w̃ > 1.7e7`, a visit divides by w̃ as that of a hard row does,
//!   and α̃λ is less than 6e-8 of what λ has moved C by: a spring so stiff acts as hard. Above 1e30 α̃ is kept at 1e30
//!   (unit of C² per kg m²): the row moves nothing that can be seen.
//! - Where a colour's last pack is not full, springs are visited in another order than by
//!   [`XpbdSolver`](crate::XpbdSolver): iterates agree nearly, and converged results as those of two orders do
//!   ([order](crate#order-of-the-constraints-colours-and-threads)).

mod positions;
mod springs;
mod vector_rows;

use crate::update::XpbdUpdate;
use cloth_core::cloth::Elements;
use cloth_core::element::Constraint;
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::position_based::{Motion, check_counts};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, StepError, StepInput, StepReport, Stepper};
use positions::Positions;
use springs::Springs;
use std::fmt::Debug;
use vector_rows::VectorRows;
use wide::f32x4;

/// Settings of [`SingleXpbd`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SingleConfig {
    /// Sweeps over all constraints per substep, at least 1.
    pub iterations: u32,
    /// Substeps per step, at least 1.
    pub substeps: u32,
}

impl Default for SingleConfig {
    /// Twenty substeps of one sweep, as [`XpbdConfig`](crate::XpbdConfig).
    fn default() -> Self {
        Self {
            iterations: 1,
            substeps: 20,
        }
    }
}

/// XPBD whose sweeps are in single precision; see the [module documentation](self).
#[derive(Debug)]
pub struct SingleXpbd {
    motion: Motion,
    families: Vec<Box<dyn Family>>,
    positions: Positions,
    config: SingleConfig,
}

/// Elements of one kind with their multipliers.
trait Family: Debug + Send + Sync {
    /// Computes the compliances for `update` and an origin (m).
    fn prepare(&mut self, update: XpbdUpdate, origin: &Vec3);
    /// λ = 0.
    fn reset(&mut self);
    /// One sweep over positions (m, relative to the origin) with the inverse mass (1/kg) as the fourth number.
    fn sweep(&mut self, x: &mut [f32x4]);
    /// Shows `Jᵀλ` (kg m) of each row at prescribed vertices, each with its number.
    fn each_pin_impulse(&self, x: &[f32x4], see: &mut dyn FnMut(usize, Vec3));
}

/// Whether the fourth number, the inverse mass, is that of a prescribed vertex.
fn is_prescribed(x: &f32x4) -> bool {
    x.to_array()[3] == 0.0
}

impl SingleXpbd {
    /// Starts with the masses and prescribed vertices of `particles` as they are now, and without constraints.
    #[must_use]
    pub fn builder(particles: &Particles) -> SingleBuilder {
        SingleBuilder {
            solver: Self {
                motion: Motion::new(particles),
                families: Vec::new(),
                positions: Positions::new(particles.len()),
                config: SingleConfig::default(),
            },
            error: None,
        }
    }
}

impl Stepper for SingleXpbd {
    fn name(&self) -> &'static str {
        "xpbd-single"
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        self.motion.begin(state, &mut input)?;
        let h = input.dt / Real::from(self.config.substeps);
        let origin = self.positions.center(self.motion.positions());
        for family in &mut self.families {
            family.prepare(XpbdUpdate::new(h, 0.0), &origin);
        }
        for _ in 0..self.config.substeps {
            self.motion.predict(&mut input, h)?; // v ← v + h f/m, x̃ ← x + h v
            let others_move = input.air.is_some() || input.contact_constraints().is_some();
            self.positions
                .round(self.motion.positions(), self.motion.inverse_mass());
            for family in &mut self.families {
                family.reset();
            }
            for iteration in 1..=self.config.iterations {
                let is_last = iteration == self.config.iterations;
                let shown = is_last || others_move || input.observer.is_some();
                if others_move && iteration > 1 {
                    self.positions
                        .round(self.motion.positions(), self.motion.inverse_mass());
                }
                self.motion.iterate(&mut input, |_, x| {
                    for family in &mut self.families {
                        family.sweep(self.positions.as_mut_slice()); // Δλ of every row, y moved along
                    }
                    if shown {
                        self.positions.add_change(x);
                    }
                });
            }
            if self.motion.needs_pin_forces() {
                // As in double precision: each moved by h v against Jᵀλ/h².
                let (x, motion) = (self.positions.as_slice(), &mut self.motion);
                for family in &self.families {
                    family.each_pin_impulse(x, &mut |vertex, impulse| {
                        motion.add_pin_impulse(&mut input, vertex, impulse);
                    });
                }
            }
            self.motion.update_velocities(&mut input)?; // v ← v + (x − x̃)/h
        }
        self.motion.finish(state, &mut input)
    }
}

/// Collects particles, elements and settings of a [`SingleXpbd`].
#[derive(Debug)]
pub struct SingleBuilder {
    solver: SingleXpbd,
    /// The first error found.
    error: Option<BuildError>,
}

impl SingleBuilder {
    /// Adds springs. A sweep visits families in the order in which they were added.
    #[must_use]
    pub fn springs(self, springs: &[Spring]) -> Self {
        self.add(springs, |count| Springs::new(springs, count).map(boxed))
    }

    /// Adds elements whose rows are a [`VectorRow`](cloth_core::element::VectorRow): quadratic hinges, attachments.
    #[must_use]
    pub fn vector_rows<const N: usize, E: Constraint<N>>(self, elements: &[E]) -> Self {
        self.add(elements, |count| {
            VectorRows::<N>::new(elements, count).map(boxed)
        })
    }

    /// Adds all elements of a cloth, as [`ClothModel::families`](cloth_core::ClothModel::families) has them.
    #[must_use]
    pub fn elements(mut self, families: Vec<Elements>) -> Self {
        for family in families {
            match family {
                Elements::Springs(springs) | Elements::Links(springs) => {
                    self = self.springs(&springs);
                }
                Elements::Quadratic(hinges) => self = self.vector_rows(&hinges),
                other => {
                    let error = other.unsupported(
                        "depends on one distance or is one vector row, in single precision",
                    );
                    self.error = self.error.or(Some(error));
                }
            }
        }
        self
    }

    fn add<const N: usize, E: Constraint<N>>(
        mut self,
        elements: &[E],
        family: impl FnOnce(usize) -> Result<Box<dyn Family>, BuildError>,
    ) -> Self {
        if self.error.is_none() {
            let count = self.solver.motion.vertex_count();
            let family = cloth_core::method::family::check_vertices(elements, count)
                .and_then(|()| family(count))
                .map_err(|error| error.in_family(self.solver.families.len()));
            match family {
                Ok(family) => self.solver.families.push(family),
                Err(error) => self.error = Some(error),
            }
        }
        self
    }

    /// Replaces the settings.
    #[must_use]
    pub fn config(mut self, config: SingleConfig) -> Self {
        self.solver.config = config;
        self
    }

    /// The solver.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`]; [`BuildError::NoSuchVertex`]; [`BuildError::RepeatedVertex`];
    /// [`BuildError::InvalidElement`];
    /// [`BuildError::SettingsConflict`] and [`BuildError::UnsupportedElements`] for elements that are not a vector row;
    /// the former also where rest data change with time.
    pub fn build(self) -> Result<SingleXpbd, BuildError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        let SingleConfig {
            iterations,
            substeps,
        } = self.solver.config;
        check_counts(iterations, substeps)?;
        Ok(self.solver)
    }
}

fn boxed<F: Family + 'static>(family: F) -> Box<dyn Family> {
    Box::new(family)
}

/// `α̃` in single precision. NaN stays NaN, and the step ends in an error.
fn scaled_compliance(update: XpbdUpdate, stiffness: Real) -> f32 {
    let compliance = update.scaled_compliance(stiffness) as f32;
    if compliance > MAX_SCALED_COMPLIANCE {
        MAX_SCALED_COMPLIANCE
    } else {
        compliance
    }
}

/// Stands for `α̃ = ∞` of a row without stiffness, so that `α̃λ` has a value.
const MAX_SCALED_COMPLIANCE: f32 = 1e30;

/// Nothing can change a row whose `w̃ + α̃` is not above this.
const SMALLEST: f32 = 1e-30;
