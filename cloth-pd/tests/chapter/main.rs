//! The claims of the chapter.

mod acceleration;
mod change;
mod cloth;
mod edges;
mod local;
mod minimum;
mod motion;
mod pin_work;
mod robust;
mod step;
