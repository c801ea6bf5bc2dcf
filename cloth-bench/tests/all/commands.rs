//! Work without progress to show is spoken of.

use cloth_bench::commands::while_saying;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

#[test]
fn long_work_is_spoken_of_until_it_ends() {
    let said = AtomicU32::new(0);
    let say = || {
        said.fetch_add(1, Ordering::Relaxed);
    };
    let result = while_saying(Duration::from_millis(1), say, || {
        while said.load(Ordering::Relaxed) < 3 {
            std::thread::yield_now();
        }
        7
    });
    assert_eq!(result, 7);
}
