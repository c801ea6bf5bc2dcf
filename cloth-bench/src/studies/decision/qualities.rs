//! What no measurement says of the methods.

use crate::report::table::{Cell, Table};

/// Method, whether stiffness is in physical units, what may change between steps, what runs in parallel, what is factorised,
/// and patents that are reported (nobody here has checked them, nor looked for others).
const QUALITIES: [[&str; 6]; 10] = [
    [
        "explicit-euler",
        "yes",
        "anything",
        "forces",
        "nothing",
        "none reported",
    ],
    [
        "symplectic-euler",
        "yes",
        "anything",
        "forces",
        "nothing",
        "none reported",
    ],
    [
        "implicit-euler",
        "yes",
        "anything",
        "assembly, products",
        "a matrix now and then",
        "none reported",
    ],
    [
        "linear-implicit",
        "yes",
        "anything",
        "assembly, products",
        "nothing by default",
        "none reported",
    ],
    [
        "implicit-midpoint",
        "yes",
        "anything",
        "assembly, products",
        "a matrix now and then",
        "none reported",
    ],
    [
        "bdf2",
        "yes",
        "anything",
        "assembly, products",
        "a matrix now and then",
        "none reported",
    ],
    [
        "pbd",
        "no: depends on iterations and step",
        "anything",
        "constraints of a colour",
        "nothing",
        "none reported",
    ],
    [
        "xpbd",
        "yes, once it has converged",
        "anything",
        "constraints of a colour",
        "nothing",
        "US 11,270,041",
    ],
    [
        "xpbd-direct",
        "yes",
        "anything",
        "rows of the system",
        "a matrix every iteration",
        "US 11,270,041",
    ],
    [
        "pd",
        "yes",
        "step and stiffness cost a new factor",
        "projections",
        "one matrix, beforehand",
        "none reported",
    ],
];

pub(super) fn table() -> Table {
    let mut table = Table::new(&[
        "method",
        "physical parameters",
        "may change while running",
        "in parallel",
        "factorises",
        "patents",
    ]);
    for row in QUALITIES {
        table.push(row.map(Cell::from));
    }
    table
}
