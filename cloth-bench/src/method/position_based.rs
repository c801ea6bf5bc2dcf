//! Settings of the position-based methods.

use crate::error::BenchError;
use crate::scene::Scene;
use crate::settings::{Auto, Choice, Or, Parameter, Range::*, Setting, Settings, Table};
use cloth_core::cloth::Elements;
use cloth_core::math::Real;
use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_pbd::{Hierarchy, HierarchyConfig, PbdConfig, StiffnessRule};
use cloth_xpbd::single::SingleConfig;
use cloth_xpbd::{SubstepRule, XpbdConfig};

crate::settings! {
    /// Of position-based dynamics.
    pub(super) struct Pbd {
        iterations: u32 = 20 in AtLeast(1.0), "sweeps per substep";
        substeps: Or<Substeps, u32> = 1 in AtLeast(1.0),
            "parts of a step, or auto (studies take 1): as many as xpbd takes for its strain, fewer by the root of the \
             iterations";
        projection: Or<Material, Real> = "material" in Within(0.0, 1.0),
            "stiffness of the projections: material (one constraint alone shows its k), or a number";
        hierarchy: Option<Or<Once, u32>> = "none" in AtLeast(1.0),
            "correction by coarse levels: none, once (in a substep), or the number of sweeps from one to the next";
    }
    /// Of extended position-based dynamics.
    pub(super) struct Xpbd {
        iterations: u32 = 1 in AtLeast(1.0), "sweeps per substep";
        substeps: Or<Substeps, u32> = "published" in AtLeast(1.0),
            "parts of a step: a number, published (20, in some studies), or auto: as many as leave no more than the \
             given strain on this mesh, with this step and fall";
        precision: Precision = "double",
            "of the sweeps: double, or single (springs and quadratic bending, coloured sweeps as they are)";
        energy_gain: Or<Auto, Option<Real>> = "auto" in Above(0.0),
            "a step that gains more than this fraction of the largest energy so far is taken again with twice as many \
             substeps, up to eight times as many; none: never; auto: 0.01 with substeps=auto in double precision, else \
             none";
    }
    /// Of sweeps.
    pub(super) struct Sweeps {
        strain: Or<Auto, Real> = "auto" in Above(0.0),
            "largest strain that the sweeps may leave of a swing or an impact, with substeps=auto (no more substeps \
             than those with which the springs themselves yield as much); auto: 0.1, or 0.07 where there is something \
             to touch";
        sweep: Sweep = "colored", "how a sweep goes: colored, sequential, jacobi (with averaging) or plain-jacobi";
        relaxation: Real = 1 in Between(0.0, 2.0), "part of its correction that a constraint makes in a visit";
        chebyshev: Option<Or<Auto, Real>> = "none",
            "extrapolation of the sweeps: none, auto (spectral radius estimated), or the spectral radius";
        chebyshev_delay: u32 = 4 in AtLeast(1.0), "plain sweeps of a substep before the extrapolation";
    }
    /// Of constraints with a compliance.
    pub(super) struct ConstraintDamping {
        damping: Real = 0 "s",
            "stiffness-proportional damping β of every constraint, a force −β k Ċ along it; it keeps the strain that \
             sweeps leave, (1 + β/h) times as much with substeps h: no more than some of these";
    }
}

/// Of position-based dynamics, and of its extended form.
pub(super) const PBD: &[&[Parameter]] = &[Pbd::PARAMETERS, Sweeps::PARAMETERS];
pub(super) const XPBD: &[&[Parameter]] = &[
    Xpbd::PARAMETERS,
    Sweeps::PARAMETERS,
    ConstraintDamping::PARAMETERS,
];

crate::choices! {
    /// The published number of substeps, which a study can ask for, or as many as the strain asks for: what
    /// [`run`](crate::commands) takes unless it is told otherwise.
    #[derive(PartialEq)]
    pub(super) enum Substeps { Published = "published", Auto = "auto" }
    /// Stiffness from the material.
    pub(super) enum Material { Material = "material" }
    /// Once a substep.
    pub(super) enum Once { Once = "once" }
    /// Precision of sweeps.
    #[derive(PartialEq)]
    pub(super) enum Precision { Double = "double", Single = "single" }
}

impl Choice for Sweep {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("colored", Self::Colored),
        ("sequential", Self::Sequential),
        ("jacobi", Self::Jacobi),
        ("plain-jacobi", Self::PlainJacobi),
    ];
}

pub(super) const PUBLISHED_SUBSTEPS: u32 = 20;
/// Largest strain to be left in cloth that swings freely, and in cloth that can touch something: what stops it suddenly
/// leaves more energy.
const SWINGING: Real = 0.1;
const TOUCHING: Real = 0.07;
/// With a number of substeps that is chosen.
const CHOSEN_ENERGY_GAIN: Real = 0.01;

/// The number of substeps of position-based dynamics on a scene, for a step of `dt` (s).
pub(super) fn pbd_substeps(
    scene: &Scene,
    settings: &Settings,
    dt: Real,
) -> Result<u32, BenchError> {
    let own = Pbd::read(settings)?;
    substeps(scene, settings, dt, *own.substeps, *own.iterations)
}

/// The same of its extended form.
pub(super) fn xpbd_substeps(
    scene: &Scene,
    settings: &Settings,
    dt: Real,
) -> Result<u32, BenchError> {
    let own = Xpbd::read(settings)?;
    substeps(scene, settings, dt, *own.substeps, *own.iterations)
}

fn substeps(
    scene: &Scene,
    settings: &Settings,
    dt: Real,
    wanted: Or<Substeps, u32>,
    iterations: u32,
) -> Result<u32, BenchError> {
    let sweeps = Sweeps::read(settings)?;
    let given = match wanted {
        Or::Word(Substeps::Auto) => None,
        Or::Word(Substeps::Published) => Some(PUBLISHED_SUBSTEPS),
        Or::Value(count) => Some(count),
    };
    if let Some(count) = given {
        sweeps.strain.refuse_without("substeps=auto")?;
        return Ok(count);
    }
    let rule = SubstepRule {
        strain: match *sweeps.strain {
            Or::Word(Auto::Auto) if scene.can_touch() => TOUCHING,
            Or::Word(Auto::Auto) => SWINGING,
            Or::Value(strain) => strain,
        },
        gravity: scene.gravity,
        fall: scene.fall(),
        driven: scene.driving_speed(),
        tension: scene.lasting_tension()?,
        iterations,
    };
    let particles = &scene.model.particles;
    Ok(rule.substeps(particles, &scene.joined_gauges()?, dt))
}

pub(super) fn pbd(settings: &Settings, substeps: u32) -> Result<PbdConfig, BenchError> {
    let (own, sweeps) = (Pbd::read(settings)?, Sweeps::read(settings)?);
    Ok(PbdConfig {
        iterations: *own.iterations,
        substeps,
        sweep: *sweeps.sweep,
        acceleration: acceleration(&sweeps, &own.iterations)?,
        stiffness: match *own.projection {
            Or::Word(Material::Material) => StiffnessRule::Material,
            Or::Value(stiffness) => StiffnessRule::Fixed(stiffness),
        },
    })
}

pub(super) fn xpbd(settings: &Settings, substeps: u32) -> Result<XpbdConfig, BenchError> {
    let (own, sweeps) = (Xpbd::read(settings)?, Sweeps::read(settings)?);
    let is_chosen =
        *own.substeps == Or::Word(Substeps::Auto) && *own.precision == Precision::Double;
    Ok(XpbdConfig {
        iterations: *own.iterations,
        substeps,
        sweep: *sweeps.sweep,
        acceleration: acceleration(&sweeps, &own.iterations)?,
        damping: *ConstraintDamping::read(settings)?.damping,
        energy_gain: match *own.energy_gain {
            Or::Word(Auto::Auto) => is_chosen.then_some(CHOSEN_ENERGY_GAIN),
            Or::Value(gain) => gain,
        },
    })
}

/// The settings of sweeps in single precision, if that is asked for.
pub(super) fn single(
    settings: &Settings,
    substeps: u32,
) -> Result<Option<SingleConfig>, BenchError> {
    let own = Xpbd::read(settings)?;
    if *own.precision == Precision::Double {
        return Ok(None);
    }
    let iterations = *own.iterations;
    let plain = XpbdConfig {
        iterations,
        substeps,
        ..XpbdConfig::default()
    };
    if xpbd(settings, substeps)? != plain {
        return Err(BenchError::Usage(
            "precision=single needs coloured sweeps without relaxation, extrapolation, damping or energy_gain"
                .into(),
        ));
    }
    Ok(Some(SingleConfig {
        iterations,
        substeps,
    }))
}

/// The coarse levels, if the settings ask for them.
pub(super) fn hierarchy(
    scene: &Scene,
    settings: &Settings,
) -> Result<Option<Hierarchy>, BenchError> {
    let every = match *Pbd::read(settings)?.hierarchy {
        None => return Ok(None),
        Some(Or::Word(Once::Once)) => None,
        Some(Or::Value(count)) => Some(count),
    };
    let Some(mesh) = &scene.mesh else {
        return Err(BenchError::Usage(format!(
            "scene `{}` has no triangles to make coarse levels of",
            scene.name
        )));
    };
    let is_solid = |family: &Elements| matches!(family, Elements::ArapTetrahedra(_));
    if scene.model.others.iter().any(is_solid) {
        return Err(BenchError::usage(
            "hierarchy makes coarse levels of triangles, and cannot be with a solid",
        ));
    }
    let config = HierarchyConfig {
        every,
        ..HierarchyConfig::default()
    };
    Hierarchy::build(mesh, &scene.model.particles, config)
        .map(Some)
        .map_err(BenchError::usage)
}

/// `iterations` are the sweeps of a substep.
fn acceleration(sweeps: &Sweeps, iterations: &Setting<u32>) -> Result<Acceleration, BenchError> {
    let (relaxation, delay) = (*sweeps.relaxation, *sweeps.chebyshev_delay);
    let radius = match *sweeps.chebyshev {
        None => {
            sweeps.chebyshev_delay.refuse_without("chebyshev")?;
            return Ok(Acceleration {
                relaxation,
                chebyshev: None,
            });
        }
        Some(Or::Word(Auto::Auto)) => Radius::Estimated,
        Some(Or::Value(radius)) => Radius::Given(radius),
    };
    // Who says how many sweeps may want fewer: the beginning of a curve, for instance.
    if **iterations <= delay && !iterations.is_given() {
        return Err(BenchError::Usage(format!(
            "chebyshev begins after the {delay} plain sweeps of chebyshev_delay, and iterations is {} unless set: set more",
            **iterations
        )));
    }
    Ok(Acceleration {
        relaxation,
        chebyshev: Some(Chebyshev { radius, delay }),
    })
}
