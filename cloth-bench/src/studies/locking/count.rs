//! How many degrees of freedom rigid edges leave, counted and measured.

use crate::mesh_spec;
use crate::studies::prelude::*;
use cloth_core::dof::{EdgeRank, bent};
use cloth_core::mesh::TriMesh;
use cloth_core::topology::{EdgeTable, Topology};

pub(super) const PATTERNS: [&str; 5] = [
    "one-way",
    "alternating",
    "crossed",
    "equilateral",
    "irregular",
];

/// Cells a side.
fn sizes(scope: Scope) -> &'static [usize] {
    scope.pick(&[4, 8, 16, 32], &[4, 8, 16, 32, 64, 128])
}

/// The numbers of `cloth-bench locking`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Locking {
    /// The counts.
    pub topology: Topology,
    /// At rest.
    pub flat: EdgeRank,
    /// After [`bent`].
    pub bent: EdgeRank,
}

impl Locking {
    /// Counts and measures a mesh.
    ///
    /// # Errors
    /// [`BenchError::Usage`] if an edge is not manifold, [`BenchError::Failed`] if the rank cannot be measured.
    pub fn of(mesh: &TriMesh) -> Result<Self, BenchError> {
        let edges = EdgeTable::build(mesh).map_err(BenchError::usage)?;
        Ok(Self {
            topology: Topology::of(mesh, &edges),
            flat: EdgeRank::measure(mesh.positions(), &edges)?,
            bent: EdgeRank::measure(&bent(mesh.positions()), &edges)?,
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
    /// 3V − E, and 3χ + E_b.
    counts: [i64; 2],
    /// Flat, and bent.
    nullity: [usize; 2],
    self_stresses: [usize; 2],
    /// Of the bent one.
    smallest_nonzero_singular_value: Real,
}

impl Counted {
    fn of(pattern: &str, cells: usize) -> Result<Self, BenchError> {
        let Locking {
            topology: t,
            flat,
            bent,
        } = Locking::of(&mesh_of(pattern, cells)?)?;
        Ok(Self {
            vertices: t.vertices,
            edges: t.edges,
            counts: [t.count_3v_e, 3 * t.euler + t.boundary_edges as i64],
            nullity: [flat, bent].map(|rank| rank.nullity),
            self_stresses: [flat, bent].map(|rank| rank.self_stresses),
            smallest_nonzero_singular_value: bent.smallest_nonzero_singular_value,
        })
    }
}

/// Counts and measures every pattern; whether the count was right everywhere.
pub(super) fn run(study: &mut StudyRun<'_>) -> Result<bool, BenchError> {
    let scope = study.scope;
    let mut table = Table::new(&[
        "pattern",
        "cells",
        "vertices",
        "edges",
        "3V − E",
        "3χ + E_b",
        "nullity flat",
        "nullity bent",
        "self-stresses flat",
        "self-stresses bent",
        "smallest kept, bent",
    ]);
    let mut share = Vec::new();
    let mut smallest = Vec::new();
    let mut as_counted = true;
    for pattern in PATTERNS {
        let mut shares = Vec::new();
        let mut kept = Vec::new();
        for &cells in sizes(scope) {
            let case = format!("count, {pattern}, {cells} cells");
            let Some(found) = study.case(&case, || Counted::of(pattern, cells)) else {
                continue;
            };
            let coordinates = 3.0 * found.vertices as Real;
            let [flat, bent] = found.nullity;
            as_counted &= bent as i64 == found.counts[0] && flat == found.vertices + 3;
            shares.push((cells as Real, bent as Real / coordinates));
            kept.push((cells as Real, found.smallest_nonzero_singular_value));
            table.push([
                Cell::from(pattern),
                Cell::from(cells),
                Cell::from(found.vertices),
                Cell::from(found.edges),
                Cell::from(found.counts[0]),
                Cell::from(found.counts[1]),
                Cell::from(flat),
                Cell::from(bent),
                Cell::from(found.self_stresses[0]),
                Cell::from(found.self_stresses[1]),
                Cell::from(found.smallest_nonzero_singular_value),
            ]);
        }
        share.push(Series::new(pattern, shares));
        smallest.push(Series::new(pattern, kept));
    }
    let closed_form = |&n: &usize| {
        let n = n as Real;
        (n, (3.0 + 4.0 * n) / (3.0 * (n + 1.0) * (n + 1.0)))
    };
    let curve = sizes(scope).iter().map(closed_form).collect();
    share.push(Series::new("(3 + 4n)/3(n + 1)²", curve).styled(Style::ExactCurve));
    study.findings.plot(
        "locking-share",
        &Plot {
            title: "Motions left by rigid edges, as a share of all coordinates".into(),
            x: Axis::log("cells a side (dimensionless)"),
            y: Axis::log("nullity of the bent sheet / 3V (dimensionless)"),
            series: share,
            note: "The dashed curve is the closed form for a square grid with one diagonal a cell."
                .into(),
        },
    );
    study.findings.plot("locking-smallest", &Plot {
        title: "How firmly the bent sheet is locked".into(),
        x: Axis::log("cells a side (dimensionless)"),
        y: Axis::log("smallest kept singular value (dimensionless)"),
        series: smallest,
        note: "Small values are motions that cost next to nothing although no rigid edge allows them.".into(),
    });
    study
        .findings
        .table("locking", "Counted and measured degrees of freedom", table);
    Ok(as_counted)
}
