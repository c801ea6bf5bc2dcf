//! The columns of the table: how a value is said, and when it is best or unfit.

use super::measure::Contact;
use super::{REFERENCE, Row, measure};
use crate::studies::prelude::*;
use crate::studies::{NOISE, stability};

/// A column of the table: its heading, its value, how it is said, and how it is judged.
pub(super) struct Column {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) value: fn(&Row) -> Option<Real>,
    pub(super) say: fn(Real) -> String,
    pub(super) rule: Rule,
}

/// The explicit method, which cuts a step into as many parts as it needs.
const EXPLICIT: &str = "symplectic-euler";

/// A sheet that is longer by so much of its edges than one that is solved to its end looks like another material. Not a
/// multiple of that strain: what the edge at a corner takes depends on the mesh.
const STRETCHED: Real = 0.02;

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
    /// Near to that of the reference; so much more is too much.
    Reference(Real),
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
        rule: Rule::Reference(STRETCHED),
    },
    Column {
        name: "stable up to (N/m)",
        unit: "N/m",
        value: |r| r.step.as_ref()?.stable.stable,
        say: power,
        rule: Rule::Above(1e4),
    },
    Column {
        name: "locks?",
        unit: "dimensionless",
        value: |r| r.step.as_ref()?.fold,
        say: fold,
        rule: Rule::One,
    },
    Column {
        name: "ms in contact",
        unit: "ms",
        value: |r| r.contact.as_ref()?.drape.ms,
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
        value: |r| r.contact.as_ref()?.drape.crossings,
        say: two,
        rule: Rule::Below(0.0),
    },
    Column {
        name: "energy from nowhere",
        unit: "dimensionless",
        value: |r| r.contact.as_ref()?.drape.excess,
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
        name: "real time up to about",
        unit: "vertices",
        value: Row::real_time,
        say: side,
        rule: Rule::Gain,
    },
];

fn one(value: Real) -> String {
    significant(value, 1)
}

fn fold(share: Real) -> String {
    let word = match share {
        share if share < 0.5 => "yes",
        share if share < 0.8 => "partly",
        share if share < 1.25 => "no",
        _ => "too far",
    };
    format!("{word} ({share:.2})")
}

/// A power of ten.
pub(super) fn power(value: Real) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let exponent = value.log10().round().clamp(0.0, 9.0) as usize;
    let least = if exponent == 9 { "≥ " } else { "" };
    format!("{least}10{}", DIGITS[exponent])
}

/// A square of so many vertices.
fn side(vertices: Real) -> String {
    let side = vertices.sqrt();
    format!("{side:.0} × {side:.0}")
}

impl Column {
    /// Its name with the sheet that it is measured on.
    pub(super) fn head(&self, scope: Scope) -> String {
        let square = |side: u32| format!("{side} × {side}");
        let [small, large] = measure::sides(scope).map(square);
        let (of_error, of_contact, _) = measure::small(scope);
        let name = self.name;
        match name {
            "error of a step" => format!("{name}, {}", square(of_error)),
            "stable up to (N/m)" => format!("{name}, {}", square(stability::map::N as u32)),
            "locks?" => format!(
                "{name} alternating diagonals, {}",
                square(measure::FOLDED + 1)
            ),
            "memory" => format!("{name}, {large}"),
            _ if self.unit == "ms" && name.starts_with("ms a step") => {
                name.replace("small", &small).replace("large", &large)
            }
            "real time up to about" => name.to_owned(),
            _ => format!("{name}, {}", square(of_contact)),
        }
    }

    /// Times that differ by less than this factor may be in another order in another run; what depends on no clock has
    /// no such factor.
    pub(super) fn noise(&self) -> Real {
        match self.rule {
            Rule::Cost | Rule::Gain => NOISE,
            _ => 1.0,
        }
    }

    /// Whether this is how far steps reach that are not cut, as they are everywhere else: no fault of the method.
    fn is_uncut(&self, row: &Row) -> bool {
        self.name.starts_with("stable") && row.method == EXPLICIT
    }

    /// The value of a row as a reader wants it.
    pub(super) fn said(&self, row: &Row, value: Real) -> String {
        let strained = row.step.as_ref().and_then(|step| step.stable.strained);
        let more = match strained.filter(|_| self.name.starts_with("stable")) {
            _ if self.is_uncut(row) => " uncut".to_owned(),
            Some(stiffness) => format!(", strained from {}", power(stiffness)),
            None => String::new(),
        };
        (self.say)(value) + &more
    }

    /// The value of a row, and what to think of it beside the others.
    pub(super) fn judged(&self, row: &Row, rows: &[&Row]) -> Option<(Real, Mark)> {
        let value = (self.value)(row)?;
        if self.is_uncut(row) {
            return Some((value, Mark::Expected));
        }
        let all: Vec<Real> = rows.iter().filter_map(|row| (self.value)(row)).collect();
        let reference = rows.iter().find(|row| row.method == REFERENCE);
        let reference = reference.and_then(|row| (self.value)(row));
        Some((value, self.rule.judge(value, &all, reference)))
    }

    /// What stands where a method has no value.
    pub(super) fn absence(&self, row: &Row) -> (&'static str, Mark) {
        let aims = Method::find(row.method).is_ok_and(Method::aims_at_implicit_euler);
        let mut reasons = row.step.iter().flat_map(|step| &step.reasons);
        let rests = !reasons.any(|reason| reason.contains("not at rest"));
        match self.name {
            "error of a step" if !aims => ("another step", Mark::Expected),
            "locks?" if !rests => ("not at rest", Mark::Expected),
            "ms a step, large" | "real time up to about" if row.cost.is_some() => {
                ("too long", Mark::Unfit)
            }
            "ms in contact" | "contact costs" | "crossings" | "energy from nowhere"
                if row.contact.as_ref().is_some_and(Contact::is_too_long) =>
            {
                ("too long", Mark::Unfit)
            }
            _ => ("failed", Mark::Unfit),
        }
    }
}

impl Row {
    /// Time of a step that ends in contact over that of one that hangs.
    pub(super) fn contact_cost(&self) -> Option<Real> {
        let contact = self.contact.as_ref()?;
        Some(contact.drape.ms? / contact.hanging_ms?)
    }

    /// Vertices at 60 steps a second, by the power law through both sizes; but no step takes less than in proportion to
    /// the vertices, whatever small sizes may say.
    pub fn real_time(&self) -> Option<Real> {
        let cost = self.cost.as_ref()?;
        let [small, large] = cost.sides.map(|side| Real::from(side).powi(2));
        let [fast, slow] = [cost.ms[0]?, cost.ms[1]?];
        let exponent = ((slow / fast).ln() / (large / small).ln()).max(1.0);
        Some(small * (1000.0 / 60.0 / fast).powf(1.0 / exponent))
    }
}

impl Rule {
    /// Whether it judges what comes out, and not what that costs.
    pub(super) fn is_of_quality(&self) -> bool {
        !matches!(self, Self::Cost | Self::Gain)
    }

    /// What to think of one of several values, given that of the reference.
    pub fn judge(&self, value: Real, all: &[Real], reference: Option<Real>) -> Mark {
        let least = all.iter().copied().fold(Real::INFINITY, Real::min);
        let most = all.iter().copied().fold(0.0, Real::max);
        let is_low = value <= 1.05 * least;
        let is_high = value >= 0.95 * most;
        let (is_best, is_unfit) = match *self {
            Self::Cost => (value < NOISE * least, value > 10.0 * least),
            Self::Gain => (NOISE * value > most, value < 0.1 * most),
            Self::Below(limit) => (is_low, value > limit),
            Self::Above(limit) => (is_high, value < limit),
            Self::One => ((0.8..1.25).contains(&value), !(0.5..2.0).contains(&value)),
            Self::Reference(more) => match reference {
                Some(right) => ((value / right - 1.0).abs() <= 0.05, value > right + more),
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
