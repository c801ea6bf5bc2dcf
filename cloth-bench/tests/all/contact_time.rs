//! The time of contact is measured with every method.

use crate::scene_text::scene;
use cloth_bench::method::METHODS;
use cloth_bench::run::from_start;
use cloth_bench::settings::Settings;

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
