//! Connected components of the cloth that nothing constrains.
//!
//! *Linear momentum.* The rows of S of an element that does not resist a translation add up to zero, so `1ᵀA = 1ᵀM/Δt²`
//! over such a component (1 the vector of ones), and `1ᵀ∇G = 1ᵀM (q − u)/Δt²`. A plain iteration, A d = ∇G and q⁺ = q −
//! d, therefore has `1ᵀM (q⁺ − u) = 0`: the centre of mass is right after one of them, from any start. An iterate that
//! has it right has `1ᵀ∇G = 0`, and pairs, extrapolations and shortened steps are combinations that keep it so. Of a
//! coarse correction the shift is taken away.
//!
//! *Angular momentum.* The forces of a plain iteration are `w Sᵀ(p − S x⁺)`, with the p of x. Their moment about the
//! origin is `w Σ z × p` over the rows z of S x⁺: zero only if p is the projection of x⁺, at convergence. What is left
//! then is that of implicit Euler, `−Δt² Σ v[1] × f(x[1])` in a step, f the internal forces.

use cloth_core::contact::ContactRow;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::method::pieces::Pieces;
use cloth_core::particles::Particles;
use cloth_core::topology::DisjointSets;

/// Connected components of the cloth without a prescribed vertex and without an element that resists a translation. The
/// momentum of such a component after the step is known beforehand: elasticity does not change it.
#[derive(Clone, Debug)]
pub(crate) struct FreeComponents {
    /// Number of the component of each vertex, `CONSTRAINED` for vertices of components that are not free.
    component: Vec<u32>,
    /// What elements couple, held vertices too.
    pieces: Pieces,
    /// Mass (kg) of each vertex, and of each component.
    vertex_mass: Vec<Real>,
    mass: Vec<Real>,
    shift: Vec<Vec3>,
    /// Of each component, `Σ Δt D` (kg) with the drag of the air.
    dragged: Vec<Mat3>,
    /// Whether each component is supported: contact pressed something else against it where the last step ended.
    is_supported: Vec<bool>,
    /// Which components touch each other, and the mass (kg) of those that do together.
    touching: DisjointSets,
    together: Vec<Real>,
}

/// What the momentum of cloth comes to in a step if nothing stops it: `Σ m (q − u) + Δt D (q − Δt v₀) = 0`, with the
/// displacements q and u without elasticity, and the drag D of the air, if there is air, from the velocities v₀ before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Momentum<'a> {
    /// u (m).
    pub(crate) inertial: &'a [Vec3],
    /// D (kg/s) and v₀ (m/s); empty without air.
    pub(crate) drag: &'a [(Mat3, Vec3)],
    /// Δt (s).
    pub(crate) dt: Real,
}

impl Momentum<'_> {
    /// What a vertex of some mass (kg) and displaced by `q` (m) lacks of it, times Δt (kg·m).
    fn missing(&self, vertex: usize, mass: Real, q: Vec3) -> Vec3 {
        let inertia = (self.inertial[vertex] - q) * mass;
        match self.drag.get(vertex) {
            Some((drag, before)) => inertia - drag * (q - before * self.dt) * self.dt,
            None => inertia,
        }
    }

    /// Adds Δt D (kg) of a vertex, if there is air.
    fn add_drag(&self, vertex: usize, out: &mut Mat3) {
        if let Some((drag, _)) = self.drag.get(vertex) {
            *out += drag * self.dt;
        }
    }

    /// The shift (m) by which vertices make up for what they lack together (kg·m), of their mass (kg) and drag (kg).
    fn shift(&self, missing: Vec3, mass: Real, drag: &Mat3) -> Vec3 {
        if self.drag.is_empty() {
            return missing / mass;
        }
        let resistance = Mat3::from_diagonal_element(mass) + drag;
        resistance.try_inverse().unwrap_or_else(Mat3::zeros) * missing
    }
}

const CONSTRAINED: u32 = u32::MAX;
/// A row of `Σ w SᵀS` whose entries add up to more than this fraction of the largest diagonal entry resists a
/// translation; a smaller entry couples nothing: it is the rounding that removed elements leave.
const ROUNDING: Real = 1e-13;

impl FreeComponents {
    /// Finds the components in the entries of the lower half of `Σ w SᵀS` (N/m): row, column, value. It makes no
    /// difference if some families count twice.
    pub(crate) fn of(entries: &[(usize, usize, Real)], particles: &Particles) -> Self {
        let count = particles.len();
        let mut sets = DisjointSets::new(count);
        let mut sums: Vec<Real> = vec![0.0; count];
        let largest = entries.iter().map(|entry| entry.2).fold(0.0, Real::max);
        for &(row, column, value) in entries {
            sums[row] += value;
            if row != column {
                sums[column] += value;
                if value.abs() > ROUNDING * largest {
                    sets.join(row as u32, column as u32);
                }
            }
        }
        let mut is_constrained = vec![false; count];
        for vertex in 0..count {
            if particles.is_prescribed(vertex) || sums[vertex].abs() > ROUNDING * largest {
                is_constrained[sets.root(vertex as u32) as usize] = true;
            }
        }
        let mut number = vec![CONSTRAINED; count];
        let (mut component, mut mass) = (Vec::with_capacity(count), Vec::new());
        for vertex in 0..count {
            let root = sets.root(vertex as u32) as usize;
            if !is_constrained[root] && number[root] == CONSTRAINED {
                number[root] = mass.len() as u32;
                mass.push(0.0);
            }
            component.push(number[root]);
            if let Some(mass) = mass.get_mut(number[root] as usize) {
                *mass += particles.mass()[vertex];
            }
        }
        let roots: Vec<u32> = (0..count as u32).map(|vertex| sets.root(vertex)).collect();
        Self {
            shift: vec![Vec3::zeros(); mass.len()],
            dragged: vec![Mat3::zeros(); mass.len()],
            is_supported: vec![false; mass.len()],
            touching: DisjointSets::default(),
            together: Vec::new(),
            vertex_mass: particles.mass().to_vec(),
            pieces: Pieces::new(&roots),
            component,
            mass,
        }
    }

    /// The pieces that elements couple.
    pub(crate) fn pieces(&self) -> &Pieces {
        &self.pieces
    }

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.mass.is_empty()
    }

    /// Finds the components that a body or another component supports, in the contacts where a step has ended. The next
    /// step starts these where their velocity takes them, x[0] + Δt v[0], without the shift by gravity that a free
    /// component gets: cloth that lies still would have to come back from a fall of g Δt².
    pub(crate) fn find_supported(&mut self, rows: &[ContactRow]) {
        self.is_supported.fill(false);
        for row in rows {
            let ends = || {
                row.vertices
                    .iter()
                    .zip(row.weights)
                    .filter(|end| end.1 != 0.0)
            };
            let component = |vertex: u32| self.component[vertex as usize];
            let first = ends().next().map(|end| component(*end.0));
            if row.is_internal() && ends().all(|end| Some(component(*end.0)) == first) {
                continue;
            }
            for (vertex, _) in ends() {
                let component = self.component[*vertex as usize] as usize;
                if let Some(is_supported) = self.is_supported.get_mut(component) {
                    *is_supported = true;
                }
            }
        }
    }

    /// Moves every free component that nothing supports as a whole to where its momentum takes it, from the
    /// displacements q (m).
    pub(crate) fn align(&mut self, momentum: Momentum<'_>, q: &mut [Vec3]) {
        self.shift.fill(Vec3::zeros());
        self.dragged.fill(Mat3::zeros());
        for (vertex, &component) in self.component.iter().enumerate() {
            if let Some(shift) = self.shift.get_mut(component as usize) {
                let mass = self.vertex_mass[vertex];
                *shift += momentum.missing(vertex, mass, q[vertex]);
                momentum.add_drag(vertex, &mut self.dragged[component as usize]);
            }
        }
        for (number, shift) in self.shift.iter_mut().enumerate() {
            *shift = momentum.shift(*shift, self.mass[number], &self.dragged[number]);
        }
        self.add_shifts(q);
    }

    /// Moves every free component that nothing supports as a whole, so that its centre of mass is not displaced.
    pub(crate) fn center(&mut self, q: &mut [Vec3]) {
        self.shift.fill(Vec3::zeros());
        for (vertex, &component) in self.component.iter().enumerate() {
            if let Some(shift) = self.shift.get_mut(component as usize) {
                *shift -= q[vertex] * self.vertex_mass[vertex];
            }
        }
        for (shift, mass) in self.shift.iter_mut().zip(&self.mass) {
            *shift /= *mass;
        }
        self.add_shifts(q);
    }

    fn add_shifts(&self, q: &mut [Vec3]) {
        for (&component, q) in self.component.iter().zip(q) {
            let component = component as usize;
            if self.is_supported.get(component) == Some(&false) {
                *q += self.shift[component];
            }
        }
    }

    /// Finds the shift of each component, from the displacements q (m), that takes it to where its momentum does,
    /// together with those that it touches; none where anything else is touched. Returns whether there is one.
    pub(crate) fn find_shifts(
        &mut self,
        momentum: Momentum<'_>,
        rows: &[ContactRow],
        q: &[Vec3],
    ) -> bool {
        let count = self.mass.len();
        // All that is not free is one more.
        self.touching.reset(count + 1);
        for row in rows {
            let ends = row.vertices.iter().zip(row.weights);
            let mut last = (!row.is_internal()).then_some(count as u32);
            for (&vertex, _) in ends.filter(|end| end.1 != 0.0) {
                let own = self.component[vertex as usize].min(count as u32);
                last.iter().for_each(|&last| self.touching.join(last, own));
                last = Some(own);
            }
        }
        let held = self.touching.root(count as u32);
        self.shift.fill(Vec3::zeros());
        self.dragged.fill(Mat3::zeros());
        self.together.clear();
        self.together.resize(count, 0.0);
        for (number, mass) in self.mass.iter().enumerate() {
            let root = self.touching.root(number as u32);
            if root != held {
                self.together[root as usize] += mass;
            }
        }
        for (vertex, &component) in self.component.iter().enumerate() {
            if component != CONSTRAINED {
                let root = self.touching.root(component) as usize;
                let mass = self.vertex_mass[vertex];
                self.shift[root] += momentum.missing(vertex, mass, q[vertex]);
                momentum.add_drag(vertex, &mut self.dragged[root]);
            }
        }
        for number in 0..count {
            // The root is the lowest of those that touch each other, and so comes first.
            let root = self.touching.root(number as u32) as usize;
            self.shift[number] = match self.together[root] {
                0.0 => Vec3::zeros(),
                mass if root == number => {
                    momentum.shift(self.shift[root], mass, &self.dragged[root])
                }
                _ => self.shift[root],
            };
        }
        self.together.iter().any(|mass| *mass > 0.0)
    }

    /// Adds a part of the shifts that were found last to the vertices of free components.
    pub(crate) fn add_found(&self, part: Real, q: &mut [Vec3]) {
        for (&component, q) in self.component.iter().zip(q) {
            if let Some(shift) = self.shift.get(component as usize) {
                *q += shift * part;
            }
        }
    }
}
