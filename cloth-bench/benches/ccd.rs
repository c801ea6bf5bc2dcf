//! Nanoseconds per continuous collision query: each method on generated queries of exactly known answer. The throughput
//! that criterion prints is queries per second. How often a method is wrong stands in its name, because a fast wrong
//! answer is no answer.

use cloth_bench::ccd::exact_queries::{ExactQueries, Family, Truth};
use cloth_bench::ccd::{METHODS, generate};
use cloth_collide::{Query, QueryKind};
use criterion::{Criterion, Throughput};
use std::hint::black_box;
use support::limit;

const COUNT: usize = 2_000;
const SEED: u64 = 1;
const KINDS: [(&str, QueryKind); 2] = [
    ("vertex-triangle", QueryKind::VertexTriangle),
    ("edge-edge", QueryKind::EdgeEdge),
];

fn run(criterion: &mut Criterion, group: &str, queries: &[(Query, bool)]) {
    let mut group = criterion.benchmark_group(group);
    group.throughput(Throughput::Elements(queries.len() as u64));
    for method in METHODS {
        let found = |query: &Query| method.first_contact(query).expect("finite").is_some();
        let wrong = |truth: bool| {
            queries
                .iter()
                .filter(|(q, t)| *t == truth && found(q) != truth)
                .count()
        };
        let name = format!(
            "{}: {} missed, {} too many",
            method.name,
            wrong(true),
            wrong(false)
        );
        limit::bench(&mut group, name, size_of_val(queries), || {
            queries
                .iter()
                .filter(|(query, _)| found(black_box(query)))
                .count()
        });
    }
}

/// Half contacts, half degenerate: the hard mixture.
fn mixed(criterion: &mut Criterion) {
    for (name, kind) in KINDS {
        let queries: Vec<_> = generate(kind, COUNT, SEED)
            .iter()
            .map(|q| (q.query, q.contact))
            .collect();
        run(
            criterion,
            &format!("ccd, half of them contacts, {name}"),
            &queries,
        );
    }
}

/// Nothing degenerate and no contact: what most of the queries of a simulation are.
fn misses(criterion: &mut Criterion) {
    for (name, kind) in KINDS {
        let apart = ExactQueries::new(kind, SEED)
            .filter(|known| {
                known.family == Family::General && matches!(known.truth, Truth::Apart { .. })
            })
            .map(|known| (known.query, false));
        let queries: Vec<_> = apart.take(COUNT).collect();
        run(criterion, &format!("ccd, no contacts, {name}"), &queries);
    }
}

fn main() {
    limit::main(&[mixed, misses]);
}
