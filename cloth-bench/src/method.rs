//! Every method by name, with its published setting: one for all scenes.

mod direct;
mod known;
mod mass_spring;
mod own;
mod position_based;
mod projective;
mod strain_limit;

pub(crate) use own::own;
pub use own::{Build, OwnMethod, all, register, with_own};

use crate::error::BenchError;
use crate::names;
use crate::run::Summary;
use crate::scene::{ContactSetup, Scene};
use crate::settings::{Or, Parameter, Settings, Table};
use cloth_core::cloth::Elements;
use cloth_core::energy::{Spring, StrainLimitSpring};
use cloth_core::math::Real;
use cloth_core::method::family::Energies;
use cloth_core::step::{BuildError, Stepper};
use cloth_massspring::{
    Bdf2, ExplicitConfig, ExplicitEuler, ImplicitEuler, ImplicitMidpoint, SymplecticEuler,
    stable_time_step,
};
use cloth_pbd::PbdSolver;
use cloth_pd::PdSolver;
use cloth_xpbd::XpbdSolver;
use cloth_xpbd::direct::DirectXpbd;
use cloth_xpbd::single::SingleXpbd;

/// A method that can be named.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// What can be set of this method, with the published setting.
    parameters: &'static [&'static [Parameter]],
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Explicit,
    Symplectic,
    Implicit,
    LinearImplicit,
    Midpoint,
    Bdf2,
    Pbd,
    Xpbd,
    XpbdDirect,
    Pd,
    Own(OwnMethod),
}

/// More parts of a step than this are a slip of the pen, and more than these are worth a note.
const MOST_SUBSTEPS: Real = 1e6;
const MANY_SUBSTEPS: u32 = 500;
/// How many times as many substeps as were chosen are worth a note.
const MANY_TIMES: u32 = 3;
/// Fraction of the steps with truncated vertices that is worth a warning.
const TRUNCATED: Real = 0.1;
/// Strain at the end of a run of which sweeps may have left a part that is worth a warning: more than their number is
/// chosen for.
const SWEPT_STRAIN: Real = 0.15;

/// Every method of the workspace; [`all`] has those of your own too.
pub const METHODS: [Method; 10] = [
    Method {
        name: "explicit-euler",
        about: "forward Euler: forces at the start of the step",
        parameters: mass_spring::EXPLICIT,
        kind: Kind::Explicit,
    },
    Method {
        name: "symplectic-euler",
        about: "semi-implicit Euler: forces first, then positions with the new velocities",
        parameters: mass_spring::EXPLICIT,
        kind: Kind::Symplectic,
    },
    Method {
        name: "implicit-euler",
        about: "implicit Euler as a minimisation, by a quasi-Newton method around multigrid, or by Newton",
        parameters: mass_spring::NEWTON,
        kind: Kind::Implicit,
    },
    Method {
        name: "linear-implicit",
        about: "implicit Euler with one linear solve a step (Baraff and Witkin); what turns far in a step is slowed: a \
                strip that slides off a pole goes a fifth as far in steps of 1/60 s, two thirds in steps of 1/240 s",
        parameters: mass_spring::LINEARIZED,
        kind: Kind::LinearImplicit,
    },
    Method {
        name: "implicit-midpoint",
        about: "implicit midpoint rule: second order, no damping of its own",
        parameters: mass_spring::NEWTON,
        kind: Kind::Midpoint,
    },
    Method {
        name: "bdf2",
        about: "two-step backward differences: second order, little damping",
        parameters: mass_spring::NEWTON,
        kind: Kind::Bdf2,
    },
    Method {
        name: "pbd",
        about: "position-based dynamics; with one iteration a substep it is xpbd, with its published 20 iterations of one \
                substep it stretches too far (a rope of 20 links of 1 kg and 10⁴ N/m 2.9 times as far as it should, one of \
                80 links 20 times, lighter ones more) and gains energy: xpbd is what it became",
        parameters: position_based::PBD,
        kind: Kind::Pbd,
    },
    Method {
        name: "xpbd",
        about: "extended position-based dynamics, small steps",
        parameters: position_based::XPBD,
        kind: Kind::Xpbd,
    },
    Method {
        name: "xpbd-direct",
        about: "the step of XPBD as one system of positions and multipliers, solved directly",
        parameters: direct::DIRECT,
        kind: Kind::XpbdDirect,
    },
    Method {
        name: "pd",
        about: "projective dynamics",
        parameters: &[projective::Pd::PARAMETERS],
        kind: Kind::Pd,
    },
];

impl Method {
    /// The method of that name.
    pub fn find(name: &str) -> Result<&'static Self, BenchError> {
        names::find("method", name, all(), |method| method.name)
    }

    /// The tables of what can be set, with the published setting: of the method, and of all methods.
    pub fn parameters(&self) -> Vec<&'static [Parameter]> {
        [self.parameters, &[strain_limit::StrainLimit::PARAMETERS]].concat()
    }

    /// Where the published setting is another one than the defaults of the parameters: `key=value` pairs.
    pub(crate) fn defaults(&self) -> &'static str {
        match self.kind {
            Kind::LinearImplicit => "linear_tolerance=1e-8",
            _ => "",
        }
    }

    /// What is known of the method where it gains energy, to be said beside that; starts with a space.
    pub(crate) fn about_energy_gain(&self) -> &'static str {
        match self.kind {
            Kind::Pbd => {
                " (that is pbd's own: what its sweeps leave of a stretch has no force behind it; more substeps of one \
                 iteration leave less, and xpbd takes as many as the mesh asks for)"
            }
            Kind::Xpbd => {
                " (its sweeps end before the forces of a step are in balance, as where pins pull stiff cloth taut; more \
                 substeps leave less of that, and implicit-euler and pd nothing)"
            }
            Kind::LinearImplicit => {
                " (one linear solve a step can make energy where stiff cloth turns fast; a shorter --dt makes it less, \
                 and implicit-euler makes none)"
            }
            Kind::Pd => {
                " (its steps end where what is left of a step is a tenth of the change of velocity, as stiff ropes of \
                 light vertices may leave it; --set velocity_tolerance=0.01 leaves less, and implicit-euler nothing)"
            }
            _ => "",
        }
    }

    /// A sentence about steps whose contact ended vertices of a sweeping method short of where forces would, if there
    /// are so many that it is worth a warning.
    pub(crate) fn truncation_warning(&self, summary: &Summary) -> Option<String> {
        let (truncated, steps) = (summary.truncated_steps, summary.steps);
        let is_worth_it = Real::from(truncated) > TRUNCATED * Real::from(steps);
        (matches!(self.kind, Kind::Xpbd | Kind::Pbd) && is_worth_it).then(|| {
            format!(
                "{truncated} of {steps} steps ended with vertices that had to stop short, so that nothing crosses: no \
                 force has held them, and what rests on them is not all told by --forces; see what `--set \
                 substeps={}` makes of it",
                4 * summary.iterations_per_step.max(1)
            )
        })
    }

    /// A note on a number of substeps that makes the method dear, before a run.
    pub(crate) fn cost_note(
        &self,
        scene: &Scene,
        settings: &Settings,
        dt: Real,
    ) -> Result<Option<String>, BenchError> {
        let count = self.substeps(scene, settings, dt)?;
        Ok((count > MANY_SUBSTEPS).then(|| {
            format!(
                "{} takes {count} substeps a step here: stiff, light or heavily loaded cloth needs them; the steps of \
                 implicit-euler and pd do not depend on that",
                self.name
            )
        }))
    }

    /// A note on a run of which most steps took many more substeps than the rule had chosen.
    pub(crate) fn refinement_note(
        &self,
        (scene, settings, dt): (&Scene, &Settings, Real),
        summary: &Summary,
    ) -> Result<Option<String>, BenchError> {
        if !matches!(self.kind, Kind::Xpbd) || summary.iterations_per_step <= MANY_SUBSTEPS {
            return Ok(None);
        }
        let config = position_based::xpbd(settings, self.substeps(scene, settings, dt)?)?;
        let times = summary.iterations_per_step / (config.substeps * config.iterations).max(1);
        Ok((times >= MANY_TIMES).then(|| {
            format!(
                "half of the steps took {times} times the {} substeps that the mesh asks for, or more: with fewer they \
                 would have gained energy, by more than {} of what there is (`--set energy_gain=none` lets them; the \
                 steps of implicit-euler and pd do not depend on that)",
                config.substeps,
                config.energy_gain.unwrap_or_default()
            )
        }))
    }

    /// A sentence about a stretch in a run of which sweeps may have left a part. Whoever has given a number of substeps
    /// has perhaps tried others, which leave what loads and pins do.
    pub(crate) fn stretch_warning(&self, summary: &Summary, settings: &Settings) -> Option<String> {
        let (strain, sweeps) = (summary.max_stretch_of_all, summary.iterations_per_step);
        let given = settings
            .get("substeps")
            .and_then(|given| given.parse::<u32>().ok());
        let advice = match given {
            None => format!(
                "see what `--set substeps={}` makes of it",
                4 * sweeps.max(1)
            ),
            Some(_) => "what more substeps do not change is the cloth's own".into(),
        };
        (matches!(self.kind, Kind::Xpbd) && strain > SWEPT_STRAIN).then(|| {
            format!(
                "an edge was {:.0} % longer than at rest after one of the steps, at the end {:.0} %: where loads and pins \
                 do not stretch it so, {sweeps} sweeps a step leave some of that, and the motion is another one; \
                 {advice}",
                100.0 * strain,
                100.0 * summary.max_stretch,
            )
        })
    }

    /// Settings of a run that is not a comparison: where the published one leaves more strain the finer the mesh, it is
    /// chosen for the mesh instead.
    pub(crate) fn by_default(&self, settings: Settings) -> Settings {
        match self.kind {
            Kind::Xpbd => Settings::of("substeps=auto").then(&settings),
            Kind::Own(own) => Settings::of(own.by_default).then(&settings),
            _ => settings,
        }
    }

    /// What the published setting is called where it is not the one of [`Method::by_default`].
    pub(crate) fn published(&self) -> String {
        match self.kind {
            Kind::Xpbd => format!(
                "{}, {} substeps",
                self.name,
                position_based::PUBLISHED_SUBSTEPS
            ),
            Kind::Own(own) if !own.by_default.is_empty() => format!("{}, published", self.name),
            _ => self.name.to_owned(),
        }
    }

    /// The same of the command `run`, which gives pbd as many substeps, too; studies show its published setting.
    pub(crate) fn for_run(&self, settings: &Settings) -> Settings {
        Settings::of(self.defaults_of_run()).then(settings)
    }

    /// Where `run` takes another setting than the published one: `key=value` pairs.
    pub(crate) fn defaults_of_run(&self) -> &'static str {
        match self.kind {
            Kind::Pbd | Kind::Xpbd => "substeps=auto",
            Kind::Own(own) => own.by_default,
            _ => "",
        }
    }

    /// A solver for a scene and a step size `dt` (s), or its [parts](Scene::parts), with strain limiting if the
    /// settings ask for it.
    ///
    /// # Errors
    /// [`BenchError::Usage`] for a setting that the method does not know or that is out of range, or an element of the
    /// scene without the view that the method needs.
    pub fn build(
        &self,
        scene: &Scene,
        settings: &Settings,
        dt: Real,
    ) -> Result<Box<dyn Stepper>, BenchError> {
        settings.check(&format!("method `{}`", self.name), &self.parameters())?;
        self.check_hard(scene)?;
        let checked = self.check_pushed(scene);
        let checked = checked.and_then(|()| self.check_volumes(scene));
        let checked = checked.and_then(|()| self.check_restitution(scene));
        checked.map_err(|error| error.at(&scene.file))?;
        // Runs take a step in as many parts.
        let dt = dt / Real::from(scene.parts(dt));
        let substeps = self.substeps(scene, settings, dt)?;
        let settings = &settings.with_defaults(self.defaults());
        let solver = self.solver(scene, settings, dt, substeps)?;
        strain_limit::limited(solver, scene, settings)
    }

    /// Refuses hard constraints where the method has none.
    fn check_hard(&self, scene: &Scene) -> Result<(), BenchError> {
        let reason = match self.kind {
            _ if !scene.is_hard() => return Ok(()),
            Kind::Xpbd => return Ok(()),
            Kind::XpbdDirect => "the constraints of a mesh are redundant, and its system singular",
            Kind::Pbd => "its stiffness ends where its iterations do, whatever is asked for",
            Kind::Pd => "it would be in its constant matrix",
            _ => "it is built on the elastic energy and its derivatives, which would be infinite",
        };
        let what = match scene.is_hard_by_links() {
            true => {
                "links without a finite stiffness, which is what [[link]] has unless it says one"
            }
            false => "stiffness=inf",
        };
        Err(BenchError::Usage(format!(
            "{}`{}` cannot take {what}: {reason}; xpbd takes it, as hard constraints",
            scene.hard_place, self.name
        )))
    }

    /// Refuses bodies that the cloth pushes where they would be thrown back: within a step of PBD a body is where it
    /// will be, its sweeps are as stiff as they are many, and what they push it with grows with them.
    fn check_pushed(&self, scene: &Scene) -> Result<(), BenchError> {
        let is_pushed = |touch: &ContactSetup| touch.free_bodies().next().is_some();
        if matches!(self.kind, Kind::Pbd) && scene.touch.as_ref().is_some_and(is_pushed) {
            return Err(BenchError::usage(
                "`pbd` cannot push an obstacle that has a mass: how hard it pushes depends on its iterations, not on \
                 the material; the other methods can",
            ));
        }
        Ok(())
    }

    /// Refuses restitution where contact is no impulse.
    pub(crate) fn check_restitution(&self, scene: &Scene) -> Result<(), BenchError> {
        let projects = matches!(
            self.kind,
            Kind::Explicit | Kind::Symplectic | Kind::Pbd | Kind::Xpbd | Kind::XpbdDirect
        );
        if projects || !scene.touch.as_ref().is_some_and(ContactSetup::rebounds) {
            return Ok(());
        }
        Err(BenchError::Usage(format!(
            "`{}` cannot take restitution: it minimises along the energy of contact, which ends a step without the velocity \
             of an impact; explicit methods, pbd, xpbd and xpbd-direct can",
            self.name
        )))
    }

    /// A sentence about a method whose energy has no bound in contact, where the scene has any.
    pub(crate) fn contact_warning(&self, scene: &Scene) -> Option<String> {
        let gains = matches!(self.kind, Kind::Midpoint) && scene.can_touch();
        gains.then(|| {
            format!(
                "`{}` damps nothing and gains energy in contact, without a bound: bdf2 is of second order too, and does \
                 not",
                self.name
            )
        })
    }

    /// Refuses sealed volumes where their pressure would not be that of the scene.
    fn check_volumes(&self, scene: &Scene) -> Result<(), BenchError> {
        let reason = match self.kind {
            _ if scene.volumes.is_empty() => return Ok(()),
            Kind::Midpoint => {
                "it damps nothing, and takes what contact brings at the end of a step"
            }
            Kind::Pbd => "how hard the cloth holds it depends on its iterations",
            Kind::XpbdDirect => "it solves the cloth first, as if nothing were inside",
            _ => return Ok(()),
        };
        Err(BenchError::Usage(format!(
            "`{}` cannot take bulk_modulus: {reason}; implicit-euler, pd and xpbd can",
            self.name
        )))
    }

    fn solver(
        &self,
        scene: &Scene,
        settings: &Settings,
        dt: Real,
        substeps: u32,
    ) -> Result<Box<dyn Stepper>, BenchError> {
        let (particles, families) = (&scene.model.particles, scene.model.families());
        macro_rules! solver {
            ($kind:ident, $config:expr) => {{
                let builder = $kind::builder(particles).config($config);
                Box::new(self.built(builder.elements(families).build())?)
            }};
        }
        Ok(match self.kind {
            Kind::Explicit => solver!(ExplicitEuler, explicit(settings, substeps)?),
            Kind::Symplectic => solver!(SymplecticEuler, explicit(settings, substeps)?),
            Kind::Implicit => solver!(ImplicitEuler, mass_spring::newton(scene, settings)?),
            Kind::LinearImplicit => solver!(ImplicitEuler, mass_spring::linearized(settings)?),
            Kind::Midpoint => solver!(ImplicitMidpoint, mass_spring::newton(scene, settings)?),
            Kind::Bdf2 => solver!(Bdf2, mass_spring::newton(scene, settings)?),
            Kind::Pbd => {
                let solver = solver!(PbdSolver, position_based::pbd(settings, substeps)?);
                match position_based::hierarchy(scene, settings)? {
                    Some(levels) => Box::new(self.built(solver.with_hierarchy(levels))?),
                    None => solver,
                }
            }
            Kind::Xpbd => match position_based::single(settings, substeps)? {
                Some(config) => solver!(SingleXpbd, config),
                None => solver!(XpbdSolver, position_based::xpbd(settings, substeps)?),
            },
            Kind::XpbdDirect => solver!(DirectXpbd, direct::direct(settings, substeps)?),
            Kind::Pd => {
                let own = projective::Pd::read(settings)?;
                let config = projective::projective(&own)?;
                let mut builder = PdSolver::builder(particles).config(config);
                if *own.coarse > 0 {
                    builder = builder.coarse_grid(&scene.start.positions, *own.coarse);
                }
                Box::new(self.built(builder.elements(families).build())?)
            }
            Kind::Own(own) => (own.build)(scene, settings, dt)?,
        })
    }

    /// What a builder of the method has made, or why not.
    fn built<T>(&self, solver: Result<T, BuildError>) -> Result<T, BenchError> {
        solver.map_err(|error| match error {
            BuildError::UnsupportedElements { elements, .. } => {
                let instead = match elements {
                    "StVK triangles" => "; membrane=arap has one",
                    "tetrahedra with a volume" => "; a solid with poisson = 0 has none of them",
                    "dihedral hinges" | "cubic-shell hinges" => "; bending=quadratic has one",
                    _ => "",
                };
                BenchError::Usage(format!("`{}` {error}{instead}", self.name))
            }
            _ => BenchError::usage(error),
        })
    }

    /// Into how many parts the method cuts a step of `dt` (s) on a scene.
    pub fn substeps(
        &self,
        scene: &Scene,
        settings: &Settings,
        dt: Real,
    ) -> Result<u32, BenchError> {
        match self.kind {
            Kind::Implicit
            | Kind::LinearImplicit
            | Kind::Midpoint
            | Kind::Bdf2
            | Kind::Pd
            | Kind::Own(_) => Ok(1),
            Kind::Pbd => position_based::pbd_substeps(scene, settings, dt),
            Kind::Xpbd => position_based::xpbd_substeps(scene, settings, dt),
            Kind::XpbdDirect => direct::substeps(scene, settings, dt),
            Kind::Explicit | Kind::Symplectic => {
                if let Or::Value(count) = *mass_spring::Explicit::read(settings)?.substeps {
                    return Ok(count);
                }
                let energies = taut(scene)?;
                let stable =
                    stable_time_step(&energies, &scene.model.particles, &scene.start.positions);
                let wanted = stable.map_or(1.0, |stable| (2.0 * dt / stable).ceil().max(1.0));
                if wanted <= MOST_SUBSTEPS {
                    return Ok(wanted as u32);
                }
                Err(BenchError::Usage(format!(
                    "a stable step of {} needs {wanted:.1e} substeps of {dt} s, more than {MOST_SUBSTEPS:e}",
                    self.name
                )))
            }
        }
    }
}

fn explicit(settings: &Settings, substeps: u32) -> Result<ExplicitConfig, BenchError> {
    Ok(ExplicitConfig {
        substeps,
        damping: mass_spring::damping(settings)?,
        ..Default::default()
    })
}

/// The energy of a scene with all that is slack taut: at the start it may resist nothing, and later all at once.
fn taut(scene: &Scene) -> Result<Energies, BenchError> {
    let taut = |family| match family {
        Elements::Limited(springs) | Elements::SlackLinks(springs) => {
            let one = |s: &StrainLimitSpring| {
                Spring::along(&scene.start.positions, &[s.vertices], s.stiffness)
            };
            Elements::Springs(springs.iter().flat_map(one).collect())
        }
        Elements::LimitedTriangles(triangles) => {
            Elements::LimitedTriangles(triangles.iter().map(|t| t.taut()).collect())
        }
        other => other,
    };
    let families = scene.model.families().into_iter().map(taut);
    Energies::new(scene.model.particles.len())
        .with_elements(families.collect())
        .map_err(BenchError::usage)
}
