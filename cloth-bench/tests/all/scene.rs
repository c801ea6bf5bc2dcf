//! What scenes are built of.

mod pins;
