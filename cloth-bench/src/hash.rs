//! A hash that is the same on every machine and in every version.

/// FNV-1a of 64 bits (Fowler, Noll and Vo, RFC 9923). One changed byte always changes it: every round is a bijection of
/// the hash so far.
pub fn fnv1a(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes
        .into_iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
}
