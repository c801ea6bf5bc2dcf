//! One page, `run.html`, that plays the run in a browser, forces of contact as colour where they are recorded.

use super::{Folder, Frame, Writer};
use crate::error::BenchError;
use crate::report::html::{Report, Section};
use crate::report::player::{Film, Playback, Track};
use cloth_core::math::{Real, Vec3};
use nalgebra::UnitQuaternion;
use std::f64::consts::PI;

/// A surface of the same triangles in some frames, one after the other.
struct Shown {
    name: String,
    triangles: Vec<[u32; 3]>,
    /// The first of these frames.
    first: usize,
    frames: Vec<Vec<Vec3>>,
    /// Force of contact on each vertex (N), in each of them; none of a body.
    forces: Vec<Vec<Real>>,
}

/// All frames, until the end.
pub(super) struct Page {
    name: String,
    /// What turns the scene so that z is up.
    upright: UnitQuaternion<Real>,
    times: Vec<Real>,
    shown: Vec<Shown>,
}

impl Page {
    /// Of a scene of this name; `gravity` (m/s²) tells what is up.
    pub(super) fn new(name: &str, gravity: Vec3) -> Self {
        let up = -gravity.try_normalize(0.0).unwrap_or(-Vec3::z());
        let half_turn = UnitQuaternion::from_axis_angle(&Vec3::x_axis(), PI);
        Self {
            name: name.to_owned(),
            upright: UnitQuaternion::rotation_between(&up, &Vec3::z()).unwrap_or(half_turn),
            times: Vec::new(),
            shown: Vec::new(),
        }
    }

    /// Adds a surface in the last frame; after a tear it is another one.
    fn add(&mut self, name: &str, triangles: &[[u32; 3]], x: &[Vec3], forces: Vec<Real>) {
        let first = self.times.len() - 1;
        let places = x.iter().map(|x| self.upright * x).collect();
        let last = self.shown.iter_mut().rev().find(|shown| shown.name == name);
        match last.filter(|shown| shown.triangles == triangles) {
            Some(shown) => {
                shown.frames.push(places);
                shown.forces.push(forces);
            }
            None => self.shown.push(Shown {
                name: name.to_owned(),
                triangles: triangles.to_vec(),
                first,
                frames: vec![places],
                forces: vec![forces],
            }),
        }
    }
}

impl Shown {
    /// The film of all of `count` frames, forces relative to the `largest` (N).
    fn film(self, count: usize, largest: Real) -> Film {
        let Self {
            mut frames,
            mut forces,
            ..
        } = self;
        // Where it is not there, all of it is in a point, which is not seen.
        let point = frames[0].first().copied().unwrap_or_default();
        let nothing = vec![point; frames[0].len()];
        frames.splice(0..0, vec![nothing.clone(); self.first]);
        frames.resize(count, nothing);
        if self.name != CLOTH {
            return Film::of_obstacle(&self.triangles, &frames);
        }
        let film = Film::of_cloth(&self.triangles, &frames);
        if largest == 0.0 {
            return film;
        }
        let still = vec![0.0; frames[0].len()];
        forces.splice(0..0, vec![still.clone(); self.first]);
        forces.resize(count, still);
        film.with_colors(
            forces
                .iter()
                .flatten()
                .map(|force| (force / largest).sqrt().min(1.0)),
        )
    }
}

/// The name of the cloth among the surfaces; bodies have others.
const CLOTH: &str = "cloth";

impl Writer for Page {
    fn frame(&mut self, frame: &Frame<'_>, _: &mut Folder) -> Result<(), BenchError> {
        self.times.push(frame.time);
        let forces = match &frame.forces {
            Some([normal, friction]) => {
                let both = normal.iter().zip(friction);
                both.map(|(normal, friction)| (normal + friction).norm())
                    .collect()
            }
            None => vec![0.0; frame.positions.len()],
        };
        self.add(CLOTH, frame.triangles, &frame.positions, forces);
        for body in &frame.obstacles {
            self.add(&body.name(), body.triangles, &body.positions, Vec::new());
        }
        Ok(())
    }

    fn finish(&mut self, folder: &mut Folder) -> Result<(), BenchError> {
        let count = self.times.len();
        let surfaces = std::mem::take(&mut self.shown);
        let forces = surfaces
            .iter()
            .flat_map(|shown| shown.forces.iter().flatten());
        let mut forces: Vec<Real> = forces.copied().filter(|force| *force > 0.0).collect();
        forces.sort_by(Real::total_cmp);
        // Beside the few of an impact all others would be nothing.
        let largest = forces.get(19 * forces.len() / 20).copied().unwrap_or(0.0);
        let colors = match largest > 0.0 {
            true => format!(
                " The redder, the larger the force of contact on a vertex: as its square root, up to {largest:.3e} \
                 N, which one in twenty exceeds."
            ),
            false => String::new(),
        };
        let playback = Playback {
            caption: format!("{}, {:.3} s.{colors}", self.name, self.times[count - 1]),
            seconds_per_frame: self.times.get(1).map_or(1.0, |time| time - self.times[0]),
            tracks: vec![Track {
                name: self.name.clone(),
                surfaces: surfaces
                    .into_iter()
                    .map(|shown| shown.film(count, largest))
                    .collect(),
            }],
        };
        let page = Report {
            title: self.name.clone(),
            sections: vec![Section {
                id: "run".into(),
                playbacks: vec![playback],
                ..Section::default()
            }],
            ..Report::default()
        };
        folder.write("run.html", &[page.to_html().as_bytes()])
    }
}
