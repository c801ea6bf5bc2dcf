//! No method allocates once warm.

use crate::common::{advance, methods, scene, solver};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

/// The system's allocator, counting the calls of each thread.
struct Counting;

#[allow(unsafe_code)] // a global allocator cannot be written without
// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promise about `layout` is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise about `pointer` and `layout` is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn no_step_allocates_after_the_first() {
    let scene = scene("hang", &["n=20"]);
    for method in methods() {
        let mut solver = solver(method, &scene);
        let mut state = scene.start.clone();
        advance(&mut *solver, &scene, &mut state, 1);
        let before = ALLOCATIONS.get();
        advance(&mut *solver, &scene, &mut state, 10);
        assert_eq!(
            ALLOCATIONS.get() - before,
            0,
            "allocations of {}",
            method.name
        );
    }
}
