//! Closed forms of the log barrier.

use cloth_collide::SeparationProbe;
use cloth_collide::barrier::BarrierContacts;
use cloth_collide::barrier::{EdgeEdgeContact, Mollifier, VertexTriangleContact};
use cloth_collide::obstacle::{HalfSpace, ImpactLaw, Obstacle, ObstacleContacts, PenaltyLaw};
use cloth_core::contact::{ContactSource, ContactStep};
use cloth_core::element::Energy;
use cloth_core::math::{Vec3, gather};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, join};
use cloth_core::particles::Particles;
use cloth_core::topology::EdgeTable;

const GRAVITY: f64 = 9.81;
const RANGE: f64 = 1e-3;
const STIFFNESS: f64 = 2e4;

/// Free flight and contact, until nothing moves.
struct Fall {
    x: Vec<Vec3>,
    v: Vec<Vec3>,
    inverse_mass: Vec<f64>,
    dt: f64,
    /// Where each vertex is led to fall straight down, if it is.
    plumb: Option<Vec<Vec3>>,
}

impl Fall {
    fn new(x: Vec<Vec3>, inverse_mass: Vec<f64>, dt: f64) -> Self {
        let v = vec![Vec3::zeros(); x.len()];
        Self {
            x,
            v,
            inverse_mass,
            dt,
            plumb: None,
        }
    }

    fn step(&mut self, contacts: &mut BarrierContacts) {
        let from = self.x.clone();
        for ((x, v), w) in self.x.iter_mut().zip(&mut self.v).zip(&self.inverse_mass) {
            if *w > 0.0 {
                *v -= Vec3::z() * (GRAVITY * self.dt);
                *x += *v * self.dt;
            }
        }
        for (line, (x, v)) in self
            .plumb
            .iter()
            .flatten()
            .zip(self.x.iter_mut().zip(&mut self.v))
        {
            (x.x, x.y, v.x, v.y) = (line.x, line.y, 0.0, 0.0);
        }
        let step = ContactStep {
            from: &from,
            inverse_mass: &self.inverse_mass,
            dt: self.dt,
        };
        contacts.resolve(&step, &mut self.x, &mut self.v).unwrap();
    }

    /// Largest speed (m/s) after so many steps; of what is led straight down, the part that can move.
    fn settle(&mut self, contacts: &mut BarrierContacts, steps: usize) -> f64 {
        for _ in 0..steps {
            self.step(contacts);
        }
        let speed = |v: &Vec3| {
            if self.plumb.is_some() {
                v.z.abs()
            } else {
                v.norm()
            }
        };
        self.v.iter().map(speed).fold(0.0, f64::max)
    }
}

/// The gap (m) at which a barrier of `RANGE` and `STIFFNESS` presses with `pressure` (N/m²).
fn gap(pressure: f64) -> f64 {
    let (mut low, mut high) = (0.0, RANGE);
    for _ in 0..200 {
        let d = 0.5 * (low + high);
        let past: f64 = d - RANGE;
        let pressed = STIFFNESS * past * (2.0 * (d / RANGE).ln() + past / d);
        if pressed > pressure {
            low = d;
        } else {
            high = d;
        }
    }
    high
}

/// A triangle (m) with equal sides around the axis, at the height `z` (m).
fn equilateral(radius: f64, z: f64) -> [Vec3; 3] {
    [0.0, 1.0, 2.0].map(|k: f64| {
        let angle = std::f64::consts::TAU * k / 3.0;
        Vec3::new(radius * angle.cos(), radius * angle.sin(), z)
    })
}

#[test]
fn sheet_rests_on_a_plane_at_the_gap_that_presses_with_its_weight() {
    let x = equilateral(0.1, 0.002);
    let mesh = TriMesh::new(x.to_vec(), vec![[0, 1, 2]]).unwrap();
    let plane = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let law = ImpactLaw::new(0.0, 0.0).unwrap();
    for thickness in [0.0, 5e-4] {
        let obstacles = ObstacleContacts::new(thickness, 0.0)
            .unwrap()
            .with(plane.clone(), law);
        let mut contacts = BarrierContacts::builder(&mesh)
            .distance(RANGE)
            .stiffness(STIFFNESS)
            .accuracy(1e-9)
            .obstacles(obstacles)
            .build()
            .unwrap();
        let density = 0.2;
        let w = 3.0 / (density * mesh.area());
        let mut fall = Fall::new(x.to_vec(), vec![w; 3], 0.05);
        let speed = fall.settle(&mut contacts, 100);
        let expected = thickness + gap(density * GRAVITY);
        for x in &fall.x {
            let error = (x.z - expected).abs() / RANGE;
            assert!(error < 1e-9, "{} instead of {expected}: {error:e}", x.z);
        }
        assert!(speed < 1e-12, "{speed:e}");
    }
}

#[test]
fn pyramid_of_sheets_has_gaps_that_press_with_the_weight_above() {
    // Each triangle lies well inside the one below: its three vertices are all that touches.
    let layers = 10;
    let radius = |k: usize| 0.2 - 0.018 * k as f64;
    let x: Vec<Vec3> = (0..=layers)
        .flat_map(|k| equilateral(radius(k), 9e-4 * k as f64))
        .collect();
    let triangles = (0..=layers as u32)
        .map(|k| [3 * k, 3 * k + 1, 3 * k + 2])
        .collect();
    let mesh = TriMesh::new(x.clone(), triangles).unwrap();
    let mut contacts = precise(&mesh);
    let density = 0.2;
    let areas: Vec<f64> = mesh.areas().collect();
    let w = (0..3 * (layers + 1)).map(|v| match v / 3 {
        0 => 0.0,
        k => 3.0 / (density * areas[k]),
    });
    let mut fall = Fall::new(x, w.collect(), 0.05);
    let speed = fall.settle(&mut contacts, 300);
    let mut before = 0.0;
    for k in 1..=layers {
        let above: f64 = areas[k..].iter().sum();
        let expected = gap(density * GRAVITY * above / areas[k]);
        for c in 0..3 {
            let found = fall.x[3 * k + c].z - fall.x[3 * k - 3 + c].z;
            let error = (found - expected).abs() / RANGE;
            assert!(
                error < 1e-8,
                "layer {k}: {found} instead of {expected}, {error:e}"
            );
        }
        assert!(expected > before);
        before = expected;
    }
    assert!(speed < 1e-8, "{speed:e}");
    let mut probe = SeparationProbe::new(&mesh);
    assert_eq!(probe.measure(&fall.x).unwrap().intersecting_pairs, 0);
}

/// A vertex, held by nothing but a barrier, above a small triangle that is held; the rest of its own triangle is held high up.
#[test]
fn vertex_rests_on_a_triangle_at_the_gap_that_presses_with_its_weight() {
    let floor = equilateral(0.02, 0.0).map(|x| x + Vec3::new(0.001, -0.002, 0.0));
    let upper = [(0.0, 0.0, 0.0015), (0.1, 0.0, 0.4), (0.0, 0.2, 0.4)];
    let upper = upper.map(|(x, y, z)| Vec3::new(x, y, z));
    let x = [floor, upper].concat();
    let mesh = TriMesh::new(x.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let mass = 0.005;
    let mut contacts = precise(&mesh);
    let w = vec![0.0, 0.0, 0.0, 1.0 / mass, 0.0, 0.0];
    let mut fall = Fall::new(x, w, 0.05);
    let speed = fall.settle(&mut contacts, 100);
    let area = mesh.areas().nth(1).unwrap() / 3.0;
    let expected = gap(mass * GRAVITY / area);
    let error = (fall.x[3].z - expected).abs() / RANGE;
    assert!(
        error < 1e-9,
        "{} instead of {expected}: {error:e}",
        fall.x[3].z
    );
    assert!(speed < 1e-9, "{speed:e}");
    assert_eq!(contacts.report().contacts, 1);
}

/// An edge lies across another one at 3/10 of its length, one end free, the other held where the edge is level when it rests.
#[test]
fn edge_rests_on_an_edge_at_the_gap_that_presses_with_its_weight() {
    let lower = [(-0.04, 0.0, 0.0), (0.06, 0.0, 0.0), (0.0, 0.0, -0.1)];
    let upper = [(0.0, -0.03, 0.0015), (0.0, 0.07, 0.0), (0.0, 0.0, 0.3)];
    let mut x: Vec<Vec3> = lower
        .iter()
        .chain(&upper)
        .map(|&(x, y, z)| Vec3::new(x, y, z))
        .collect();
    let mesh = TriMesh::new(x.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let mass = 0.005;
    let area = mesh.areas().fold(f64::INFINITY, f64::min) / 3.0;
    let expected = gap(mass * GRAVITY / (0.7 * area));
    x[4].z = expected;
    let mut contacts = precise(&mesh);
    let w = vec![0.0, 0.0, 0.0, 1.0 / mass, 0.0, 0.0];
    let mut fall = Fall::new(x.clone(), w, 0.05);
    // Without friction it would slide off.
    fall.plumb = Some(x);
    let speed = fall.settle(&mut contacts, 100);
    let error = (fall.x[3].z - expected).abs() / RANGE;
    assert!(
        error < 1e-9,
        "{} instead of {expected}: {error:e}",
        fall.x[3].z
    );
    assert!(speed < 1e-9, "{speed:e}");
    assert_eq!(contacts.report().contacts, 1);
}

fn precise(mesh: &TriMesh) -> BarrierContacts {
    BarrierContacts::builder(mesh)
        .distance(RANGE)
        .stiffness(STIFFNESS)
        .accuracy(1e-9)
        .build()
        .unwrap()
}

/// Ten aligned triangles: each vertex lies right above another, and each pair of them has 6 contacts of a vertex and 6 of two edges that are not parallel.
#[test]
fn stack_of_aligned_triangles_has_gaps_that_press_with_the_weight_above() {
    let layers = 10;
    let x: Vec<Vec3> = (0..=layers)
        .flat_map(|k| equilateral(0.1, 9.9e-4 * k as f64))
        .collect();
    let triangles = (0..=layers as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
    let mesh = TriMesh::new(x.clone(), triangles.collect()).unwrap();
    let mut contacts = precise(&mesh);
    let density = 0.2;
    let w = (0..x.len()).map(|v| {
        if v < 3 {
            0.0
        } else {
            3.0 / (density * mesh.areas().next().unwrap())
        }
    });
    // Vertex upon vertex is an unstable balance, with a rate √(g/d) for each layer above.
    let mut fall = Fall::new(x.clone(), w.collect(), 1e-3);
    fall.plumb = Some(x);
    let speed = fall.settle(&mut contacts, 3000);
    let mut before = 0.0;
    for k in 1..=layers {
        // Each contact stands for a third of a triangle.
        let above = (layers + 1 - k) as f64;
        let expected = gap(density * GRAVITY * above * 3.0 / 12.0);
        for c in 0..3 {
            let found = fall.x[3 * k + c].z - fall.x[3 * k - 3 + c].z;
            let error = (found - expected).abs() / RANGE;
            assert!(
                error < 1e-8,
                "layer {k}: {found} instead of {expected}, {error:e}"
            );
        }
        assert!(expected > before);
        before = expected;
    }
    assert!(speed < 1e-8, "{speed:e}");
}

/// The energy of all barriers (J), its gradient (N) at `x` (m): over all pairs there are, without a search.
fn forces(mesh: &TriMesh, x: &[Vec3]) -> Vec<Vec3> {
    let law = PenaltyLaw::barrier(STIFFNESS, RANGE).unwrap();
    let edges = EdgeTable::build(mesh).unwrap();
    let mut vertex_area = vec![0.0; x.len()];
    let mut edge_area = vec![0.0; edges.ends().len()];
    for (triangle, area) in mesh.triangles().iter().zip(mesh.areas()) {
        triangle
            .iter()
            .for_each(|v| vertex_area[*v as usize] += area / 3.0);
        for (edge, ends) in edges.ends().iter().enumerate() {
            if ends.iter().all(|v| triangle.contains(v)) {
                edge_area[edge] += area / 3.0;
            }
        }
    }
    let mut forces = vec![Vec3::zeros(); x.len()];
    let mut add = |vertices: [u32; 4], gradient: [Vec3; 4]| {
        for (v, g) in vertices.iter().zip(gradient) {
            forces[*v as usize] -= g;
        }
    };
    for v in 0..x.len() as u32 {
        for &[a, b, c] in mesh.triangles().iter().filter(|t| !t.contains(&v)) {
            let pair = VertexTriangleContact {
                vertices: [v, a, b, c],
                area: vertex_area[v as usize],
                law,
            };
            add(pair.vertices, pair.gradient(&gather(x, pair.vertices)));
        }
    }
    let squared = |[a, b]: [u32; 2]| {
        let p = mesh.positions();
        (p[a as usize] - p[b as usize]).norm_squared()
    };
    for (i, &[a, b]) in edges.ends().iter().enumerate() {
        for (j, &[c, d]) in edges.ends().iter().enumerate().skip(i + 1) {
            if [c, d].contains(&a) || [c, d].contains(&b) {
                continue;
            }
            let pair = EdgeEdgeContact {
                vertices: [a, b, c, d],
                area: edge_area[i].min(edge_area[j]),
                law,
                mollifier: Mollifier::new([squared([a, b]), squared([c, d])]),
            };
            add(pair.vertices, pair.gradient(&gather(x, pair.vertices)));
        }
    }
    forces
}

#[test]
fn ten_sheets_at_rest_stay_apart_and_each_vertex_bears_its_weight() {
    let n = 5;
    let layer = |k: usize| {
        let sheet = grid(n, n, 0.2, 0.2, Diagonals::Alternating).unwrap();
        let (angle, shift) = (
            1.0 + k as f64,
            Vec3::new(0.017, 0.011, 0.0) * (k % 3) as f64,
        );
        let turned = |x: &Vec3| {
            let (s, c) = angle.sin_cos();
            let y = x - Vec3::new(0.1, 0.1, 0.0);
            Vec3::new(c * y.x - s * y.y, s * y.x + c * y.y, 9e-4 * k as f64) + shift
        };
        let positions = sheet.positions().iter().map(turned).collect();
        TriMesh::new(positions, sheet.triangles().to_vec()).unwrap()
    };
    let mesh = join(&(0..=10).map(layer).collect::<Vec<_>>()).unwrap();
    let (x, each) = (mesh.positions().to_vec(), n * n);
    let particles = Particles::from_areal_density(&mesh, 0.2).unwrap();
    let mass = particles.mass();
    let w = (0..x.len()).map(|v| if v < each { 0.0 } else { 1.0 / mass[v] });
    let mut contacts = precise(&mesh);
    let mut fall = Fall::new(x.clone(), w.collect(), 0.02);
    fall.plumb = Some(x);
    let mut probe = SeparationProbe::new(&mesh);
    let mut speed = 0.0;
    for k in 0..5 {
        speed = fall.settle(&mut contacts, 20);
        let found = probe.measure(&fall.x).unwrap();
        assert_eq!(found.intersecting_pairs, 0, "{k}");
    }
    assert!(speed < 1e-11, "{speed:e}");
    let forces = forces(&mesh, &fall.x);
    for v in each..forces.len() {
        let weight = mass[v] * GRAVITY;
        let error = (forces[v].z - weight).abs() / weight;
        assert!(error < 1e-9, "{v}: {error:e}");
    }
    // On the whole, gaps grow upwards.
    let height = |k: usize| {
        fall.x[each * k..each * (k + 1)]
            .iter()
            .map(|x| x.z)
            .sum::<f64>()
            / each as f64
    };
    let gaps: Vec<f64> = (0..10).map(|k| height(k + 1) - height(k)).collect();
    assert!(gaps.iter().all(|g| *g > 0.0));
    assert!(
        gaps[7..].iter().sum::<f64>() > 1.2 * gaps[..3].iter().sum::<f64>(),
        "{gaps:?}"
    );
}
