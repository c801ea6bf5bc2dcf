//! The local step of a batch of elements: the formula of one element, and of many that project to spheres side by side.
//!
//! A square root and a division take longer than all else that a spring needs; done for a block of springs side by
//! side, they do not wait for one another, nor for the sums over vertices.

use crate::local::apply;
use cloth_core::element::Projective;
use cloth_core::math::{Mat3, Real, Vec3, absolute_up_to_one, gather};

/// Most elements in a batch.
pub(crate) const BATCH_SIZE: usize = 32;

/// Forces and energies of a batch of elements.
#[derive(Debug)]
pub(crate) struct ProjectionBatch<const K: usize> {
    /// `w (z − p)` (N for an operator without dimension), the gradient of the energy by z: minus the force.
    forces: [[Vec3; K]; BATCH_SIZE],
    /// `½ w ‖z − p‖²` (J).
    energies: [Real; BATCH_SIZE],
    spheres: Spheres,
    /// Force over z (N/m), on spheres.
    factors: [Real; BATCH_SIZE],
}

impl<const K: usize> Default for ProjectionBatch<K> {
    #[inline(always)]
    fn default() -> Self {
        Self {
            forces: [[Vec3::zeros(); K]; BATCH_SIZE],
            energies: [0.0; BATCH_SIZE],
            spheres: Spheres::NONE,
            factors: [0.0; BATCH_SIZE],
        }
    }
}

impl<const K: usize> ProjectionBatch<K> {
    /// Force and energy of each element, in their order; what follows the last element has no meaning.
    #[inline(always)]
    pub(crate) fn each(&self) -> impl Iterator<Item = (&[Vec3; K], Real)> {
        self.forces.iter().zip(self.energies.iter().copied())
    }

    /// Projects at most [`BATCH_SIZE`] elements at x (m).
    #[inline(always)]
    pub(crate) fn find<'a, const N: usize, E: Projective<N, K>>(
        &mut self,
        elements: impl Iterator<Item = &'a E> + Clone,
        are_spheres: bool,
        x: &[Vec3],
    ) {
        if !(are_spheres && self.find_on_spheres(elements.clone(), x)) {
            self.find_one_by_one(elements, x);
        }
    }

    #[inline(always)]
    fn find_one_by_one<'a, const N: usize, E: Projective<N, K>>(
        &mut self,
        elements: impl Iterator<Item = &'a E>,
        x: &[Vec3],
    ) {
        let outputs = self.forces.iter_mut().zip(&mut self.energies);
        for (element, (force, energy)) in elements.zip(outputs) {
            let z = apply(&element.operator(), &gather(x, element.vertices()));
            let (p, weight) = (element.project(z), element.weight());
            let mut squared = 0.0;
            for k in 0..K {
                let difference = z[k] - p[k];
                squared += difference.norm_squared();
                force[k] = difference * weight;
            }
            *energy = 0.5 * weight * squared;
        }
    }

    /// The same for spheres. Returns `false` where some `‖z‖²` is zero, subnormal or not finite.
    #[inline(always)]
    fn find_on_spheres<'a, const N: usize, E: Projective<N, K>>(
        &mut self,
        elements: impl Iterator<Item = &'a E>,
        x: &[Vec3],
    ) -> bool {
        if !self.spheres.gather(elements, x) {
            return false;
        }
        self.spheres.project(&mut self.factors, &mut self.energies);
        for lane in 0..BATCH_SIZE {
            self.forces[lane][0] = self.spheres.z[lane] * self.factors[lane];
        }
        true
    }
}

/// Elements that project to spheres, side by side; what follows the last has no weight.
#[derive(Debug)]
struct Spheres {
    /// `z = S x`.
    z: [Vec3; BATCH_SIZE],
    radius: [Real; BATCH_SIZE],
    weight: [Real; BATCH_SIZE],
    /// `‖z‖²`.
    squared: [Real; BATCH_SIZE],
}

impl Spheres {
    /// No element.
    const NONE: Self = Self {
        z: [Vec3::new(1.0, 1.0, 1.0); BATCH_SIZE],
        radius: [1.0; BATCH_SIZE],
        weight: [0.0; BATCH_SIZE],
        squared: [3.0; BATCH_SIZE],
    };

    /// Takes elements from anywhere. Returns `false` where some `‖z‖²` is zero, subnormal or not finite.
    #[inline(always)]
    fn gather<'a, const N: usize, const K: usize, E: Projective<N, K>>(
        &mut self,
        elements: impl Iterator<Item = &'a E>,
        x: &[Vec3],
    ) -> bool {
        let mut count = 0;
        for (lane, element) in elements.enumerate().take(BATCH_SIZE) {
            self.z[lane] = apply(&element.operator(), &gather(x, element.vertices()))[0];
            self.radius[lane] = element.sphere().unwrap_or(0.0);
            self.weight[lane] = element.weight();
            count = lane + 1;
        }
        self.measure(count)
    }

    #[inline(always)]
    fn measure(&mut self, count: usize) -> bool {
        for lane in count..BATCH_SIZE {
            self.z[lane] = Vec3::repeat(1.0);
            (self.radius[lane], self.weight[lane]) = (1.0, 0.0);
        }
        let (z, mut abnormal) = (&self.z, 0u64);
        for lane in 0..BATCH_SIZE {
            let squared = z[lane].x * z[lane].x + z[lane].y * z[lane].y + z[lane].z * z[lane].z;
            abnormal |= u64::from(!(Real::MIN_POSITIVE..Real::INFINITY).contains(&squared));
            self.squared[lane] = squared;
        }
        abnormal == 0
    }

    /// `z − p = (1 − r/‖z‖) z`: fills in what z is multiplied by for the force (N/m), and the energy (J).
    #[inline(always)]
    fn project(&self, factors: &mut [Real; BATCH_SIZE], energies: &mut [Real; BATCH_SIZE]) {
        for lane in 0..BATCH_SIZE {
            let length = self.squared[lane].sqrt();
            let stretch = length - self.radius[lane];
            let force = self.weight[lane] * stretch;
            energies[lane] = 0.5 * force * stretch;
            factors[lane] = force / length;
        }
    }
}

/// The lower half of a symmetric 3 × 3 matrix column by column, and padding to whole registers.
pub(crate) type Packed = [Real; 8];

/// `w (I − ∂p/∂z)` (N/m) of at most [`BATCH_SIZE`] elements that project to spheres: `w (c I + (1 − c) z zᵀ/‖z‖²)` with
/// `c = 1 − r/‖z‖`, or 0 where that is negative. None where some `‖z‖²` is zero, subnormal or not finite.
#[inline(always)]
pub(crate) fn projected_hessians_on_spheres<
    'a,
    const N: usize,
    const K: usize,
    E: Projective<N, K>,
>(
    elements: impl Iterator<Item = &'a E>,
    x: &[Vec3],
) -> Option<[Packed; BATCH_SIZE]> {
    let mut spheres = Spheres::NONE;
    if !spheres.gather(elements, x) {
        return None;
    }
    let (mut across, mut along) = ([0.0; BATCH_SIZE], [0.0; BATCH_SIZE]);
    for lane in 0..BATCH_SIZE {
        let length = spheres.squared[lane].sqrt();
        let c = absolute_up_to_one(1.0 - spheres.radius[lane] / length);
        across[lane] = spheres.weight[lane] * c;
        along[lane] = spheres.weight[lane] * (1.0 - c) / spheres.squared[lane];
    }
    let mut packed = [[0.0; 8]; BATCH_SIZE];
    for lane in 0..BATCH_SIZE {
        let [x, y, z] = spheres.z[lane].into();
        let (c, a) = (across[lane], along[lane]);
        packed[lane] = [
            c + a * x * x,
            a * x * y,
            a * x * z,
            c + a * y * y,
            a * y * z,
            c + a * z * z,
            0.0,
            0.0,
        ];
    }
    Some(packed)
}

#[inline(always)]
pub(crate) fn unpacked(&[xx, yx, zx, yy, zy, zz, ..]: &Packed) -> Mat3 {
    Mat3::new(xx, yx, zx, yx, yy, zy, zx, zy, zz)
}
