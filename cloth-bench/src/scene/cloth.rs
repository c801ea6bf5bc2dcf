//! The cloth of a scene: its numbers, and which elements carry it.

use crate::error::BenchError;
use crate::settings::{Infinite, Or, Range::*, Settings, Table};
use cloth_core::cloth::{
    BendingElements, Cloth, ClothModel, CoarseMembrane, DirectionalModulus, Discretization,
    Membrane, MembraneElements, Piece, SpringEdges, SpringLaw,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::{TriMesh, vertex_normals};

crate::settings! {
    /// Of cloth and of chains.
    pub(crate) struct Stiffness {
        stiffness: Or<Infinite, Real> = 1e4 "N/m" in AtLeast(0.0),
            "stiffness k of every spring, or inf: hard constraints, with xpbd alone";
    }
    /// Of cloth.
    pub(crate) struct Material {
        density: Real = 0.2 "kg/m²" in Above(0.0), "areal density";
        modulus: Option<Real> = "none" "N/m",
            "membrane modulus Y in the place of the stiffness of springs, or none; springs have it in the mean over all \
             directions, and a quarter less on irregular meshes, whose vertices give way; triangles on every mesh";
        membrane: MembraneName = "springs",
            "elements that resist stretching: springs, stvk or arap; triangles get the modulus that springs of the \
             given stiffness have";
        poisson: Real = 0.3333333333333333 in Between(-1.0, 1.0), "Poisson's ratio of stvk; springs have 1/3";
        shear: Option<Real> = "none" "N/m",
            "stiffness of springs along both diagonals of rectangular cells, or none: one diagonal, as stiff as the \
             other edges";
        rigidity: Real = 1e-5 "N·m", "bending rigidity D";
        bending: BendingName = "quadratic",
            "elements that resist bending: quadratic, dihedral, bridson (a moment with sin θ/2), cubic, curved, spring \
             (across hinges) or none";
        bending_stiffness: Real = 1 "N/m", "stiffness of springs across hinges";
    }
    /// Of the springs on edges.
    pub(crate) struct EdgeSprings {
        compression: Real = 1, "share of the stiffness that springs on edges keep under compression, from 0 to 1";
        slack: Option<[Real; 2]> = "none",
            "lengths relative to rest between which springs on edges do not resist, or principal stretches between \
             which membrane=arap does not, such as 0.98,1.02, or none";
        edges: Or<Edges, Real> = "all",
            "edges that carry springs: all, quads (no diagonals), or the fraction of the coordinates that is to be free, \
             such as 0.2";
        level: u32 = 0,
            "coarse level of the mesh that keeps the cloth from stretching, from 1; 0: the mesh itself does; single held \
             vertices are drawn out";
        fine_fraction: Real = 0.01, "part of the modulus that springs on edges keep beside a coarse level, from 0 to 1";
    }
}

crate::choices! {
    /// What resists stretching.
    #[derive(PartialEq)]
    pub(crate) enum MembraneName { Springs = "springs", Stvk = "stvk", Arap = "arap" }
    /// What resists bending.
    #[derive(PartialEq)]
    pub(crate) enum BendingName {
        Quadratic = "quadratic",
        Dihedral = "dihedral",
        Bridson = "bridson",
        Cubic = "cubic",
        Curved = "curved",
        Spring = "spring",
        None = "none",
    }
    /// Edges that carry springs.
    #[derive(PartialEq)]
    pub(crate) enum Edges { All = "all", Quads = "quads" }
}

/// Cuts the cloth that settings describe to a mesh.
pub(super) fn cut(settings: &Settings, mesh: &TriMesh) -> Result<ClothModel, BenchError> {
    let cloth = described(settings)?;
    let discretization = discretization(settings)?;
    let mut model = cloth
        .discretized_with(&discretization, mesh)
        .map_err(BenchError::usage)?;
    if is_hard(settings)? {
        harden(&mut model, |_| true);
    }
    Ok(model)
}

/// Whether the springs on edges are hard constraints.
pub(super) fn is_hard(settings: &Settings) -> Result<bool, BenchError> {
    Ok(*Stiffness::read(settings)?.stiffness == Or::Word(Infinite::Infinite))
}

/// What is seldom meant of a piece of a mesh, a sentence each.
pub(super) fn hints(piece: &Piece, mesh: &TriMesh) -> Vec<String> {
    /// Denser or stiffer is no cloth (kg/m², N/m).
    const MOST: [Real; 2] = [20.0, 1e7];
    /// So far off is a modulus worth a word.
    const OFF: Real = 1.25;
    /// From here on vertices give way so far that it shows.
    const IMBALANCE: Real = 0.1;
    let (density, membrane) = (piece.cloth.areal_density, piece.cloth.membrane);
    let (name, stiffness) = match membrane {
        Membrane::SpringStiffness(k) => ("stiffness", k),
        Membrane::Modulus(y) => ("modulus", y),
    };
    let heavy = (density > MOST[0]).then(|| {
        format!("density = {density} kg/m² is that of no cloth, which has 0.05 to 1: 1000 g/m² are 1 kg/m²")
    });
    let stiff = (stiffness > MOST[1]).then(|| {
        format!(
            "{name} = {stiffness:e} N/m is that of no cloth, which has 1e3 to 1e5: it is Young's modulus (Pa) times the \
             thickness (m)"
        )
    });
    let moduli = piece.directional_moduli(mesh).ok().flatten();
    let moduli = moduli.filter(|[soft, stiff]| soft.ratio * OFF < 1.0 || stiff.ratio > OFF);
    let uneven = moduli.map(|extremes| {
        let [soft, stiff] = extremes.map(|DirectionalModulus { direction, ratio }| {
            // Without the sign of a zero.
            let [x, y, z] = [0, 1, 2].map(|axis| (100.0 * direction[axis]).round() / 100.0 + 0.0);
            format!("{ratio:.2} times the modulus along the edge ({x}, {y}, {z})")
        });
        format!(
            "springs on a mesh whose triangles are longer one way than another do not have the modulus that is asked for: \
             they have {soft} and {stiff}; membrane=arap and membrane=stvk have it on every mesh"
        )
    });
    let is_asked = matches!(membrane, Membrane::Modulus(_));
    let gives_way = is_asked && imbalance(piece, mesh) > IMBALANCE;
    let soft = gives_way.then(|| {
        "springs on an irregular mesh give way, and have less than the modulus that is asked for (by a quarter on \
         `irregular:33`): membrane=arap and membrane=stvk have it on every mesh"
            .to_owned()
    });
    let all = [heavy, stiff, uneven, soft];
    all.into_iter().flatten().collect()
}

/// What pulls at a vertex along the cloth in even strain, over the sum of all pulls there (dimensionless): the median.
/// It is zero where edges lie alike on both sides, and vertices move as the mean strain says.
fn imbalance(piece: &Piece, mesh: &TriMesh) -> Real {
    let Ok(model) = ClothModel::of_pieces(mesh, std::slice::from_ref(piece), &[]) else {
        return 0.0;
    };
    let x = mesh.positions();
    let mut pulls = vec![(Vec3::zeros(), 0.0); x.len()];
    for spring in &model.springs {
        let [a, b] = spring.vertices.map(|v| v as usize);
        let pull = (x[b] - x[a]) * spring.stiffness;
        for (v, pull) in [(a, pull), (b, -pull)] {
            pulls[v].0 += pull;
            pulls[v].1 += pull.norm();
        }
    }
    let normals = vertex_normals(x, mesh.triangles());
    let pulls = pulls
        .iter()
        .zip(&normals)
        .filter(|((_, all), _)| *all > 0.0);
    let within = pulls.map(|((sum, all), n)| (sum - n * n.dot(sum)).norm() / all);
    let mut ratios: Vec<Real> = within.collect();
    ratios.sort_unstable_by(Real::total_cmp);
    ratios.get(ratios.len() / 2).copied().unwrap_or(0.0)
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
    let (own, edges) = (Material::read(settings)?, EdgeSprings::read(settings)?);
    let others = [
        (own.membrane.bare(), *own.membrane != MembraneName::Springs),
        (own.shear.bare(), own.shear.is_some()),
        (edges.compression.bare(), *edges.compression != 1.0),
        (edges.slack.bare(), edges.slack.is_some()),
        (edges.edges.bare(), *edges.edges != Or::Word(Edges::All)),
        (edges.level.bare(), *edges.level > 0),
        (own.bending.bare(), *own.bending == BendingName::Spring),
    ];
    match others.iter().find(|(_, is_wrong)| *is_wrong) {
        None => Ok(()),
        Some((key, _)) => {
            let text = settings.get(key.name()).unwrap_or_default();
            Err(Stiffness::read(settings)?.stiffness.refuse(format!(
                "stiffness=inf is of one spring on every edge, and cannot be with {}={}",
                key.name(),
                text.trim_matches('"')
            )))
        }
    }
}

/// The elements that carry it.
pub(super) fn discretization(settings: &Settings) -> Result<Discretization, BenchError> {
    let (own, edges) = (Material::read(settings)?, EdgeSprings::read(settings)?);
    Ok(Discretization {
        membrane: membrane_elements(&own)?,
        shear: *own.shear,
        bending: bending_elements(&own)?,
        law: law(&edges)?,
        edges: match *edges.edges {
            Or::Word(Edges::All) => SpringEdges::All,
            Or::Word(Edges::Quads) => SpringEdges::Quads,
            Or::Value(fraction) => SpringEdges::DofFraction(fraction),
        },
        coarse_membrane: coarse_membrane(&edges)?,
    })
}

/// The numbers of the cloth, whatever carries it.
pub(super) fn described(settings: &Settings) -> Result<Cloth, BenchError> {
    let own = Material::read(settings)?;
    Ok(Cloth {
        areal_density: *own.density,
        membrane: membrane(settings, &own)?,
        bending_rigidity: *own.rigidity,
    })
}

fn membrane(settings: &Settings, own: &Material) -> Result<Membrane, BenchError> {
    let stiffness = Stiffness::read(settings)?.stiffness;
    let Some(modulus) = *own.modulus else {
        return Ok(Membrane::SpringStiffness(match *stiffness {
            Or::Value(stiffness) => stiffness,
            Or::Word(Infinite::Infinite) => {
                check_hard(settings)?;
                // Hard constraints take the place of these springs.
                1.0
            }
        }));
    };
    if stiffness.is_given() {
        return Err(own
            .modulus
            .refuse("modulus and stiffness both say how stiff the membrane is: give one of them"));
    }
    Ok(Membrane::Modulus(modulus))
}

pub(super) fn membrane_elements(own: &Material) -> Result<MembraneElements, BenchError> {
    if *own.membrane != MembraneName::Stvk {
        own.poisson.refuse_without("membrane=stvk")?;
    }
    Ok(match *own.membrane {
        MembraneName::Springs => MembraneElements::Springs,
        MembraneName::Stvk => MembraneElements::Stvk {
            poisson_ratio: *own.poisson,
        },
        MembraneName::Arap => MembraneElements::Arap,
    })
}

fn law(edges: &EdgeSprings) -> Result<SpringLaw, BenchError> {
    if edges.slack.is_some() && edges.compression.is_given() {
        return Err(edges.slack.refuse(
            "slack and compression both say what springs do when they are pushed: give one of them",
        ));
    }
    Ok(match (*edges.slack, *edges.compression) {
        (Some(limits), _) => SpringLaw::DeadZone(limits),
        (None, 1.0) => SpringLaw::Linear,
        (None, share) => SpringLaw::Compression(share),
    })
}

fn coarse_membrane(edges: &EdgeSprings) -> Result<Option<CoarseMembrane>, BenchError> {
    let level = *edges.level;
    if level == 0 {
        edges.fine_fraction.refuse_without("a level of 1 or more")?;
        return Ok(None);
    }
    Ok(Some(CoarseMembrane {
        level,
        fine_fraction: *edges.fine_fraction,
    }))
}

fn bending_elements(own: &Material) -> Result<BendingElements, BenchError> {
    let elements = match *own.bending {
        BendingName::Quadratic => BendingElements::Quadratic,
        BendingName::Dihedral => BendingElements::Dihedral,
        BendingName::Bridson => BendingElements::Bridson,
        BendingName::Cubic => BendingElements::Cubic,
        BendingName::Curved => BendingElements::Curved,
        BendingName::Spring => BendingElements::Springs(*own.bending_stiffness),
        BendingName::None => BendingElements::None,
    };
    if *own.bending != BendingName::Spring {
        own.bending_stiffness.refuse_without("bending=spring")?;
    }
    if matches!(
        elements,
        BendingElements::Springs(_) | BendingElements::None
    ) {
        own.rigidity.refuse_without("bending hinges")?;
    }
    Ok(elements)
}
