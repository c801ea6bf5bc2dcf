//! Methods of continuous collision detection on generated queries of exactly known answer.

use crate::ccd::{METHODS, generate, score};
use crate::studies::prelude::*;
use cloth_collide::QueryKind;

const KINDS: [(&str, QueryKind); 2] = [
    ("vertex–triangle", QueryKind::VertexTriangle),
    ("edge–edge", QueryKind::EdgeEdge),
];

/// Adds the table; says how many contacts the conservative methods have missed or found too late.
pub(super) fn run(study: &mut StudyRun<'_>) -> String {
    let count = study.scope.pick(300, 10_000);
    let found = study.grid(
        iproduct!(KINDS, &METHODS),
        |((name, _), method)| format!("{name} queries, {}", method.name),
        |((_, kind), method)| {
            let queries = generate(*kind, count, 1);
            score(method, &queries, |number| format!("query {number}"))
        },
    );
    let (mut broken, mut asked) = (0, 0);
    for (_, score) in found
        .iter()
        .filter(|((_, method), _)| method.is_conservative)
    {
        broken += score.false_negatives + score.late;
        asked += score.queries;
    }
    let rows = found
        .into_iter()
        .map(|(((name, _), method), score)| (name, method.name, score));
    study.table(
        "collision-queries",
        "Continuous queries: half of them contacts, half of them degenerate, all of exactly known answer",
        Table::named(&["queries", "method"], &rows.collect_vec()),
    );
    let missed = match broken {
        0 => "none and were never late".to_owned(),
        _ => format!("{broken} or were late for them"),
    };
    format!("Of {asked} queries the conservative methods missed {missed}.")
}
