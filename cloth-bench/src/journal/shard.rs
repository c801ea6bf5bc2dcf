//! Cases shared among several runs.

use crate::hash::fnv1a;

/// One of several runs that share the cases of the studies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which one, from 1.
    number: u64,
    /// Of how many.
    count: u64,
}

impl Shard {
    /// Whether a case falls to this one: by a hash of its names, the same on every machine and in every version.
    pub fn includes(&self, study: &str, case: &str) -> bool {
        // With a byte between the names that neither has.
        let hash = fnv1a(study.bytes().chain([0]).chain(case.bytes()));
        // The low bits of a product know little of its high ones.
        (hash ^ hash >> 32) % self.count == self.number - 1
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(number, count)| {
            Some((number.parse::<u64>().ok()?, count.parse::<u64>().ok()?))
        });
        match numbers {
            Some((number, count)) if 1 <= number && number <= count => Ok(Self { number, count }),
            _ => Err("it is not I/N with whole numbers 1 ≤ I ≤ N, such as 2/4".into()),
        }
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}
