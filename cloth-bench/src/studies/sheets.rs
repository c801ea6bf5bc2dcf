//! The cloth of a study that compares methods: the hanging sheet in some sizes, or a scene file of one's own.

use super::Cases;
use crate::error::BenchError;
use crate::report::table::Cell;
use crate::scene::{self, Scene, file};
use crate::settings::Settings;
use std::path::Path;

/// A cloth to compare methods on.
#[derive(Debug)]
pub(super) struct TestSheet {
    /// What it is called in sentences: `33 × 33`, or the name of the scene.
    pub(super) name: String,
    /// The same in a column of sizes.
    pub(super) size: Cell,
    /// The same in names of files.
    pub(super) file: String,
    /// Whether it is a scene of one's own.
    pub(super) is_own: bool,
    pub(super) scene: Scene,
}

impl TestSheet {
    /// The hanging sheet with so many vertices a side, or the scene that the run was started with.
    ///
    /// # Errors
    /// [`BenchError::Usage`] for a scene file that does not serve.
    pub(super) fn of_study(cases: &Cases<'_>, sides: &[u32]) -> Result<Vec<Self>, BenchError> {
        if let Some(path) = cases.own_scene() {
            return Ok(vec![Self::own(path)?]);
        }
        sides.iter().map(|&n| Self::hanging(n)).collect()
    }

    fn hanging(n: u32) -> Result<Self, BenchError> {
        Ok(Self {
            name: format!("{n} × {n}"),
            size: Cell::from(n as usize),
            file: n.to_string(),
            is_own: false,
            scene: scene::build("hang", None, &Settings::default().with("n", n))?,
        })
    }

    /// The scene of a file.
    ///
    /// # Errors
    /// [`BenchError::Usage`] with the line of what is wrong in it, or if it has contact, air or moving pins: the references have none of these.
    pub(super) fn own(path: &Path) -> Result<Self, BenchError> {
        let scene = file::build(path, &Settings::default())?;
        if !scene.is_plain() {
            return Err(BenchError::Usage(format!(
                "{}: this scene has contact, air or moving pins, with which the references of the studies cannot be compared",
                path.display()
            )));
        }
        let letters = scene.name.chars();
        Ok(Self {
            name: scene.name.to_owned(),
            size: Cell::from(scene.name),
            // Names of scenes may have blanks and slashes, those of files better not.
            file: letters
                .map(|c| if c.is_alphanumeric() { c } else { '-' })
                .collect(),
            is_own: true,
            scene,
        })
    }

    /// What it is, as a part of a sentence.
    pub(super) fn what(&self) -> String {
        if self.is_own {
            format!("the scene `{}`", self.name)
        } else {
            "the hanging sheet".into()
        }
    }

    /// What it is, with its size.
    pub(super) fn which(&self) -> String {
        if self.is_own {
            self.what()
        } else {
            format!("the {} sheet", self.name)
        }
    }
}
