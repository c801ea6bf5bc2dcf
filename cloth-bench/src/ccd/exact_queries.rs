//! Continuous queries whose answer is known without any rounding, for tests and for the comparison of methods.
//!
//! All coordinates are whole multiples of a power of two, made by integer arithmetic and short enough for an `f64` to
//! hold them exactly. A contact is built in: two points of the two primitives are made to coincide at a chosen time. Or
//! a gap is: the primitives stay on both sides of a slab, whose thickness is known. Then everything is turned by an
//! integer matrix and moved, also exactly.

use cloth_collide::{Query, QueryKind};
use cloth_core::math::{Real, Vec3};
use cloth_core::random::SplitMix64;

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

/// A point on the lattice (units of the builder).
type Lattice = [i128; 3];

/// Parts into which time and the parameters of an edge are divided.
const PARTS: i128 = 32;

/// Corners are multiples of this, so that a point at a fraction of a line, three times over, is whole.
const CELL: i128 = PARTS * LINE;

/// Points at a fraction of a line between corners are multiples of this.
const LINE: i128 = PARTS * PARTS * PARTS;

/// Four moving points.
#[derive(Clone, Copy, Debug)]
struct Motion {
    from: [Lattice; 4],
    to: [Lattice; 4],
}

/// Draws queries of one family.
struct Builder<'a> {
    random: &'a mut SplitMix64,
    family: Family,
    /// Largest coordinate of a corner (cells).
    extent: i128,
    /// Length of a unit (m): a power of two.
    unit: Real,
}

fn plus(a: Lattice, b: Lattice) -> Lattice {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn times(factor: i128, a: Lattice) -> Lattice {
    a.map(|x| factor * x)
}

/// a + (b − a) · part / PARTS, which has to be whole.
fn between(a: Lattice, b: Lattice, part: i128) -> Lattice {
    [0, 1, 2].map(|i| {
        let scaled = a[i] * (PARTS - part) + b[i] * part;
        debug_assert!(scaled % PARTS == 0);
        scaled / PARTS
    })
}

impl<'a> Builder<'a> {
    fn new(random: &'a mut SplitMix64, family: Family) -> Self {
        let mut builder = Self {
            random,
            family,
            extent: 0,
            unit: 1.0,
        };
        // So that nothing exceeds 2⁵³ units, also after `place`.
        let far = family == Family::FarAway;
        builder.extent = 1 << builder.draw(2, if far { 14 } else { 24 });
        let exponent = if far { -30 } else { builder.draw(-90, 40) };
        builder.unit = (2.0 as Real).powi(exponent as i32);
        builder
    }

    /// A whole number from `low` to `high`, both included.
    fn draw(&mut self, low: i128, high: i128) -> i128 {
        low + i128::from(self.random.next_bits() >> 1) % (high - low + 1)
    }

    /// Coordinates that coincide often if the extent is small.
    fn corner(&mut self) -> Lattice {
        let planar = self.family == Family::Planar;
        let mut coordinate = || CELL * self.draw(-self.extent, self.extent);
        let [x, y, z] = [coordinate(), coordinate(), coordinate()];
        [x, y, if planar { 0 } else { z }]
    }

    /// A corner at both times; in one of four cases it stands still.
    fn moving(&mut self) -> [Lattice; 2] {
        let start = self.corner();
        let end = if self.draw(0, 3) == 0 {
            start
        } else {
            self.corner()
        };
        [start, end]
    }

    fn part_of_time(&mut self) -> i128 {
        match self.family {
            Family::AtStart => 0,
            Family::AtEnd => PARTS,
            _ => self.draw(0, PARTS),
        }
    }

    /// A fraction of an edge: sometimes an end.
    fn part(&mut self) -> i128 {
        match self.draw(0, 7) {
            0 => 0,
            1 => PARTS,
            _ => self.draw(0, PARTS),
        }
    }

    /// By how much a nearly collapsed thing is off the line (units).
    fn thickness(&mut self) -> i128 {
        match self.family {
            Family::NearlyCollapsed => {
                let part = (CELL * self.extent) >> self.draw(10, 30);
                (part / LINE).max(1) * LINE
            }
            _ => 0,
        }
    }

    /// A third point on the line through two, at all times; off it by the thickness.
    fn nearly_on_line(&mut self, [a, b]: [[Lattice; 2]; 2]) -> [Lattice; 2] {
        let part = self.draw(-PARTS, 2 * PARTS);
        let off = self.thickness();
        let direction = [0; 3].map(|_| self.draw(-1, 1));
        [0, 1].map(|at| plus(between(a[at], b[at], part), times(off, direction)))
    }

    /// A vertex that comes through a point of a triangle.
    fn vertex_meets_triangle(&mut self) -> (Motion, Truth) {
        if self.family == Family::Touching {
            return self.touching(1);
        }
        let (a, b) = (self.moving(), self.moving());
        let c = match self.family {
            Family::Collapsed | Family::NearlyCollapsed => self.nearly_on_line([a, b]),
            _ => self.moving(),
        };
        let j = self.part_of_time();
        // First a point of ab, then one of the line from it to c.
        let (k, l) = (self.part(), self.part());
        let [at_a, at_b, at_c] = [a, b, c].map(|[from, to]| between(from, to, j));
        let point = between(between(at_a, at_b, k), at_c, l);
        let [p0, p1] = self.through(point, j);
        let motion = Motion {
            from: [p0, a[0], b[0], c[0]],
            to: [p1, a[1], b[1], c[1]],
        };
        (motion, contact(j))
    }

    /// A path through `point` at the part `j` of time.
    fn through(&mut self, point: Lattice, j: i128) -> [Lattice; 2] {
        let part = self.corner().map(|x| x / PARTS);
        [
            plus(point, times(-j, part)),
            plus(point, times(PARTS - j, part)),
        ]
    }

    /// An edge that comes through a point of another.
    fn edge_meets_edge(&mut self) -> (Motion, Truth) {
        if self.family == Family::Touching {
            return self.touching(2);
        }
        let (a, b) = (self.moving(), self.moving());
        let j = self.part_of_time();
        let (k, l) = (self.part(), self.part());
        let at_contact = [a, b].map(|[from, to]| between(from, to, j));
        let point = between(at_contact[0], at_contact[1], k);
        let path = self.through(point, j);
        // The vector of the second edge at both times.
        let edge = match self.family {
            Family::Collapsed | Family::NearlyCollapsed => {
                let factor = [-2, -1, 1, 2, 0][self.draw(0, 4) as usize];
                let off = self.thickness();
                let direction = [0; 3].map(|_| self.draw(-1, 1));
                [0, 1].map(|at| {
                    let along = plus(b[at], times(-1, a[at]));
                    plus(times(factor, along), times(off, direction))
                })
            }
            _ => self.moving(),
        };
        let end = |at: usize, part: i128| plus(path[at], edge[at].map(|e| e / PARTS * part));
        let motion = Motion {
            from: [a[0], b[0], end(0, -l), end(0, PARTS - l)],
            to: [a[1], b[1], end(1, -l), end(1, PARTS - l)],
        };
        (motion, contact(j))
    }

    /// The first `count` points above the plane z = 0, the others below it, one of each in it and at the same place at
    /// the same time.
    fn touching(&mut self, count: usize) -> (Motion, Truth) {
        let mut motion = self.on_both_sides(count, 0);
        let j = self.part_of_time();
        // The last point is carried to where the first one is at that time.
        let [x, y, _] = between(motion.from[0], motion.to[0], j);
        let path = self.through([x, y, 0], j);
        for i in 0..2 {
            motion.from[3][i] = path[0][i];
            motion.to[3][i] = path[1][i];
        }
        (motion, contact(j))
    }

    /// As `touching`, but apart by a gap along z, and with the feet of the two points free.
    fn apart(&mut self, count: usize) -> (Motion, Truth) {
        let gap = 1 << self.draw(0, 12);
        let motion = self.on_both_sides(count, gap);
        (motion, Truth::Apart { gap: gap as Real })
    }

    /// The first `count` points at z ≥ `gap`, the first of them at z = gap; the others at z ≤ 0, the last of them at z
    /// = 0. Some families bend further points towards lines or planes, if this keeps the sides.
    fn on_both_sides(&mut self, count: usize, gap: i128) -> Motion {
        let points = [0; 4].map(|_| self.moving());
        let mut motion = Motion {
            from: points.map(|x| x[0]),
            to: points.map(|x| x[1]),
        };
        let flat = self.family == Family::Planar;
        for k in 0..4 {
            for x in [&mut motion.from[k], &mut motion.to[k]] {
                let height = if k == 0 || k == 3 { 0 } else { x[2].abs() };
                x[2] = if k < count { gap + height } else { -height };
                if flat {
                    x[1] = 0;
                }
            }
        }
        if matches!(self.family, Family::Collapsed | Family::NearlyCollapsed) {
            // All at the heights of the slab: parallel edges, or a triangle that is a line.
            for x in [&mut motion.from, &mut motion.to] {
                if count == 2 {
                    x[1] = plus(x[0], times(2, plus(x[2], times(-1, x[3]))));
                    x[1][2] = gap;
                    x[2][2] = 0;
                } else {
                    x[2] = plus(x[1], times(-1, plus(x[3], times(-1, x[1]))));
                }
            }
        }
        motion
    }

    /// Turns by an integer matrix, moves along, and away in the family that asks for it.
    fn place(&mut self, motion: Motion, truth: Truth) -> (Motion, Truth) {
        let quaternion = [0; 4].map(|_| self.draw(-2, 2));
        let norm: i128 = quaternion.iter().map(|q| q * q).sum();
        let [w, x, y, z] = if norm == 0 { [1, 0, 0, 0] } else { quaternion };
        let norm = norm.max(1);
        // The rotation by a quaternion, times its squared norm.
        let matrix = [
            [
                w * w + x * x - y * y - z * z,
                2 * (x * y - w * z),
                2 * (x * z + w * y),
            ],
            [
                2 * (x * y + w * z),
                w * w - x * x + y * y - z * z,
                2 * (y * z - w * x),
            ],
            [
                2 * (x * z - w * y),
                2 * (y * z + w * x),
                w * w - x * x - y * y + z * z,
            ],
        ];
        let drift = if self.draw(0, 1) == 0 {
            [0; 3]
        } else {
            self.corner()
        };
        let away = match self.family {
            // A million metres.
            Family::FarAway => (1e6 / self.unit) as i128,
            _ => 0,
        };
        let turned =
            |p: Lattice| matrix.map(|row| (0..3).map(|i| row[i] * p[i]).sum::<i128>() + away);
        let moved = Motion {
            from: motion.from.map(turned),
            to: motion.to.map(|p| turned(plus(p, drift))),
        };
        let truth = match truth {
            Truth::Apart { gap } => Truth::Apart {
                gap: gap * norm as Real * self.unit,
            },
            contact => contact,
        };
        (moved, truth)
    }

    /// In metres.
    ///
    /// # Panics
    /// If an `f64` cannot hold a coordinate: then the limits on the extent are wrong.
    fn real(&self, point: Lattice) -> Vec3 {
        let coordinate = |x: i128| {
            let rounded = x as Real;
            assert!(rounded as i128 == x, "{x} units are not exact");
            rounded * self.unit
        };
        point.map(coordinate).into()
    }
}

/// Contact at the part `j` of time.
fn contact(j: i128) -> Truth {
    Truth::Contact {
        time: j as Real / PARTS as Real,
    }
}
