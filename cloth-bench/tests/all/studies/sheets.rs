//! The sheet that several studies share.

use cloth_bench::scene;
use cloth_bench::settings::Settings;
use cloth_bench::studies::sheets::{STIFFNESS, hanging, sixteenth_step};
use std::sync::Arc;

#[test]
fn the_sheet_of_the_studies_is_the_scene_as_it_is() {
    let n = Settings::default().with("n", 5);
    let ours = scene::build("hang", None, &hanging(5, STIFFNESS)).unwrap();
    let scene = scene::build("hang", None, &n).unwrap();
    assert_eq!(ours.model.springs, scene.model.springs);
    assert_eq!(ours.model.hinges, scene.model.hinges);
    // Found once, and the same when it is asked for again.
    let found = [0; 2].map(|_| sixteenth_step(&hanging(5, STIFFNESS)).unwrap());
    assert!(Arc::ptr_eq(&found[0], &found[1]));
}
