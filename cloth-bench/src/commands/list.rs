//! `cloth-bench list`

use super::print;
use crate::ccd;
use crate::error::BenchError;
use crate::laws::LAWS;
use crate::mesh_spec::GENERATORS;
use crate::method;
use crate::scene::{SCENES, file};
use crate::settings::Parameter;
use crate::studies::STUDIES;
use clap::Args;
use serde_json::{Value, json};

/// Arguments of `list`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// The keys of scene files, which are not given with `--set`.
const SCENE_FILES: &str = "scene-files";

/// Something that can be named, whatever its kind.
struct Entry {
    name: &'static str,
    about: &'static str,
    parameters: Vec<&'static Parameter>,
}

fn entries() -> [(&'static str, Vec<Entry>); 7] {
    let entry = |name, about, tables: &[&'static [Parameter]]| Entry {
        name,
        about,
        parameters: tables.iter().copied().flatten().collect(),
    };
    [
        (
            "scenes",
            SCENES
                .iter()
                .map(|s| entry(s.name, s.about, s.groups()))
                .collect(),
        ),
        (
            SCENE_FILES,
            file::SECTIONS
                .iter()
                .map(|s| entry(s.head, s.about, &[s.keys]))
                .collect(),
        ),
        (
            "methods",
            method::all()
                .map(|m| entry(m.name, m.about, &m.parameters()))
                .collect(),
        ),
        (
            "studies",
            STUDIES
                .iter()
                .map(|s| entry(s.name, s.question, &[]))
                .collect(),
        ),
        (
            "laws",
            LAWS.iter()
                .map(|l| entry(l.name, l.about, &[l.parameters]))
                .collect(),
        ),
        (
            "ccd-methods",
            ccd::METHODS
                .iter()
                .map(|m| entry(m.name, m.about, &[]))
                .collect(),
        ),
        (
            "meshes",
            GENERATORS
                .iter()
                .map(|&(form, about)| entry(form, about, &[]))
                .collect(),
        ),
    ]
}

pub(super) fn execute(arguments: &Arguments) -> Result<(), BenchError> {
    let kinds = entries();
    if arguments.json {
        let kind = |(name, entries): &(&str, Vec<Entry>)| {
            ((*name).to_owned(), entries.iter().map(as_json).collect())
        };
        let object: serde_json::Map<String, Value> = kinds.iter().map(kind).collect();
        return print(&Value::Object(object).to_string());
    }
    let mut lines = Vec::new();
    for (kind, entries) in kinds {
        lines.push(format!("{kind}:"));
        for entry in entries {
            lines.push(format!("  {:18} {}", entry.name, entry.about));
            for p in &entry.parameters {
                let set = if kind == SCENE_FILES {
                    format!("{} = {}", p.name, p.default)
                } else {
                    format!("--set {}={}", p.name, p.default)
                };
                lines.push(format!("  {:18}   {set}  {}", "", p.about));
            }
        }
    }
    print(&lines.join("\n"))
}

fn as_json(entry: &Entry) -> Value {
    let parameter =
        |p: &&Parameter| json!({"name": p.name, "default": p.default, "about": p.about});
    let parameters: Vec<Value> = entry.parameters.iter().map(parameter).collect();
    json!({"name": entry.name, "about": entry.about, "parameters": parameters})
}
