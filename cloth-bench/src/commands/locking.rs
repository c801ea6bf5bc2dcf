//! `cloth-bench locking MESH`

use super::print_pairs;
use crate::error::BenchError;
use crate::mesh_spec;
use crate::studies::Locking;
use clap::Args;
use cloth_core::dof::RANK_THRESHOLD;
use serde_json::json;

/// Arguments of `locking`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// An OBJ file, or a generator: grid:NxM:alternating, disk:N, tube:NxM, torus:NxM, sphere:N, … (see list), or
    /// several joined by +
    mesh: String,
    /// One JSON object instead of lines
    #[arg(long)]
    json: bool,
}

pub(super) fn execute(arguments: &Arguments) -> Result<(), BenchError> {
    let found = Locking::of(&mesh_spec::load(&arguments.mesh)?)?;
    let t = found.topology;
    print_pairs(
        arguments.json,
        &[
            ("mesh", json!(arguments.mesh)),
            ("vertices", json!(t.vertices)),
            ("edges", json!(t.edges)),
            ("faces", json!(t.faces)),
            ("boundary_edges", json!(t.boundary_edges)),
            ("boundary_loops", json!(t.boundary_loops)),
            ("components", json!(t.components)),
            ("euler", json!(t.euler)),
            ("count_3v_e", json!(t.count_3v_e)),
            (
                "count_3euler_boundary",
                json!(3 * t.euler + t.boundary_edges as i64),
            ),
            ("rank_threshold", json!(RANK_THRESHOLD)),
            ("rank_flat", json!(found.flat.rank)),
            ("nullity_flat", json!(found.flat.nullity)),
            ("self_stresses_flat", json!(found.flat.self_stresses)),
            (
                "smallest_nonzero_singular_value_flat",
                json!(found.flat.smallest_nonzero_singular_value),
            ),
            ("rank_bent", json!(found.bent.rank)),
            ("nullity_bent", json!(found.bent.nullity)),
            ("self_stresses_bent", json!(found.bent.self_stresses)),
            (
                "smallest_nonzero_singular_value_bent",
                json!(found.bent.smallest_nonzero_singular_value),
            ),
        ],
    )
}
