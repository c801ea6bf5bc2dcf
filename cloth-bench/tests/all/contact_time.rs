//! The time of contact is measured with every method.

use crate::scene_text::scene;
use cloth_bench::method::{METHODS, Method};
use cloth_bench::run::{from_start, run};
use cloth_bench::settings::Settings;
use cloth_core::particles::State;
use cloth_core::step::{StepError, StepInput, StepReport, Stepper};

/// A method that lets the time of the state jump after each step.
struct Jumping<'a>(&'a mut dyn Stepper);

impl Stepper for Jumping<'_> {
    fn name(&self) -> &'static str {
        "jumping"
    }

    fn step(&mut self, state: &mut State, input: StepInput<'_>) -> Result<StepReport, StepError> {
        let report = self.0.step(state, input)?;
        state.time += 0.5;
        Ok(report)
    }
}

/// The contacts of a run, whose time is measured, tell of a state that is of another time than its moving bodies.
#[test]
fn a_state_of_another_time_than_the_bodies_ends_a_run() {
    let scene = scene(
        "another-time",
        "dt = 0.01\n[[mesh]]\ngenerator = \"grid:3x3:alternating\"\ntranslate = [0, 0, 9]\n\
         [[obstacle]]\nshape = \"sphere\"\nradius = 0.1\nvelocity = [1, 0, 0]\n",
    );
    for method in ["implicit-euler", "xpbd"] {
        let method = Method::find(method).unwrap();
        let mut stepper = method
            .build(&scene, &Settings::default(), scene.dt)
            .unwrap();
        let mut state = scene.start.clone();
        let mut jumping = Jumping(&mut *stepper);
        let ended = run(&scene, &mut jumping, &mut state, scene.dt, 3, |_, _, _| {
            Ok(())
        });
        let said = ended.unwrap_err().to_string();
        assert!(said.contains("step 2: the step begins at 0.51 s"), "{said}");
    }
}

/// A sheet that lies on a ball and a sealed ball of cloth on a floor: of each method contact takes some of the time of
/// a step, and never more.
#[test]
fn contact_takes_some_of_the_time_of_a_step() {
    let lying = "[[mesh]]\ngenerator = \"grid:7x7:alternating\"\nscale = 0.2\ntranslate = [-0.1, -0.1, 0.1019]\n\
                 [contact]\nself = true\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.1\n";
    let sealed = "[[mesh]]\ngenerator = \"sphere:3\"\nscale = 0.1\ntranslate = [0, 0, 0.0519]\nbulk_modulus = 1e5\n\
                  [[obstacle]]\nshape = \"plane\"\n";
    for (name, text) in [("lying", lying), ("sealed", sealed)] {
        let scene = scene(name, text);
        for method in METHODS {
            let can_take = match name {
                // No step of this method is stable.
                "lying" => method.name != "explicit-euler",
                // Others refuse a bulk modulus.
                _ => ["implicit-euler", "pd", "xpbd"].contains(&method.name),
            };
            if !can_take {
                continue;
            }
            let settings = Settings::default();
            let after = |_, _: &_, _: &_| Ok(());
            let run = from_start(&scene, &method, &settings, scene.dt, 3, after);
            let (summary, _) = match run {
                Ok(run) => run,
                Err(error) => panic!("{name}, {}: {error}", method.name),
            };
            let [contact, step] = [summary.contact_ms_median, summary.ms_per_step_median];
            let told = format!("{name}, {}: {contact} of {step} ms", method.name);
            assert!(contact > 0.0 && contact <= step, "{told}");
        }
    }
}
