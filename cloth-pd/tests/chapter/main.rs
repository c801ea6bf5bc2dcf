//! The claims of the chapter.

mod acceleration;
mod cloth;
mod edges;
mod minimum;
mod motion;
mod step;
