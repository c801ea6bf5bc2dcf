//! One run of a study: its scope, its cases and what they found.

use super::{Cases, Findings, Scope};
use crate::error::BenchError;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::ops::{Deref, DerefMut};

/// What a study works with. It asks for its cases, one by one or over a grid of points, and adds tables, plots and a
/// conclusion to its findings, whose methods are its own. A case that fails is noted there, and is missing in what the
/// study sees.
#[allow(missing_debug_implementations)] // its cases hold a closure
pub(super) struct StudyRun<'a> {
    pub(super) scope: Scope,
    pub(super) cases: Cases<'a>,
    pub(super) findings: Findings,
}

impl Deref for StudyRun<'_> {
    type Target = Findings;

    fn deref(&self) -> &Findings {
        &self.findings
    }
}

impl DerefMut for StudyRun<'_> {
    fn deref_mut(&mut self) -> &mut Findings {
        &mut self.findings
    }
}

impl<'a> StudyRun<'a> {
    pub(super) fn new(scope: Scope, cases: Cases<'a>) -> Self {
        Self {
            scope,
            cases,
            findings: Findings::default(),
        }
    }

    /// The result of one case, unless it failed.
    pub(super) fn case<T: Serialize + DeserializeOwned + Default>(
        &mut self,
        name: &str,
        work: impl FnOnce() -> Result<T, BenchError>,
    ) -> Option<T> {
        let outcome = self.cases.case(name, work);
        self.findings.unless_failed(name, outcome)
    }

    /// A case that fills findings of its own, which are added to those of the study, reports the parts that it is at,
    /// and draws a conclusion: none if it failed.
    pub(super) fn chapter<T: Serialize + DeserializeOwned + Default>(
        &mut self,
        name: &str,
        work: impl FnOnce(&mut Findings, &mut dyn FnMut(&str)) -> Result<T, BenchError>,
    ) -> Option<T> {
        let outcome = self.cases.parts(name, |progress| {
            let mut own = Findings::default();
            let conclusion = work(&mut own, progress)?;
            Ok((own, conclusion))
        });
        let (own, conclusion) = self.findings.unless_failed(name, outcome)?;
        self.findings.append(own);
        Some(conclusion)
    }

    /// One case per point, one after the other: the points whose case did not fail, each with its result.
    pub(super) fn grid<P, T: Serialize + DeserializeOwned + Default>(
        &mut self,
        points: impl IntoIterator<Item = P>,
        name: impl Fn(&P) -> String,
        mut work: impl FnMut(&P) -> Result<T, BenchError>,
    ) -> Vec<(P, T)> {
        let found = points.into_iter().filter_map(|point| {
            let found = self.case(&name(&point), || work(&point))?;
            Some((point, found))
        });
        found.collect()
    }

    /// The same with several cases at once, for results that hold no times ([`Cases::side_by_side`]).
    pub(super) fn grid_side_by_side<P: Sync, T: Serialize + DeserializeOwned + Default + Send>(
        &mut self,
        points: impl IntoIterator<Item = P>,
        name: impl Fn(&P) -> String,
        work: impl Fn(&P) -> Result<T, BenchError> + Sync,
    ) -> Vec<(P, T)> {
        let points: Vec<P> = points.into_iter().collect();
        let outcomes = self.cases.side_by_side(&points, &name, work);
        let found = points
            .into_iter()
            .zip(outcomes)
            .filter_map(|(point, outcome)| {
                let found = self.findings.unless_failed(&name(&point), outcome)?;
                Some((point, found))
            });
        found.collect()
    }
}
