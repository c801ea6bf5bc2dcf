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
    let mut table = Table::default();
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
                ("queries", Cell::from(name)),
                ("method", Cell::from(method.name)),
                ("number", Cell::from(score.queries)),
                ("false positives", Cell::from(score.false_positives)),
                ("false negatives", Cell::from(score.false_negatives)),
                ("late", Cell::from(score.late)),
                ("median (ns)", Cell::from(score.median_ns)),
                ("mean (ns)", Cell::from(score.mean_ns)),
                ("worst (ns)", Cell::from(score.worst_ns)),
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
