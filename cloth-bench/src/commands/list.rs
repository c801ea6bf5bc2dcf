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

/// What stands before parameters that several entries have.
const COMMON: &str = "(common)";

/// Width (characters) of the lines that name common parameters.
const WIDTH: usize = 120;

/// Something that can be named, whatever its kind.
struct Entry {
    name: &'static str,
    about: &'static str,
    parameters: Vec<Parameter>,
}

fn entries() -> [(&'static str, Vec<Entry>); 7] {
    let with_defaults =
        |name, about, tables: &[&'static [Parameter]], defaults: [&'static str; 2]| {
            let own = |parameter: &Parameter| {
                let defaults = defaults.iter().flat_map(|pairs| pairs.split_whitespace());
                let mut defaults = defaults.filter_map(|pair| pair.split_once('='));
                let own = defaults.find(|(key, _)| *key == parameter.name);
                Parameter {
                    default: own.map_or(parameter.default, |(_, default)| default),
                    ..*parameter
                }
            };
            Entry {
                name,
                about,
                parameters: tables.iter().copied().flatten().map(own).collect(),
            }
        };
    let entry =
        |name, about, tables: &[&'static [Parameter]]| with_defaults(name, about, tables, [""; 2]);
    let plain = |name, about| entry(name, about, &[]);
    let scenes = SCENES.iter();
    let scenes = scenes.map(|s| with_defaults(s.name, s.about, &s.groups(), [s.defaults(), ""]));
    let sections = file::SECTIONS
        .iter()
        .map(|s| entry(s.head, s.about, s.keys));
    let methods = method::all();
    // What is not given is what `run` takes.
    let methods = methods.map(|m| {
        let defaults = [m.defaults_of_run(), m.defaults()];
        with_defaults(m.name, m.about, &m.parameters(), defaults)
    });
    let laws = LAWS.iter().map(|l| entry(l.name, l.about, l.parameters));
    let meshes = GENERATORS.iter().map(|&(form, about)| plain(form, about));
    [
        ("scenes", scenes.collect()),
        (SCENE_FILES, sections.collect()),
        ("methods", methods.collect()),
        (
            "studies",
            STUDIES.iter().map(|s| plain(s.name, s.question)).collect(),
        ),
        ("laws", laws.collect()),
        (
            "ccd-methods",
            ccd::METHODS
                .iter()
                .map(|m| plain(m.name, m.about))
                .collect(),
        ),
        ("meshes", meshes.collect()),
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
        let common = common(&entries);
        let full = |p: &Parameter| {
            let set = match kind {
                SCENE_FILES => format!("{} = {}", p.name, p.default),
                _ => format!("--set {}={}", p.name, p.default),
            };
            format!("  {:18}   {set}  {}", "", p.explained())
        };
        lines.push(format!("{kind}:"));
        if !common.is_empty() {
            lines.push(format!("  {COMMON:18} of more than one of them"));
            lines.extend(common.iter().map(&full));
        }
        for entry in &entries {
            lines.push(format!("  {:18} {}", entry.name, entry.about));
            let mut shared = Vec::new();
            for p in &entry.parameters {
                match common.iter().find(|known| is_same(known, p)) {
                    Some(known) if known.default == p.default => shared.push(p.name.to_owned()),
                    Some(_) => shared.push(format!("{}={}", p.name, p.default)),
                    None => lines.push(full(p)),
                }
            }
            lines.extend(wrapped(&shared));
        }
    }
    print(&lines.join("\n"))
}

/// The parameters that more than one entry has, each once, with the default that it has first.
fn common(entries: &[Entry]) -> Vec<Parameter> {
    let all = || entries.iter().flat_map(|entry| &entry.parameters);
    let mut common: Vec<Parameter> = Vec::new();
    for p in all() {
        let is_known = common.iter().any(|known| known.name == p.name);
        if !is_known && all().filter(|other| is_same(other, p)).count() > 1 {
            common.push(*p);
        }
    }
    common
}

/// Whether two parameters mean the same; their defaults may differ.
fn is_same(a: &Parameter, b: &Parameter) -> bool {
    (a.name, a.about) == (b.name, b.about)
}

/// Lines that name the common parameters of an entry; where its default is another one, with that.
fn wrapped(names: &[String]) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for name in names {
        match lines.last_mut() {
            Some(line) if line.len() + name.len() + 2 < WIDTH => *line += &format!(", {name}"),
            _ => lines.push(format!("  {:18}   {COMMON} {name}", "")),
        }
    }
    lines
}

fn as_json(entry: &Entry) -> Value {
    let parameter = |p: &Parameter| json!({"name": p.name, "default": p.default, "about": p.about, "unit": p.unit, "range": p.range.to_string()});
    let parameters: Vec<Value> = entry.parameters.iter().map(parameter).collect();
    json!({"name": entry.name, "about": entry.about, "parameters": parameters})
}
