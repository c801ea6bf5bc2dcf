//! How many degrees of freedom rigid edges leave, counted and measured.

use crate::mesh_spec;
use crate::studies::prelude::*;
use cloth_core::dof::{EdgeRank, perturbed};
use cloth_core::mesh::TriMesh;
use cloth_core::topology::{EdgeTable, Topology, bow_tie_vertices, inconsistently_oriented_edges};

pub(super) const PATTERNS: [&str; 5] = [
    "one-way",
    "alternating",
    "crossed",
    "equilateral",
    "irregular",
];

/// Cells a side.
const SIZES: [&[usize]; 2] = [&[4, 8, 16, 32], &[4, 8, 16, 32, 64, 128]];

/// The numbers of `cloth-bench locking`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Locking {
    /// The counts.
    pub topology: Topology,
    /// Vertices where separate fans of triangles touch.
    pub bow_tie_vertices: usize,
    /// Edges across which front and back change places.
    pub inconsistently_oriented_edges: usize,
    /// At rest.
    pub flat: EdgeRank,
    /// After [`perturbed`].
    pub bent: EdgeRank,
}

impl Locking {
    /// Counts and measures a mesh.
    pub fn of(mesh: &TriMesh) -> Result<Self, BenchError> {
        let edges = EdgeTable::build(mesh).map_err(BenchError::usage)?;
        Ok(Self {
            topology: Topology::of(mesh, &edges),
            bow_tie_vertices: bow_tie_vertices(mesh, &edges).len(),
            inconsistently_oriented_edges: inconsistently_oriented_edges(mesh, &edges).len(),
            flat: EdgeRank::measure(mesh.positions(), &edges)?,
            bent: EdgeRank::measure(&perturbed(mesh.positions()), &edges)?,
        })
    }
}

pub(super) fn mesh_of(pattern: &str, cells: usize) -> Result<TriMesh, BenchError> {
    let n = cells + 1;
    mesh_spec::load(&match pattern {
        "equilateral" => format!("equilateral:{n}x{n}"),
        "irregular" => format!("irregular:{n}"),
        grid => format!("grid:{n}x{n}:{grid}"),
    })
}

/// What one mesh has.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Counted {
    vertices: usize,
    edges: usize,
    #[serde(rename = "3V − E")]
    count: i64,
    #[serde(rename = "3χ + E_b")]
    boundary_count: i64,
    nullity_flat: usize,
    nullity_bent: usize,
    #[serde(rename = "self-stresses flat")]
    self_stresses_flat: usize,
    #[serde(rename = "self-stresses bent")]
    self_stresses_bent: usize,
    #[serde(rename = "smallest kept, bent")]
    smallest: Real,
}

impl Counted {
    fn of(pattern: &str, cells: usize) -> Result<Self, BenchError> {
        let Locking {
            topology: t,
            flat,
            bent,
            ..
        } = Locking::of(&mesh_of(pattern, cells)?)?;
        Ok(Self {
            vertices: t.vertices,
            edges: t.edges,
            count: t.count_3v_e,
            boundary_count: 3 * t.euler + t.boundary_edges as i64,
            nullity_flat: flat.nullity,
            nullity_bent: bent.nullity,
            self_stresses_flat: flat.self_stresses,
            self_stresses_bent: bent.self_stresses,
            smallest: bent.smallest_nonzero_singular_value,
        })
    }
}

/// Counts and measures every pattern; whether the count was right everywhere.
pub(super) fn run(study: &mut StudyRun<'_>) -> bool {
    let sizes = study.scope.of(SIZES).iter().copied();
    let rows = study.grid(
        iproduct!(PATTERNS, sizes.clone()),
        |(pattern, cells)| format!("count, {pattern}, {cells} cells"),
        |&(pattern, cells)| Counted::of(pattern, cells),
    );
    let closed_form = |n: usize| {
        let n = n as Real;
        (n, (3.0 + 4.0 * n) / (3.0 * (n + 1.0) * (n + 1.0)))
    };
    let cells = Axis::log("cells a side (dimensionless)");
    let plot = Plot::new(
        "Motions left by rigid edges, as a share of all coordinates",
        cells.clone(),
        Axis::log("nullity of the bent sheet / 3V (dimensionless)"),
    )
    .with(curves(&rows, |((pattern, cells), found)| {
        let share = found.nullity_bent as Real / (3.0 * found.vertices as Real);
        (*pattern, (*cells as Real, share))
    }))
    .exact("(3 + 4n)/3(n + 1)²", sizes.map(closed_form))
    .note("The dashed curve is the closed form for a square grid with one diagonal a cell.");
    study.plot("locking-share", &plot);
    let plot = Plot::new(
        "How firmly the bent sheet is locked",
        cells,
        Axis::log("smallest kept singular value (dimensionless)"),
    )
    .with(curves(&rows, |((pattern, cells), found)| {
        (*pattern, (*cells as Real, found.smallest))
    }))
    .note("Small values are motions that cost next to nothing although no rigid edge allows them.");
    study.plot("locking-smallest", &plot);
    let table = Table::named(&["pattern", "cells"], &rows);
    study.table("locking", "Counted and measured degrees of freedom", table);
    rows.iter().all(|(_, found)| {
        found.nullity_bent as i64 == found.count && found.nullity_flat == found.vertices + 3
    })
}
