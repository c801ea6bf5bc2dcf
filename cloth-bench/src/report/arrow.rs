//! All tables in one Arrow file, in long form: one row per value.
//!
//! `pandas.read_feather` and `polars.read_ipc` read it;
//! `df[df.table == "sag-chain"].pivot(index="row", columns="column", values="number")` gives a table back.

use super::table::{Cell, Table};
use crate::error::BenchError;
use arrow_array::builder::{Float64Builder, StringBuilder, UInt32Builder};
use arrow_array::{ArrayRef, RecordBatch};
use arrow_ipc::writer::FileWriter;
use std::sync::Arc;

/// The file: columns `study`, `table`, `row` (from 0), `column`, `number` and `text`, of which the last two are null
/// where the value is of the other kind or missing.
pub fn file<'a>(
    tables: impl IntoIterator<Item = (&'a str, &'a str, &'a Table)>,
) -> Result<Vec<u8>, BenchError> {
    let mut study = StringBuilder::new();
    let mut name = StringBuilder::new();
    let mut row = UInt32Builder::new();
    let mut column = StringBuilder::new();
    let mut number = Float64Builder::new();
    let mut text = StringBuilder::new();
    for (of_study, table_name, table) in tables {
        for (index, cells) in (0_u32..).zip(&table.rows) {
            for (column_name, cell) in table.columns.iter().zip(cells) {
                study.append_value(of_study);
                name.append_value(table_name);
                row.append_value(index);
                column.append_value(column_name);
                match cell {
                    Cell::Text(value) | Cell::Marked(value, _) => text.append_value(value),
                    _ => text.append_null(),
                }
                match *cell {
                    Cell::Number(value) => number.append_value(value),
                    Cell::Int(value) => number.append_value(value as f64),
                    _ => number.append_null(),
                }
            }
        }
    }
    let columns: [(&str, ArrayRef); 6] = [
        ("study", Arc::new(study.finish())),
        ("table", Arc::new(name.finish())),
        ("row", Arc::new(row.finish())),
        ("column", Arc::new(column.finish())),
        ("number", Arc::new(number.finish())),
        ("text", Arc::new(text.finish())),
    ];
    let batch = RecordBatch::try_from_iter_with_nullable(
        columns.map(|(name, values)| (name, values, matches!(name, "number" | "text"))),
    )?;
    let mut writer = FileWriter::try_new(Vec::new(), &batch.schema())?;
    writer.write(&batch)?;
    writer.into_inner().map_err(BenchError::failed)
}
