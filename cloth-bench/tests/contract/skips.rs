//! What a scene does not use does not exist.

use crate::common::scene;

#[test]
fn without_rigidity_no_bending_is_built() {
    let without = scene("hang", &["n=9", "rigidity=0"]);
    assert!(without.model.hinges.is_empty());
    assert_eq!(without.model.energies().unwrap().family_count(), 1);
    let with = scene("hang", &["n=9"]);
    assert_eq!(with.model.energies().unwrap().family_count(), 2);
}
