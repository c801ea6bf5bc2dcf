//! One coarse level: its links, and what it hands down.

use super::tether::{Pull, Tether};
use cloth_core::math::{Real, Vec3};
use cloth_core::position_based::{Acceleration, Families, Sweep};
use cloth_core::step::BuildError;
use cloth_core::topology::CoarseLevel;

#[derive(Debug)]
pub(super) struct Level {
    /// Number in the next finer level of each vertex.
    fine: Vec<u32>,
    /// Number in the mesh of each vertex.
    pub(super) original: Vec<u32>,
    /// What the next finer level gets from this one: fine vertex, then parents `shares[starts[i]..starts[i + 1]]` with weights.
    children: Vec<u32>,
    starts: Vec<u32>,
    shares: Vec<(u32, Real)>,
    /// Masses (kg), that of the children included, and inverse masses (1/kg), 0 for a prescribed vertex.
    pub(super) mass: Vec<Real>,
    inverse_mass: Vec<Real>,
    pub(super) links: Vec<Tether>,
    tethers: Families<Pull>,
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
            ..
        } = coarse;
        let mut own: Vec<Real> = fine.iter().map(|&v| mass[v as usize]).collect();
        let (mut children, mut starts, mut shares) = (Vec::new(), vec![0], Vec::new());
        for (child, parents) in coarse.parents {
            for &(parent, weight) in &parents {
                own[parent as usize] += weight * mass[child as usize];
            }
            children.push(child);
            shares.extend(parents);
            starts.push(shares.len() as u32);
        }
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
            children,
            starts,
            shares,
            mass: own,
            inverse_mass,
            links,
            tethers,
        })
    }

    /// Parents, by their numbers in this level, and weights of each vertex of the next finer level that is not in this one.
    pub(super) fn parents(&self) -> impl Iterator<Item = (u32, &[(u32, Real)])> {
        let ranges = self.starts.windows(2);
        let shares = ranges.map(|w| &self.shares[w[0] as usize..w[1] as usize]);
        self.children.iter().copied().zip(shares)
    }

    pub(super) fn positions_mut(&mut self) -> &mut [Vec3] {
        &mut self.x
    }

    pub(super) fn positions(&self) -> &[Vec3] {
        &self.x
    }

    /// Takes the positions of the next finer level.
    pub(super) fn take(&mut self, finer: &[Vec3]) {
        for (x, &v) in self.x.iter_mut().zip(&self.fine) {
            *x = finer[v as usize];
        }
        self.before.copy_from_slice(&self.x);
    }

    /// Sweeps over the links, each of which goes the part `stiffness` of its way.
    pub(super) fn pull(&mut self, sweeps: u32, stiffness: Real) {
        self.tethers.forget();
        self.tethers
            .sweep(&Pull::Begin, &self.inverse_mass, &mut self.x);
        let rule = Pull::Go(stiffness);
        for _ in 0..sweeps {
            self.tethers.sweep(&rule, &self.inverse_mass, &mut self.x);
        }
    }

    /// Moves the next finer level along: its vertices that are in this one too, and the others by the weighted mean of their parents.
    pub(super) fn hand_down(&self, finer: &mut [Vec3]) {
        for ((x, before), &v) in self.x.iter().zip(&self.before).zip(&self.fine) {
            finer[v as usize] += x - before;
        }
        for (child, parents) in self.parents() {
            for &(parent, weight) in parents {
                let parent = parent as usize;
                finer[child as usize] += (self.x[parent] - self.before[parent]) * weight;
            }
        }
    }
}
