//! Energy from nowhere where contact changes the end of a step: the stability monitor of the explicit integrators, and
//! the guard of the midpoint rule.

use cloth_core::contact::{
    ContactConstraints, ContactError, ContactPotential, ContactRow, ContactSource, ContactStep,
};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepError, StepInput, Stepper};
use cloth_massspring::{ExplicitEuler, ImplicitMidpoint, SymplecticEuler};

/// Pulls vertex 1 away from vertex 0, for ever.
struct Pull {
    /// By so much a step (m).
    displacement: Real,
    /// And by so much faster (m/s).
    push: Real,
    /// Whether it is a body that does it, and says what work that is.
    is_body: bool,
    work: Real,
    /// Whether a step has ended that was not taken back.
    has_ended: bool,
}

impl ContactSource for Pull {
    fn keep_free(&mut self, _: &[Vec3], _: &[Real], _: &mut [Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn potential(&mut self) -> &mut dyn ContactPotential {
        unreachable!("explicit methods want constraints")
    }

    fn constraints(&mut self) -> &mut dyn ContactConstraints {
        self
    }

    fn work(&self) -> Real {
        self.work
    }

    fn take_back(&mut self) {
        self.has_ended = false;
    }
}

impl ContactConstraints for Pull {
    fn begin_step(&mut self, _: &ContactStep<'_>) -> Result<(), ContactError> {
        (self.work, self.has_ended) = (0.0, false);
        Ok(())
    }

    fn begin_substep(&mut self, _: &ContactStep<'_>, _: &[Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn sweep(&mut self, _: &ContactStep<'_>, _: &mut [Vec3]) {}

    fn end_substep(&mut self, _: &ContactStep<'_>, x: &mut [Vec3]) -> Result<(), ContactError> {
        x[1].x += self.displacement;
        Ok(())
    }

    fn change_velocities(&mut self, v: &mut [Vec3]) {
        // The displacement is not to become a velocity.
        v[1].x -= self.displacement / DT;
        let before = v[1].norm_squared();
        v[1].x += self.push;
        if self.is_body {
            // Of 1 kg.
            self.work += 0.5 * (v[1].norm_squared() - before);
        }
    }

    fn end_step(&mut self, _: &[Vec3]) {
        self.has_ended = true;
    }
}

/// Size of a step (s).
const DT: Real = 0.01;

const PULL: Pull = Pull {
    displacement: 0.0,
    push: 0.0,
    is_body: false,
    work: 0.0,
    has_ended: false,
};

/// How a run of 1000 steps at a twentieth of the stable one ends: with one mass of 1 kg on a spring of 100 N/m and 1 m.
/// Contact is where the state is: a step that fails has not ended there either.
fn end(solver: &mut dyn Stepper, mut contact: Pull) -> Result<(), StepError> {
    let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x()]);
    for _ in 0..1000 {
        let step = solver.step(&mut state, StepInput::new(DT).contacts(&mut contact));
        assert_eq!(contact.has_ended, step.is_ok());
        step?;
    }
    Ok(())
}

fn solvers() -> (SymplecticEuler, ExplicitEuler) {
    let mut particles = Particles::new(vec![1.0; 2]).unwrap();
    particles.prescribe(0).unwrap();
    let spring = || {
        vec![Spring {
            vertices: [0, 1],
            rest_length: 1.0,
            stiffness: 100.0,
        }]
    };
    let symplectic = SymplecticEuler::builder(&particles);
    let forward = ExplicitEuler::builder(&particles);
    (
        symplectic.energy(spring()).build().unwrap(),
        forward.energy(spring()).build().unwrap(),
    )
}

#[test]
fn motion_out_of_stretch_that_contact_leaves_ends_the_run() {
    let stretch = || Pull {
        displacement: 1e-3,
        ..PULL
    };
    let (mut symplectic, mut forward) = solvers();
    // Pulled by a on from step to step, the mass swings about a displacement of a/(Δt² ω²) = 0.1 m, with no more than ½
    // k (0.1 m)² = 0.5 J.
    let error = end(&mut symplectic, stretch()).unwrap_err();
    let StepError::EnergyGain { kinetic, given, .. } = error else {
        panic!("{error}")
    };
    assert!(kinetic < 1.0 && kinetic > 99.0 * given, "{error}");
    let error = end(&mut forward, stretch()).unwrap_err();
    assert!(matches!(error, StepError::Unstable { .. }), "{error}");
}

#[test]
fn motion_that_a_body_pays_for_goes_on() {
    let push = |is_body| Pull {
        push: 0.1,
        is_body,
        ..PULL
    };
    let (mut symplectic, _) = solvers();
    end(&mut symplectic, push(true)).unwrap();
    let (mut symplectic, _) = solvers();
    let error = end(&mut symplectic, push(false)).unwrap_err();
    assert!(matches!(error, StepError::EnergyGain { .. }), "{error}");
}

#[test]
fn contact_that_does_nothing_changes_nothing() {
    let (mut symplectic, _) = solvers();
    end(&mut symplectic, PULL).unwrap();
}

/// Pushes vertex 1 with a constant force (N), as a body would that says what work that is, or not.
#[derive(Debug)]
struct Push {
    force: Vec3,
    tells: bool,
    from: Vec3,
    work: Real,
    /// Whether a step has ended that was not taken back.
    has_ended: bool,
}

impl ContactSource for Push {
    fn keep_free(&mut self, _: &[Vec3], _: &[Real], _: &mut [Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn potential(&mut self) -> &mut dyn ContactPotential {
        self
    }

    fn constraints(&mut self) -> &mut dyn ContactConstraints {
        unreachable!("methods that minimise want the potential")
    }

    fn work(&self) -> Real {
        self.work
    }

    fn take_back(&mut self) {
        self.has_ended = false;
    }
}

impl ContactPotential for Push {
    fn begin(&mut self, step: &ContactStep<'_>, _: &mut [Vec3]) -> Result<(), ContactError> {
        (self.from, self.has_ended) = (step.from[1], false);
        Ok(())
    }

    fn limit(&mut self, _: &[Vec3], _: &[Vec3]) -> Result<Real, ContactError> {
        Ok(1.0)
    }

    fn limit_each(
        &mut self,
        _: &[Vec3],
        _: &mut [Vec3],
        fractions: &mut [Real],
    ) -> Result<(), ContactError> {
        fractions.fill(1.0);
        Ok(())
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        out[1] -= self.force;
        -self.force.dot(&x[1])
    }

    fn linearize(&self, _: &[Vec3], _: &mut Vec<ContactRow>) {}

    fn end(&mut self, x: &[Vec3], _: &mut [Vec3]) {
        self.has_ended = true;
        if self.tells {
            self.work = self.force.dot(&(x[1] - self.from));
        }
    }
}

#[test]
fn the_midpoint_rule_is_refused_energy_from_nowhere_in_contact() {
    let mut particles = Particles::new(vec![1.0; 2]).unwrap();
    particles.prescribe(0).unwrap();
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: 1e-6,
    };
    let run = |tells| {
        let builder = ImplicitMidpoint::builder(&particles).energy(vec![spring]);
        let mut solver = builder.build().unwrap();
        let mut push = Push {
            force: Vec3::x(),
            tells,
            from: Vec3::zeros(),
            work: 0.0,
            has_ended: false,
        };
        let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x()]);
        for _ in 0..30 {
            let before = state.clone();
            let step = solver.step(&mut state, StepInput::new(DT).contacts(&mut push));
            assert_eq!(push.has_ended, step.is_ok());
            if let Err(error) = step {
                assert_eq!(state, before);
                return Err(error);
            }
        }
        Ok(())
    };
    run(true).unwrap();
    let error = run(false).unwrap_err();
    let StepError::EnergyGrowth {
        before,
        after,
        given,
        step,
    } = error
    else {
        panic!("{error}")
    };
    // The speed grows evenly, and the account begins after the first step: ten times its speed is too much.
    assert!((10..=12).contains(&step), "{error}");
    assert!(after > before && after > 100.0 * given, "{error}");
    assert!(error.to_string().contains("take implicit Euler or BDF2"));
}
