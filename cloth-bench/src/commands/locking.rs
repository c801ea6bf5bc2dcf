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
    let mut pairs = vec![("mesh", json!(arguments.mesh))];
    pairs.extend(fields!(t => vertices, edges, faces, boundary_edges, boundary_loops, components));
    pairs.extend(fields!(found => bow_tie_vertices, inconsistently_oriented_edges));
    pairs.extend(fields!(t => euler, count_3v_e));
    let boundary = 3 * t.euler + t.boundary_edges as i64;
    pairs.push(("count_3euler_boundary", json!(boundary)));
    pairs.push(("rank_threshold", json!(RANK_THRESHOLD)));
    let flat = ["rank_flat", "nullity_flat", "self_stresses_flat"];
    let bent = ["rank_bent", "nullity_bent", "self_stresses_bent"];
    let smallest = [
        "smallest_nonzero_singular_value_flat",
        "smallest_nonzero_singular_value_bent",
    ];
    for (names, last, rank) in [
        (flat, smallest[0], found.flat),
        (bent, smallest[1], found.bent),
    ] {
        let counts = [rank.rank, rank.nullity, rank.self_stresses];
        pairs.extend(names.into_iter().zip(counts.map(|count| json!(count))));
        pairs.push((last, json!(rank.smallest_nonzero_singular_value)));
    }
    print_pairs(arguments.json, &pairs)
}
