//! The cases that a study is cut into.
//!
//! A case has a name and a result, and depends on no other case. So it can be left out when it is finished already, or
//! when another machine runs it; what several cases need, such as a reference, is a [`LazyCell`] value, found when the
//! first of them asks for it.

use crate::error::BenchError;
use crate::journal::{Journal, Shard};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
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

/// What a run has come to.
#[derive(Clone, Copy, Debug)]
pub enum Progress<'a> {
    /// The next case.
    Case(&'a str),
    /// A part of the case that is being run.
    Part(&'a str),
}

/// Runs the cases of a study that are not finished, and keeps their results in the journal.
#[allow(missing_debug_implementations)] // it holds a closure
pub struct Cases<'a> {
    study: &'static str,
    /// None where cases are only counted.
    journal: Option<&'a mut Journal>,
    share: Share,
    progress: &'a mut dyn FnMut(Progress<'_>),
    named: HashSet<String>,
    left_out: Vec<String>,
    own_scene: Option<PathBuf>,
}

impl<'a> Cases<'a> {
    /// Cases of the study of that name; without a journal none is kept.
    pub fn new(
        study: &'static str,
        journal: Option<&'a mut Journal>,
        share: Share,
        progress: &'a mut dyn FnMut(Progress<'_>),
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

    /// The result of the case `name`: of `work`, now or when it was finished. A case that falls to another run has the
    /// default value.
    pub fn case<T: Serialize + DeserializeOwned + Default>(
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
        self.announce(name);
        let known = match self.known(name)? {
            Some(known) => known,
            None => {
                let started = Instant::now();
                let progress = &mut *self.progress;
                let outcome = work(&mut |part| progress(Progress::Part(part)));
                let seconds = started.elapsed().as_secs_f64();
                Known::Found(self.keep(name, seconds, outcome.and_then(to_value))?)
            }
        };
        self.read(name, known)
    }

    /// The results of one case per item, in their order. Those that are not finished are run side by side, as many as
    /// rayon has threads, each with one thread of its own. For results that hold no times: cores that are all busy
    /// share their memory, and measure each other.
    pub fn side_by_side<I, T>(
        &mut self,
        items: &[I],
        name: impl Fn(&I) -> String,
        work: impl Fn(&I) -> Result<T, BenchError> + Sync,
    ) -> Vec<Result<T, BenchError>>
    where
        I: Sync,
        T: Serialize + DeserializeOwned + Default,
    {
        let names: Vec<String> = items.iter().map(name).collect();
        let found =
            self.values_side_by_side(&names, &|index| work(&items[index]).and_then(to_value));
        let found = names.iter().zip(found);
        found.map(|(name, found)| self.read(name, found?)).collect()
    }

    /// The same, not yet read.
    fn values_side_by_side(
        &mut self,
        names: &[String],
        work: &(dyn Fn(usize) -> Result<Value, BenchError> + Sync),
    ) -> Vec<Result<Known, BenchError>> {
        let mut results: Vec<Option<Result<Known, BenchError>>> = Vec::with_capacity(names.len());
        for name in names {
            let known = self.known(name).transpose();
            if known.is_some() {
                self.announce(name);
            }
            results.push(known);
        }
        let open: Vec<usize> = (0..names.len()).filter(|&i| results[i].is_none()).collect();
        let next = AtomicUsize::new(0);
        let (tell, told) = mpsc::channel();
        let run = |tell: mpsc::Sender<Told>| {
            let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build();
            while let Some(&index) = open.get(next.fetch_add(1, Ordering::Relaxed)) {
                let started = Instant::now();
                if tell.send(Told::Begun(index)).is_err() {
                    return;
                }
                let outcome = match &alone {
                    Ok(alone) => alone.install(|| work(index)),
                    Err(error) => Err(BenchError::failed(error)),
                };
                let seconds = started.elapsed().as_secs_f64();
                // Nobody listens when the journal cannot be written any more.
                if tell.send(Told::Ended(index, seconds, outcome)).is_err() {
                    return;
                }
            }
        };
        std::thread::scope(|scope| {
            for _ in 0..rayon::current_num_threads().min(open.len()) {
                let tell = tell.clone();
                scope.spawn(|| run(tell));
            }
            drop(tell);
            for message in told {
                match message {
                    Told::Begun(index) => self.announce(&names[index]),
                    Told::Ended(index, seconds, outcome) => {
                        let kept = self.keep(&names[index], seconds, outcome);
                        results[index] = Some(kept.map(Known::Found));
                    }
                }
                if self.broken().is_some() {
                    break;
                }
            }
        });
        let never_run = || Err(BenchError::Failed("the run was broken off".into()));
        let results = results.into_iter();
        results
            .map(|result| result.unwrap_or_else(never_run))
            .collect()
    }

    fn broken(&self) -> Option<&BenchError> {
        self.journal.as_ref().and_then(|journal| journal.broken())
    }

    fn announce(&mut self, name: &str) {
        (self.progress)(Progress::Case(&format!("{}: {name}", self.study)));
    }

    fn about(&self, name: &str, error: impl std::fmt::Display) -> BenchError {
        BenchError::Failed(format!("case `{name}` of study `{}`: {error}", self.study))
    }

    /// What is known of a case before it is run; none if it is to be run now.
    fn known(&mut self, name: &str) -> Result<Option<Known>, BenchError> {
        if let Some(error) = self.broken() {
            return Err(error.clone());
        }
        if !self.named.insert(name.to_owned()) {
            return Err(self.about(name, "there are two of that name"));
        }
        let journal = self.journal.as_ref();
        if let Some(known) = journal.and_then(|journal| journal.recall(self.study, name)) {
            return Ok(Some(Known::Found(known?)));
        }
        let is_ours = match self.share {
            Share::All => true,
            Share::One(shard) => shard.includes(self.study, name),
            Share::Nothing => false,
        };
        if is_ours {
            return Ok(None);
        }
        self.left_out.push(name.to_owned());
        Ok(Some(Known::Elsewhere))
    }

    /// Records what came of a case after so many seconds, and hands it on.
    fn keep(
        &mut self,
        name: &str,
        seconds: f64,
        outcome: Result<Value, BenchError>,
    ) -> Result<Value, BenchError> {
        let recorded = outcome.clone().map_err(|error| error.to_string());
        if let Some(journal) = &mut self.journal {
            journal.record(self.study, name, seconds, recorded)?;
        }
        outcome
    }

    /// The result of a case, read back from what the journal keeps. What cannot be, such as a number that is none, is
    /// found out now, and not only when the run is taken up again.
    fn read<T: DeserializeOwned + Default>(
        &self,
        name: &str,
        known: Known,
    ) -> Result<T, BenchError> {
        match known {
            Known::Elsewhere => Ok(T::default()),
            Known::Found(value) => T::deserialize(&value).map_err(|error| self.about(name, error)),
        }
    }

    /// The cases that were neither finished nor run.
    pub fn left_out(&self) -> &[String] {
        &self.left_out
    }
}

/// What is known of a case that is not to be run now.
enum Known {
    /// Its result.
    Found(Value),
    /// It falls to another run.
    Elsewhere,
}

/// What a thread says of the case with this index.
enum Told {
    Begun(usize),
    /// After so many seconds, with this outcome.
    Ended(usize, f64, Result<Value, BenchError>),
}

/// A result as the journal keeps it.
fn to_value<T: Serialize>(found: T) -> Result<Value, BenchError> {
    serde_json::to_value(found).map_err(BenchError::failed)
}

/// A value that several cases need, found when it is asked for the first time.
pub(crate) struct LazyCell<T, F> {
    find: F,
    found: Option<Result<T, BenchError>>,
}

impl<T, F: FnMut() -> Result<T, BenchError>> LazyCell<T, F> {
    pub(crate) fn new(find: F) -> Self {
        Self { find, found: None }
    }

    /// The value.
    pub(crate) fn get(&mut self) -> Result<&T, BenchError> {
        let found = self.found.get_or_insert_with(&mut self.find);
        found.as_ref().map_err(Clone::clone)
    }
}
