//! What no measurement says of the methods, at their default settings.

use crate::report::table::{Cell, Table};

const COLUMNS: [&str; 6] = [
    "method",
    "physical parameters",
    "holds and lets go without a new solver",
    "in parallel",
    "factorises",
    "patent reported, not checked",
];

/// As the documentation of the crates has it.
#[rustfmt::skip] // a table is read by rows
const QUALITIES: [[&str; 6]; 10] = [
    ["explicit-euler", "yes", "no", "gradients", "nothing", "none reported"],
    ["symplectic-euler", "yes", "no", "gradients", "nothing", "none reported"],
    ["implicit-euler", "yes", "no", "gradients, matrices, multigrid", "nothing (multigrid)", "none reported"],
    ["linear-implicit", "yes", "no", "gradients, matrices, multigrid", "nothing (multigrid)", "none reported"],
    ["implicit-midpoint", "yes", "no", "gradients, matrices, multigrid", "nothing (multigrid)", "none reported"],
    ["bdf2", "yes", "no", "gradients, matrices, multigrid", "nothing (multigrid)", "none reported"],
    ["pbd", "no: depends on iterations and step", "no", "constraints of a colour", "nothing", "none reported"],
    ["xpbd", "yes, once it has converged", "no", "constraints of a colour", "nothing", "US 11,270,041"],
    ["xpbd-direct", "yes", "no", "no", "its system", "as xpbd"],
    ["pd", "yes", "yes", "blocks of vertices, subtrees of the factor", "its matrix, anew for another step size", "none reported"],
];

pub(super) fn table() -> Table {
    let mut table = Table::new(&COLUMNS);
    for row in QUALITIES {
        table.push(row.map(Cell::from));
    }
    table
}
