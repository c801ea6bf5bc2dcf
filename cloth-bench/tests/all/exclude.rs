//! Pieces of one cloth that pass through each other freely, while all others keep out of each other's way.

use cloth_bench::method::Method;
use cloth_bench::run::{Plan, Solver, run_changing};
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_collide::SeparationProbe;
use cloth_core::math::Vec3;
use std::path::PathBuf;

const DT: f64 = 0.01;
const STEPS: u32 = 20;

fn build(name: &str, text: &str) -> Result<Scene, cloth_bench::error::BenchError> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("exclude");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, text).unwrap();
    file::build(&path, &Settings::default())
}

/// A held sheet, and a tilted one that falls onto it.
fn two(own: &str) -> String {
    format!(
        "dt = {DT}\n[[mesh]]\ngenerator = \"grid:7x7:alternating\"\nscale = 0.3\n\
         [[mesh]]\ngenerator = \"grid:6x6:alternating\"\nscale = 0.2\nrotate = [0.4, 0, 0]\ntranslate = [0.04, 0.05, 0.02]\n\
         {own}[[pins]]\nvertices = {:?}\n[contact]\nself = true\n",
        (0..49).collect::<Vec<u32>>()
    )
}

/// Most pairs of triangles that met after a step, all and those that count; and where the falling sheet ended (m).
fn fallen(scene: &Scene, method: &str) -> (usize, usize, Vec<Vec3>) {
    let method = Method::find(method).unwrap();
    let settings = Settings::default();
    let mut solver = Solver::new(method, &settings, scene, DT).unwrap();
    let mut state = scene.start.clone();
    let mut all = SeparationProbe::new(scene.mesh.as_ref().unwrap());
    let mut counted = scene.separation_probe().unwrap();
    let mut most = [0, 0];
    run_changing(
        scene,
        &mut solver,
        &mut state,
        Plan::new(DT, STEPS),
        |moment| {
            let x = &moment.state.positions;
            for (most, probe) in most.iter_mut().zip([&mut all, &mut counted]) {
                *most = (*most).max(probe.measure(x).unwrap().intersecting_pairs);
            }
            Ok(())
        },
    )
    .unwrap();
    (most[0], most[1], of_the_second(scene, &state.positions))
}

/// The vertices of the second piece.
fn of_the_second(scene: &Scene, x: &[Vec3]) -> Vec<Vec3> {
    let place = |old: usize| match &scene.order {
        Some(order) => order.new_of_old()[old] as usize,
        None => old,
    };
    (49..x.len()).map(|old| x[place(old)]).collect()
}

#[test]
fn an_excluded_piece_falls_through_as_if_the_other_were_not_there() {
    let through = build("through", &two("[mesh.contact]\nexclude = [0]\n")).unwrap();
    let apart = build("apart", &two("")).unwrap();
    for method in ["implicit-euler", "pd", "xpbd"] {
        let (all, counted, end) = fallen(&through, method);
        assert!(all > 0, "{method}: nothing has passed");
        assert_eq!(counted, 0, "{method}");
        // A rigid motion: free fall by steps, by substeps for XPBD; no distance has changed.
        let start = &through.start.positions;
        let drop = 9.81 * DT * DT * f64::from(STEPS * (STEPS + 1)) / 2.0;
        let tolerance = if method == "xpbd" { 0.1 * drop } else { 1e-6 };
        let mean = |x: &[Vec3]| x.iter().map(|x| x.z).sum::<f64>() / x.len() as f64;
        let fell = mean(&of_the_second(&through, start)) - mean(&end);
        assert!((fell - drop).abs() < tolerance, "{method}: {fell} {drop}");

        let (all, counted, end) = fallen(&apart, method);
        assert_eq!((all, counted), (0, 0), "{method}");
        assert!(mean(&end) > 0.0, "{method}: {}", mean(&end));
    }
}

#[test]
fn a_piece_that_there_is_not_is_named() {
    let refused = build("missing", &two("[mesh.contact]\nexclude = [2]\n"));
    let told = refused.unwrap_err().to_string();
    assert!(
        told.contains("missing.toml: line 11") && told.contains("there is no mesh 2"),
        "{told}"
    );
}
