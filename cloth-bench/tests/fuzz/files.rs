//! Mesh files and scene files.

use crate::{Random, folder, fuzz};
use cloth_bench::scene::file;
use cloth_bench::settings::Settings;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::mesh::{TriMesh, obj, ply};

/// What a reader gives can be worked with.
fn check(mesh: &TriMesh) {
    let finite = |x: &cloth_core::math::Vec3| x.iter().all(|x| x.is_finite());
    assert!(mesh.positions().iter().all(finite));
    let corners = mesh.triangles().iter().flatten();
    assert!(corners.copied().all(|v| (v as usize) < mesh.vertex_count()));
}

fn mesh(random: &mut Random) -> TriMesh {
    let (n, m) = (2 + random.below(3), 2 + random.below(3));
    grid(n, m, 1.0, 0.5, Diagonals::Crossed).unwrap()
}

#[test]
fn obj_files() {
    fuzz(50_000, |random| {
        let mesh = mesh(random);
        let mut text = obj::format(mesh.positions(), mesh.triangles()).into_bytes();
        random.mutate(&mut text);
        if let Ok(mesh) = obj::parse(&String::from_utf8_lossy(&text)) {
            check(&mesh);
        }
    });
}

#[test]
fn ply_files() {
    let encodings = [
        ply::Encoding::Ascii,
        ply::Encoding::BinaryLittleEndian,
        ply::Encoding::BinaryBigEndian,
    ];
    fuzz(50_000, |random| {
        let mesh = mesh(random);
        let encoding = encodings[random.below(encodings.len())];
        let mut bytes = ply::format(mesh.positions(), mesh.triangles(), encoding);
        random.mutate(&mut bytes);
        if let Ok(mesh) = ply::parse(&bytes) {
            check(&mesh);
        }
    });
}

/// One of everything, and small.
const SCENE: &str = r#"
gravity = [0, 0, -9.81]
dt = 0.01
steps = 3
[[mesh]]
generator = "grid:4x3:alternating"
scale = [1, 0.25, 1]
rotate = [0.5, 0, 0]
translate = [0, 0, 1]
[cloth]
density = 0.2
stiffness = 1e4
rigidity = 1e-5
[[pins]]
select = "corners"
move = [0, 0, 0.5]
turn = [0, 0, 3]
centre = [0.5, 0, 1]
duration = 0.5
[start]
velocity = [0, 1, 0]
wave = [0, 0, 0.01]
wave_number = [1, 0, 0]
[air]
wind = [1, 0, 0]
[[obstacle]]
shape = "sphere"
radius = 0.25
position = [0, 0, -1]
velocity = [0, 0, 0.1]
[contact]
self = true
thickness = 1e-3
"#;

#[test]
fn scene_files() {
    let path = folder("scene-files").join("scene.toml");
    fuzz(2000, |random| {
        let mut text = SCENE.as_bytes().to_vec();
        random.mutate(&mut text);
        std::fs::write(&path, &text).unwrap();
        if let Ok(scene) = file::build(&path, &Settings::default()) {
            assert_eq!(scene.start.first_non_finite(), None);
            assert!(scene.dt > 0.0 && scene.dt.is_finite());
        }
    });
}
