//! Broad phases on a crumpled sheet of 32k triangles: an accordion of sixteen layers, 4 mm apart, with noise.
//!
//! What each number holds: `build` a first call, memory included; `refit` the tree following its boxes; `query` the
//! tree's search alone; `again` a later call, which for the tree is refit and query, for the cells filling and query;
//! `candidates` all from positions to sorted vertex–triangle and edge–edge pairs.

use cloth_bench::crumpled::{BROAD_PHASES, accordion, boxes};
use cloth_collide::{ClothCandidates, Hierarchy};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use criterion::Criterion;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use std::hint::black_box;
use support::limit;

/// How near (m) pieces have to come to be of interest.
const MARGIN: Real = 0.002;

/// The distance of the layers (m).
const GAP: Real = 0.004;

fn crumpled(side: usize) -> (TriMesh, Vec<Vec3>) {
    accordion(side, GAP).expect("a sheet")
}

fn pairs_of_triangles(criterion: &mut Criterion) {
    let (mesh, positions) = crumpled(128);
    let boxes = boxes(&mesh, &positions, MARGIN);
    let bytes = size_of_val(&boxes[..]);
    let mut group = criterion.benchmark_group("pairs of triangles, 32k crumpled");
    group.sample_size(20);
    let mut out = Vec::new();
    for (name, new) in BROAD_PHASES {
        limit::bench(&mut group, format!("{name}: build"), bytes, || {
            let mut fresh = new();
            fresh.overlapping(black_box(&boxes), &mut out);
            fresh
        });
        let mut warm = new();
        limit::bench(&mut group, format!("{name}: again"), bytes, || {
            warm.overlapping(black_box(&boxes), &mut out)
        });
    }
    let mut tree = Hierarchy::over(&boxes);
    limit::bench(&mut group, "hierarchy: refit", bytes, || {
        tree.refit(black_box(&boxes).iter().copied())
    });
    limit::bench(&mut group, "hierarchy: query", bytes, || {
        out.clear();
        tree.visit_overlapping(|a, b| out.push([a, b]));
    });
    group.finish();
}

fn vector(v: Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

/// The library's tree as it comes, over the same boxes.
fn parry(criterion: &mut Criterion) {
    let (mesh, positions) = crumpled(128);
    let leaves: Vec<Aabb> = boxes(&mesh, &positions, MARGIN)
        .iter()
        .map(|b| Aabb::new(vector(b.lower), vector(b.upper)))
        .collect();
    let bytes = size_of_val(&leaves[..]);
    let mut group = criterion.benchmark_group("parry's own tree, 32k crumpled");
    group.sample_size(20);
    let strategies = [
        ("binned", BvhBuildStrategy::Binned),
        ("ploc", BvhBuildStrategy::Ploc),
    ];
    for (name, strategy) in strategies {
        limit::bench(&mut group, format!("{name}: build"), bytes, || {
            Bvh::from_leaves(strategy, black_box(&leaves))
        });
        let mut tree = Bvh::from_leaves(strategy, &leaves);
        let mut workspace = BvhWorkspace::default();
        limit::bench(&mut group, format!("{name}: refit"), bytes, || {
            for (number, leaf) in (0..).zip(black_box(&leaves)) {
                tree.insert_or_update_partially(*leaf, number, 0.0);
            }
            tree.refit(&mut workspace);
        });
        let mut pairs = Vec::new();
        limit::bench(&mut group, format!("{name}: query"), bytes, || {
            pairs.clear();
            let mut visit = |a: u32, b: u32| pairs.push([a, b]);
            tree.traverse_bvtt_single_tree::<false>(&mut workspace, &mut visit);
            pairs.len()
        });
    }
    group.finish();
}

fn candidates(criterion: &mut Criterion) {
    for side in [32, 128, 320] {
        let (mesh, positions) = crumpled(side);
        let count = mesh.triangle_count();
        let bytes = size_of_val(mesh.triangles()) + size_of_val(&positions[..]);
        let mut group = criterion.benchmark_group(format!("candidates, {count} triangles"));
        group.sample_size(20);
        for (name, new) in BROAD_PHASES {
            let mut candidates = ClothCandidates::new(&mesh, new());
            limit::bench(&mut group, name, bytes, || {
                let updated = candidates.update(black_box(&positions), &positions, MARGIN);
                updated.expect("finite positions");
                candidates.edge_edge().len()
            });
        }
        group.finish();
    }
}

fn main() {
    limit::main(&[pairs_of_triangles, parry, candidates]);
}
