//! How much memory the program has taken, and how much a piece of work asks for.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    // By thread, because others allocate whenever they like. Constant and without a destructor, so that to count does
    // not allocate.
    static ALLOCATED: Cell<Allocated> = const { Cell::new(Allocated { count: 0, bytes: 0 }) };
}

/// What a thread has asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Allocated {
    /// How often it asked for memory.
    pub count: i64,
    /// How much it was given and has not given back (bytes).
    pub bytes: i64,
}

/// Gives what `work` does, and what it asks for on this thread, less what it gives back.
pub fn allocated<T>(work: impl FnOnce() -> T) -> (T, Allocated) {
    let before = ALLOCATED.get();
    let done = work();
    let after = ALLOCATED.get();
    let difference = Allocated {
        count: after.count - before.count,
        bytes: after.bytes - before.bytes,
    };
    (done, difference)
}

/// The allocator of the system, counted.
struct Counting;

/// Counts a change by so many bytes.
fn count(asked: i64, bytes: i64) {
    let Allocated { count, bytes: held } = ALLOCATED.get();
    ALLOCATED.set(Allocated {
        count: count + asked,
        bytes: held + bytes,
    });
}

#[allow(unsafe_code, reason = "an allocator cannot be written without it")]
// SAFETY: every call goes to the system's allocator unchanged; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(1, layout.size() as i64);
        // SAFETY: the caller's promises are those that `System` asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(1, layout.size() as i64);
        // SAFETY: as above.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        count(0, -(layout.size() as i64));
        // SAFETY: as above.
        unsafe { System.dealloc(place, layout) }
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(1, size as i64 - layout.size() as i64);
        // SAFETY: as above.
        unsafe { System.realloc(place, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The most memory (bytes) that this process has held at a time, where the system tells it (Linux).
pub fn peak() -> Option<u64> {
    kilobytes("/proc/self/status", "VmHWM:").map(|kb| 1024 * kb)
}

/// Memory (bytes) that programs could still take, where the system tells it (Linux).
pub fn available() -> Option<u64> {
    kilobytes("/proc/meminfo", "MemAvailable:").map(|kb| 1024 * kb)
}

/// The number behind a name in one of the system's tables.
fn kilobytes(table: &str, name: &str) -> Option<u64> {
    let text = std::fs::read_to_string(table).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}
