//! Contact as an energy that has no other side: the log barrier, and a search that stays inside (COL-7).
//!
//! # The idea
//!
//! A method has moved the cloth to y as if nothing were in the way. Of all places that are free of contact, which is the nearest? S1 (51) makes it a
//! minimum, with an energy that is infinite where anything touches,
//!
//! F(x) = ½ Σ m_i ‖x_i − y_i‖²/Δt² + Σ_k A_k b(d_k(x)),  b(d) = −κ (d − d̂)² ln(d/d̂) for d < d̂, else 0.
//!
//! d_k are the distances of all pairs (vertex, triangle) and (edge, edge) without a common vertex, and φ − h of every vertex and obstacle with the thickness h. b is
//! [`PenaltyLaw::barrier`], which unlike the logarithm of S1 (52) ends smoothly at d̂, so that only what is near counts. With the distance itself and not its
//! square, as Li et al. have it, the gap of a resting mass has the closed form below. Divided by Δt², the first term makes
//! ∂F = 0 the equation of a step of implicit Euler with contact forces, m (x − y)/Δt² = −Σ A ∂b, so what rests, rests where the
//! barrier alone would hold it: **κ b′(d) = −ρ g** under a cloth of ρ (kg/m²), whatever Δt and the mesh.
//!
//! Weights make b an energy per area: A is the area of the vertex (a third of its triangles), and for two edges the smaller of their areas (likewise). A
//! refined mesh has more and smaller contacts, and the same pressure, up to how its vertices happen to lie: a vertex right above another is near all
//! triangles around it, and counts with each.
//!
//! # The search
//!
//! S1 (53) goes down the gradient. We take Newton's steps, H p = −∂F, and each is *guarded* twice: it ends before anything
//! is nearer than 7/10 of what it was (or of d̂, if it was farther), which [`ContinuousTest`](crate::ContinuousTest) and [`first_contact`](crate::obstacle::first_contact) tell without ever being late, and then before F has
//! stopped falling. So every point of the search, and every point on the straight ways between them, is free of crossings. The end is therefore as untangled as the start,
//! whatever the number of steps, **even if the search is cut short**; the straight way from start to end is not looked at, and need not be free.
//!
//! H is the true Hessian if conjugate gradients find it positive; otherwise what makes pairs indefinite is left out ([`Gap::convex_part`]). Second derivatives of
//! distances come from the stationarity of the nearest points ([`Gap::curvature`]). Edges that are nearly parallel have a [`Mollifier`].
//!
//! Prescribed vertices and obstacles move first, as far as is safe; the free vertices, told of the motion through H, make way; and so on until all have arrived,
//! or there is no way ([`ContactError::NoWay`](cloth_core::contact::ContactError)).
//!
//! # Equation → code
//!
//! | equation | code |
//! |---|---|
//! | d, ∂d, ∂²d, the convex part of −∂²d | [`Gap`] |
//! | m(‖u × v‖²) for two edges u, v | [`Mollifier`] |
//! | A b(d), A m b(d) as elements, with both derivatives | [`VertexTriangleContact`], [`EdgeEdgeContact`] |
//! | which act; Σ A b and its derivatives | `terms` |
//! | H p = −∂F | `newton` |
//! | largest safe part of a step | `guard` |
//! | min F | `minimise` |
//!
//! # Limits
//!
//! - No friction and no restitution: an impact leaves no normal velocity but what the barrier gives back within the step.
//! - One contact can hold up the step of all. A motion much longer than what is between the layers takes many Newton steps, and when they are
//!   spent the cloth stays behind, safe but slower than it should be ([`BarrierReport::outcome`]).
//! - Obstacles push free vertices only. A prescribed one may be inside, where cloth is fixed to a body for instance.
//! - A vertex right above a vertex is an unstable balance, as it is for two balls.
//! - The elastic energy is not in F: the method has had its say, as with any contact at the end of a step.
//!
//! # References
//!
//! - M. Li, Z. Ferguson, T. Schneider, T. Langlois, D. Zorin, D. Panozzo, C. Jiang and D. M. Kaufman, Incremental potential contact, *ACM Transactions on Graphics*
//!   39(4), 2020. DOI 10.1145/3386569.3392425: the barrier, the mollifier, the guarded Newton search.
//! - J. Nocedal and S. J. Wright, *Numerical Optimization*, Springer 2006. DOI 10.1007/978-0-387-40065-5. Chapters 7 and 19.

mod builder;
mod contacts;
mod guard;
mod minimise;
mod newton;
mod terms;

pub use crate::potential::{EdgeEdgeContact, Gap, Mollifier, VertexTriangleContact};
pub use builder::BarrierBuilder;
pub use contacts::{BarrierContacts, BarrierReport};

#[cfg(doc)]
use crate::obstacle::PenaltyLaw;
