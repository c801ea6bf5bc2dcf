//! The conservative continuous test: the first time at which two moving primitives of cloth touch.
//!
//! All vertices move linearly from where they are at the start, time 0, to where they are at the end, time 1.
//! [`ContinuousTest`] never misses a contact.

mod advance;
mod difference;
mod direction;
mod number;
mod query;
mod reach;

pub use query::{Query, QueryKind};

use crate::error::CollideError;
use cloth_core::error::{not_negative, within};
use cloth_core::math::Real;

/// The conservative test: **no contact is missed, and no time of impact is late**, whatever the input. It is asked by
/// [`Query::first_contact`]. The default has no separation and no slack: the first contact, as exactly as can be told.
///
/// # Method
///
/// The differences p − a, p − b, p − c of a vertex to the corners of a triangle are the corners of a moving triangle,
/// those of the ends of two edges of a moving parallelogram. Such a polygon cannot meet the origin over a piece of time
/// in which n(t) · x_k(t) > d |n(t)| for all its corners x_k, with the minimal separation d. The direction n is
/// that from the origin to the nearest feature of the polygon; as this feature moves, so does the direction: for a face
/// the normal u(t) × v(t), for an edge e(t) a direction that stays across it, for a corner the vector to it. Then the
/// left side is a cubic in t, and the convex hull of its four Bernstein coefficients shows how far it is positive. The
/// test goes on to that time and asks again, until there is no time left or no distance.
///
/// This is conservative advancement (Mirtich 1996), where additive advancement (Li et al. 2021) would bound the speed
/// of approach by the largest relative speed of the vertices. Here sliding and turning cost nothing, as the direction
/// goes along. So a step covers most of what is left. How much remains: let τ be the time to the contact. The hull lies
/// below the cubic by O(τ²), so the step ends O(τ²) before the contact, and a simple contact is approached
/// quadratically. An inclusion test (Wang et al. 2021) halves boxes in time and in both parameters of the polygon;
/// here, whatever its parameters, a polygon on one side of a plane is done with at once.
///
/// Only the sign of the products n · x_k proves anything, not the way in which n was found. So everything about
/// rounding is in a few lines, and its allowance is subtracted (`src/ccd/reach.rs` has the proof). Where `f64` cannot
/// tell near from touching, and d = 0, the walk goes on with double-double numbers (unevaluated sums of two `f64`),
/// which can tell apart what is further than about 1e-29 of the size of the motion.
///
/// # What is guaranteed
///
/// - The distance is larger than d at all times before the returned one, and at it (at time 0 there may be no such
///   moment). If nothing is returned, during the whole motion.
/// - The time is 0 only if the distance at the start is not larger than d, to rounding: 1e-14 of the size of the
///   motion, or for d = 0 1e-29.
/// - At most [`ContinuousTest::MOST_STEPS`] steps of constant cost each, on any input: 96 in `f64` for d > 0, 32 for
///   d = 0 and then 64 with double-double numbers. If they are used up, the time is that reached so far
///   ([`Stop::Budget`]): early, never late. [`potential`](crate::potential) takes it for a contact: the path is cut
///   there, or the pair counts as too near. That costs progress, not safety.
///
/// # False positives
///
/// None in 40 000 queries that have a gap, with d = 0: 20 000 of each [kind](QueryKind), among them parallel edges,
/// triangles without area or nearly so, motions in one plane, and places far from the origin. The test
/// `nothing_is_reported_where_there_is_a_gap` (`tests/all/ccd.rs`) asks them. Nor is there one with a positive d
/// smaller than the gap by a thousandth and rounding (`separation_just_below_the_gap_is_kept`). Of other methods
/// `cargo run --release -p cloth-bench -- ccd --kind ee --generate 10000 --method cubic` (or `additive`, `--kind vf`)
/// counts false positives, contacts that are missed and times that are late.
///
/// One is possible in three ways, each of them on the safe side: a pass nearer than can be told (the limits below),
/// steps that are used up ([`Stop::Budget`]), and, for d = 0, a motion in which the origin goes through the inside of
/// the face as far as `f64` can tell, which counts as a contact without a finer test. With a slack, [`Stop::Slack`] is
/// no claim of contact: the distance has come down to what was asked for.
///
/// # How many steps
///
/// | motion | steps |
/// |---|---|
/// | the differences stay farther than d from the origin along an axis | 0 |
/// | sliding: all move as one, in the plane of the face or along parallel edges | 1 |
/// | all move as one, on course for a face | 2, but for rounding |
/// | all move as one and graze, at a distance δ > d | 2 for d = 0; about 2 + ½ log₂(δ/(2(δ − d))) for d > 0 |
/// | the direction turns, on course for a face | quadratic convergence |
/// | the direction turns, a graze at δ, d = 0 | about log₂ √(size/δ): 27 where `f64` ends, 48 where twice the digits end |
///
/// Edges that are parallel are no special case: any of their nearest points gives the same n, and only n is used. In
/// the fourth row let a be the length of path left to the place where the two are nearest. The direction of a step is
/// that to the nearest point at its start, and certifies the motion until the length that is left is
/// (d √(a² + δ²) − δ²)/a. For d = 0 that is negative: the first step passes.
/// For d > 0 it is about a/2 − δ (δ − d)/a once a is below δ: a is halved until a² < 2 δ (δ − d). In the last row a
/// cubic nearly has a double root. Its control polygon begins along its tangent, which meets zero half of the way to a
/// double root. So what is left of the time, τ, is halved until τ² is as small as δ/size.
///
/// # Limits
///
/// - A pass at a distance below the above is reported as a contact.
/// - For d > 0, steps shrink with the square root of (distance − d)/d while the direction n turns. Let a step turn it
///   by θ. The bound on |n| by its coefficients is then too large by a fraction of the order of θ², so d |n| is
///   overestimated by d θ². The step is certified only while that stays below what there is to spare, the distance less
///   d. So θ is at most of the order of √((distance − d)/d), and the step, in which n turns at a steady rate, shrinks
///   with it.
/// - With a slack above 0, a start at less than about 1e-6 of the size of the motion can use up the steps, and then the
///   time is early by more than the slack asks for. Without slack and separation this has not been seen.
/// - A contact during the motion is found. A vertex that is on the wrong side of a sheet at the start, without touching
///   it, is left there: the test compares distances, and knows no sides.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContinuousTest {
    separation: Real,
    slack: Real,
}

/// A contact, or a moment from which on a contact cannot be excluded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Time as a fraction of the step (dimensionless, 0..=1). Never late.
    pub time: Real,
    /// Why there.
    pub stop: Stop,
}

/// Why the walk through time ended before the end of the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The distance is not larger than the separation, as far as can be told.
    Contact,
    /// What the distance exceeds the separation by has shrunk to the given fraction of its first value.
    Slack,
    /// The steps were used up.
    Budget,
}

impl ContinuousTest {
    /// No query takes more steps than this.
    pub const MOST_STEPS: u32 = advance::MOST_STEPS;

    /// A test for the first time at which the distance is down to `separation` d (m, not negative), or to
    /// d + `slack` · (first distance − d). The `slack` (dimensionless, from 0 to below 1) is what a line search wants
    /// to keep for its next step; with 0 the two come as near as rounding allows.
    ///
    /// # Errors
    /// [`CollideError::OutOfRange`] if they are not in these ranges.
    pub fn new(separation: Real, slack: Real) -> Result<Self, CollideError> {
        not_negative("separation (m)", separation)?;
        let is_right = (0.0..1.0).contains(&slack);
        within(is_right, "slack", slack, "in the range from 0 to below 1")?;
        Ok(Self { separation, slack })
    }
}
