//! The hook of contact, in every method, with and without strain limiting (COL-9).

use crate::common::{methods, scene};
use crate::counting_allocator::allocations_once_warm;
use cloth_bench::method::{METHODS, Method};
use cloth_bench::run::{SeparationWatch, run};
use cloth_bench::settings::Settings;
use cloth_core::contact::{ContactError, ContactSource, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::step::{StepError, StepInput};

const SHIFT: Vec3 = Vec3::new(0.25, -0.5, 0.125);

/// Answers as told, and remembers how it was asked.
#[derive(Default)]
struct Scripted {
    answer: Option<ContactError>,
    is_nonsense: bool,
    asked: u32,
    from: Vec<Vec3>,
    dt: Real,
    offered: Vec<Vec3>,
}

impl ContactSource for Scripted {
    fn resolve(
        &mut self,
        step: &ContactStep<'_>,
        positions: &mut [Vec3],
        velocities: &mut [Vec3],
    ) -> Result<(), ContactError> {
        self.asked += 1;
        self.from = step.from.to_vec();
        self.dt = step.dt;
        self.offered = positions.to_vec();
        for (x, &w) in positions.iter_mut().zip(step.inverse_mass) {
            if w != 0.0 {
                *x += SHIFT;
            }
        }
        velocities.fill(SHIFT);
        if self.is_nonsense {
            positions[3].y = Real::NAN;
        }
        self.answer.clone().map_or(Ok(()), Err)
    }
}

/// Every method, bare and with strain limiting.
fn variants() -> impl Iterator<Item = (&'static Method, Settings)> {
    let limited = Settings::parse(&["strain_limit=0.1"]).unwrap();
    methods().flat_map(move |m| [(m, Settings::default()), (m, limited.clone())])
}

#[test]
fn contact_has_the_last_word_once_a_step() {
    let scene = scene("hang", &["n=5"]);
    let free = |v: usize| !scene.model.particles.is_prescribed(v);
    for (method, settings) in variants() {
        let mut bare = method.build(&scene, &settings, scene.dt).unwrap();
        let mut alone = scene.start.clone();
        let input = || StepInput::new(scene.dt).gravity(scene.gravity);
        bare.step(&mut alone, input()).unwrap();
        let mut solver = method.build(&scene, &settings, scene.dt).unwrap();
        let mut state = scene.start.clone();
        let mut source = Scripted::default();
        let touching = input().contacts(&mut source);
        solver.step(&mut state, touching).unwrap();
        assert_eq!(source.asked, 1, "{}", method.name);
        assert_eq!(source.dt, scene.dt);
        assert_eq!(source.from, scene.start.positions, "{}", method.name);
        assert_eq!(source.offered, alone.positions, "{}", method.name);
        assert!(state.velocities.iter().all(|v| *v == SHIFT));
        let ends = state.positions.iter().zip(&alone.positions).enumerate();
        for (v, (x, alone)) in ends {
            let expected = if free(v) { alone + SHIFT } else { *alone };
            assert_eq!(*x, expected, "{}, vertex {v}", method.name);
        }
        assert_eq!((state.steps, state.time), (alone.steps, alone.time));
    }
}

#[test]
fn a_step_that_contact_refuses_has_not_happened() {
    let scene = scene("hang", &["n=5"]);
    let reason = ContactError::NoWay { vertex: 7 };
    for (method, settings) in variants() {
        let mut solver = method.build(&scene, &settings, scene.dt).unwrap();
        let mut state = scene.start.clone();
        let mut refuse = |source: &mut Scripted| {
            let input = StepInput::new(scene.dt).gravity(scene.gravity);
            let error = solver.step(&mut state, input.contacts(source)).unwrap_err();
            assert!(state == scene.start, "{}", method.name);
            error
        };
        let mut source = Scripted {
            answer: Some(reason.clone()),
            ..Scripted::default()
        };
        let expected = StepError::Contact {
            reason: reason.clone(),
            step: 1,
        };
        assert_eq!(refuse(&mut source), expected, "{}", method.name);
        let mut source = Scripted {
            is_nonsense: true,
            ..Scripted::default()
        };
        let expected = StepError::NonFinite { vertex: 3, step: 1 };
        assert_eq!(refuse(&mut source), expected, "{}", method.name);
        // What failed leaves nothing behind.
        let mut fresh = method.build(&scene, &settings, scene.dt).unwrap();
        let mut other = scene.start.clone();
        let input = || StepInput::new(scene.dt).gravity(scene.gravity);
        solver.step(&mut state, input()).unwrap();
        fresh.step(&mut other, input()).unwrap();
        assert_eq!(state, other, "{}", method.name);
    }
}

/// Stops everything that gets below a height (m).
struct Stop(Real);

impl ContactSource for Stop {
    fn resolve(
        &mut self,
        _step: &ContactStep<'_>,
        positions: &mut [Vec3],
        velocities: &mut [Vec3],
    ) -> Result<(), ContactError> {
        for (x, v) in positions.iter_mut().zip(velocities) {
            if x.z < self.0 {
                x.z = self.0;
                *v = Vec3::zeros();
            }
        }
        Ok(())
    }
}

/// A sheet that arrives at 1 m/s, without gravity: no method takes the way to the contact for the way from it.
#[test]
fn what_contact_stops_stays_where_it_is() {
    let scene = scene("drop", &["n=5", "contact=none"]);
    for (method, settings) in variants() {
        let mut solver = method.build(&scene, &settings, scene.dt).unwrap();
        let mut state = scene.start.clone();
        state.velocities.fill(-Vec3::z());
        let height = state.positions[0].z - 2.5 * scene.dt;
        for step in 1..=6 {
            let mut stop = Stop(height);
            let input = StepInput::new(scene.dt).contacts(&mut stop);
            solver.step(&mut state, input).unwrap();
            let expected = if step < 3 { -1.0 } else { 0.0 };
            for v in &state.velocities {
                let error = (v - Vec3::z() * expected).norm();
                assert!(error < 1e-9, "{}: {error:e} m/s, step {step}", method.name);
            }
        }
    }
}

#[test]
fn what_cannot_be_touched_is_not_looked_for() {
    for pairs in [&["n=9"][..], &["n=9", "contact=none", "self=yes"]] {
        let scene = scene("hang", pairs);
        assert!(scene.contacts().unwrap().is_none());
        assert_eq!(scene.parts(), 1);
    }
    let scene = scene("hang", &["n=9", "self=yes"]);
    assert!(scene.contacts().unwrap().is_some());
}

/// Where cloth falls, a step is cut into so many parts that none takes it further than a twenty-fourth of an edge at the end of the fall, unless the settings say how many.
#[test]
fn fall_decides_how_often_contact_is_resolved() {
    let parts = |name: &str, pairs: &[&str]| scene(name, pairs).parts();
    // Cells of 1/32 m: two thirds of the sides are along them, a third is a diagonal.
    let edge = (2.0 + Real::sqrt(2.0)) / 3.0 / 32.0;
    let expected = |fall: Real| (24.0 * (2.0 * 9.81 * fall).sqrt() / 60.0 / edge).ceil() as u32;
    assert_eq!(parts("fold", &["n=33"]), expected(1.0));
    assert_eq!(parts("drop", &["n=33", "floor=0.7"]), expected(0.7));
    assert_eq!(parts("drape-box", &["n=33"]), expected(0.5f64.sqrt()));
    assert_eq!(parts("drop", &["n=33", "floor=0"]), 10);
    assert_eq!(parts("drop", &["n=33", "self=yes"]), 10);
    assert_eq!(parts("fold", &["n=33", "contact_steps=7"]), 7);
    assert_eq!(
        parts("fold", &["n=33", "contact_steps=auto"]),
        expected(1.0)
    );
}

/// Who feels contact in its own solve takes the step whole; who limits strain afterwards does not feel it.
#[test]
fn methods_that_feel_contact_take_whole_steps() {
    let scene = scene("drape-sphere", &["n=9"]);
    assert!(scene.parts() > 1);
    let parts = |name: &str, pairs: &[&str]| {
        let settings = Settings::parse(pairs).unwrap();
        let method = Method::find(name).unwrap();
        let solver = method.build(&scene, &settings, scene.dt).unwrap();
        scene.parts_with(&*solver)
    };
    assert_eq!(parts("xpbd", &[]), 1);
    assert_eq!(parts("xpbd", &["precision=single"]), 1);
    assert_eq!(parts("xpbd-direct", &[]), 1);
    assert_eq!(parts("pbd", &[]), 1);
    assert_eq!(parts("pd", &[]), 1);
    assert_eq!(parts("pd", &["acceleration=none"]), 1);
    assert_eq!(parts("xpbd", &["strain_limit=0.1"]), scene.parts());
    for method in ["symplectic-euler", "implicit-midpoint", "linear-implicit"] {
        assert_eq!(parts(method, &[]), 1);
    }
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
            .step(&mut state, input.contacts(&mut *source))
            .unwrap();
    });
    assert_eq!(count, 0);
}

#[test]
fn nothing_crosses_in_any_scene_with_any_kind_of_method() {
    let scenes: [(&str, &[&str]); 5] = [
        ("drape-sphere", &["n=9"]),
        ("drape-box", &["n=9"]),
        ("fold", &["n=13"]),
        ("twist", &["n=21", "turns=6"]),
        ("stack", &["n=4", "sheets=4"]),
    ];
    for (name, pairs) in scenes {
        let scene = scene(name, pairs);
        for method in METHODS {
            if !["implicit-euler", "pbd", "xpbd", "xpbd-direct", "pd"].contains(&method.name) {
                continue;
            }
            let settings = Settings::default();
            let mut solver = method.build(&scene, &settings, scene.dt).unwrap();
            let mut state = scene.start.clone();
            let mut watch = SeparationWatch::new(&scene);
            let look = |_, state: &_, _: &_| watch.look(state);
            run(&scene, &mut *solver, &mut state, scene.dt, 40, look)
                .unwrap_or_else(|error| panic!("{name}, {}: {error}", method.name));
            let seen = watch.seen();
            assert_eq!(seen.crossed_steps, 0, "{name}, {}", method.name);
            if let Some(clearance) = seen.min_clearance {
                assert!(clearance > 0.0, "{name}, {}: {clearance}", method.name);
            }
        }
    }
}
