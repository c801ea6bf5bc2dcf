//! Tables: every number of a study, to a CSV file and to HTML.
//!
//! The CSV keeps each number to its last bit, for other programs. The HTML rounds to four
//! significant digits, for people.

use super::{html::escape, rows};
use crate::journal::Number;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// What a reader should see of a value at a glance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mark {
    /// Among the best of its column.
    Best,
    /// Nothing remarkable.
    Plain,
    /// So bad that it rules the method out where it matters.
    Unfit,
    /// A failure that theory foretells: no alarm.
    Expected,
}

impl Mark {
    /// The sign before the value, and the class of its cell in the page.
    fn sign(self) -> [&'static str; 2] {
        match self {
            Self::Best => ["★ ", "best"],
            Self::Plain => ["", "plain"],
            Self::Unfit => ["✗ ", "unfit"],
            Self::Expected => ["", "expected"],
        }
    }
}

/// One value of a [`Table`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub enum Cell {
    /// A name or a remark.
    Text(String),
    /// A count.
    Int(i64),
    /// A measured or computed number; its column says the unit.
    #[serde(serialize_with = "write_number", deserialize_with = "read_number")]
    Number(f64),
    /// A value as a reader wants it, rounded and with its unit, and what to think of it.
    Marked(String, Mark),
    /// There is no value here (a method does not have this quantity, or the run failed).
    #[default]
    Missing,
}

fn write_number<S: Serializer>(number: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    Number(*number).serialize(serializer)
}

fn read_number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Number::deserialize(deserializer).map(|number| number.0)
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<i64> for Cell {
    fn from(count: i64) -> Self {
        Self::Int(count)
    }
}

impl From<usize> for Cell {
    /// Counts above `i64::MAX`, which no table here can hold, become `i64::MAX`.
    fn from(count: usize) -> Self {
        Self::Int(i64::try_from(count).unwrap_or(i64::MAX))
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Missing, Into::into)
    }
}

impl Cell {
    /// A value as a reader wants it, rounded and with its unit.
    pub fn said(text: impl Into<String>) -> Self {
        Self::Marked(text.into(), Mark::Plain)
    }

    /// As one CSV field, quoted where RFC 4180 asks for it.
    ///
    /// Numbers are the shortest text that reads back to the same `f64`; `NaN`, `inf` and `-inf`
    /// are written so. A missing value is an empty field, an empty text is `""`.
    fn to_csv(&self) -> String {
        match self {
            Self::Text(text) => quoted(text),
            Self::Int(count) => count.to_string(),
            Self::Number(number) => format!("{number:?}"),
            Self::Marked(text, _) => quoted(text),
            Self::Missing => String::new(),
        }
    }

    /// For a terminal.
    fn to_text(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Int(count) => count.to_string(),
            Self::Number(number) => significant(*number, 4),
            Self::Marked(text, mark) => format!("{}{text}", mark.sign()[0]),
            Self::Missing => "–".to_owned(),
        }
    }

    /// As one HTML table cell.
    fn to_html(&self) -> String {
        match self {
            Self::Text(text) => format!("<td>{}</td>", escape(text)),
            Self::Int(count) => format!("<td class=\"number\">{count}</td>"),
            Self::Number(number) => {
                format!("<td class=\"number\">{}</td>", significant(*number, 4))
            }
            Self::Marked(text, mark) => {
                let [sign, class] = mark.sign();
                format!("<td class=\"number {class}\">{sign}{}</td>", escape(text))
            }
            Self::Missing => "<td class=\"number missing\">–</td>".to_owned(),
        }
    }

    fn is_numeric(&self) -> bool {
        matches!(self, Self::Int(_) | Self::Number(_) | Self::Marked(..))
    }
}

/// Rows of values under named columns. A column name states its unit: `"time (s)"`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Table {
    /// The name of each column, with its unit.
    pub columns: Vec<String>,
    /// The rows, each with one cell per column.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new<S: AsRef<str>>(columns: &[S]) -> Self {
        Self {
            columns: columns.iter().map(|s| s.as_ref().to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// A table without rows, whose first column names what the others are about.
    pub fn about(first: &str, others: impl IntoIterator<Item = String>) -> Self {
        let columns = std::iter::once(first.to_owned()).chain(others);
        Self::new(&columns.collect::<Vec<_>>())
    }

    /// Adds a row: what it is about, and the other cells.
    pub fn line(&mut self, first: impl Into<Cell>, others: impl IntoIterator<Item = Cell>) {
        let cells = std::iter::once(first.into()).chain(others);
        self.rows.push(cells.collect());
    }

    /// A table of typed rows: a column per field, of the same name with blanks for `_`; where there is more to say,
    /// such as a unit, with `#[serde(rename = "time (s)")]`. The fields of a field that is a struct, and of the
    /// elements of a tuple, are columns of their own.
    ///
    /// # Panics
    /// If a row holds what is no cell, such as a list.
    pub fn of<R: Serialize + Default>(rows: &[R]) -> Self {
        Self::named::<&str, R>(&[], rows)
    }

    /// The same of rows that hold values without a name, in tuples, which are called `names` in their order.
    ///
    /// # Panics
    /// If there are fewer names, and as [`Table::of`].
    pub fn named<S: AsRef<str>, R: Serialize + Default>(names: &[S], rows: &[R]) -> Self {
        let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
        // The columns are there without rows too.
        let (columns, _) = rows::columns_and_cells(&names, &R::default());
        let cells = rows
            .iter()
            .map(|row| rows::columns_and_cells(&names, row).1);
        Self {
            columns,
            rows: cells.collect(),
        }
    }

    /// As a CSV file (RFC 4180: comma, CRLF, first line the column names), at full precision.
    pub fn to_csv(&self) -> String {
        let names = self
            .columns
            .iter()
            .map(|name| quoted(name))
            .collect::<Vec<_>>()
            .join(",");
        let mut csv = names + "\r\n";
        for row in &self.rows {
            csv += &row.iter().map(Cell::to_csv).collect::<Vec<_>>().join(",");
            csv += "\r\n";
        }
        csv
    }

    /// As lines of text for a terminal, numbers to four significant digits and to the right of their columns.
    pub fn to_text(&self) -> String {
        let texts: Vec<Vec<String>> = self
            .rows
            .iter()
            .map(|row| row.iter().map(Cell::to_text).collect())
            .collect();
        let width = |text: &str| text.chars().count();
        let widths: Vec<usize> = (0..self.columns.len())
            .map(|column| {
                let cells = texts.iter().filter_map(|row| row.get(column));
                let widest = cells.map(|text| width(text)).max().unwrap_or(0);
                widest.max(width(&self.columns[column]))
            })
            .collect();
        let mut lines = String::new();
        for (row, cells) in std::iter::once(&self.columns).chain(&texts).enumerate() {
            let mut line = String::new();
            for (column, text) in cells.iter().enumerate() {
                let blanks = " ".repeat(widths[column] - width(text));
                let is_name = row > 0 && matches!(self.rows[row - 1][column], Cell::Text(_));
                let is_name = is_name
                    || row == 0
                        && self
                            .rows
                            .iter()
                            .any(|cells| matches!(cells[column], Cell::Text(_)));
                line += &if is_name {
                    format!("{text}{blanks}  ")
                } else {
                    format!("{blanks}{text}  ")
                };
            }
            lines += line.trim_end();
            lines.push('\n');
        }
        lines
    }

    /// As an HTML `<table>`, numbers to four significant digits and aligned to the right.
    pub fn to_html(&self) -> String {
        let mut html = String::from("<table><thead><tr>");
        for (column, name) in self.columns.iter().enumerate() {
            let mut cells = self.rows.iter().filter_map(|row| row.get(column));
            let class = if cells.any(Cell::is_numeric) {
                " class=\"number\""
            } else {
                ""
            };
            html += &format!("<th scope=\"col\"{class}>{}</th>", escape(name));
        }
        html += "</tr></thead><tbody>\n";
        for row in &self.rows {
            let cells: String = row.iter().map(Cell::to_html).collect();
            html += &format!("<tr>{cells}</tr>\n");
        }
        html + "</tbody></table>\n"
    }
}

impl<R: Serialize + Default> From<&Vec<R>> for Table {
    fn from(rows: &Vec<R>) -> Self {
        Self::of(rows)
    }
}

/// `text` as a CSV field: in quotes, with quotes doubled, if it holds a comma, a quote, a line
/// break or blanks at its ends, or is empty.
fn quoted(text: &str) -> String {
    let plain = !text.is_empty() && !text.contains([',', '"', '\r', '\n']) && text.trim() == text;
    if plain {
        text.to_owned()
    } else {
        format!("\"{}\"", text.replace('"', "\"\""))
    }
}

/// `number` rounded to `digits` significant digits, without trailing zeros; as `1.5e-7` outside
/// of 0.001 … 100 000, as `NaN`, `∞` or `−∞` if not finite.
pub fn significant(number: f64, digits: usize) -> String {
    if number.is_nan() {
        return "NaN".to_owned();
    }
    if number.is_infinite() {
        return if number > 0.0 { "∞" } else { "−∞" }.to_owned();
    }
    if number == 0.0 {
        return "0".to_owned();
    }
    let last = digits.max(1) - 1;
    // Rounding may carry into the next decade, so the exponent is read from the rounded text.
    let scientific = format!("{number:.last$e}");
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let text = if (-3..5).contains(&exponent) {
        let decimals = usize::try_from(last as i32 - exponent).unwrap_or(0);
        trimmed(&format!("{number:.decimals$}")).to_owned()
    } else {
        format!("{}e{exponent}", trimmed(mantissa))
    };
    text.replace('-', "−").replace("e−", "e-")
}

/// `number` as a reader wants it: two significant digits, or all of them before the point.
pub fn two(number: f64) -> String {
    match number.abs() >= 100.0 {
        true => format!("{number:.0}"),
        false => significant(number, 2),
    }
}

/// A fraction as a percentage of two digits.
pub fn percent(fraction: f64) -> String {
    match 100.0 * fraction {
        none if none.abs() < 0.005 => "0 %".into(),
        beyond if beyond.abs() >= 1e6 => format!("{beyond:.0e} %"),
        share => format!("{} %", two(share)),
    }
}

/// Without the zeros that end a decimal fraction.
fn trimmed(decimal: &str) -> &str {
    if decimal.contains('.') {
        decimal.trim_end_matches('0').trim_end_matches('.')
    } else {
        decimal
    }
}
