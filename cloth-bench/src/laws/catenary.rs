//! The catenary of a chain of elastic links, which is exact for springs and masses.

use super::prelude::*;
use cloth_massspring::{Accept, ImplicitConfig, ImplicitEuler};
use nalgebra::{Matrix2, Vector2};

law! {
    CATENARY = "catenary" within 1e-8,
    "depth (m) of the lowest vertex of a hanging chain below its first support: link i spans l(1/T + 1/kl)(H, V), with H the same everywhere and V falling by mg at every vertex";
    catenary(CatenarySettings {
        links: u32 = 20 in AtLeast(2.0), "number of links, together 1 m";
        span: Real = 0.6 "m" in Above(0.0), "distance of the supports, across";
        drop: Real = 0.1 "m", "height of the first over the second";
        stiffness: Real = 500 "N/m" in Above(0.0), "stiffness k of every link";
        mass: Real = 0.05 "kg" in Above(0.0), "mass of every vertex";
    })
}

const GRAVITY: Real = 9.81;

/// A chain by its numbers.
struct Chain {
    links: usize,
    /// From the first support to the second: across and down (m).
    ends: Vector2<Real>,
    stiffness: Real,
    /// Weight of a vertex (N).
    weight: Real,
}

impl Chain {
    /// Length of a link (m).
    fn length(&self) -> Real {
        1.0 / self.links as Real
    }

    /// Pull (N) across and down in a link, from that in the first.
    fn pull(&self, link: usize, first: Vector2<Real>) -> Vector2<Real> {
        first - Vector2::new(0.0, link as Real * self.weight)
    }

    /// What a link spans (m) under a pull.
    fn spans(&self, pull: Vector2<Real>) -> Vector2<Real> {
        pull * (self.length() / pull.norm() + 1.0 / self.stiffness)
    }

    /// Complementary energy (J) of a pull in the first link. It is convex, and at its minimum the links span what they
    /// have to.
    fn energy(&self, first: Vector2<Real>) -> Real {
        let of = |link| {
            let t = self.pull(link, first).norm();
            t * self.length() + t * t / (2.0 * self.stiffness)
        };
        (0..self.links).map(of).sum::<Real>() - first.dot(&self.ends)
    }

    /// The pull (N) in the first link, by Newton's method.
    fn solve(&self) -> Result<Vector2<Real>, BenchError> {
        let total = self.weight * self.links as Real;
        let mut first = Vector2::new(total, 0.5 * total);
        for _ in 0..200 {
            let mut gap = -self.ends;
            let mut slope = Matrix2::zeros();
            for link in 0..self.links {
                let pull = self.pull(link, first);
                let t = pull.norm();
                gap += self.spans(pull);
                let across = Matrix2::identity() - pull * pull.transpose() / (t * t);
                slope +=
                    across * (self.length() / t) + Matrix2::identity() * (1.0 / self.stiffness);
            }
            if gap.norm() < 1e-13 {
                return Ok(first);
            }
            let step = slope.try_inverse().unwrap_or_default() * gap;
            let before = self.energy(first);
            // What rounding makes of the energy is no rise.
            let bound = before + 1e-13 * (1.0 + before.abs());
            // A pull of zero is a kink of the energy, which Newton's method must not run into.
            let least = (0..self.links).map(|link| self.pull(link, first).norm());
            let mut share = (0.5 * least.fold(Real::INFINITY, Real::min) / step.norm()).min(1.0);
            while share > 1e-9 && self.energy(first - step * share) > bound {
                share *= 0.5;
            }
            first -= step * share;
        }
        Err(BenchError::Failed(
            "no pull keeps every link taut: the closed form does not know slack links".into(),
        ))
    }

    /// Vertices (m) of the catenary.
    fn shape(&self) -> Result<Vec<Vec3>, BenchError> {
        let first = self.solve()?;
        let mut at = Vec3::zeros();
        let mut shape = vec![at];
        for link in 0..self.links {
            let spans = self.spans(self.pull(link, first));
            at += Vec3::new(spans.x, 0.0, -spans.y);
            shape.push(at);
        }
        Ok(shape)
    }

    /// A state far from it: a parabola that sags by half a metre.
    fn start(&self) -> State {
        let place = |i| {
            let s = i as Real / self.links as Real;
            Vec3::new(self.ends.x * s, 0.0, -self.ends.y * s - 2.0 * s * (1.0 - s))
        };
        State::at_rest((0..=self.links).map(place).collect())
    }
}

fn catenary(own: &CatenarySettings) -> Result<Evaluation, BenchError> {
    let (mass, links) = (*own.mass, *own.links);
    within_reach(1e4 * Real::from(links))?;
    let chain = Chain {
        links: links as usize,
        ends: Vector2::new(*own.span, *own.drop),
        stiffness: *own.stiffness,
        weight: mass * GRAVITY,
    };
    let expected = chain.shape()?;
    let mut particles = Particles::new(vec![mass; chain.links + 1])?;
    for end in [0, chain.links] {
        particles.prescribe(end)?;
    }
    let springs = (0..chain.links as u32).map(|i| Spring {
        vertices: [i, i + 1],
        rest_length: chain.length(),
        stiffness: chain.stiffness,
    });
    let sharp = ImplicitConfig {
        tolerance: 0.0,
        accept: Accept::Minimum,
        ..Default::default()
    };
    let mut solver = ImplicitEuler::builder(&particles)
        .elements(vec![Elements::Springs(springs.collect())])
        .config(sharp)
        .build()?;
    let mut state = chain.start();
    // The second support is where the closed form ends, to rounding.
    state.positions[chain.links] = expected[chain.links];
    // Steps of a thousand seconds: of the inertia next to nothing is left, and of what is left, nothing after a few.
    for _ in 0..10 {
        let input = StepInput::new(1e3).gravity(Vec3::z() * -GRAVITY);
        solver.step(&mut state, input)?;
    }
    let depth = |shape: &[Vec3]| shape.iter().map(|x| -x.z).fold(Real::MIN, Real::max);
    let off = expected.iter().zip(&state.positions);
    let off = off.map(|(a, b)| (a - b).norm()).fold(0.0, Real::max);
    Ok(Evaluation::new(depth(&expected), depth(&state.positions)).detail("largest_distance", off))
}
