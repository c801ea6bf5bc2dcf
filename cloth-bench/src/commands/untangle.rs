//! `cloth-bench untangle MESH`

use super::{check_files, print_pairs, write_file};
use crate::error::BenchError;
use crate::mesh_spec;
use crate::tangle;
use clap::Args;
use cloth_collide::SeparationProbe;
use cloth_collide::potential::PotentialContacts;
use cloth_collide::untangle::{UntangleOutcome, UntangleProgress, Untangler, project_back};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::{obj, ply};
use serde_json::json;
use std::path::{Path, PathBuf};

/// What the numbers mean whose names do not say it.
const NUMBERS: &str = "\
Of the numbers that come out:
  pairs_before, pairs_after  pairs of triangles that have a point in common they should not have
  pairs                      the same after every iteration
  contour_before, _after     length of the curves in which the cloth passes through itself (m)
  farthest                   the most that a vertex was moved (m)
  min_distance               between parts that share no vertex (m); neighbours in the mesh count too";

/// Arguments of `untangle`.
#[derive(Debug, Args)]
#[command(after_help = NUMBERS)]
pub struct Arguments {
    /// An OBJ or PLY file (m), or a generator (see list)
    mesh: String,
    /// OBJ or PLY file for the result, in the order of vertices and triangles of the mesh; positions and triangles only
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Distance (m) to leave between layers; parts of one piece that are nearer in the mesh and do not touch stay as
    /// near as they are
    #[arg(
        long,
        value_name = "M",
        default_value_t = 2e-3,
        allow_negative_numbers = true
    )]
    thickness: Real,
    /// Iterations, at most
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1000,
        allow_negative_numbers = true
    )]
    iterations: u32,
    /// One JSON object instead of lines
    #[arg(long)]
    json: bool,
}

/// The kinds of files that can be written.
#[derive(Clone, Copy)]
enum Kind {
    Obj,
    Ply,
}

impl Kind {
    fn of(path: &Path) -> Result<Self, BenchError> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("obj") => Ok(Self::Obj),
            Some("ply") => Ok(Self::Ply),
            _ => Err(BenchError::Usage(format!(
                "--out is `{}`, but its name has to end in .obj or .ply",
                path.display()
            ))),
        }
    }

    fn format(self, x: &[Vec3], triangles: &[[u32; 3]]) -> Vec<u8> {
        match self {
            Self::Obj => obj::format(x, triangles).into_bytes(),
            Self::Ply => ply::format(x, triangles, ply::Encoding::BinaryLittleEndian),
        }
    }
}

pub(super) fn execute(arguments: &Arguments) -> Result<(), BenchError> {
    let out = arguments.out.as_deref();
    let out = out.map(|path| Ok::<_, BenchError>((path, Kind::of(path)?)));
    let out = out.transpose()?;
    check_files(arguments.out.iter())?;
    let thickness = arguments.thickness;
    if !(thickness > 0.0 && thickness.is_finite()) {
        return Err(BenchError::Usage(format!(
            "--thickness is {thickness} m, but it has to be a positive finite number"
        )));
    }
    let mesh = mesh_spec::load(&arguments.mesh)?;
    let inverse_mass = vec![1.0; mesh.vertex_count()];
    let mut x = mesh.positions().to_vec();
    let mut untangler = Untangler::new(&mesh);
    let mut pairs = Vec::new();
    let after = |at: UntangleProgress| {
        eprintln!(
            "iteration {}: {} pairs, contour {:.4} m",
            at.iterations, at.pairs, at.length
        );
        pairs.push(at.pairs);
    };
    let report = untangler.relax(&mut x, &inverse_mass, arguments.iterations, after)?;
    if report.pairs_before > 0 && report.pairs_after == 0 {
        eprintln!("untangled; back towards the start");
        let contacts = PotentialContacts::builder(&mesh).thickness(thickness);
        let mut contacts = contacts.full_thickness().build()?;
        project_back(&mut contacts, &inverse_mass, mesh.positions(), &mut x)?;
    }
    let separation = SeparationProbe::new(&mesh).measure(&x)?;
    let displacements = x.iter().zip(mesh.positions()).map(|(a, b)| (a - b).norm());
    let outcome = match report.outcome {
        UntangleOutcome::Untangled => "untangled",
        UntangleOutcome::Stalled => "stalled",
        UntangleOutcome::BudgetSpent => "iterations spent",
    };
    let failure = (report.pairs_after > 0).then(|| {
        let ended = match report.outcome {
            UntangleOutcome::BudgetSpent => "not done",
            _ => "stalled",
        };
        let left = tangle::describe(&mesh, &x, untangler.pairs(), |_| None);
        format!("{ended} after {} iterations: {left}", report.iterations)
    });
    let mut told = vec![
        ("mesh", json!(arguments.mesh)),
        ("vertices", json!(mesh.vertex_count())),
        ("triangles", json!(mesh.triangle_count())),
        ("outcome", json!(outcome)),
        ("pairs_before", json!(report.pairs_before)),
        ("pairs_after", json!(separation.intersecting_pairs)),
        ("contour_before", json!(report.length_before)),
        ("contour_after", json!(report.length_after)),
        ("iterations", json!(report.iterations)),
        ("thickness", json!(thickness)),
        ("farthest", json!(displacements.fold(0.0, Real::max))),
        ("min_distance", json!(separation.min_distance)),
        ("out", json!(out.map(|(path, _)| path))),
    ];
    if arguments.json {
        told.push(("pairs", json!(pairs)));
    }
    told.extend(failure.iter().map(|text| ("error", json!(text))));
    if let Some((path, kind)) = out {
        write_file(path, &kind.format(&x, mesh.triangles()))?;
    }
    print_pairs(arguments.json, &told)?;
    failure.map_or(Ok(()), |text| Err(BenchError::Failed(text)))
}
