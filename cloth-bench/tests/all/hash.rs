//! Hashes against published values.

use cloth_bench::hash::fnv1a;

/// Values from the list of test vectors of the authors.
#[test]
fn published_values_come_out() {
    for (text, hash) in [
        ("", 0xcbf2_9ce4_8422_2325),
        ("a", 0xaf63_dc4c_8601_ec8c),
        ("foobar", 0x8594_4171_f739_67e8),
    ] {
        assert_eq!(fnv1a(text.bytes()), hash, "{text}");
    }
}
