//! Excluded pairs: they pass through each other already, and are pulled apart by something else; or they may pass
//! through each other for good.

/// Regions of the cloth, and which of them may pass through each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Excluded {
    /// The region of each vertex of the cloth, from 1; 0 for none. Empty if there are none at all.
    region: Vec<u32>,
    /// In rising order, the smaller number first.
    pairs: Vec<[u32; 2]>,
}

impl Excluded {
    /// Of these regions, one number per vertex, and pairs of them.
    pub(crate) fn new(region: Vec<u32>, mut pairs: Vec<[u32; 2]>) -> Self {
        pairs.iter_mut().for_each(|pair| pair.sort_unstable());
        pairs.sort_unstable();
        Self { region, pairs }
    }

    /// Of how many vertices the regions are known.
    pub(super) fn region_count(&self) -> usize {
        self.region.len()
    }

    /// Takes over other regions and pairs of them. Returns whether they are others.
    pub(super) fn replace(&mut self, region: &[u32], pairs: &[[u32; 2]]) -> bool {
        let region = if pairs.is_empty() { &[] } else { region };
        let is_same = self.region == region && self.pairs == pairs;
        region.clone_into(&mut self.region);
        pairs.clone_into(&mut self.pairs);
        !is_same
    }

    /// Whether a pair is excluded whose first vertex is in one of its pieces, and whose last is in the other. The
    /// vertices of bodies are in no region.
    pub(crate) fn has(&self, vertices: &[u32]) -> bool {
        if self.pairs.is_empty() {
            return false;
        }
        let of = |v: &u32| self.region.get(*v as usize).copied();
        let ends = [vertices.first(), vertices.last()].map(|v| v.and_then(of));
        let [Some(a), Some(b)] = ends else {
            return false;
        };
        let known = self.pairs.binary_search(&[a.min(b), a.max(b)]).is_ok();
        known && vertices.iter().all(|v| ends.contains(&of(v)))
    }
}
