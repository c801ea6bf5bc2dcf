//! The projections of a few elements at once.
//!
//! A square root and a division take longer than all else that a spring needs; done for a block of springs side by side, they do not wait for
//! one another, nor for the sums over vertices.

use crate::local::apply;
use cloth_core::element::Projective;
use cloth_core::math::{Mat3, Real, Vec3, gather};

/// Elements of a block, at most.
pub(crate) const BLOCK: usize = 32;

/// What the elements of a block add to the gradient and the energy.
#[derive(Debug)]
pub(crate) struct Pulls<const K: usize> {
    /// `w (z − p)` (N for an operator without dimension).
    pulls: [[Vec3; K]; BLOCK],
    /// `½ w ‖z − p‖²` (J).
    energies: [Real; BLOCK],
    spheres: Spheres,
    /// What z is multiplied by for the pull (N/m), on spheres.
    shares: [Real; BLOCK],
}

impl<const K: usize> Default for Pulls<K> {
    #[inline(always)]
    fn default() -> Self {
        Self {
            pulls: [[Vec3::zeros(); K]; BLOCK],
            energies: [0.0; BLOCK],
            spheres: Spheres::NONE,
            shares: [0.0; BLOCK],
        }
    }
}

impl<const K: usize> Pulls<K> {
    /// Pull and energy of each element, in their order; what follows the last element has no meaning.
    #[inline(always)]
    pub(crate) fn each(&self) -> impl Iterator<Item = (&[Vec3; K], Real)> {
        self.pulls.iter().zip(self.energies.iter().copied())
    }

    /// Projects at most [`BLOCK`] elements at x (m).
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
        let places = self.pulls.iter_mut().zip(&mut self.energies);
        for (element, (pull, energy)) in elements.zip(places) {
            let z = apply(&element.operator(), &gather(x, element.vertices()));
            let (p, weight) = (element.project(z), element.weight());
            let mut squared = 0.0;
            for k in 0..K {
                let difference = z[k] - p[k];
                squared += difference.norm_squared();
                pull[k] = difference * weight;
            }
            *energy = 0.5 * weight * squared;
        }
    }

    /// The same for spheres. Returns `false` where some `‖z‖²` is no number to divide by.
    #[inline(always)]
    fn find_on_spheres<'a, const N: usize, E: Projective<N, K>>(
        &mut self,
        elements: impl Iterator<Item = &'a E>,
        x: &[Vec3],
    ) -> bool {
        if !self.spheres.gather(elements, x) {
            return false;
        }
        self.spheres.project(&mut self.shares, &mut self.energies);
        for lane in 0..BLOCK {
            self.pulls[lane][0] = self.spheres.z[lane] * self.shares[lane];
        }
        true
    }
}

/// Elements that project to spheres, side by side; what follows the last has no weight.
#[derive(Debug)]
struct Spheres {
    /// `z = G x`.
    z: [Vec3; BLOCK],
    radius: [Real; BLOCK],
    weight: [Real; BLOCK],
    /// `‖z‖²`.
    squared: [Real; BLOCK],
}

impl Spheres {
    /// No element.
    const NONE: Self = Self {
        z: [Vec3::new(1.0, 1.0, 1.0); BLOCK],
        radius: [1.0; BLOCK],
        weight: [0.0; BLOCK],
        squared: [3.0; BLOCK],
    };

    /// Takes elements from anywhere. Returns `false` where some `‖z‖²` is no number to divide by.
    #[inline(always)]
    fn gather<'a, const N: usize, const K: usize, E: Projective<N, K>>(
        &mut self,
        elements: impl Iterator<Item = &'a E>,
        x: &[Vec3],
    ) -> bool {
        let mut count = 0;
        for (lane, element) in elements.enumerate().take(BLOCK) {
            self.z[lane] = apply(&element.operator(), &gather(x, element.vertices()))[0];
            self.radius[lane] = element.sphere().unwrap_or(0.0);
            self.weight[lane] = element.weight();
            count = lane + 1;
        }
        self.measure(count)
    }

    #[inline(always)]
    fn measure(&mut self, count: usize) -> bool {
        for lane in count..BLOCK {
            self.z[lane] = Vec3::repeat(1.0);
            (self.radius[lane], self.weight[lane]) = (1.0, 0.0);
        }
        let (z, mut lost) = (&self.z, 0u64);
        for lane in 0..BLOCK {
            let squared = z[lane].x * z[lane].x + z[lane].y * z[lane].y + z[lane].z * z[lane].z;
            lost |= u64::from(!(Real::MIN_POSITIVE..Real::INFINITY).contains(&squared));
            self.squared[lane] = squared;
        }
        lost == 0
    }

    /// `z − p = (1 − r/‖z‖) z`: fills in what z is multiplied by for the pull (N/m), and the energy (J).
    #[inline(always)]
    fn project(&self, shares: &mut [Real; BLOCK], energies: &mut [Real; BLOCK]) {
        for lane in 0..BLOCK {
            let length = self.squared[lane].sqrt();
            let stretch = length - self.radius[lane];
            let force = self.weight[lane] * stretch;
            energies[lane] = 0.5 * force * stretch;
            shares[lane] = force / length;
        }
    }
}

/// The lower half of a symmetric 3 × 3 matrix column by column, and padding to whole registers.
pub(crate) type Packed = [Real; 8];

/// `w (I − ∂p/∂z)` (N/m) of at most [`BLOCK`] elements that project to spheres: `w (c I + (1 − c) z zᵀ/‖z‖²)` with `c = 1 − r/‖z‖`, or 0
/// where that is negative. None where some `‖z‖²` is no number to divide by.
#[inline(always)]
pub(crate) fn resistances_on_spheres<'a, const N: usize, const K: usize, E: Projective<N, K>>(
    elements: impl Iterator<Item = &'a E>,
    x: &[Vec3],
) -> Option<[Packed; BLOCK]> {
    let mut spheres = Spheres::NONE;
    if !spheres.gather(elements, x) {
        return None;
    }
    let (mut across, mut along) = ([0.0; BLOCK], [0.0; BLOCK]);
    for lane in 0..BLOCK {
        let length = spheres.squared[lane].sqrt();
        let share = (1.0 - spheres.radius[lane] / length).max(0.0);
        across[lane] = spheres.weight[lane] * share;
        along[lane] = spheres.weight[lane] * (1.0 - share) / spheres.squared[lane];
    }
    let mut packed = [[0.0; 8]; BLOCK];
    for lane in 0..BLOCK {
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
