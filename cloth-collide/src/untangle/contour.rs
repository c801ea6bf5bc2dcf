//! The curves along which a cloth passes through itself.

use super::World;
use super::crossing::{Crossing, End};
use crate::broad_phase::TrianglePairs;
use crate::error::NonFinite;
use crate::incidence::ends;
use crate::separation::meet_unduly;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

/// Segments in which pairs of triangles meet, and the pairs, which may be more: a pair that only touches has no
/// segment.
#[derive(Debug)]
pub(super) struct Contour {
    pub(super) pairs: TrianglePairs,
    segments: Vec<[End; 2]>,
    /// Pairs of triangles that meet.
    pub(super) meeting: Vec<[u32; 2]>,
}

impl Contour {
    pub(super) fn new(mesh: &TriMesh) -> Self {
        Self {
            pairs: TrianglePairs::new(mesh),
            segments: Vec::new(),
            meeting: Vec::new(),
        }
    }

    /// Finds all segments at `positions` (m).
    pub(super) fn find(&mut self, positions: &[Vec3], world: World<'_>) -> Result<(), NonFinite> {
        self.pairs.find(positions)?;
        self.segments.clear();
        self.meeting.clear();
        for (pair, corners) in self.pairs.pairs.iter().zip(self.pairs.corners()) {
            if world.counts(corners) && meet_unduly(corners, positions) {
                self.meeting.push(*pair);
                self.segments.extend(segment(corners, positions));
            }
        }
        Ok(())
    }

    /// Where edges pass through triangles: once for each triangle of the edge.
    pub(super) fn crossings(&self) -> impl Iterator<Item = Crossing> + '_ {
        let ends = self.segments.iter().flatten();
        ends.filter_map(|end| match end {
            End::Crossing(crossing) => Some(*crossing),
            End::Vertex { .. } => None,
        })
    }

    /// Length of all segments (m).
    pub(super) fn length(&self) -> Real {
        let lengths = self.segments.iter();
        let lengths = lengths.map(|[a, b]| (b.point() - a.point()).norm());
        // Not their sum, which is −0 if there are none.
        lengths.fold(0.0, |sum, length| sum + length)
    }

    /// Replaces `out` by the gradient of the length by the positions (dimensionless).
    pub(super) fn gradient(&self, out: &mut [Vec3]) {
        out.fill(Vec3::zeros());
        for [a, b] in &self.segments {
            if let Some(r) = (b.point() - a.point()).try_normalize(0.0) {
                a.pull_back(-r, out);
                b.pull_back(r, out);
            }
        }
    }
}

/// The segment in which two triangles meet: between the two crossings, or the crossing and the common vertex, that are
/// farthest apart.
fn segment(pair: [[u32; 3]; 2], positions: &[Vec3]) -> Option<[End; 2]> {
    let mut found: [Option<End>; 7] = [None; 7];
    let mut count = 0;
    let mut add = |end: End| {
        found[count] = Some(end);
        count += 1;
    };
    if let Some(&vertex) = pair[0].iter().find(|v| pair[1].contains(v)) {
        let point = positions[vertex as usize];
        add(End::Vertex { vertex, point });
    }
    for (one, other) in [(0, 1), (1, 0)] {
        for k in 0..3 {
            let edge = ends(k).map(|k| pair[one][k]);
            // An edge that ends in a corner of the other meets it there.
            if edge.iter().any(|v| pair[other].contains(v)) {
                continue;
            }
            if let Some(crossing) = Crossing::find(edge, pair[other], positions) {
                add(End::Crossing(crossing));
            }
        }
    }
    let mut longest = None;
    let mut length = 0.0;
    for (i, a) in found.iter().flatten().enumerate() {
        for b in found.iter().flatten().skip(i + 1) {
            let squared = (b.point() - a.point()).norm_squared();
            if squared > length {
                (length, longest) = (squared, Some([*a, *b]));
            }
        }
    }
    longest
}
