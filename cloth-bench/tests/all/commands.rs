//! Work without progress to show is spoken of; pictures are seen from where one wants.

use crate::program::{folder, program, refused};
use cloth_bench::commands::while_saying;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

#[test]
fn long_work_is_spoken_of_until_it_ends() {
    let said = AtomicU32::new(0);
    let say = || {
        said.fetch_add(1, Ordering::Relaxed);
    };
    let result = while_saying(Duration::from_millis(1), say, || {
        while said.load(Ordering::Relaxed) < 3 {
            std::thread::yield_now();
        }
        7
    });
    assert_eq!(result, 7);
}

/// The part of a picture of a flat sheet, seen along a direction, that is not background.
fn seen(look: &str) -> f64 {
    let file = folder("look").join(format!("{look}.png"));
    let path = file.to_str().unwrap();
    let run = ["run", "drop", "--n", "9", "--method", "pd", "--steps", "1"];
    let output = program(&[&run[..], &["--picture", path, "--look", look]].concat());
    assert!(output.status.success(), "{output:?}");
    let bytes = std::fs::read(&file).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let pixels: Vec<&[u8]> = pixels
        .chunks(info.line_size / info.width as usize)
        .collect();
    let other = pixels.iter().filter(|pixel| **pixel != pixels[0]).count();
    other as f64 / pixels.len() as f64
}

#[test]
fn a_picture_is_seen_from_where_one_wants() {
    // From above all of it, along it next to nothing.
    let [above, along, long] = ["0,0,-1", "0,1,0", "0,1e200,0"].map(seen);
    assert!(above > 0.5 && along < 0.1, "{above} {along}");
    assert_eq!(along, long);
    let run = ["run", "drop", "--n", "9", "--method", "pd", "--steps", "1"];
    let named = [&run[..], &["--picture", "look.jpg"]].concat();
    refused(&named, 2, &["look.jpg has to end in .png"]);
    for look in ["0,0", "0,0,0", "0,nan,1", "inf,0,0", "up"] {
        let wrong = [&run[..], &["--picture", "look.png", "--look", look]].concat();
        refused(
            &wrong,
            2,
            &["--look", "three finite numbers such as 0,1,-0.3"],
        );
    }
}

/// Studies take other numbers of substeps.
#[test]
fn list_shows_the_settings_that_run_takes() {
    let told = program(&["list", "--json"]).stdout;
    let told: serde_json::Value = serde_json::from_slice(&told).unwrap();
    let default = |method: &str, key: &str| {
        let named = |all: &serde_json::Value, name: &str| {
            let mut all = all.as_array().unwrap().iter();
            all.find(|entry| entry["name"] == name).unwrap().clone()
        };
        let method = named(&told["methods"], method);
        named(&method["parameters"], key)["default"].clone()
    };
    for method in ["xpbd", "pbd"] {
        assert_eq!(default(method, "substeps"), "auto");
    }
    assert_eq!(default("linear-implicit", "linear_tolerance"), "1e-8");
}
