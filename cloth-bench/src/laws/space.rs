//! Degrees of freedom, and two methods with one minimum.

use super::prelude::*;
use crate::mesh_spec;
use crate::scene;
use crate::yardstick;
use cloth_core::dof::{EdgeRank, perturbed};
use cloth_core::mesh::TriMesh;
use cloth_core::topology::{EdgeTable, Topology};
use cloth_pd::{PdConfig, PdSolver};

crate::settings! {
    /// Of laws of meshes.
    struct MeshSetting {
        mesh: String = "grid:9x9:alternating", "a generator or a file";
    }
}

pub(super) const COUNT: Law = Law {
    name: "count",
    about: "3V − E = 3χ + E_b, on any mesh",
    parameters: &[MeshSetting::PARAMETERS],
    tolerance: 0.0,
    evaluate: count,
};

pub(super) const NULL_SPACE: Law = Law {
    name: "null-space",
    about: "motions that keep every edge of the bent mesh: 3χ + E_b, but at least the six rigid ones of each piece; the flat ones are a detail",
    parameters: &[MeshSetting::PARAMETERS],
    tolerance: 0.0,
    evaluate: null_space,
};

law! {
    SAME_MINIMUM = "same-minimum" within 1e-9,
    "distance (m) between the converged step of PD and that of Newton, on the hanging sheet: 0";
    same_minimum(SameMinimumSettings {
        n: u32 = 9 in AtLeast(2.0), "vertices a side";
        stiffness: Real = 100 "N/m" in Above(0.0), "stiffness of the springs";
    })
}

fn counted(settings: &Settings) -> Result<(TriMesh, EdgeTable, Topology), BenchError> {
    let mesh = mesh_spec::load(&MeshSetting::read(settings)?.mesh)?;
    let edges = EdgeTable::build(&mesh).map_err(BenchError::usage)?;
    let topology = Topology::of(&mesh, &edges);
    Ok((mesh, edges, topology))
}

/// `3χ + E_b`.
fn closed_form(topology: &Topology) -> Real {
    (3 * topology.euler + topology.boundary_edges as i64) as Real
}

fn count(settings: &Settings) -> Result<Evaluation, BenchError> {
    let (_, _, topology) = counted(settings)?;
    let evaluation = Evaluation::new(closed_form(&topology), topology.count_3v_e as Real);
    Ok(evaluation
        .detail("euler", topology.euler as Real)
        .detail("boundary_edges", topology.boundary_edges as Real))
}

fn null_space(settings: &Settings) -> Result<Evaluation, BenchError> {
    let (mesh, edges, topology) = counted(settings)?;
    let measure =
        |positions: &[_]| EdgeRank::measure(positions, &edges).map_err(BenchError::failed);
    let rest = measure(mesh.positions())?;
    let curved = measure(&perturbed(mesh.positions()))?;
    // Every piece keeps its six rigid motions, however many edges there are.
    let expected = closed_form(&topology).max(6.0 * topology.components as Real);
    Ok(Evaluation::new(expected, curved.nullity as Real)
        .detail("nullity_flat", rest.nullity as Real)
        .detail("self_stresses_flat", rest.self_stresses as Real)
        .detail("self_stresses_bent", curved.self_stresses as Real)
        .detail(
            "smallest_nonzero_singular_value_bent",
            curved.smallest_nonzero_singular_value,
        ))
}

fn same_minimum(own: &SameMinimumSettings) -> Result<Evaluation, BenchError> {
    let side = *own.n;
    within_reach(1e3 * Real::from(side).powi(4))?;
    let settings = Settings::default()
        .with("n", side)
        .with("stiffness", *own.stiffness);
    let scene = scene::build("hang", None, &settings)?;
    let input = || StepInput::new(scene.dt).gravity(scene.gravity);
    let mut newton = yardstick::reference(&scene.model)?;
    let mut before = scene.start.clone();
    for _ in 0..10 {
        newton.step(&mut before, input())?;
    }
    let mut by_newton = before.clone();
    newton.step(&mut by_newton, input())?;
    let config = PdConfig {
        iterations: Some(100_000),
        tolerance: Some(1e-12),
        ..Default::default()
    };
    let mut pd = PdSolver::builder(&scene.model.particles)
        .elements(scene.model.families())
        .config(config)
        .build()?;
    let mut by_pd = before;
    let report = pd.step(&mut by_pd, input())?;
    let apart = by_pd.positions.iter().zip(&by_newton.positions);
    let distance = apart.map(|(a, b)| (a - b).norm()).fold(0.0, Real::max);
    Ok(Evaluation::new(0.0, distance).detail("pd_iterations", Real::from(report.iterations)))
}
