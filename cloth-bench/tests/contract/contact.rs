//! The hook of contact, in every method, with and without strain limiting.

use crate::common::{allocations_once_warm, methods, scene};
use cloth_bench::method::Method;
use cloth_bench::settings::Settings;
use cloth_core::contact::{
    ContactConstraints, ContactError, ContactPotential, ContactRow, ContactSource, ContactStep,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::step::{StepError, StepInput};

/// Refuses every step, in both views, at its beginning or at its end.
#[derive(Debug)]
struct Refusal {
    reason: ContactError,
    at_end: bool,
}

impl Refusal {
    fn answer(&self, at_end: bool) -> Result<(), ContactError> {
        // An energy has its word at the beginning alone.
        if self.at_end == at_end {
            Err(self.reason.clone())
        } else {
            Ok(())
        }
    }
}

impl ContactSource for Refusal {
    fn keep_free(&mut self, _: &[Vec3], _: &[Real], _: &mut [Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn potential(&mut self) -> &mut dyn ContactPotential {
        self
    }

    fn constraints(&mut self) -> &mut dyn ContactConstraints {
        self
    }
}

impl ContactPotential for Refusal {
    fn begin(&mut self, _: &ContactStep<'_>, _: &mut [Vec3]) -> Result<(), ContactError> {
        Err(self.reason.clone())
    }

    fn limit(&mut self, _: &[Vec3], _: &[Vec3]) -> Result<Real, ContactError> {
        unreachable!("the step has not begun")
    }

    fn limit_each(
        &mut self,
        _: &[Vec3],
        _: &mut [Vec3],
        _: &mut [Real],
    ) -> Result<(), ContactError> {
        unreachable!("the step has not begun")
    }

    fn add_gradient(&self, _: &[Vec3], _: &mut [Vec3]) -> Real {
        unreachable!("the step has not begun")
    }

    fn linearize(&self, _: &[Vec3], _: &mut Vec<ContactRow>) {
        unreachable!("the step has not begun")
    }

    fn end(&mut self, _: &[Vec3], _: &mut [Vec3]) {
        unreachable!("the step has not begun")
    }
}

impl ContactConstraints for Refusal {
    fn begin_step(&mut self, _: &ContactStep<'_>) -> Result<(), ContactError> {
        self.answer(false)
    }

    fn begin_substep(&mut self, _: &ContactStep<'_>, _: &[Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn sweep(&mut self, _: &ContactStep<'_>, x: &mut [Vec3]) {
        x.iter_mut().for_each(|x| x.z += 0.1);
    }

    fn end_substep(&mut self, _: &ContactStep<'_>, _: &mut [Vec3]) -> Result<(), ContactError> {
        self.answer(true)
    }

    fn change_velocities(&mut self, _: &mut [Vec3]) {}

    fn end_step(&mut self, _: &[Vec3]) {
        unreachable!("the step has been refused")
    }
}

/// Every method, bare and with strain limiting.
fn variants() -> impl Iterator<Item = (&'static Method, Settings)> {
    let limited = Settings::parse(&["strain_limit=0.1"]).unwrap();
    methods().flat_map(move |m| [(m, Settings::default()), (m, limited.clone())])
}

#[test]
fn a_step_that_contact_refuses_has_not_happened() {
    let scene = scene("hang", &["n=5"]);
    let reason = ContactError::Infeasible {
        vertex: 7,
        is_prescribed: false,
        body: None,
    };
    let expected = StepError::Contact {
        reason: reason.clone(),
        step: 1,
    };
    for (method, settings) in variants() {
        let mut solver = method.build(&scene, &settings, scene.dt).unwrap();
        let mut state = scene.start.clone();
        let input = || StepInput::new(scene.dt).gravity(scene.gravity);
        for at_end in [false, true] {
            let reason = reason.clone();
            let mut refusal = Refusal { reason, at_end };
            let touched = StepInput::new(scene.dt).gravity(scene.gravity);
            let touched = touched.contacts(&mut refusal);
            let refused = solver.step(&mut state, touched);
            assert_eq!(refused, Err(expected.clone()), "{}", method.name);
            assert!(state == scene.start, "{}", method.name);
        }
        // What failed leaves nothing behind.
        let mut fresh = method.build(&scene, &settings, scene.dt).unwrap();
        let mut other = scene.start.clone();
        solver.step(&mut state, input()).unwrap();
        fresh.step(&mut other, input()).unwrap();
        assert_eq!(state, other, "{}", method.name);
    }
}

#[test]
fn newtons_method_refuses_contact_that_it_does_not_feel() {
    let scene = scene("drape-sphere", &["n=5"]);
    for (name, linear) in [
        ("implicit-euler", "cholesky"),
        ("implicit-midpoint", "conjugate-gradients"),
        ("bdf2", "jacobi"),
    ] {
        let settings = Settings::default().with("linear", linear);
        let built = Method::find(name)
            .unwrap()
            .build(&scene, &settings, scene.dt);
        let told = built.map(drop).unwrap_err().to_string();
        assert!(
            told.contains("linear") && told.contains("contact"),
            "{told}"
        );
    }
}

#[test]
fn what_cannot_be_touched_is_not_looked_for() {
    for pairs in [&["n=9"][..], &["n=9", "contact=none", "self=yes"]] {
        let scene = scene("hang", pairs);
        assert!(scene.contacts().unwrap().is_none());
    }
    let scene = scene("hang", &["n=9", "self=yes"]);
    assert!(scene.contacts().unwrap().is_some());
}

#[test]
fn contact_far_away_allocates_nothing_once_warm() {
    let scene = scene("hang", &["n=9", "self=yes"]);
    let mut source = scene.contacts().unwrap().unwrap();
    let method = Method::find("xpbd").unwrap();
    let mut solver = method
        .build(&scene, &Settings::default(), scene.dt)
        .unwrap();
    let mut state = scene.start.clone();
    let count = allocations_once_warm(|| {
        let input = StepInput::new(1e-3).gravity(scene.gravity);
        solver
            .step(&mut state, input.contacts(&mut source))
            .unwrap();
    });
    assert_eq!(count, 0);
}
