//! The stitch: a vertex that is drawn to another one, or to a point of an edge, and then held there.

use super::Spring;
use crate::element::{Constraint, Convexity, Element, Projective, Row, RowForm, VectorRow};
use crate::error::{OutOfRange, finite, number};
use crate::math::{Blocks, Mat3, Real, Vec3, across_pair, gather, length_and_direction};

/// A spring between a vertex and another one (N = 2), or a point of the edge between two others (N = 3), whose rest
/// length L falls to zero: `E = ½ k (‖Σ qᵢ xᵢ‖ − L(t))²` (J), with the weights `q = (1, −1)` or `(1, f − 1, −f)`.
///
/// ```text
/// L(t) = L₀                                   until `from`
/// L(t) = L₀ (until − t)/(until − from)        between
/// L(t) = 0                                    after it: E = ½ k ‖Σ qᵢ xᵢ‖²
/// ```
///
/// The weights have the sum zero, and the forces act along `Σ qᵢ xᵢ`: a stitch changes neither momentum nor angular
/// momentum, at any L. Once it is closed the energy is quadratic, with a gradient and a Hessian (`k qᵢqⱼ I`) where the
/// two points coincide too, and its rows are the three coordinates of `Σ qᵢ xᵢ`. While it closes it has one row, that
/// of a [`Spring`] of length L, and two that are zero everywhere.
///
/// The matrix of projective dynamics has k in it and not L, so it stays as it is while the stitch closes. Methods tell
/// the time by [`Element::set_time`].
///
/// Limits: the stiffness is finite, so that a force F leaves the points F/k apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stitch<const N: usize = 2> {
    vertices: [u32; N],
    /// q (dimensionless).
    weights: [Real; N],
    stiffness: Real,
    start_length: Real,
    from: Real,
    until: Real,
    /// L (m) at the time that was set last.
    rest_length: Real,
}

impl Stitch {
    /// A stitch of `stiffness` k (N/m) between two vertices, closed from the start on.
    #[must_use]
    pub fn pair(vertices: [u32; 2], stiffness: Real) -> Self {
        Self::closed(vertices, [1.0, -1.0], stiffness)
    }
}

impl Stitch<3> {
    /// A stitch of `stiffness` k (N/m) between the first vertex and the point at `fraction` f of the way from the
    /// second to the third, closed from the start on.
    #[must_use]
    pub fn onto_edge(vertices: [u32; 3], fraction: Real, stiffness: Real) -> Self {
        Self::closed(vertices, [1.0, fraction - 1.0, -fraction], stiffness)
    }
}

impl<const N: usize> Stitch<N> {
    fn closed(vertices: [u32; N], weights: [Real; N], stiffness: Real) -> Self {
        Self {
            vertices,
            weights,
            stiffness,
            start_length: 0.0,
            from: 0.0,
            until: 0.0,
            rest_length: 0.0,
        }
    }

    /// The same with a rest length that falls from `start_length` L₀ (m) to zero between two times (s); at once if they
    /// are the same. It begins with L₀.
    #[must_use]
    pub fn closing(self, start_length: Real, [from, until]: [Real; 2]) -> Self {
        Self {
            start_length,
            from,
            until,
            rest_length: start_length,
            ..self
        }
    }

    /// The vector (m) between its two points where the cloth is at `positions` (m).
    ///
    /// # Panics
    /// If there is no position of one of its vertices.
    #[must_use]
    pub fn gap(&self, positions: &[Vec3]) -> Vec3 {
        self.between(&gather(positions, self.vertices))
    }

    /// `Σ qᵢ xᵢ` (m).
    #[inline(always)]
    fn between(&self, x: &[Vec3; N]) -> Vec3 {
        self.as_vector_row().value(x)
    }

    /// Rest length L (m) at a time (s).
    #[must_use]
    pub fn rest_length_at(&self, time: Real) -> Real {
        if time >= self.until {
            0.0
        } else if time <= self.from {
            self.start_length
        } else {
            self.start_length * ((self.until - time) / (self.until - self.from))
        }
    }

    /// When it is closed (s).
    #[must_use]
    pub fn until(&self) -> Real {
        self.until
    }

    /// Stiffness k (N/m).
    #[must_use]
    pub fn stiffness(&self) -> Real {
        self.stiffness
    }

    /// What it is while it closes, from `Σ qᵢ xᵢ` to the origin.
    #[inline(always)]
    fn spring(&self) -> Spring {
        Spring {
            vertices: [self.vertices[0], self.vertices[1]],
            rest_length: self.rest_length,
            stiffness: self.stiffness,
        }
    }

    #[inline(always)]
    fn is_closed(&self) -> bool {
        self.rest_length == 0.0
    }

    #[inline(always)]
    fn as_vector_row(&self) -> VectorRow<N> {
        VectorRow {
            coefficients: self.weights,
            target: Vec3::zeros(),
            stiffness: self.stiffness,
        }
    }

    /// What a matrix for `Σ qᵢ xᵢ`, in the first block of a spring, is for the vertices.
    #[inline]
    fn spread(&self, [[matrix, _], _]: Blocks<2>) -> Blocks<N> {
        let q = &self.weights;
        std::array::from_fn(|i| std::array::from_fn(|j| matrix * (q[i] * q[j])))
    }
}

/// The stitches of a seam.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seam {
    /// From vertex to vertex.
    pub pairs: Vec<Stitch>,
    /// From a vertex to a point of an edge.
    pub onto_edges: Vec<Stitch<3>>,
}

impl Seam {
    /// The same with stitches that close between two times (s), from the lengths that they have at `positions` (m).
    ///
    /// # Panics
    /// If there is no position of a vertex.
    #[must_use]
    pub fn closing(self, positions: &[Vec3], times: [Real; 2]) -> Self {
        fn all<const N: usize>(
            stitches: Vec<Stitch<N>>,
            x: &[Vec3],
            times: [Real; 2],
        ) -> Vec<Stitch<N>> {
            let stitches = stitches.into_iter();
            let closing = |stitch: Stitch<N>| stitch.closing(stitch.gap(x).norm(), times);
            stitches.map(closing).collect()
        }
        Self {
            pairs: all(self.pairs, positions, times),
            onto_edges: all(self.onto_edges, positions, times),
        }
    }

    /// The vectors (m) between the two points of each stitch, where the cloth is at `positions` (m).
    ///
    /// # Panics
    /// If there is no position of a vertex.
    pub fn gaps<'a>(&'a self, positions: &'a [Vec3]) -> impl Iterator<Item = Vec3> + 'a {
        let pairs = self.pairs.iter().map(|stitch| stitch.gap(positions));
        let onto_edges = self.onto_edges.iter();
        pairs.chain(onto_edges.map(|stitch| stitch.gap(positions)))
    }

    /// Vertices that are sewn to another one.
    #[must_use]
    pub fn sewn_pairs(&self) -> Vec<[u32; 2]> {
        self.pairs.iter().map(Element::vertices).collect()
    }

    /// Vertices that are sewn onto an edge, each with the two ends of that.
    #[must_use]
    pub fn sewn_onto_edges(&self) -> Vec<[u32; 3]> {
        self.onto_edges.iter().map(Element::vertices).collect()
    }
}

impl<const N: usize> Element<N> for Stitch<N> {
    const CHANGES_WITH_TIME: bool = true;

    #[inline(always)]
    fn vertices(&self) -> [u32; N] {
        self.vertices
    }

    fn set_time(&mut self, time: Real) {
        self.rest_length = self.rest_length_at(time);
    }

    fn check(&self) -> Result<(), OutOfRange> {
        finite("rest length (m)", self.rest_length)?;
        number("stiffness", self.stiffness)?;
        Ok(())
    }
}

impl<const N: usize> Constraint<N> for Stitch<N> {
    type Rows = [Row<N>; 3];

    #[inline]
    fn rows(&self, x: &[Vec3; N]) -> [Row<N>; 3] {
        if self.is_closed() {
            return self.as_vector_row().rows(x);
        }
        let [row] = self.spring().rows(&[self.between(x), Vec3::zeros()]);
        let [direction, _] = row.gradient;
        let closing = Row {
            value: row.value,
            gradient: self.weights.map(|q| direction * q),
            stiffness: self.stiffness,
        };
        let none = Row {
            value: 0.0,
            gradient: [Vec3::zeros(); N],
            ..closing
        };
        [closing, none, none]
    }

    #[inline]
    fn geometric_stiffness(
        &self,
        x: &[Vec3; N],
        multipliers: &[Real],
        convexity: Convexity,
    ) -> Blocks<N> {
        if self.is_closed() {
            return [[Mat3::zeros(); N]; N];
        }
        let ends = [self.between(x), Vec3::zeros()];
        let spring = self.spring();
        self.spread(spring.geometric_stiffness(&ends, multipliers, convexity))
    }

    #[inline(always)]
    fn row_form(&self, _: &[Vec3; N]) -> RowForm<N> {
        match self.is_closed() {
            true => RowForm::Vector(self.as_vector_row()),
            false => RowForm::General,
        }
    }

    #[inline]
    fn curvature(&self, x: &[Vec3; N], convexity: Convexity) -> Blocks<N> {
        if self.is_closed() {
            return [[Mat3::zeros(); N]; N];
        }
        let ends = [self.between(x), Vec3::zeros()];
        self.spread(self.spring().curvature(&ends, convexity))
    }

    /// That of a [`Spring`], `k |l − L|/L` across it with the predicted length l, would be without a bound as L falls to
    /// zero, and a step of any size would then count as none. Divided by |l| where that is more than L it is at most
    /// 2 k, and k where the stitch is closed.
    #[inline]
    fn mixed_curvature(&self, x: &[Vec3; N], from: &[Vec3; N], to: &[Vec3; N]) -> Blocks<N> {
        if self.is_closed() {
            return [[Mat3::zeros(); N]; N];
        }
        let [x, from, to] = [x, from, to].map(|x| [self.between(x), Vec3::zeros()]);
        let spring = self.spring();
        let (_, n) = length_and_direction(x[0], spring.vertices);
        let predicted = spring.predicted_length(&from, &to);
        let strain = (predicted - self.rest_length) / predicted.abs().max(self.rest_length);
        self.spread(across_pair(n, self.stiffness * strain.abs()))
    }
}

/// The set is the sphere of radius L, in the end its centre. It is not announced as a sphere: a solver may keep the
/// radius of one for good.
impl<const N: usize> Projective<N, 1> for Stitch<N> {
    #[inline]
    fn operator(&self) -> [[Real; N]; 1] {
        [self.weights]
    }

    #[inline]
    fn weight(&self) -> Real {
        self.stiffness
    }

    #[inline]
    fn project(&self, z: [Vec3; 1]) -> [Vec3; 1] {
        self.spring().project(z)
    }

    #[inline]
    fn projected_hessian(&self, z: [Vec3; 1]) -> [[Mat3; 1]; 1] {
        self.spring().projected_hessian(z)
    }
}
