//! `[[obstacle]]`: rigid bodies, and their surfaces for pictures.

use super::document::Section;
use super::keys::{self, Shape, Source};
use super::mesh;
use super::natural_order;
use crate::error::BenchError;
use crate::scene::contact::{Body, splits};
use crate::scene::touching;
use crate::settings::{Choice, Setting};
use cloth_collide::obstacle::{
    AnimatedMesh, Capsule, ClosedMesh, Cuboid, HalfSpace, Obstacle, ObstacleError, Pose, RigidBody,
    RigidMotion, SampledDistance, Shifted, SignedDistance, Sphere, SurfaceOnly,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{self, Diagonals, sphere};
use cloth_core::mesh::{TriMesh, io};
use nalgebra::Matrix3;
use std::path::{Path, PathBuf};

/// The body that a table describes. The size (m) of the scene is for planes in pictures, the thickness (m) of contact
/// says how fine round surfaces are.
pub(super) fn body(
    section: &Section<'_>,
    folder: &Path,
    [size, thickness]: [Real; 2],
    gravity: Vec3,
) -> Result<Body, BenchError> {
    let own = section.read::<keys::Obstacle>()?;
    if *own.shape == Some(Shape::Animation) {
        return animated(section, &own, folder);
    }
    let named = Shape::NAMES
        .iter()
        .find(|(_, shape)| own.shape.as_ref() == Some(shape));
    let kind = named.map_or("body", |(name, _)| *name);
    let mut why_hollow = None;
    let (obstacle, surface, free) = match *own.shape {
        Some(Shape::Mesh) => {
            let (body, why) = of_mesh(section, &own, folder, thickness, gravity)?;
            why_hollow = why;
            body
        }
        _ => rigid(section, &own, [size, thickness], gravity)?,
    };
    Ok(Body::Rigid {
        why_hollow,
        obstacle,
        surface,
        free: free.map(Box::new),
        kind,
        friction: *own.friction,
    })
}

/// A surface whose shapes are the files of a folder.
fn animated(
    section: &Section<'_>,
    own: &keys::Obstacle,
    folder: &Path,
) -> Result<Body, BenchError> {
    only(section, own, &["folder", "interval"])?;
    own.released.refuse_without("a mass or a density")?;
    let moves = [own.velocity.bare(), own.angular_velocity.bare()];
    for key in moves.iter().chain(&weights(own)) {
        key.refuse_given("for this shape: its files say how it moves")?;
    }
    let name = needed(&own.folder)?;
    let wrong = |error: &dyn std::fmt::Display| own.folder.refuse(error);
    let unreadable = |error| wrong(&format!("folder `{name}`: {error}"));
    let entries = std::fs::read_dir(folder.join(name)).map_err(unreadable)?;
    let mut files: Vec<PathBuf> = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| wrong(&error))?.path();
        let is = |kind: &str| {
            path.extension()
                .is_some_and(|end| end.eq_ignore_ascii_case(kind))
        };
        if is("obj") || is("ply") {
            files.push(path);
        }
    }
    natural_order::sort(&mut files).map_err(|error| wrong(&format!("folder `{name}`: {error}")))?;
    let pose = motion(own).pose;
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
        let message = format!("folder `{name}` has no OBJ or PLY file");
        return Err(wrong(&message));
    };
    let interval = own.interval.unwrap_or(1.0 / 60.0);
    let animation = AnimatedMesh::new(shapes, interval).map_err(|error| wrong(&error))?;
    Ok(Body::Animated(mesh, animation, *own.friction))
}

/// A rigid body, its surface in its own frame, and its mass if the cloth can push it.
type Rigid = (Obstacle, TriMesh, Option<RigidBody>);

fn rigid(
    section: &Section<'_>,
    own: &keys::Obstacle,
    [size, thickness]: [Real; 2],
    gravity: Vec3,
) -> Result<Rigid, BenchError> {
    let refused = |error: ObstacleError| section.refuse_table(error);
    let motion = motion(own);
    match *own.shape {
        Some(Shape::Sphere) => {
            only(section, own, &["radius"])?;
            let radius = *needed(&own.radius)?;
            let ball = Sphere::new(radius).map_err(refused)?;
            let surface = drawn(section, sphere(splits(radius, thickness), radius))?;
            let of = |density| RigidBody::sphere(density, radius, gravity);
            around_centre(section, own, ball, surface, motion, of)
        }
        Some(Shape::Box) => {
            only(section, own, &["size"])?;
            let edges = *needed(&own.size)?;
            let half = edges / 2.0;
            let body = Cuboid::new(half).map_err(|error| own.size.refuse(error))?;
            let surface = drawn(section, generate::cuboid(half.into()))?;
            let of = |density| RigidBody::cuboid(density, half, gravity);
            around_centre(section, own, body, surface, motion, of)
        }
        Some(Shape::Capsule) => {
            only(section, own, &["radius", "length"])?;
            let radius = *needed(&own.radius)?;
            let half = *needed(&own.length)? / 2.0;
            let body = Capsule::new(half, radius).map_err(|error| own.length.refuse(error))?;
            let ball = drawn(section, sphere(splits(radius, thickness), radius))?;
            // Both halves of the ball, moved apart.
            let stretch = |x: &Vec3| x + Vec3::z() * if x.z < 0.0 { -half } else { half };
            let long = ball.positions().iter().map(stretch).collect();
            let surface = drawn(section, TriMesh::new(long, ball.triangles().to_vec()))?;
            let of = |density| RigidBody::capsule(density, half, radius, gravity);
            around_centre(section, own, body, surface, motion, of)
        }
        Some(Shape::Plane) => {
            only(section, own, &[])?;
            let plane = HalfSpace::new(Vec3::z()).map_err(refused)?;
            let surface = touching::centred([1, 1], [1.5 * size; 2], Diagonals::OneWay)?;
            if let Some(key) = weights(own).iter().find(|key| key.is_given()) {
                return Err(key.refuse("a plane has no end, and so no mass"));
            }
            let obstacle = Obstacle::moving(plane, motion).map_err(refused)?;
            Ok((obstacle, surface, None))
        }
        Some(Shape::Mesh | Shape::Animation) | None => Err(section.refuse_table("needs a shape")),
    }
}

/// A body of triangles, and why it has no inside, if it has none.
fn of_mesh(
    section: &Section<'_>,
    own: &keys::Obstacle,
    folder: &Path,
    thickness: Real,
    gravity: Vec3,
) -> Result<(Rigid, Option<String>), BenchError> {
    only(section, own, &["file", "generator", "scale", "sampled"])?;
    let placed =
        |shape: Result<Obstacle, ObstacleError>| shape.map_err(|error| section.refuse_table(error));
    let surface = mesh::scaled(section, folder)?;
    let closed = match ClosedMesh::new(&surface) {
        Ok(closed) => closed,
        Err(error) => {
            let why = hollow(section, own, error)?;
            let body = placed(Obstacle::moving(SurfaceOnly, motion(own)))?;
            return Ok(((body, surface, None), Some(why)));
        }
    };
    let mut middle = Vec3::zeros();
    let free = body_of(own, |density| {
        let (body, centre) = RigidBody::of_mesh(density, &surface, gravity)?;
        middle = centre;
        Ok(body)
    })?;
    let centre = free.map(|_| own.centre.unwrap_or(middle));
    let (surface, motion) = about(section, centre, surface, motion(own))?;
    let body = match free {
        Some(_) => ClosedMesh::new(&surface).map_err(|error| section.refuse_table(error))?,
        None => closed,
    };
    let obstacle = match *own.sampled {
        None => Obstacle::moving(body, motion),
        Some(spacing) => {
            let padding = 2.0 * thickness + spacing;
            let grid = SampledDistance::new(&body, spacing, padding)
                .map_err(|error| own.sampled.refuse(error))?;
            Obstacle::moving(grid, motion)
        }
    };
    Ok(((placed(obstacle)?, surface, free), None))
}

/// Why a mesh has no inside, if it can do without.
fn hollow(
    section: &Section<'_>,
    own: &keys::Obstacle,
    error: ObstacleError,
) -> Result<String, BenchError> {
    let given = weights(own).into_iter().chain([own.sampled.bare()]);
    if let Some(key) = given.into_iter().find(Setting::is_given) {
        let message = format!("{} needs an inside, but {error}", key.name());
        return Err(section.refuse_table(message));
    }
    // Not meant like that, rather than without an inside.
    let is_mistake = matches!(
        error,
        ObstacleError::InsideOut { .. } | ObstacleError::NonFinite { .. }
    );
    if is_mistake {
        let source = section.read::<Source>()?;
        let key = match source.file.is_some() {
            true => source.file,
            false => source.generator,
        };
        return Err(key.refuse(error));
    }
    Ok(error.to_string())
}

/// The keys of a body that the cloth pushes.
fn weights(own: &keys::Obstacle) -> [Setting<()>; 4] {
    [
        own.density.bare(),
        own.mass.bare(),
        own.inertia.bare(),
        own.centre.bare(),
    ]
}

/// Mass and inertia, if the cloth pushes the body; `of` gives those of a density (kg/m³) about the centre of mass.
fn body_of(
    own: &keys::Obstacle,
    mut of: impl FnMut(Real) -> Result<RigidBody, ObstacleError>,
) -> Result<Option<RigidBody>, BenchError> {
    let body = match (*own.density, *own.mass) {
        (None, None) => {
            own.inertia.refuse_without("a mass or a density")?;
            own.centre.refuse_without("a mass or a density")?;
            return Ok(None);
        }
        (Some(_), Some(_)) => {
            let message = "a density is given too: give one of them";
            return Err(own.mass.refuse(message));
        }
        (Some(density), None) => of(density).map_err(|error| own.density.refuse(error))?,
        (None, Some(mass)) => {
            let body = of(1.0).and_then(|body| body.with_mass(mass));
            body.map_err(|error| own.mass.refuse(error))?
        }
    };
    let Some(moments) = *own.inertia else {
        return Ok(Some(body));
    };
    if moments.max() > 0.5 * moments.sum() {
        let message =
            "one moment of inertia is more than the other two together, which no body has";
        return Err(own.inertia.refuse(message));
    }
    let body = body.with_inertia(Matrix3::from_diagonal(&moments));
    body.map(Some).map_err(|error| own.inertia.refuse(error))
}

/// A shape whose origin is its middle, and what it weighs.
fn around_centre(
    section: &Section<'_>,
    own: &keys::Obstacle,
    shape: impl SignedDistance + 'static,
    surface: TriMesh,
    motion: RigidMotion,
    of: impl FnMut(Real) -> Result<RigidBody, ObstacleError>,
) -> Result<(Obstacle, TriMesh, Option<RigidBody>), BenchError> {
    let free = body_of(own, of)?;
    let (surface, motion) = about(section, *own.centre, surface, motion)?;
    let obstacle = match *own.centre {
        None => Obstacle::moving(shape, motion),
        Some(centre) => {
            let shift = -centre;
            Obstacle::moving(Shifted { shape, shift }, motion)
        }
    };
    let obstacle = obstacle.map_err(|error| section.refuse_table(error))?;
    Ok((obstacle, surface, free))
}

/// The surface of a body and its motion in a frame whose origin is its centre of mass (m), if it has one.
fn about(
    section: &Section<'_>,
    centre: Option<Vec3>,
    surface: TriMesh,
    motion: RigidMotion,
) -> Result<(TriMesh, RigidMotion), BenchError> {
    let Some(centre) = centre else {
        return Ok((surface, motion));
    };
    let shifted = surface.positions().iter().map(|x| x - centre);
    let shifted = TriMesh::new(shifted.collect(), surface.triangles().to_vec());
    let pose = Pose {
        position: motion.pose.to_world(centre),
        ..motion.pose
    };
    Ok((drawn(section, shifted)?, RigidMotion { pose, ..motion }))
}

fn motion(own: &keys::Obstacle) -> RigidMotion {
    let pose = Pose::at(own.position.unwrap_or_default());
    RigidMotion {
        pose: pose.turned(own.rotate.unwrap_or_default()),
        velocity: own.velocity.unwrap_or_default(),
        angular_velocity: own.angular_velocity.unwrap_or_default(),
    }
}

fn needed<T>(setting: &Setting<Option<T>>) -> Result<&T, BenchError> {
    let message = || format!("this shape needs the key {}", setting.name());
    setting.as_ref().ok_or_else(|| setting.refuse(message()))
}

/// Refuses measures that the shape does not have.
fn only(section: &Section<'_>, own: &keys::Obstacle, used: &[&str]) -> Result<(), BenchError> {
    let source = section.read::<Source>()?;
    let measures = [
        own.radius.bare(),
        own.size.bare(),
        own.length.bare(),
        source.file.bare(),
        source.generator.bare(),
        source.scale.bare(),
        own.folder.bare(),
        own.interval.bare(),
        own.sampled.bare(),
    ];
    let mut unused = measures.iter().filter(|key| !used.contains(&key.name()));
    unused.try_for_each(|key| key.refuse_given("for this shape"))
}

fn drawn(
    section: &Section<'_>,
    surface: Result<TriMesh, cloth_core::mesh::MeshError>,
) -> Result<TriMesh, BenchError> {
    surface.map_err(|error| section.refuse_table(error))
}
