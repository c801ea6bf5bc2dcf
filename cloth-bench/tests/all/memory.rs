//! Counted memory.

use cloth_bench::memory::{allocated, available, peak};

#[test]
fn what_is_asked_for_and_given_back_is_counted() {
    let (kept, all) = allocated(|| {
        drop(std::hint::black_box(vec![1_u64; 100]));
        vec![0_u8; 1000]
    });
    assert_eq!((all.count, all.bytes), (2, 1000));
    let (_, given_back) = allocated(|| drop(std::hint::black_box(kept)));
    assert_eq!((given_back.count, given_back.bytes), (0, -1000));
}

#[test]
fn the_peak_is_at_least_what_is_held() {
    let Some(before) = peak() else {
        return; // another system
    };
    let held = vec![1_u8; 64 << 20];
    assert!(peak().unwrap() >= before.max(64 << 20), "{before}");
    assert!(available().unwrap() > 0);
    drop(std::hint::black_box(held));
}
