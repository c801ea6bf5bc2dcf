//! States of a run as files that other programs open.
//!
//! | format | files in the folder | numbers | for |
//! |---|---|---|---|
//! | `obj` | `00000.obj`, `00001.obj`, … | text, every bit | every modelling program; `--mesh` |
//! | `ply` | `00000.ply`, `00001.ply`, … | binary, double precision, where they are recorded with forces of contact (N) as `pressure_x`, …, `friction_z` | MeshLab, Blender, Open3D; `--mesh` |
//! | `vtk` | `run.pvd`, `cloth_00000.vtp`, … | binary, double precision, with velocities (m/s), times (s) and, where they are recorded, forces of contact (N) | ParaView: open `run.pvd` |
//! | `gltf` | `run.glb` | single precision, played between the frames | Blender and the web |
//! | `html` | `run.html` | 16 bits a coordinate; forces of contact as colour, where they are recorded | a browser: a page that plays it |
//!
//! Frame 0 is the start. Lengths are in metres. Vertices are in the order of the caller's mesh. Obstacles, animated
//! ones too, are surfaces of their own, numbered in the order of the scene file: `obstacle0.obj`, or one file a frame
//! (`obstacle0_00000.obj`) where they move. `obj`, `ply` and `vtk` keep the axes of the scene; `gltf` has y up, so its
//! root node turns the scene.
//!
//! A run that fails leaves the frames before the failure, complete and playable; a full disk leaves no part of a file.

mod gltf;
mod page;
mod sequence;
mod vtk;

use crate::error::BenchError;
use crate::files;
use crate::run::Moment;
use crate::scene::{BodySurface, Scene};
use clap::ValueEnum;
use cloth_collide::potential::ContactForces;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::particles::State;
use std::path::{Path, PathBuf};

/// Formats of exported states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Wavefront OBJ, one file a frame
    Obj,
    /// PLY, binary, one file a frame
    Ply,
    /// VTK polygons, one file a frame, and run.pvd with their times, for ParaView
    Vtk,
    /// One binary glTF 2.0 file with an animation, run.glb, for Blender and the web
    Gltf,
    /// One page that plays the run, run.html, for a browser; with --forces the cloth is the redder, the larger the
    /// force of contact on it
    Html,
}

/// Writes states of a scene to a folder.
pub struct Export {
    folder: Folder,
    every: u32,
    frames: u32,
    /// In the caller's vertex numbers.
    triangles: Vec<[u32; 3]>,
    writer: Box<dyn Writer>,
}

impl std::fmt::Debug for Export {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Export")
            .field("folder", &self.folder)
            .field("every", &self.every)
            .field("frames", &self.frames)
            .finish_non_exhaustive()
    }
}

/// What was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exported {
    /// States.
    pub frames: u32,
    /// Files.
    pub files: u64,
    /// Size of all files (bytes).
    pub bytes: u64,
}

/// A state on its way to a file.
struct Frame<'a> {
    /// Its number, from 0.
    index: u32,
    /// The step after which it was.
    step: u32,
    /// Its time (s).
    time: Real,
    /// Positions (m), in the caller's order.
    positions: Vec<Vec3>,
    /// Velocities (m/s), in the caller's order.
    velocities: Vec<Vec3>,
    /// Pressure and friction (N), where they are recorded.
    forces: Option<[Vec<Vec3>; 2]>,
    triangles: &'a [[u32; 3]],
    obstacles: Vec<BodySurface<'a>>,
}

impl Frame<'_> {
    /// Pressure and friction (N), one per vertex, by the names that they have in files; none where they are not
    /// recorded.
    fn force_vectors(&self) -> Vec<(&'static str, &[Vec3])> {
        let both = self.forces.iter();
        let named = both.flat_map(|[normal, friction]| {
            [("pressure", &normal[..]), ("friction", &friction[..])]
        });
        named.collect()
    }
}

/// The triangles of a scene's mesh in the caller's vertex numbers.
fn triangles(scene: &Scene, mesh: &TriMesh) -> Vec<[u32; 3]> {
    match &scene.order {
        Some(order) => {
            let back = |t: &[u32; 3]| t.map(|v| order.old_of_new()[v as usize]);
            mesh.triangles().iter().map(back).collect()
        }
        None => mesh.triangles().to_vec(),
    }
}

/// One format.
trait Writer {
    /// Takes a frame.
    fn frame(&mut self, frame: &Frame<'_>, folder: &mut Folder) -> Result<(), BenchError>;

    /// Writes what can only be written at the end.
    fn finish(&mut self, folder: &mut Folder) -> Result<(), BenchError>;
}

impl Export {
    /// Creates the folder, and writes the start of the scene. Every `every`-th step is to follow.
    pub fn begin(
        scene: &Scene,
        folder: &Path,
        format: Format,
        every: u32,
    ) -> Result<Self, BenchError> {
        let Some(mesh) = &scene.mesh else {
            return Err(BenchError::Usage(format!(
                "scene `{}` has no triangles to export",
                scene.name
            )));
        };
        if every == 0 {
            return Err(BenchError::Usage(
                "--export-every is 0, but it has to be at least 1".into(),
            ));
        }
        let writer: Box<dyn Writer> = match format {
            Format::Obj => Box::new(sequence::Sequence::Obj),
            Format::Ply => Box::new(sequence::Sequence::Ply),
            Format::Vtk => Box::new(vtk::Vtk::default()),
            Format::Gltf => Box::new(gltf::Gltf::new(scene.name, scene.gravity)),
            Format::Html => Box::new(page::Page::new(scene.name, scene.gravity)),
        };
        let mut export = Self {
            folder: Folder::create(folder)?,
            every,
            frames: 0,
            triangles: triangles(scene, mesh),
            writer,
        };
        export.take(0, scene, &scene.start, None)?;
        Ok(export)
    }

    /// Writes what is there after a step, if it is one of those to be written; in `vtk`, `ply` and `html` with the
    /// forces of contact, where they are recorded.
    pub fn after(&mut self, moment: &Moment<'_>) -> Result<(), BenchError> {
        if moment.step.is_multiple_of(self.every) {
            self.take(moment.step, moment.scene, moment.state, moment.forces)
        } else {
            Ok(())
        }
    }

    fn take(
        &mut self,
        step: u32,
        scene: &Scene,
        state: &State,
        forces: Option<&ContactForces>,
    ) -> Result<(), BenchError> {
        if let Some(mesh) = &scene.mesh
            && mesh.triangles().len() != self.triangles.len()
        {
            self.triangles = triangles(scene, mesh);
        }
        let back = |values: &[Vec3]| match &scene.order {
            Some(order) => order.restore(values),
            None => values.to_vec(),
        };
        let obstacles = scene.touch.iter();
        let obstacles = obstacles.flat_map(|touch| touch.body_surfaces(state.time));
        let frame = Frame {
            index: self.frames,
            step,
            time: state.time,
            positions: back(&state.positions),
            velocities: back(&state.velocities),
            forces: forces.map(|f| [back(&f.normal), back(&f.friction)]),
            triangles: &self.triangles,
            obstacles: obstacles.collect(),
        };
        self.writer.frame(&frame, &mut self.folder)?;
        self.frames += 1;
        Ok(())
    }

    /// Writes what can only be written at the end, and says how much was written.
    pub fn finish(mut self) -> Result<Exported, BenchError> {
        self.writer.finish(&mut self.folder)?;
        Ok(Exported {
            frames: self.frames,
            files: self.folder.files,
            bytes: self.folder.bytes,
        })
    }
}

/// Where files go, and how many there are.
#[derive(Debug)]
struct Folder {
    path: PathBuf,
    files: u64,
    bytes: u64,
}

impl Folder {
    fn create(path: &Path) -> Result<Self, BenchError> {
        std::fs::create_dir_all(path).map_err(|error| {
            BenchError::Failed(format!(
                "{}: the folder for the export cannot be made: {error}",
                path.display()
            ))
        })?;
        Ok(Self {
            path: path.to_owned(),
            files: 0,
            bytes: 0,
        })
    }

    /// Writes a file of several parts, replacing it; all of it or nothing.
    fn write(&mut self, name: &str, parts: &[&[u8]]) -> Result<(), BenchError> {
        let path = self.path.join(name);
        files::write(&path, parts).map_err(|error| {
            BenchError::Failed(format!(
                "{}: the export cannot be written: {error}",
                path.display()
            ))
        })?;
        self.files += 1;
        self.bytes += parts.iter().map(|part| part.len() as u64).sum::<u64>();
        Ok(())
    }
}
