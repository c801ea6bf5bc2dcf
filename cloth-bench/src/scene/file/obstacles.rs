//! `[[obstacle]]`: rigid bodies, and their surfaces for pictures.

use super::document::Section;
use super::keys::{
    ANGULAR_VELOCITY, EXTENT, FILE, LENGTH, POSITION, RADIUS, ROTATE, SHAPE, VELOCITY,
};
use crate::error::BenchError;
use crate::names;
use crate::scene::touching;
use crate::settings::Parameter;
use cloth_collide::obstacle::{
    Capsule, ClosedMesh, Cuboid, HalfSpace, Obstacle, ObstacleError, Pose, RigidMotion, Sphere,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, sphere};
use cloth_core::mesh::{TriMesh, io};
use std::path::Path;

/// Splits of the edges of the icosahedron that stands for a sphere in pictures.
const ROUND: usize = 5;

/// The body that a table describes. `size` (m) is that of the scene, for planes in pictures.
pub(super) fn obstacle(
    section: &Section<'_>,
    folder: &Path,
    size: Real,
) -> Result<(Obstacle, TriMesh), BenchError> {
    let refused = |error: ObstacleError| section.refuse_table(error);
    let motion = motion(section)?;
    let placed = |shape: Result<Obstacle, ObstacleError>| shape.map_err(refused);
    match section.text(&SHAPE)? {
        Some("sphere") => {
            only(section, &[&RADIUS])?;
            let radius = needed(section, &RADIUS, section.positive(&RADIUS)?)?;
            let ball = Sphere::new(radius).map_err(refused)?;
            Ok((
                placed(Obstacle::moving(ball, motion))?,
                drawn(section, sphere(ROUND, radius))?,
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
            ))
        }
        Some("capsule") => {
            only(section, &[&RADIUS, &LENGTH])?;
            let radius = needed(section, &RADIUS, section.positive(&RADIUS)?)?;
            let half = needed(section, &LENGTH, section.number(&LENGTH)?)? / 2.0;
            let body =
                Capsule::new(half, radius).map_err(|error| section.refuse(&LENGTH, error))?;
            let ball = drawn(section, sphere(ROUND, radius))?;
            // Both halves of the ball, moved apart.
            let stretch = |x: &Vec3| x + Vec3::z() * if x.z < 0.0 { -half } else { half };
            let long = ball.positions().iter().map(stretch).collect();
            let surface = TriMesh::new(long, ball.triangles().to_vec());
            Ok((
                placed(Obstacle::moving(body, motion))?,
                drawn(section, surface)?,
            ))
        }
        Some("plane") => {
            only(section, &[])?;
            let plane = HalfSpace::new(Vec3::z()).map_err(refused)?;
            let surface = touching::centred([1, 1], [1.5 * size; 2], Diagonals::OneWay)?;
            Ok((placed(Obstacle::moving(plane, motion))?, surface))
        }
        Some("mesh") => {
            only(section, &[&FILE])?;
            let file = needed(section, &FILE, section.text(&FILE)?)?;
            let surface =
                io::read(&folder.join(file)).map_err(|error| section.refuse(&FILE, error))?;
            let body = ClosedMesh::new(&surface).map_err(|error| section.refuse(&FILE, error))?;
            Ok((placed(Obstacle::moving(body, motion))?, surface))
        }
        Some(other) => {
            let known = ["sphere", "box", "capsule", "plane", "mesh"];
            Err(section.refuse(&SHAPE, names::unknown("shape", other, &known)))
        }
        None => Err(section.refuse_table("needs a shape")),
    }
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
    let unused = [&RADIUS, &EXTENT, &LENGTH, &FILE];
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
