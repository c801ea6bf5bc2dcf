//! Contact as a potential: an energy per area of the distance to the nearest piece, which every method can take into its own solve.
//!
//! # The idea
//!
//! Cloth that touches something is pressed against it, and the pressure depends on how near it is: p = −φ′(d), with an energy φ (J/m²) that begins at the
//! thickness h and whose stiffness κ (Pa/m) is a number of the scene, the same for every method, resolution and step. Each contact weighs in with the area A that it
//! stands for, so
//!
//! E(x) = Σ A φ(d(x)),
//!
//! over all pairs (vertex, triangle), (edge, edge) and (vertex, obstacle) that are nearer than h. φ is quadratic down to h/2 and a barrier from there on
//! ([`PenaltyLaw::two_stage`]): under a weight ρ g the gap is h − ρ g/κ, and nothing gets to d = 0.
//!
//! A method adds E to what it minimises, with its gradient, and the Gauss–Newton part of its second derivative, A φ″ ∂d ∂dᵀ. Before it
//! moves the cloth it asks how far the way is safe ([`ContinuousTest`](crate::ContinuousTest)). So what it accepts is free of crossings, and nothing is
//! left to be repaired afterwards.
//!
//! # Equation → code
//!
//! | equation | code |
//! |---|---|
//! | φ, φ′, φ″ | [`PenaltyLaw`] |
//! | d, ∂d, ∂²d | [`Gap`] |
//! | m(‖u × v‖²) for two edges u, v | [`Mollifier`] |
//! | A φ(d), A m φ(d) as elements, with both derivatives | [`VertexTriangleContact`], [`EdgeEdgeContact`] |
//! | which pairs can be near on a way | `near` |
//! | how far the way is safe | `limit` |
//! | Σ A φ, Σ A ∂φ | [`PotentialContacts`] |

mod friction;
mod gap;
mod mollifier;
mod near;
mod pair;
mod source;

pub use gap::Gap;
pub use mollifier::Mollifier;
pub use pair::{EdgeEdgeContact, VertexTriangleContact};
pub use source::{PotentialBuilder, PotentialContacts, PotentialReport};

#[cfg(doc)]
use crate::obstacle::PenaltyLaw;
