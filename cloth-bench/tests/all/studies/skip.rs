//! What features cost that are not used.

mod memory;
