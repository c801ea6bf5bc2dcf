//! A figure of capsules that walks on the spot, as a sequence of OBJ files, and a gown for it: how
//! `scenes/figure` and `scenes/gown.obj` were made.
//!
//! ```sh
//! cargo run --release -p cloth-bench --example figure -- cloth-bench/scenes
//! ```
//!
//! A body of several closed parts that reach into each other, with the same triangles in every file, is what
//! `shape = "animation"` takes.

use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::obj;
use nalgebra::{Rotation3, UnitQuaternion};
use std::error::Error;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::Path;

/// Vertices around a capsule, and rings in each of its halves.
const AROUND: usize = 8;
const RINGS: usize = 2;
/// Shapes, a tenth of a second apart, and steps of the walk (1/s).
const SHAPES: usize = 21;
const INTERVAL: Real = 0.1;
const PACE: Real = 1.25;

/// A capsule between two points (m).
struct Limb {
    from: Vec3,
    to: Vec3,
    /// Of both halves (m), across and along the walk.
    radii: [Real; 2],
}

/// All limbs at a time (s): the figure looks along y, z is up.
fn limbs(time: Real) -> Vec<Limb> {
    // It stands still at first.
    let swing = (TAU * PACE * 0.5 * time).sin() * (time / 0.4).min(1.0);
    let limb = |from: Vec3, to: Vec3, radii| Limb { from, to, radii };
    let at = Vec3::new;
    let mut all = vec![
        limb(at(0.0, 0.0, 1.0), at(0.0, 0.0, 1.3), [0.17, 0.11]),
        limb(at(0.0, 0.0, 1.38), at(0.0, 0.0, 1.52), [0.05, 0.05]),
        limb(at(0.0, 0.0, 1.57), at(0.0, 0.0, 1.64), [0.085, 0.1]),
    ];
    for side in [-1.0, 1.0] {
        let phase = swing * side;
        // Bent forwards, a leg from the hip and an arm of the other side from the shoulder.
        let down = |angle: Real, length: Real| at(0.0, angle.sin(), -angle.cos()) * length;
        let hip = at(0.09 * side, 0.0, 0.92);
        let knee = hip + down(0.45 * phase, 0.42);
        let foot = knee + down(0.45 * phase - 0.5 * (0.5 - 0.5 * phase), 0.42);
        all.push(limb(hip, knee, [0.075; 2]));
        all.push(limb(knee, foot, [0.055; 2]));
        let shoulder = at(0.2 * side, 0.0, 1.36);
        let elbow = shoulder + at(0.03 * side, 0.0, 0.0) + down(-0.4 * phase, 0.28);
        let hand = elbow + down(-0.4 * phase + 0.3, 0.26);
        all.push(limb(shoulder, elbow, [0.05; 2]));
        all.push(limb(elbow, hand, [0.04; 2]));
    }
    all
}

/// Adds the surface of a limb to the lists of a mesh.
fn add(limb: &Limb, positions: &mut Vec<Vec3>, triangles: &mut Vec<[u32; 3]>) {
    let axis = limb.to - limb.from;
    let turn = UnitQuaternion::rotation_between(&Vec3::z(), &axis)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vec3::x_axis(), 2.0 * FRAC_PI_2));
    // Down to the pole of one half, and from there to that of the other; across stays across.
    let turn = match axis.z < 0.0 {
        true => turn * Rotation3::from_axis_angle(&Vec3::z_axis(), 2.0 * FRAC_PI_2),
        false => turn * Rotation3::identity(),
    };
    let [across, along] = limb.radii;
    let point = |height: Real, angle: Real, end: &Vec3| {
        let wide = height.cos();
        let place = Vec3::new(
            across * wide * angle.cos(),
            along * wide * angle.sin(),
            0.5 * (across + along) * height.sin(),
        );
        end + turn * place
    };
    let first = positions.len() as u32;
    positions.push(point(-FRAC_PI_2, 0.0, &limb.from));
    for ring in 0..2 * RINGS {
        let is_lower = ring < RINGS;
        let part = match is_lower {
            true => ring as Real + 1.0 - RINGS as Real,
            false => (ring - RINGS) as Real,
        };
        let height = FRAC_PI_2 * part / RINGS as Real;
        for step in 0..AROUND {
            let angle = TAU * step as Real / AROUND as Real;
            let end = if is_lower { &limb.from } else { &limb.to };
            positions.push(point(height, angle, end));
        }
    }
    let last = positions.len() as u32;
    positions.push(point(FRAC_PI_2, 0.0, &limb.to));
    let vertex = |ring: usize, step: usize| first + 1 + (ring * AROUND + step % AROUND) as u32;
    for step in 0..AROUND {
        triangles.push([first, vertex(0, step + 1), vertex(0, step)]);
        for ring in 0..2 * RINGS - 1 {
            let corners = [0, 1].map(|up| [0, 1].map(|on| vertex(ring + up, step + on)));
            triangles.push([corners[0][0], corners[0][1], corners[1][1]]);
            triangles.push([corners[0][0], corners[1][1], corners[1][0]]);
        }
        let top = 2 * RINGS - 1;
        triangles.push([last, vertex(top, step), vertex(top, step + 1)]);
    }
}

/// A gown without sleeves, a surface of revolution around the figure: a collar, shoulders, and straight down.
fn gown() -> Result<TriMesh, Box<dyn Error>> {
    const STEPS: usize = 72;
    let mut profile = Vec::new();
    for ring in 0..=9 {
        let part = Real::from(ring) / 9.0;
        profile.push([0.15 + 0.18 * part, 1.475 - 0.02 * part * part]);
    }
    for ring in 1..=40 {
        let part = Real::from(ring) / 40.0;
        profile.push([0.33 + 0.07 * part, 1.455 - 0.8 * part]);
    }
    let mut positions = Vec::new();
    for [radius, height] in &profile {
        for step in 0..STEPS {
            let angle = TAU * step as Real / STEPS as Real;
            // Less deep than wide.
            positions.push(Vec3::new(
                radius * angle.cos(),
                0.8 * radius * angle.sin(),
                *height,
            ));
        }
    }
    let vertex = |ring: usize, step: usize| (ring * STEPS + step % STEPS) as u32;
    let mut triangles = Vec::new();
    for ring in 0..profile.len() - 1 {
        for step in 0..STEPS {
            let [a, b] = [0, 1].map(|on| vertex(ring, step + on));
            let [c, d] = [0, 1].map(|on| vertex(ring + 1, step + on));
            match (ring + step) % 2 {
                0 => triangles.extend([[a, c, b], [b, c, d]]),
                _ => triangles.extend([[a, c, d], [a, d, b]]),
            }
        }
    }
    Ok(TriMesh::new(positions, triangles)?)
}

/// Rounded to a tenth of a millimetre, so that files are short.
fn rounded(positions: &[Vec3]) -> Vec<Vec3> {
    let round = |x: &Vec3| x.map(|c| (c * 1e4).round() / 1e4);
    positions.iter().map(round).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("say into which folder")?;
    let figure = Path::new(&folder).join("figure");
    std::fs::create_dir_all(&figure)?;
    for shape in 0..SHAPES {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for limb in limbs(INTERVAL * shape as Real) {
            add(&limb, &mut positions, &mut triangles);
        }
        let mesh = TriMesh::new(rounded(&positions), triangles)?;
        obj::write(
            &figure.join(format!("{shape:02}.obj")),
            mesh.positions(),
            mesh.triangles(),
        )?;
    }
    let gown = gown()?;
    let gown = TriMesh::new(rounded(gown.positions()), gown.triangles().to_vec())?;
    obj::write(
        &Path::new(&folder).join("gown.obj"),
        gown.positions(),
        gown.triangles(),
    )?;
    Ok(())
}
