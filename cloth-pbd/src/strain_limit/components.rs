//! Connected components of the limits, and the angular-velocity correction that restores their angular momentum.

use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::topology::DisjointSets;

/// The connected components of a cloth: no limit acts between them.
#[derive(Debug, Default)]
pub(super) struct Components {
    /// Vertices, component by component, in ascending order within each.
    vertices: Vec<u32>,
    /// Component p is `vertices[starts[p]..starts[p + 1]]`.
    starts: Vec<usize>,
}

impl Components {
    /// From pairs of connected vertices. Vertices in no pair are left out.
    pub(super) fn new(pairs: &[[u32; 2]], vertex_count: usize) -> Self {
        let mut sets = DisjointSets::new(vertex_count);
        let mut linked = vec![false; vertex_count];
        for &[a, b] in pairs {
            sets.join(a, b);
            (linked[a as usize], linked[b as usize]) = (true, true);
        }
        let mut members: Vec<(u32, u32)> = (0..vertex_count as u32)
            .filter(|&v| linked[v as usize])
            .map(|v| (sets.root(v), v))
            .collect();
        members.sort_unstable();
        let mut starts = vec![0];
        for component in members.chunk_by(|a, b| a.0 == b.0) {
            starts.push(starts[starts.len() - 1] + component.len());
        }
        Self {
            vertices: members.into_iter().map(|(_, v)| v).collect(),
            starts,
        }
    }

    fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|w| &self.vertices[w[0]..w[1]])
    }

    /// Turns every component of the body `after` so that its angular momentum is that of the body `before`,
    /// with the smallest change of the velocities `after.v` in the metric of M: a rigid rotation.
    pub(super) fn keep_angular_momentum(
        &self,
        inverse_mass: &[Real],
        [x_before, v_before]: [&[Vec3]; 2],
        x: &[Vec3],
        v: &mut [Vec3],
    ) {
        for component in self.iter() {
            let from = Body {
                component,
                w: inverse_mass,
                x: x_before,
                v: v_before,
            };
            let to = Body { x, v, ..from };
            let (Some(pivot_before), Some(pivot)) = (from.pivot(), to.pivot()) else {
                continue;
            };
            let (wanted, _) = from.angular_momentum_and_inertia(pivot_before);
            let (present, inertia) = to.angular_momentum_and_inertia(pivot);
            let omega = angular_velocity(&inertia, wanted - present);
            for i in component.iter().map(|&i| i as usize) {
                if inverse_mass[i] > 0.0 {
                    v[i] += omega.cross(&(x[i] - pivot.0));
                }
            }
        }
    }
}

/// Some vertices of a cloth: inverse masses (1/kg), positions (m) and velocities (m/s) of all.
#[derive(Clone, Copy)]
struct Body<'a> {
    component: &'a [u32],
    w: &'a [Real],
    x: &'a [Vec3],
    v: &'a [Vec3],
}

impl Body<'_> {
    fn vertices(&self) -> impl Iterator<Item = usize> {
        self.component.iter().map(|&i| i as usize)
    }

    /// Position and velocity of its pivot: its one prescribed vertex, or its centre of mass; `None` if two or
    /// more are prescribed.
    fn pivot(&self) -> Option<(Vec3, Vec3)> {
        let mut held = self.vertices().filter(|&i| self.w[i] == 0.0);
        match (held.next(), held.next()) {
            (Some(pin), None) => Some((self.x[pin], self.v[pin])),
            (Some(_), Some(_)) => None,
            (None, _) => {
                let mass: Real = self.vertices().map(|i| 1.0 / self.w[i]).sum();
                let mean = |of: &[Vec3]| -> Vec3 {
                    self.vertices().map(|i| of[i] / (self.w[i] * mass)).sum()
                };
                Some((mean(self.x), mean(self.v)))
            }
        }
    }

    /// `Σ m (x − c) × (v − u)` (kg m²/s) and the tensor of inertia (kg m²) about the pivot c that moves with u.
    fn angular_momentum_and_inertia(&self, (c, u): (Vec3, Vec3)) -> (Vec3, Mat3) {
        let mut momentum = Vec3::zeros();
        let mut inertia = Mat3::zeros();
        for i in self.vertices().filter(|&i| self.w[i] > 0.0) {
            let (r, v) = (self.x[i] - c, self.v[i] - u);
            momentum += r.cross(&v) / self.w[i];
            inertia += (Mat3::identity() * r.norm_squared() - r * r.transpose()) / self.w[i];
        }
        (momentum, inertia)
    }
}

/// The smallest ω (rad/s) with `I ω = L`; I is singular for vertices on a line, and L has no component along it.
fn angular_velocity(inertia: &Mat3, momentum: Vec3) -> Vec3 {
    let size = inertia.trace();
    if size <= 0.0 || !size.is_finite() {
        return Vec3::zeros();
    }
    let eigen = inertia.symmetric_eigen();
    (0..3)
        .filter(|&k| eigen.eigenvalues[k] > 1e-14 * size)
        .map(|k| {
            let axis = eigen.eigenvectors.column(k);
            axis * (axis.dot(&momentum) / eigen.eigenvalues[k])
        })
        .sum()
}
