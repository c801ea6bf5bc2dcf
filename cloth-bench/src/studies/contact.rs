//! The comparison with contact in it.

mod laws;
mod motion;
mod step;
mod survival;

use crate::studies::prelude::*;

pub(super) const STUDY: Study = Study {
    name: "contact",
    question: "What is each method's answer worth once the cloth touches something?",
    about: "Step: a sheet of 1 m × 1 m lies on a sphere of 0.3 m with its middle while its sides fall, after seventeen steps of \
        1/60 s of implicit Euler. The reference x* is implicit Euler's next step to 1e-10: the minimiser of G with the contact \
        potential and its lagged friction. The position error is ‖x − x*‖_M/‖x̃ − x*‖_M, 1 at the inertial prediction, which \
        has gone into the sphere; the objective error (G − G*)/(G(xₙ) − G*), 1 where the step starts, none where the straight \
        path there is not free of crossings. Such a step buckles, so few iterations can end farther away than the prediction. \
        A method that cuts the step solves another problem, whose solution is nearer to the motion in continuous time. \
        Drape: the same sheet after 0.4 s, on several meshes and with several steps; the converged fall is that of BDF2 with \
        the shortest step. Which way a corner buckles is chance on coarse meshes, so expect a few per cent of scatter. \
        Laws: a sheet slides down a slope from rest, or lies on a floor; closed forms beside every method's own view of contact.",
    run,
};

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    step::run(study);
    motion::run(study);
    laws::run(study);
    survival::run(study);
    Ok(())
}
