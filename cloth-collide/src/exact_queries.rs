//! Continuous queries whose answer is known without any rounding, for tests and for the comparison of methods.
//!
//! All coordinates are whole multiples of a power of two, made by integer arithmetic and short enough for an `f64` to
//! hold them exactly. A contact is built in: two points of the two primitives are made to coincide at a chosen time. Or
//! a gap is: the primitives stay on both sides of a slab, whose thickness is known. Then everything is turned by an
//! integer matrix and moved, also exactly.

mod lattice;

use crate::ccd::{Query, QueryKind};
use cloth_core::math::Real;
use cloth_core::random::SplitMix64;
use lattice::{Builder, Lattice};

/// What is known about a query, exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Truth {
    /// They touch at this time (dimensionless, 0..=1), and perhaps before it too.
    Contact {
        /// The time, exactly.
        time: Real,
    },
    /// They are never nearer than this.
    Apart {
        /// A distance (m), right to a few roundings.
        gap: Real,
    },
}

/// How a query was made. All but the first are degenerate or hard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Nothing special.
    General,
    /// At all times a triangle without area, or two parallel edges.
    Collapsed,
    /// As the last, but for a part in a thousand to a billion.
    NearlyCollapsed,
    /// Everything moves in one plane.
    Planar,
    /// Contact at time 0.
    AtStart,
    /// Contact at time 1.
    AtEnd,
    /// A corner of one meets a corner or an edge of the other, without going through.
    Touching,
    /// General, a thousand kilometres from the origin of space.
    FarAway,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::General,
        Self::Collapsed,
        Self::NearlyCollapsed,
        Self::Planar,
        Self::AtStart,
        Self::AtEnd,
        Self::Touching,
        Self::FarAway,
    ];
}

/// A query and its answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownQuery {
    /// The motion.
    pub query: Query,
    /// The answer.
    pub truth: Truth,
    /// How it was made.
    pub family: Family,
}

/// Endless known queries: every second one touches, and half of these are [`Family::General`], as are half of the
/// others. The same `kind` and seed give the same bits.
#[derive(Clone, Debug)]
pub struct ExactQueries {
    kind: QueryKind,
    random: SplitMix64,
    count: usize,
}

impl ExactQueries {
    /// The sequence that belongs to `seed`.
    #[must_use]
    pub fn new(kind: QueryKind, seed: u64) -> Self {
        Self {
            kind,
            random: SplitMix64::new(seed),
            count: 0,
        }
    }
}

impl Iterator for ExactQueries {
    type Item = KnownQuery;

    fn next(&mut self) -> Option<KnownQuery> {
        let count = self.count;
        self.count += 1;
        let family = match count / 2 {
            half if half % 2 == 0 => Family::General,
            half => Family::ALL[1 + half / 2 % 7],
        };
        let mut build = Builder::new(&mut self.random, family);
        let (motion, truth) = match (self.kind, count % 2) {
            (QueryKind::VertexTriangle, 0) => build.vertex_meets_triangle(),
            (QueryKind::EdgeEdge, 0) => build.edge_meets_edge(),
            (QueryKind::VertexTriangle, _) => build.apart(1),
            (QueryKind::EdgeEdge, _) => build.apart(2),
        };
        let (motion, truth) = build.place(motion, truth);
        let real = |x: [Lattice; 4]| x.map(|x| build.real(x));
        Some(KnownQuery {
            query: Query {
                kind: self.kind,
                from: real(motion.from),
                to: real(motion.to),
            },
            truth,
            family,
        })
    }
}
