//! The same cloth on several meshes and with several steps, beside a converged value.

use crate::studies::prelude::*;
use std::fmt;

/// Steps per second at which meshes are compared.
pub(super) const RATE: u32 = 60;

/// Every mesh at [`RATE`], and every rate on one mesh.
pub(super) struct MeshesAndSteps {
    /// Vertices a side.
    pub(super) sizes: &'static [u32],
    /// Steps per second.
    pub(super) rates: &'static [u32],
    /// The size at which rates are compared.
    pub(super) middle: u32,
}

/// A method on a mesh with a step.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Point {
    pub(super) method: &'static str,
    pub(super) vertices_a_side: u32,
    pub(super) steps_per_second: u32,
}

impl Point {
    pub(super) fn step(&self) -> Real {
        1.0 / Real::from(self.steps_per_second)
    }
}

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [n, rate] = [self.vertices_a_side, self.steps_per_second];
        write!(f, "{}, {n} vertices a side, 1/{rate} s", self.method)
    }
}

/// A value of a method at a point over the converged one: among meshes, and among steps.
pub(super) type OverConverged = (Point, [Real; 2]);

impl MeshesAndSteps {
    pub(super) fn points(&self, methods: &[&'static str]) -> Vec<Point> {
        let others = self.rates.iter().filter(|&&rate| rate != RATE);
        let sizes = self.sizes.iter().map(|&n| (n, RATE));
        let grid = sizes.chain(others.map(|&rate| (self.middle, rate)));
        let point = |(&method, (vertices_a_side, steps_per_second))| Point {
            method,
            vertices_a_side,
            steps_per_second,
        };
        iproduct!(methods, grid).map(point).collect()
    }

    /// Those of some rows that compare meshes.
    pub(super) fn by_size<T>(rows: &[(Point, T)]) -> impl Iterator<Item = &(Point, T)> {
        rows.iter()
            .filter(|(point, _)| point.steps_per_second == RATE)
    }

    /// Those that compare steps, from the shortest on.
    pub(super) fn by_step<'a, T>(&self, rows: &'a [(Point, T)]) -> Vec<&'a (Point, T)> {
        let is_ours = |row: &&(Point, T)| row.0.vertices_a_side == self.middle;
        let mut ours: Vec<_> = rows.iter().filter(is_ours).collect();
        ours.sort_by_key(|(point, _)| std::cmp::Reverse(point.steps_per_second));
        ours
    }

    /// A plot against the meshes, with a line for the converged value.
    pub(super) fn plot_by_size(&self, title: &str, y: Axis, rows: &[OverConverged]) -> Plot {
        let series = curves(Self::by_size(rows), |(point, over)| {
            (point.method, (Real::from(point.vertices_a_side), over[0]))
        });
        let ends = ends(self.sizes.iter().map(|&n| Real::from(n)));
        let plot = Plot::new(title, Axis::log("vertices a side (dimensionless)"), y);
        plot.with(series).exact("converged", ends.map(|x| (x, 1.0)))
    }

    /// The same against the steps.
    pub(super) fn plot_by_step(&self, title: &str, y: Axis, rows: &[OverConverged]) -> Plot {
        let series = curves(self.by_step(rows), |(point, over)| {
            (point.method, (point.step(), over[1]))
        });
        let ends = ends(self.rates.iter().map(|&rate| 1.0 / Real::from(rate)));
        let plot = Plot::new(title, Axis::log("step (s)"), y);
        plot.with(series).exact("converged", ends.map(|x| (x, 1.0)))
    }

    /// From least to largest of what a method shows: over all meshes, and over all steps.
    pub(super) fn ranges(&self, method: &str, rows: &[OverConverged]) -> [String; 2] {
        let is_ours = |row: &&OverConverged| row.0.method == method;
        let by_size = Self::by_size(rows).filter(is_ours);
        let by_step = self.by_step(rows).into_iter().filter(is_ours);
        [
            range(by_size.map(|(_, over)| over[0])),
            range(by_step.map(|(_, over)| over[1])),
        ]
    }
}

/// Least and largest of some values; infinite without any.
fn ends(values: impl Iterator<Item = Real>) -> [Real; 2] {
    values.fold([Real::INFINITY, -Real::INFINITY], |[least, most], value| {
        [least.min(value), most.max(value)]
    })
}

/// Least and largest of some values, in words.
pub fn range(values: impl Iterator<Item = Real>) -> String {
    match ends(values) {
        [least, most] if least <= most => {
            format!("{} to {}", significant(least, 3), significant(most, 3))
        }
        _ => "nothing known".to_owned(),
    }
}
