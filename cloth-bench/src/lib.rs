//! The cloth simulation methods of this workspace, measured side by side.

pub mod error;
pub mod mesh_spec;
pub mod names;
pub mod report;
pub mod scene;
pub mod settings;
