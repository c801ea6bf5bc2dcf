//! One coarse level: restriction, relaxation of its links, prolongation.

use super::tether::{Tether, TetherUpdate};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::multigrid::{CoarseLevel, Prolongation};
use cloth_core::method::position_based::{Acceleration, Families, Sweep};
use cloth_core::step::BuildError;

#[derive(Debug)]
pub(super) struct Level {
    /// Number in the next finer level of each vertex.
    fine: Vec<u32>,
    /// Number in the mesh of each vertex.
    pub(super) original: Vec<u32>,
    /// To the next finer level.
    prolongation: Prolongation,
    /// Masses (kg), restricted from the next finer level, and inverse masses (1/kg), 0 for a prescribed vertex.
    pub(super) mass: Vec<Real>,
    inverse_mass: Vec<Real>,
    pub(super) links: Vec<Tether>,
    tethers: Families<TetherUpdate>,
    /// Positions (m) now and before anything moved.
    x: Vec<Vec3>,
    before: Vec<Vec3>,
}

impl Level {
    /// `mass` (kg) is that of the next finer level.
    pub(super) fn new(
        coarse: CoarseLevel,
        mass: &[Real],
        is_prescribed: impl Fn(u32) -> bool,
        sweep: Sweep,
    ) -> Result<Self, BuildError> {
        let CoarseLevel {
            vertices: original,
            kept: fine,
            prolongation,
            ..
        } = coarse;
        let restricted = |vertex| -> Real {
            let followers = prolongation.of_coarse(vertex).iter();
            followers
                .map(|&(v, weight)| weight * mass[v as usize])
                .sum()
        };
        let own: Vec<Real> = (0..fine.len()).map(restricted).collect();
        let inverse = |(&v, &mass): (&u32, &Real)| if is_prescribed(v) { 0.0 } else { 1.0 / mass };
        let inverse_mass = original.iter().zip(&own).map(inverse).collect();
        let link = |(&vertices, &length): (&[u32; 2], &Real)| Tether { vertices, length };
        let links: Vec<Tether> = coarse.links.iter().zip(&coarse.lengths).map(link).collect();
        let mut tethers = Families::new(fine.len(), sweep, Acceleration::default())?;
        tethers.add(&links)?;
        Ok(Self {
            x: vec![Vec3::zeros(); fine.len()],
            before: vec![Vec3::zeros(); fine.len()],
            fine,
            original,
            prolongation,
            mass: own,
            inverse_mass,
            links,
            tethers,
        })
    }

    /// The vertices of the next finer level that are not in this one, with their parents, by their numbers in
    /// this level, and weights.
    pub(super) fn parents(&self) -> impl Iterator<Item = (u32, &[(u32, Real)])> {
        let is_kept = |v: &u32| self.fine.binary_search(v).is_ok();
        let left_out = (0..self.prolongation.fine_count() as u32).filter(move |v| !is_kept(v));
        left_out.map(|v| (v, self.prolongation.of_fine(v as usize)))
    }

    pub(super) fn positions_mut(&mut self) -> &mut [Vec3] {
        &mut self.x
    }

    pub(super) fn positions(&self) -> &[Vec3] {
        &self.x
    }

    /// Restricts (injects) the positions of the next finer level.
    pub(super) fn restrict(&mut self, finer: &[Vec3]) {
        for (x, &v) in self.x.iter_mut().zip(&self.fine) {
            *x = finer[v as usize];
        }
        self.before.copy_from_slice(&self.x);
    }

    /// Relaxes the links by `sweeps`, each projection times `stiffness`.
    pub(super) fn relax(&mut self, sweeps: u32, stiffness: Real) {
        self.tethers.reset();
        self.tethers
            .sweep(&TetherUpdate::Begin, &self.inverse_mass, &mut self.x);
        let update = TetherUpdate::Project(stiffness);
        for _ in 0..sweeps {
            self.tethers.sweep(&update, &self.inverse_mass, &mut self.x);
        }
    }

    /// Adds the prolongated correction to the next finer level: `Δxᵢ = Σⱼ Pᵢⱼ Δxⱼ`.
    pub(super) fn prolongate(&self, finer: &mut [Vec3]) {
        for (vertex, finer) in finer.iter_mut().enumerate() {
            for &(parent, weight) in self.prolongation.of_fine(vertex) {
                let parent = parent as usize;
                *finer += (self.x[parent] - self.before[parent]) * weight;
            }
        }
    }
}
