//! Gauss–Seidel sweeps over the hanging sheet: time per element, on one thread and on two, beside the loop that one
//! would write first; by size, by order of the vertices, by method and precision.

use cloth_bench::method::Method;
use cloth_bench::settings::Settings;
use cloth_core::element::{Constraint, Element};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid, irregular};
use cloth_core::method::ordering::Order;
use cloth_core::random::SplitMix64;
use cloth_core::step::StepInput;
use cloth_core::topology::EdgeTable;
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput};
use rayon::ThreadPoolBuilder;
use support::limit;
use support::limit::Moved;
use support::sheet::{Compliant, coloured, shaken, sheet, sweep_bytes};

/// Springs in the order of their vertices over arrays of three numbers: the loop of a first program.
fn first_loop(springs: &[Spring], lambda: &mut [Real], w: &[Real], x: &mut [[Real; 3]]) {
    for (spring, lambda) in springs.iter().zip(lambda) {
        let [i, j] = spring.vertices().map(|v| v as usize);
        let (a, b) = (x[i], x[j]);
        let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let softness = 1e6 / spring.stiffness;
        let change = -(length - spring.rest_length + softness * *lambda) / (w[i] + w[j] + softness);
        *lambda += change;
        for axis in 0..3 {
            let step = d[axis] / length * change;
            x[i][axis] += w[i] * step;
            x[j][axis] -= w[j] * step;
        }
    }
}

/// Rows of one family in coloured sweeps, on some number of threads.
fn visit<const N: usize, E: Constraint<N>>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    threads: usize,
    (w, elements, start): (&[Real], &[E], &[Vec3]),
) {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.expect("threads");
    let mut families = coloured(w.len(), elements);
    let mut x = start.to_vec();
    families.prepare(&Compliant, w, &x);
    group.throughput(Throughput::Elements(elements.len() as u64));
    let bytes = sweep_bytes(elements, w);
    let name = format!("{name}, {threads} threads");
    limit::bench_in(&pool, group, name, bytes, || {
        families.sweep(&Compliant, w, &mut x);
    });
}

/// Springs and hinges of grids from 1,000 to 1,000,000 vertices, beside the loop that one would write first.
fn grids(criterion: &mut Criterion) {
    for side in [32, 64, 90, 128, 181, 256, 512, 1000] {
        let scene = sheet(side);
        let model = &scene.model;
        let w = model.particles.inverse_mass();
        let mut group = criterion.benchmark_group(format!("sweep, {side} a side"));
        group.sample_size(20);
        let mut springs = model.springs.clone();
        springs.sort_by_key(|spring| spring.vertices);
        let start = shaken(&scene.start.positions);
        let mut x: Vec<[Real; 3]> = start.iter().map(|&x| x.into()).collect();
        let mut lambda = vec![0.0; springs.len()];
        group.throughput(Throughput::Elements(springs.len() as u64));
        let numbers = size_of_val(&springs[..]) + 2 * size_of_val(&lambda[..]);
        let bytes = numbers + 2 * size_of_val(&x[..]) + size_of_val(w);
        let name = "springs, in the order of their vertices";
        limit::bench(&mut group, name, bytes, || {
            first_loop(&springs, &mut lambda, w, &mut x);
        });
        for threads in [1, 2] {
            visit(&mut group, "springs", threads, (w, &model.springs, &start));
            visit(&mut group, "hinges", threads, (w, &model.hinges, &start));
        }
    }
}

/// Meshes as a file might have them, their vertices shuffled: as they are, and sorted again as `cloth-bench` does it
/// with files.
fn files(criterion: &mut Criterion) {
    let grid = |side| grid(side, side, 1.0, 1.0, Diagonals::Alternating);
    for (name, mesh) in [
        ("grid of 64 a side", grid(64)),
        ("grid of 256 a side", grid(256)),
        ("grid of 1000 a side", grid(1000)),
        ("irregular sheet of 256 a side", irregular(256, 1.0, 1.0, 1)),
    ] {
        let mesh = mesh.expect("a mesh");
        let edges = EdgeTable::build(&mesh).expect("edges");
        let springs = Spring::along(mesh.positions(), edges.ends(), 1e4);
        let start = shaken(mesh.positions());
        let count = start.len();
        let w = vec![5.0 * count as Real; count];
        let mut shuffled: Vec<u32> = (0..count as u32).collect();
        let mut random = SplitMix64::new(1);
        for i in (1..count).rev() {
            shuffled.swap(i, (random.next_bits() % (i as u64 + 1)) as usize);
        }
        let mut moved = vec![Vec3::zeros(); count];
        for (&place, x) in shuffled.iter().zip(&start) {
            moved[place as usize] = *x;
        }
        let numbered = |number: &dyn Fn(u32) -> u32| {
            let springs = springs.iter().map(|spring| Spring {
                vertices: spring.vertices.map(number),
                ..*spring
            });
            let mut springs: Vec<Spring> = springs.collect();
            springs.sort_by_key(|spring| spring.vertices);
            springs
        };
        let mut group = criterion.benchmark_group(format!("sweep, {name}"));
        group.sample_size(20);
        visit(&mut group, "as generated", 1, (&w, &springs, &start));
        let as_it_is = numbered(&|v| shuffled[v as usize]);
        visit(&mut group, "shuffled", 1, (&w, &as_it_is, &moved));
        let sorted = Order::morton(&moved);
        let again = numbered(&|v| sorted.renumber([shuffled[v as usize]])[0]);
        let x = sorted.apply(&moved);
        visit(&mut group, "sorted again", 1, (&w, &again, &x));
    }
}

/// Steps of 100 sweeps over springs alone: what a rule and its precision cost.
fn methods(criterion: &mut Criterion) {
    const SWEEPS: u32 = 100;
    for side in [64, 128, 256] {
        let mut scene = sheet(side);
        scene.model.hinges.clear();
        scene.model.others.clear();
        let mut group = criterion.benchmark_group(format!("100 sweeps, {side} a side"));
        group.sample_size(10);
        let springs = scene.model.springs.len() as u64;
        group.throughput(Throughput::Elements(springs * u64::from(SWEEPS)));
        let pool = ThreadPoolBuilder::new().num_threads(1).build();
        let pool = pool.expect("threads");
        for (name, settings) in [
            ("pbd", Settings::default()),
            ("xpbd", Settings::default().with("substeps", 1)),
            (
                "xpbd",
                Settings::default()
                    .with("substeps", 1)
                    .with("precision", "single"),
            ),
        ] {
            let settings = settings.with("iterations", SWEEPS);
            let method = Method::find(name).expect("a method");
            let mut solver = method
                .build(&scene, &settings, 1.0 / 60.0)
                .expect("a solver");
            let mut state = scene.start.clone();
            let name = format!("{name} {}", settings.get("precision").unwrap_or("double"));
            let w = scene.model.particles.inverse_mass();
            let moved = Moved::times(SWEEPS, sweep_bytes(&scene.model.springs, w));
            limit::bench_in(&pool, &mut group, name, moved, || {
                let input = StepInput::new(1.0 / 60.0).gravity(Vec3::new(0.0, 0.0, -9.81));
                solver.step(&mut state, input)
            });
        }
    }
}

fn main() {
    limit::main(&[grids, files, methods]);
}
