//! All tests of this crate in one program, which links once; a file is a subject, and a filter picks it:
//! `cargo test --release -p cloth-collide --test all potential::`.

mod animated;
mod between_steps;
mod bodies_in_time;
mod body_surfaces;
mod candidates;
mod ccd;
mod concave_edges;
mod contact_laws;
mod contact_memory;
#[path = "../../../cloth-core/tests/support/counting_allocator.rs"]
mod counting_allocator;
mod edges_matter;
mod first_contact;
mod garments;
mod guarantee;
#[path = "../support/lattice.rs"]
mod lattice;
mod linearization_errors;
mod multipliers;
mod nearest_edge_edge;
mod nearest_point_triangle;
mod no_allocation;
mod obstacle_shapes;
mod potential;
mod potential_derivatives;
#[path = "../support/random.rs"]
mod random;
mod separation;
mod sewn;
#[path = "../support/shapes.rs"]
mod shapes;
#[path = "../support/solids.rs"]
mod solids;
mod taken_back;
#[path = "../../../cloth-bench/src/mesh_spec/tangled.rs"]
mod tangled_garments;
mod too_far;
mod untangle;
