//! Scenes that are about contact.

use super::contact::{Body, ContactSetup, Surface, splits};
use super::{Grid, Scene, Stack, Twist, Weight, build, cloth};
use crate::bounds::bounds;
use crate::error::BenchError;
use crate::settings::{Settings, Table};
use cloth_collide::obstacle::{Cuboid, HalfSpace, Obstacle, Pose, RigidMotion, Sphere};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::Diagonals;
use cloth_core::mesh::{TriMesh, generate};
use cloth_core::pin::Pins;
use nalgebra::{Rotation3, UnitQuaternion};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

/// Radius of the sphere, and half the edges of the box that cloth is draped on (m).
const RADIUS: Real = 0.3;
const HALF_EDGES: [Real; 3] = [0.25, 0.25, 0.25];
/// How fast the box turns (rad/s).
const SPIN: Real = 2.0;

/// What a sheet falls on.
pub(super) enum Below {
    Sphere,
    TurningBox,
    /// This far below the lowest vertex (m).
    Floor(Real),
}

/// An obstacle below the middle of a mesh, or below all of it, where `up` points against gravity.
pub(super) fn below(
    kind: &Below,
    mesh: &TriMesh,
    up: Vec3,
    settings: &Settings,
) -> Result<Body, BenchError> {
    let [low, high] = bounds(mesh.positions().iter().copied());
    let lowest = low.dot(&up).min(high.dot(&up));
    let middle = (low + high) / 2.0;
    let thickness = Surface::read(settings)?.thickness_of(mesh);
    // Two thicknesses below the lowest vertex.
    let at = |depth: Real| middle + up * (lowest - depth - 2.0 * thickness - middle.dot(&up));
    let turned = UnitQuaternion::rotation_between(&Vec3::z(), &up)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vec3::x_axis(), 2.0 * FRAC_PI_2));
    let still = |position: Vec3| {
        RigidMotion::still(Pose {
            position,
            orientation: turned,
        })
    };
    let (name, obstacle, shape) = match kind {
        Below::Sphere => {
            let sphere = Sphere::new(RADIUS).map_err(BenchError::failed)?;
            let shape =
                generate::sphere(splits(RADIUS, thickness), RADIUS).map_err(BenchError::failed)?;
            ("sphere", Obstacle::moving(sphere, still(at(RADIUS))), shape)
        }
        Below::TurningBox => {
            let cuboid = Cuboid::new(HALF_EDGES.into()).map_err(BenchError::failed)?;
            let motion = RigidMotion {
                angular_velocity: up * SPIN,
                ..still(at(HALF_EDGES[2]))
            };
            (
                "box",
                Obstacle::moving(cuboid, motion),
                generate::cuboid(HALF_EDGES).map_err(BenchError::failed)?,
            )
        }
        Below::Floor(depth) => {
            let size = 1.5 * (high - low).norm();
            let plane = HalfSpace::new(Vec3::z()).map_err(BenchError::failed)?;
            (
                "plane",
                Obstacle::moving(plane, still(at(*depth))),
                centred([1, 1], [size; 2], Diagonals::OneWay)?,
            )
        }
    };
    Ok(Body::Rigid {
        why_hollow: None,
        obstacle: obstacle.map_err(BenchError::usage)?,
        surface: shape,
        free: None,
        kind: name,
        friction: None,
    })
}

fn gravity(settings: &Settings) -> Result<Vec3, BenchError> {
    Ok(Vec3::z() * -*Weight::read(settings)?.gravity)
}

/// A grid around the origin.
pub(super) fn centred(
    cells: [u32; 2],
    size: [Real; 2],
    diagonals: Diagonals,
) -> Result<TriMesh, BenchError> {
    let [columns, rows] = cells.map(|n| n as usize + 1);
    let flat =
        generate::grid(columns, rows, size[0], size[1], diagonals).map_err(BenchError::usage)?;
    let middle = Vec3::new(size[0], size[1], 0.0) / 2.0;
    moved(&flat, |x| x - middle)
}

/// `mesh` in another place.
fn moved(mesh: &TriMesh, place: impl Fn(Vec3) -> Vec3) -> Result<TriMesh, BenchError> {
    let positions = mesh.positions().iter().map(|&x| place(x)).collect();
    TriMesh::new(positions, mesh.triangles().to_vec()).map_err(BenchError::usage)
}

/// A sheet of the scene's own size around the origin, in the pattern that the settings ask for.
fn sheet(settings: &Settings, cells: [u32; 2], size: [Real; 2]) -> Result<TriMesh, BenchError> {
    centred(cells, size, *Grid::read(settings)?.pattern)
}

/// A ribbon of 1 m by ¼ m, upright on the floor, falls down on itself.
pub(super) fn fold(name: &'static str, settings: &Settings) -> Result<Scene, BenchError> {
    /// How far the upright ribbon is bent out of its plane (m), so that it knows where to fall.
    const WAVE: Real = 0.01;
    const HEIGHT: Real = 1.0;
    let n = *Grid::read(settings)?.n - 1;
    let flat = sheet(settings, [n.div_ceil(4), n], [0.25, HEIGHT])?;
    let mesh = moved(&flat, |x| Vec3::new(x.x, 0.0, x.y))?;
    let model = cloth::cut(settings, &mesh)?;
    let floor = below(&Below::Floor(0.0), &mesh, Vec3::z(), settings)?;
    let mut scene = Scene {
        steps: 180,
        touch: Some(ContactSetup::new(settings, &mesh, vec![floor])?),
        ..build::of_mesh(name, &mesh, model, gravity(settings)?)
    };
    for x in &mut scene.start.positions {
        x.y += WAVE * (1.5 * TAU * x.z).sin();
    }
    Ok(scene)
}

/// A narrow towel of 1 m by 0.1 m whose ends are turned against each other by an angle θ, and brought nearer as it
/// becomes a rope.
///
/// A strand that winds around the axis at a radius r, by θ in all, is a helix: as long as the hypotenuse of its axial
/// length and r θ. So that it keeps its length L, the ends come to √(L² − r² θ²) of each other, at a constant rate: for
/// 4 turns at 2.5 cm, 0.63 m around the axis, from 1 m to 0.78 m. On the way there they are nearer than a helix would
/// have them. An edge of the towel that stayed 5 cm away from the axis would have to be 1.48 m long; so it has to roll
/// up, and contact is all that keeps it from the axis.
///
/// The rope is made of few triangles, so a corner of one layer may catch in another, and there the towel is stretched.
/// That is in the shape, not in a method. With 33 vertices along, edges are as long as the radius of the rope.
pub(super) fn twist(name: &'static str, settings: &Settings) -> Result<Scene, BenchError> {
    const SIZES: [Real; 2] = [1.0, 0.1];
    /// How long the turning takes (s).
    const DURATION: Real = 4.0;
    let n = *Grid::read(settings)?.n - 1;
    let mesh = sheet(settings, [n, n.div_ceil(10)], SIZES)?;
    let mut model = cloth::cut(settings, &mesh)?;
    let own = Twist::read(settings)?;
    let (turns, radius) = (*own.turns, *own.rope);
    let wound = (radius * turns * TAU).abs();
    if wound >= SIZES[0] {
        return Err(BenchError::Usage(format!(
            "a towel of {} m cannot be turned {turns} times: around a rope of radius {radius} m alone that is a way of {wound:.2} m",
            SIZES[0]
        )));
    }
    // How much nearer each end comes (m).
    let nearer = 0.5 * (SIZES[0] - (SIZES[0].powi(2) - wound.powi(2)).sqrt());
    let mut pins = Pins::new();
    for (vertex, &x) in mesh.positions().iter().enumerate() {
        if x.x.abs() < SIZES[0] / 2.0 - 1e-9 {
            continue;
        }
        let side = x.x.signum();
        // Half of the turns at each end.
        let path = move |time: Real| {
            let part = (time / DURATION).clamp(0.0, 1.0);
            let turn = Rotation3::from_axis_angle(&Vec3::x_axis(), side * part * turns * TAU / 2.0);
            turn * x - Vec3::x() * (side * part * nearer)
        };
        pins.add_path(&mut model.particles, vertex, path)
            .map_err(BenchError::failed)?;
    }
    Ok(Scene {
        steps: 240,
        pins: Some(Arc::new(pins)),
        touch: Some(ContactSetup::new(settings, &mesh, Vec::new())?),
        ..build::of_mesh(name, &mesh, model, gravity(settings)?)
    })
}

/// Square sheets of ½ m, each turned a little against the one below, on the floor.
pub(super) fn stack(name: &'static str, settings: &Settings) -> Result<Scene, BenchError> {
    const WIDTH: Real = 0.5;
    let n = *Grid::read(settings)?.n - 1;
    let flat = sheet(settings, [n; 2], [WIDTH; 2])?;
    let gap = 1.5 * Surface::read(settings)?.thickness_of(&flat);
    let layer = |k: u32| {
        let turn = Rotation3::from_axis_angle(&Vec3::z_axis(), 0.1 * Real::from(k));
        moved(&flat, |x| turn * x + Vec3::z() * (gap * Real::from(k)))
    };
    let layers: Vec<TriMesh> = (0..*Stack::read(settings)?.sheets)
        .map(layer)
        .collect::<Result<_, _>>()?;
    let mesh = generate::join(&layers).map_err(BenchError::usage)?;
    let model = cloth::cut(settings, &mesh)?;
    let floor = below(&Below::Floor(0.0), &mesh, Vec3::z(), settings)?;
    Ok(Scene {
        steps: 120,
        touch: Some(ContactSetup::new(settings, &mesh, vec![floor])?),
        ..build::of_mesh(name, &mesh, model, gravity(settings)?)
    })
}
