//! `untangle`, as a user meets it.

use crate::program::{folder, program, refused};
use cloth_collide::SeparationProbe;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid, join, tube};
use cloth_core::mesh::{TriMesh, io, obj};
use std::path::{Path, PathBuf};

/// Two sheets of 0.4 m, 2 mm apart, the middle of the upper one pushed 1 cm below the lower one.
fn layers() -> TriMesh {
    let sheet = |place: &dyn Fn(Vec3) -> Vec3| {
        let flat = grid(17, 17, 0.4, 0.4, Diagonals::Alternating).unwrap();
        let positions = flat.positions().iter().map(|&x| place(x)).collect();
        TriMesh::new(positions, flat.triangles().to_vec()).unwrap()
    };
    let pushed = |x: Vec3| {
        let is_pushed = (x.xy() - Vec3::new(0.2, 0.2, 0.0).xy()).amax() < 0.11;
        Vec3::z() * if is_pushed { -0.01 } else { 2e-3 }
    };
    let lower = sheet(&|x| x + Vec3::new(3.1e-3, 4.7e-3, 0.0));
    join(&[lower, sheet(&|x| x + pushed(x))]).unwrap()
}

/// Two tubes side by side that go through each other from rim to rim: as long as they are, the contour is as short as
/// it can be.
fn tubes() -> TriMesh {
    let one = tube(24, 12, 0.1, 0.4).unwrap();
    let aside = one
        .positions()
        .iter()
        .map(|x| x + Vec3::new(0.11, 0.003, 0.0));
    let other = TriMesh::new(aside.collect(), one.triangles().to_vec()).unwrap();
    join(&[one, other]).unwrap()
}

fn written(name: &str, mesh: &TriMesh) -> (PathBuf, String) {
    let folder = folder(name);
    let path = folder.join("in.obj");
    obj::write(&path, mesh.positions(), mesh.triangles()).unwrap();
    let text = path.to_str().unwrap().to_owned();
    (folder, text)
}

fn crossings(path: &Path) -> usize {
    let mesh = io::read(path).unwrap();
    let measured = SeparationProbe::new(&mesh)
        .measure(mesh.positions())
        .unwrap();
    measured.intersecting_pairs
}

#[test]
fn mesh_is_pulled_apart_and_written() {
    let mesh = layers();
    let (folder, file) = written("untangle", &mesh);
    for name in ["out.obj", "out.ply"] {
        let path = folder.join(name);
        let out = path.to_str().unwrap();
        let done = program(&[
            "untangle",
            &file,
            "--thickness",
            "1e-3",
            "--json",
            "--out",
            out,
        ]);
        let steps = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.success(), "{steps}");
        let told: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
        let before = told["pairs_before"].as_u64().unwrap();
        assert_eq!(before as usize, crossings(Path::new(&file)));
        assert!(before > 50 && steps.starts_with(&format!("iteration 0: {before} pairs")));
        assert_eq!(
            (&told["pairs_after"], &told["outcome"]),
            (&0.into(), &"untangled".into())
        );
        let pairs = told["pairs"].as_array().unwrap();
        assert_eq!(pairs.len() as u64, told["iterations"].as_u64().unwrap() + 1);
        assert_eq!(
            (pairs[0].as_u64(), pairs.last().unwrap().as_u64()),
            (Some(before), Some(0))
        );
        // What was pushed through by 1 cm has to come back by that and the thickness, and each layer goes half of it or
        // a little more.
        let farthest = told["farthest"].as_f64().unwrap();
        assert!(farthest > 5.5e-3 && farthest < 6.6e-3, "{farthest}");
        assert!(told["min_distance"].as_f64().unwrap() > 0.95e-3);
        let result = io::read(&path).unwrap();
        assert_eq!(
            (crossings(&path), result.triangles()),
            (0, mesh.triangles())
        );
        let ways = result
            .positions()
            .iter()
            .zip(mesh.positions())
            .map(|(a, b)| (a - b).norm());
        assert_eq!(ways.fold(0.0, Real::max), farthest);
    }
}

/// A mesh without crossings comes back with the same bits.
#[test]
fn mesh_that_is_not_tangled_stays() {
    let mesh = grid(5, 5, 1.0, 1.0, Diagonals::Crossed).unwrap();
    let (folder, file) = written("untangle-nothing", &mesh);
    let path = folder.join("out.obj");
    let done = program(&["untangle", &file, "--out", path.to_str().unwrap()]);
    assert!(done.status.success());
    assert_eq!(io::read(&path).unwrap(), mesh);
}

#[test]
fn untangle_says_where_it_stalls() {
    let (folder, file) = written("untangle-stalled", &tubes());
    let path = folder.join("out.obj");
    let out = path.to_str().unwrap();
    let done = program(&["untangle", &file, "--json", "--out", out]);
    let told: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(
        (done.status.code(), &told["outcome"]),
        (Some(1), &"stalled".into())
    );
    let left = told["pairs_after"].as_u64().unwrap();
    assert_eq!(left as usize, crossings(&path));
    let message = String::from_utf8_lossy(&done.stderr);
    let error = message.lines().last().unwrap();
    let words = format!(": {left} pairs of triangles still pass through each other, all between (");
    assert!(
        error.starts_with("error: stalled after ") && error.contains(&words),
        "{error}"
    );
    assert!(error.contains("the first are triangles "), "{error}");
    refused(
        &["untangle", &file, "--iterations", "2"],
        1,
        &["not done after 2 iterations"],
    );
}

#[test]
fn what_untangle_cannot_work_with_is_named() {
    let (_, file) = written("untangle-refused", &layers());
    refused(&["untangle", "no-such.obj"], 2, &["no-such.obj"]);
    refused(
        &["untangle", &file, "--out", "a.stl"],
        2,
        &["`a.stl`", ".obj or .ply"],
    );
    for thickness in ["0", "-0.001", "nan", "inf"] {
        refused(
            &["untangle", &file, "--thickness", thickness],
            2,
            &["--thickness is", "positive"],
        );
    }
    refused(&["untangle", &file, "--thickness", "thick"], 2, &["thick"]);
}
