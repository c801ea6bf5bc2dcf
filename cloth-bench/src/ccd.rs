//! Methods of continuous collision detection, held against queries of known answer: how often is each one wrong, and
//! how long does it take?

mod additive;
pub mod coplanarity;
pub mod exact_queries;
mod file;

pub use file::read;

use crate::error::BenchError;
use crate::names;
use cloth_collide::{CollideError, ContinuousTest, Query, QueryKind};
use cloth_core::math::Real;
use exact_queries::{ExactQueries, KnownQuery, Truth};
use serde::{Deserialize, Serialize};
use std::hint::black_box;
use std::time::Instant;

/// A method by name.
#[derive(Clone, Copy, Debug)]
pub struct CcdMethod {
    /// Its name.
    pub name: &'static str,
    /// What it does.
    pub about: &'static str,
    /// Whether it misses nothing and is never late. One that says so and is not so fails the run.
    pub is_conservative: bool,
    first_contact: fn(&Query) -> Result<Option<Real>, CollideError>,
}

/// All methods.
pub const METHODS: [CcdMethod; 6] = [
    CcdMethod {
        name: "conservative",
        about: "moving separating directions, certified; what is too near for f64 in double precision",
        is_conservative: true,
        first_contact: |query| conservative(query, 0.0),
    },
    CcdMethod {
        name: "conservative-slack",
        about: "the same, stopping when the distance has shrunk to a thousandth",
        is_conservative: true,
        first_contact: |query| conservative(query, 1e-3),
    },
    CcdMethod {
        name: "additive",
        about: "additive conservative advancement (Li et al. 2021), to a thousandth of the distance, at most 10000 steps; its distances round",
        is_conservative: false,
        first_contact: |query| Ok(additive::first_contact(query)),
    },
    CcdMethod {
        name: "cubic",
        about: "roots of the coplanarity cubic and a tolerance of 1e-9",
        is_conservative: false,
        first_contact: |query| Ok(coplanarity::first_contact(query, 1e-9)),
    },
    CcdMethod {
        name: "cubic-strict",
        about: "the same without a tolerance",
        is_conservative: false,
        first_contact: |query| Ok(coplanarity::first_contact(query, 0.0)),
    },
    CcdMethod {
        name: "discrete",
        about: "distance zero at the end of the motion: what tunnels",
        is_conservative: false,
        first_contact: |query| Ok((query.distance(1.0) == 0.0).then_some(1.0)),
    },
];

fn conservative(query: &Query, slack: Real) -> Result<Option<Real>, CollideError> {
    let test = ContinuousTest::new(0.0, slack)?;
    Ok(query.first_contact(&test)?.map(|impact| impact.time))
}

impl CcdMethod {
    /// The method of this name.
    pub fn find(name: &str) -> Result<Self, BenchError> {
        names::find("method of `ccd`", name, METHODS.into_iter(), |method| {
            method.name
        })
    }

    /// First contact (dimensionless, 0..=1).
    pub fn first_contact(&self, query: &Query) -> Result<Option<Real>, CollideError> {
        (self.first_contact)(query)
    }
}

/// A query and what is known about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelledQuery {
    /// The motion.
    pub query: Query,
    /// Whether there is a contact.
    pub contact: bool,
    /// A time (dimensionless, 0..=1) at which there is one, if that is known.
    pub contact_time: Option<Real>,
    /// The line of its file where it begins, from 1; none if it is from no file.
    pub line: Option<usize>,
}

/// `count` queries of exactly known answer, half of them contacts, half of them degenerate.
pub fn generate(kind: QueryKind, count: usize, seed: u64) -> Vec<LabelledQuery> {
    let labelled = |known: KnownQuery| {
        let contact_time = match known.truth {
            Truth::Contact { time } => Some(time),
            Truth::Apart { .. } => None,
        };
        LabelledQuery {
            query: known.query,
            contact: contact_time.is_some(),
            contact_time,
            line: None,
        }
    };
    ExactQueries::new(kind, seed)
        .take(count)
        .map(labelled)
        .collect()
}

/// How a method did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// Number of queries.
    #[serde(rename = "number")]
    pub queries: usize,
    /// Queries with a contact.
    #[serde(skip)]
    pub positives: usize,
    /// Contacts found that are none.
    pub false_positives: usize,
    /// Contacts missed.
    pub false_negatives: usize,
    /// Contacts found later than one that is known.
    pub late: usize,
    /// Time that half of the queries do not exceed (ns). All times are the shortest of several repetitions of each
    /// query.
    #[serde(rename = "median (ns)")]
    pub median_ns: Real,
    /// Mean time of a query (ns).
    #[serde(rename = "mean (ns)")]
    pub mean_ns: Real,
    /// Longest time of a query (ns).
    #[serde(rename = "worst (ns)")]
    pub worst_ns: Real,
}

/// Repetitions of the whole set; and calls between two looks at the clock, which would otherwise be what is measured.
const PASSES: usize = 5;
const CALLS: u32 = 4;

/// Asks the `method` every query and compares. `place` says where the query of a number comes from.
///
/// # Errors
/// [`BenchError::Usage`] for a query that the method cannot work with, [`BenchError::Failed`] for a time that is no
/// number in 0..=1.
pub fn score(
    method: &CcdMethod,
    queries: &[LabelledQuery],
    place: impl Fn(usize) -> String,
) -> Result<Score, BenchError> {
    let mut score = Score {
        queries: queries.len(),
        ..Default::default()
    };
    for (number, labelled) in queries.iter().enumerate() {
        let found = method.first_contact(&labelled.query);
        let found =
            found.map_err(|error| BenchError::Usage(format!("{}: {error}", place(number))))?;
        if let Some(time) = found
            && !(0.0..=1.0).contains(&time)
        {
            return Err(BenchError::Failed(format!(
                "{}: contact at time {time}",
                place(number)
            )));
        }
        score.positives += usize::from(labelled.contact);
        score.false_positives += usize::from(found.is_some() && !labelled.contact);
        score.false_negatives += usize::from(found.is_none() && labelled.contact);
        let late =
            matches!((found, labelled.contact_time), (Some(found), Some(known)) if found > known);
        score.late += usize::from(late);
    }
    let mut shortest = vec![Real::INFINITY; queries.len()];
    for _ in 0..PASSES {
        for (labelled, shortest) in queries.iter().zip(&mut shortest) {
            let start = Instant::now();
            for _ in 0..CALLS {
                // Checked above: it is not an error.
                let _ = black_box(method.first_contact(black_box(&labelled.query)));
            }
            let each = start.elapsed().as_nanos() as Real / Real::from(CALLS);
            *shortest = shortest.min(each);
        }
    }
    shortest.sort_by(Real::total_cmp);
    if let (Some(&median), Some(&worst)) = (shortest.get(queries.len() / 2), shortest.last()) {
        score.mean_ns = shortest.iter().sum::<Real>() / queries.len() as Real;
        score.median_ns = median;
        score.worst_ns = worst;
    }
    Ok(score)
}
