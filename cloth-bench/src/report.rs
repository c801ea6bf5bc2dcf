//! What a study leaves behind: plots, tables and pictures, collected in one page.
//!
//! - [`plot`]: curves over linear or logarithmic axes, as SVG
//! - [`png`]: the same as PNG, if that was built in
//! - [`table`]: numbers, as CSV for programs and HTML for people
//! - [`arrow`]: all numbers of all tables in one Arrow file
//! - [`render`]: triangle meshes, as PNG
//! - [`player`]: runs that the page plays back in three dimensions
//! - [`html`]: the page that holds it all, in a single file without outside resources
//! - [`facts`]: commit, machine and threads, which every result states
//! - [`palette`]: one colour and marker per method
//! - [`scale`]: ranges and ticks

pub mod arrow;
pub mod canvas;
pub mod facts;
pub mod html;
mod layout;
pub mod palette;
pub mod player;
pub mod plot;
pub mod png;
pub mod render;
mod rows;
pub mod scale;
pub mod table;
