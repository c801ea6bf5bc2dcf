//! Truncation by contact that fades: what is left of each path, in closed form.

use cloth_core::contact::{
    ContactError, ContactPotential, ContactRow, ContactStep, FadingTruncation,
};
use cloth_core::math::{Real, Vec3};

/// Stops vertex 10 at half of its path if it `stops`, lets common paths go on if they are free, and records from where
/// a step and its paths go, and how often it was asked.
#[derive(Debug, Default)]
struct Recorder {
    stops: bool,
    is_free: bool,
    asked: u32,
    begun: Vec<Vec3>,
    from: Vec<Vec3>,
}

impl ContactPotential for Recorder {
    fn begin(&mut self, _: &ContactStep<'_>, start: &mut [Vec3]) -> Result<(), ContactError> {
        self.begun = start.to_vec();
        Ok(())
    }

    fn limit(&mut self, _: &[Vec3], _: &[Vec3]) -> Result<Real, ContactError> {
        Ok(if self.is_free { 1.0 } else { 0.9 })
    }

    fn limit_each(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        fractions: &mut [Real],
    ) -> Result<(), ContactError> {
        self.asked += 1;
        self.from = from.to_vec();
        fractions.fill(1.0);
        if self.stops && to[10].z < -0.05 {
            (to[10].z, fractions[10]) = (-0.05, 0.05 / (from[10].z - to[10].z));
        }
        Ok(())
    }

    fn add_gradient(&self, _: &[Vec3], _: &mut [Vec3]) -> Real {
        0.0
    }

    fn linearize(&self, _: &[Vec3], _: &mut Vec<ContactRow>) {}

    fn end(&mut self, _: &[Vec3], _: &mut [Vec3]) {}
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
    let mut contact = Recorder {
        stops: true,
        ..Recorder::default()
    };
    let mut truncation = FadingTruncation::default();
    truncation
        .limit(&mut contact, &from, &mut to, neighbours)
        .unwrap();
    assert_eq!(contact.asked, 2);
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
    assert_eq!((contact.asked, near), (3, whole));
}

/// Four pieces of three vertices: one flies, one flies with a prescribed vertex, one is torn in two directions, and one
/// flies while its prescribed vertex stays. Then all of them together.
#[test]
fn a_piece_that_flies_goes_as_a_whole_first() {
    let from: Vec<Vec3> = (0..12).map(|v| Vec3::new(f64::from(v), 0.0, 0.0)).collect();
    let neighbours = |v: usize| (v % 3 < 2).then_some(v + 1).into_iter();
    let mut inverse_mass = [1.0; 12];
    (inverse_mass[3], inverse_mass[9]) = (0.0, 0.0);
    let step = ContactStep {
        from: &from,
        inverse_mass: &inverse_mass,
        dt: 0.01,
    };
    let mut displacements = [
        [1.0, 1.1, 0.9],
        [2.0, 2.1, 2.2],
        [1.0, -2.0, 1.5],
        [0.0, 3.0, 3.0],
    ];
    let places = |of: &[[Real; 3]; 4]| -> Vec<Vec3> {
        let all = from.iter().zip(of.as_flattened());
        all.map(|(x, z)| x + Vec3::new(0.0, 0.0, *z)).collect()
    };
    let mut truncation = FadingTruncation::default();
    let mut begin = |is_free: bool, displacements: &[[Real; 3]; 4]| {
        let mut contact = Recorder {
            is_free,
            ..Recorder::default()
        };
        let (mut feasible, mut start) = (from.clone(), places(displacements));
        let found = truncation.begin(&mut contact, &step, &mut feasible, &mut start, neighbours);
        found.unwrap();
        assert_eq!(start, places(displacements));
        assert_eq!(contact.from, feasible);
        [contact.begun, feasible]
    };
    let are = |x: &[Vec3], displacements: [[Real; 3]; 4]| {
        let places = places(&displacements);
        let error = x.iter().zip(&places).map(|(a, b)| (a - b).norm());
        let error = error.fold(0.0, Real::max);
        assert!(error < 1e-14, "{x:?} for {places:?}");
    };
    for is_free in [true, false] {
        let [begun, feasible] = begin(is_free, &displacements);
        // A prescribed vertex is where it will end, and takes the others of its piece along.
        let flown = if is_free { 1.0 } else { 0.0 };
        are(&begun, [[0.0; 3], [2.0, 2.1, 2.1], [0.0; 3], [0.0; 3]]);
        are(&feasible, [[flown; 3], [2.0, 2.1, 2.1], [0.0; 3], [0.0; 3]]);
    }
    // All together, and by the motion that they have together.
    for piece in &mut displacements {
        *piece = piece.map(|z| 20.0 + 0.1 * z);
    }
    let mean = displacements.as_flattened().iter().sum::<Real>() / 12.0;
    let [held, other] = [3, 9].map(|v| displacements[v / 3][v % 3]);
    let whole = [
        [mean; 3],
        [held, mean, mean],
        [mean; 3],
        [other, mean, mean],
    ];
    for is_free in [true, false] {
        let [begun, feasible] = begin(is_free, &displacements);
        are(&begun, whole);
        are(&feasible, whole);
    }
}
