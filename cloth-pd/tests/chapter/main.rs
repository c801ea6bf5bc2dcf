//! The claims of the chapter.

mod acceleration;
mod change;
mod cloth;
mod edges;
mod local;
mod minimum;
mod motion;
mod robust;
mod step;
