//! What happens once, before the first step: tables, colours, orders, files, symbolic factorisation, the rank of the
//! edges.

use cloth_core::dof::EdgeRank;
use cloth_core::energy::{CurvatureHinge, Spring};
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid, irregular};
use cloth_core::mesh::{TriMesh, obj, ply};
use cloth_core::method::coloring::Colored;
use cloth_core::method::family::Energies;
use cloth_core::method::linear::BlockCholesky;
use cloth_core::method::ordering::Order;
use cloth_core::particles::Particles;
use cloth_core::topology::{EdgeTable, HingeTable, Topology};
use cloth_pbd::{Hierarchy, HierarchyConfig};
use criterion::{Criterion, Throughput};
use support::limit;

const SIDES: [usize; 3] = [32, 128, 256];

/// A sheet, and the bytes of its mesh.
fn sheet(side: usize) -> (TriMesh, usize) {
    let mesh = grid(side, side, 1.0, 1.0, Diagonals::Alternating).expect("a sheet");
    let bytes = size_of_val(mesh.positions()) + size_of_val(mesh.triangles());
    (mesh, bytes)
}

fn tables(criterion: &mut Criterion) {
    for side in SIDES {
        let (mesh, bytes) = sheet(side);
        let edges = EdgeTable::build(&mesh).expect("edges");
        let hinges = HingeTable::build(&mesh, &edges);
        let of_edges = size_of_val(edges.ends()) + size_of_val(edges.sides());
        let of_hinges = size_of_val(hinges.hinges());
        let mut group = criterion.benchmark_group(format!("tables, {side} a side"));
        group.throughput(Throughput::Elements(mesh.triangle_count() as u64));
        limit::bench(&mut group, "regular mesh", bytes, || sheet(side));
        limit::bench(&mut group, "irregular mesh", bytes, || {
            irregular(side, 1.0, 1.0, 1)
        });
        limit::bench(&mut group, "edges", bytes + of_edges, || {
            EdgeTable::build(&mesh)
        });
        limit::bench(&mut group, "hinges", bytes + of_edges + of_hinges, || {
            HingeTable::build(&mesh, &edges)
        });
        limit::bench(&mut group, "counts", bytes + of_edges, || {
            Topology::of(&mesh, &edges)
        });
    }
}

fn orders(criterion: &mut Criterion) {
    for side in SIDES {
        let (mesh, bytes) = sheet(side);
        let edges = EdgeTable::build(&mesh).expect("edges");
        let hinges = HingeTable::build(&mesh, &edges);
        let springs = Spring::along(mesh.positions(), edges.ends(), 1e4);
        let bending = CurvatureHinge::across(&mesh, &hinges, 1e-5);
        let (count, positions) = (mesh.vertex_count(), mesh.positions());
        let numbers = 2 * size_of::<u32>() * count;
        let mut group = criterion.benchmark_group(format!("orders, {side} a side"));
        group.throughput(Throughput::Elements(count as u64));
        let moved = size_of_val(positions) + numbers;
        limit::bench(&mut group, "Morton", moved, || Order::morton(positions));
        let moved = size_of_val(edges.ends()) + numbers;
        limit::bench(&mut group, "reverse Cuthill-McKee", moved, || {
            Order::reverse_cuthill_mckee(count, &edges)
        });
        let order = Order::morton(positions);
        limit::bench(&mut group, "renumber the mesh", 2 * bytes + numbers, || {
            order.reorder_mesh(&mesh)
        });
        let moved = 2 * size_of_val(&springs[..]);
        limit::bench(&mut group, "colour springs", moved, || {
            Colored::new(&springs, count)
        });
        let moved = 2 * size_of_val(&bending[..]);
        limit::bench(&mut group, "colour hinges", moved, || {
            Colored::new(&bending, count)
        });
        let mut energies = Energies::new(count).with(springs).expect("springs");
        energies = energies.with(bending).expect("hinges");
        let pattern = energies.assembly().pattern().clone();
        let of_pattern = size_of_val(pattern.columns());
        limit::bench(&mut group, "pattern of the Hessian", of_pattern, || {
            energies.assembly()
        });
        let free = vec![true; count];
        limit::bench(&mut group, "analyse the factor", of_pattern, || {
            BlockCholesky::analyze(&pattern, &free)
        });
        if side < 256 {
            let particles = Particles::new(vec![1.0; count]).expect("masses");
            limit::bench(&mut group, "coarse levels", bytes, || {
                Hierarchy::build(&mesh, &particles, HierarchyConfig::default())
            });
        }
    }
}

fn files(criterion: &mut Criterion) {
    for side in SIDES {
        let (mesh, bytes) = sheet(side);
        let (positions, triangles) = (mesh.positions(), mesh.triangles());
        let text = obj::format(positions, triangles);
        let ascii = ply::format(positions, triangles, ply::Encoding::Ascii);
        let binary = ply::format(positions, triangles, ply::Encoding::BinaryLittleEndian);
        let mut group = criterion.benchmark_group(format!("files, {side} a side"));
        group.throughput(Throughput::Elements(positions.len() as u64));
        limit::bench(&mut group, "read OBJ", text.len() + bytes, || {
            obj::parse(&text)
        });
        limit::bench(&mut group, "read PLY, text", ascii.len() + bytes, || {
            ply::parse(&ascii)
        });
        limit::bench(&mut group, "read PLY, binary", binary.len() + bytes, || {
            ply::parse(&binary)
        });
        limit::bench(&mut group, "write OBJ", text.len() + bytes, || {
            obj::format(positions, triangles)
        });
        limit::bench(
            &mut group,
            "write PLY, binary",
            binary.len() + bytes,
            || ply::format(positions, triangles, ply::Encoding::BinaryLittleEndian),
        );
    }
}

/// Rank of the edge Jacobian, flat and bent. Its factorisation grows faster than the sheet, so the sizes are smaller.
fn ranks(criterion: &mut Criterion) {
    for side in [9, 17, 33] {
        let (mesh, bytes) = sheet(side);
        let edges = EdgeTable::build(&mesh).expect("edges");
        let flat = mesh.positions().to_vec();
        let bent: Vec<Vec3> = cloth_core::dof::perturbed(&flat);
        let mut group = criterion.benchmark_group(format!("rank of the edges, {side} a side"));
        group.sample_size(10);
        for (name, x) in [("flat", &flat), ("bent", &bent)] {
            limit::bench(&mut group, name, bytes, || EdgeRank::measure(x, &edges));
        }
    }
}

fn main() {
    limit::main(&[tables, orders, files, ranks]);
}
