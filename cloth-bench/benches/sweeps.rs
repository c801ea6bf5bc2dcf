//! Gauss–Seidel sweeps over the hanging sheet: time per element, on one thread and on all, beside the loop that one would write first.

use cloth_bench::scene::{self, Scene};
use cloth_bench::settings::Settings;
use cloth_core::element::{Constraint, Element};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::position_based::{Acceleration, Families, RowAt, RowEquation, Rule, Sweep};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rayon::ThreadPoolBuilder;

/// XPBD's rule, with substeps of 1 ms.
#[derive(Debug)]
struct Compliant;

/// λ and α̃.
#[derive(Clone, Copy, Debug, Default)]
struct Multiplier {
    total: Real,
    softness: Real,
}

impl Rule for Compliant {
    type Memory = Multiplier;
    const ROWS_TOGETHER: bool = true;

    fn prepare(&self, row: RowAt, memory: &mut Multiplier) {
        memory.softness = 1e6 / row.stiffness;
    }

    fn equation(&self, row: RowAt, memory: &mut Multiplier) -> RowEquation {
        RowEquation {
            residual: row.value + memory.softness * memory.total,
            softness: memory.softness,
        }
    }

    fn remember(&self, change: Real, memory: &mut Multiplier) {
        memory.total += change;
    }
}

fn sheet(side: u32) -> Scene {
    scene::build("hang", None, &Settings::default().with("n", side)).expect("a scene")
}

/// A sheet that is not at rest, so that no correction is zero.
fn shaken(scene: &Scene) -> Vec<Vec3> {
    let shaken = scene.start.positions.iter().enumerate();
    let noise = |i: usize| Vec3::from_fn(|axis, _| (1e3 * (i + 7 * axis) as Real).sin());
    let size = 0.1 / (scene.start.positions.len() as Real).sqrt();
    shaken.map(|(i, x)| x + noise(i) * size).collect()
}

fn families<const N: usize, E: Constraint<N>>(
    scene: &Scene,
    elements: &[E],
) -> Families<Compliant> {
    let count = scene.start.positions.len();
    let mut families = Families::new(count, Sweep::Colored, Acceleration::default())
        .expect("settings in their ranges");
    families.add(elements).expect("elements of the sheet");
    families
}

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

fn sweeps(criterion: &mut Criterion) {
    for side in [64, 128, 256, 512] {
        let scene = sheet(side);
        let w = scene.model.particles.inverse_mass();
        let mut group = criterion.benchmark_group(format!("sweep, {side} a side"));
        group.sample_size(20);
        group.throughput(Throughput::Elements(scene.model.springs.len() as u64));
        let mut springs = scene.model.springs.clone();
        springs.sort_by_key(|spring| spring.vertices);
        let mut x: Vec<[Real; 3]> = shaken(&scene).iter().map(|&x| x.into()).collect();
        let mut lambda = vec![0.0; springs.len()];
        group.bench_function("springs, in the order of their vertices", |bencher| {
            bencher.iter(|| first_loop(&springs, &mut lambda, w, &mut x));
        });
        for threads in [1, 2] {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.expect("threads");
            let mut visit = |name: &str, mut families: Families<Compliant>, count: usize| {
                let mut x = shaken(&scene);
                families.prepare(&Compliant, w, &x);
                group.throughput(Throughput::Elements(count as u64));
                group.bench_function(format!("{name}, coloured, {threads} threads"), |bencher| {
                    bencher.iter(|| pool.install(|| families.sweep(&Compliant, w, &mut x)));
                });
            };
            let model = &scene.model;
            visit(
                "springs",
                families(&scene, &model.springs),
                model.springs.len(),
            );
            visit(
                "hinges",
                families(&scene, &model.hinges),
                model.hinges.len(),
            );
        }
    }
}

criterion_group!(benches, sweeps);
criterion_main!(benches);
