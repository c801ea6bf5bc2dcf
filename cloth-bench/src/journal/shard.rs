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
    #[must_use]
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Every case falls to exactly one shard, and the shards are about as large.
    #[test]
    fn shards_cut_the_cases_evenly() {
        let names: Vec<String> = (0..1000).map(|i| format!("case {i}")).collect();
        for count in [1_u64, 2, 3, 8] {
            let shards: Vec<Shard> = (1..=count).map(|number| Shard { number, count }).collect();
            let sizes = shards.iter().map(|shard| {
                names
                    .iter()
                    .filter(|name| shard.includes("study", name))
                    .count()
            });
            let sizes: Vec<usize> = sizes.collect();
            assert_eq!(sizes.iter().sum::<usize>(), 1000);
            let mean = 1000 / count as usize;
            assert!(sizes.iter().all(|&n| n.abs_diff(mean) < 70), "{sizes:?}");
        }
        assert_eq!(
            "2/4".parse(),
            Ok(Shard {
                number: 2,
                count: 4
            })
        );
        for text in ["0/2", "3/2", "1", "a/b", "1/0", ""] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
