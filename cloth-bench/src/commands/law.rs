//! `cloth-bench law NAME`

use super::print_pairs;
use crate::error::BenchError;
use crate::laws::Law;
use crate::settings::Settings;
use clap::Args;
use serde_json::json;

/// Arguments of `law`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The law (see list)
    name: String,
    /// Sets a parameter
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// One JSON object instead of lines
    #[arg(long)]
    json: bool,
}

pub(super) fn execute(arguments: &Arguments) -> Result<(), BenchError> {
    let law = Law::find(&arguments.name)?;
    let evaluation = law.evaluate(&Settings::parse(&arguments.settings)?)?;
    let mut pairs = vec![
        ("law", json!(law.name)),
        ("expected", json!(evaluation.expected)),
        ("measured", json!(evaluation.measured)),
        ("error", json!(evaluation.error())),
        ("tolerance", json!(law.tolerance.max(evaluation.rounding))),
    ];
    let details = evaluation.details.iter();
    pairs.extend(details.map(|&(name, value)| (name, json!(value))));
    print_pairs(arguments.json, &pairs)?;
    if law.holds(&evaluation) {
        return Ok(());
    }
    Err(BenchError::Failed(format!(
        "law `{}` does not hold: the error {:e} is above {:e}",
        law.name,
        evaluation.error(),
        law.tolerance.max(evaluation.rounding)
    )))
}
