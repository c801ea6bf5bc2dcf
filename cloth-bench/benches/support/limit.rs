//! What every bench of this folder has in common: one `main`, and beside each kernel the time that moving its data
//! takes.
//!
//! The data of a kernel are everything that it has to read or write, each byte once. They cannot come faster than
//! memory gives them, and how fast that is depends on how many they are: from the second cache level, the third, or
//! main memory. So a triad `a = b + 3 c` over arrays of many sizes is timed once in each program, on one thread, and
//! gives the limit of a kernel whose data are as many. Near 1 a kernel waits for memory alone; far above it computes,
//! waits for its own results, or reads the same data again.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion};
use rayon::ThreadPool;
use std::hint::black_box;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Runs the benches of a program: all of them, or those whose names contain the argument of `cargo bench`.
pub fn main(targets: &[fn(&mut Criterion)]) {
    let started = Instant::now();
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(600))
        .sample_size(20)
        .configure_from_args();
    for target in targets {
        target(&mut criterion);
    }
    criterion.final_summary();
    println!("all in {:.0} s", started.elapsed().as_secs_f64());
}

/// What a kernel moves.
#[derive(Clone, Copy, Debug)]
pub struct Moved {
    /// Everything that one pass reads or writes.
    bytes: usize,
    passes: usize,
}

impl From<usize> for Moved {
    fn from(bytes: usize) -> Self {
        Self { bytes, passes: 1 }
    }
}

impl Moved {
    /// The same bytes again and again: as fast as so many come, however often.
    #[must_use]
    pub fn times(passes: u32, bytes: usize) -> Self {
        let passes = passes as usize;
        Self { bytes, passes }
    }
}

/// Times `work` as criterion does, and prints the shortest time beside the limit for what it moves. Nothing is printed
/// for what a filter leaves out.
pub fn bench<O>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: impl Into<String>,
    moved: impl Into<Moved>,
    mut work: impl FnMut() -> O,
) {
    timed(group, &name.into(), moved, |repetitions| {
        let started = Instant::now();
        for _ in 0..repetitions {
            black_box(work());
        }
        started.elapsed()
    });
}

/// The same with work on the threads of a pool, entered before the clock starts: going in takes longer than a small
/// sweep.
pub fn bench_in<O>(
    pool: &ThreadPool,
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: impl Into<String>,
    moved: impl Into<Moved>,
    mut work: impl FnMut() -> O + Send,
) {
    timed(group, &name.into(), moved, |repetitions| {
        pool.install(|| {
            let started = Instant::now();
            for _ in 0..repetitions {
                black_box(work());
            }
            started.elapsed()
        })
    });
}

/// The same where `time` does the work so many times and says how long it took.
pub fn timed(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    moved: impl Into<Moved>,
    mut time: impl FnMut(u64) -> Duration,
) {
    let Moved { bytes, passes } = moved.into();
    let mut shortest = f64::INFINITY;
    group.bench_function(name, |bencher| {
        bencher.iter_custom(|repetitions| {
            let taken = time(repetitions);
            shortest = shortest.min(taken.as_secs_f64() / repetitions as f64);
            taken
        });
    });
    if shortest.is_finite() {
        let limit = Triad::measured().seconds(bytes) * passes as f64;
        let again = match passes {
            1 => String::new(),
            _ => format!(" {passes} times"),
        };
        println!(
            "    {name}: {} of data{again}, limit {}, measured {}, ratio {:.1}\n",
            in_bytes(bytes),
            in_time(limit),
            in_time(shortest),
            shortest / limit
        );
    }
}

fn in_bytes(bytes: usize) -> String {
    let bytes = bytes as f64;
    match bytes {
        0.0..1e3 => format!("{bytes} B"),
        1e3..1e6 => format!("{:.1} kB", bytes / 1e3),
        _ => format!("{:.1} MB", bytes / 1e6),
    }
}

fn in_time(seconds: f64) -> String {
    match seconds {
        0.0..1e-6 => format!("{:.1} ns", 1e9 * seconds),
        1e-6..1e-3 => format!("{:.1} µs", 1e6 * seconds),
        1e-3..1.0 => format!("{:.2} ms", 1e3 * seconds),
        _ => format!("{seconds:.2} s"),
    }
}

/// Bytes per second by the number of bytes.
struct Triad(Vec<(usize, f64)>);

impl Triad {
    /// Measured when it is asked for the first time; takes half a second.
    fn measured() -> &'static Self {
        static TRIAD: OnceLock<Triad> = OnceLock::new();
        TRIAD.get_or_init(|| {
            let triad = Self((0..7).map(|i| Self::at(4_000 << (2 * i))).collect());
            let told = triad
                .0
                .iter()
                .map(|(bytes, speed)| format!("{} {:.0} GB/s", in_bytes(*bytes), speed / 1e9));
            println!(
                "triad on one thread: {}",
                told.collect::<Vec<_>>().join(", ")
            );
            triad
        })
    }

    /// The best of many runs over three arrays of that many numbers in all.
    fn at(numbers: usize) -> (usize, f64) {
        let count = numbers / 3;
        let (b, c) = (vec![1.0_f64; count], vec![2.0_f64; count]);
        let mut a = vec![0.0_f64; count];
        let bytes = 24 * count;
        let mut shortest = f64::INFINITY;
        let started = Instant::now();
        let mut runs = 0;
        while runs < 5 || started.elapsed() < Duration::from_millis(40) {
            let run = Instant::now();
            for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
                *a = b + 3.0 * c;
            }
            black_box(&mut a);
            shortest = shortest.min(run.elapsed().as_secs_f64());
            runs += 1;
        }
        (bytes, bytes as f64 / shortest)
    }

    /// Time (s) to move so many bytes, at the speed of the measured size next above, or of the largest.
    fn seconds(&self, bytes: usize) -> f64 {
        let mut sizes = self.0.iter();
        let at_least = sizes.find(|(size, _)| *size >= bytes);
        let (_, speed) = at_least.or(self.0.last()).expect("sizes");
        bytes as f64 / speed
    }
}
