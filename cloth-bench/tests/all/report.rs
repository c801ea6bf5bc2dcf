//! The report: tables, plots, pictures and pages.

mod arrow;
mod canvas;
mod facts;
mod html;
mod palette;
mod player;
mod plot;
#[cfg(feature = "plots-as-png")]
mod png;
mod render;
mod rows;
mod scale;
mod table;
