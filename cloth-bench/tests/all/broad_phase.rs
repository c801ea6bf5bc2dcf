//! All broad phases find the same, so that a run has the same bits with each of them.

use crate::scene_text::written;
use cloth_bench::method::Method;
use cloth_bench::run::from_start;
use cloth_bench::scene::file;
use cloth_bench::settings::Settings;

/// A sheet that falls on a small ball and on itself, with the settings of contact that the caller adds.
fn text(contact: &str) -> String {
    format!(
        "dt = 0.01\n[[mesh]]\ngenerator = \"grid:17x17:alternating\"\nscale = 0.4\n\
         translate = [-0.17, -0.21, 0.055]\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.05\n\
         [contact]\nself = true\n{contact}"
    )
}

#[test]
fn run_has_the_same_bits_with_every_broad_phase() {
    for method in ["xpbd", "pd", "implicit-euler"] {
        let ends = ["hierarchy", "spatial-hash", "morton-grid"].map(|name| {
            let contact = format!("broad_phase = \"{name}\"\n");
            let path = written(&format!("{method}-{name}"), &text(&contact));
            let scene = file::build(&path, &Settings::default()).unwrap();
            let method = Method::find(method).unwrap();
            let settings = Settings::default();
            let ran = from_start(&scene, method, &settings, scene.dt, 25, |_, _, _| Ok(()));
            let (summary, end) = ran.unwrap();
            let touched = summary.min_clearance.unwrap() < 2e-3;
            assert!(touched, "it lands");
            let bits = |v: &cloth_core::math::Vec3| [v.x, v.y, v.z].map(f64::to_bits);
            end.positions
                .iter()
                .chain(&end.velocities)
                .map(bits)
                .collect::<Vec<_>>()
        });
        assert!(ends[0] == ends[1], "{method}: spatial hash");
        assert!(ends[0] == ends[2], "{method}: Morton grid");
    }
}

#[test]
fn wrong_names_and_those_without_effect_are_refused() {
    let refused = |name: &str, text: &str| {
        let path = written(name, text);
        file::build(&path, &Settings::default())
            .unwrap_err()
            .to_string()
    };
    let said = refused("unknown", &text("broad_phase = \"grid\"\n"));
    assert!(
        said.contains("unknown.toml: line ") && said.contains("`grid`"),
        "{said}"
    );
    let plane = "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n[[obstacle]]\nshape = \"plane\"\n\
                 [contact]\nbroad_phase = \"spatial-hash\"\n";
    let said = refused("plane", plane);
    assert!(
        said.contains("line 6: broad_phase has no meaning"),
        "{said}"
    );
}
