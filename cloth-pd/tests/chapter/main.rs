//! The claims of the chapter.

mod cloth;
mod edges;
mod minimum;
mod motion;
mod step;
