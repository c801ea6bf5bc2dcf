//! The drape over a sphere: a square sheet, held in the middle, falls on a sphere of 0.3 m and lies there, as in the
//! scene `drape-sphere`, without friction.
//!
//! No sheet lies on a sphere without stretching, so there is no developable answer: what cannot stretch touches along
//! lines and stands off in folds. Folds need bending, and a locked sheet makes few. So what is compared is one and the
//! same sheet as its edges get stiffer, which a sheet that is merely stiff does not notice, and one and the same drape
//! as its mesh gets finer: each mesh begins where the coarser one came to rest ([`super::finer`]), which also is what
//! makes 128 cells a side affordable.

use super::finer::refined;
use super::sheet::{KINDS, Kind, Sheet, square};
use super::{count, fold};
use crate::studies::prelude::*;
use cloth_core::cloth::ClothModel;
use cloth_core::dof::EdgeRank;
use cloth_core::energy::Spring;
use cloth_core::topology::EdgeTable;

/// D (N·m): cloth of this weight bends under itself over 8 cm.
const RIGIDITY: Real = 1e-3;
/// Y (N/m): soft for the size of the folds, and stiff.
pub const MODULI: [Real; 2] = [1e3, 1e5];
/// Everything this near (m) to the middle of the sheet is held, or a sheet that does not give slides off.
const HELD: Real = 0.06;
/// Cells a side of one drape made finer and finer.
const SIZES: [usize; 4] = [16, 32, 64, 128];
const DT: Real = 1.0 / 60.0;
const MOST_STEPS: u32 = 200;
/// When nothing is faster than this (m/s), it is at rest.
const STILL: Real = 2e-3;
/// The method of the patterns, kinds of membrane and resolutions: one linear solve a step. What is at rest in it is at
/// rest in every method that solves its steps.
const METHOD: &str = "linear-implicit";

fn patterns(scope: Scope) -> &'static [&'static str] {
    scope.pick(&["alternating"], &count::PATTERNS)
}

/// One drape; a kind of membrane by its place in `KINDS`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// The pattern of the mesh.
    pub pattern: &'static str,
    /// Its place in `KINDS`.
    pub kind: usize,
    /// Y (N/m).
    pub modulus: Real,
    /// Name of the method.
    pub method: &'static str,
    /// 0: as published.
    pub iterations: u32,
    /// Cells a side.
    pub cells: usize,
}

impl Case {
    fn solver(&self) -> String {
        match self.iterations {
            0 => self.method.to_owned(),
            n => format!("{}, {n} iterations", self.method),
        }
    }

    fn name(&self) -> String {
        let Self {
            pattern,
            cells,
            modulus,
            ..
        } = self;
        let (membrane, solver) = (KINDS[self.kind].0, self.solver());
        format!("drape, {pattern}, {cells} cells, {membrane}, Y = {modulus:e} N/m, {solver}")
    }
}

/// What came of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Drape {
    #[serde(rename = "coordinates − conditions")]
    coordinates_left: i64,
    nullity_draped: usize,
    /// How far (m) they end below the highest vertex, in the mean.
    #[serde(rename = "corners below the top")]
    corners: Real,
    #[serde(rename = "bending energy (mJ)")]
    bending: Real,
    membrane_over_bending: Real,
    rms_strain: Real,
    /// None: never at rest.
    steps_to_rest: Option<u32>,
}

/// What the others differ from.
const BASE: Case = Case {
    pattern: "alternating",
    kind: 0,
    modulus: MODULI[1],
    method: METHOD,
    iterations: 0,
    cells: SIZES[0],
};

/// Every drape.
pub fn list(scope: Scope) -> Vec<Case> {
    let mut cases = Vec::new();
    let of_pattern = |(&pattern, modulus)| Case {
        pattern,
        modulus,
        ..BASE
    };
    cases.extend(iproduct!(patterns(scope), MODULI).map(of_pattern));
    if scope == Scope::Quick {
        return cases;
    }
    // Midpoints have no surface that contact knows of.
    let others = (1..KINDS.len()).filter(|&kind| KINDS[kind].1 != Kind::Midpoints);
    let of_kind = |(kind, modulus)| Case {
        kind,
        modulus,
        ..BASE
    };
    cases.extend(iproduct!(others, MODULI).map(of_kind));
    let own = iterating_own().map(|own| (own.name, 0));
    let compared = ["implicit-euler", "pd", "xpbd"].map(|method| (method, 0));
    let compared = compared
        .into_iter()
        .chain([5, 20, 80, 320].map(|count| ("pbd", count)));
    let of_method = |(method, iterations)| Case {
        method,
        iterations,
        ..BASE
    };
    cases.extend(compared.chain(own).map(of_method));
    cases
}

/// The drapes that are made finer and finer, each from the one before.
fn chains(scope: Scope) -> Vec<Case> {
    // By another method where that is cheap: PD takes minutes for stiff edges.
    let all = [(METHOD, MODULI[0]), (METHOD, MODULI[1]), ("pd", MODULI[0])];
    let chain = |(method, modulus)| Case {
        method,
        modulus,
        ..BASE
    };
    scope.pick(vec![], all.map(chain).to_vec())
}

/// A sheet hung over the sphere from `start` (m), or from flat, until it is at rest; and its points (m) there.
fn drape(case: &Case, start: Option<Vec<Vec3>>) -> Result<(Drape, Vec<Vec3>), BenchError> {
    let mesh = square(case.pattern, case.cells)?;
    let mut sheet = Sheet::new(mesh, KINDS[case.kind].1, case.modulus, RIGIDITY)?;
    sheet.hold(|p| (p - Vec3::new(0.5, 0.5, 0.0)).norm() < HELD)?;
    let conditions = sheet.conditions()?;
    let settings = Settings::default();
    let contact = Settings::default().with("friction", 0);
    let scene = Scene {
        model: ClothModel {
            particles: sheet.particles.clone(),
            springs: Vec::new(),
            hinges: Vec::new(),
            others: sheet.families(),
        },
        start: State::at_rest(held_in_place(&sheet, start)),
        mesh: Some(sheet.mesh.clone()),
        gravity: Vec3::z() * -fold::GRAVITY,
        // The obstacle under any sheet of this size.
        ..scene::build("drape-sphere", Some("grid:2x2:one-way"), &contact)?
    };
    let settings = match case.iterations {
        0 => settings,
        n => settings.with("iterations", n),
    };
    let mut stepper = Method::find(case.method)?.build(&scene, &settings, DT)?;
    let mut state = scene.start.clone();
    let steps = run::to_rest(&scene, stepper.as_mut(), &mut state, DT, MOST_STEPS, STILL)?;
    let edges = EdgeTable::build(&sheet.mesh)?;
    let gauges = Spring::along(sheet.mesh.positions(), edges.ends(), 0.0);
    let x = &state.positions;
    let rank = EdgeRank::of_pairs(x, &conditions)?;
    let bending = sheet.bending_energy(x)?;
    let found = Drape {
        coordinates_left: 3 * x.len() as i64 - conditions.len() as i64,
        nullity_draped: rank.nullity,
        corners: fall_of_corners(sheet.mesh.positions(), x),
        bending: 1e3 * bending,
        membrane_over_bending: sheet.membrane_energy(x)? / bending,
        rms_strain: Strain::of(&gauges, x).rms,
        steps_to_rest: steps,
    };
    Ok((found, state.positions))
}

/// The points (m) a drape begins with: those given, or flat; what is held is where it is at rest.
fn held_in_place(sheet: &Sheet, start: Option<Vec<Vec3>>) -> Vec<Vec3> {
    let mut points = start.unwrap_or_else(|| sheet.points.clone());
    for (point, x) in points.iter_mut().enumerate() {
        if sheet.particles.is_prescribed(point) {
            *x = sheet.points[point];
        }
    }
    points
}

/// The same drape with every number of cells of [`SIZES`]; the first begins flat, each other where the one before came
/// to rest.
fn chain(first: &Case) -> Result<Vec<Drape>, BenchError> {
    let mut drapes = Vec::new();
    let mut start = None;
    for cells in SIZES {
        let (found, at_rest) = drape(&Case { cells, ..*first }, start.take())?;
        drapes.push(found);
        start = Some(refined(&at_rest, cells)?);
    }
    Ok(drapes)
}

/// How far (m) the four corners of the unit square are below the highest vertex, in the mean.
pub fn fall_of_corners(rest: &[Vec3], positions: &[Vec3]) -> Real {
    let heights = positions.iter().map(|p| p.z);
    let highest = heights.fold(Real::NEG_INFINITY, Real::max);
    let corner = |x: Real, y: Real| {
        let far = |p: &Vec3| (p.x - x).powi(2) + (p.y - y).powi(2);
        let both = rest.iter().zip(positions);
        let nearest = both.min_by(|(p, _), (q, _)| far(p).total_cmp(&far(q)));
        nearest.map_or(0.0, |(_, p)| highest - p.z)
    };
    0.25 * (corner(0.0, 0.0) + corner(1.0, 0.0) + corner(0.0, 1.0) + corner(1.0, 1.0))
}

/// What the drapes say: how far the corners come down at the stiffer modulus, over what they do at the softer.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Drapes {
    /// Pattern and ratio: least and largest.
    pub(super) kept: Option<[(String, Real); 2]>,
    /// Cells a side, and how far (m) the corners come down at either modulus: least and most cells.
    pub(super) sizes: Option<[(usize, [Real; 2]); 2]>,
}

/// What the table says of a drape beside that.
const HEAD: [&str; 6] = ["pattern", "cells", "membrane", "Y", "method", "begins"];

pub(super) fn run(study: &mut StudyRun<'_>) -> Drapes {
    let scope = study.scope;
    let flat = study.grid_side_by_side(list(scope), Case::name, |case| Ok(drape(case, None)?.0));
    let finer = study.grid_side_by_side(
        chains(scope),
        |first| format!("{}, made finer", first.name()),
        chain,
    );
    let finer = finer.into_iter().flat_map(|(first, drapes)| {
        let of_size = move |(cells, found)| (Case { cells, ..first }, found);
        SIZES.into_iter().zip(drapes).map(of_size)
    });
    let finer: Vec<(Case, Drape)> = finer.collect();
    let row = |(case, found): &(Case, Drape)| {
        let begins = match case.cells == SIZES[0] {
            true => "flat",
            false => "from the coarser",
        };
        let (mesh, membrane) = ((case.pattern, case.cells), KINDS[case.kind].0);
        (mesh, membrane, case.modulus, case.solver(), begins, *found)
    };
    let rows = flat.iter().chain(&finer).map(row).collect_vec();
    let table = Table::named(&HEAD, &rows);
    study.table("locking-sphere", "Sheets draped over a sphere", table);
    let depth = |(case, found): &(Case, Drape)| (*case, found.corners);
    let springs = flat.iter().filter(|(case, _)| case.kind == 0);
    let fallen: Vec<(Case, Real)> = springs.map(depth).collect();
    let made_finer: Vec<(Case, Real)> = finer.iter().map(depth).collect();
    Drapes {
        kept: kept(&fallen).map(|both| both.map(|(pattern, share)| (pattern.to_owned(), share))),
        sizes: sizes(&made_finer),
    }
}

/// How deep (m) the corners are at both moduli with the fewest and the most cells a side, by `METHOD`.
pub fn sizes(made_finer: &[(Case, Real)]) -> Option<[(usize, [Real; 2]); 2]> {
    let ours = || made_finer.iter().filter(|(case, _)| case.method == METHOD);
    let cells = || ours().map(|(case, _)| case.cells);
    let at = |cells: usize| {
        let depth = |modulus: Real| {
            let wanted = |(case, _): &&(Case, Real)| case.cells == cells && case.modulus == modulus;
            ours().find(wanted).map(|&(_, depth)| depth)
        };
        Some((cells, [depth(MODULI[0])?, depth(MODULI[1])?]))
    };
    Some([at(cells().min()?)?, at(cells().max()?)?])
}

/// Least and largest share of the depth of the corners that is kept from the softer modulus to the stiffer, with their
/// patterns.
pub fn kept(fallen: &[(Case, Real)]) -> Option<[(&'static str, Real); 2]> {
    let at = |pattern: &str, modulus: Real| {
        let wanted = |(case, _): &&(Case, Real)| {
            case.pattern == pattern && case.modulus == modulus && case.method == METHOD
        };
        fallen.iter().find(wanted).map(|&(_, depth)| depth)
    };
    let ratio = |pattern| Some((pattern, at(pattern, MODULI[1])? / at(pattern, MODULI[0])?));
    let ratios = count::PATTERNS.into_iter().filter_map(ratio);
    let (least, most) = ratios.minmax_by(|a, b| a.1.total_cmp(&b.1)).into_option()?;
    Some([least, most])
}
