//! From a name and settings to a [`Scene`].

use super::cloth::{self, Stiffness};
use super::contact::ContactSetup;
use super::midpoints::{self, Midpoints, Points};
use super::touching::{self, Below};
use super::{Axis, Chain, Floor, Grid, Placed, SCENES, Scene, SceneInfo, Strip, Weight, pins};
use crate::bounds::bounds;
use crate::error::BenchError;
use crate::mesh_spec;
use crate::names;
use crate::settings::{Settings, Table};
use cloth_core::cloth::{ClothModel, Piece};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate;
use cloth_core::method::ordering::Order;
use cloth_core::particles::Particles;

impl SceneInfo {
    /// The scene of that name.
    pub fn find(name: &str) -> Result<&'static Self, BenchError> {
        names::find("scene", name, SCENES.iter(), |scene| scene.name)
    }
}

/// Builds the scene `name`. `mesh` replaces the sheet of `hang` and `drop` (a file, or a generator).
///
/// # Errors
/// [`BenchError::Usage`] for an unknown scene, a mesh that does not serve, a key that the scene does not know, or a
/// value out of range.
pub fn build(name: &str, mesh: Option<&str>, settings: &Settings) -> Result<Scene, BenchError> {
    let info = SceneInfo::find(name)?;
    settings.check(&format!("scene `{name}`"), &info.groups())?;
    let settings = &settings.with_defaults(info.defaults());
    match (info.name, mesh) {
        ("chain", None) => chain(settings),
        ("cantilever", None) => cantilever(settings),
        ("fold", None) => touching::fold(info.name, settings),
        ("twist", None) => touching::twist(info.name, settings),
        ("stack", None) => touching::stack(info.name, settings),
        (name @ ("chain" | "cantilever" | "fold" | "twist" | "stack"), Some(_)) => {
            Err(BenchError::Usage(format!(
                "scene `{name}` takes no --mesh; `hang`, `drop` and the drapes do"
            )))
        }
        (name, mesh) => sheet(name, mesh, settings),
    }
}

/// `hang` and `drop`.
fn sheet(name: &'static str, mesh: Option<&str>, settings: &Settings) -> Result<Scene, BenchError> {
    let from_file = mesh.is_some_and(mesh_spec::is_file);
    let (grid, placed) = (Grid::read(settings)?, Placed::read(settings)?);
    let (mesh, order) = match mesh {
        Some(spec) => {
            let mut own = [grid.n.bare(), grid.pattern.bare()].into_iter();
            if let Some(key) = own.find(|key| key.is_given()) {
                return Err(key.refuse(format!(
                    "{} shapes the scene's own sheet, which --mesh replaces: give one of them",
                    key.name()
                )));
            }
            let mesh = mesh_spec::load(spec)?;
            // Files come in any vertex order; neighbours in space become neighbours in memory.
            let order = from_file.then(|| Order::morton(mesh.positions()));
            (mesh, order)
        }
        None => {
            let n = *grid.n as usize;
            let mesh = generate::grid(n, n, 1.0, 1.0, *grid.pattern);
            (mesh.map_err(BenchError::usage)?, None)
        }
    };
    let up = match *placed.up {
        Axis::X => Vec3::x(),
        Axis::Default if from_file => Vec3::y(),
        Axis::Y => Vec3::y(),
        Axis::Default | Axis::Z => Vec3::z(),
    };
    let held = match (placed.pins.as_str(), name) {
        ("default", "drop" | "drape-sphere" | "drape-box") => "none",
        ("default", _) if from_file => "highest",
        ("default", _) => "corners",
        (text, _) => text,
    };
    let mut held = pins::chosen(held, mesh.positions(), up)?;
    let gravity = up * -*Weight::read(settings)?.gravity;
    if name == "hang" && *Midpoints::read(settings)?.points == Points::Midpoints {
        let (small, model) = midpoints::cut(settings, &mesh, &held)?;
        let touch = ContactSetup::new(settings, &mesh, Vec::new())?;
        if !touch.is_idle() {
            return Err(BenchError::Usage(
                "self=yes cannot be with points=midpoints: there are gaps between the small triangles, which contact would go through".into(),
            ));
        }
        return Ok(of_mesh(name, &small, model, gravity));
    }
    let mesh = match &order {
        Some(order) => {
            for vertex in &mut held {
                *vertex = order.new_of_old()[*vertex] as usize;
            }
            order.reorder_mesh(&mesh)
        }
        None => mesh,
    };
    let mut model = cloth::cut(settings, &mesh)?;
    let piece = Piece {
        cloth: cloth::described(settings)?,
        discretization: cloth::discretization(settings)?,
        triangles: (0..mesh.triangles().len() as u32).collect(),
    };
    hold(&held, &mut model)?;
    let below = match name {
        "drape-sphere" => Some(Below::Sphere),
        "drape-box" => Some(Below::TurningBox),
        "drop" => Floor::read(settings)?.floor.map(Below::Floor),
        _ => None,
    };
    let obstacles = below
        .as_ref()
        .map(|kind| touching::below(kind, &mesh, up, settings));
    let scene = of_mesh(name, &mesh, model, gravity);
    let obstacles = obstacles.transpose()?.into_iter().collect();
    let touch = ContactSetup::new(settings, &mesh, obstacles)?;
    Ok(Scene {
        order,
        hints: cloth::hints(&piece, &mesh),
        touch: Some(touch),
        steps: if name.starts_with("drape") {
            120
        } else {
            scene.steps
        },
        ..scene
    })
}

fn hold(vertices: &[usize], model: &mut ClothModel) -> Result<(), BenchError> {
    vertices
        .iter()
        .try_for_each(|&vertex| model.particles.prescribe(vertex).map_err(BenchError::usage))
}

pub(super) fn of_mesh(
    name: &'static str,
    mesh: &TriMesh,
    model: ClothModel,
    gravity: Vec3,
) -> Scene {
    let positions = mesh.positions().to_vec();
    Scene::new(name, model, positions, Some(mesh.clone()), gravity)
}

pub(super) fn chain(settings: &Settings) -> Result<Scene, BenchError> {
    let own = Chain::read(settings)?;
    let (n, link) = (*own.n as usize, *own.link);
    if !(n as Real * link).is_finite() {
        return Err(own
            .link
            .refuse(format!("{n} links of {link} m are longer than any number")));
    }
    let mut mass = vec![*own.mass; n + 1];
    mass[n] = *own.tip_mass;
    let mut particles = Particles::new(mass).map_err(|error| settings.blame([], error))?;
    particles.prescribe(0).map_err(BenchError::usage)?;
    let positions: Vec<Vec3> = (0..=n)
        .map(|i| Vec3::new(i as Real * link, 0.0, 0.0))
        .collect();
    let ends: Vec<[u32; 2]> = (0..n as u32).map(|i| [i, i + 1]).collect();
    let stiffness = Stiffness::read(settings)?.stiffness.number();
    let model = ClothModel {
        springs: Spring::along(&positions, &ends, stiffness),
        hinges: Vec::new(),
        others: Vec::new(),
        particles,
    };
    let gravity = Vec3::z() * -*Weight::read(settings)?.gravity;
    Ok(Scene::new("chain", model, positions, None, gravity))
}

fn cantilever(settings: &Settings) -> Result<Scene, BenchError> {
    const WIDTH: Real = 0.2;
    let own = Strip::read(settings)?;
    let (across, length) = (*own.n as usize, *own.length);
    let along = ((length / WIDTH * across as Real).round() as usize).max(2);
    let mesh = generate::grid(along + 1, across + 1, length, WIDTH, *own.pattern)
        .map_err(BenchError::usage)?;
    let mut model = cloth::cut(settings, &mesh)?;
    // Two columns of vertices are held: position and direction of the clamped end.
    let [low, _] = bounds(mesh.positions().iter().copied());
    let clamp = low.x + 1.5 * length / along as Real;
    let held: Vec<usize> = (0..mesh.vertex_count())
        .filter(|&v| mesh.positions()[v].x < clamp)
        .collect();
    hold(&held, &mut model)?;
    Ok(of_mesh(
        "cantilever",
        &mesh,
        model,
        Vec3::z() * -*Weight::read(settings)?.gravity,
    ))
}
