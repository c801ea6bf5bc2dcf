//! Sweeps over contact constraints with friction as a plain loop, beside the real ones: corners of triangles that are
//! pressed onto other triangles, and dragged along them.
//!
//! `cargo run --release -p cloth-collide --example naive_sweep`
//!
//! No two of these pairs share a vertex, so the order of the constraints does not matter. Which pairs get one, and what
//! becomes of a path that is not safe at the end of the substep, is in the crate.

use cloth_collide::QueryKind;
use cloth_collide::obstacle::PenaltyLaw;
use cloth_collide::potential::{Gap, PotentialContacts};
use cloth_core::contact::{ContactConstraints, ContactStep};
use cloth_core::{TriMesh, Vec3};

const THICKNESS: f64 = 5e-3; // h (m)
const STIFFNESS: f64 = 1e6; // κ (Pa/m)
const FRICTION: f64 = 0.4; // μ
const DT: f64 = 1e-3; // of the substep (s)
const PAIRS: usize = 20;
const SWEEPS: usize = 5;

/// C = n·Σ c_k x_k − d₀ ≥ 0 with the compliance α̃ (1/kg), and what it has pushed with so far (kg m).
struct Constraint {
    vertices: [usize; 4],
    weights: [f64; 4],
    normal: Vec3,
    range: f64,
    compliance: f64,
    origin: Vec3,
    lambda: f64,
    friction: Vec3,
}

impl Constraint {
    /// Of a vertex and a triangle at `x` (m), of the area A (m²): the force A ψ′(d) and its derivative A ψ″(d) there.
    fn new(vertices: [usize; 4], area: f64, x: &[Vec3]) -> Self {
        let law = PenaltyLaw::new(STIFFNESS, THICKNESS).expect("positive numbers");
        let gap = Gap::new(QueryKind::VertexTriangle, &vertices.map(|v| x[v]));
        let curvature = law.curvature(gap.distance);
        let constraint = Self {
            vertices,
            weights: gap.weights,
            normal: gap.normal,
            range: gap.distance - law.slope(gap.distance) / curvature,
            compliance: 1.0 / (area * curvature * DT * DT),
            origin: Vec3::zeros(),
            lambda: 0.0,
            friction: Vec3::zeros(),
        };
        let origin = constraint.point(x);
        Self {
            origin,
            ..constraint
        }
    }

    /// Σ c_k x_k (m).
    fn point(&self, x: &[Vec3]) -> Vec3 {
        (0..4).map(|k| x[self.vertices[k]] * self.weights[k]).sum()
    }

    /// One visit of a sweep: XPBD's Δλ along n, and friction that takes the point back to its origin within the cone.
    fn project(&mut self, inverse_mass: &[f64], x: &mut [Vec3]) {
        let point = self.point(x);
        let value = self.normal.dot(&point) - self.range;
        let squares = (0..4).map(|k| self.weights[k].powi(2) * inverse_mass[self.vertices[k]]);
        let inverse_effective_mass: f64 = squares.sum();
        let change =
            -(value + self.compliance * self.lambda) / (inverse_effective_mass + self.compliance);
        let lambda = (self.lambda + change).max(0.0);

        let moved = point - self.origin;
        let slip = moved - self.normal * self.normal.dot(&moved);
        let wanted = self.friction - slip / inverse_effective_mass;
        let friction = wanted * (FRICTION * lambda / wanted.norm()).min(1.0);

        let push = self.normal * (lambda - self.lambda) + friction - self.friction;
        (self.lambda, self.friction) = (lambda, friction);
        for (v, w) in self.vertices.into_iter().zip(self.weights) {
            x[v] += push * (w * inverse_mass[v]);
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Of each pair a corner is between 0.25 h and 0.7 h above a triangle, and the rest of its own far above it.
    let (mut x, mut triangles) = (Vec::new(), Vec::new());
    for k in 0..PAIRS {
        let place = Vec3::new(k as f64, 0.0, 0.0);
        let height = THICKNESS * (0.25 + 0.45 * k as f64 / PAIRS as f64);
        let corners = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]];
        let above = [[0.03, 0.02, height], [0.1, 0.1, 0.1], [0.0, 0.12, 0.1]];
        x.extend(
            [corners, above]
                .as_flattened()
                .iter()
                .map(|x| place + Vec3::from(*x)),
        );
        triangles.extend([0, 3].map(|first| [0, 1, 2].map(|c| (6 * k + first + c) as u32)));
    }
    let mesh = TriMesh::new(x.clone(), triangles)?;
    let inverse_mass: Vec<f64> = (0..x.len())
        .map(|v| 500.0 + 100.0 * (v % 7) as f64)
        .collect();
    // Where all would go: the upper ones down by up to 1 mm, and along the lower ones by more than friction stops.
    let motion = |v: usize| match v % 6 {
        0..3 => Vec3::zeros(),
        _ => Vec3::new(2e-4 * (v / 6) as f64, 1e-4, -1e-3) * ((v / 6) as f64 / PAIRS as f64),
    };
    let predicted: Vec<Vec3> = (0..x.len()).map(|v| x[v] + motion(v)).collect();

    let mut naive = predicted.clone();
    let constraint = |k: usize| {
        let lower = 6 * k;
        // A vertex stands for a third of its triangle, between sheets for half of that.
        let area = mesh.areas().nth(2 * k + 1).expect("two triangles a pair") / 6.0;
        Constraint::new([lower + 3, lower, lower + 1, lower + 2], area, &x)
    };
    let mut constraints: Vec<Constraint> = (0..PAIRS).map(constraint).collect();
    for _ in 0..SWEEPS {
        for constraint in &mut constraints {
            constraint.project(&inverse_mass, &mut naive);
        }
    }

    let mut contacts = PotentialContacts::builder(&mesh)
        .thickness(THICKNESS)
        .stiffness(STIFFNESS)
        .friction(FRICTION)
        .build()?;
    let step = ContactStep {
        from: &x,
        inverse_mass: &inverse_mass,
        dt: DT,
    };
    let mut real = predicted.clone();
    contacts.begin_step(&step)?;
    contacts.begin_substep(&step, &predicted)?;
    for _ in 0..SWEEPS {
        contacts.sweep(&step, &mut real);
    }

    let sizes = |a: &[Vec3], b: &[Vec3]| {
        let each = a.iter().zip(b).map(|(a, b)| (a - b).norm());
        each.fold(0.0, f64::max)
    };
    let (apart, moved) = (sizes(&naive, &real), sizes(&naive, &predicted));
    let limit = |c: &&Constraint| c.friction.norm() > (1.0 - 1e-12) * FRICTION * c.lambda;
    let slipping = constraints.iter().filter(limit).count();
    println!(
        "{PAIRS} constraints, {slipping} of which slip, move vertices by {moved:.2e} m; the two differ by {apart:.1e} m"
    );
    assert!(apart < 1e-14 && moved > 1e-4);
    assert!(slipping > 0 && slipping < PAIRS);
    Ok(())
}

#[test]
fn the_naive_sweep_and_that_of_the_crate_move_vertices_alike() {
    main().unwrap();
}
