//! Elements that threads visit side by side share no vertex, or are refused.

// What is refused here never comes from outside.
#[allow(dead_code, unreachable_pub)] // a part of the file is enough
#[path = "../../src/method/parallel.rs"]
mod parallel;

use parallel::Stencils;

#[test]
fn a_vertex_may_be_in_one_part_of_every_stage() {
    let stages = vec![vec![0, 2, 3], vec![3, 4]];
    let stencils = Stencils::new(vec![[0, 1], [1, 2], [3, 4], [2, 3]], stages, 5);
    assert_eq!(stencils.stages().len(), 2);
}

#[test]
#[should_panic(expected = "two parts of a stage share vertex 1")]
fn parts_that_share_a_vertex_are_refused() {
    let _ = Stencils::new(vec![[0, 1], [2, 3], [1, 4]], vec![vec![0, 1, 2, 3]], 5);
}

#[test]
#[should_panic(expected = "a vertex that does not exist")]
fn a_vertex_that_does_not_exist_is_refused() {
    let _ = Stencils::new(vec![[0, 1], [2, 3]], vec![vec![0, 2]], 3);
}

#[test]
#[should_panic(expected = "slice index starts at 2 but ends at 1")]
fn bounds_that_do_not_ascend_are_refused() {
    let _ = Stencils::new(vec![[0, 1], [2, 3]], vec![vec![0, 2, 1]], 4);
}
