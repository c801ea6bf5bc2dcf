//! The page that plays a run holds the motion, and the forces of contact as colour.

use crate::program::folder;
use crate::scene_text::scene;
use cloth_bench::export::{Export, Format};
use cloth_bench::method::Method;
use cloth_bench::run::{Plan, Solver, run_changing};
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;
use serde_json::Value;

fn decoded(value: &Value) -> Vec<u8> {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let text = value.as_str().unwrap().trim_end_matches('=');
    let (mut bits, mut count, mut out) = (0_u32, 0, Vec::new());
    for letter in text.bytes() {
        let six = LETTERS.iter().position(|l| *l == letter).unwrap();
        bits = bits << 6 | six as u32;
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
    }
    out
}

/// The places (m) of a film, frame by frame.
fn places(film: &Value) -> Vec<Vec<Vec3>> {
    let number = |list: &str, axis: usize| film[list][axis].as_f64().unwrap();
    let coordinates: Vec<f64> = decoded(&film["frames"])
        .as_chunks::<2>()
        .0
        .iter()
        .enumerate()
        .map(|(k, bytes)| {
            let part = f64::from(u16::from_le_bytes(*bytes)) / 65535.0;
            number("low", k % 3) + number("size", k % 3) * part
        })
        .collect();
    let vertices = film["vertices"].as_u64().unwrap() as usize;
    let points = coordinates
        .as_chunks::<3>()
        .0
        .iter()
        .map(|x| Vec3::from(*x));
    let points: Vec<Vec3> = points.collect();
    points.chunks(vertices).map(<[Vec3]>::to_vec).collect()
}

/// A sheet falls on a ball, y up, and is torn on the way.
#[test]
fn page_plays_the_run_with_forces_as_colour() {
    let text = "dt = 0.01\ngravity = [0, -9.81, 0]\n[[mesh]]\ngenerator = \"grid:9x9:alternating\"\nscale = 0.4\n\
                rotate = [-1.5707963267948966, 0, 0]\ntranslate = [-0.2, 0.104, 0.2]\n\
                [[obstacle]]\nshape = \"sphere\"\nradius = 0.1\n\
                [[event]]\ntime = 0.06\ndo = \"tear\"\nline = [[-0.13, 0.104, 0.13], [-0.13, 0.104, -0.05]]\n";
    let scene = scene("played", text);
    let (method, settings) = (Method::find("xpbd").unwrap(), Settings::default());
    let to = folder("page");
    let mut export = Export::begin(&scene, &to, Format::Html, 2).unwrap();
    let mut solver = Solver::new(method, &settings, &scene, scene.dt).unwrap();
    let mut state = scene.start.clone();
    let plan = Plan {
        forces: true,
        ..Plan::new(scene.dt, 12)
    };
    let mut frames = vec![state.positions.clone()];
    let mut forces = vec![vec![0.0; state.positions.len()]];
    run_changing(&scene, &mut solver, &mut state, plan, |moment| {
        if moment.step % 2 == 0 {
            frames.push(moment.state.positions.clone());
            let f = moment.forces.unwrap();
            let both = f.normal.iter().zip(&f.friction);
            forces.push(both.map(|(a, b)| (a + b).norm()).collect());
        }
        export.after(moment)
    })
    .unwrap();
    assert_eq!(export.finish().unwrap().frames, 7);
    let page = std::fs::read_to_string(to.join("run.html")).unwrap();
    let data = page.split("application/json\">").nth(1).unwrap();
    let data: Value = serde_json::from_str(data.split("</script>").next().unwrap()).unwrap();
    assert!((data["seconds_per_frame"].as_f64().unwrap() - 0.02).abs() < 1e-12);
    let films = data["tracks"][0]["surfaces"].as_array().unwrap();
    let cloth: Vec<&Value> = films
        .iter()
        .filter(|film| film["is_cloth"] == true)
        .collect();
    assert_eq!((films.len(), cloth.len()), (3, 2));
    let mut all = forces.concat();
    all.retain(|force| *force > 0.0);
    all.sort_by(f64::total_cmp);
    let largest = all[19 * all.len() / 20];
    assert!(largest > 0.0);
    // The tear is before the seventh step, of which the fourth frame is the first one after it.
    for (film, shown) in cloth.iter().zip([0..4, 4..7]) {
        let reds = decoded(&film["reds"]);
        for (frame, x) in places(film).iter().enumerate() {
            if !shown.contains(&frame) {
                assert!(x.iter().all(|other| *other == x[0]), "{frame}: it is seen");
                continue;
            }
            for (v, x) in x.iter().enumerate() {
                // The player has z up.
                let real = frames[frame][v];
                let turned = Vec3::new(real.x, -real.z, real.y);
                assert!((x - turned).amax() < 1e-5, "{frame}: {x} {turned}");
                let red = f64::from(reds[frame * frames[0].len() + v]);
                let expected = 255.0 * (forces[frame][v] / largest).sqrt().min(1.0);
                assert!((red - expected).abs() < 0.51, "{frame}: {red} {expected}");
            }
        }
    }
    let left = |film: &Value| decoded(&film["triangles"]).len();
    assert!(left(cloth[1]) < left(cloth[0]));
}
