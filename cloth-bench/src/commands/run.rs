//! `cloth-bench run SCENE --method M`

mod forces;
mod picture;
mod pin_loads;

use super::{PATIENCE, check_files, print_pairs, while_saying, write_file};
use crate::error::BenchError;
use crate::export::{Export, Format};
use crate::memory;
use crate::method::Method;
use crate::run::{Moment, Plan, SeparationWatch, Solver, crossing_warnings, run_changing};
use crate::scene::{self, ContactSetup, Scene, SceneInfo};
use crate::settings::Settings;
use crate::yardstick::StepProblem;
use clap::Args;
use cloth_collide::untangle::CrossingPairs;
use cloth_core::math::{Real, Vec3, is_finite};
use cloth_core::step::Stepper;
use forces::ForcesTable;
use indicatif::{ProgressBar, ProgressStyle};
use pin_loads::PinLoadsTable;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What the numbers mean whose names do not say it.
const NUMBERS: &str = "\
Of the numbers that come out:
  pins                 vertices that are held at the end, after all that was grabbed and released on the way
  ms_per_step_max      the longest step (ms); a contact in which much is folded takes far more than the median
  max_stretch_of_all   largest strain of an edge after any step; max_stretch is that at the end
  elastic_energy       of all elements at the end (J)
  gravity_energy       at the end, relative to the start: −Σ m g·(x − x₀) (J)
  contact_energy       of the cloth with itself and with bodies at the end (J)
  potential_energy     elastic_energy + gravity_energy + contact_energy + what sealed volumes store (J)
  energy_excess        the most by which the cloth held more energy than it was given: from nowhere (J)
  energy_given         the most that its start, gravity, pins, bodies, air and gas gave it (J)
  contact_energy_at_start  of a cloth that starts nearer to itself or to a body than the thickness (J)
  center_of_mass_drop  against gravity (m)
  chebyshev_fallbacks  substeps of pbd and xpbd that gave up their extrapolation because it made the corrections grow
  coarse_builds        coarse grids that pd made anew because pins had changed
  coarse_fallbacks     iterations of pd's steps that went without the coarse grid, because it could not be made or factorised
  newton_fallbacks     minimisations of implicit steps in which Newton's method took over from the quasi-Newton method
  restarts             steps of bdf2 taken by implicit Euler, of first order: the first, and those after a jump of velocities or load
  refinements          steps of xpbd taken again with twice as many substeps, because they would have gained energy
  rebuilds             changes of the cloth on the way (pins, tears) for which the method was built anew
  tangled_pairs        pairs of triangles of the cloth that passed through each other before each step, of a scene with untangle=yes, until nothing did
  tangled_obstacle_pairs  the same of a triangle of the cloth and one of a body
  untangled_after      steps after which none of these crossed any more
  converged_steps      steps that ended within the tolerance of the method, by its own estimate; none of methods without one
  unfinished_steps     steps that ended at their most iterations, short of the end that the method looks for
  truncated_steps      steps that ended with vertices whose displacement contact has truncated
  pinched_steps        steps after which cloth that bodies had pinched was passing through one of them
  min_clearance        smallest distance of a vertex from an obstacle at the end, negative inside; from an animation without a sign (m)";

/// Arguments of `run`.
#[derive(Debug, Args)]
#[command(after_help = NUMBERS)]
pub struct Arguments {
    /// The scene (see list), or a file of your own, FILE.toml (see scene-files in list)
    scene: String,
    /// The method (see list)
    #[arg(long)]
    method: String,
    /// An OBJ or PLY file or a generator (see list) in place of the scene's own sheet
    #[arg(long, value_name = "MESH")]
    mesh: Option<String>,
    /// Vertices a side, links or cells, as the scene says
    #[arg(long, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..))]
    n: Option<u32>,
    /// Number of steps
    #[arg(long, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..))]
    steps: Option<u32>,
    /// Step size (s)
    #[arg(long, allow_negative_numbers = true)]
    dt: Option<Real>,
    /// Ends the run as failed once it has taken this long (s); asked between steps, of which none is cut short: one
    /// that takes long goes on to its end
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    time_limit: Option<Real>,
    /// Number of threads; all cores if not given
    #[arg(long, allow_negative_numbers = true)]
    threads: Option<usize>,
    /// Sets a parameter of the scene or the method
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Also takes the step that implicit Euler would take next after as many steps, and compares it with the minimiser
    /// of that step: the same step for every method
    #[arg(long)]
    reference: bool,
    /// Also counts crossings and measures distances after every step, not only at the end
    #[arg(long)]
    watch: bool,
    /// Folder for the start and the state after every step
    #[arg(long, value_name = "DIR")]
    export: Option<PathBuf>,
    /// Format of the exported states
    #[arg(long, value_enum, default_value = "obj", requires = "export")]
    format: Format,
    /// Exports every K-th step only
    #[arg(
        long,
        value_name = "K",
        default_value_t = 1,
        requires = "export",
        allow_negative_numbers = true
    )]
    export_every: u32,
    /// CSV file for the force, its part along the normals and its friction, and the torque on every body in every step
    /// (about the position of an obstacle, or the origin for an animation), bodies numbered in the order of the scene
    /// file: of the cloth on it, and on a body that the cloth pushes also of the other bodies and the held cloth that
    /// stop it, each with its reaction on the other body; exports in vtk, ply and html get the forces of contact on
    /// every vertex
    #[arg(long, value_name = "FILE")]
    forces: Option<PathBuf>,
    /// CSV file for the force with which the cloth pulls at every held vertex in every step, and for their sum: its
    /// elements, the weight of the vertex itself and forces of the scene, without air and contact; not of soft pins, nor
    /// by linear-implicit
    #[arg(long, value_name = "FILE")]
    pin_loads: Option<PathBuf>,
    /// PNG file for a picture of the end
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Where the camera of the picture looks, such as 0,1,-0.3 (any length); otherwise from the front and a little down
    #[arg(long, value_name = "X,Y,Z", requires = "picture", value_parser = direction, allow_hyphen_values = true)]
    look: Option<Vec3>,
    /// One JSON object instead of lines
    #[arg(long)]
    json: bool,
}

/// Three numbers, not all zero.
fn direction(text: &str) -> Result<Vec3, String> {
    let numbers: Result<Vec<Real>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let three: Option<[Real; 3]> = numbers.ok().and_then(|all| all.try_into().ok());
    let direction = three.map(Vec3::from);
    let direction = direction.filter(|v| is_finite(v) && v.amax() > 0.0);
    // Neither too long nor too short to be squared.
    direction
        .map(|v| v / v.amax())
        .ok_or_else(|| "needs three finite numbers such as 0,1,-0.3, not all zero".into())
}

/// More threads than this are a slip of the pen.
const MOST_THREADS: usize = 1024;

pub(super) fn execute(arguments: &Arguments) -> Result<(), BenchError> {
    let mut settings = Settings::parse(&arguments.settings)?;
    if let Some(n) = arguments.n {
        if let Some(other) = settings.get("n") {
            return Err(BenchError::Usage(format!(
                "--n is {n} and --set n is `{other}`: give one of them"
            )));
        }
        settings = settings.with("n", n);
    }
    let method = Method::find(&arguments.method)?;
    let groups = if scene::file::is_file(&arguments.scene) {
        if arguments.n.is_some() || arguments.mesh.is_some() {
            return Err(BenchError::Usage(
                "--n and --mesh are for the scenes of the program; a scene file has its own [[mesh]]".into(),
            ));
        }
        scene::file::overrulable()
    } else {
        SceneInfo::find(&arguments.scene)?.groups()
    };
    let what = format!("scene `{}` with method `{}`", arguments.scene, method.name);
    settings.check(&what, &[&groups[..], &method.parameters()].concat())?;
    let of_scene = settings.among(&groups);
    let overruling = settings.among(&method.parameters());
    let scene = if scene::file::is_file(&arguments.scene) {
        scene::file::build(Path::new(&arguments.scene), &of_scene)?
    } else {
        scene::build(&arguments.scene, arguments.mesh.as_deref(), &of_scene)?
    };
    let settings = method.for_run(&scene.settings_of(method.name).then(&overruling));
    let dt = arguments.dt.unwrap_or(scene.dt);
    if !(dt > 0.0 && dt.is_finite()) {
        return Err(BenchError::Usage(format!(
            "--dt is {dt} s, but it has to be a positive finite number"
        )));
    }
    if let Some(limit) = arguments.time_limit
        && (limit <= 0.0 || limit.is_nan())
    {
        return Err(BenchError::Usage(format!(
            "--time-limit is {limit} s, but it has to be above zero"
        )));
    }
    let steps = arguments.steps.unwrap_or(scene.steps);
    let is_png = |file: &&PathBuf| {
        file.extension()
            .is_some_and(|end| end.eq_ignore_ascii_case("png"))
    };
    if let Some(file) = arguments.picture.as_ref().filter(|file| !is_png(file)) {
        return Err(BenchError::Usage(format!(
            "--picture is a PNG file, so {} has to end in .png",
            file.display()
        )));
    }
    if arguments.picture.is_some() || arguments.export.is_some() {
        scene.mesh.as_ref().ok_or_else(|| {
            BenchError::Usage(format!(
                "scene `{}` has no triangles to export or to draw",
                scene.name
            ))
        })?;
    }
    if arguments.forces.is_some() && !scene.can_touch() {
        return Err(BenchError::Usage(format!(
            "--forces is for the forces of contact, and scene `{}` has nothing to touch",
            scene.name
        )));
    }
    let holds = scene.model.particles.free_count() < scene.model.particles.len();
    if arguments.pin_loads.is_some() && !holds && scene.changes.is_empty() {
        return Err(BenchError::Usage(format!(
            "--pin-loads is for held vertices, and scene `{}` has none (a pin with a stiffness is a spring, which holds \
             none)",
            scene.name
        )));
    }
    if arguments.pin_loads.is_some() && !method.tells_pin_forces() {
        return Err(BenchError::Usage(format!(
            "method `{}` does not tell the forces at held vertices, for which --pin-loads is",
            method.name
        )));
    }
    let files = [&arguments.forces, &arguments.pin_loads, &arguments.picture];
    check_files(files.into_iter().flatten())?;
    if arguments.reference && !scene.is_plain() {
        return Err(BenchError::Usage(
            "--reference compares with a step without contact and air and with pins at rest; this scene has other steps".into(),
        ));
    }
    if arguments.reference && !method.aims_at_implicit_euler() {
        return Err(BenchError::Usage(format!(
            "--reference compares with the step of implicit Euler, at which method `{}` does not aim",
            method.name
        )));
    }
    if let Some(threads) = arguments.threads
        && !(1..=MOST_THREADS).contains(&threads)
    {
        return Err(BenchError::Usage(format!(
            "--threads is {threads}, but it has to be 1 to {MOST_THREADS}"
        )));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads.unwrap_or(0));
    let pool = pool.build()?;
    // Inside the pool, so that the methods use its threads and no others.
    pool.install(|| simulate(arguments, &scene, method, &settings, dt, steps))
}

fn simulate(
    arguments: &Arguments,
    scene: &Scene,
    method: &Method,
    settings: &Settings,
    dt: Real,
    steps: u32,
) -> Result<(), BenchError> {
    let begun = Instant::now();
    let mut solver = Solver::new(method, settings, scene, dt)?;
    let setup_ms = 1e3 * begun.elapsed().as_secs_f64();
    let mut peak_memory = None;
    let (format, every) = (arguments.format, arguments.export_every);
    let export = arguments.export.as_ref();
    let has_files = |folder: &&PathBuf| {
        std::fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some())
    };
    if let Some(folder) = export.filter(has_files) {
        eprintln!(
            "note: {} has files, of which those that this run does not replace stay",
            folder.display()
        );
    }
    let export = export.map(|folder| Export::begin(scene, folder, format, every));
    let mut export = export.transpose()?;
    let mut table = arguments.forces.is_some().then(ForcesTable::default);
    let mut pin_loads = arguments.pin_loads.is_some().then(PinLoadsTable::default);
    let bar = progress_bar(steps);
    let mut tangles = TangleProgress::default();
    let of_bodies = scene.touch.iter().flat_map(ContactSetup::notes);
    for note in of_bodies.map(str::to_owned).chain(scene.mesh_notes()) {
        eprintln!("note: {note}");
    }
    if let Some(note) = method.cost_note(scene, settings, dt)? {
        eprintln!("note: {note}");
    }
    if let Some(warning) = method.contact_warning(scene) {
        eprintln!("warning: {warning}");
    }
    for warning in scene.start_warnings(dt, steps) {
        eprintln!("warning: {warning}");
    }
    let mut state = scene.start.clone();
    let watch = arguments.watch.then(|| SeparationWatch::new(scene));
    let mut watch = watch.transpose()?;
    let after = |moment: &Moment<'_>| {
        let (step, state) = (moment.step, moment.state);
        bar.inc(1);
        if let Some(line) = moment.tangled.and_then(|found| tangles.line(step, found)) {
            bar.suspend(|| eprintln!("{line}"));
        }
        if step == steps {
            // Before what is only measured afterwards takes memory too.
            peak_memory = memory::peak();
        }
        if let Some(watch) = &mut watch {
            watch.look(moment.scene, state)?;
        }
        if let Some(export) = &mut export {
            export.after(moment)?;
        }
        if let Some(table) = &mut table {
            table.add(moment);
        }
        if let Some(table) = &mut pin_loads {
            table.add(moment);
        }
        let limit = arguments.time_limit.unwrap_or(Real::INFINITY);
        let taken = begun.elapsed().as_secs_f64();
        if step < steps && taken > limit {
            return Err(BenchError::Failed(format!(
                "the time limit of {limit} s, which is asked between steps, is over after step {step} of {steps}, {taken:.1} s after the start"
            )));
        }
        Ok(())
    };
    let say = || {
        // On a terminal the bar says it.
        if bar.is_hidden() {
            let [step, seconds] = [bar.position(), begun.elapsed().as_secs()];
            eprintln!("{step} of {steps} steps in {seconds} s");
        }
    };
    let finished = while_saying(PATIENCE, say, || {
        let plan = Plan {
            dt,
            steps,
            forces: arguments.forces.is_some(),
            pin_loads: arguments.pin_loads.is_some(),
        };
        run_changing(scene, &mut solver, &mut state, plan, after)
    });
    bar.finish_and_clear();
    // Of a run that failed too: what came before the failure may show why. Before the first step there is nothing.
    let exported = export.map(Export::finish).transpose();
    let has_run = finished.is_ok();
    let table = table.filter(|table| has_run || !table.is_empty());
    let pin_loads = pin_loads.filter(|table| has_run || !table.is_empty());
    if let (Some(file), Some(table)) = (&arguments.forces, &table) {
        write_file(file, table.text().as_bytes())?;
    }
    if let (Some(file), Some(table)) = (&arguments.pin_loads, &pin_loads) {
        write_file(file, table.text().as_bytes())?;
    }
    let vertices = state.positions.len();
    let start = scene;
    let (summary, scene) = match finished {
        Ok((summary, end)) => (summary, end),
        Err(error) => {
            print_pairs(
                arguments.json,
                &[
                    ("scene", json!(scene.name)),
                    ("method", json!(method.name)),
                    ("vertices", json!(vertices)),
                    ("steps", json!(state.steps)),
                    ("finite", json!(state.first_non_finite().is_none())),
                    ("error", json!(error.to_string())),
                ],
            )?;
            return Err(error);
        }
    };
    let mut pairs = vec![
        ("scene", json!(scene.name)),
        ("method", json!(method.name)),
        ("vertices", json!(vertices)),
        ("pins", json!(vertices - scene.model.particles.free_count())),
        ("steps", json!(summary.steps)),
        ("dt", json!(dt)),
        ("threads", json!(rayon::current_num_threads())),
        ("setup_ms", json!(setup_ms)),
        ("peak_memory", json!(peak_memory)),
    ];
    pairs.extend(fields!(summary =>
        ms_per_step_median, ms_per_step_max, contact_ms_median, truncated_steps, pinched_steps, iterations, iterations_per_step,
        linear_iterations, chebyshev_fallbacks, coarse_builds, coarse_fallbacks, newton_fallbacks, restarts, refinements,
        rebuilds, unfinished_steps, converged_steps, max_stretch, max_stretch_of_all, rms_strain, kinetic_energy, elastic_energy,
        gravity_energy, contact_energy, potential_energy, energy_excess, energy_given, contact_energy_at_start,
        center_of_mass_drop, intersections, obstacle_intersections, min_distance, min_clearance, max_seam_gap,
        max_volume_change,
    ));
    pairs.push(("finite", json!(state.first_non_finite().is_none())));
    if let Some(exported) = exported? {
        pairs.extend([
            ("export_frames", json!(exported.frames)),
            ("export_files", json!(exported.files)),
            ("export_bytes", json!(exported.bytes)),
        ]);
    }
    let seen = watch.map(|watch| watch.seen());
    if let Some(seen) = &seen {
        pairs.extend(fields!(seen =>
            crossed_steps, obstacle_crossed_steps, most_intersections, most_obstacle_intersections,
        ));
        pairs.push(("min_distance_of_all", json!(seen.min_distance)));
        pairs.push(("min_clearance_of_all", json!(seen.min_clearance)));
    }
    if !summary.tangled_pairs.is_empty() {
        pairs.extend(fields!(summary => tangled_pairs, tangled_obstacle_pairs, untangled_after));
    }
    if arguments.reference {
        pairs.extend(compared(&scene, solver.stepper(), steps, dt)?);
    }
    if let (Some(file), Some(mesh)) = (&arguments.picture, &scene.mesh) {
        write_file(file, &picture::of(&scene, mesh, &state, arguments.look)?)?;
    }
    let warnings = [
        summary.start_warning(),
        summary.stretched.clone(),
        summary.open_seam.clone(),
        method.stretch_warning(&summary, settings),
        summary
            .energy_warning()
            .map(|warning| warning + method.about_energy_gain()),
        summary.budget_warning(),
        method.truncation_warning(&summary),
        summary.pinch_warning(),
        summary.held_inside.clone(),
    ];
    if let Some(note) = method.refinement_note((&scene, settings, dt), &summary)? {
        eprintln!("note: {note}");
    }
    let crossings = crossing_warnings(start, &summary, seen.as_ref())?;
    for warning in warnings.into_iter().flatten().chain(crossings) {
        eprintln!("warning: {warning}");
    }
    let gain = summary.energy_gain.map(BenchError::failed);
    let failure = gain.or(summary.tangled.map(BenchError::Failed));
    pairs.extend(
        failure
            .iter()
            .map(|error| ("error", json!(error.to_string()))),
    );
    print_pairs(arguments.json, &pairs)?;
    failure.map_or(Ok(()), Err)
}

/// What is said of a cloth that is pulled apart: whenever fewer pairs cross than ever before.
#[derive(Default)]
struct TangleProgress {
    fewest: Option<usize>,
}

impl TangleProgress {
    /// A line about what was found before a step, if it is worth one.
    fn line(&mut self, step: u32, found: CrossingPairs) -> Option<String> {
        let count = found.count();
        if self.fewest.is_some_and(|fewest| fewest <= count) || count == 0 && self.fewest.is_none()
        {
            return None;
        }
        self.fewest = Some(count);
        let CrossingPairs { own, bodies } = found;
        let after = step - 1;
        Some(match count {
            0 => format!("after {after} steps: untangled"),
            _ => format!(
                "after {after} steps: {own} crossing pairs of the cloth with itself, {bodies} with bodies"
            ),
        })
    }
}

/// It ticks, so that a long step shows as one.
fn progress_bar(steps: u32) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} steps, {elapsed}, {eta} left");
    let bar = ProgressBar::new(u64::from(steps))
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_secs(1));
    bar
}

/// One step of the method beside the minimiser that implicit Euler aims at.
fn compared(
    scene: &Scene,
    stepper: &mut dyn Stepper,
    steps: u32,
    dt: Real,
) -> Result<[(&'static str, Value); 4], BenchError> {
    let problem = StepProblem::after(scene, steps, dt)?;
    let (error, report, _) = problem.solve(stepper)?;
    Ok([
        ("objective_error", json!(error.objective)),
        ("gradient_error", json!(error.gradient)),
        ("compared_iterations", json!(report.iterations)),
        ("reference_gradient", json!(problem.reference_gradient())),
    ])
}
