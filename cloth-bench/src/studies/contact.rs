//! The comparison with contact in it.

pub mod cylinder;
pub mod laws;
pub mod meeting;
pub mod motion;
pub mod step;
pub mod survival;

use crate::studies::prelude::*;

pub(super) const STUDY: Study = Study {
    name: "contact",
    question: "What is each method's answer worth once the cloth touches something?",
    about: "One contact potential for every method, as an energy or as constraints: only one is left, so methods are compared and not potentials. Step: a sheet of 1 m × 1 m lies on a sphere of 0.3 m with its middle while its sides fall, a strip folds onto itself, \
        sheets land on each other, a tube buckles on a floor, each after some steps of 1/60 s of implicit Euler. \
        The reference x* is implicit Euler's next step to 1e-10: the minimiser of G with the contact potential and its lagged friction. The position error is ‖x − x*‖_M/‖x̃ − x*‖_M, 1 at the inertial prediction, which \
        has gone into what it touches; the objective error (G − G*)/(G(xₙ) − G*), 1 where the step starts, none where the straight \
        path there is not free of crossings. What iterates is one run, measured after every iteration (the clock stands still meanwhile); times are medians of three runs after one to warm up. Such a step buckles, so few iterations can end farther away than the prediction. \
        A method that cuts the step solves another problem, whose solution is nearer to the motion in continuous time. \
        Motion: drape, fold and stack, and a sleeve that hangs on an arm, after 0.4 s, on several meshes and with several steps; the converged motion is that of BDF2 with \
        the shortest step, and its distance ‖x − x_ref‖_M/(√Σm · L) is measured on the mesh on which steps are compared, and so is that over the way from the start, since a stack moves by millimetres only; how well it is known, the row of BDF2 with half as many steps tells. Which way a corner buckles is chance on coarse meshes, so expect a few per cent of scatter. \
        Laws: a sheet slides down a slope from rest, or lies on a floor, and loses energy to friction, to contact and to the method's own steps; sheets lie on each other; a strip is pulled over a cylinder until it slips, or hangs over it without friction; sheets meet in free flight; \
        closed forms beside every method's own view of contact, through forces that contact reports. The force that pulls the strip grows by 0.4 % a step, so it is seen to slip up to 3 % late; \
        friction of a step of implicit Euler to 1e-3 of all forces, its default, and of one linear solve holds longer, and that of PBD's one substep holds where nothing should. \
        Steps: a drape, a fold, a stack and a garment by every method with steps of every size, each vertex starting with a velocity of up to 1 cm/s. \
        ok: never a crossing, no vertex inside a body, and never more energy than was given by more than a hundredth of the most; strained: more, but only as elastic energy that a solver cut short leaves; grew: it moves with more; crossed, ended: as the words say. The worst of ten runs (three of xpbd-direct, one with --quick), also of the drape with springs of every stiffness. \
        Recovery: a ribbon that comes down through itself, sheets tilted through each other, a tube with a lining that comes out on one side; crossing pairs are let go and pulled apart during the run.",
    run,
};

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    step::run(study);
    motion::run(study);
    laws::run(study);
    meeting::run(study);
    survival::run(study);
    Ok(())
}
