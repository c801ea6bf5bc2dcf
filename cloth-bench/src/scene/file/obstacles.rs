//! `[[obstacle]]`: rigid bodies, and their surfaces for pictures.

use super::document::Section;
use super::keys::{
    ANGULAR_VELOCITY, BODY_DENSITY, EXTENT, FILE, FOLDER, GENERATOR, INTERVAL, LENGTH, POSITION,
    RADIUS, ROTATE, SAMPLED, SCALE, SHAPE, VELOCITY,
};
use super::mesh;
use crate::error::BenchError;
use crate::names;
use crate::scene::contact::{Body, splits};
use crate::scene::touching;
use crate::settings::Parameter;
use cloth_collide::obstacle::{
    AnimatedMesh, Capsule, ClosedMesh, Cuboid, HalfSpace, Obstacle, ObstacleError, Pose, RigidBody,
    RigidMotion, SampledDistance, Sphere,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, sphere};
use cloth_core::mesh::{TriMesh, io};
use std::path::{Path, PathBuf};

/// The body that a table describes. The size (m) of the scene is for planes in pictures, the thickness (m) of contact
/// says how fine round surfaces are.
pub(super) fn body(
    section: &Section<'_>,
    folder: &Path,
    [size, thickness]: [Real; 2],
    gravity: Vec3,
) -> Result<Body, BenchError> {
    if section.text(&SHAPE)? == Some("animation") {
        return animated(section, folder);
    }
    let (obstacle, surface, free) = rigid(section, folder, [size, thickness], gravity)?;
    Ok(Body::Rigid {
        obstacle,
        surface,
        free: free.map(Box::new),
        is_flat: section.text(&SHAPE)? == Some("plane"),
    })
}

/// A surface whose shapes are the files of a folder.
fn animated(section: &Section<'_>, folder: &Path) -> Result<Body, BenchError> {
    only(section, &[&FOLDER, &INTERVAL])?;
    if let Some(key) = [&VELOCITY, &ANGULAR_VELOCITY, &BODY_DENSITY]
        .into_iter()
        .find(|key| section.value(key).is_some())
    {
        let message = format!(
            "{} has no meaning for this shape: its files say how it moves",
            key.name
        );
        return Err(section.refuse(key, message));
    }
    let name = needed(section, &FOLDER, section.text(&FOLDER)?)?;
    let wrong = |error: &dyn std::fmt::Display| section.refuse(&FOLDER, error.to_string());
    let entries = std::fs::read_dir(folder.join(name)).map_err(|error| wrong(&error))?;
    let mut files: Vec<PathBuf> = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| wrong(&error))?.path();
        let kind = path.extension().and_then(|kind| kind.to_str());
        if matches!(kind, Some("obj" | "ply")) {
            files.push(path);
        }
    }
    files.sort();
    let pose = motion(section)?.pose;
    let mut first: Option<TriMesh> = None;
    let mut shapes = Vec::new();
    for file in &files {
        let mesh = io::read(file).map_err(|error| wrong(&error))?;
        let shape = mesh.positions().iter().map(|&x| pose.to_world(x));
        shapes.push(shape.collect());
        let first = first.get_or_insert_with(|| mesh.clone());
        if first.triangles() != mesh.triangles() {
            let shown = file.display();
            return Err(wrong(&format!(
                "{shown} has other triangles than the first file"
            )));
        }
    }
    let Some(mesh) = first else {
        return Err(wrong(&"has no OBJ or PLY file"));
    };
    let interval = section.positive(&INTERVAL)?.unwrap_or(1.0 / 60.0);
    let animation = AnimatedMesh::new(shapes, interval).map_err(|error| wrong(&error))?;
    Ok(Body::Animated(mesh, animation))
}

fn rigid(
    section: &Section<'_>,
    folder: &Path,
    [size, thickness]: [Real; 2],
    gravity: Vec3,
) -> Result<(Obstacle, TriMesh, Option<RigidBody>), BenchError> {
    let refused = |error: ObstacleError| section.refuse_table(error);
    let density = section.positive(&BODY_DENSITY)?;
    let free = |body: Option<Result<RigidBody, ObstacleError>>| {
        body.transpose()
            .map_err(|error| section.refuse(&BODY_DENSITY, error))
    };
    let motion = motion(section)?;
    let placed = |shape: Result<Obstacle, ObstacleError>| shape.map_err(refused);
    match section.text(&SHAPE)? {
        Some("sphere") => {
            only(section, &[&RADIUS])?;
            let radius = needed(section, &RADIUS, section.positive(&RADIUS)?)?;
            let ball = Sphere::new(radius).map_err(refused)?;
            Ok((
                placed(Obstacle::moving(ball, motion))?,
                drawn(section, sphere(splits(radius, thickness), radius))?,
                free(density.map(|density| RigidBody::sphere(density, radius, gravity)))?,
            ))
        }
        Some("box") => {
            only(section, &[&EXTENT])?;
            let edges = needed(section, &EXTENT, section.vector(&EXTENT)?)?;
            let half = edges / 2.0;
            let body = Cuboid::new(half).map_err(|error| section.refuse(&EXTENT, error))?;
            Ok((
                placed(Obstacle::moving(body, motion))?,
                touching::block(half.into())?,
                free(density.map(|density| RigidBody::cuboid(density, half, gravity)))?,
            ))
        }
        Some("capsule") => {
            only(section, &[&RADIUS, &LENGTH])?;
            let radius = needed(section, &RADIUS, section.positive(&RADIUS)?)?;
            let half = needed(section, &LENGTH, section.number(&LENGTH)?)? / 2.0;
            let body =
                Capsule::new(half, radius).map_err(|error| section.refuse(&LENGTH, error))?;
            let ball = drawn(section, sphere(splits(radius, thickness), radius))?;
            // Both halves of the ball, moved apart.
            let stretch = |x: &Vec3| x + Vec3::z() * if x.z < 0.0 { -half } else { half };
            let long = ball.positions().iter().map(stretch).collect();
            let surface = TriMesh::new(long, ball.triangles().to_vec());
            Ok((
                placed(Obstacle::moving(body, motion))?,
                drawn(section, surface)?,
                free(density.map(|density| RigidBody::capsule(density, half, radius, gravity)))?,
            ))
        }
        Some("plane") => {
            only(section, &[])?;
            let plane = HalfSpace::new(Vec3::z()).map_err(refused)?;
            let surface = touching::centred([1, 1], [1.5 * size; 2], Diagonals::OneWay)?;
            if density.is_some() {
                let message = "a plane has no end, and so no mass";
                return Err(section.refuse(&BODY_DENSITY, message));
            }
            Ok((placed(Obstacle::moving(plane, motion))?, surface, None))
        }
        Some("mesh") => {
            only(section, &[&FILE, &GENERATOR, &SCALE, &SAMPLED])?;
            let (surface, motion, body_of) = centred(section, folder, motion, density, gravity)?;
            let body = ClosedMesh::new(&surface).map_err(|error| match section.value(&FILE) {
                Some(_) => section.refuse(&FILE, error),
                None => section.refuse(&GENERATOR, error),
            })?;
            let obstacle = match section.positive(&SAMPLED)? {
                None => Obstacle::moving(body, motion),
                Some(spacing) => {
                    let padding = 2.0 * thickness + spacing;
                    let grid = SampledDistance::new(&body, spacing, padding)
                        .map_err(|error| section.refuse(&SAMPLED, error))?;
                    Obstacle::moving(grid, motion)
                }
            };
            Ok((placed(obstacle)?, surface, body_of))
        }
        Some(other) => {
            let known = ["sphere", "box", "capsule", "plane", "mesh", "animation"];
            Err(section.refuse(&SHAPE, names::unknown("shape", other, &known)))
        }
        None => Err(section.refuse_table("needs a shape")),
    }
}

/// The mesh of a body, and its motion. If it has a density, its frame has its origin in the centre of mass.
fn centred(
    section: &Section<'_>,
    folder: &Path,
    motion: RigidMotion,
    density: Option<Real>,
    gravity: Vec3,
) -> Result<(TriMesh, RigidMotion, Option<RigidBody>), BenchError> {
    let surface = mesh::scaled(section, folder)?;
    let Some(density) = density else {
        return Ok((surface, motion, None));
    };
    let (body, centre) = RigidBody::of_mesh(density, &surface, gravity)
        .map_err(|error| section.refuse(&BODY_DENSITY, error))?;
    let shifted = surface.positions().iter().map(|x| x - centre);
    let shifted = TriMesh::new(shifted.collect(), surface.triangles().to_vec());
    let pose = Pose {
        position: motion.pose.to_world(centre),
        ..motion.pose
    };
    Ok((
        drawn(section, shifted)?,
        RigidMotion { pose, ..motion },
        Some(body),
    ))
}

fn motion(section: &Section<'_>) -> Result<RigidMotion, BenchError> {
    let pose = Pose::at(section.vector(&POSITION)?.unwrap_or_default());
    Ok(RigidMotion {
        pose: pose.turned(section.vector(&ROTATE)?.unwrap_or_default()),
        velocity: section.vector(&VELOCITY)?.unwrap_or_default(),
        angular_velocity: section.vector(&ANGULAR_VELOCITY)?.unwrap_or_default(),
    })
}

fn needed<T>(section: &Section<'_>, key: &Parameter, value: Option<T>) -> Result<T, BenchError> {
    value.ok_or_else(|| section.refuse_table(format!("this shape needs the key {}", key.name)))
}

/// Refuses measures that the shape does not have.
fn only(section: &Section<'_>, used: &[&Parameter]) -> Result<(), BenchError> {
    let unused = [
        &RADIUS, &EXTENT, &LENGTH, &FILE, &GENERATOR, &SCALE, &FOLDER, &INTERVAL, &SAMPLED,
    ];
    let mut unused = unused.into_iter().filter(|key| !used.contains(key));
    match unused.find(|key| section.value(key).is_some()) {
        None => Ok(()),
        Some(key) => {
            let message = format!("{} has no meaning for this shape", key.name);
            Err(section.refuse(key, message))
        }
    }
}

fn drawn(
    section: &Section<'_>,
    surface: Result<TriMesh, cloth_core::mesh::MeshError>,
) -> Result<TriMesh, BenchError> {
    surface.map_err(|error| section.refuse_table(error))
}
