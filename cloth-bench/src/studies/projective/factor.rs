//! The constant matrix: its fill, what it costs to factorise, to solve with and to change.

use crate::studies::prelude::*;
use cloth_core::element::Projective;
use cloth_core::energy::Spring;
use cloth_core::method::linear::{Cholesky, UpperPattern};
use cloth_core::method::parallel::wide;
use cloth_pd::{LocalStep, PanelFactor, WoodburyUpdate};
use std::collections::BTreeMap;
use std::hint::black_box;
use std::time::Instant;

/// `M/Δt² + Σ w SᵀS` of the springs and hinges of a scene, all vertices free, factorised.
pub fn constant_matrix(scene: &Scene) -> Result<Cholesky, BenchError> {
    let model = &scene.model;
    let masses = model.particles.mass().iter();
    let inertia = |(v, m): (u32, &Real)| BTreeMap::from([(v, m / (scene.dt * scene.dt))]);
    let mut columns: Vec<BTreeMap<u32, Real>> = (0..).zip(masses).map(inertia).collect();
    add(&model.springs, &mut columns);
    add(&model.hinges, &mut columns);
    let mut pattern = UpperPattern {
        column_offsets: vec![0],
        rows: Vec::new(),
    };
    let mut values: Vec<Real> = Vec::new();
    for column in &columns {
        pattern.rows.extend(column.keys());
        values.extend(column.values());
        pattern.column_offsets.push(values.len() as u32);
    }
    let mut cholesky = Cholesky::analyze(pattern)?;
    cholesky.values_mut().copy_from_slice(&values);
    cholesky.factorize()?;
    Ok(cholesky)
}

/// Adds the upper half of `Σ w SᵀS`.
fn add<const N: usize, E: Projective<N, 1>>(elements: &[E], columns: &mut [BTreeMap<u32, Real>]) {
    for element in elements {
        let (vertices, [row]) = (element.vertices(), element.operator());
        for i in 0..N {
            for j in (0..N).filter(|&j| vertices[j] <= vertices[i]) {
                let column = &mut columns[vertices[i] as usize];
                *column.entry(vertices[j]).or_default() += element.weight() * row[i] * row[j];
            }
        }
    }
}

const SIZES: [&[u32]; 2] = [&[17, 33], &[32, 64, 128, 256, 512]];

/// Repetitions, of which the shortest counts.
const REPETITIONS: u32 = 10;
/// Changed rows, at most, that are tried.
const MOST_ROWS: usize = 120;

/// Of the factor of one size: numbers in the lower half of the matrix and in the factor, their ratio, and so on, as the
/// columns say.
type Cost = ([usize; 2], [Real; 7], Option<usize>);
const COST: [&str; 11] = [
    "n",
    "numbers in the lower half of the matrix",
    "numbers in the factor",
    "fill",
    "ms to factorise",
    "ms a solve",
    "ms the library's solve",
    "library's solve / own",
    "GB/s, the factor read twice",
    "times as long as reading it",
    "changed rows as dear as factorising",
];

fn cost(n: u32) -> Result<Cost, BenchError> {
    let scene = scene::build("hang", None, &Settings::default().with("n", n))?;
    let b = &scene.start.positions;
    let mut cholesky = constant_matrix(&scene)?;
    let mut panels = PanelFactor::new(cholesky.factor());
    let (mut solution, mut columns) = (b.clone(), vec![1.0; 3 * b.len()]);
    let numbers = vec![1.0; cholesky.factor_len()];
    let [mut factorise, mut solve, mut library, mut stream] = [Real::INFINITY; 4];
    for _ in 0..REPETITIONS {
        let started = Instant::now();
        cholesky.factorize()?;
        panels.refill(cholesky.factor());
        factorise = factorise.min(started.elapsed().as_secs_f64());
        // The first solve of each finds the other's numbers in the caches.
        for _ in 0..3 {
            solve = solve.min(seconds(|| panels.solve(b, &mut solution)));
        }
        for _ in 0..3 {
            stream = stream.min(seconds(|| read_twice(&numbers)));
        }
        for _ in 0..3 {
            library = library.min(seconds(|| cholesky.solve_in_place(&mut columns)));
        }
    }
    let rows = rows_worth(factorise, &mut panels, b.len());
    let (given, factor) = (cholesky.values_mut().len(), cholesky.factor_len());
    let fill = factor as Real / given as Real;
    let [ms, ms_solve, ms_library] = [factorise, solve, library].map(|seconds| 1e3 * seconds);
    let bandwidth = 16e-9 * factor as Real / solve;
    let over = [library / solve, solve / stream];
    let costs = [fill, ms, ms_solve, ms_library, over[0], bandwidth, over[1]];
    Ok(([given, factor], costs, rows))
}

/// One row per size.
pub(super) fn costs(study: &mut StudyRun<'_>) {
    let sizes = study.scope.of(SIZES).iter().copied();
    let rows = study.grid(sizes, |n| format!("the factor, {n} × {n}"), |&n| cost(n));
    study.table(
        "projective-factor",
        "The constant matrix of the hanging sheet, bending included: fill, and the shortest of thirty times to factorise, to solve for three right-hand sides, and to change it",
        Table::named(&COST, &rows),
    );
}

/// Reads the numbers from first to last and from last to first, as a solve does.
fn read_twice(numbers: &[Real]) {
    let (chunks, _) = numbers.as_chunks::<16>();
    wide(
        #[inline(always)]
        || {
            let mut sums = [0.0; 16];
            for chunk in chunks {
                for lane in 0..16 {
                    sums[lane] += chunk[lane];
                }
            }
            for chunk in chunks.iter().rev() {
                for lane in 0..16 {
                    sums[lane] += chunk[lane];
                }
            }
            black_box(sums);
        },
    );
}

fn seconds(work: impl FnOnce()) -> Real {
    let started = Instant::now();
    work();
    started.elapsed().as_secs_f64()
}

/// Number of springs, ns a spring, bytes, ns a spring to move them, and the ratio of these times.
type Local = (usize, Real, usize, Real, Real);

fn local_step(n: u32) -> Result<Local, BenchError> {
    let scene = scene::build("hang", None, &Settings::default().with("n", n))?;
    let (springs, x) = (&scene.model.springs, &scene.start.positions);
    let local = LocalStep::new(&scene.model.particles, springs.clone());
    let mut local = local.map_err(BenchError::usage)?;
    let mut forces = vec![Vec3::zeros(); x.len()];
    let [mut project, mut moved] = [Real::INFINITY; 2];
    for _ in 0..10 * REPETITIONS {
        project = project.min(seconds(|| {
            black_box(local.add_gradient(x, &mut forces));
        }));
        moved = moved.min(seconds(|| move_bytes(springs, x, &mut forces)));
    }
    let count = springs.len();
    let [own, least] = [project, moved].map(|seconds| 1e9 * seconds / count as Real);
    Ok((count, own, local_bytes(springs, x), least, project / moved))
}

/// The local step of the springs, beside moving the same bytes.
pub(super) fn local_steps(study: &mut StudyRun<'_>) {
    let sizes = study.scope.of(SIZES).iter().copied();
    let rows = study.grid(
        sizes,
        |n| format!("the local step, {n} × {n}"),
        |&n| local_step(n),
    );
    let names = [
        "n",
        "springs",
        "ns a spring",
        "bytes",
        "ns a spring to move them",
        "times as long as moving them",
    ];
    study.table(
        "projective-local",
        "The local step of the springs of the hanging sheet, beside moving the same bytes: a spring and a position are read, a force is read and written; the shortest of a hundred times",
        Table::named(&names, &rows),
    );
}

/// Bytes that the local step of springs has to move: those of a spring, of a position, and of a force that is read and
/// written.
pub fn local_bytes(springs: &[Spring], x: &[Vec3]) -> usize {
    size_of_val(springs) + 3 * size_of_val(x)
}

/// Moves those bytes, and does next to nothing with them.
pub fn move_bytes(springs: &[Spring], x: &[Vec3], forces: &mut [Vec3]) {
    wide(
        #[inline(always)]
        || {
            let mut sums = [[0.0; 2]; 4];
            for four in springs.as_chunks::<4>().0 {
                for (sum, spring) in sums.iter_mut().zip(four) {
                    *sum = [sum[0] + spring.stiffness, sum[1] + spring.rest_length];
                }
            }
            let factor = sums.iter().flatten().sum::<Real>();
            for (force, x) in forces.iter_mut().zip(x) {
                *force += x * factor;
            }
            black_box(&forces);
        },
    );
}

/// The number of changed rows, in threes, for which setting up a correction takes as long as `limit` (s).
fn rows_worth(limit: Real, panels: &mut PanelFactor, count: usize) -> Option<usize> {
    (3..=MOST_ROWS.min(count)).step_by(3).find(|&rank| {
        let mut low_rank = WoodburyUpdate::default();
        for column in 0..rank {
            low_rank.push([((column * 7919 % count) as u32, 1.0)]);
        }
        let mut prepare = || {
            seconds(|| {
                low_rank.prepare(count, |b: &[Vec3], x: &mut [Vec3]| panels.solve(b, x));
            })
        };
        (0..3).map(|_| prepare()).fold(Real::INFINITY, Real::min) >= limit
    })
}
