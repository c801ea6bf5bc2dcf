//! What scenes are built of.

mod falls;
mod pins;
