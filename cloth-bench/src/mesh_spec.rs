//! A mesh by name: a file, or a generator such as `grid:33x33:alternating`.

mod tangled;

use crate::bounds::bounds;
use crate::error::BenchError;
use crate::names;
use crate::settings::{Choice, Value};
use cloth_core::error::within;
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{self, Diagonals};
use cloth_core::mesh::{MeshError, TetMesh, TriMesh, io};
use std::path::Path;

/// The generators and how they are written, for `list`.
pub const GENERATORS: [(&str, &str); 12] = [
    (
        "grid:NxM:PATTERN",
        "N × M vertices, 1 m wide and (M − 1)/(N − 1) m high; PATTERN is one-way, alternating or crossed",
    ),
    (
        "equilateral:NxM",
        "N × M vertices on a lattice of equilateral triangles, 1 m wide",
    ),
    (
        "irregular:N",
        "about N × N vertices, jittered, Delaunay, 1 m × 1 m",
    ),
    ("disk:N", "N rings, radius 0.5 m"),
    (
        "tube:NxM",
        "N vertices around, M cells along, radius 0.25 m, 1 m long",
    ),
    (
        "torus:NxM",
        "N vertices around, M across, radii 0.5 m and 0.2 m",
    ),
    (
        "sphere:N",
        "an icosahedron with edges split in N, radius 0.5 m",
    ),
    (
        "moebius:NxM",
        "a Möbius band, N vertices around, M cells across, radius 0.5 m",
    ),
    (
        "holes:N:K",
        "N × N cells, alternating diagonals, 1 m × 1 m, with K × K square holes; A+B sets any two of these side by side",
    ),
    (
        "tangled:GARMENT",
        "one that passes through itself: layers, sleeve, lining, pocket, seams, rolled, or dress:NxM of any size",
    ),
    (
        "block:NxMxK",
        "a solid of N × M × K cubes of tetrahedra, 1 m wide, in scene files with [mesh.solid]",
    ),
    (
        "ball:N",
        "a solid of N shells of tetrahedra, radius 0.5 m, in scene files with [mesh.solid]",
    ),
];

impl Choice for Diagonals {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("one-way", Self::OneWay),
        ("alternating", Self::Alternating),
        ("crossed", Self::Crossed),
    ];
}

/// Names of the generators.
fn kinds() -> Vec<&'static str> {
    GENERATORS
        .iter()
        .map(|(form, _)| form.split(':').next().unwrap_or(form))
        .collect()
}

/// Whether `spec` names a file: what has no colon, or exists and is no generator.
pub fn is_file(spec: &str) -> bool {
    match spec.split_once(':') {
        None => !kinds().contains(&spec),
        Some((kind, _)) => !kinds().contains(&kind) && Path::new(spec).exists(),
    }
}

/// Whether `spec` is of a generator of solids.
pub fn is_solid(spec: &str) -> bool {
    matches!(spec.split(':').next(), Some("block" | "ball"))
}

/// Builds the solid that `spec` names.
pub fn solid(spec: &str) -> Result<TetMesh, BenchError> {
    let (kind, size) = spec.split_once(':').unwrap_or((spec, ""));
    let numbers: Option<Vec<usize>> = size.split('x').map(|n| n.parse().ok()).collect();
    let solid = match (kind, numbers.as_deref()) {
        ("block", Some(&[n, m, k])) => {
            let cells = [n, m, k];
            let edge = 1.0 / n.max(1) as f64;
            let size = Vec3::from(cells.map(|count| count.max(1) as f64 * edge));
            generate::block(cells, size)
        }
        ("ball", Some(&[n])) => generate::ball(n, 0.5),
        _ => {
            let message = format!("`{spec}` is no solid: those are block:NxMxK and ball:N");
            return Err(BenchError::Usage(message));
        }
    };
    solid.map_err(|error| BenchError::Usage(format!("`{spec}`: {error}")))
}

/// Builds or reads the mesh that `spec` names.
pub fn load(spec: &str) -> Result<TriMesh, BenchError> {
    if is_file(spec) {
        return io::read(Path::new(spec)).map_err(BenchError::usage);
    }
    if spec.contains('+') {
        return side_by_side(spec);
    }
    if is_solid(spec) {
        return Err(BenchError::Usage(format!(
            "`{spec}` is a solid, for a [[mesh]] with [mesh.solid] in a scene file"
        )));
    }
    let mut parts = spec.split(':');
    let kind = parts.next().unwrap_or_default();
    let arguments: Vec<&str> = parts.collect();
    let known = kinds();
    if !known.contains(&kind) {
        return Err(BenchError::Usage(names::unknown(
            "mesh generator",
            kind,
            &known,
        )));
    }
    let form = GENERATORS[known.iter().position(|k| *k == kind).unwrap_or(0)].0;
    let wrong = || BenchError::Usage(format!("`{spec}` is not of the form {form}"));
    let one = || -> Result<usize, BenchError> {
        match arguments[..] {
            [n] => n.parse().map_err(|_| wrong()),
            _ => Err(wrong()),
        }
    };
    let two = |text: &str| -> Result<[usize; 2], BenchError> {
        let (n, m) = text.split_once('x').ok_or_else(wrong)?;
        Ok([
            n.parse().map_err(|_| wrong())?,
            m.parse().map_err(|_| wrong())?,
        ])
    };
    let only_two = || match arguments[..] {
        [size] => two(size),
        _ => Err(wrong()),
    };
    let mesh = match kind {
        "grid" => {
            let [size, pattern] = arguments[..] else {
                return Err(wrong());
            };
            let [n, m] = two(size)?;
            let diagonals = Diagonals::NAMES.iter().find(|(name, _)| *name == pattern);
            let diagonals = diagonals.ok_or_else(|| {
                let known = <Diagonals as Value>::names();
                BenchError::Usage(names::unknown("diagonal pattern", pattern, &known))
            })?;
            let height = m.saturating_sub(1) as f64 / n.saturating_sub(1).max(1) as f64;
            generate::grid(n, m, 1.0, height, diagonals.1)
        }
        "equilateral" => {
            let [n, m] = only_two()?;
            generate::equilateral(n, m, 1.0 / n.saturating_sub(1).max(1) as f64)
        }
        "irregular" => generate::irregular(one()?, 1.0, 1.0, 1),
        "disk" => generate::disk(one()?, 0.5),
        "tube" => {
            let [n, m] = only_two()?;
            generate::tube(n, m, 0.25, 1.0)
        }
        "torus" => {
            let [n, m] = only_two()?;
            generate::torus(n, m, 0.5, 0.2)
        }
        "sphere" => generate::sphere(one()?, 0.5),
        "tangled" => match arguments[..] {
            ["dress", size] => {
                let [n, m] = two(size)?;
                tangled::dress(n, m)
            }
            [name] => match name {
                "layers" => tangled::layers(0.01, 2e-3),
                "sleeve" => tangled::sleeve(0.03),
                "lining" => tangled::lining(0.2),
                "pocket" => tangled::pocket(0.0),
                "seams" => tangled::seams(),
                "rolled" => tangled::rolled(),
                _ => return Err(wrong()),
            },
            _ => return Err(wrong()),
        },
        "holes" => match arguments[..] {
            [cells, holes] => with_holes(
                cells.parse().map_err(|_| wrong())?,
                holes.parse().map_err(|_| wrong())?,
            ),
            _ => return Err(wrong()),
        },
        _ => {
            let [n, m] = only_two()?;
            generate::moebius(n, m, 0.5, 0.3)
        }
    };
    mesh.map_err(|error| BenchError::Usage(format!("`{spec}`: {error}")))
}

/// A square sheet of `cells` × `cells` cells with `holes` × `holes` square holes, at least a cell apart and a cell from
/// the rim.
fn with_holes(cells: usize, holes: usize) -> Result<TriMesh, MeshError> {
    let bands = holes.saturating_mul(2).saturating_add(1);
    let range = "at least 2 K + 1 for K holes a side";
    within(cells >= bands, "the number of cells", cells as f64, range)?;
    let sheet = generate::grid(
        cells.saturating_add(1),
        cells.saturating_add(1),
        1.0,
        1.0,
        Diagonals::Alternating,
    )?;
    // Cells lie in 2K + 1 bands, of which every second one is cut.
    let is_cut = |x: f64| ((x * cells as f64) as usize * bands / cells) % 2 == 1;
    generate::without_triangles(&sheet, |_, corners| {
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        is_cut(middle.x) && is_cut(middle.y)
    })
}

/// Several generated meshes along the x axis, 0.1 m apart.
fn side_by_side(spec: &str) -> Result<TriMesh, BenchError> {
    let mut next = 0.0;
    let pieces = spec.split('+').map(|piece| {
        let mesh = load(piece)?;
        let [low, high] = bounds(mesh.positions().iter().copied()).map(|corner| corner.x);
        let shift = Vec3::x() * (next - low);
        next += high - low + 0.1;
        let positions = mesh.positions().iter().map(|p| p + shift).collect();
        mesh.moved(positions).map_err(BenchError::usage)
    });
    generate::join(&pieces.collect::<Result<Vec<_>, _>>()?).map_err(BenchError::usage)
}
