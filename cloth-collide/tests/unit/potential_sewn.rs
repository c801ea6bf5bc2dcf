use super::*;

#[test]
fn vertices_are_sewn_through_others_and_never_to_themselves() {
    let sewn = Sewn::new(&[[7, 2], [2, 5], [0, 1]]);
    for pair in [[5, 7], [7, 5], [2, 7], [1, 0]] {
        assert!(sewn.join(&pair), "{pair:?}");
    }
    for pair in [[0, 2], [7, 7], [3, 3], [3, 4], [8, 9], [9, 9], [5, 1]] {
        assert!(!sewn.join(&pair), "{pair:?}");
    }
    assert!(sewn.join(&[3, 9, 2, 4, 5]));
    assert!(!Sewn::new(&[]).join(&[0, 1]));
}
