//! Truncation by contact that fades: what is left of each path, in closed form.

use cloth_core::contact::{
    ContactError, ContactPotential, ContactRow, ContactStep, FadingTruncation,
};
use cloth_core::math::{Real, Vec3};

/// Stops vertex 10 at half of its path, and counts how often it was asked.
#[derive(Debug)]
struct Stop(u32);

impl ContactPotential for Stop {
    fn begin(&mut self, _: &ContactStep<'_>, _: &mut [Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn limit(&mut self, _: &[Vec3], _: &[Vec3]) -> Result<Real, ContactError> {
        Ok(1.0)
    }

    fn limit_each(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        fractions: &mut [Real],
    ) -> Result<(), ContactError> {
        self.0 += 1;
        fractions.fill(1.0);
        if to[10].z < -0.05 {
            (to[10].z, fractions[10]) = (-0.05, 0.05 / (from[10].z - to[10].z));
        }
        Ok(())
    }

    fn add_gradient(&self, _: &[Vec3], _: &mut [Vec3]) -> Real {
        0.0
    }

    fn linearize(&self, _: &[Vec3], _: &mut Vec<ContactRow>) {}

    fn end(&mut self, _: &[Vec3], _: &[Vec3]) {}
}

/// Vertices 1 cm apart that all move down by 10 cm. Beside one that is stopped after 5 cm, each goes 0.3 mm further
/// than the one before, in whatever order they are numbered; what is coupled to none of them is not stopped.
#[test]
fn a_displacement_fades_by_three_percent_of_the_distance() {
    let count = 60;
    // 0 to 40 in a row, though not in the order of their numbers; the rest without neighbours.
    let place = |v: usize| (v * 17) % 41;
    let vertex: Vec<usize> = (0..41)
        .map(|at| (0..41).find(|&v| place(v) == at).unwrap())
        .collect();
    let x = |v: usize| Vec3::new(0.01 * place(v) as Real, if v < 41 { 0.0 } else { 1.0 }, 0.0);
    let from: Vec<Vec3> = (0..count).map(x).collect();
    let mut to: Vec<Vec3> = from.iter().map(|x| x - 0.1 * Vec3::z()).collect();
    let neighbours = |v: usize| {
        let next = (v < 41 && place(v) < 40).then(|| vertex[place(v) + 1]);
        next.into_iter()
    };
    let mut contact = Stop(0);
    let mut truncation = FadingTruncation::default();
    truncation
        .limit(&mut contact, &from, &mut to, neighbours)
        .unwrap();
    assert_eq!(contact.0, 2);
    for v in 0..count {
        let away = place(v).abs_diff(place(10)) as Real;
        let depth = if v < 41 { 0.05 + 3e-4 * away } else { 0.1 };
        assert!((to[v].z + depth).abs() < 1e-15, "{v}: {}", to[v].z);
    }
    // Nothing is stopped: one question, and no digit changes.
    let mut near: Vec<Vec3> = from.iter().map(|x| x - 0.01 * Vec3::z()).collect();
    let whole = near.clone();
    truncation
        .limit(&mut contact, &from, &mut near, neighbours)
        .unwrap();
    assert_eq!((contact.0, near), (3, whole));
}
