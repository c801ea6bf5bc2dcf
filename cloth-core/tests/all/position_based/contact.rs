//! What contact is asked in a step of a position-based method, and when.

use super::{Builder, GRAVITY, TestSettings};
use cloth_core::contact::{
    ContactConstraints, ContactError, ContactPotential, ContactSource, ContactStep,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::position_based::Sweep;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepError, StepInput};

/// Notes what is asked of it, lifts the positions in each sweep, and refuses the end of the given substep.
#[derive(Debug, Default)]
struct Noted {
    calls: Vec<&'static str>,
    refused: Option<usize>,
    ends: usize,
}

impl ContactSource for Noted {
    fn keep_free(&mut self, _: &[Vec3], _: &[Real], _: &mut [Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn potential(&mut self) -> &mut dyn ContactPotential {
        panic!("a method that projects positions wants constraints");
    }

    fn constraints(&mut self) -> &mut dyn ContactConstraints {
        self
    }
}

impl ContactConstraints for Noted {
    fn begin_step(&mut self, step: &ContactStep<'_>) -> Result<(), ContactError> {
        assert_eq!(step.dt, 0.5);
        self.calls.push("step");
        Ok(())
    }

    fn begin_substep(
        &mut self,
        step: &ContactStep<'_>,
        predicted: &[Vec3],
    ) -> Result<(), ContactError> {
        assert_eq!((step.dt, step.from.len()), (0.25, predicted.len()));
        self.calls.push("substep");
        Ok(())
    }

    fn sweep(&mut self, step: &ContactStep<'_>, x: &mut [Vec3]) {
        for (x, from) in x.iter_mut().zip(step.from) {
            *x = from + Vec3::z();
        }
        self.calls.push("sweep");
    }

    fn end_substep(&mut self, _: &ContactStep<'_>, _: &mut [Vec3]) -> Result<(), ContactError> {
        self.calls.push("end");
        self.ends += 1;
        match self.refused {
            Some(end) if end == self.ends => Err(ContactError::Infeasible {
                vertex: 3,
                is_prescribed: false,
                body: None,
            }),
            _ => Ok(()),
        }
    }

    fn change_velocities(&mut self, velocities: &mut [Vec3]) {
        // A lift of 1 m in 0.25 s.
        assert!((velocities[0] - Vec3::z() * 4.0).norm() < 1e-12);
        self.calls.push("velocities");
    }

    fn end_step(&mut self, x: &[Vec3]) {
        assert!((x[0].z - 2.0).abs() < 1e-12);
        self.calls.push("end of step");
    }
}

#[test]
fn contact_constraints_come_last_in_each_sweep_and_are_asked_in_order() {
    let particles = Particles::new(vec![1.0; 4]).unwrap();
    let settings = TestSettings {
        iterations: 2,
        substeps: 2,
        sweep: Sweep::Colored,
    };
    let mut solver = Builder::new(&particles).config(settings).build().unwrap();
    let mut state = State::at_rest(vec![Vec3::zeros(); 4]);
    let mut noted = Noted {
        refused: Some(2),
        ..Noted::default()
    };
    let before = state.clone();
    let refused = solver.step(&mut state, StepInput::new(0.5).contacts(&mut noted));
    let reason = ContactError::Infeasible {
        vertex: 3,
        is_prescribed: false,
        body: None,
    };
    assert_eq!(refused, Err(StepError::Contact { reason, step: 1 }));
    assert_eq!(state, before);
    let substep = ["substep", "sweep", "sweep", "end", "velocities"];
    assert_eq!(noted.calls[1..6], substep);
    noted = Noted::default();
    let input = StepInput::new(0.5).gravity(GRAVITY).contacts(&mut noted);
    solver.step(&mut state, input).unwrap();
    let all = [&["step"], &substep[..], &substep[..], &["end of step"]].concat();
    assert_eq!(noted.calls, all);
}
