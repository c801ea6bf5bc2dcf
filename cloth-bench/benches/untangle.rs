//! The slow way out of contact: pulling apart what is tangled.

use cloth_collide::untangle::{UntangleOutcome, Untangler};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, join};
use criterion::{Criterion, Throughput};
use support::limit;
use support::limit::Moved;

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
            let report = untangler.relax(&mut x, &inverse_mass, most, |_| ());
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
    limit::main(&[untangle]);
}
