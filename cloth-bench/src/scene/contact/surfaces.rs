//! The bodies of a scene as triangles, wherever they are at a time.

use super::{ContactSetup, RigidSetup};
use crate::error::BenchError;
use cloth_collide::obstacle::Pose;
use cloth_collide::{BodyProbe, distance_from_surface};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

/// The surface of a body at a time.
#[derive(Clone, Debug)]
pub struct BodySurface<'a> {
    /// Number of the body in the scene, from 0: that of its `[[obstacle]]` in a scene file.
    pub number: usize,
    /// Vertices (m).
    pub positions: Vec<Vec3>,
    /// Its triangles, in these numbers.
    pub triangles: &'a [[u32; 3]],
    /// Where a rigid body is; none of a surface that changes its shape.
    pub pose: Option<Pose>,
    /// Whether it never moves.
    pub is_still: bool,
}

impl BodySurface<'_> {
    /// `obstacle0`, `obstacle1`, …
    pub fn name(&self) -> String {
        format!("obstacle{}", self.number)
    }
}

/// Position (m) of a point as a function of time (s).
type Path = Box<dyn Fn(Real) -> Vec3 + Send + Sync>;

impl ContactSetup {
    /// The way of a point that the body of this number in the scene takes along from `start` (m) at a time (s).
    pub(in crate::scene) fn path(
        &self,
        body: usize,
        start: Vec3,
        since: Real,
    ) -> Result<Path, BenchError> {
        if let Some(rigid) = self.rigid_body(body) {
            let motion = *self.rigid[rigid].obstacle.motion();
            let local = motion.pose_at(since).to_local(start);
            return Ok(Box::new(move |time| motion.pose_at(time).to_world(local)));
        }
        let numbers = self.numbers[self.rigid.len()..].iter();
        let mut animated = numbers.zip(&self.animated);
        let Some((_, (surface, animation, _))) = animated.find(|(n, _)| **n == body) else {
            return Err(BenchError::Failed(format!("there is no obstacle {body}")));
        };
        let fixed = animation.attach(surface.triangles(), start, since);
        let fixed = fixed.map_err(BenchError::failed)?;
        Ok(Box::new(move |time| fixed.position(time)))
    }

    /// The greatest speed (m/s) of any body that moves as it is told, at its vertices, until it is driven otherwise.
    pub(in crate::scene) fn max_speed(&self) -> Real {
        let rigid = self.obstacles().enumerate().map(|(body, obstacle)| {
            let motion = obstacle.motion();
            self.speed_with(body, [motion.velocity, motion.angular_velocity])
        });
        let animated = self.animated.iter();
        let animated = animated.map(|(_, animation, _)| animation.max_speed());
        rigid.chain(animated).fold(0.0, Real::max)
    }

    /// The greatest speed (m/s) of the vertices of an obstacle that has this velocity (m/s), and angular velocity
    /// (rad/s) about its position.
    pub(in crate::scene) fn speed_with(
        &self,
        body: usize,
        [velocity, angular_velocity]: [Vec3; 2],
    ) -> Real {
        let vertices = self.rigid[body].surface.positions().iter();
        let radius = vertices.map(Vec3::norm).fold(0.0, Real::max);
        velocity.norm() + angular_velocity.norm() * radius
    }

    /// Surfaces of all bodies at a time (s), in the order of the scene.
    pub fn body_surfaces(&self, time: Real) -> Vec<BodySurface<'_>> {
        let rigid = self.rigid.iter().enumerate().map(|(index, body)| {
            let motion = body.obstacle.motion();
            let is_at_rest =
                motion.velocity == Vec3::zeros() && motion.angular_velocity == Vec3::zeros();
            let is_moved = body.free.is_some() || self.driven.contains(&index);
            (Some(motion.pose_at(time)), is_at_rest && !is_moved)
        });
        let animated = self.animated.iter();
        let animated = animated.map(|(_, animation, _)| (None, animation.shape_count() == 1));
        let places = rigid.chain(animated).zip(self.surfaces(time));
        let bodies = places.zip(&self.numbers);
        let mut bodies: Vec<_> = bodies
            .map(
                |(((pose, is_still), (positions, triangles)), &number)| BodySurface {
                    number,
                    positions,
                    triangles,
                    pose,
                    is_still,
                },
            )
            .collect();
        bodies.sort_by_key(|body| body.number);
        bodies
    }

    /// Surfaces of the bodies, the rigid ones first: their vertices (m) at a time (s), and their triangles.
    pub(in crate::scene) fn surfaces(
        &self,
        time: Real,
    ) -> impl Iterator<Item = (Vec<Vec3>, &[[u32; 3]])> + '_ {
        let rigid = self.rigid.iter().map(move |body| {
            let pose = body.obstacle.motion().pose_at(time);
            let positions = body.surface.positions().iter();
            let positions = positions.map(|&x| pose.to_world(x)).collect();
            (positions, body.surface.triangles())
        });
        let animated = self.animated.iter().map(move |(shape, animation, _)| {
            let mut positions = shape.positions().to_vec();
            // As rigid bodies, it is nowhere at a time that is no number.
            if animation.place(time, &mut positions).is_err() {
                positions.fill(Vec3::repeat(Real::NAN));
            }
            (positions, shape.triangles())
        });
        rigid.chain(animated)
    }

    /// Surfaces at rest and numbers in the scene of the bodies that have edges, and so an end.
    fn edged(&self) -> impl Iterator<Item = (&TriMesh, usize)> + '_ {
        let edged = self.rigid.iter().filter(|body| body.has_triangles());
        let rigid = edged.map(|body| (&body.surface, body.number));
        let numbers = self.numbers[self.rigid.len()..].iter().copied();
        rigid.chain(
            self.animated
                .iter()
                .map(|(surface, ..)| surface)
                .zip(numbers),
        )
    }

    /// Vertices (m) of the bodies that have an end, at a time (s).
    pub(crate) fn bounded_surfaces(&self, time: Real) -> impl Iterator<Item = Vec<Vec3>> + '_ {
        let rigid = self.rigid.iter().map(RigidSetup::has_triangles);
        let bounded = rigid.chain(std::iter::repeat(true));
        let all = self.surfaces(time).zip(bounded);
        all.filter_map(|((positions, _), is_bounded)| is_bounded.then_some(positions))
    }

    /// The body of a triangle, and which of its own it is, in words; counted from 0 through the triangles of those
    /// bodies that have edges, in the order of [`ContactSetup::body_numbers`].
    pub(crate) fn body_triangle(&self, triangle: usize) -> Option<String> {
        let mut first = 0;
        for (surface, number) in self.edged() {
            let next = first + surface.triangle_count();
            if triangle < next {
                return Some(format!("{} of obstacle {number}", triangle - first));
            }
            first = next;
        }
        None
    }

    /// Smallest distance (m) of the points `x` (m) from a body at `time` (s): negative inside a rigid one, and without
    /// a sign from the triangles of one without an inside. None where there are no bodies.
    pub fn min_clearance(&self, x: &[Vec3], time: Real) -> Option<Real> {
        let rigid = self.rigid.iter().filter(|body| body.has_inside());
        let rigid = rigid.flat_map(|body| {
            let clearance = move |&x: &Vec3| body.obstacle.signed_distance(x, time).value;
            x.iter().map(clearance)
        });
        let own = self.rigid.iter().map(RigidSetup::has_inside);
        let hollow = self.surfaces(time).zip(own.chain(std::iter::repeat(false)));
        let hollow = hollow.filter(|(_, has_inside)| !has_inside);
        let hollow = hollow
            .map(|(surface, _)| surface)
            .filter_map(|(positions, triangles)| distance_from_surface(x, &positions, triangles));
        rigid.chain(hollow).reduce(Real::min)
    }

    /// What counts the triangles of the cloth `mesh` that go through bodies; nothing where no body has an edge.
    pub fn probe(&self, mesh: &TriMesh) -> Result<Option<BodyProbe>, BenchError> {
        let bodies: Vec<&TriMesh> = self.edged().map(|(surface, _)| surface).collect();
        if bodies.is_empty() {
            return Ok(None);
        }
        let probe = BodyProbe::new(mesh, &bodies).map_err(BenchError::failed)?;
        Ok(Some(probe))
    }

    /// Counts them where the cloth is at `x` (m) at `time` (s).
    pub fn count(
        &self,
        probe: &mut BodyProbe,
        x: &[Vec3],
        time: Real,
    ) -> Result<usize, BenchError> {
        let places: Vec<Vec<Vec3>> = self.bounded_surfaces(time).collect();
        let bodies = places.iter().map(Vec::as_slice);
        probe.count(x, bodies).map_err(BenchError::failed)
    }
}
