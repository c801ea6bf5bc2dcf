//! From the text of a file to a [`Scene`].

use super::document::{Document, Section};
use super::keys::{
    Link, MESH_CLOTH, MESH_CONTACT, MESH_SOLID, Obstacle, SECTIONS, Top, overrulable,
};
use super::material::Material;
use super::selection::Pieces;
use super::{
    air, event, force, gas, hints, link, mass, mesh, methods, obstacles, pins, roughness, seam,
    start, tear,
};
use crate::bounds::bounds;
use crate::error::BenchError;
use crate::scene::cloth::{self, Stiffness};
use crate::scene::contact::{ContactSetup, Surface};
use crate::scene::{HeldMotion, Scene, build as built_in};
use crate::settings::{Settings, Table};
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::method::ordering::Order;
use cloth_core::pin::Pins;
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The scene that a file describes. What `settings` give of its keys of cloth and contact overrules the file.
///
/// # Errors
/// [`BenchError::Usage`] with the path, and with the line where there is one; or for a setting that overrules nothing.
pub fn build(path: &Path, settings: &Settings) -> Result<Scene, BenchError> {
    let text = std::fs::read_to_string(path).map_err(|error| {
        BenchError::Usage(format!(
            "{}: the scene file cannot be read: {error}",
            path.display()
        ))
    })?;
    build_text(path, &text, settings)
}

/// The scene that a text describes, which stands in the file `path`, or would.
///
/// # Errors
/// As [`build`].
pub(crate) fn build_text(
    path: &Path,
    text: &str,
    settings: &Settings,
) -> Result<Scene, BenchError> {
    settings.check(&format!("scene `{}`", path.display()), &overrulable())?;
    let document = Document { path, text };
    let root = DeTable::parse(text).map_err(|error| match error.span() {
        Some(span) => document.refuse(
            span.clone(),
            document.of_syntax(error.message(), span.start),
        ),
        None => document.refuse_whole(error.message()),
    })?;
    let sections = Sections::find(document, root.get_ref())?;
    sections.scene(settings)
}

/// The tables of a file.
struct Sections<'a> {
    document: Document<'a>,
    top: Section<'a>,
    meshes: Vec<Section<'a>>,
    /// What each of them says of its own material.
    materials: Vec<Option<Section<'a>>>,
    /// Of its inside, if it is a solid.
    solids: Vec<Option<Section<'a>>>,
    /// And of its own contact.
    roughness: Vec<Option<Section<'a>>>,
    cloth: Section<'a>,
    pins: Vec<Section<'a>>,
    masses: Vec<Section<'a>>,
    forces: Vec<Section<'a>>,
    events: Vec<Section<'a>>,
    seams: Vec<Section<'a>>,
    links: Vec<Section<'a>>,
    start: Section<'a>,
    air: Section<'a>,
    obstacles: Vec<Section<'a>>,
    contact: Section<'a>,
    chain: Section<'a>,
    /// Settings of methods, by the names of these.
    methods: Vec<(&'static str, Settings)>,
}

impl<'a> Sections<'a> {
    fn find(document: Document<'a>, root: &'a DeTable<'a>) -> Result<Self, BenchError> {
        let [
            top,
            meshes,
            _,
            _,
            _,
            cloth,
            pins,
            masses,
            forces,
            events,
            seams,
            links,
            start,
            air,
            obstacles,
            contact,
            chain,
            _,
        ] = &SECTIONS;
        let names: Vec<&str> = SECTIONS[1..]
            .iter()
            .filter(|info| !info.head.contains('.'))
            .map(|info| info.head.trim_matches(['[', ']']))
            .chain(["method"])
            .collect();
        let named = |info: &super::SectionInfo| root.get(info.head.trim_matches(['[', ']']));
        let table = |value: &'a Spanned<DeValue<'a>>, info: &'static super::SectionInfo| {
            let DeValue::Table(entries) = value.get_ref() else {
                let message = format!("this has to be a table: write {} above its keys", info.head);
                return Err(document.refuse(value.span(), message));
            };
            let below: &[&str] = match info.head {
                "[[mesh]]" => &["cloth", "contact", "solid"],
                _ => &[],
            };
            Section::new(document, info, Some(value), Some(entries), below)
        };
        let one = |info: &'static super::SectionInfo| match named(info) {
            Some(value) => table(value, info),
            None => Section::new(document, info, None, None, &[]),
        };
        let all = |info: &'static super::SectionInfo| match named(info).map(|v| (v, v.get_ref())) {
            None => Ok(Vec::new()),
            Some((_, DeValue::Array(array))) => {
                array.iter().map(|value| table(value, info)).collect()
            }
            Some((value, _)) => {
                let message = format!("this table can be there several times: write {}", info.head);
                Err(document.refuse(value.span(), message))
            }
        };
        let meshes = all(meshes)?;
        let materials = meshes.iter().map(|mesh| mesh.below("cloth", &MESH_CLOTH));
        let materials = materials.collect::<Result<_, _>>()?;
        let solids = meshes.iter().map(|mesh| mesh.below("solid", &MESH_SOLID));
        let solids = solids.collect::<Result<_, _>>()?;
        let own = meshes
            .iter()
            .map(|mesh| mesh.below("contact", &MESH_CONTACT));
        let roughness = own.collect::<Result<_, _>>()?;
        Ok(Self {
            document,
            top: Section::new(document, top, None, Some(root), &names)?,
            meshes,
            materials,
            solids,
            roughness,
            cloth: one(cloth)?,
            pins: all(pins)?,
            masses: all(masses)?,
            forces: all(forces)?,
            events: all(events)?,
            seams: all(seams)?,
            links: all(links)?,
            start: one(start)?,
            air: one(air)?,
            obstacles: all(obstacles)?,
            contact: one(contact)?,
            chain: one(chain)?,
            methods: methods::settings(document, root.get("method"))?,
        })
    }

    fn scene(&self, settings: &Settings) -> Result<Scene, BenchError> {
        // The top first, as one reads it.
        let top = self.top.read::<Top>()?;
        let gravity = top.gravity.unwrap_or(Vec3::z() * -9.81);
        let stem = self.document.path.file_stem().unwrap_or_default();
        let name = (*top.name).clone();
        let name = name.unwrap_or_else(|| stem.to_string_lossy().into_owned());
        let scene = if self.chain.is_given() {
            self.chain(settings)?
        } else {
            self.sheet(settings, gravity)?
        };
        let mut scene = Scene {
            // Scenes have names that last, and a program reads one or a few files.
            name: Box::leak(name.into_boxed_str()),
            gravity,
            dt: top.dt.unwrap_or(scene.dt),
            steps: top.steps.unwrap_or(scene.steps),
            methods: self.methods.clone(),
            file: format!("{}: ", self.document.path.display()),
            ..scene
        };
        scene.hints.extend(hints::of_rotations([
            &self.meshes,
            &self.obstacles,
            &self.pins,
            &self.events,
        ])?);
        scene.hints.extend(hints::of_intervals(&self.obstacles)?);
        scene.event_times = hints::event_times([
            &self.events,
            &self.pins,
            &self.forces,
            &self.seams,
            &self.obstacles,
        ])?;
        scene.hints.extend(hints::of_sizes(&scene));
        if self.falls_freely() && gravity != Vec3::zeros() {
            scene.hints.push(
                "nothing holds the cloth, and nothing is below it: it falls freely all along"
                    .into(),
            );
        }
        Ok(scene)
    }

    /// Whether nothing acts on the cloth but gravity.
    fn falls_freely(&self) -> bool {
        let several = [&self.pins, &self.forces, &self.events, &self.obstacles];
        let one = [&self.chain, &self.start, &self.air];
        several.iter().all(|sections| sections.is_empty())
            && !one.iter().any(|section| section.is_given())
    }

    fn chain(&self, overruling: &Settings) -> Result<Scene, BenchError> {
        let others = [&self.cloth, &self.start, &self.air, &self.contact];
        let mut others = others
            .into_iter()
            .chain(&self.meshes)
            .chain(&self.pins)
            .chain(&self.masses)
            .chain(&self.forces)
            .chain(&self.events)
            .chain(&self.seams)
            .chain(&self.links)
            .chain(&self.obstacles);
        if let Some(other) = others.find(|section| section.is_given()) {
            return Err(other.refuse_table("has no meaning beside [chain]"));
        }
        let unused = overrulable().into_iter().flatten();
        let mut unused = unused.filter(|key| key.name != "stiffness");
        if let Some(key) = unused.find(|key| overruling.get(key.name).is_some()) {
            let message = format!("--set {} has no meaning for a chain", key.name);
            return Err(BenchError::Usage(message));
        }
        let settings = self.chain.settings(Settings::default());
        built_in::chain(&settings.then(overruling))
    }

    fn sheet(&self, overruling: &Settings, gravity: Vec3) -> Result<Scene, BenchError> {
        let folder = self.document.path.parent().unwrap_or(Path::new(""));
        if self.meshes.is_empty() {
            return Err(self.document.refuse_whole(
                "there is no cloth: a scene needs [[mesh]] with a file or a generator",
            ));
        }
        let mesh::Joined {
            mesh,
            counts,
            solids,
            from_file,
        } = mesh::joined(&self.meshes, &self.solids, folder)?;
        let has_solid = solids.iter().any(Option::is_some);
        if has_solid && self.air.is_given() {
            let message = "is for sheets, and cannot be with [mesh.solid]";
            return Err(self.air.refuse_table(message));
        }
        let read = |section: &Section<'_>| section.settings(Settings::default()).then(overruling);
        let (cloth, contact) = (read(&self.cloth), read(&self.contact));
        let mut material = Material::new(&cloth, &self.materials, solids, &counts)?;
        let up = -gravity.try_normalize(0.0).unwrap_or(-Vec3::z());
        let pieces = Pieces {
            mesh: &mesh,
            counts: &counts,
            up,
        };
        let mut held = pieces.chosen_by(&self.pins)?;
        let mut weighted = pieces.chosen_by(&self.masses)?;
        let mut pushed = pieces.chosen_by(&self.forces)?;
        let events = self.events.iter();
        let grasped = events.map(|section| event::chosen(section, &pieces));
        let mut grasped: Vec<Vec<usize>> = grasped.collect::<Result<_, _>>()?;
        let borders = seam::Borders::new(&self.seams, &mesh, &counts)?;
        let mut seams = Vec::new();
        for (section, borders) in self.seams.iter().zip(borders.iter().cycle()) {
            seams.push(borders.ends(section)?);
        }
        seam::sew_once(&self.seams, &mut seams)?;
        let mut links = Vec::new();
        for section in &self.links {
            links.push(link::links(section, &counts, &mesh)?);
        }
        // Files come in any vertex order; neighbours in space become neighbours in memory.
        let order = from_file.then(|| Order::morton(mesh.positions()));
        let mesh = match &order {
            Some(order) => {
                let chosen = held.iter_mut().chain(&mut pushed).chain(&mut weighted);
                for vertex in chosen.chain(&mut grasped).flatten() {
                    *vertex = order.new_of_old()[*vertex] as usize;
                }
                material.reorder(order);
                link::reorder(&mut links, order);
                order.reorder_mesh(&mesh)
            }
            None => mesh,
        };
        let mut model = material.cut(&mesh, |_| true)?;
        let hints = material.hints(&mesh)?;
        let mut added_masses = Vec::new();
        for (section, vertices) in self.masses.iter().zip(weighted) {
            let mass = mass::add(section, &vertices, &mut model.particles)?;
            added_masses.push((vertices, mass));
        }
        model.fasten(links);
        let inside = gas::inside(&self.meshes, &counts, &mesh, order.as_ref())?;
        let (gases, volumes) = gas::left(&inside, &vec![true; mesh.triangles().len()]);
        let name = |v: usize| order.as_ref().map_or(v, |o| o.old_of_new()[v] as usize);
        let pieces = (&mesh, &counts[..]);
        let mut changes = tear::tears(&self.events, &material, pieces, &inside, name)?;
        let mut ways = Pins::new();
        let holds = self.pins.iter().zip(held);
        let holds = holds.map(|(section, vertices)| pins::hold(section, vertices));
        let holds: Vec<pins::Hold> = holds.collect::<Result<_, _>>()?;
        pins::refuse_overlap(&self.pins, &holds, name)?;
        let positions = start::positions(&self.start, folder, &mesh, order.as_ref())?;
        let timed = holds.iter().filter(|hold| hold.is_timed());
        let timed: Vec<usize> = timed.flat_map(|hold| hold.vertices.clone()).collect();
        let mut touch = self.touch(&contact, &mesh, folder, gravity)?;
        let mut taken_along = Vec::new();
        for (section, hold) in self.pins.iter().zip(holds) {
            hold.check(section, &touch)?;
            let (model, ways) = (&mut model, &mut ways);
            taken_along.extend(hold.apply(section, &positions, model, ways, &mut changes)?);
        }
        let of_body = |(vertices, body): &(Vec<usize>, usize)| {
            let body = *body;
            vertices.clone().into_iter().map(move |v| (v, body))
        };
        let carried: Vec<_> = taken_along.iter().flat_map(of_body).collect();
        let known = (&model.particles, &timed[..], &carried[..]);
        changes.extend(event::changes(&self.events, grasped, known, name)?);
        for (section, vertices) in self.forces.iter().zip(pushed) {
            let push = force::push(section, vertices, &model.particles, &changes)?;
            changes.push(push);
        }
        for obstacle in self.obstacles.iter().filter(|_| touch.is_idle()) {
            let own = obstacle.read::<Obstacle>()?;
            own.density.refuse_given("with contact=none")?;
            own.mass.refuse_given("with contact=none")?;
        }
        changes.extend(event::of_bodies(&self.events, &self.obstacles, &mut touch)?);
        touch.pieces =
            roughness::of_pieces(&contact, &self.roughness, (&mesh, &counts), order.as_ref())?;
        touch.check_friction(&contact)?;
        if let (true, Some(section)) = (touch.is_idle(), self.roughness.iter().flatten().next()) {
            let message = "has no meaning without anything to touch";
            return Err(section.refuse_table(message));
        }
        let mut scene = Scene {
            order,
            touch: Some(touch),
            air: air::around(&self.air, &cloth, &mesh)?,
            added_masses,
            pins: Some(Arc::new(ways)).filter(|ways| !ways.is_empty()),
            changes,
            gases,
            volumes,
            hints,
            hard_place: self.hard_place(&cloth)?,
            ..built_in::of_mesh("", &mesh, model, gravity)
        };
        scene.start.positions = positions;
        start::apply(&self.start, &mut scene)?;
        for (vertices, body) in taken_along {
            let start = scene.start.clone();
            scene.hold(&vertices, HeldMotion::With(body), &start)?;
        }
        let order = scene.order.clone();
        for (section, ends) in self.seams.iter().zip(seams) {
            seam::apply(section, ends, &material, order.as_ref(), &mut scene)?;
        }
        scene.changes.sort_by(|a, b| a.time.total_cmp(&b.time));
        Ok(scene)
    }

    /// Where the first hard constraints stand, as errors begin.
    fn hard_place(&self, cloth: &Settings) -> Result<String, BenchError> {
        if cloth::is_hard(cloth)? {
            return Ok(Stiffness::read(cloth)?.stiffness.place().to_owned());
        }
        let pieces = self.materials.iter().flatten();
        for section in pieces {
            let own = section.read::<Stiffness>()?.stiffness;
            if own.number().is_infinite() {
                return Ok(own.place().to_owned());
            }
        }
        for section in &self.links {
            if section.read::<Link>()?.stiffness.number().is_infinite() {
                return Ok(section.place());
            }
        }
        Ok(String::new())
    }

    /// What the cloth can touch.
    fn touch(
        &self,
        contact: &Settings,
        mesh: &TriMesh,
        folder: &Path,
        gravity: Vec3,
    ) -> Result<ContactSetup, BenchError> {
        let [low, high] = bounds(mesh.positions().iter().copied());
        let size = (high - low).norm();
        let thickness = Surface::read(contact)?.thickness_of(mesh);
        let bodies = self.obstacles.iter();
        let bodies: Vec<_> = bodies
            .map(|section| obstacles::body(section, folder, [size, thickness], gravity))
            .collect::<Result<_, _>>()?;
        ContactSetup::new(contact, mesh, bodies)
    }
}
