//! Films of a page.

use cloth_bench::report::html::base64;
use cloth_bench::report::player::{Film, Playback, Track};
use cloth_core::math::Vec3;
use serde_json::json;

#[test]
fn positions_keep_sixteen_bits() {
    let frames = [
        vec![Vec3::new(-1.0, 2.0, 5.0), Vec3::new(0.0, 2.0, 5.5)],
        vec![Vec3::new(3.0, 2.0, 6.0), Vec3::new(1.0, 2.0, 5.0)],
    ];
    let film = Film::of_cloth(&[[0, 1, 258]], &frames);
    let film = serde_json::to_value(&film).unwrap();
    assert_eq!(film["low"], json!([-1.0, 2.0, 5.0]));
    assert_eq!(film["size"], json!([4.0, 0.0, 1.0]));
    assert_eq!(
        film["triangles"],
        base64(&[0, 0, 0, 0, 1, 0, 0, 0, 2, 1, 0, 0])
    );
    // 0, 0, 0; ¼, 0, ½; 1, 0, 1; ½, 0, 0 of 65535.
    let numbers: [u16; 12] = [0, 0, 0, 16384, 0, 32768, 65535, 0, 65535, 32768, 0, 0];
    let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    assert_eq!(film["frames"], base64(&bytes));
}

#[test]
fn names_cannot_end_the_script() {
    let playback = Playback {
        caption: "</script>".into(),
        seconds_per_frame: 0.1,
        tracks: vec![Track {
            name: "</script><b>".into(),
            surfaces: vec![Film::of_obstacle(&[], &[])],
        }],
    };
    let html = playback.to_html();
    assert_eq!(html.matches("</script>").count(), 1);
    assert!(!html.contains("<b>"));
}
