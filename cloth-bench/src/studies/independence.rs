//! Is it the same cloth on another mesh and with another step?

use crate::studies::prelude::*;

pub(super) const STUDY: Study = Study {
    name: "independence",
    question: "Does a method show the same cloth at every resolution and every frame rate?",
    about: "A sheet of 1 m × 1 m with the same density, modulus (1e4 N/m) and rigidity (1e-5 N·m) on every mesh, held at two corners, falls from the horizontal for 0.5 s. fall (m) is that of the centre of mass, strain the root mean square over the edges; \
        both beside the converged value: BDF2 on the finest mesh with the shortest step. Independent converged codes agree on a fall of 0.487 m to 0.50 m. Published settings, which is the point: a method whose published setting is a number of iterations shows another cloth on another mesh. \
        A stretchy method falls farther and strains more; one that is numerically heavy falls less. What may surprise: implicit Euler with long steps falls too far, as free fall does in it, by one step more, while its linearised step falls too little; short steps, not more iterations, cure both.",
    run,
};

const SECONDS: Real = 0.5;
/// The frame rate at which resolutions are compared, and the mesh on which frame rates are.
const RATE: u32 = 60;

fn methods() -> Vec<&'static str> {
    method::with_own(&[
        "implicit-euler",
        "linear-implicit",
        "implicit-midpoint",
        "bdf2",
        "pbd",
        "xpbd",
        "pd",
    ])
}

/// Vertices a side.
fn sizes(scope: Scope) -> &'static [usize] {
    scope.pick(&[9, 17], &[16, 24, 32, 48, 64])
}

/// Steps per second.
fn rates(scope: Scope) -> &'static [u32] {
    scope.pick(&[30, 60, 120], &[30, 60, 120, 240])
}

/// Vertices a side and steps per second of the converged value.
fn finest(scope: Scope) -> (usize, u32) {
    scope.pick((17, 240), (64, 480))
}

fn middle(scope: Scope) -> usize {
    sizes(scope)[sizes(scope).len() / 2]
}

/// Every resolution at one rate, then every other rate at one resolution.
fn grid(scope: Scope) -> Vec<(usize, u32)> {
    let by_size = sizes(scope).iter().map(|&n| (n, RATE));
    let others = rates(scope).iter().filter(|&&rate| rate != RATE);
    by_size
        .chain(others.map(|&rate| (middle(scope), rate)))
        .collect()
}

/// Where a sheet is after half a second.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Fallen {
    fall: Number,
    strain: Number,
}

fn fall(name: &str, n: usize, rate: u32) -> Result<Fallen, BenchError> {
    let settings = Settings::default().with("n", n).with("modulus", 1e4);
    let scene = scene::build("hang", None, &settings)?;
    let dt = 1.0 / Real::from(rate);
    let steps = (SECONDS * Real::from(rate)).round() as u32;
    let method = Method::find(name)?;
    let (end, _) = run::from_start(
        &scene,
        method,
        &Settings::default(),
        dt,
        steps,
        |_, _, _| Ok(()),
    )?;
    Ok(Fallen {
        fall: Number(end.center_of_mass_drop),
        strain: Number(end.rms_strain),
    })
}

/// A method on one mesh with one step.
#[derive(Default, Serialize)]
struct Row {
    method: &'static str,
    vertices_a_side: usize,
    steps_per_second: u32,
    #[serde(rename = "fall (m)")]
    fall: Real,
    fall_over_converged: Real,
    strain: Real,
    strain_over_converged: Real,
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let (n, rate) = finest(scope);
    // Everything else is relative to it.
    let Some(converged) = study.case("converged", || fall("bdf2", n, rate)) else {
        return Ok(());
    };
    let grid = grid(scope);
    let of_method = |method| grid.iter().map(move |&(n, rate)| (method, n, rate));
    let found = study.grid_side_by_side(
        methods().into_iter().flat_map(of_method),
        |(method, n, rate)| format!("{method}, {n} vertices a side, 1/{rate} s"),
        |&(method, n, rate)| fall(method, n, rate),
    );
    let row = |((method, n, rate), Fallen { fall, strain })| Row {
        method,
        vertices_a_side: n,
        steps_per_second: rate,
        fall: fall.0,
        fall_over_converged: fall.0 / converged.fall.0,
        strain: strain.0,
        strain_over_converged: strain.0 / converged.strain.0,
    };
    let rows: Vec<Row> = found.into_iter().map(row).collect();
    let at_rate = || rows.iter().filter(|row| row.steps_per_second == RATE);
    let mut at_size: Vec<&Row> = rows
        .iter()
        .filter(|row| row.vertices_a_side == middle(scope))
        .collect();
    at_size.sort_by_key(|row| std::cmp::Reverse(row.steps_per_second));
    let (size, step) = (
        |row: &Row| row.vertices_a_side as Real,
        |row: &Row| 1.0 / Real::from(row.steps_per_second),
    );
    let fall = Axis::linear("fall over converged (dimensionless)");
    let vertices = Axis::log("vertices a side (dimensionless)");
    let by_size = curves(at_rate(), |row| {
        (row.method, (size(row), row.fall_over_converged))
    });
    let by_step = curves(at_size.iter().copied(), |row| {
        (row.method, (step(row), row.fall_over_converged))
    });
    let strains = curves(at_rate(), |row| {
        (row.method, (size(row), row.strain_over_converged))
    });
    let one = |ends: [Real; 2]| ends.map(|x| (x, 1.0));
    let sizes = one(ends(sizes(scope).iter().map(|&n| n as Real)));
    let steps = one(ends(rates(scope).iter().map(|&r| 1.0 / Real::from(r))));
    let note = "1 is the converged value.";
    let title = "The fall in 0.5 s, steps of 1/60 s";
    let plot = Plot::new(title, vertices.clone(), fall.clone()).with(by_size);
    let plot = plot.exact("converged", sizes).note(note);
    study.findings.plot("independence-size", &plot);
    let plot = Plot::new("The fall in 0.5 s on one mesh", Axis::log("step (s)"), fall);
    let plot = plot.with(by_step).exact("converged", steps).note(note);
    study.findings.plot("independence-step", &plot);
    let strain = Axis::log("strain over converged (dimensionless)");
    let plot = Plot::new("The strain after 0.5 s, steps of 1/60 s", vertices, strain);
    let plot = plot.with(strains).exact("converged", sizes).note(note);
    study.findings.plot("independence-strain", &plot);
    let told = methods().into_iter().map(|method| {
        let of = |row: &&&Row| row.method == method;
        let fall = range(at_rate().filter(|row| of(&row)).map(|row| row.fall_over_converged));
        let by_step = range(at_size.iter().filter(of).map(|row| row.fall_over_converged));
        let strain = range(at_rate().filter(|row| of(&row)).map(|row| row.strain_over_converged));
        format!(
            "{method} falls {fall} of the converged way over all resolutions and {by_step} over all steps, at {strain} times the strain",
        )
    });
    study.findings.section.verdict = Some(format!(
        "Converged, the sheet falls {} m in 0.5 s. {}.",
        significant(converged.fall.0, 4),
        told.collect::<Vec<_>>().join("; ")
    ));
    let caption = "The same cloth on every mesh, with every step";
    let table = Table::of(&rows);
    study.findings.table("independence", caption, table);
    Ok(())
}

/// Least and largest of some values; infinite without any.
fn ends(values: impl Iterator<Item = Real>) -> [Real; 2] {
    values.fold([Real::INFINITY, -Real::INFINITY], |[least, most], value| {
        [least.min(value), most.max(value)]
    })
}

fn range(values: impl Iterator<Item = Real>) -> String {
    match ends(values) {
        [least, most] if least <= most => {
            format!("{} to {}", significant(least, 3), significant(most, 3))
        }
        _ => "nothing known".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent converged codes agree on 0.487 m to 0.50 m.
    #[test]
    fn the_sheet_falls_as_far_as_it_should() {
        let fallen = fall("bdf2", 17, 240).unwrap();
        assert!((0.487..0.50).contains(&fallen.fall.0), "{fallen:?}");
    }

    #[test]
    fn a_range_is_least_to_largest() {
        assert_eq!(range([2.0, 1.0, 3.0].into_iter()), "1 to 3");
        assert_eq!(range(std::iter::empty()), "nothing known");
    }
}
