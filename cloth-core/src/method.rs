//! For authors of methods: what solvers are built from. A simulation needs none of it.
//!
//! In reading order: sums of elements and what they are stored in ([`family`], [`block_matrix`]); orders to visit them
//! in ([`coloring`], [`ordering`]); loops over vectors, on several threads with the same bits ([`vectors`],
//! [`chunked`], [`parallel`]); linear solvers ([`linear`], [`multigrid`], and with contacts [`contact_hessian`]); the
//! sweeps of PBD and XPBD ([`position_based`]); what quasi-Newton methods remember ([`limited_memory`]), and how far a
//! direction is followed ([`line_search`]), also where it may touch something ([`trust`]).

pub mod family;

pub mod block_matrix;

pub mod coloring;
pub mod ordering;

pub mod chunked;
pub mod parallel;
pub mod vectors;

pub mod linear;
pub mod multigrid;

pub mod contact_hessian;

pub mod position_based;

pub mod limited_memory;
pub mod line_search;
pub mod trust;
