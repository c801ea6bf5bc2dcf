//! Tables as a file of Arrow.

use arrow_array::Array;
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, UInt32Type};
use arrow_ipc::reader::FileReader;
use cloth_bench::report::arrow::file;
use cloth_bench::report::table::{Cell, Table};

#[test]
fn every_value_comes_back() {
    let mut table = Table::new(&["method", "error", "steps", "remark"]);
    table.line("pbd", [0.1.into(), 3_usize.into(), Cell::Missing]);
    let bytes = file([("convergence", "one", &table)]).unwrap();
    let mut reader = FileReader::try_new(std::io::Cursor::new(bytes), None).unwrap();
    let names: Vec<_> = reader
        .schema()
        .fields()
        .iter()
        .map(|f| f.name().clone())
        .collect();
    assert_eq!(names, ["study", "table", "row", "column", "number", "text"]);
    let batch = reader.next().unwrap().unwrap();
    assert_eq!(batch.num_rows(), 4);
    let text = |column: usize, row: usize| batch.column(column).as_string::<i32>().value(row);
    assert_eq!(
        [text(0, 1), text(1, 1), text(3, 1), text(5, 0)],
        ["convergence", "one", "error", "pbd"]
    );
    let numbers = batch.column(4).as_primitive::<Float64Type>();
    assert_eq!(numbers.value(1).to_bits(), 0.1_f64.to_bits());
    assert_eq!(numbers.value(2), 3.0);
    assert!(numbers.is_null(0) && numbers.is_null(3) && batch.column(5).is_null(3));
    assert_eq!(batch.column(2).as_primitive::<UInt32Type>().value(3), 0);
}
