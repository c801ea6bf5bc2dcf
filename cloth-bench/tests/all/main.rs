//! All tests of this crate in one program, which links once; a file is a subject, and a filter picks it:
//! `cargo test --release -p cloth-bench --test all laws::`.

mod animations;
mod bending_laws;
mod body_mass;
mod broad_phase;
mod carried;
mod ccd;
mod changes;
mod cli;
mod commands;
mod concave_edges;
mod contact_time;
mod crossings;
mod crumpled;
mod driven;
mod energy;
mod error;
mod events;
#[path = "../support/exact_runs.rs"]
mod exact_runs;
mod exclude;
mod export;
mod flights;
mod forces;
mod hard_constraints;
mod hash;
mod held_inside;
mod hollow;
mod journal;
#[path = "../support/law.rs"]
mod law;
mod laws;
mod links;
mod loads;
mod locking;
mod memory;
mod mesh_spec;
mod messages;
mod method_tables;
mod names;
mod page;
mod pinched;
mod places;
mod poles;
#[path = "../support/program.rs"]
mod program;
mod readme;
mod refusals;
mod report;
mod restitution;
mod resume;
mod rigid_bodies;
mod sampled;
mod scene;
mod scene_file;
#[path = "../support/scene_text.rs"]
mod scene_text;
mod seam;
mod settings;
mod sliding;
mod soft_pins;
mod solids;
mod start_warnings;
mod starts;
mod stops;
mod stretch;
mod studies;
mod tangled;
mod tears;
mod towel;
mod uneven_seams;
mod untangle;
mod user_forces;
mod volume;
mod weld;
mod wind;
