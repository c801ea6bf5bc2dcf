//! Random input to everything that takes input from outside: nothing may panic, and nothing that is not finite may come
//! out as a result.
//!
//! Every case has a seed of its own. As a test, a fixed number of cases is run, the same ones every time; with
//! `CLOTH_FUZZ_SECONDS=3600` each test goes on with further seeds for so long. A case that panics says its seed, which
//! `CLOTH_FUZZ_SEED` runs alone.

#[path = "fuzz/files.rs"]
mod files;
#[path = "fuzz/input.rs"]
mod input;
#[path = "fuzz/journal.rs"]
mod journal;
#[path = "fuzz/meshes.rs"]
mod meshes;

use cloth_core::random::SplitMix64;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Says the seed if the case does not return.
struct Seed(u64);

impl Drop for Seed {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("this case alone: CLOTH_FUZZ_SEED={}", self.0);
        }
    }
}

fn variable(name: &str) -> Option<u64> {
    let text = std::env::var(name).ok()?;
    Some(text.parse().expect("a whole number"))
}

/// Runs `count` cases, or those that the environment asks for.
fn fuzz(count: u64, mut case: impl FnMut(&mut Random)) {
    if let Some(seed) = variable("CLOTH_FUZZ_SEED") {
        return case(&mut Random(SplitMix64::new(seed)));
    }
    let end = variable("CLOTH_FUZZ_SECONDS").map(|s| Instant::now() + Duration::from_secs(s));
    let goes_on = |seed| end.map_or(seed < count, |end| Instant::now() < end);
    for seed in (0..).take_while(|&seed| goes_on(seed)) {
        let _seed = Seed(seed);
        case(&mut Random(SplitMix64::new(seed)));
    }
}

/// What cases are made of.
struct Random(SplitMix64);

impl Random {
    /// Below `end`, which is above 0.
    fn below(&mut self, end: usize) -> usize {
        (self.0.next_bits() % end as u64) as usize
    }

    fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    fn pick<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// A number of any size, now and then one that is none.
    fn number(&mut self) -> f64 {
        match self.below(12) {
            0 => 0.0,
            1 => f64::from_bits(self.0.next_bits()),
            2 => self.0.symmetric() * 1e-12,
            3 => self.0.symmetric() * 1e12,
            4 => self.below(5) as f64,
            _ => self.0.symmetric(),
        }
    }

    /// `text` with some words replaced, and bytes changed, lost, doubled or moved.
    fn mutate(&mut self, text: &mut Vec<u8>) {
        let changes = if self.one_in(3) { 1 + self.below(4) } else { 1 };
        for _ in 0..changes {
            let (place, length) = (self.below(text.len() + 1), self.below(16));
            let end = (place + length).min(text.len());
            match self.below(10) {
                0 => text.truncate(place),
                1 => drop(text.drain(place..end)),
                2 => {
                    let piece = text[place..end].to_vec();
                    let to = self.below(text.len() + 1);
                    text.splice(to..to, piece);
                }
                3 => text.insert(place, self.0.next_bits() as u8),
                4 => {
                    if let Some(byte) = text.get_mut(place) {
                        *byte ^= 1 << self.below(8);
                    }
                }
                _ => self.replace_word(text, place),
            }
        }
    }

    /// Puts something else where a word is at `place`.
    fn replace_word(&mut self, text: &mut Vec<u8>, place: usize) {
        let ends = |byte: &u8| b" \n,[]".contains(byte);
        let start = text[..place].iter().rposition(ends).map_or(0, |i| i + 1);
        let end = text[place..].iter().position(ends);
        let end = end.map_or(text.len(), |length| place + length);
        let word = match self.below(3) {
            0 => self.number().to_string(),
            1 => self.below(12).to_string(),
            _ => self
                .pick(&[
                    "-1",
                    "nan",
                    "1e999",
                    "4294967296",
                    "1e-300",
                    "",
                    "\"\"",
                    "true",
                ])
                .to_owned(),
        };
        text.splice(start..end, word.into_bytes());
    }
}

/// A folder for one of the tests.
fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("fuzz")
        .join(name);
    std::fs::create_dir_all(&path).unwrap();
    path
}
