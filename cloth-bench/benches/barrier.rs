//! The slow and safe ways out of contact: a step with the log barrier, and pulling apart what is tangled.

#[path = "support/limit.rs"]
mod limit;

use cloth_collide::barrier::BarrierContacts;
use cloth_collide::untangle::{UntangleOutcome, Untangler};
use cloth_core::contact::{ContactSource, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, join};
use criterion::{Criterion, Throughput};
use limit::Moved;
use std::time::{Duration, Instant};

const DT: Real = 1.0 / 600.0;

/// A sheet of `size` × `size` (m) around the origin, moved.
fn sheet(side: usize, size: Real, place: impl Fn(Vec3) -> Vec3) -> TriMesh {
    let flat = grid(side, side, size, size, Diagonals::Alternating).expect("a sheet");
    let middle = Vec3::new(0.5, 0.5, 0.0) * size;
    let positions = flat.positions().iter().map(|x| place(x - middle)).collect();
    TriMesh::new(positions, flat.triangles().to_vec()).expect("a mesh")
}

/// Bytes of positions and triangles.
fn bytes_of(mesh: &TriMesh) -> usize {
    size_of_val(mesh.positions()) + size_of_val(mesh.triangles())
}

/// A sheet that comes down by 1.5 mm onto another one 1.5 mm below it: everywhere the barrier stops it. One step, and one in which both stay where they are and nothing is near.
fn barrier(criterion: &mut Criterion) {
    for side in [9, 17, 33] {
        let shift = Vec3::new(0.0031, 0.0017, 0.0015);
        let sheets = [sheet(side, 0.3, |x| x), sheet(side, 0.3, |x| x + shift)];
        let mesh = join(&sheets).expect("two sheets");
        let from = mesh.positions().to_vec();
        let count = from.len();
        let mut group = criterion.benchmark_group(format!("barrier, two sheets, {side} a side"));
        group.sample_size(10);
        group.throughput(Throughput::Elements(mesh.triangle_count() as u64));
        let bytes = bytes_of(&mesh) + 2 * size_of_val(&from[..]) + count * size_of::<Real>();
        for (name, way) in [("apart", 0.0), ("pressed", 0.0015)] {
            let mut contacts = BarrierContacts::builder(&mesh).build().expect("settings");
            let inverse_mass = vec![1e4; count];
            let mut resolve = |down: Real| {
                let end = |(v, x): (usize, &Vec3)| match v < count / 2 {
                    true => *x,
                    false => x - Vec3::z() * down,
                };
                let mut positions: Vec<Vec3> = from.iter().enumerate().map(end).collect();
                let ways = positions.iter().zip(&from);
                let mut velocities: Vec<Vec3> = ways.map(|(to, x)| (to - x) / DT).collect();
                let step = ContactStep {
                    from: &from,
                    inverse_mass: &inverse_mass,
                    dt: DT,
                };
                let started = Instant::now();
                let resolved = contacts.resolve(&step, &mut positions, &mut velocities);
                resolved.expect("a way");
                (started.elapsed(), contacts.report())
            };
            limit::timed(&mut group, name, bytes, |repetitions| {
                let mut sum = Duration::ZERO;
                for _ in 0..repetitions {
                    // That the start is safe is found out in a step of its own.
                    resolve(0.0);
                    sum += resolve(way).0;
                }
                sum
            });
            resolve(0.0);
            println!("{:?}", resolve(way).1);
        }
    }
}

/// A hill of the lower sheet goes through the middle of the upper one.
fn tangled(side: usize) -> TriMesh {
    let hill = |x: Vec3| Vec3::z() * 0.12 * (-x.norm_squared() / 0.02).exp();
    let lower = sheet(side, 1.0, |x| x + hill(x));
    let upper = sheet(side, 0.9, |x| x + Vec3::new(0.0131, 0.0072, 0.06));
    join(&[lower, upper]).expect("two sheets")
}

/// The curve in which a cloth passes through itself with its gradient, and the whole way until no triangles meet.
fn untangle(criterion: &mut Criterion) {
    for side in [17, 33, 65] {
        let mesh = tangled(side);
        let start = mesh.positions();
        let inverse_mass = vec![1e4; start.len()];
        let mut untangler = Untangler::new(&mesh);
        let mut group = criterion.benchmark_group(format!("untangle, two sheets, {side} a side"));
        group.sample_size(10);
        group.throughput(Throughput::Elements(mesh.triangle_count() as u64));
        let mut x = start.to_vec();
        let bytes = bytes_of(&mesh) + size_of_val(start);
        limit::bench(&mut group, "contour and gradient", bytes, || {
            untangler.contour_length(start, &mut x)
        });
        let mut relax = |most| {
            x.copy_from_slice(start);
            let report = untangler.relax(&mut x, &inverse_mass, most);
            report.expect("positions that are finite")
        };
        let whole = relax(10_000);
        assert_eq!(whole.outcome, UntangleOutcome::Untangled);
        println!(
            "{} iterations from {} pairs",
            whole.iterations, whole.pairs_before
        );
        let moved = Moved::times(whole.iterations, bytes);
        limit::bench(&mut group, "until no triangles meet", moved, || {
            relax(10_000).iterations
        });
    }
}

fn main() {
    limit::main(&[barrier, untangle]);
}
