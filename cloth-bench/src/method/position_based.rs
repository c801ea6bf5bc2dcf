//! Settings of the position-based methods.

use crate::error::BenchError;
use crate::scene::Scene;
use crate::settings::{Parameter, Settings, parameter};
use cloth_core::math::Real;
use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_pbd::{Hierarchy, HierarchyConfig, PbdConfig, StiffnessRule};
use cloth_xpbd::single::SingleConfig;
use cloth_xpbd::{SubstepRule, XpbdConfig};

const PBD_SUBSTEPS: Parameter = parameter(
    "substeps",
    "1",
    "parts of a step, or auto: as many as xpbd takes for its strain, fewer by the root of the iterations",
);
/// The published setting has a name, so that a study can ask for it; [`run`](crate::commands) takes `auto` unless it is
/// told otherwise.
pub(super) const XPBD_SUBSTEPS: Parameter = parameter(
    "substeps",
    PUBLISHED,
    "parts of a step: a number, published (20), or auto (what run takes): as many as leave no more than the given strain on this mesh, with this step and fall",
);
const PUBLISHED: &str = "published";
const PUBLISHED_SUBSTEPS: u32 = 20;
/// As many substeps as the strain asks for.
pub(crate) const AUTO: &str = "auto";
const STRAIN: Parameter = parameter(
    "strain",
    AUTO,
    "largest strain that the sweeps may leave, with substeps=auto; auto: 0.1, or 0.07 where there is something to touch",
);
/// Largest strain to be left in cloth that swings freely, and in cloth that can touch something: what stops it suddenly
/// leaves more energy.
const SWINGING: Real = 0.1;
const TOUCHING: Real = 0.07;
const PBD_ITERATIONS: Parameter = parameter("iterations", "20", "sweeps per substep");
const PBD_STIFFNESS: Parameter = parameter(
    "projection",
    "material",
    "stiffness of the projections: material (one constraint alone shows its k), or a number from 0 to 1",
);
const XPBD_ITERATIONS: Parameter = parameter("iterations", "1", "sweeps per substep");
const SWEEP: Parameter = parameter(
    "sweep",
    "colored",
    "how a sweep goes: colored, sequential, jacobi (with averaging) or plain-jacobi",
);
const RELAXATION: Parameter = parameter(
    "relaxation",
    "1",
    "part of its correction that a constraint makes in a visit, above 0 and below 2",
);
const CHEBYSHEV: Parameter = parameter(
    "chebyshev",
    "none",
    "extrapolation of the sweeps: none, auto (spectral radius estimated), or the spectral radius",
);
const CHEBYSHEV_DELAY: Parameter = parameter(
    "chebyshev_delay",
    "4",
    "plain sweeps of a substep before the extrapolation",
);

const HIERARCHY: Parameter = parameter(
    "hierarchy",
    "none",
    "correction by coarse levels: none, once a substep, or the number of sweeps from one to the next",
);
pub(super) const XPBD_DAMPING: Parameter = parameter(
    "damping",
    "0",
    "stiffness-proportional damping β (s) of every constraint: a force −β k Ċ along it",
);

const PRECISION: Parameter = parameter(
    "precision",
    "double",
    "of the sweeps: double, or single (springs and quadratic bending, coloured sweeps as they are)",
);

const ENERGY_GAIN: Parameter = parameter(
    "energy_gain",
    AUTO,
    "a step that gains more than this part of the energy in play is taken again with twice as many substeps, up to eight times as many; none: never; auto: 0.01 with substeps=auto in double precision, else none",
);
/// With a number of substeps that is chosen.
const CHOSEN_ENERGY_GAIN: Real = 0.01;

/// Of position-based dynamics.
pub(super) const PBD: &[Parameter] = &[
    PBD_ITERATIONS,
    PBD_SUBSTEPS,
    STRAIN,
    PBD_STIFFNESS,
    HIERARCHY,
    SWEEP,
    RELAXATION,
    CHEBYSHEV,
    CHEBYSHEV_DELAY,
];

/// Of extended position-based dynamics.
pub(super) const XPBD: &[Parameter] = &[
    XPBD_ITERATIONS,
    XPBD_SUBSTEPS,
    STRAIN,
    SWEEP,
    RELAXATION,
    CHEBYSHEV,
    CHEBYSHEV_DELAY,
    XPBD_DAMPING,
    PRECISION,
    ENERGY_GAIN,
];

const SWEEPS: [(&str, Sweep); 4] = [
    ("colored", Sweep::Colored),
    ("sequential", Sweep::Sequential),
    ("jacobi", Sweep::Jacobi),
    ("plain-jacobi", Sweep::PlainJacobi),
];

/// The number of substeps of position-based dynamics on a scene, for a step of `dt` (s).
pub(super) fn pbd_substeps(
    scene: &Scene,
    settings: &Settings,
    dt: Real,
) -> Result<u32, BenchError> {
    substeps(scene, settings, dt, [&PBD_SUBSTEPS, &PBD_ITERATIONS])
}

/// The same of its extended form.
pub(super) fn xpbd_substeps(
    scene: &Scene,
    settings: &Settings,
    dt: Real,
) -> Result<u32, BenchError> {
    substeps(scene, settings, dt, [&XPBD_SUBSTEPS, &XPBD_ITERATIONS])
}

fn substeps(
    scene: &Scene,
    settings: &Settings,
    dt: Real,
    [count, iterations]: [&Parameter; 2],
) -> Result<u32, BenchError> {
    if settings.text(count) != AUTO {
        settings.refuse_without(&STRAIN, "substeps=auto")?;
        return match settings.text(count) {
            PUBLISHED => Ok(PUBLISHED_SUBSTEPS),
            _ => settings.count(count, 1),
        };
    }
    let rule = SubstepRule {
        strain: match settings.text(&STRAIN) {
            AUTO if scene.can_touch() => TOUCHING,
            AUTO => SWINGING,
            _ => settings.positive(&STRAIN)?,
        },
        gravity: scene.gravity,
        fall: scene.fall(),
        tension: scene.lasting_tension(),
        iterations: settings.count(iterations, 1)?,
    };
    let particles = &scene.model.particles;
    let own = rule.substeps(particles, &scene.gauges()?, &scene.start.positions, dt);
    Ok((Real::from(own) * loaded(scene)).ceil() as u32)
}

/// By which factor bodies that the cloth carries need more substeps. The sweeps that a load needs grow with the ratio
/// of its mass to that of what carries it: with the square root of the ratio alone, the scene `ball-in-net` keeps 3 %
/// of stretch, three times what its equilibrium has, and 2 % of energy from nowhere.
fn loaded(scene: &Scene) -> Real {
    let bodies = scene.touch.iter().flat_map(|touch| touch.free_bodies());
    let load: Real = bodies.map(|(_, body)| body.mass()).sum();
    let own: Real = scene.model.particles.mass().iter().sum();
    1.0 + load / own
}

/// Settings with the number of substeps that has been found, and what that says about steps that gain energy.
pub(super) fn with_substeps(settings: &Settings, count: u32) -> Settings {
    let is_chosen = settings.text(&XPBD_SUBSTEPS) == AUTO
        && settings.text(&PRECISION) == PRECISION.default
        && settings.text(&ENERGY_GAIN) == AUTO;
    let found = settings.clone().with(XPBD_SUBSTEPS.name, count);
    match is_chosen {
        true => found.with(ENERGY_GAIN.name, CHOSEN_ENERGY_GAIN),
        false => found,
    }
}

pub(super) fn pbd(settings: &Settings) -> Result<PbdConfig, BenchError> {
    let iterations = settings.count(&PBD_ITERATIONS, 1)?;
    Ok(PbdConfig {
        iterations,
        substeps: settings.count(&PBD_SUBSTEPS, 1)?,
        sweep: settings.choice(&SWEEP, &SWEEPS)?,
        acceleration: acceleration(settings, iterations)?,
        stiffness: match settings.text(&PBD_STIFFNESS) {
            "material" => StiffnessRule::Material,
            _ => StiffnessRule::Fixed(settings.number(&PBD_STIFFNESS)?),
        },
    })
}

pub(super) fn xpbd(settings: &Settings) -> Result<XpbdConfig, BenchError> {
    let iterations = settings.count(&XPBD_ITERATIONS, 1)?;
    Ok(XpbdConfig {
        iterations,
        substeps: settings.count(&XPBD_SUBSTEPS, 1)?,
        sweep: settings.choice(&SWEEP, &SWEEPS)?,
        acceleration: acceleration(settings, iterations)?,
        damping: settings.number(&XPBD_DAMPING)?,
        energy_gain: match settings.text(&ENERGY_GAIN) {
            AUTO | "none" => None,
            _ => Some(settings.positive(&ENERGY_GAIN)?),
        },
    })
}

/// The settings of sweeps in single precision, if that is asked for.
pub(super) fn single(settings: &Settings) -> Result<Option<SingleConfig>, BenchError> {
    if !settings.choice(&PRECISION, &[("double", false), ("single", true)])? {
        return Ok(None);
    }
    let config = SingleConfig {
        iterations: settings.count(&XPBD_ITERATIONS, 1)?,
        substeps: settings.count(&XPBD_SUBSTEPS, 1)?,
    };
    let plain = XpbdConfig {
        iterations: config.iterations,
        substeps: config.substeps,
        ..XpbdConfig::default()
    };
    if xpbd(settings)? != plain {
        return Err(BenchError::Usage(
            "precision=single needs coloured sweeps without relaxation, extrapolation, damping or energy_gain"
                .into(),
        ));
    }
    Ok(Some(config))
}

/// The coarse levels, if the settings ask for them.
pub(super) fn hierarchy(
    scene: &Scene,
    settings: &Settings,
) -> Result<Option<Hierarchy>, BenchError> {
    let every = match settings.text(&HIERARCHY) {
        "none" => return Ok(None),
        "once" => None,
        _ => Some(settings.count(&HIERARCHY, 1)?),
    };
    let Some(mesh) = &scene.mesh else {
        return Err(BenchError::Usage(format!(
            "scene `{}` has no triangles to make coarse levels of",
            scene.name
        )));
    };
    let config = HierarchyConfig {
        every,
        ..HierarchyConfig::default()
    };
    Hierarchy::build(mesh, &scene.model.particles, config)
        .map(Some)
        .map_err(BenchError::usage)
}

/// `iterations` are the sweeps of a substep.
fn acceleration(settings: &Settings, iterations: u32) -> Result<Acceleration, BenchError> {
    let relaxation = settings.number(&RELAXATION)?;
    let radius = match settings.text(&CHEBYSHEV) {
        "none" => {
            settings.refuse_without(&CHEBYSHEV_DELAY, "chebyshev")?;
            return Ok(Acceleration {
                relaxation,
                chebyshev: None,
            });
        }
        "auto" => Radius::Estimated,
        _ => Radius::Given(settings.number(&CHEBYSHEV)?),
    };
    let delay = settings.count(&CHEBYSHEV_DELAY, 1)?;
    // Who says how many sweeps may want fewer: the beginning of a curve, for instance.
    if iterations <= delay && settings.get(XPBD_ITERATIONS.name).is_none() {
        return Err(BenchError::Usage(format!(
            "chebyshev begins after the {delay} plain sweeps of chebyshev_delay, and iterations is {iterations} unless set: set more"
        )));
    }
    Ok(Acceleration {
        relaxation,
        chebyshev: Some(Chebyshev { radius, delay }),
    })
}
