//! The columns of the table: how a value is said, and when it is best or unfit.

use super::Row;
use crate::report::table::Mark;
use crate::studies::prelude::*;

/// A column of the table: its heading, its value, how it is said, and how it is judged.
pub(super) struct Column {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) value: fn(&Row) -> Option<Real>,
    pub(super) say: fn(Real) -> String,
    pub(super) rule: Rule,
}

/// When a value is best or unfit.
#[derive(Debug)]
pub enum Rule {
    /// Less is better; ten times the least is too much.
    Cost,
    /// More is better; a tenth of the most is too little.
    Gain,
    /// Less is better; above the limit is too much.
    Below(Real),
    /// More is better; below the limit is too little.
    Above(Real),
    /// Near to that of the reference; twice that is too much.
    Reference,
    /// Near to one; half and twice that are too far from it.
    One,
}

pub(super) const COLUMNS: [Column; 12] = [
    Column {
        name: "ms a step, small",
        unit: "ms",
        value: |r| r.cost.as_ref()?.ms[0],
        say: two,
        rule: Rule::Cost,
    },
    Column {
        name: "ms a step, large",
        unit: "ms",
        value: |r| r.cost.as_ref()?.ms[1],
        say: two,
        rule: Rule::Cost,
    },
    Column {
        name: "error of a step",
        unit: "dimensionless",
        value: |r| r.step.as_ref()?.error,
        say: one,
        rule: Rule::Below(0.1),
    },
    Column {
        name: "stretch",
        unit: "dimensionless",
        value: |r| r.step.as_ref()?.stretch,
        say: percent,
        rule: Rule::Reference,
    },
    Column {
        name: "stable up to",
        unit: "N/m",
        value: |r| r.step.as_ref()?.stable,
        say: power,
        rule: Rule::Above(1e4),
    },
    Column {
        name: "fold",
        unit: "dimensionless",
        value: |r| r.step.as_ref()?.fold,
        say: fold,
        rule: Rule::One,
    },
    Column {
        name: "ms in contact",
        unit: "ms",
        value: |r| r.contact.as_ref()?.sixtieth.ms,
        say: two,
        rule: Rule::Cost,
    },
    Column {
        name: "contact costs",
        unit: "dimensionless",
        value: Row::contact_cost,
        say: |x| format!("{} ×", two(x)),
        rule: Rule::Cost,
    },
    Column {
        name: "crossings",
        unit: "pairs",
        value: |r| r.contact.as_ref()?.sixtieth.crossings,
        say: two,
        rule: Rule::Below(0.0),
    },
    Column {
        name: "energy above what was given",
        unit: "dimensionless",
        value: |r| r.contact.as_ref()?.sixtieth.excess,
        say: percent,
        rule: Rule::Below(0.01),
    },
    Column {
        name: "memory",
        unit: "B",
        value: |r| r.cost.as_ref()?.memory,
        say: |x| format!("{} MB", two(x / 1e6)),
        rule: Rule::Cost,
    },
    Column {
        name: "real time up to",
        unit: "vertices",
        value: Row::real_time,
        say: side,
        rule: Rule::Gain,
    },
];

fn one(value: Real) -> String {
    significant(value, 1)
}

pub(super) fn two(value: Real) -> String {
    if value >= 100.0 {
        return format!("{value:.0}");
    }
    significant(value, 2)
}

pub(super) fn percent(value: Real) -> String {
    match 100.0 * value {
        none if none < 0.005 => "0 %".into(),
        share => format!("{} %", two(share)),
    }
}

fn fold(share: Real) -> String {
    let word = match share {
        share if share < 0.5 => "locked",
        share if share < 0.8 => "bends",
        share if share < 1.25 => "folds",
        _ => "too far",
    };
    format!("{word} ({share:.2})")
}

/// A power of ten.
pub(super) fn power(value: Real) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let exponent = value.log10().round().clamp(0.0, 9.0) as usize;
    let least = if exponent == 9 { "≥ " } else { "" };
    format!("{least}10{} N/m", DIGITS[exponent])
}

/// A square of so many vertices.
fn side(vertices: Real) -> String {
    let side = vertices.sqrt();
    format!("≈ {side:.0} × {side:.0}")
}

impl Row {
    /// Time of a step that ends in contact over that of one that hangs.
    pub(super) fn contact_cost(&self) -> Option<Real> {
        let contact = self.contact.as_ref()?;
        Some(contact.sixtieth.ms? / contact.hanging_ms?)
    }

    /// Vertices at 60 steps a second, by the power law through both sizes; but no step takes less than in proportion to
    /// the vertices, whatever small sizes may say.
    #[must_use]
    pub fn real_time(&self) -> Option<Real> {
        let cost = self.cost.as_ref()?;
        let [small, large] = cost.sides.map(|side| Real::from(side).powi(2));
        let [fast, slow] = [cost.ms[0]?, cost.ms[1]?];
        let exponent = ((slow / fast).ln() / (large / small).ln()).max(1.0);
        Some(small * (1000.0 / 60.0 / fast).powf(1.0 / exponent))
    }
}

impl Rule {
    /// What to think of one of several values, given that of the reference.
    #[must_use]
    pub fn judge(&self, value: Real, all: &[Real], reference: Option<Real>) -> Mark {
        let least = all.iter().copied().fold(Real::INFINITY, Real::min);
        let most = all.iter().copied().fold(0.0, Real::max);
        let is_low = value <= 1.05 * least;
        let is_high = value >= 0.95 * most;
        let (is_best, is_unfit) = match *self {
            Self::Cost => (is_low, value > 10.0 * least),
            Self::Gain => (is_high, value < 0.1 * most),
            Self::Below(limit) => (is_low, value > limit),
            Self::Above(limit) => (is_high, value < limit),
            Self::One => ((0.8..1.25).contains(&value), !(0.5..2.0).contains(&value)),
            Self::Reference => match reference {
                Some(right) => ((value / right - 1.0).abs() <= 0.05, value > 2.0 * right),
                None => (false, false),
            },
        };
        match (is_unfit, is_best) {
            (true, _) => Mark::Unfit,
            (_, true) => Mark::Best,
            _ => Mark::Plain,
        }
    }
}
