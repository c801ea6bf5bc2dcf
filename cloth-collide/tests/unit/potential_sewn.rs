use super::*;

#[test]
fn vertices_are_sewn_through_others_and_never_to_themselves() {
    let sewn = Sewn::new(&[[7, 2], [2, 5], [0, 1]], &[], 10);
    for pair in [[5, 7], [7, 5], [2, 7], [1, 0]] {
        assert!(sewn.join(&pair), "{pair:?}");
    }
    for pair in [[0, 2], [7, 7], [3, 3], [3, 4], [8, 9], [9, 9], [5, 1]] {
        assert!(!sewn.join(&pair), "{pair:?}");
    }
    assert!(sewn.join(&[3, 9, 2, 4, 5]));
    assert!(!Sewn::new(&[], &[], 10).join(&[0, 1]));
}

#[test]
fn a_vertex_on_an_edge_is_a_neighbour_of_its_ends_alone() {
    // 6 and 7 are on the edge from 1 to 2, and 2 is sewn to 9.
    let sewn = Sewn::new(&[[2, 9]], &[[6, 1, 2], [7, 1, 2]], 10);
    for pair in [[6, 1], [2, 6], [7, 1], [7, 2], [9, 6], [7, 9], [2, 9]] {
        assert!(sewn.join(&pair), "{pair:?}");
    }
    for pair in [[6, 7], [1, 2], [1, 9], [6, 8], [6, 6]] {
        assert!(!sewn.join(&pair), "{pair:?}");
    }
    assert!(sewn.join(&[4, 6, 5, 2]));
}
