//! Errors of the motion, relative to the size of the cloth.

use crate::program::folder;
use crate::readme::table;

/// Half the lengths, half of gravity, four times the density and no bending: the same motion at half the size, bit for
/// bit, so that errors are the same where they are relative to it.
#[test]
fn errors_are_relative_to_the_size_of_the_scene() {
    let errors = |scale: f64| -> Vec<Vec<String>> {
        let text = format!(
            "gravity = [0, 0, {:?}]\n[[mesh]]\ngenerator = \"grid:3x3:alternating\"\nscale = {scale:?}\n\
             [cloth]\ndensity = {:?}\nrigidity = 0\n[[pins]]\nvertices = [0]\n",
            -9.81 * scale,
            0.2 / (scale * scale),
        );
        let file = folder("work-precision").join(format!("{scale}.toml"));
        std::fs::write(&file, text).unwrap();
        let scene = [
            "work-precision",
            "--quick",
            "--scene",
            file.to_str().unwrap(),
        ];
        let lines = table(&scene, "work-precision").into_iter();
        // The last three are the error, the order and the remark; names have commas too.
        lines.map(|line| line[line.len() - 3..].to_vec()).collect()
    };
    let (whole, half) = (errors(1.0), errors(0.5));
    assert!(whole.len() > 80, "{}", whole.len());
    assert_eq!(whole, half);
}
