//! Memory of features that are not used.

use cloth_bench::studies::skip::memory::{features, held};

/// But for a contact hook that is there and has nothing to do, which holds its mesh.
#[test]
fn what_is_not_used_holds_no_memory_and_what_is_used_does() {
    let mut of_hook = None;
    for (feature, method) in features() {
        let held = held(9, feature, method).unwrap();
        let told = format!("{feature}, {method}: {held:?}");
        assert_eq!(held.later, 0, "{told}");
        match feature {
            "contact" => {
                // The tables of the hook itself: no method takes notice of it.
                assert!((25_000..31_000).contains(&held.unused), "{told}");
                assert_eq!(*of_hook.get_or_insert(held.unused), held.unused, "{told}");
                assert!(held.used > held.unused, "{told}");
            }
            // Of settings of a method their text is copied, and given back.
            _ => assert!(held.unused == 0 && held.unused_count <= 3, "{told}"),
        }
        match feature {
            "observer" => assert_eq!((held.used, held.used_count), (0, 0), "{told}"),
            "strain limiting" => assert_eq!(held.used, 26_512, "{told}"),
            "bending" => assert!(held.used > 15_000, "{told}"),
            _ => {}
        }
    }
}
