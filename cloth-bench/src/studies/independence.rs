//! Is it the same cloth on another mesh, with another step, and in a mirror?

pub mod order;

use super::meshes_and_steps::{MeshesAndSteps, OverConverged, Point};
use crate::studies::prelude::*;

pub(super) const STUDY: Study = Study {
    name: "independence",
    question: "Does a method show the same cloth at every resolution and every frame rate, and a symmetric one as symmetric?",
    about: "A sheet of 1 m × 1 m with the same density, modulus (1e4 N/m) and rigidity (1e-5 N·m) on every mesh, held at two corners, falls from the horizontal for 0.5 s. fall (m) is that of the centre of mass, strain the root mean square over the edges; \
        both beside the converged value: BDF2 on the finest mesh with the shortest step. Independent converged codes agree on a fall of 0.487 m to 0.50 m. Default settings, which is the point: a method that takes the same number of iterations or substeps everywhere, as PBD and the published setting of XPBD do, shows another cloth on another mesh. \
        A stretchy method falls farther and strains more; one that is numerically heavy falls less. What may surprise: implicit Euler with long steps falls too far, as free fall does in it, by one step more, while its linearised step falls too little; short steps, not more iterations, cure both. \
        Order: a sheet of 1 m × 1 m with crossed diagonals, held at two corners, and its fall of 0.5 s are their own mirror image; asymmetry (m) is the largest distance of a vertex from the mirror image of its partner, sideways (m) how far the centre of mass has left the plane of symmetry. Sweeps visit the constraints one after the other, or colour after colour, in an order that is not symmetric; the coarse levels of PD and of implicit Euler are not symmetric either, which shows as long as they are cut short.",
    run,
};

const SECONDS: Real = 0.5;
/// XPBD at its published setting; all others are at their defaults.
const XPBD_PUBLISHED: &str = "xpbd, 20 substeps";

fn methods() -> Vec<&'static str> {
    method::with_own(&[
        "implicit-euler",
        "linear-implicit",
        "implicit-midpoint",
        "bdf2",
        "pbd",
        "xpbd",
        XPBD_PUBLISHED,
        "pd",
    ])
}

fn meshes_and_steps(scope: Scope) -> MeshesAndSteps {
    let (sizes, rates): (&[u32], &[u32]) = scope.pick(
        (&[9, 17], &[30, 60, 120]),
        (&[16, 24, 32, 48, 64], &[30, 60, 120, 240]),
    );
    MeshesAndSteps {
        sizes,
        rates,
        middle: sizes[sizes.len() / 2],
    }
}

/// Vertices a side and steps per second of the converged value.
const FINEST: [(u32, u32); 2] = [(17, 240), (64, 480)];

/// A fall that is off by no more than this part is right.
const NEAR: Real = 0.05;

/// Where a sheet is after half a second.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Fallen {
    /// How far its centre of mass has fallen (m).
    pub fall: Number,
    strain: Number,
}

/// Half a second of the hanging sheet with so many vertices a side, by a method with so many steps a second.
pub fn fall(name: &str, n: u32, rate: u32) -> Result<Fallen, BenchError> {
    let settings = Settings::default().with("n", n).with("modulus", 1e4);
    let scene = scene::build("hang", None, &settings)?;
    let dt = 1.0 / Real::from(rate);
    let steps = (SECONDS * Real::from(rate)).round() as u32;
    let variant = match name {
        XPBD_PUBLISHED => Variant::published(Method::find("xpbd")?),
        _ => Variant::default_of(Method::find(name)?),
    };
    let method = Method::find(variant.method())?;
    let (end, _) = run::simulate(&scene, method, &variant.settings, dt, steps)?;
    Ok(Fallen {
        fall: Number(end.center_of_mass_drop),
        strain: Number(end.rms_strain),
    })
}

/// The same beside the converged value.
#[derive(Default, Serialize)]
struct Compared {
    #[serde(rename = "fall (m)")]
    fall: Real,
    fall_over_converged: Real,
    strain: Real,
    strain_over_converged: Real,
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let lopsided = order::run(study)?;
    let (n, rate) = study.scope.of(FINEST);
    // Everything else is relative to it.
    let Some(converged) = study.case("converged", || fall("bdf2", n, rate)) else {
        return Ok(());
    };
    let grid = meshes_and_steps(study.scope);
    let found = study.grid_side_by_side(grid.points(&methods()), Point::to_string, |point| {
        fall(point.method, point.vertices_a_side, point.steps_per_second)
    });
    let compared = |(point, Fallen { fall, strain })| {
        let compared = Compared {
            fall: fall.0,
            fall_over_converged: fall.0 / converged.fall.0,
            strain: strain.0,
            strain_over_converged: strain.0 / converged.strain.0,
        };
        (point, compared)
    };
    let rows: Vec<(Point, Compared)> = found.into_iter().map(compared).collect();
    let over = |value: fn(&Compared) -> Real| -> Vec<OverConverged> {
        rows.iter()
            .map(|(point, row)| (*point, [value(row); 2]))
            .collect()
    };
    let falls = over(|row| row.fall_over_converged);
    let strains = over(|row| row.strain_over_converged);
    let fall = Axis::linear("fall over converged (dimensionless)");
    let strain = Axis::log("strain over converged (dimensionless)");
    let short = "The fall in 0.5 s, steps of 1/60 s";
    let [mesh, after] = [
        "The fall in 0.5 s on one mesh",
        "The strain after 0.5 s, steps of 1/60 s",
    ];
    for (name, plot) in [
        ("size", grid.plot_by_size(short, fall.clone(), &falls)),
        ("step", grid.plot_by_step(mesh, fall, &falls)),
        ("strain", grid.plot_by_size(after, strain, &strains)),
    ] {
        let plot = plot.note("1 is the converged value.");
        study.plot(&format!("independence-{name}"), &plot);
    }
    let mut told = methods().into_iter().map(|method| {
        let [by_size, by_step] = grid.ranges(method, &falls);
        let [strain, by_step_strain] = grid.ranges(method, &strains);
        format!(
            "{method} falls {by_size} of the converged way over all resolutions and {by_step} over all steps, at {strain} and {by_step_strain} times the strain",
        )
    });
    let is_near = |row: &Compared| (row.fall_over_converged - 1.0).abs() <= NEAR;
    let mut near = methods();
    near.retain(|method| {
        let mut own = rows.iter().filter(|(point, _)| point.method == *method);
        own.all(|(_, row)| is_near(row))
    });
    study.section.rests_on = "figure-independence-size".into();
    study.section.verdict = Some(format!(
        "Converged, the sheet falls {} m in 0.5 s; within {} of that on every mesh and with every step: {}.\n{}. {lopsided}",
        significant(converged.fall.0, 2),
        percent(NEAR),
        near.join(", "),
        told.join("; ")
    ));
    study.table(
        "independence",
        "The same cloth on every mesh, with every step",
        &rows,
    );
    Ok(())
}
