//! Bending lock: counted, measured, and cured.

mod cone;
pub(super) mod count;
pub mod finer;
pub mod fold;
pub mod methods;
pub mod picture;
mod remedies;
pub mod sheet;
pub mod sphere;
pub mod sweeps;

pub(super) use methods::fold_angle;

use crate::studies::prelude::*;
use sphere::Drapes;
use sweeps::{Folds, OnCones};

pub(super) const STUDY: Study = Study {
    name: "locking",
    question: "How many motions does a sheet with rigid edges have, what does that do to folds, and what helps?",
    about: "Count: 3V − E assumes that the edge lengths are independent conditions; rank and nullity are those of the Jacobian of the edge lengths, at rest and after a smooth \
        bend by up to a quarter of the size, and the smallest kept singular value tells how near the sheet is to having one motion more. \
        Cone: a quarter of a ring between clamps that lie on a cone; its energy at rest, over that of its hinges with every vertex on the cone. Stiff is a sheet whose energy no longer rises with Y, locked \
        one whose energy does. l* = (702 D R²/Y)^¼ is the edge length at which springs with all vertices on a surface of radius R store as much as the hinges; l⁴ is the mean of L⁴ over the edges, weighted with L². \
        Fold: a unit square, held along one diagonal, whose corners hang down; fold angle (°) below the horizontal at which the corners are seen from the clamp; bending reached is the energy of the hinges over that of the \
        exact elastica with the rigidity that the hinges have about this axis (column rigidity over D). rising is the direction of the diagonals of a one-way grid. A sheet free to curve across is softer than the elastica, which is why \
        bending reached exceeds 1 where nothing locks. \
        Remedies: conditions are the springs, as if all were taut; pull, push, shear and waves (stretch that changes its sign along x, 4 cells a wave) are the energies at 2 % strain over those of the springs, \
        so they say what a remedy breaks. Cone at Y = 1e8 N/m and at a hundredth of it, fold at 1e6 N/m, held along the falling diagonal. Cost per step: shortest of seven linearised steps of implicit Euler from the exact fold, over that of the springs, measured by turns. \
        Methods: the same fold, Y = 1e6 N/m, with steps of 1/60 s until nothing moves by 0.1 mm/s, on every pattern (symplectic Euler, midpoint and BDF2 with air drag of 10 1/s, without which they swing on) and, alternating, with other iterations; strains are those of the edges. \
        Sphere: the scene drape-sphere, 16 cells a side unless said, held in the middle, D = 1e-3 N·m, without friction, contact 40 times a step (10 times where the number of cells is varied: each mesh begins where the coarser one, of half as many cells, came to rest, the coarsest flat), velocities taken away whenever the kinetic energy has passed a maximum, until nothing is faster than 2 mm/s; nullity draped is that of the sheet as it lies there, corners below the top (m) how far it comes down. A locked sheet stands off. \
        D = 0.02 N·m elsewhere, density 0.2 kg/m².",
    run,
};

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let as_counted = count::run(study);
    picture::run(study)?;
    let cones = sweeps::cones(study);
    let folds = sweeps::folds(study);
    remedies::run(study);
    let by_method = methods::run(study);
    let drapes = sphere::run(study);
    study.answer(
        "Which folds does the mesh allow?",
        allowed(as_counted, &folds),
        None,
        "figure-locking-fold",
    );
    study.section.verdict = Some(format!(
        "{} {by_method}",
        verdict(as_counted, &cones, &folds, &drapes)
    ));
    Ok(())
}

/// What the count says of folds.
fn allowed(as_counted: bool, folds: &Folds) -> String {
    let is_measured = if as_counted {
        "so it is measured on every pattern"
    } else {
        "but it is NOT measured so on every pattern"
    };
    format!(
        "With edges that cannot stretch, a bent sheet has 3V − E motions, which is 3χ + E_b: the number of its boundary edges and three more, {is_measured}. A square of N × N vertices has 3N² coordinates and 4N − 1 motions, six of them rigid: \
        finer meshes allow more folds only in proportion to their boundary. Of {} folds under their own weight {} lost half of their bending to that; the others have lines of edges along the fold, or edges that are soft enough.",
        folds.locked + folds.free,
        folds.locked
    )
}

fn verdict(as_counted: bool, cones: &OnCones, folds: &Folds, drapes: &Drapes) -> String {
    let count = if as_counted {
        "For every pattern and size the bent sheet has exactly 3V − E = 3χ + E_b motions, those of its boundary, and the flat one V + 3."
    } else {
        "The measured null spaces are NOT those of the count everywhere."
    };
    let left = 100.0 * cones.left;
    let [least, most] = cones.equilateral;
    let constant = if least > 0.9 && most < 1.1 {
        "confirmed"
    } else {
        "not right"
    };
    let [weakest, strongest] = cones.placed;
    let constant = format!(
        "The estimate l* = (702 D R²/Y)^¼ is {constant} for vertices that stay on a cone: the membrane of equilateral triangles costs {least:.2} to {most:.2} times (l/l*)⁴ there, that of all patterns {weakest:.2} to {strongest:.2} times. \
         But a sheet between clamps does not stay there: beyond l* it gets rid of all but {left:.1} % of that energy, or less, by leaving the surface."
    );
    let (pattern, cells, ratio, energy) = &cones.worst;
    let [from, to] = folds.halved;
    let onset = if folds.locked < 3 {
        format!(
            "Only {} of {} folds under their own weight lost half of their bending: too few to judge l* by",
            folds.locked,
            folds.locked + folds.free
        )
    } else {
        let judged = if from > 0.5 && to < 2.0 {
            "confirmed within a factor of 2"
        } else {
            "no sharp number"
        };
        format!(
            "As the edge length at which a fold under its own weight locks, l* is {judged}: {} of {} sheets lose half of their bending, at l = {from:.2} to {to:.2} l*; the others have lines of edges along the fold, or are not yet that stiff",
            folds.locked,
            folds.locked + folds.free
        )
    };
    let draped = drapes.kept.as_ref().map_or_else(
        || "No drape over a sphere came off".to_owned(),
        |[(worst, least), (best, most)]| {
            let share = if worst == best {
                format!("{least:.2}")
            } else {
                format!("{least:.2} ({worst}) to {most:.2} ({best})")
            };
            format!("Draped over a sphere, the corners of a sheet whose edges are a hundred times stiffer come down by {share} of what they did")
        },
    );
    let resolved = drapes.sizes.map_or_else(String::new, |sizes| {
        let [coarse, fine] = sizes.map(|(cells, [soft, stiff])| {
            format!("{soft:.2} and {stiff:.2} m with {cells} cells a side")
        });
        format!(" Soft and stiff, they come down by {coarse}, and made finer by {fine}.")
    });
    format!(
        "{count}\n{constant} The most locked cone is {pattern}, {cells} cells, l = {ratio:.1} l*, at {energy:.1} times the developable energy. {onset}. {draped}.{resolved}"
    )
}
