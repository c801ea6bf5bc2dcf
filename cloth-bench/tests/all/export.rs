//! Exported runs, read back without the code that wrote them: every format holds the same motion.

mod glb;

use cloth_core::math::Vec3;
use cloth_core::mesh::{TriMesh, io};
pub(crate) use glb::Glb;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn program(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cloth-bench"))
        .args(arguments)
        .output()
        .expect("the program runs")
}

/// An empty folder of this test's own.
fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    path
}

/// A run with an export, and what it told.
fn export(run: &str, format: &str, to: &Path) -> Value {
    let mut arguments: Vec<&str> = run.split_whitespace().collect();
    arguments.extend(["--json", "--format", format, "--export"]);
    arguments.push(to.to_str().unwrap());
    let output = program(&arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {message}");
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

fn meshes(folder: &Path, extension: &str) -> Vec<(String, TriMesh)> {
    let mut found: Vec<(String, TriMesh)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .map(|path| {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            (name, io::read(&path).unwrap())
        })
        .collect();
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}

/// A turning box below a small sheet.
const BOX: &str = "run drape-box --method xpbd --n 7 --steps 5 --threads 1";

#[test]
fn obj_and_ply_hold_the_same_bits() {
    let [obj, ply] = ["sequence-obj", "sequence-ply"].map(folder);
    let told = export(BOX, "obj", &obj);
    export(BOX, "ply", &ply);
    let (obj, ply) = (meshes(&obj, "obj"), meshes(&ply, "ply"));
    let names: Vec<&str> = ply.iter().map(|(name, _)| &name[..]).collect();
    let frames = (0..=5).map(|step| format!("{step:05}"));
    let boxes = (0..=5).map(|step| format!("obstacle0_{step:05}"));
    assert_eq!(names, frames.chain(boxes).collect::<Vec<_>>());
    assert_eq!(obj, ply);
    assert_eq!(told["export_frames"], 6);
    assert_eq!(told["export_files"], 12);
    assert_ne!(ply[5].1, ply[4].1);
    assert_ne!(ply[11].1, ply[10].1);
    // A sphere that stands still is written once.
    let still = folder("sequence-still");
    let told = export(
        "run drape-sphere --method xpbd --n 5 --steps 4 --export-every 2",
        "ply",
        &still,
    );
    let names: Vec<String> = meshes(&still, "ply")
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    assert_eq!(names, ["00000", "00002", "00004", "obstacle0"]);
    let size = |name: &str| std::fs::metadata(still.join(name)).unwrap().len();
    let bytes: u64 = names.iter().map(|name| size(&format!("{name}.ply"))).sum();
    assert_eq!(told["export_bytes"], bytes);
}

#[test]
fn an_export_changes_nothing_of_the_run() {
    let run = |more: &[&str]| {
        let all = "run drape-box --method xpbd --n 7 --steps 5 --threads 1 --json";
        let arguments: Vec<&str> = all.split_whitespace().chain(more.iter().copied()).collect();
        let told: Value = serde_json::from_slice(&program(&arguments).stdout).unwrap();
        let Value::Object(mut told) = told else {
            panic!("no object")
        };
        told.retain(|key, _| {
            let is_measured = key.contains("ms_") || key.ends_with("_ms") || key == "peak_memory";
            !key.starts_with("export") && !is_measured
        });
        told
    };
    let to = folder("unchanged");
    let alone = run(&[]);
    assert!(alone.len() > 10);
    for format in ["obj", "ply", "vtk", "gltf"] {
        assert_eq!(
            alone,
            run(&["--export", to.to_str().unwrap(), "--format", format])
        );
    }
}

/// The array of an appended-data file of VTK that its XML calls `name`.
fn appended(file: &[u8], name: &str) -> Vec<[u8; 8]> {
    let mark = b"<AppendedData encoding=\"raw\">_";
    let head = file.windows(mark.len()).position(|w| w == mark).unwrap();
    let xml = std::str::from_utf8(&file[..head]).unwrap();
    let tag = xml
        .split("<DataArray")
        .find(|tag| tag.contains(&format!("Name=\"{name}\"")));
    let offset = tag.unwrap().split("offset=\"").nth(1).unwrap();
    let offset: usize = offset.split('"').next().unwrap().parse().unwrap();
    let data = &file[head + mark.len() + offset..];
    let length = u64::from_le_bytes(data[..8].try_into().unwrap()) as usize;
    data[8..8 + length].as_chunks().0.to_vec()
}

#[test]
fn vtk_holds_the_same_bits_and_the_times() {
    let [vtk, ply] = ["vtk", "vtk-ply"].map(folder);
    export(BOX, "vtk", &vtk);
    export(BOX, "ply", &ply);
    let vectors = |file: &[u8], name: &str| -> Vec<Vec3> {
        let numbers: Vec<f64> = appended(file, name)
            .into_iter()
            .map(f64::from_le_bytes)
            .collect();
        numbers.chunks(3).map(Vec3::from_column_slice).collect()
    };
    let collection = std::fs::read_to_string(vtk.join("run.pvd")).unwrap();
    for (name, mesh) in meshes(&ply, "ply") {
        let file = match name.strip_prefix("obstacle0") {
            Some(step) => format!("obstacle0{step}.vtp"),
            None => format!("cloth_{name}.vtp"),
        };
        let step: f64 = name[name.len() - 5..].parse().unwrap();
        let entry = collection
            .lines()
            .find(|line| line.contains(&file))
            .unwrap();
        let time: f64 = entry.split('"').nth(1).unwrap().parse().unwrap();
        assert!((time - step / 60.0).abs() < 1e-15, "{entry}");
        let bytes = std::fs::read(vtk.join(&file)).unwrap();
        let positions = vectors(&bytes, "position");
        assert_eq!(positions, mesh.positions());
        let integers = |name| appended(&bytes, name).into_iter().map(i64::from_le_bytes);
        let corners = mesh
            .triangles()
            .as_flattened()
            .iter()
            .map(|&v| i64::from(v));
        assert!(integers("connectivity").eq(corners));
        assert!(integers("offsets").eq((1..=mesh.triangle_count() as i64).map(|n| 3 * n)));
    }
    // In free fall every velocity is known.
    let fall = folder("vtk-fall");
    export("run drop --method xpbd --n 3 --steps 6", "vtk", &fall);
    let bytes = std::fs::read(fall.join("cloth_00006.vtp")).unwrap();
    let velocities = vectors(&bytes, "velocity");
    assert_eq!(velocities.len(), 9);
    for v in velocities {
        assert!((v + Vec3::z() * 0.981).norm() < 1e-12, "{v}");
    }
}

/// A sheet that rests on a slope: forces on its vertices are the same bits in both formats, carry its weight, and leave
/// the mesh as it is.
#[test]
fn vtk_and_ply_hold_the_same_forces() {
    let folder_of = |name: &str| {
        let path = folder(name);
        std::fs::create_dir_all(&path).unwrap();
        path
    };
    let [vtk, ply] = ["forces-vtk", "forces-ply"].map(folder_of);
    let scene = ply.with_extension("toml");
    let text = "dt = 0.01\ngravity = [1, 0, -9.81]\n[[mesh]]\ngenerator = \"grid:3x3:alternating\"\n\
                translate = [0, 0, 0.00199804]\n[[obstacle]]\nshape = \"plane\"\n";
    std::fs::write(&scene, text).unwrap();
    let table = ply.with_extension("csv");
    let run = format!(
        "run {} --method xpbd --steps 40 --forces {}",
        scene.display(),
        table.display()
    );
    export(&run, "vtk", &vtk);
    export(&run, "ply", &ply);
    let of_vtk = std::fs::read(vtk.join("cloth_00040.vtp")).unwrap();
    let of_ply = std::fs::read(ply.join("00040.ply")).unwrap();
    let end = b"end_header\n";
    let head = of_ply.windows(end.len()).position(|w| w == end).unwrap();
    let (head, body) = of_ply.split_at(head + end.len());
    let head = std::str::from_utf8(head).unwrap();
    let names = head
        .lines()
        .filter_map(|l| l.strip_prefix("property double "));
    let names: Vec<&str> = names.collect();
    let numbers: Vec<f64> = body[..9 * 8 * names.len()]
        .as_chunks()
        .0
        .iter()
        .map(|number| f64::from_le_bytes(*number))
        .collect();
    let column = |name: &str| {
        let at = names.iter().position(|n| *n == name).unwrap();
        numbers.iter().skip(at).step_by(names.len()).copied()
    };
    let mut sums = [[0.0; 3]; 2];
    for (what, sums) in ["pressure", "friction"].into_iter().zip(&mut sums) {
        let expected = appended(&of_vtk, what).into_iter().map(f64::from_le_bytes);
        let expected: Vec<f64> = expected.collect();
        for (axis, name) in ["x", "y", "z"].iter().enumerate() {
            let found = column(&format!("{what}_{name}"));
            assert!(
                found
                    .clone()
                    .eq(expected.iter().skip(axis).step_by(3).copied())
            );
            sums[axis] = found.sum();
        }
    }
    let mass = 0.2;
    for (found, expected) in sums
        .as_flattened()
        .iter()
        .zip([[0.0, 0.0, 9.81 * mass], [-mass, 0.0, 0.0]].as_flattened())
    {
        assert!((found - expected).abs() < 1e-4, "{sums:?}");
    }
    // A reader of meshes finds the mesh; the start has no forces.
    let read = |name: &str| io::read(&ply.join(name)).unwrap();
    assert_eq!(read("00040.ply").triangles(), read("00000.ply").triangles());
    assert!(read("00040.ply").positions().iter().all(|x| x.z > 1e-3));
    assert!(
        !String::from_utf8_lossy(&std::fs::read(ply.join("00000.ply")).unwrap())
            .contains("pressure")
    );
}

#[test]
fn gltf_plays_the_same_motion() {
    let [gltf, ply] = ["gltf", "gltf-ply"].map(folder);
    let told = export(BOX, "gltf", &gltf);
    export(BOX, "ply", &ply);
    let ply = meshes(&ply, "ply");
    let glb = Glb::read(&gltf.join("run.glb"));
    assert_eq!(told["export_files"], 1);
    let size = std::fs::metadata(gltf.join("run.glb")).unwrap().len();
    assert_eq!(told["export_bytes"], size);

    // The root turns z up into y up, and carries everything.
    let root: Vec<f64> = serde_json::from_value(glb.json["nodes"][0]["rotation"].clone()).unwrap();
    let root = UnitQuaternion::new_unchecked(Quaternion::new(root[3], root[0], root[1], root[2]));
    assert!((root * Vec3::z() - Vec3::y()).norm() < 1e-6);
    assert_eq!(glb.json["nodes"][0]["children"], serde_json::json!([1, 2]));
    assert_eq!(glb.json["scenes"][0]["nodes"], serde_json::json!([0]));

    let primitive = &glb.mesh_of(1)["primitives"][0];
    let start = glb.vectors(&primitive["attributes"]["POSITION"]);
    assert_eq!(glb.corners(primitive), ply[0].1.triangles().as_flattened());
    let targets = primitive["targets"].as_array().unwrap();
    let targets: Vec<Vec<Vec3>> = targets
        .iter()
        .map(|t| glb.vectors(&t["POSITION"]))
        .collect();
    assert_eq!(targets.len(), 5);
    assert_eq!(glb.mesh_of(1)["weights"].as_array().unwrap().len(), 5);
    let [times, weights] = glb.animation(1, "weights").unwrap();
    assert_eq!([times.len(), weights.len()], [6, 30]);
    let [_, shifts] = glb.animation(2, "translation").unwrap();
    let [_, turns] = glb.animation(2, "rotation").unwrap();
    let obstacle = &glb.mesh_of(2)["primitives"][0];
    let body = glb.vectors(&obstacle["attributes"]["POSITION"]);
    assert_eq!(glb.corners(obstacle), ply[6].1.triangles().as_flattened());

    for frame in 0..6 {
        assert!((times[frame] - frame as f64 / 60.0).abs() < 1e-8);
        let weights = &weights[5 * frame..5 * (frame + 1)];
        for (vertex, expected) in ply[frame].1.positions().iter().enumerate() {
            let moved = weights
                .iter()
                .zip(&targets)
                .map(|(w, target)| target[vertex] * *w);
            let x = start[vertex] + moved.sum::<Vec3>();
            assert!(
                (x - expected).norm() < 1e-7,
                "frame {frame}: {x} {expected}"
            );
        }
        let shift = Vec3::from_column_slice(&shifts[3 * frame..3 * frame + 3]);
        let q = &turns[4 * frame..4 * frame + 4];
        let turn = UnitQuaternion::new_unchecked(Quaternion::new(q[3], q[0], q[1], q[2]));
        for (x, expected) in body.iter().zip(ply[6 + frame].1.positions()) {
            let x: Vector3<f64> = turn * x + shift;
            assert!(
                (x - expected).norm() < 1e-6,
                "frame {frame}: {x} {expected}"
            );
        }
    }
}

/// A triangle that a scene file moves and bends: vertex v is at `shapes()[k][v]` (m) at the time 0.05 s times k.
fn shapes() -> [[Vec3; 3]; 3] {
    [
        [[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 1.0, -1.0]],
        [[0.25, 0.0, -1.0], [1.0, 0.5, -1.0], [0.0, 1.0, -2.0]],
        [[0.75, 0.0, -1.0], [1.0, 0.5, -1.5], [0.0, 2.0, -2.0]],
    ]
    .map(|shape| shape.map(Vec3::from))
}

/// A scene file of a sheet far above an animation, which stands before a box that turns.
fn animation() -> PathBuf {
    let folder = folder("animation");
    std::fs::create_dir_all(folder.join("shapes")).unwrap();
    for (k, shape) in shapes().iter().enumerate() {
        let text = cloth_core::mesh::obj::format(shape, &[[0, 1, 2]]);
        std::fs::write(folder.join(format!("shapes/{k}.obj")), text).unwrap();
    }
    let path = folder.join("scene.toml");
    let text = "dt = 0.02\n[[mesh]]\ngenerator = \"grid:3x3:alternating\"\ntranslate = [0, 0, 5]\n\
                [[obstacle]]\nshape = \"animation\"\nfolder = \"shapes\"\ninterval = 0.05\nposition = [0, 0, 0.5]\n\
                [[obstacle]]\nshape = \"box\"\nsize = [1, 2, 3]\nposition = [9, 0, 0]\nangular_velocity = [0, 0, 1]\n";
    std::fs::write(&path, text).unwrap();
    path
}

/// Where vertex v of the animation is at a time (s).
fn interpolated(time: f64, v: usize) -> Vec3 {
    let shapes = shapes().map(|shape| shape[v] + Vec3::z() * 0.5);
    let [a, b, part] = match time / 0.05 {
        place if place < 1.0 => [shapes[0], shapes[1], Vec3::repeat(place)],
        place if place < 2.0 => [shapes[1], shapes[2], Vec3::repeat(place - 1.0)],
        _ => [shapes[2], shapes[2], Vec3::zeros()],
    };
    a + (b - a).component_mul(&part)
}

/// Six steps of 0.02 s: the animation is between its shapes and, in the end, beyond the last.
#[test]
fn an_animation_is_exported_where_it_is() {
    let run = format!("run {} --method xpbd --steps 6", animation().display());
    for format in ["obj", "ply", "vtk"] {
        let to = folder(&format!("animation-{format}"));
        let told = export(&run, format, &to);
        let per_frame = 3 * 7;
        assert_eq!(told["export_files"], per_frame + i32::from(format == "vtk"));
        for step in 0..=6 {
            let name = format!("obstacle0_{step:05}");
            let positions = if format == "vtk" {
                let bytes = std::fs::read(to.join(format!("{name}.vtp"))).unwrap();
                let numbers = appended(&bytes, "position").into_iter();
                let numbers: Vec<f64> = numbers.map(f64::from_le_bytes).collect();
                numbers.chunks(3).map(Vec3::from_column_slice).collect()
            } else {
                let read = io::read(&to.join(format!("{name}.{format}"))).unwrap();
                assert_eq!(read.triangles(), [[0, 1, 2]]);
                read.positions().to_vec()
            };
            assert_eq!(positions.len(), 3);
            for (v, x) in positions.iter().enumerate() {
                let expected = interpolated(0.02 * f64::from(step), v);
                assert!((x - expected).norm() < 1e-14, "{name}: {x} {expected}");
            }
        }
    }
    let to = folder("animation-gltf");
    export(&run, "gltf", &to);
    let glb = Glb::read(&to.join("run.glb"));
    assert_eq!(glb.json["nodes"][2]["name"], "obstacle0");
    assert_eq!(glb.json["nodes"][3]["name"], "obstacle1");
    assert!(glb.animation(3, "rotation").is_some());
    let primitive = &glb.mesh_of(2)["primitives"][0];
    assert_eq!(primitive["material"], 1);
    assert_eq!(glb.corners(primitive), [0, 1, 2]);
    assert_eq!(glb.mesh_of(2)["weights"].as_array().unwrap().len(), 6);
    let start = glb.vectors(&primitive["attributes"]["POSITION"]);
    let targets = primitive["targets"].as_array().unwrap().iter();
    let targets: Vec<_> = targets.map(|t| glb.vectors(&t["POSITION"])).collect();
    let [times, weights] = glb.animation(2, "weights").unwrap();
    for (time, weights) in times.iter().zip(weights.chunks(6)) {
        for v in 0..3 {
            let moved = weights.iter().zip(&targets).map(|(w, t)| t[v] * *w);
            let x = start[v] + moved.sum::<Vec3>();
            let expected = interpolated(*time, v);
            assert!((x - expected).norm() < 1e-6, "{time} s: {x} {expected}");
        }
    }
}

#[test]
fn one_frame_is_a_gltf_without_an_animation() {
    let to = folder("gltf-still");
    export("run hang --method xpbd --n 3 --steps 0", "gltf", &to);
    let glb = Glb::read(&to.join("run.glb"));
    assert_eq!(glb.json["animations"], Value::Null);
    assert_eq!(glb.json["meshes"][0]["weights"], Value::Null);
    assert_eq!(glb.json["bufferViews"].as_array().unwrap().len(), 2);
}

#[test]
fn a_run_that_fails_leaves_its_frames() {
    let to = folder("gltf-failed");
    let run = "run hang --method explicit-euler --set substeps=1 --n 5 --format gltf --export";
    let mut arguments: Vec<&str> = run.split_whitespace().collect();
    arguments.push(to.to_str().unwrap());
    let output = program(&arguments);
    assert_eq!(output.status.code(), Some(1));
    let glb = Glb::read(&to.join("run.glb"));
    assert_eq!(glb.json["asset"]["version"], "2.0");
}

fn refused(run: &str, to: &Path, code: i32, words: &[&str]) {
    let mut arguments: Vec<&str> = run.split_whitespace().collect();
    arguments.extend(["--export", to.to_str().unwrap()]);
    let output = program(&arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{run}: {message}");
    for word in words {
        assert!(
            message.contains(word),
            "{run} says `{message}`, which lacks `{word}`"
        );
    }
}

#[test]
fn what_cannot_be_written_is_named() {
    let to = folder("refused");
    let hang = "run hang --method xpbd --n 3 --steps 3";
    refused(
        &format!("{hang} --export-every 0"),
        &to,
        2,
        &["--export-every", "at least 1"],
    );
    refused(
        "run chain --method xpbd",
        &to,
        2,
        &["chain", "no triangles"],
    );
    refused(&format!("{hang} --format off"), &to, 2, &["off", "obj"]);
    // A file where the folder should be.
    std::fs::create_dir_all(&to).unwrap();
    let file = to.join("file");
    std::fs::write(&file, "").unwrap();
    refused(
        hang,
        &file,
        1,
        &["refused/file", "folder for the export cannot be made"],
    );
    // A folder where a file should be: found out before the first step.
    std::fs::create_dir_all(to.join("00000.obj")).unwrap();
    refused(hang, &to, 1, &["00000.obj", "cannot be written"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_named() {
    for (format, file) in [
        ("obj", "00002.obj"),
        ("ply", "00002.ply"),
        ("vtk", "cloth_00002.vtp"),
        ("vtk", "run.pvd"),
        ("gltf", "run.glb"),
    ] {
        let to = folder(&format!("full-{file}"));
        std::fs::create_dir_all(&to).unwrap();
        // Every write to this device fails for want of room.
        std::os::unix::fs::symlink("/dev/full", to.join(file)).unwrap();
        let run = format!("run hang --method xpbd --n 3 --steps 3 --format {format}");
        refused(&run, &to, 1, &[file, "cannot be written", "No space left"]);
    }
}

/// A limit on the size of files stands for a disk that is full in the middle of one: a file is there whole, or not at
/// all.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_no_part_of_a_file() {
    // A frame takes more than the 2 kB that there are; run.pvd after 40 frames too, but none of those of 9 vertices.
    for (format, n, frames) in [
        ("obj", 9, 0),
        ("ply", 9, 0),
        ("vtk", 9, 0),
        ("gltf", 9, 0),
        ("vtk", 3, 41),
    ] {
        let to = folder(&format!("cut-off-{format}-{n}"));
        let limited = "trap '' XFSZ; ulimit -f 4; exec \"$@\"";
        let run = format!("run hang --method xpbd --n {n} --steps 40 --format {format} --export");
        let output = Command::new("sh")
            .args(["-c", limited, "sh", env!("CARGO_BIN_EXE_cloth-bench")])
            .args(run.split(' '))
            .arg(&to)
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{told}");
        assert!(told.contains("cannot be written: File too large"), "{told}");
        let files: Vec<_> = std::fs::read_dir(&to).unwrap().collect();
        assert_eq!(files.len(), frames, "{format}: {files:?}");
    }
}
