//! The cases that a study is cut into.
//!
//! A case has a name and a result, and depends on no other case. So it can be left out when it is finished already, or when another machine runs it; what several cases
//! need, such as a reference, is a [`Late`] value, found when the first of them asks for it.

use super::Findings;
use crate::error::BenchError;
use crate::journal::{Journal, Shard};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Which of the unfinished cases are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    /// All.
    All,
    /// Those that fall to one of several runs. What a study concludes from its share is not to be shown.
    One(Shard),
    /// None: everything should be finished.
    Nothing,
}

/// Runs the cases of a study that are not finished, and keeps their results in the journal.
#[allow(missing_debug_implementations)] // it holds a closure
pub struct Cases<'a> {
    study: &'static str,
    journal: &'a mut Journal,
    share: Share,
    progress: &'a mut dyn FnMut(&str),
    named: HashSet<String>,
    left_out: Vec<String>,
    own_scene: Option<PathBuf>,
}

impl<'a> Cases<'a> {
    pub(super) fn new(
        study: &'static str,
        journal: &'a mut Journal,
        share: Share,
        progress: &'a mut dyn FnMut(&str),
        own_scene: Option<PathBuf>,
    ) -> Self {
        Self {
            study,
            journal,
            share,
            progress,
            named: HashSet::new(),
            left_out: Vec::new(),
            own_scene,
        }
    }

    /// The scene file that the run was started with.
    pub(super) fn own_scene(&self) -> Option<&Path> {
        self.own_scene.as_deref()
    }

    /// The result of the case `name`: of `work`, now or when it was finished. A case that falls to another run has the default value.
    ///
    /// # Errors
    /// That of `work`, now or then; [`BenchError::Failed`] if the journal cannot be written, or if the name is not the only one of its kind.
    pub(crate) fn case<T: Serialize + DeserializeOwned + Default>(
        &mut self,
        name: &str,
        work: impl FnOnce() -> Result<T, BenchError>,
    ) -> Result<T, BenchError> {
        self.parts(name, |_| work())
    }

    /// The same with a case that reports the parts that it is at.
    pub(crate) fn parts<T: Serialize + DeserializeOwned + Default>(
        &mut self,
        name: &str,
        work: impl FnOnce(&mut dyn FnMut(&str)) -> Result<T, BenchError>,
    ) -> Result<T, BenchError> {
        if let Some(error) = self.journal.broken() {
            return Err(error.clone());
        }
        (self.progress)(&format!("{}: {name}", self.study));
        let study = self.study;
        let about =
            |error| BenchError::Failed(format!("case `{name}` of study `{study}`: {error}"));
        if !self.named.insert(name.to_owned()) {
            return Err(about("there are two of that name".to_owned()));
        }
        if let Some(known) = self.journal.recall(self.study, name) {
            return serde_json::from_value(known?).map_err(|error| about(error.to_string()));
        }
        let is_ours = match self.share {
            Share::All => true,
            Share::One(shard) => shard.includes(self.study, name),
            Share::Nothing => false,
        };
        if !is_ours {
            self.left_out.push(name.to_owned());
            return Ok(T::default());
        }
        let started = Instant::now();
        let outcome = work(&mut *self.progress);
        let seconds = started.elapsed().as_secs_f64();
        let recorded = match &outcome {
            Ok(found) => {
                let value =
                    serde_json::to_value(found).map_err(|error| about(error.to_string()))?;
                // What cannot be read back, such as a number that is none, is found out now.
                T::deserialize(&value).map_err(|error| about(error.to_string()))?;
                Ok(value)
            }
            Err(error) => Err(error.to_string()),
        };
        self.journal.record(self.study, name, seconds, recorded)?;
        outcome
    }
    /// A case that fills findings of its own, which are added to those of the study, and draws a conclusion.
    pub(crate) fn chapter<T: Serialize + DeserializeOwned + Default>(
        &mut self,
        name: &str,
        findings: &mut Findings,
        work: impl FnOnce(&mut Findings, &mut dyn FnMut(&str)) -> Result<T, BenchError>,
    ) -> Result<T, BenchError> {
        let (own, conclusion) = self.parts(name, |progress| {
            let mut own = Findings::default();
            let conclusion = work(&mut own, progress)?;
            Ok((own, conclusion))
        })?;
        findings.append(own);
        Ok(conclusion)
    }

    /// The cases that were neither finished nor run.
    pub(super) fn left_out(&self) -> &[String] {
        &self.left_out
    }
}

/// A value that several cases need, found when it is asked for the first time.
pub(crate) struct Late<T, F> {
    find: F,
    found: Option<Result<T, BenchError>>,
}

impl<T, F: FnMut() -> Result<T, BenchError>> Late<T, F> {
    pub(crate) fn new(find: F) -> Self {
        Self { find, found: None }
    }

    /// The value.
    ///
    /// # Errors
    /// That of finding it, every time.
    pub(crate) fn get(&mut self) -> Result<&T, BenchError> {
        let found = self.found.get_or_insert_with(&mut self.find);
        found.as_ref().map_err(Clone::clone)
    }
}
