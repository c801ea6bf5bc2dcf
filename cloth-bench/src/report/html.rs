//! One page for everything: a single HTML file without outside resources, and without scripts unless it plays something
//! back.
//!
//! A section answers one question. Its answer in plain words stands directly below it, then the
//! figures, pictures and tables it rests on, then the command that makes them again.

use super::player::{self, Playback};
use super::table::Table;
use serde::{Deserialize, Serialize};

/// A picture with its caption.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Picture {
    /// A PNG file.
    pub png: Vec<u8>,
    /// What it shows.
    pub caption: String,
}

/// The answer to one question.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Section {
    /// The anchor in the page: letters, digits and `-`; other characters become `-`.
    pub id: String,
    /// The heading.
    pub title: String,
    /// The question in one sentence.
    pub question: String,
    /// Whether it opens the report, before the plain answers.
    #[serde(default)]
    pub leads: bool,
    /// The answer in a plain sentence, once someone has judged the numbers.
    pub verdict: Option<String>,
    /// The plot or table that it rests on: `figure-` or `table-`, and the name; if empty, the first of the section.
    #[serde(default)]
    pub rests_on: String,
    /// The numbers behind it, method by method.
    #[serde(default)]
    pub detail: String,
    /// The command that makes this section again.
    pub command: String,
    /// Figures with their names: `<svg>` elements from [`Plot::draw`](super::plot::Plot::draw). They go into the
    /// page as they are.
    pub plots: Vec<(String, String)>,
    /// Pictures.
    pub pictures: Vec<Picture>,
    /// Runs to play back.
    #[serde(default)]
    pub playbacks: Vec<Playback>,
    /// Tables with their names and captions.
    pub tables: Vec<(String, String, Table)>,
    /// Surprises, limits, anything a reader should know; one paragraph each.
    pub notes: Vec<String>,
}

/// The whole page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// The heading.
    pub title: String,
    /// Name and value of what every result depends on; see [`facts::collect`](super::facts::collect).
    pub facts: Vec<(String, String)>,
    /// Plain answers to the questions that people come with.
    pub answers: Vec<Answer>,
    /// The sections, in order.
    pub sections: Vec<Section>,
}

/// A plain answer.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Answer {
    /// The question.
    pub question: String,
    /// The answer in a sentence or two.
    pub answer: String,
    /// Its numbers, where they are many.
    pub table: Option<Table>,
    /// The plot or table that it rests on: `figure-` or `table-`, and the name.
    pub figure: String,
    /// The id of the section that this is in.
    pub section: String,
}

/// Tables longer than this are folded away at first.
const LONG_TABLE: usize = 15;

impl Report {
    /// The page as the text of one HTML file.
    pub fn to_html(&self) -> String {
        let title = escape(&self.title);
        let facts: String = self
            .facts
            .iter()
            .map(|(name, value)| {
                format!(
                    "<div><dt>{}</dt><dd>{}</dd></div>\n",
                    escape(name),
                    escape(value)
                )
            })
            .collect();
        let contents: String = self
            .sections
            .iter()
            .map(|s| {
                format!(
                    "<li><a href=\"#{}\">{}</a> <span>{}</span></li>\n",
                    anchor(&s.id),
                    escape(&s.title),
                    escape(&s.question)
                )
            })
            .collect();
        let contents = if self.sections.len() < 2 {
            String::new()
        } else {
            format!("<nav aria-label=\"Contents\"><ol>\n{contents}</ol></nav>\n")
        };
        let answers = self.answers_to_html();
        let of = |leads: bool| -> String {
            let sections = self.sections.iter().filter(|s| s.leads == leads);
            sections.map(Section::to_html).collect()
        };
        let (leading, sections) = (of(true), of(false));
        let script = if self.sections.iter().all(|s| s.playbacks.is_empty()) {
            String::new()
        } else {
            format!("<script>\n{}</script>\n", player::SCRIPT)
        };
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n\
             <h1>{title}</h1>\n<dl class=\"facts\">\n{facts}</dl>\n</header>\n<main>\n\
             {leading}{answers}{contents}{sections}</main>\n{script}</body>\n</html>\n"
        )
    }

    fn answers_to_html(&self) -> String {
        if self.answers.is_empty() {
            return String::new();
        }
        let rows = self.answers.iter().map(|answer| {
            let (kind, _) = answer.figure.split_once('-').unwrap_or_default();
            let table = answer.table.as_ref().map_or(String::new(), scrolled);
            format!(
                "<dt>{}</dt><dd>{} <a href=\"#{}\">{kind} in {}</a>{table}</dd>\n",
                escape(&answer.question),
                escape(&answer.answer),
                anchor(&answer.figure),
                escape(&answer.section)
            )
        });
        let rows: String = rows.collect();
        format!("<h2 class=\"answers\">In short</h2>\n<dl class=\"answers\">\n{rows}</dl>\n")
    }
}

impl Section {
    /// Whether it shows the plot `figure-…` or the table `table-…`.
    pub(crate) fn shows(&self, figure: &str) -> bool {
        let plots = self.plots.iter().map(|(name, _)| ("figure-", name));
        let tables = self.tables.iter().map(|(name, ..)| ("table-", name));
        let mut all = plots.chain(tables);
        all.any(|(kind, name)| figure.strip_prefix(kind) == Some(name))
    }

    /// What its answer rests on: a figure or a table; if none is named, the first.
    fn basis(&self) -> Option<(&str, &str)> {
        if let Some(named) = self.rests_on.split_once('-') {
            return Some(named);
        }
        let plot = self.plots.first().map(|(name, _)| ("figure", &**name));
        let table = self.tables.first();
        plot.or(table.map(|(name, ..)| ("table", &**name)))
    }

    fn to_html(&self) -> String {
        let mut html = format!(
            "<section id=\"{}\"{}>\n<h2>{}</h2>\n",
            anchor(&self.id),
            if self.leads { " class=\"lead\"" } else { "" },
            escape(&self.title)
        );
        if !self.question.is_empty() {
            html += &format!("<p class=\"question\">{}</p>\n", escape(&self.question));
        }
        if let Some(verdict) = &self.verdict {
            let link = self.basis().map_or(String::new(), |(kind, name)| {
                let id = anchor(&format!("{kind}-{name}"));
                format!(" <a href=\"#{id}\">{kind}</a>")
            });
            let link = if self.leads { "" } else { &link };
            html += &format!("<p class=\"verdict\">{}{link}</p>\n", escape(verdict));
        }
        if !self.detail.is_empty() {
            html += &format!(
                "<details><summary>In numbers</summary><p>{}</p></details>\n",
                escape(&self.detail)
            );
        }
        if self.leads {
            html += &self.tables_to_html(1, 0);
        }
        if !self.plots.is_empty() {
            html += "<div class=\"plots\">\n";
            for (name, plot) in &self.plots {
                let id = anchor(&format!("figure-{name}"));
                html += &format!("<figure class=\"plot\" id=\"{id}\">\n{plot}</figure>\n");
            }
            html += "</div>\n";
        }
        if !self.pictures.is_empty() {
            html += "<div class=\"pictures\">\n";
            for picture in &self.pictures {
                let caption = escape(&picture.caption);
                html += &format!(
                    "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{}\"/>\
                     <figcaption>{caption}</figcaption></figure>\n",
                    base64(&picture.png)
                );
            }
            html += "</div>\n";
        }
        for playback in &self.playbacks {
            html += &playback.to_html();
        }
        html += &self.tables_to_html(usize::MAX, usize::from(self.leads));
        if !self.notes.is_empty() {
            let notes: String = self
                .notes
                .iter()
                .map(|note| format!("<li>{}</li>\n", escape(note)))
                .collect();
            let notes = format!("<ul class=\"notes\">\n{notes}</ul>\n");
            html += &if self.leads {
                format!("<details><summary>How it was measured</summary>\n{notes}</details>\n")
            } else {
                format!("<h3>Worth knowing</h3>\n{notes}")
            };
        }
        if !self.command.is_empty() {
            html += &format!("<pre><code>{}</code></pre>\n", escape(&self.command));
        }
        html + "</section>\n"
    }

    /// So many of its tables, without the first ones. Long ones are folded away, and all but the first of a section
    /// that leads.
    fn tables_to_html(&self, most: usize, without: usize) -> String {
        let mut html = String::new();
        for (name, caption, table) in self.tables.iter().skip(without).take(most) {
            let (caption, body) = (escape(caption), scrolled(table));
            let id = anchor(&format!("table-{name}"));
            html += &if table.rows.len() > LONG_TABLE || without > 0 {
                let rows = table.rows.len();
                // A link into what is folded away opens it.
                format!(
                    "<details><summary>{caption} ({rows} rows)</summary><div id=\"{id}\">{body}</div></details>\n"
                )
            } else {
                format!("<div id=\"{id}\"><p class=\"caption\">{caption}</p>{body}</div>\n")
            };
        }
        html
    }
}

/// A table that scrolls where the page is too narrow for it.
fn scrolled(table: &Table) -> String {
    format!("<div class=\"scroll\">{}</div>", table.to_html())
}

/// `text` with everything replaced that HTML or XML would read as markup, in content and in
/// quoted attributes. Control characters, which XML forbids, become `�`.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\'' => escaped += "&#39;",
            '\n' | '\t' => escaped.push(letter),
            _ if letter.is_control() => escaped.push('\u{fffd}'),
            _ => escaped.push(letter),
        }
    }
    escaped
}

/// `id` as an anchor.
fn anchor(id: &str) -> String {
    id.chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect()
}

/// RFC 4648, with padding.
pub fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= chunk.len() {
                char::from(letter)
            } else {
                '='
            });
        }
    }
    text
}

const STYLE: &str = include_str!("page.css");
