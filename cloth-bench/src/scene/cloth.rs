//! The cloth of a scene: its numbers, and which elements carry it.

use super::{
    BENDING, BENDING_STIFFNESS, DENSITY, MEMBRANE, MODULUS, POISSON, RIGIDITY, SHEAR, STIFFNESS,
};
use crate::error::BenchError;
use crate::settings::{Parameter, Settings, parameter};
use cloth_core::cloth::{
    BendingCarrier, Cloth, ClothModel, CoarseMembrane, Discretization, Membrane, MembraneCarrier,
    SpringEdges, SpringLaw,
};
use cloth_core::math::Real;
use cloth_core::mesh::TriMesh;

pub(super) const COMPRESSION: Parameter = parameter(
    "compression",
    "1",
    "share of the stiffness that springs on edges keep under compression, from 0 to 1",
);
pub(super) const SLACK: Parameter = parameter(
    "slack",
    "none",
    "lengths relative to rest between which springs on edges do not resist, or principal stretches between which membrane=arap does not, such as 0.98,1.02, or none",
);
pub(super) const EDGES: Parameter = parameter(
    "edges",
    "all",
    "edges that carry springs: all, quads (no diagonals), or the share of the coordinates that is to be free, such as 0.2",
);
pub(super) const LEVEL: Parameter = parameter(
    "level",
    "0",
    "coarse level of the mesh that keeps the cloth from stretching, from 1; 0: the mesh itself does",
);
pub(super) const FINE_SHARE: Parameter = parameter(
    "fine_fraction",
    "0.01",
    "part of the modulus that springs on edges keep beside a coarse level, from 0 to 1",
);

/// Cuts the cloth that settings describe to a mesh. `rigidity` is the parameter of the scene for D: scenes differ in
/// its default.
pub(super) fn cut(
    settings: &Settings,
    rigidity: &Parameter,
    mesh: &TriMesh,
) -> Result<ClothModel, BenchError> {
    let cloth = described(settings, rigidity)?;
    let carriers = carriers(settings)?;
    let mut model = cloth
        .discretized_with(&carriers, mesh)
        .map_err(BenchError::usage)?;
    if is_hard(settings) {
        harden(&mut model, |_| true);
    }
    Ok(model)
}

/// Whether the springs on edges are hard constraints.
pub(super) fn is_hard(settings: &Settings) -> bool {
    settings.text(&STIFFNESS).parse() == Ok(Real::INFINITY)
}

/// The stiffness k of springs (N/m), which may be infinite.
pub(super) fn stiffness(settings: &Settings) -> Result<Real, BenchError> {
    if is_hard(settings) {
        return Ok(Real::INFINITY);
    }
    settings.number(&STIFFNESS)
}

/// Makes hard constraints of the springs that begin at vertices which are wanted.
pub(super) fn harden(model: &mut ClothModel, is_wanted: impl Fn(usize) -> bool) {
    let springs = model.springs.iter_mut();
    springs
        .filter(|spring| is_wanted(spring.vertices[0] as usize))
        .for_each(|spring| spring.stiffness = Real::INFINITY);
}

/// Refuses what hard constraints cannot be beside.
fn check_hard(settings: &Settings) -> Result<(), BenchError> {
    let others = [&MEMBRANE, &SHEAR, &COMPRESSION, &SLACK, &EDGES, &LEVEL];
    let mut others = others.into_iter();
    let other = others.find(|key| settings.text(key) != key.default);
    let springs = (settings.text(&BENDING) == "spring").then_some(&BENDING);
    match other.or(springs) {
        None => Ok(()),
        Some(key) => Err(BenchError::Usage(format!(
            "stiffness=inf is of one spring on every edge, and cannot be with {}={}",
            key.name,
            settings.text(key)
        ))),
    }
}

/// The elements that carry it.
pub(super) fn carriers(settings: &Settings) -> Result<Discretization, BenchError> {
    Ok(Discretization {
        membrane: membrane_carrier(settings)?,
        shear: optional(settings, &SHEAR)?,
        bending: bending_carrier(settings)?,
        law: law(settings)?,
        edges: edges(settings)?,
        detail: detail(settings)?,
    })
}

/// The numbers of the cloth, whatever carries it.
pub(super) fn described(settings: &Settings, rigidity: &Parameter) -> Result<Cloth, BenchError> {
    Ok(Cloth {
        areal_density: settings.number(&DENSITY)?,
        membrane: membrane(settings)?,
        bending_rigidity: settings.number(rigidity)?,
    })
}

fn membrane(settings: &Settings) -> Result<Membrane, BenchError> {
    let Some(modulus) = optional(settings, &MODULUS)? else {
        if is_hard(settings) {
            check_hard(settings)?;
            // Hard constraints take the place of these springs.
            return Ok(Membrane::SpringStiffness(1.0));
        }
        return Ok(Membrane::SpringStiffness(settings.number(&STIFFNESS)?));
    };
    if settings.get(STIFFNESS.name).is_some() {
        return Err(BenchError::Usage(
            "modulus and stiffness both say how stiff the membrane is: give one of them".into(),
        ));
    }
    Ok(Membrane::Modulus(modulus))
}

pub(super) fn membrane_carrier(settings: &Settings) -> Result<MembraneCarrier, BenchError> {
    let kind = settings.choice(
        &MEMBRANE,
        &[("springs", "springs"), ("stvk", "stvk"), ("arap", "arap")],
    )?;
    if kind != "stvk" {
        settings.refuse_without(&POISSON, "membrane=stvk")?;
    }
    Ok(match kind {
        "stvk" => MembraneCarrier::Stvk {
            poisson_ratio: settings.number(&POISSON)?,
        },
        "arap" => MembraneCarrier::Arap,
        _ => MembraneCarrier::Springs,
    })
}

fn law(settings: &Settings) -> Result<SpringLaw, BenchError> {
    if settings.text(&SLACK) == SLACK.default {
        let share = settings.number(&COMPRESSION)?;
        return Ok(if share == 1.0 {
            SpringLaw::Linear
        } else {
            SpringLaw::Compression(share)
        });
    }
    if settings.get(COMPRESSION.name).is_some() {
        return Err(BenchError::Usage(
            "slack and compression both say what springs do when they are pushed: give one of them"
                .into(),
        ));
    }
    let text = settings.text(&SLACK);
    let limits = text.split_once(',').and_then(|(least, most)| {
        let number = |text: &str| text.trim().parse::<Real>().ok();
        Some([number(least)?, number(most)?])
    });
    limits.map(SpringLaw::DeadZone).ok_or_else(|| {
        BenchError::Usage(format!(
            "slack is `{text}`, but it has to be two numbers such as 0.98,1.02, or none"
        ))
    })
}

fn edges(settings: &Settings) -> Result<SpringEdges, BenchError> {
    Ok(match settings.text(&EDGES) {
        "all" => SpringEdges::All,
        "quads" => SpringEdges::Quads,
        _ => SpringEdges::DofFraction(settings.number(&EDGES)?),
    })
}

fn detail(settings: &Settings) -> Result<Option<CoarseMembrane>, BenchError> {
    let level = settings.count(&LEVEL, 0)?;
    if level == 0 {
        settings.refuse_without(&FINE_SHARE, "a level of 1 or more")?;
        return Ok(None);
    }
    let fine_fraction = settings.number(&FINE_SHARE)?;
    Ok(Some(CoarseMembrane {
        level,
        fine_fraction,
    }))
}

fn bending_carrier(settings: &Settings) -> Result<BendingCarrier, BenchError> {
    let springs = BendingCarrier::Springs(settings.number(&BENDING_STIFFNESS)?);
    let carrier = settings.choice(
        &BENDING,
        &[
            ("quadratic", BendingCarrier::Quadratic),
            ("dihedral", BendingCarrier::Dihedral),
            ("bridson", BendingCarrier::Bridson),
            ("cubic", BendingCarrier::Cubic),
            ("curved", BendingCarrier::Curved),
            ("spring", springs),
            ("none", BendingCarrier::None),
        ],
    )?;
    if carrier != springs {
        settings.refuse_without(&BENDING_STIFFNESS, "bending=spring")?;
    }
    if carrier == springs || carrier == BendingCarrier::None {
        settings.refuse_without(&RIGIDITY, "bending hinges")?;
    }
    Ok(carrier)
}

/// The value as a number, or none where it says so.
fn optional(settings: &Settings, parameter: &Parameter) -> Result<Option<Real>, BenchError> {
    match settings.text(parameter) {
        "none" => Ok(None),
        _ => settings.number(parameter).map(Some),
    }
}
