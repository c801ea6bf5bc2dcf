//! Claims that hold for every method.

#[path = "contract/air.rs"]
mod air;
#[path = "contract/common.rs"]
mod common;
#[path = "contract/contact.rs"]
mod contact;
#[path = "contract/discretization.rs"]
mod discretization;
#[path = "contract/energy.rs"]
mod energy;
#[path = "contract/momentum.rs"]
mod momentum;
#[path = "contract/no_alloc.rs"]
mod no_alloc;
#[path = "contract/pin_loads.rs"]
mod pin_loads;
#[path = "contract/potential.rs"]
mod potential;
#[path = "contract/refuses.rs"]
mod refuses;
#[path = "contract/rest_state.rs"]
mod rest_state;
#[path = "contract/rows.rs"]
mod rows;
#[path = "contract/same_minimum.rs"]
mod same_minimum;
#[path = "contract/scene_files.rs"]
mod scene_files;
#[path = "contract/skips.rs"]
mod skips;
#[path = "contract/strain_limit.rs"]
mod strain_limit;
#[path = "contract/thread_parity.rs"]
mod thread_parity;
