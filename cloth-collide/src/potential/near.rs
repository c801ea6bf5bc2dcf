//! What the parts of a cloth stand for in contact: areas, laws, and who is free.

use super::excluded::Excluded;
use super::mollifier::Mollifier;
use super::pinched::Pinched;
use super::sewn::Sewn;
use crate::broad_phase::{BroadPhaseKind, TrianglePairs};
use crate::ccd::QueryKind;
use crate::error::NonFinite;
use crate::incidence::Incidence;
use crate::obstacle::PenaltyLaw;
use crate::pair::{Gap, Pair};
use crate::separation::meet_unduly;
use cloth_core::contact::ContactError;
use cloth_core::math::{Real, Vec3, gather, is_finite};
use cloth_core::mesh::TriMesh;
use cloth_core::method::pieces::Pieces;
use cloth_core::topology::joined;

/// Fraction of the thickness that coordinates have to resolve: the length below which friction is a spring.
const RESOLVED: Real = 0.01;

/// What a vertex of a body's surface knows of its body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// By how much (m) the signed distance may be off that keeps the vertices of the cloth out as well; infinite if
    /// there is none.
    pub(super) error_bound: Real,
    /// Coefficient of friction μ (dimensionless).
    pub(super) friction: Real,
    /// Its number: obstacles first, then animated surfaces.
    pub(super) body: usize,
}

impl Side {
    /// Whether there is a signed distance, but not an exact one.
    fn is_off(&self) -> bool {
        self.error_bound > 0.0 && self.error_bound < Real::INFINITY
    }
}

/// What the cloth has of its own.
#[derive(Clone, Debug, Default)]
pub(crate) struct Own {
    /// Thickness (m) and coefficient of friction μ (dimensionless) of each vertex; empty where all are alike.
    pub(super) thicknesses: Vec<Real>,
    pub(super) frictions: Vec<Real>,
    /// Coefficient μ of cloth on cloth (dimensionless).
    pub(super) friction: Real,
    pub(super) self_collision: bool,
    pub(super) excluded: Excluded,
    pub(crate) sewn: Sewn,
    pub(super) broad_phase: BroadPhaseKind,
    pub(super) pinched_passes: bool,
    /// Whether edges push from the thickness on, as vertices do, and vertices with all of their area.
    pub(super) full_thickness: bool,
}

/// Areas and laws of the parts of a cloth and of the surfaces of bodies, and which vertices are not prescribed.
#[derive(Clone, Debug)]
pub(crate) struct Near {
    /// That with the largest range: what is farther apart than it does not touch.
    pub(crate) law: PenaltyLaw,
    /// Number of vertices of the cloth; what follows are those of surfaces of bodies.
    pub(crate) cloth: usize,
    surfaces: Vec<Side>,
    pub(crate) own: Own,
    pub(super) incidence: Incidence,
    /// A third of the rest area of the triangles around each vertex, and around each edge (m²).
    pub(super) vertex_area: Vec<Real>,
    pub(super) edge_area: Vec<Real>,
    rest: Vec<Vec3>,
    /// The connected component that each vertex belongs to.
    pub(super) component: Vec<u32>,
    /// The same of those of the cloth, for their motion.
    pub(super) components: Pieces,
    pub(super) is_free: Vec<bool>,
    /// Prescribed vertices that have not been seen to move: nothing is detected between them.
    resting: Vec<u32>,
    /// Whether no vertex of a body moves in the (sub)step at hand.
    pub(super) bodies_rest: bool,
    pub(super) is_resting: Vec<bool>,
    pub(super) crossing: Excluded,
    pub(super) pinched: Pinched,
    /// Prescribed vertices in bodies, or at them: the triangles around them pass through.
    pub(super) prescribed_inside: Pinched,
    /// None if the cloth cannot touch itself.
    triangle_pairs: Option<TrianglePairs>,
}

impl Near {
    /// Of a mesh that ends with the vertices of `surfaces`.
    pub(super) fn new(mesh: &TriMesh, law: PenaltyLaw, surfaces: Vec<Side>, own: Own) -> Self {
        let incidence = Incidence::new(mesh);
        let mut vertex_area = vec![0.0; mesh.vertex_count()];
        let mut edge_area = vec![0.0; incidence.edges.len()];
        let around = mesh.triangles().iter().zip(&incidence.triangle_edges);
        for ((corners, edges), area) in around.zip(mesh.areas()) {
            for (vertex, edge) in corners.iter().zip(edges) {
                vertex_area[*vertex as usize] += area / 3.0;
                edge_area[*edge as usize] += area / 3.0;
            }
        }
        let cloth = mesh.vertex_count() - surfaces.len();
        let any = own.self_collision || !surfaces.is_empty();
        let component = joined(mesh.vertex_count(), incidence.edges.iter().copied());
        Self {
            law,
            cloth,
            surfaces,
            own,
            components: Pieces::new(&component[..cloth]),
            component,
            incidence,
            vertex_area,
            edge_area,
            rest: mesh.positions().to_vec(),
            is_free: vec![true; mesh.vertex_count()],
            resting: Vec::new(),
            bodies_rest: false,
            is_resting: vec![false; mesh.vertex_count()],
            crossing: Excluded::default(),
            pinched: Pinched::default(),
            prescribed_inside: Pinched::default(),
            triangle_pairs: any.then(|| TrianglePairs::new(mesh)),
        }
    }

    /// Takes over which vertices are prescribed, by their inverse masses (1/kg), and tells whether they were others
    /// before.
    pub(super) fn begin(&mut self, inverse_mass: &[Real]) -> bool {
        let mut changed = false;
        for (free, w) in self.is_free.iter_mut().zip(inverse_mass) {
            changed |= std::mem::replace(free, *w > 0.0) != *free;
        }
        if changed {
            let prescribed = (0u32..).zip(&self.is_free).filter(|(_, free)| !**free);
            self.resting.clear();
            self.resting.extend(prescribed.map(|(vertex, _)| vertex));
            let all = self.is_resting.iter_mut().zip(&self.is_free);
            all.for_each(|(resting, free)| *resting = !free);
        }
        changed
    }

    /// Records prescribed vertices that begin to move, from `from` to `to` (m). Returns whether there are any:
    /// what was found without them is not all.
    pub(super) fn starts_moving(&mut self, from: &[Vec3], to: &[Vec3]) -> bool {
        let count = self.resting.len();
        // They are in order, those of bodies last.
        let may_move = match self.bodies_rest {
            true => self.resting.partition_point(|&v| (v as usize) < self.cloth),
            false => count,
        };
        let moves = |&v: &u32| from[v as usize] != to[v as usize];
        if !self.resting[..may_move].iter().any(moves) {
            return false;
        }
        let is_resting = &mut self.is_resting;
        self.resting.retain(|&vertex| {
            let v = vertex as usize;
            is_resting[v] = from[v] == to[v];
            is_resting[v]
        });
        self.resting.len() < count
    }

    /// How many of `count` vertices, the first ones, may move in the (sub)step at hand.
    pub(super) fn may_move(&self, count: usize) -> usize {
        if self.bodies_rest { self.cloth } else { count }
    }

    /// What there is of the cloth alone.
    pub(super) fn own<'a>(&self, of_all: &'a [Vec3]) -> &'a [Vec3] {
        &of_all[..self.cloth]
    }

    /// m of two edges.
    pub(super) fn mollifier(&self, vertices: [u32; 4]) -> Mollifier {
        let [a, b, c, d] = gather(&self.rest, vertices);
        Mollifier::new([(b - a).norm_squared(), (d - c).norm_squared()])
    }

    /// The area (m²) that a pair stands for at `x` (m).
    pub(super) fn area_of(&self, pair: Pair, area_at_rest: Real, x: &[Vec3; 4]) -> Real {
        match pair.kind {
            QueryKind::VertexTriangle => area_at_rest,
            QueryKind::EdgeEdge => area_at_rest * self.mollifier(pair.vertices).at(x).0,
        }
    }

    /// That no triangles meet at `x` (m) that should not. One of the cloth that meets a body may, if a corner of it is
    /// prescribed: nothing could part them, so its prescribed corners pass through that body from now on.
    pub(super) fn check_crossing(&mut self, x: &[Vec3]) -> Result<(), ContactError> {
        self.find_triangles(x)?;
        let crosses = |pair: &[[u32; 3]; 2]| {
            let vertices = pair.as_flattened();
            let is_free = vertices.iter().any(|&v| self.is_free[v as usize]);
            self.keeps_apart(*pair, is_free)
                && !self.crossing.has(vertices)
                && !self.is_pinched(vertices)
                && meet_unduly(*pair, x)
        };
        let (mut inside, mut first, mut pairs) = (Vec::new(), None, 0);
        for [a, b] in self.near_triangles().filter(crosses) {
            let (own, other) = if self.is_own(a[0]) { (a, b) } else { (b, a) };
            let body = self.body_of(other[0]);
            let fixed = own.into_iter().filter(|&v| !self.is_free[v as usize]);
            let before = inside.len();
            inside.extend(
                body.iter()
                    .flat_map(|&n| fixed.clone().map(move |v| [v, n as u32])),
            );
            if inside.len() == before {
                first.get_or_insert((own, body));
                pairs += 1;
            }
        }
        self.prescribed_inside.extend(inside);
        first.map_or(Ok(()), |(triangle, body)| {
            Err(ContactError::IntersectingStart {
                pairs,
                triangle,
                body,
            })
        })
    }

    /// Whether two triangles are kept apart unless they are excluded: bodies do not touch each other, nor prescribed
    /// cloth.
    pub(crate) fn keeps_apart(&self, pair: [[u32; 3]; 2], is_free: bool) -> bool {
        let first = pair.map(|corners| corners[0]);
        let vertices = pair.as_flattened();
        self.patches_meet(first)
            && (is_free || first.into_iter().all(|v| self.is_own(v)))
            && !self.pass(vertices)
    }

    fn find_triangles(&mut self, x: &[Vec3]) -> Result<(), NonFinite> {
        self.triangle_pairs
            .as_mut()
            .map_or(Ok(()), |pairs| pairs.find(x))
    }

    /// Pairs of triangles that are near each other where they were found last, and could touch.
    fn near_triangles(&self) -> impl Iterator<Item = [[u32; 3]; 2]> + '_ {
        let corners = self.triangle_pairs.iter().flat_map(TrianglePairs::corners);
        corners.filter(|[a, b]| self.patches_meet([a[0], b[0]]))
    }

    /// The bodies that something passes through, but no triangle at `x` (m): they need not let it pass any more. What
    /// crosses the others beside it, where vertices have sunk in with it, passes from now on, too.
    pub(super) fn unpinched(&mut self, x: &[Vec3]) -> Result<Vec<usize>, NonFinite> {
        let mut bodies = self.pinched.bodies();
        if bodies.is_empty() {
            return Ok(bodies);
        }
        self.find_triangles(x)?;
        let mut crossing = Vec::new();
        for [a, b] in self.near_triangles() {
            let body = self.body_of(a[0]).or(self.body_of(b[0]));
            let own = if self.is_own(a[0]) { a } else { b };
            if let Some(body) = body.filter(|body| bodies.contains(body))
                && !self.prescribed_inside.any_passes(&own, body)
                && meet_unduly([a, b], x)
            {
                crossing.extend(own.map(|v| [v, body as u32]));
            }
        }
        bodies.retain(|&body| crossing.iter().all(|pair| pair[1] as usize != body));
        self.pinched.extend(crossing);
        Ok(bodies)
    }

    /// Whether part of the cloth with these vertices passes through the body of which the others are.
    fn is_pinched(&self, vertices: &[u32]) -> bool {
        let all = [&self.pinched, &self.prescribed_inside];
        let mut bodies = vertices.iter().filter_map(|&v| self.body_of(v));
        all.iter().any(|some| some.count() > 0)
            && bodies
                .next()
                .is_some_and(|body| all.iter().any(|some| some.any_passes(vertices, body)))
    }

    /// Whether parts of the cloth with these vertices may pass through each other, or are neighbours across a seam.
    fn pass(&self, vertices: &[u32]) -> bool {
        self.own.excluded.has(vertices) || self.own.sewn.join(vertices)
    }

    /// Whether a vertex is in no triangle: inside of a solid, whose surface is what touches.
    pub(super) fn is_inside(&self, vertex: usize) -> bool {
        self.vertex_area[vertex] == 0.0
    }

    fn is_own(&self, vertex: u32) -> bool {
        (vertex as usize) < self.cloth
    }

    /// The surface that a vertex is of, if it is not of the cloth.
    fn side(&self, vertex: u32) -> Option<Side> {
        self.surfaces
            .get((vertex as usize).wrapping_sub(self.cloth))
            .copied()
    }

    /// The body that a vertex is of, if it is not of the cloth.
    pub(crate) fn body_of(&self, vertex: u32) -> Option<usize> {
        self.side(vertex).map(|side| side.body)
    }

    /// The body of each vertex that follows those of the cloth.
    pub(super) fn bodies(&self) -> impl Iterator<Item = usize> + '_ {
        self.surfaces.iter().map(|side| side.body)
    }

    /// Whether primitives with these vertices can touch: bodies do not touch each other.
    pub(super) fn patches_meet(&self, vertices: [u32; 2]) -> bool {
        match vertices.map(|v| self.is_own(v)) {
            [true, true] => self.own.self_collision,
            [false, false] => false,
            _ => true,
        }
    }

    /// Whether a pair counts: not if it is excluded, or nothing in it moves, and no prescribed vertices before
    /// bodies, which can be where they please.
    pub(super) fn meets(&self, vertices: [u32; 4]) -> bool {
        if self.surfaces.is_empty() || vertices.iter().all(|&v| self.is_own(v)) {
            let rests = vertices.iter().all(|&v| self.is_resting[v as usize]);
            let is_excluded = self.crossing.has(&vertices) || self.pass(&vertices);
            return self.own.self_collision && !rests && !is_excluded;
        }
        vertices.iter().any(|&v| self.is_free[v as usize]) && !self.is_pinched(&vertices)
    }

    /// Whether a pair is a vertex before a triangle of a body that keeps it out by a signed distance, so that the two
    /// need no detection.
    pub(super) fn is_kept_out(&self, Pair { kind, vertices }: Pair) -> bool {
        let [vertex, corner, ..] = vertices;
        kind == QueryKind::VertexTriangle
            && self.is_own(vertex)
            && self
                .side(corner)
                .is_some_and(|side| side.error_bound == 0.0)
    }

    /// Coefficient of friction μ (dimensionless) of a pair: of cloth, that of its vertex or, as for thicknesses, of one
    /// of its vertices.
    pub(super) fn friction(&self, vertices: [u32; 4]) -> Real {
        let [a, .., d] = vertices;
        let side = [a, d].map(|v| self.side(v)).into_iter().flatten().next();
        if self.own.frictions.is_empty() {
            return side.map_or(self.own.friction, |side| side.friction);
        }
        let of = |v: u32| {
            let side = self.side(v).map(|side| side.friction);
            side.unwrap_or_else(|| self.own.frictions[v as usize])
        };
        (of(a) * of(d)).sqrt()
    }

    /// Whether vertices can go to `x` (m): rounding of their coordinates must be below what friction and the thickness
    /// are told apart by. Those of bodies only have to be finite, since nobody looks for contact where they alone are.
    pub(super) fn check_range(&self, x: &[Vec3]) -> Result<(), ContactError> {
        let most = RESOLVED * self.law.range() / Real::EPSILON;
        let is_within = |x: &Vec3, most: Real| x.iter().all(|c| c.abs() <= most);
        let (own, others) = x.split_at(self.cloth);
        let far = own.iter().position(|x| !is_within(x, most));
        if let Some(vertex) = far.filter(|&vertex| is_finite(&own[vertex])) {
            let coordinate = own[vertex].amax();
            return Err(ContactError::TooFar {
                vertex,
                coordinate,
                most,
            });
        }
        let bad = others.iter().position(|x| !is_finite(x));
        let bad = far.or(bad.map(|vertex| self.cloth + vertex));
        bad.map_or(Ok(()), |vertex| Err(ContactError::NonFinite { vertex }))
    }

    /// Changes the coefficient of friction μ (dimensionless) that the surface of a body has.
    pub(super) fn set_body_friction(&mut self, body: usize, friction: Real) {
        let sides = self.surfaces.iter_mut().filter(|side| side.body == body);
        sides.for_each(|side| side.friction = friction);
    }

    /// The same as [`friction`](Self::friction) of a vertex of the cloth before a body of coefficient `friction`.
    pub(super) fn friction_on(&self, vertex: usize, friction: Real) -> Real {
        let own = self.own.frictions.get(vertex);
        own.map_or(friction, |own| (own * friction).sqrt())
    }

    /// The distance (m) from which on a vertex of the cloth is pushed away from a body.
    fn thickness(&self, vertex: u32) -> Real {
        let own = self.own.thicknesses.get(vertex as usize);
        own.copied().unwrap_or(self.law.range())
    }

    /// The distance (m) at which two parts of the cloth, or one and a body, are kept apart: half the sum of their
    /// thicknesses, or its own.
    pub(super) fn thickness_between(&self, [a, .., d]: [u32; 4]) -> Real {
        match (self.is_own(a), self.is_own(d)) {
            (true, true) => 0.5 * (self.thickness(a) + self.thickness(d)),
            (true, false) => self.thickness(a),
            _ => self.thickness(d),
        }
    }

    /// The law of a vertex of the cloth before a body.
    pub(super) fn law_at(&self, vertex: usize) -> PenaltyLaw {
        self.law.with_range(self.thickness(vertex as u32))
    }

    /// The area (m²) that a pair with these numbers stands for, but for its mollifier. A vertex before a triangle:
    /// between two sheets, whose vertices all count, half of its own; that of a body has no more than the vertices of
    /// the cloth there. Two edges: the smaller of theirs.
    pub(super) fn area_at_rest(&self, Pair { kind, vertices }: Pair, [e, f]: [u32; 2]) -> Real {
        if kind == QueryKind::EdgeEdge {
            return self.edge_area[e as usize].min(self.edge_area[f as usize]);
        }
        let [area, corners @ ..] = vertices.map(|v| self.vertex_area[v as usize]);
        if self.is_own(vertices[0]) {
            let is_between_sheets = self.is_own(vertices[1]) && !self.own.full_thickness;
            return if is_between_sheets { 0.5 } else { 1.0 } * area;
        }
        area.min(corners.iter().sum::<Real>() / 3.0)
    }

    /// The range (m) of a pair: the distance from which on it pushes. With the thickness h between the two it is
    ///
    /// - h for a vertex of the cloth before other cloth or before a body: the vertices carry the pressure, as they know
    ///   the area that they stand for;
    /// - h/2 for two edges (h with `full_thickness`), and for a vertex of a body before the cloth: they push only where
    ///   the vertices do not keep the two apart;
    /// - h/2 before the surface of a body whose signed distance is not exact: vertices are pushed by that distance, and
    ///   the triangles keep them out where it is wrong;
    /// - for two primitives of one component no more than their distance at rest, so that nothing is pushed away from
    ///   its rest.
    pub(super) fn range_of(&self, Pair { kind, vertices }: Pair) -> Real {
        let [a, .., d] = vertices;
        let fraction = match kind {
            QueryKind::EdgeEdge if !self.own.full_thickness => 0.5,
            _ => 1.0,
        };
        let between = self.thickness_between(vertices);
        let thickness = match (self.side(a), self.side(d)) {
            (None, None) => fraction * between,
            // Vertices before a distance that is off are pushed by it; the triangles keep them out where it is wrong.
            (None, Some(side)) if side.is_off() => return 0.5 * between,
            (None, Some(_)) => return fraction * between,
            _ => return 0.5 * between,
        };
        if self.component[a as usize] != self.component[d as usize] {
            return thickness;
        }
        let rest = Gap::new(kind, &gather(&self.rest, vertices)).distance;
        if rest > 0.0 {
            rest.min(thickness)
        } else {
            thickness
        }
    }
}
