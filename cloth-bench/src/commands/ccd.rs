//! `cloth-bench ccd FILE… --kind vf|ee`

use super::print_pairs;
use crate::ccd::{self, CcdMethod};
use crate::error::BenchError;
use clap::{Args, ValueEnum};
use cloth_collide::QueryKind;
use serde_json::json;

/// Arguments of `ccd`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Files of labelled queries: eight rows a query, x_num,x_den,y_num,y_den,z_num,z_den,truth
    files: Vec<String>,
    /// What the queries are about: a vertex and a face, or two edges
    #[arg(long)]
    kind: Kind,
    /// The method (see list)
    #[arg(long, default_value = "conservative")]
    method: String,
    /// Makes so many queries with exactly known answers, half of them degenerate, besides those of the files
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        allow_negative_numbers = true
    )]
    generate: usize,
    /// The seed of these
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// One JSON object instead of lines
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Kind {
    Vf,
    Ee,
}

pub(super) fn execute(arguments: &Arguments) -> Result<(), BenchError> {
    let method = CcdMethod::find(&arguments.method)?;
    let (kind, kind_name) = match arguments.kind {
        Kind::Vf => (QueryKind::VertexTriangle, "vf"),
        Kind::Ee => (QueryKind::EdgeEdge, "ee"),
    };
    let mut queries = Vec::new();
    // With each file the number of queries up to its end.
    let mut files = Vec::new();
    for file in &arguments.files {
        queries.extend(ccd::read(file, kind)?);
        files.push((file, queries.len()));
    }
    queries.extend(ccd::generate(kind, arguments.generate, arguments.seed));
    if queries.is_empty() {
        return Err(BenchError::Usage(
            "no queries: name a file, or `--generate` some".to_owned(),
        ));
    }
    let place = |number: usize| {
        let file = files.iter().find(|(_, end)| number < *end);
        match (file, queries[number].line) {
            (Some((file, _)), Some(line)) => format!("{file}: line {line}"),
            _ => format!("generated query {number}"),
        }
    };
    let score = ccd::score(&method, &queries, place)?;
    let mut pairs = vec![("method", json!(method.name)), ("kind", json!(kind_name))];
    pairs.extend(fields!(score => queries, positives, false_positives, false_negatives, late));
    pairs.push(("ns_per_query", json!(score.mean_ns)));
    pairs.extend(fields!(score => mean_ns, median_ns, worst_ns));
    print_pairs(arguments.json, &pairs)?;
    if method.is_conservative && score.false_negatives + score.late > 0 {
        return Err(BenchError::Failed(format!(
            "method `{}` missed {} contacts and was late for {}",
            method.name, score.false_negatives, score.late
        )));
    }
    Ok(())
}
