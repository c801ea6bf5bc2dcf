//! Tables of rows that are structs.

use cloth_bench::journal::Number;
use cloth_bench::report::table::{Cell, Table};
use serde::Serialize;

#[derive(Default, Serialize)]
struct Point {
    method: &'static str,
    #[serde(rename = "dt (s)")]
    dt: f64,
}

#[derive(Default, Serialize)]
struct Measured {
    steps: Option<u32>,
    #[serde(rename = "error (m)")]
    error: Number,
    at_rest: bool,
    remarks: [Cell; 2],
}

#[test]
fn columns_are_the_fields_of_a_point_and_of_what_was_measured_there() {
    let measured = Measured {
        steps: None,
        error: Number(f64::INFINITY),
        at_rest: true,
        remarks: [Cell::Missing, Cell::from("slow")],
    };
    let point = Point {
        method: "pbd",
        dt: 0.5,
    };
    assert_eq!(
        Table::of(&[(point, measured)]).to_csv(),
        "method,dt (s),steps,error (m),at rest,remarks,remarks\r\npbd,0.5,,inf,yes,,slow\r\n"
    );
}

#[test]
fn a_table_without_rows_has_its_columns() {
    assert_eq!(Table::of::<Point>(&[]).to_csv(), "method,dt (s)\r\n");
}

#[test]
fn values_of_tuples_have_the_names_that_are_given() {
    let point = Point {
        method: "pd",
        dt: 0.5,
    };
    let rows = [(("drape", 9_u32), point, [1.5, f64::NAN])];
    let names = ["scene", "n", "one", "other"];
    assert_eq!(
        Table::named(&names, &rows).to_csv(),
        "scene,n,method,dt (s),one,other\r\ndrape,9,pd,0.5,1.5,NaN\r\n"
    );
    let none: [(u32, Point); 0] = [];
    assert_eq!(Table::named(&["n"], &none).to_csv(), "n,method,dt (s)\r\n");
}

#[test]
#[should_panic(expected = "a nameless value")]
fn values_without_a_name_are_refused() {
    let _ = Table::of(&[(1_u32, Point::default())]);
}
