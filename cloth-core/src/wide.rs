//! Loops for the vector registers that the processor has.
//!
//! A program for any processor of its kind may use the registers that all of them have, which on x86-64 hold two numbers. What is run here is
//! compiled a second time for registers of four, and the processor is asked which of the two it can execute. Both do the same
//! operations in the same order (a product and a sum are never fused), so the results have the same bits.

/// Runs `work`, as compiled for wide registers if the processor has them.
///
/// The second compilation reaches as far as inlining does: the closure and what its loops call have to be `#[inline(always)]`.
#[inline(always)]
pub fn wide<T>(work: impl FnOnce() -> T) -> T {
    pulp::Arch::new().dispatch(work)
}
