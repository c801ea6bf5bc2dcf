//! Methods of continuous collision detection on generated queries of exactly known answer.

use super::super::{Findings, Scope};
use crate::ccd::{METHODS, generate, score};
use crate::studies::prelude::*;
use cloth_collide::QueryKind;

const KINDS: [(&str, QueryKind); 2] = [
    ("vertex–triangle", QueryKind::VertexTriangle),
    ("edge–edge", QueryKind::EdgeEdge),
];

/// Adds the table; returns how many contacts the methods that promise to miss none have missed or found too late, and
/// how many queries they had.
pub(super) fn run(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<[usize; 2], BenchError> {
    let count = scope.pick(300, 10_000);
    let mut table = Table::new(&[
        "queries",
        "method",
        "number",
        "false positives",
        "false negatives",
        "late",
        "median (ns)",
        "mean (ns)",
        "worst (ns)",
    ]);
    let (mut broken, mut asked) = (0, 0);
    for (name, kind) in KINDS {
        let queries = generate(kind, count, 1);
        for method in METHODS {
            progress(&format!("collision: {name} queries, {}", method.name));
            let score = score(&method, &queries, |number| format!("query {number}"))?;
            if method.promises {
                broken += score.false_negatives + score.late;
                asked += score.queries;
            }
            table.push([
                Cell::from(name),
                Cell::from(method.name),
                Cell::from(score.queries),
                Cell::from(score.false_positives),
                Cell::from(score.false_negatives),
                Cell::from(score.late),
                Cell::from(score.median_ns),
                Cell::from(score.mean_ns),
                Cell::from(score.worst_ns),
            ]);
        }
    }
    findings.table(
        "collision-queries",
        "Continuous queries: half of them contacts, half of them degenerate, all of exactly known answer",
        table,
    );
    Ok([broken, asked])
}
